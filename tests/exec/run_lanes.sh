#!/bin/sh
# Runs in lanes: lagc sweep --lanes 4 and 8 write the bytes of --lanes 1, for each method, with events, measures along the run, monitors, inputs, and runs
# that fail; what has no lanes says why. In the long form the gallery, too.
. tests/tap.sh
. tests/exec/lib_precision.sh
cat >"$TMP/wobble.lag" <<'END'
model wobble "two pendulums on a driven cart, with a term of each function that lanes have of their own"
coord a [rad], b [rad]
param m = 1 [kg] > 0, k = 2 [N*m] > 0
input push = 0.3*sin(2*t*1[1/s]) [N*m]
kinetic = m/2*((2 + cos(a - b))*a'^2 + b'^2) * 1 [m^2]
potential = k*(1 - cos(a)) + k/4*exp(-b) + k/8*log(2 + cos(b)) + k/8*sqrt(1 + a^2) + k/9*tanh(a - b)
force a = push
scene free { start a = 0.4, b = 0.1; span 6 [s]; tolerance 1e-8; output a, b every 0.1 [s] }
scene watched { like free; monitor energy 1 }
END
sed 's/^model wobble/model turns/' "$TMP/wobble.lag" >"$TMP/turns.lag"
cat >>"$TMP/turns.lag" <<'END'
event turn: a' falling { }
event kick: b rising { b' = b' + 0.2[rad/s] }
END
cat >"$TMP/fall.lag" <<'END'
model fall "a fall into a pole, from different heights"
coord x [m]
param mu = 1 [m^3/s^2] > 0
kinetic = x'^2/2 * 1 [kg]
potential = -mu/x * 1 [kg]
scene fast { start x = 1; span 20 [s]; tolerance 1e-8; output x every 0.1 [s] }
END
sed "s/^model fall/model drag/; s/^kinetic/param c = 0.01 [kg\/s] >= 0\nforce x = -c*x'\nkinetic/" "$TMP/fall.lag" >"$TMP/drag.lag"
cat >"$TMP/encounter.lag" <<'END'
model encounter "a comet that all but falls into the sun: steps are rejected, energy is lost"
coord x [m], y [m]
param mu = 1 [m^3/s^2] > 0
kinetic = (x'^2 + y'^2)/2 * 1 [kg]
potential = -mu/sqrt(x^2 + y^2) * 1 [kg]
scene near { start x = 1, y' = 0.1 [m/s]; span 20 [s]; tolerance 1e-3; output x every 0.1 [s] }
END
cat >"$TMP/spring.lag" <<'END'
model spring "x'' = -x"
coord x [m]
param w = 1 [rad/s] > 0
kinetic = x'^2/2 * 1 [kg]
potential = w^2*x^2/2 * 1 [kg]
scene free { start x = 1; span 10 [s]; tolerance 1e-9; output x every 0.1 [s] }
END
if "$LAGC" sweep "$TMP/spring.lag" w=1,2 --lanes 4 -o "$TMP/x.csv" --quiet 2>"$TMP/err"; then widths="4"; else
  skip "runs in lanes" "$(cat "$TMP/err")"
  tap_end
  exit 0
fi
"$LAGC" sweep "$TMP/spring.lag" w=1,2 --lanes 8 -o "$TMP/x.csv" --quiet 2>/dev/null && widths="4 8"

# same NAME MODEL SCENE ARGS...: the rows of all widths, on one thread and on two; in `make test` on as many as the day says
threads='1 2'
[ -n "${SLOW:-}" ] || threads=$((1 + ${DAY:-0} % 2))
same() {
  name=$1 file=$2
  shift 2
  "$LAGC" sweep "$file" "$@" --lanes 1 -o "$TMP/1.csv" --quiet || return 1
  for lanes in $widths; do
    for n in $threads; do
      "$LAGC" sweep "$file" "$@" --lanes "$lanes" --threads "$n" -o "$TMP/n.csv" --quiet && cmp "$TMP/1.csv" "$TMP/n.csv" || return 1
    done
  done
}
for method in taylor dop853 rk45 rk4; do
  check "$method: the same bytes" same x "$TMP/wobble.lag" free a=-3..3:23 --method $method
  check "$method: with events that change the state" same x "$TMP/turns.lag" free a=-1..1:13 k=1,2 --method $method --measure 'count(turn)' --measure 'hit(kick)' --measure 'b(5)'
  check "$method: rejected steps, lost energy" same x "$TMP/encounter.lag" near "y'=0.002..0.2:17" --method $method
  check "$method: runs that fail" same x "$TMP/fall.lag" fast x=0.5..3:9 "x'=-0.1..2:3" --method $method --until 3
done
check "taylor: where only rounding is left" same x "$TMP/encounter.lag" near "y'=0.2..0.9:9" --method taylor --tol 1e-15
check "taylor: errors that are rounding, and fade" same x tests/exec/taylor/offset.lag far x=10001..10007:7 --method taylor --tol 1e-15
check "steps of equal size across a pole, without an energy that is kept" same x "$TMP/drag.lag" fast x=0.5..3:9 --until 6 --method rk4
check "measures along the run" same x "$TMP/wobble.lag" free a=-3..3:11 --method dop853 --measure 'max(a)' --measure 'mean(b)' --measure 'drift(energy)' --measure 'a(2)/a(4)'
check "monitors" same x "$TMP/wobble.lag" watched a=-3..3:7 --method taylor
check "an input held constant" same x "$TMP/wobble.lag" free push=-1..1:9 --method taylor
check "backwards" same x "$TMP/wobble.lag" free a=-3..3:9 --method taylor --until -4
for method in symplectic_euler verlet verlet4 verlet6 verlet8; do check "$method: the same bytes" same x "$TMP/spring.lag" w=0.5..3:11 --method $method; done
check "steps of equal size across a pole" same x "$TMP/fall.lag" fast x=0.5..3:9 --method verlet --until 3

"$LAGC" sweep "$TMP/spring.lag" w=1,3 --method taylor --measure 'X=x(10)' -o "$TMP/closed.csv" --quiet
near "x = cos(3 t)" 1e-8 0.154251449887584 "$(sed -n 3p "$TMP/closed.csv" | cut -d, -f2)" # the tolerance, 1e-9, over ten periods
# A constant that varies: runs of each of its values go in lanes, in whatever order the grid has them.
cat >"$TMP/row.lag" <<'END'
model row
const N = 3
coord th[N] [rad]
param k = 1 [rad/s] > 0
kinetic = sum(i in 1..N, th[i]'^2/2)*1 [kg*m^2]
potential = 1 [kg*m^2]*(sum(i in 1..N, 10 [1/s^2]*(1 - cos(th[i]))) + k^2/2*sum(i in 2..N, (th[i] - th[i-1])^2))
scene run { start th[i in 1..N] = 1.5 [rad]/i; span 10; tolerance 1e-9; method dop853 }
END
check "a constant that varies first" same x "$TMP/row.lag" N=2,3,5 k=1..4:31 --measure 'th[1]'
check "last" same x "$TMP/row.lag" k=1..4:31 N=2,3,5 --measure 'th[1]'
check "two, and samples" same x "$TMP/row.lag" 'k~uniform(1,4)' N=1,2 --samples 40 --measure 'max(th[1])' --method taylor
alone() { for n in 2 3 5; do "$LAGC" sweep "$TMP/row.lag" -D N=$n k=1..4:31 --measure 'th[1]' --lanes 1 --quiet -o - | sed '1d' | cut -d, -f2; done; }
is "the numbers of each value alone" "$(alone)" "$("$LAGC" sweep "$TMP/row.lag" N=2,3,5 k=1..4:31 --measure 'th[1]' --quiet -o - | sed 1d | cut -d, -f3)"
says_lanes() { "$LAGC" sweep "$TMP/spring.lag" w=1,2 "$@" -o "$TMP/x.csv" | grep -q "at once in lanes"; }
check "the report tells" says_lanes --method taylor
lanes_of_variants() { "$LAGC" sweep "$TMP/row.lag" N=2,3 k=1,2 -o "$TMP/x.csv" | grep -q "at once in lanes"; }
check "of constants that vary, too" lanes_of_variants
bad() { # WORDS ARGS...
  words=$1
  shift
  check "refused: $*" says 2 "$words" "$LAGC" sweep "$@" -o "$TMP/none.csv"
}
bad '1, 4 or 8 runs at once' "$TMP/spring.lag" w=1,2 --lanes 3
bad 'since the method has no lanes' "$TMP/spring.lag" w=1,2 --lanes 4 --method radau
bad 'since forces depend on velocities' "$TMP/wobble.lag" k=1,2 --lanes 4 --method verlet
bad 'since the model has constraints' models/slider_crank.lag a=0.4,0.5 --lanes 4 --until 0.1
bad 'sines (--math libm) have no vectors' "$TMP/spring.lag" w=1,2 --lanes 4 --math libm
if has_precision long; then bad 'this run computes in long precision' "$TMP/spring.lag" w=1,2 --lanes 4 --precision long; fi
check "nothing is written" [ ! -e "$TMP/none.csv" ]
one_by_one() { "$LAGC" sweep "$@" -o "$TMP/x.csv" | grep -q "one by one, since"; }
check "one by one, and why" one_by_one "$TMP/spring.lag" w=1,2 --method radau
# A liblag that Clang built has lanes, too; gcc passes vectors to it.
by_clang() {
  mkdir -p "$TMP/home/lib" "$TMP/home/include" && cp "${LAGC_CLANG%/*}"/liblag*.a "$TMP/home/lib" && cp runtime/include/*.h "$TMP/home/include" && LAG_HOME=$TMP/home same x "$TMP/wobble.lag" free a=-3..3:23 --method dop853
}
if [ -n "${LAGC_CLANG:-}" ] && [ -e "${LAGC_CLANG%/*}/liblag.a" ]; then slow check "by a liblag of Clang's" by_clang; fi
if [ -n "${SLOW:-}" ]; then
  for file in models/*.lag; do
    one_of 16 || continue
    q=$(sed -n 's/^\(coord\|state\) \([A-Za-z_0-9]*\)[ ,].*/\2/p' "$file" | head -1)
    { [ -z "$q" ] || grep -q 'constraint\|contact' "$file"; } && continue
    grep -q '\<\(if\|abs\|sign\|min\|max\)\>' "$file" && method=dop853 || method=taylor
    "$LAGC" sweep "$file" "$q=0.3,0.5" --lanes 4 --method $method -o "$TMP/x.csv" --quiet >/dev/null 2>&1 || continue
    check "$file, $method" same x "$file" "$q=0.3..0.9:11" --method $method
  done
fi
tap_end
