# shellcheck shell=sh
# Helpers for suites that are scripts: `. tests/tap.sh` at their head, `tap_end` at their end.
# A suite that is run without tests/run.sh finds the build of `make` here, and a folder of its own.
: "${LAGC:=build/lagc}" "${CC:=cc}" "${BUILD:=build}" "${INC:=runtime/include}"
[ -n "${TMP:-}" ] || { TMP=$(mktemp -d) && trap 'rm -rf "$TMP"' EXIT; }
export TMP
tap_n=0
tap_bad=0

# check NAME COMMAND...: ok when the command succeeds; its output is shown when it fails.
check() {
  tap_n=$((tap_n + 1))
  tap_name=$1
  shift
  if "$@" >"$TMP/tap_output" 2>&1; then
    echo "ok $tap_n - $tap_name"
  else
    tap_bad=$((tap_bad + 1))
    echo "not ok $tap_n - $tap_name"
    sed 's/^/# /' "$TMP/tap_output"
  fi
  [ -z "${TIMES:-}" ] || tap_times
}
# With TIMES=1 logs have, after each check, the processor time of the suite's commands so far, user and system.
tap_times() {
  times >"$TMP/tap_times"
  { read -r tap_line && read -r tap_line; } <"$TMP/tap_times"
  echo "# $tap_line"
}

# slow CHECK...: a check that `make test` leaves to `make test-long`, which sets SLOW=1. Where its words run a command, `"$(...)"`, write
# `[ -z "${SLOW:-}" ] || CHECK...`: the shell expands them first.
slow() { [ -z "${SLOW:-}" ] || "$@"; }

# depth FEW SOME ALL: a count for `make test`, `make test-long`, `make test-all`
depth() { case ${SLOW:+slow}${ROWS:-} in slowsome) echo "$2" ;; slow*) echo "$3" ;; *) echo "$1" ;; esac; }

# one_of K: for long tables of equal checks, succeeds for one row in K, another one each DAY; in `make test-long` for two in K, in `make test-all`
# for each.
tap_row=0
one_of() {
  tap_row=$((tap_row + 1))
  tap_step=$1
  case ${SLOW:+slow}${ROWS:-} in
    slowsome) tap_step=$((($1 + 1) / 2)) ;;
    slow*) return 0 ;;
  esac
  [ $(((tap_row + ${DAY:-0}) % tap_step)) = 0 ]
}

# one_day_in K R: in `make test-long` the suite runs when DAY is R modulo K, in `make test-all` always. Costly suites that find the same kind of fault take turns.
one_day_in() {
  [ "${ROWS:-all}" = all ] || [ $((${DAY:-0} % $1)) = "$2" ] || skip_all "one day in $1; \`make test-all T=...\` on any"
}

# light MODEL: all but the bicycle, for whose C a compiler takes as long as for ten others; in `make test-long` on one day in four all.
light() {
  case $1${SLOW:+slow}${ROWS:-} in
    *bicycle*slowsome) [ $((${DAY:-0} % 4)) = 0 ] ;;
    *bicycle*slow*) ;;
    *bicycle*) false ;;
  esac
}

# self_contained MODEL: its C needs nothing of liblag, as an output action(x) does.
self_contained() { ! grep -q '^ *observe .*= action(' "$1"; }

# has_header MODEL: constraints that begin and end by a condition have no header, and no one function for all states.
has_header() { ! grep -q -e '^ *constraint .* while [^l]' "$1"; }

# is NAME EXPECTED GOT
is() {
  tap_expected=$2
  tap_got=$3
  check "$1" tap_same
}
tap_same() {
  [ "$tap_expected" = "$tap_got" ] || {
    printf 'expected: %s\n     got: %s\n' "$tap_expected" "$tap_got"
    return 1
  }
}

# empty NAME TEXT: ok when the text, a list of faults, is empty.
empty() {
  tap_expected=
  tap_got=$2
  check "$1" tap_empty
}
tap_empty() { [ -z "$tap_got" ] || { printf '%s\n' "$tap_got"; return 1; }; }

# near NAME TOLERANCE EXPECTED GOT: ok when the numbers differ by at most the tolerance. What is no number, as nan, is not near: mawk takes nan <= t for true.
near() { check "$1" tap_near "$2" "$3" "$4"; }
tap_near() { close_to "$3" "$2" "$1"; }

# close_to GOT EXPECTED TOLERANCE: two numbers; mawk takes NaN for less than any number
close_to() {
  echo "got $1, expected $2 within $3"
  awk -v g="$1" -v e="$2" -v t="$3" 'BEGIN { n = "^[-+]?[.]?[0-9]"; d = g - e; exit !(g ~ n && e ~ n && d <= t && -d <= t) }'
}

# says STATUS WORDS COMMAND...: the command ends with this status and prints these words, on standard error if the status is not 0.
says() {
  tap_status=$1 tap_words=$2
  shift 2
  "$@" >"$TMP/out" 2>"$TMP/err" </dev/null
  tap_got=$?
  cat "$TMP/out" "$TMP/err"
  if [ "$tap_status" = 0 ]; then cat "$TMP/out" >>"$TMP/err"; fi
  [ "$tap_got" = "$tap_status" ] && grep -qF -e "$tap_words" "$TMP/err"
}

# golden NAME FILE STATUS COMMAND...: the command ends with this status and prints this file; with BLESS the file is rewritten.
golden() {
  tap_want=$2 tap_status=$3
  tap_title=$1
  shift 3
  "$@" >"$TMP/tap_text" 2>&1
  tap_got=$?
  if [ -n "${BLESS:-}" ] && [ "$tap_got" = "$tap_status" ]; then cp "$TMP/tap_text" "$tap_want"; fi
  check "$tap_title" tap_golden
}
tap_golden() {
  [ "$tap_got" = "$tap_status" ] || echo "exit status $tap_got, expected $tap_status"
  diff -u "$tap_want" "$TMP/tap_text" && [ "$tap_got" = "$tap_status" ]
}

# relay COMMAND...: the command's own TAP results, as part of this suite's; a command without a plan is a failure.
# RELAY_PREFIX: words before each name.
relay() {
  "$@" >"$TMP/tap_relay" 2>&1
  while IFS= read -r tap_line; do
    case $tap_line in
      "ok "* | "not ok "*)
        tap_n=$((tap_n + 1))
        case $tap_line in not*) tap_bad=$((tap_bad + 1)) ;; esac
        printf '%s %s - %s%s\n' "${tap_line%%ok *}ok" "$tap_n" "${RELAY_PREFIX:-}" "${tap_line#*ok * - }"
        ;;
      "# "*) printf '%s\n' "$tap_line" ;;
    esac
  done <"$TMP/tap_relay"
  grep -q '^1\.\.' "$TMP/tap_relay" || check "$1 runs to its end" tap_fail "$TMP/tap_relay"
}
tap_fail() { tail -n 20 "$1"; false; }

skip() {
  tap_n=$((tap_n + 1))
  echo "ok $tap_n - $1 # SKIP $2"
}

skip_all() {
  echo "1..0 # SKIP $1"
  exit 0
}

# needs_gsl: skips the suite where lagc was built without GSL.
needs_gsl() { [ -n "${GSL:-}" ] || [ -e "$BUILD/liblag_gsl.a" ] || skip_all "GSL is not installed"; }

tap_end() {
  echo "1..$tap_n"
  [ "$tap_bad" = 0 ]
}
