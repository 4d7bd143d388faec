#!/bin/sh
# Several scenes or methods in one picture: `lagc plot MODEL SCENE SCENE`, `--method NAME,NAME`. An oscillator, whose steps have closed forms: with w = 2 and
# steps h, Euler's method multiplies x + i x'/w by 1 - i w h, so that after n steps its size is (1 + w^2 h^2)^(n/2).
. tests/tap.sh
. tests/exec/lib_oscillator.sh
oscillator <<'END'
effect drag { param c = 1 [1/s]; dissipation = c/2*x'^2; observe loss [m^2/s^3] = c*x'^2 }
scene swing { start x = 1; span 2; tolerance 1e-10; output x, x' every 0.1 }
scene far { like swing; start x = 3; output x, energy every 0.1 }
scene drag { like swing; use drag; output x, loss every 0.1 }
scene bare { like swing; output energy every 0.1 }
END
osc=$TMP/osc.lag pic=$TMP/a.svg
draws() { "$LAGC" plot "$@" -o "$pic" >"$TMP/out" 2>"$TMP/err" || { cat "$TMP/out" "$TMP/err"; return 1; }; }
legends() { sed -n '/^<path d=.*h20/{n;s/<[^>]*>//g;p;}' "$pic" | tr '\n' ';'; }
panels() { grep -c '^<rect x=' "$pic"; }
# end_of K: the last point of curve K, in the units of the axes; the frame is the last before it. fits LINE by two ticks of each axis.
end_of() {
  awk -v k="$1" '
    function number(s, key) { match(s, key "=\"[-0-9.]*\""); return substr(s, RSTART + length(key) + 2, RLENGTH - length(key) - 3) + 0 }
    /^<rect x=/ { nx = ny = 0 }
    /^<text .*text-anchor="middle">/ { v = $0; gsub(/<[^>]*>/, "", v); nx++; px[nx] = number($0, "x"); vx[nx] = v + 0 }
    /^<text .*text-anchor="end">/ { v = $0; gsub(/<[^>]*>/, "", v); ny++; py[ny] = number($0, "y") - 5; vy[ny] = v + 0 }
    /^<path fill="none"/ && ++n == k {
      sub(/.* d="/, ""); sub(/".*/, ""); gsub(/[ML]/, " "); m = split($0, c, " ")
      print vx[1] + (c[m - 1] - px[1])*(vx[nx] - vx[1])/(px[nx] - px[1]), vy[1] + (c[m] - py[1])*(vy[ny] - vy[1])/(py[ny] - py[1])
    }' "$pic"
}
ends() { # CURVE X Y, within a pixel
  echo "$(end_of "$1"), expected $2 $3"
  end_of "$1" | awk -v x="$2" -v y="$3" '{ a = $1 - x; b = $2 - y } END { exit !(NR == 1 && a*a + b*b < 2e-4) }'
}

check "three methods in phase space" draws "$osc" --phase x --method 'euler, symplectic_euler,verlet' --step 0.1
is "one panel" 1 "$(panels)"
is "a legend" "euler;symplectic_euler;verlet;" "$(legends)"
# 20 steps of w h = 0.2: size 1.04^10, angle 20 atan(0.2)
check "Euler's curve ends at its closed form" ends 1 "$(awk 'BEGIN { print 1.04^10*cos(20*atan2(0.2, 1)) }')" "$(awk 'BEGIN { print -2*1.04^10*sin(20*atan2(0.2, 1)) }')"
# both others turn by 2 asin(w h/2) a step: a kick of -w h x, a drift; verlet: with half a kick at each end
check "symplectic Euler's, too" ends 2 "$(awk 'BEGIN { a = atan2(0.1, sqrt(0.99)); print cos(41*a)/cos(a) }')" "$(awk 'BEGIN { a = atan2(0.1, sqrt(0.99)); print -2*sin(40*a)/cos(a) }')"
check "and verlet's" ends 3 "$(awk 'BEGIN { a = atan2(0.1, sqrt(0.99)); print cos(40*a) }')" "$(awk 'BEGIN { a = atan2(0.1, sqrt(0.99)); print -2*cos(a)*sin(40*a) }')"
check "a line a run" grep -q '^verlet  *reached t = 2 s, 20 steps, energy drift 0.00' "$TMP/out"
check "the scale of its drift is said, once" [ "$(grep -c 'relative to the larger of |E0| and the median' "$TMP/out")" = 1 ]
check "the energy that Euler's method gains is warned of" grep -q 'warning: euler: up to t = 2 s the energy has an error of' "$TMP/err"
cp "$osc" "$TMP/kept.lag" && echo 'scene watched { like swing; monitor energy 1e-6 }' >>"$osc"
check "a monitor does not end a rough method's run beside others" draws "$osc" watched --phase x --method euler,verlet --step 0.1
is "both are whole" 2 "$(grep -c 't = 2 s, 20 steps' "$TMP/out")"
"$LAGC" plot "$osc" watched --phase x --method euler --step 0.1 -o "$pic" >"$TMP/out"
is "that of one method it ends" "3 FAILED: monitor energy" "$? $(grep -o 'FAILED: monitor energy' "$TMP/out")"
is "with a way on" 1 "$(grep -c 'FAILED: .*; with --no-monitors the run goes on past it$' "$TMP/out")"
check "that leads on" draws "$osc" watched --phase x --method verlet --step 0.1 --vs x=2 --no-monitors
is "both values, whole" 2 "$(grep -c 't = 2 s, 20 steps' "$TMP/out")"
check "the same way in a warning" says 3 'up to its end; with --no-monitors the run goes on past it' "$LAGC" plot "$osc" watched --phase x --method verlet --step 0.1 --vs x=2 -o "$pic"
mv "$TMP/kept.lag" "$osc"
check "options of their own" draws "$osc" --y x --method 'euler(step=0.04),euler(step=0.02)' --quiet
is "stand in the legend" "euler(step=0.04);euler(step=0.02);" "$(legends)"
check "and act" ends 1 2 "$(awk 'BEGIN { print 1.0064^25*cos(50*atan2(0.08, 1)) }')"

check "methods that need derivatives of L have them" draws "$osc" --y x --method 'euler(step=0.01),variational(step=0.01, order=4),radau,taylor'
is "all four" 4 "$(legends | tr -cd ';' | wc -c)"

check "two expressions of one run" draws "$osc" --y x --y "2*x" --method verlet --step 0.1
is "are two curves" "x;2*x;" "$(legends)"
check "one ends at verlet's x" ends 1 2 "$(awk 'BEGIN { a = atan2(0.1, sqrt(0.99)); print cos(40*a) }')"
check "the other at twice that" ends 2 2 "$(awk 'BEGIN { a = atan2(0.1, sqrt(0.99)); print 2*cos(40*a) }')"
check "over another axis" draws "$osc" --x x --y "x'" --y "2*x"
is "two paths" "x';2*x;" "$(legends)"
check "the axis has both names" grep -q ">x', 2\*x" "$pic"
check "of two runs" draws "$osc" swing far --y x --y "2*x"
is "four curves" "x, swing;x, far;2*x, swing;2*x, far;" "$(legends)"
check "two scenes" draws "$osc" swing far --y x
is "are named" "swing;far;" "$(legends)"
check "one ends at cos 4" ends 1 2 -0.653644
check "the other at three times that" ends 2 2 -1.960931
check "an expression of each" draws "$osc" swing drag --x x --y "x*x'"
check "a parameter for both" draws "$osc" swing far k=1 --y x
check "acts in both" ends 2 2 "$(awk 'BEGIN { print 3*cos(2) }')"
check "all outputs: those that the scenes have in common" draws "$osc" swing far
is "one panel of x" "x, swing;x, far;" "$(legends)"
check "others are named" grep -q "note: x' is no output of far" "$TMP/err"
check "of each scene" grep -q "note: energy is no output of swing" "$TMP/err"
check "scenes times methods" draws "$osc" swing far --method verlet,rk4 --y x
is "each with both names" "swing, verlet;swing, rk4;far, verlet;far, rk4;" "$(legends)"
check "other values beside" draws "$osc" swing k=1 --vs x=2 --vs 'k=9 [1/s^2]' --y x
is "are named; the first by its scene" "swing;x=2;k=9;" "$(legends)"
check "the given value holds" ends 1 2 "$(awk 'BEGIN { print cos(2) }')"
check "in the others, too" ends 2 2 "$(awk 'BEGIN { print 2*cos(2) }')"
check "unless theirs is another" ends 3 2 "$(awk 'BEGIN { print cos(6) }')"
check "a given value beside others of its name" draws "$osc" swing x=1 --vs x=2 --y x
is "is named by it" "x=1;x=2;" "$(legends)"
check "two scenes, two values" draws "$osc" swing far --vs k=1 --y x
is "are four runs" "swing;swing, k=1;far;far, k=1;" "$(legends)"
check "what is no value" says 2 '--vs x: write name=value' "$LAGC" plot "$osc" --vs x
check "an unknown name" says 2 'q' "$LAGC" plot "$osc" --vs q=1
check "a run has none" says 2 '`--vs` is an option of `lagc plot`' "$LAGC" run "$osc" --vs x=1
check "no output in common" says 2 'no output in common' "$LAGC" plot "$osc" swing bare -o "$pic"
# The same name in two effects, in other units: not one axis for both
cat >"$TMP/units.lag" <<'END'
model units
coord x [m]
param m = 1 [kg] > 0, k = 1 [N/m]
lagrangian = m/2*x'^2 - k/2*x^2
effect drag { param c = 1 [kg/s]; dissipation = c/2*x'^2; observe loss [W] = c*x'^2 }
effect wind { param f = 1 [N]; force x = f; observe loss [N] = f }
scene a { start x = 1 [m]; span 2 [s]; use drag; output x, loss every 0.1 [s] }
scene b { start x = 1 [m]; span 2 [s]; use wind; output x, loss every 0.1 [s] }
END
other="note: loss is in [W] in a and in [N] in b"
check "scenes with an output in two units" draws "$TMP/units.lag" a b
is "show those in one" "x, a;x, b;" "$(legends)"
is "the other is noted, once" 1 "$(grep -c -F "$other" "$TMP/err")"
check "an output in two units alone" says 2 'no output in common' "$LAGC" plot "$TMP/units.lag" a b --y loss -o "$TMP/none.svg"
check "is noted" grep -q -F "$other" "$TMP/err"
check "as an abscissa, too" says 2 "$other" "$LAGC" plot "$TMP/units.lag" a b --x loss --y x -o "$TMP/none.svg"
check "not with --quiet" sh -c '! "$0" plot "$1" a b --quiet -o "$2" 2>&1 | grep note' "$LAGC" "$TMP/units.lag" "$pic"
check "names of a file from all scenes" sh -c 'cd "$1" && case $0 in /*) l=$0 ;; *) l=$2/$0 ;; esac; "$l" plot osc.lag swing far --y x --quiet && test -e osc_swing_far.svg' "$LAGC" "$TMP" "$PWD"

cat >"$TMP/falls.lag" <<'END'
model falls
state z
flow z' = z^2
scene s { start z = 1; span 2; output z every 0.1 }
END
check "a method that refuses the model is left out" draws "$TMP/falls.lag" --until 0.5 --y z --method rk4,verlet
check "by name" grep -q 'note: verlet is left out of the picture' "$TMP/err"
check "with its reason" grep -q 'method verlet cannot integrate a model with states' "$TMP/err"
check "if none is left, none is drawn" says 2 'no run is left to draw' "$LAGC" plot "$TMP/falls.lag" --y z --method verlet,gauss,variational -o "$TMP/none.svg"
check "a run that fails" draws "$TMP/falls.lag" --y z --method 'euler(step=0.5),rk45'
check "is drawn up to its end, with a warning" grep -q 'warning: rk45: at t = .*up to its end' "$TMP/err"
check "and said" grep -q '^rk45  *FAILED at t = 1 s' "$TMP/out"
check "where all fail, the status says so" says 3 'up to its end' "$LAGC" plot "$TMP/falls.lag" --y z --method rk45,dop853 -o "$pic"
check "one run that fails is drawn, too" says 3 'the step became too small' "$LAGC" plot "$TMP/falls.lag" --y z --method rk45 --quiet -o "$TMP/one.svg"
check "up to its end" test -s "$TMP/one.svg"

check "an unknown method" says 2 'unknown method rk5; did you mean rk4' "$LAGC" plot "$osc" --method euler,rk5 -o "$TMP/none.svg"
check "by another of its names" says 2 'unknown method leapfrog; did you mean verlet?' "$LAGC" plot "$osc" --method leapfrog -o "$TMP/none.svg"
check "one of several words" says 2 'did you mean symplectic_euler?' "$LAGC" plot "$osc" --method semi_implicit_Euler -o "$TMP/none.svg"
check "not a part of a word" says 2 'unknown method frog; --method help lists them' "$LAGC" plot "$osc" --method frog -o "$TMP/none.svg"
printf '%s\n' "model o" "coord x" "lagrangian = x'^2/2 - x^2/2" "scene s { start x = 1; method leapfrog }" >"$TMP/leapfrog.lag"
check "in a scene, too" says 1 'did you mean `verlet`?' "$LAGC" run "$TMP/leapfrog.lag"
check "the last of a list, before any runs" says 2 'unknown method yoshida4; ' "$LAGC" plot "$TMP/falls.lag" --method 'verlet(step=0.1), yoshida4' -o "$TMP/none.svg"
is "says nothing else" 0 "$("$LAGC" plot "$TMP/falls.lag" --method 'verlet(step=0.1), yoshida4' -o "$TMP/none.svg" 2>&1 | grep -c verlet)"
check "an unknown scene" says 1 'unknown scene `fra`' "$LAGC" plot "$osc" swing fra -o "$TMP/none.svg"
check "a run takes one scene" says 2 'two scenes are named: swing and far' "$LAGC" run "$osc" swing far
check "and one method" says 2 'several methods are for a picture' "$LAGC" run "$osc" --method euler,rk4
check "files of one run" says 2 '--events is for one run' "$LAGC" plot "$osc" swing far --events "$TMP/none.csv" -o "$TMP/none.svg"
check "nothing is left of these" [ -z "$(ls "$TMP"/none* 2>/dev/null)" ]
check "axes have the names of the quantities, the legend those of the runs" sh -c '"$0" plot models/pendulum.lag wide fading -o "$1" --quiet && grep -q ">pull \[N\]<" "$1" && grep -q ">pull, fading<" "$1"' "$LAGC" "$TMP/axes.svg"
check "the legend of a range has the digits that tell its values apart" sh -c '"$0" plot models/pendulum.lag --starts "th=1..1.00007:8" --phase th --until 1 -o "$1" --quiet && grep -q ">th=1.00004<" "$1"' "$LAGC" "$TMP/range.svg"
tap_end
