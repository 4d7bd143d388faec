#!/bin/sh
# --threads: sums over pairs, neighbours and trees that threads share have the bits of one thread; headers compiled with OpenMP, too.
. tests/tap.sh

printf 'int main(void) { return 0; }\n' >"$TMP/empty.c"
"$CC" -fopenmp "$TMP/empty.c" -o "$TMP/empty" 2>/dev/null || skip_all "this compiler has no OpenMP"

# Pairs below the diagonal, above it; sums of each body, and of all; unequal bodies. Sums over squares have no order of tiles.
cat >"$TMP/below.lag" <<'END'
model pairs "Unequal bodies that attract each other"
const N = 260
coord r[N]: vec3
param m[N] = 1 > 0, G = 0.1, soft = 0.3
kinetic = sum(i in 1..N, m[i]/2*dot(r[i]', r[i]'))
potential = sum(i in 1..N, sum(j in 1..i-1, -G*m[i]*m[j]/sqrt(dot(r[i] - r[j], r[i] - r[j]) + soft^2)))
scene s { start r[i in 1..N] = 3*(cos(i), sin(1.7*i), sin(0.6*i)), r[1]' = (1, 0, 0)
  m[3] = 2; m[200] = 5
  span 0.02; method verlet(step = 0.01); output r[1], r[130], r[260], energy every 0.01 }
END
sed 's/j in 1..i-1/j in i+1..N/' "$TMP/below.lag" >"$TMP/above.lag"
sed "s/^potential.*/dissipation = sum(i in 1..N, sum(j in 1..N, if(i == j, 0, m[i]*dot(r[i]' - r[j]', r[i]' - r[j]')\/(1 + dot(r[i] - r[j], r[i] - r[j])))))/" "$TMP/below.lag" >"$TMP/square.lag"

# Neighbours: in a periodic box, a scrambled order of members, so that lists reach across all shares; in the open, more than a list keeps.
cat >"$TMP/box.lag" <<'END'
model box
const N = 2000
coord x[N], y[N]
param L = 60 > 0, cut = 2.5 > 0
kinetic = sum(i in 1..N, (x[i]'^2 + y[i]'^2)/2)
function pair(s) = (cut^2 - s)^3/20
potential = sum(i in 1..N, sum(j in near(i, cut, x, y, L),
  pair(image(x[i] - x[j], L)^2 + image(y[i] - y[j], L)^2)))
scene s { start x[i in 1..N] = 37.3*i - 60*floor(37.3*i/60), y[i in 1..N] = 11.17*i - 60*floor(11.17*i/60), x[1]' = 3
  span 0.01; method verlet(step = 0.005); output x[1], y[1000], x[2000], energy every 0.01 }
END
sed 's/, L)))$/)))/; s/image(\([^,]*\), L)/(\1)/g; s/x, y, L/x, y/; s/60/20/g; s/cut = 2.5/cut = 5/; s/^model box/model open/' "$TMP/box.lag" >"$TMP/open.lag"

cat >"$TMP/tree.lag" <<'END'
model tree
const N = 2000
coord r[N]: vec3
param k = 0.1 > 0, e = 0.3 > 0, m[N] = 1 > 0
kinetic = sum(i in 1..N, m[i]*dot(r[i]', r[i]')/2)
potential = k*sum(i in 1..N, sum(j in 1..i-1, m[i]*m[j]/sqrt(e^2 + dot(r[i] - r[j], r[i] - r[j])), by tree(0.6)))
scene s { start r[i in 1..N] = sqrt(i)*(cos(2.4*i), sin(2.4*i), sin(i)), r[1]' = (1, 0, 0)
  m[3] = 2; m[40] = 5
  span 0.01; method verlet(step = 0.01); output r[1], r[2000], energy every 0.01 }
END

rows() { # MODEL OPTIONS: the digits, in hexadecimal where two texts may print alike
  model=$1
  shift
  rm -f "$TMP/rows.npy"
  "$LAGC" run "$TMP/$model.lag" --compile always -o "$TMP/rows.npy" "$@" >"$TMP/out" 2>&1 && cat "$TMP/rows.npy" && grep '^energy drift' "$TMP/out"
}
for model in below above box open tree; do
  rows $model >"$TMP/one"
  check "$model runs" test -s "$TMP/one"
  "$LAGC" emit "$TMP/$model.lag" >"$TMP/text" 2>/dev/null
  case $model in box | open) shared=lag_near_shared ;; tree) shared=lag_tree_sum ;; *) shared=LAG_NEXT_TILE ;; esac
  check "$model is shared" grep -q "$shared" "$TMP/text"
  for n in 2 1 3 4; do
    [ $n = 2 ] || one_of 6 || continue
    rows $model --threads $n >"$TMP/some"
    check "$model: the bits of $n threads are those of one" cmp "$TMP/one" "$TMP/some"
    case $model$n in below2) threads=$(OMP_DISPLAY_AFFINITY=TRUE OMP_AFFINITY_FORMAT='number %n' rows below --threads 2 --until 0.01 >/dev/null; grep -c '^number [01]$' "$TMP/out") ;; esac
  done
done
is "two threads work" 2 "$threads"

# A pair of members of which one alone is in a share, and steps that make lists anew.
slow rows box >"$TMP/one"
[ -z "${SLOW:-}" ] || check "lists made anew" eval 'rows box --until 0.3 >"$TMP/one" && rows box --until 0.3 --threads 3 >"$TMP/some" && cmp "$TMP/one" "$TMP/some"'

# Headers take all pairs, also of neighbours.
header() { # MODEL: its steps, in hexadecimal, by each compiler with the options that follow
  "$LAGC" header "$TMP/$1.lag" -o "$TMP/$1.h" >"$TMP/out" 2>&1 || cat "$TMP/out"
  name=$1
  cat >"$TMP/$1.c" <<END
#define $(echo "$name" | tr a-z A-Z)_IMPLEMENTATION
#include "$1.h"
#include <stdio.h>
static ${name}_params p;
static ${name}_state s;
int main(void) {
  ${name}_defaults(&p);
  if (${name}_start(&p, &s)) return 1;
  for (int k = 0; k < 2; k++)
    if (${name}_rk4_step(&p, &s, 0.01)) return 1;
  for (int k = 0; k < (int)(sizeof s.q / sizeof *s.q); k++) printf("%.17g %.17g\n", s.q[k], s.v[k]);
  return 0;
}
END
}
program() { "$@" -ffp-contract=off -w -I"$TMP" "$TMP/$model.c" -o "$TMP/program" -lm && "$TMP/program"; }
sed 's/N = 2000/N = 300/; s/1000/100/; s/2000/300/' "$TMP/box.lag" >"$TMP/few.lag"
for model in below few; do
  one_of 3 || [ $model = below ] || continue
  header $model
  program "$CC" -std=c99 -O1 >"$TMP/one"
  check "header of $model" test -s "$TMP/one"
  name=$(echo "$name" | tr a-z A-Z)
  check "header of $model: three threads" eval 'program "$CC" -std=c99 -O1 -fopenmp -D${name}_THREADS=3 >"$TMP/some" && cmp "$TMP/one" "$TMP/some"'
  check "header of $model: as many as OMP_NUM_THREADS says" eval 'OMP_NUM_THREADS=2 program "$CC" -std=c99 -O1 -fopenmp >"$TMP/some" && cmp "$TMP/one" "$TMP/some"'
done
model=below
check "header in C++" eval 'program "${CXX:-c++}" -x c++ -std=c++98 -O1 -fopenmp -DBELOW_THREADS=2 >"$TMP/some" && header below && program "$CC" -std=c99 -O1 >"$TMP/one" && cmp "$TMP/one" "$TMP/some"'
check "threads without OpenMP are refused" eval '! program "$CC" -std=c99 -DBELOW_THREADS=2 2>"$TMP/out" && grep -q "BELOW_THREADS needs OpenMP" "$TMP/out"'

# Programs and shared libraries.
for n in 1 3; do
  check "a simulator of $n" "$LAGC" build "$TMP/below.lag" --threads $n -o "$TMP/sim_$n"
  "$TMP/sim_$n" s -o "$TMP/sim_$n.npy" >/dev/null 2>&1
done
check "simulators: the same bits" cmp "$TMP/sim_1.npy" "$TMP/sim_3.npy"
check "a shared library" "$LAGC" build "$TMP/below.lag" --shared --threads 2 -o "$TMP/libpairs.so"

# What threads cannot do is said.
cat >"$TMP/small.lag" <<'END'
model small
coord x
lagrangian = x'^2/2 - x^2/2
scene s { start x = 1
  span 1 }
END
check "nothing to share" says 0 "--threads: nothing to share" "$LAGC" run "$TMP/small.lag" --threads 2
check "nothing to share, when it is known" says 0 "--threads: nothing to share" "$LAGC" run "$TMP/small.lag" --threads 2
check "nor in squares" says 0 "--threads: nothing to share" "$LAGC" run "$TMP/square.lag" --threads 2 --compile never
check "nor in a simulator" says 0 "--threads: nothing to share" "$LAGC" build "$TMP/small.lag" --threads 2 -o "$TMP/sim"
for n in 0 x 2.5 2000; do check "--threads $n is refused" says 2 "--threads $n: write a number from 1 to 1024" "$LAGC" run "$TMP/below.lag" --threads $n; done
check "evaluated runs have one thread" says 2 "--compile never computes in one thread: leave out --threads" "$LAGC" run "$TMP/below.lag" --threads 2 --compile never
cat >"$TMP/cc_without" <<END
#!/bin/sh
case " \$* " in *" -fopenmp "*) echo "unrecognized command-line option '-fopenmp'" >&2; exit 1 ;; esac
exec $CC "\$@"
END
chmod +x "$TMP/cc_without"
check "a compiler without OpenMP" says 2 "--threads needs OpenMP, which the C compiler \`$TMP/cc_without\` does not have" env CC="$TMP/cc_without" "$LAGC" run "$TMP/below.lag" --threads 2
check "no thread at all" says 2 '--threads 0: write a number from 1 to 1024' "$LAGC" run models/pendulum.lag --threads 0
tap_end
