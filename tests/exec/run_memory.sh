#!/bin/sh
# Memory runs out, once at each allocation of a simulator: in liblag, in gsl methods and in the analysis of a start. Either the run says so and ends
# with its own status, or the results do not depend on that memory and stay the same.
. tests/tap.sh
[ -n "$GSL" ] || skip_all "no GSL"
cat >"$TMP/fail.c" <<'EOF'
/* The allocation number $FAIL_AT of the program fails, counted from the start of main, or each that would bring what is allocated above $FAIL_ABOVE bytes. How many
 * there were, and the most bytes, go to $FAIL_COUNT at the end. */
#include <malloc.h>
#include <stdio.h>
#include <stdlib.h>
void *__libc_malloc(size_t n);
void *__libc_calloc(size_t k, size_t n);
void *__libc_realloc(void *p, size_t n);
void __libc_free(void *p);
static long at, count, above, bytes, most;
static long number(const char *name) { return getenv(name) ? atol(getenv(name)) : 0; }
__attribute__((constructor)) static void begin(void) {
  at = number("FAIL_AT");
  above = number("FAIL_ABOVE");
  count = bytes = most = 0;
}
__attribute__((destructor)) static void end(void) {
  FILE *f = getenv("FAIL_COUNT") ? fopen(getenv("FAIL_COUNT"), "w") : NULL;
  if (f) fprintf(f, "%ld %ld\n", count, most), fclose(f);
}
static int fails(size_t n) { return ++count == at || (above && bytes + (long)n > above); }
static void *seen(void *p) {
  bytes += (long)malloc_usable_size(p);
  most = bytes > most ? bytes : most;
  return p;
}
void *malloc(size_t n) { return fails(n) ? NULL : seen(__libc_malloc(n)); }
void *calloc(size_t k, size_t n) { return fails(k*n) ? NULL : seen(__libc_calloc(k, n)); }
void *realloc(void *p, size_t n) {
  if (fails(n)) return NULL;
  bytes -= (long)malloc_usable_size(p);
  return seen(__libc_realloc(p, n));
}
void free(void *p) {
  bytes -= (long)malloc_usable_size(p);
  __libc_free(p);
}
EOF
"$CC" -shared -fPIC -O1 -o "$TMP/fail.so" "$TMP/fail.c" 2>"$TMP/err" && LD_PRELOAD=$TMP/fail.so true || skip_all "no LD_PRELOAD"

plain() { sed 's/"wall_s": [^,]*,//' "$1"; }

# one WHAT WORDS...: the run with one thing failing, as the environment says; adds to $told or $same
one() {
  what=$1
  shift
  LD_PRELOAD=$TMP/fail.so "$@" >"$TMP/out" 2>&1
  status=$?
  if [ $status = 0 ]; then
    plain "$TMP/out" | cmp -s - "$TMP/expected" || { echo "$what changes the run:"; plain "$TMP/out" | diff - "$TMP/expected" | head -6; return 1; }
    same=$((same + 1))
  else
    [ $status -le 3 ] && grep -qi 'memory' "$TMP/out" || { echo "$what: status $status"; head -5 "$TMP/out"; return 1; }
    told=$((told + 1))
  fi
}

# each NAME MODEL WORDS...: the simulator of a model, built with $with, once for each of its allocations, up to MOST; at a gsl method, whose library
# does not look at all of its own, once for each of 100 limits of all memory.
MOST=400
with=
each() {
  name=$1 sim=$TMP/$1
  # shellcheck disable=SC2086
  "$LAGC" build "$2" $with -o "$sim" >"$TMP/err" 2>&1 || { cat "$TMP/err"; return 1; }
  shift 2
  FAIL_COUNT=$TMP/count LD_PRELOAD=$TMP/fail.so "$sim" "$@" >"$TMP/whole" 2>&1 || { cat "$TMP/whole"; return 1; }
  plain "$TMP/whole" >"$TMP/expected"
  read -r n most <"$TMP/count"
  told=0 same=0 stride=$((n / MOST + 1))
  case $name in
    gsl-*) for part in $(seq 1 100); do FAIL_ABOVE=$((most * part / 100)) one "a limit of $part % of $most bytes" "$sim" "$@" || return 1; done ;;
    *) for at in $(seq 1 $stride "$n"); do FAIL_AT=$at one "allocation $at of $n" "$sim" "$@" || return 1; done ;;
  esac
  echo "# $name $*: $n allocations, $most bytes; $told said, $same that do not matter"
  [ $told -gt 0 ] || { echo "none failed"; return 1; }
}
check "constraints that follow from others, and their start" each rhomb tests/exec/models/rhomb.lag --until 0.3 --json
check "events, contacts, impacts" each room models/room.lag --until 0.5 --json
check "constraints that begin and end" each wheel models/rimless_wheel.lag --until 2 --json
check "a start that is led to its constraints" each crank models/slider_crank.lag --until 0.2 --json
for method in dop853 radau taylor variational gsl-rk8pd gsl-bsimp; do
  with="--method $method"
  check "$method" each "$method" models/double_pendulum.lag --method $method --until 0.1 --json
done
MOST=60
with="--method taylor"
check "a method that is chosen: no other one for want of memory" each chosen models/double_pendulum.lag --tol 1e-12 --until 0.1 --json
with="--method radau"
slow check "the same of a stiff model" each stiff models/tippe_top.lag --until 0.1 --json
MOST=400
with="--with linear"
check "modes, by GSL's algebra" each spring models/spring_pendulum.lag --modes
check "exponents" each henon models/henon_heiles.lag --lyapunov --until 5
tap_end
