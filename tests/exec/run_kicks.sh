#!/bin/sh
# Kicks: events at equal times. The standard map iterated by hand, Greene's residues about the golden torus, a ring of FODO cells, tangents and volumes over kicks, energy, refusals.
. tests/tap.sh
map=models/standard_map.lag ring=models/storage_ring.lag

# by_hand K Q P N: q and p behind each of N kicks
by_hand() { awk -v K="$1" -v q="$2" -v p="$3" -v n="$4" 'BEGIN { for (i = 1; i <= n; i++) { q += p; p -= K*sin(q); printf "%.17g,%.17g\n", q, p } }'; }
# A regular orbit: errors of 1e-16 grow as t, and over 300 kicks to 300^2/2*1e-16 = 5e-12.
by_hand 0.9 1 0.3 300 >"$TMP/hand"
follows() { "$LAGC" run "$@" --until 300.5 --section pulse --quiet -o "$TMP/rows.csv" && tail -n +2 "$TMP/rows.csv" | cut -d, -f2,3 | paste -d, - "$TMP/hand" |
  awk -F, '{ d = ($1 - $3)^2 + ($2 - $4)^2; if (d > 1e-22) { print NR, $0; bad = 1; exit } } END { exit bad || NR != 300 }'; }
for method in taylor dop853 'verlet(step=0.1)' 'gauss(step=0.037)' 'radau' 'rk4(step=0.3)'; do check "300 kicks as by hand, $method" follows $map --method "$method"; done
cat >"$TMP/rotor.lag" <<'X'
model rotor "The same by its Lagrangian"
coord q
param T = 1 > 0, K = 0.9
lagrangian = q'^2/2
kick pulse every T { q' = q' - K*sin(q) }
scene s { start q = 1, q' = 0.3; span 20; tolerance 1e-12; output q, q' every 1 }
X
for method in taylor verlet 'variational(order=4, step=0.25)'; do check "and of its Lagrangian, $method" follows "$TMP/rotor.lag" --method "$method"; done
check "kicks of an effect" sh -c 'sed "s/^kick.*/effect beat { & }/; s/scene s {/scene s { use beat;/" "$1/rotor.lag" >"$1/effect.lag"; "$2" run "$1/effect.lag" | grep "kick pulse: 19 times, first at t = 1 s, last at 19 s"' sh "$TMP" "$LAGC" # at the end of a run it has not happened yet
is "a run in two parts is the same run" "$("$LAGC" run $map --until 90.3 --quiet -o - | tail -1)" "$("$LAGC" run $map --until 33.3 --save-state "$TMP/state" --quiet && "$LAGC" run $map --resume "$TMP/state" --until 90.3 --quiet -o - | tail -1)"
is "also where it is cut at a kick" "$("$LAGC" run $map --until 90.3 --quiet -o - | tail -1)" "$("$LAGC" run $map --until 40 --save-state "$TMP/state" --quiet && "$LAGC" run $map --resume "$TMP/state" --until 90.3 --quiet -o - | tail -1)"

# Greene's residue (2 - trace)/4 of the orbit of period 987 that turns 610 times, next to the golden torus: 1/4 at K = 0.971635; to either side it leaves it, the faster the longer the orbit
# (J.M. Greene, J. Math. Phys. 20 (1979) 1183, DOI 10.1063/1.524170). The orbit by bisection of the map on the line q = 0, its residue by the tangent of lagc run.
golden_start() { awk -v K="$1" 'BEGIN { tau = 8*atan2(1, 1); lo = tau*610/987 - 0.3; hi = lo + 0.6
  for (k = 0; k < 60; k++) { p0 = (lo + hi)/2; q = 0; p = p0; for (i = 0; i < 987; i++) { q += p; p -= K*sin(q) } if (q < 610*tau) lo = p0; else hi = p0 }
  printf "%.17g", p0 }'; }
residue() { "$LAGC" run $map K="$1" q=0 p="$(golden_start "$1")" --tangent --section pulse --until 987.5 --quiet -o - | tail -1 | awk -F, '{ printf "%.9g", (2 - $4 - $7)/4 }'; }
near "the residue of a golden orbit where the torus breaks" 2e-4 0.25 "$(residue 0.971635)" # 0.250022 by the map with 16 digits; those of Q = 377 and 1597 differ by 1e-4
is "below it, and above" "0.24 0.27" "$(awk -v a="$(residue 0.9716)" -v b="$(residue 0.9717)" 'BEGIN { printf "%.2f %.2f", a, b }')"

# The rotor at rest below: M = (1, 1; -K, 1 - K), whose power n has the trace 2 cos(n mu), cos mu = 1 - K/2; a kick leaves this state as it is.
trace() { "$LAGC" run "$@" --tangent --quiet -o - | tail -1 | awk -F, -v a="$a" -v b="$b" '{ printf "%.17g", $a + $b }'; }
a=4 b=7
near "the tangent where kicks do nothing" 1e-12 "$(awk 'BEGIN { c = 0.55; s = sqrt(1 - c*c); mu = atan2(s, c); printf "%.17g", 2*cos(30*mu) }')" "$(trace $map q=0 p=0 --section pulse --until 30.5)"
# A cell with two kicks at its end: trace 2 - k^2 h^2 in x and y; columns t, x, px, y, py and the matrix of x, y, px, py, row by row
a=6 b=16
near "the tune of a FODO cell, in x" 1e-12 1.19 "$(trace $ring linear --section sextupoles --until 2.5)"
a=11 b=21
near "and in y" 1e-12 1.19 "$(trace $ring linear --section sextupoles --until 2.5)"
a=6 b=16 # beside x = 100 mm the sextupole adds -s x M12, where x and the matrix are those of the linear cell: x1 = 1.9 x, M12 = 2.9
near "with the sextupole's gradient" 1e-12 "$(awk 'BEGIN { printf "%.17g", 1.19 - 0.19*2.9 }')" "$(trace $ring turns --section sextupoles --until 2.5)"

# Volumes, exponents, energy
log_det() { "$LAGC" run "$@" --volume --json | sed 's/.*"log": \([^,]*\),.*/\1/; q'; }
near "kicks of momenta keep volumes" 1e-11 0 "$(log_det $map)"
sed 's/{ q. = .*/{ q'"'"' = 0.9*q'"'"' - K*sin(q) }/' "$TMP/rotor.lag" >"$TMP/loss.lag"
cat >"$TMP/swing.lag" <<'X'
model swing "A pendulum that is kicked: steps end at kicks, and the method keeps its properties"
coord q
lagrangian = q'^2/2 + cos(q)
kick push every 1 { q' = q' + 0.1*sin(2*q) }
scene s { start q = 1; span 100.5; tolerance 1e-12; output q, q' every 100.5 }
X
for method in 'gauss(step=0.037)' 'verlet4(step=0.037)' 'variational(step=0.037)'; do near "with a force between them, $method" 1e-11 0 "$(log_det "$TMP/swing.lag" --method "$method")"; done
# Steps end at kicks: 27 of 0.037, one of 0.001, leapfrog written by hand. A state between the ends of a longer step would be off by 1e-8.
leapfrog() { awk 'BEGIN { q = 1; for (n = 1; n <= 11; n++) { rest = 1; while (rest > 1e-9) { h = rest < 0.037 ? rest : 0.037; v -= h/2*sin(q); q += h*v; v -= h/2*sin(q); rest -= h }
  if (n < 11) v += 0.1*sin(2*q) } printf "%.17g", q }'; }
near "leapfrog by hand" 1e-12 "$(leapfrog)" "$("$LAGC" run "$TMP/swing.lag" --until 11 --every 11 --quiet -o - --method 'verlet(step=0.037)' | tail -1 | cut -d, -f2)"
final() { "$LAGC" run "$TMP/swing.lag" --quiet -o - --method "$1" | tail -1 | cut -d, -f2; }
# 1e-12 a step, which grows a hundredfold; states of radau within longer steps, of order 3, would be off by 1.5e-9
for method in radau rk45 'verlet8(step=0.037)'; do near "the motion is that by dop853, $method" 5e-10 "$(final dop853)" "$(final "$method")"; done
near "a kick that takes a tenth of the momentum, 19 times" 1e-11 "$(awk 'BEGIN { printf "%.17g", 19*log(0.9) }')" "$(log_det "$TMP/loss.lag")"
near "the exponent of strong kicks, log(K/2)" 0.02 "$(awk 'BEGIN { printf "%.17g", log(5) }')" "$("$LAGC" lyapunov $map orbit K=10 --until 20000 --exponents 1 --json | sed 's/.*"exponents": \[\([^],]*\).*/\1/')" # Chirikov 1979, for K > 6; the standard error of 2e4 kicks is 0.005
printf "model push\ncoord x\nlagrangian = x'^2/2\nkick step every 0.5 { x' = x' + 0.1 }\nscene s { span 5.2 }\n" >"$TMP/push.lag"
near "the energy that ten kicks give" 1e-14 0.5 "$("$LAGC" run "$TMP/push.lag" --json | sed 's/.*"at_events": \([^,]*\),.*/\1/')"
check "is a line of the report" sh -c '"$0" run "$1" | grep -x "kicks and events: 0.5 of energy"' "$LAGC" "$TMP/push.lag"
check "and no drift" sh -c '"$0" run "$1" | grep "energy drift: 0 "' "$LAGC" "$TMP/push.lag"
# kicks and events that carry the state over a surface, where the energy of the other side begins; between them energy is conserved, to 1e-10
for what in 'kick e every 0.3' 'event e: y + 0.02 rising'; do
  printf "model over\ncoord y\nlagrangian = y'^2/2 - if(y > 0, y^2, 0)\n%s { y = y + 0.1 }\nscene s { start y = -0.06, y' = 0.15; span 1 }\n" "$what" >"$TMP/over.lag"
  near "$what over a surface: no drift" 1e-10 0 "$("$LAGC" run "$TMP/over.lag" --json | sed 's/.*"energy_drift_absolute": \([^,]*\).*/\1/')"
done

# Events beside kicks: x' = 0.1 n behind kick n, x = n (n - 1)/40 + ...; it meets 0.3 at t = 2.1 (x(2) = 0.25 + 0.05 ... by hand)
cat >"$TMP/gate.lag" <<'X'
model gate
coord x
lagrangian = x'^2/2
kick step every 0.5 { x' = x' + 0.1 }
event gate: x - 0.3 rising { x' = 0 }
scene s { span 5.2; output x, x' every 0.1 }
X
near "an event between kicks" 1e-12 2 "$("$LAGC" run "$TMP/gate.lag" --measure 'hit(gate)' --json | sed 's/.*"measures".*"value": \([^,}]*\).*/\1/; s/.*"hit(gate)": \([^,}]*\).*/\1/')" # x(2) = 0.5*(0.1 + 0.2 + 0.3) = 0.3, as kick 4 is due
near "after both" 1e-12 "$(awk 'BEGIN { v = 0; x = 0; for (n = 1; n <= 10; n++) { x += v*0.5; if (n == 4) v = -0.1; v += 0.1 } print x + v*0.2 }')" "$("$LAGC" run "$TMP/gate.lag" --quiet -o - | tail -1 | cut -d, -f2)"
fails() { words=$1; shift; "$LAGC" run "$@" >"$TMP/out" 2>&1; [ $? = 3 ] && grep -F "FAILED" "$TMP/out" | grep -F "$words"; }
check "a tangent over an event and a kick at once is refused" fails "at the same time" "$TMP/gate.lag" --tangent

# The dynamic aperture: how many of a hundred cells each start passes before it hits the wall, as by hand. The wall is met on the way to a lens, where motions are straight.
cells() { awk 'BEGIN { for (i = 0; i < 61; i++) { x = i*0.005; p = 0
  for (n = 0; n < 100; n++) { x += p; if (x*x >= 1) break; p += 0.9*x; x += p; if (x*x >= 1) break; p -= 0.9*x; p -= x*x/2 } printf "%d ", n } }'; }
swept() { "$LAGC" sweep $ring turns 'x=0..300:61' --measure 'count(sextupoles)' --quiet -o - | tail -n +2 | awk -F, '{ printf "%d ", $2 }'; }
is "cells that starts pass in a ring" "$(cells)" "$(swept)"
check "some are lost, late or at once" sh -c 'case $1 in "100 "*" 24 "*" 3 ") ;; *) false ;; esac' sh "$(cells)"

# --starts
plot() { "$LAGC" plot "$@" -o "$TMP/p.svg"; }
is "a run for each value of a range, in units" "7 runs" "$(plot $map --section pulse --x q --y p --starts 'q=-60..60[deg]:7' --until 9.5 | head -1)"
is "a mark each kick and run" 63 "$(grep 'stroke-linecap' "$TMP/p.svg" | tr M '\n' | grep -c h0)"
# Without kicks and at rest each mark stays where it starts: 0 in the middle of the picture at 384, 1 rad 95.493 of its 600 pixels; so that 20 degrees are 33.33.
marks() { grep 'stroke-linecap' "$TMP/p.svg" | sed 's/.* d="M\([-0-9. ]*\)h0.*/\1/' | cut -d ' ' -f "$1" | tr '\n' ' '; }
near_all() { # TOLERANCE WANTED GOT: numbers of two lists
  echo "got $3, expected $2"; awk -v e="$2" -v g="$3" -v t="$1" 'BEGIN { n = split(e, a, " "); bad = split(g, b, " ") != n; for (i = 1; i <= n; i++) { d = a[i] - b[i]; bad += b[i] ~ /n/ || d > t || -d > t } exit bad > 0 }'; }
plot $map K=0 p=0 --section pulse --x q --y p --starts 'q=-60..60[deg]:7' --until 3.5 >"$TMP/out"
check "each where it starts" near_all 0.02 "284 317.33 350.67 384 417.33 450.67 484" "$(marks 1)"
plot $map K=0 q=0 --section pulse --x q --y p --starts 'p=0.1..1.6:log:5' --until 3.5 >"$TMP/out"
# Places have two decimals, of 30 pixels.
check "in equal ratios: their distances double" near_all 3e-3 "1 2 4 8" "$(marks 2 | awk '{ for (i = 2; i <= NF; i++) printf "%.4f ", ($(i) - $(i - 1))/($2 - $1) }')"
check "coloured by their place, with a legend" sh -c 'grep -q ">p=0.1<" "$1" && grep -q ">p=1.6<" "$1" && [ "$(grep -c "stroke-width=\"2.5\"" "$1")" = 5 ]' sh "$TMP/p.svg"
is "a list" "3 runs" "$(plot $map --section pulse --x q --y p --starts p=0,1,2 --until 9.5 | head -1)"
check "an angle is drawn from -pi to pi" sh -c '"$1" plot "$2" p=2.5 --section pulse --x q --y p --until 50.5 -o "$3" >/dev/null && ! grep -q ">10<" "$3" && grep -q ">3<" "$3"' sh "$LAGC" $map "$TMP/q.svg"
check "no range" says 2 "write a range" "$LAGC" plot $map --starts q -o "$TMP/p.svg"
check "two ranges" says 2 "--starts stands twice, q=0,1 and p=0,1: one range of runs is drawn" "$LAGC" plot $map --starts q=0,1 --starts p=0,1 -o "$TMP/p.svg"
check "a range and --vs" says 2 "leave one of them out" "$LAGC" plot $map --starts q=0,1 --vs q=2 -o "$TMP/p.svg"
check "no number of runs" says 2 "the number of runs is missing" "$LAGC" plot $map --starts q=0..1 -o "$TMP/p.svg"
check "the section of an event that there is not" says 2 'no event or kick `puls`; did you mean `pulse`?' "$LAGC" run $map --section puls
check "of a coordinate without a direction" says 2 "a direction is missing" "$LAGC" run $map --section q

# Refusals
refused() { words=$1; shift; printf '%s\n' "model m" "coord x [m]" "param T = 1 [s], v = 1" "lagrangian = 1 [kg]*x'^2/2" "$@" >"$TMP/bad.lag"; says 1 "$words" "$LAGC" check "$TMP/bad.lag"; }
check "a period that is a length" refused "[m]" "kick a every 2 [m] { x' = 0 }"
check "a period that changes" refused "parameters and numbers alone" "kick a every T + t { x' = 0 }"
check "a period that is a vector" refused "a number is needed" "kick a every (T, T) { x' = 0 }"
check "a kick without a period" refused "a name and a period" "kick a: x { x' = 0 }"
check "a parameter that is set" refused "an event can set" "kick a every T { v = 0 }"
sed 's/param T = 1 > 0/param T = 1/' "$TMP/rotor.lag" >"$TMP/any.lag"
check "a period of 0" says 2 "must be positive" "$LAGC" run "$TMP/any.lag" T=0
check "backwards" fails "run forwards" $map --until -5
# The example in the head of a header is a program: 201 kicks of the map, whose free motion rk4 follows exactly.
header_follows() {
  "$LAGC" header $map --prefix rotor -o "$TMP/standard_map.h" && { echo '#include <stdio.h>'; sed -n 's/^ \*   \(#.*\)/\1/p' "$TMP/standard_map.h"; echo 'int main(void) {'; sed -n '/^ \*   rotor_params p;/,/^ \*   printf/s/^ \* //p' "$TMP/standard_map.h"; echo 'return 0; }'; } >"$TMP/head.c" &&
    "$CC" -std=c99 -O0 -iquote "$TMP" "$TMP/head.c" -lm -o "$TMP/head" &&
    "$TMP/head" | awk 'BEGIN { q = 1; p = 0.3; for (i = 0; i < 201; i++) { q += p; p -= 0.9*sin(q) } } { print $1, q; exit !($1 - q < 1e-5 && q - $1 < 1e-5) }'
}
check "a header, by the example in its head" header_follows
check "a header for a solver" says 2 'only of models with no kicks' "$LAGC" header $map --for gsl -o "$TMP/none.h"
check "gsl's methods" says 2 "events" "$LAGC" run $map --method gsl-rk8pd
tap_end
