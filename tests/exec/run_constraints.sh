#!/bin/sh
# Models with constraints, from the .lag file to the run: steps, outputs and states after events obey the constraints; starts are moved to
# them, and the report says so; impossible requests are refused. Expected values: closed forms, the same system in coordinates without
# constraints, published rules.
. tests/tap.sh
models=tests/exec/models

run() { "$LAGC" run "$@" >"$TMP/out" 2>"$TMP/err"; }
says() { # says WORDS ARGS...
  words=$1
  shift
  run "$@" && grep -q -e "$words" "$TMP/out"
}
refused() { # refused WORDS ARGS...: with exit status 2, and no file is left
  words=$1
  shift
  rm -f "$TMP/rows.csv"
  run "$@" -o "$TMP/rows.csv"
  [ $? = 2 ] && grep -qF -e "$words" "$TMP/err" && [ ! -e "$TMP/rows.csv" ]
}
# number NAME: value in the JSON report; within A B D: |A - B| <= D
number() { sed -n "s/.*\"$1\": \\([-+0-9.e]*\\)[,}].*/\\1/p" "$TMP/out"; }
within() { awk -v a="$1" -v b="$2" -v d="$3" 'BEGIN { x = a - b; exit !(a != "" && x*x <= d*d) }'; }
ends() { # ends WITHIN NAME=VALUE... -- ARGS...: a run ends at these values, on the constraints up to rounding
  tolerance=$1
  shift
  wanted=
  while [ "$1" != -- ]; do
    wanted="$wanted $1"
    shift
  done
  shift
  run "$@" --json || return 1
  within "$(number constraint_residual)" 0 1e-14 && within "$(number constraint_rate_residual)" 0 "${rates:-3e-14}" || return 1
  for pair in $wanted; do
    within "$(number "${pair%%=*}")" "${pair#*=}" "$tolerance" || { echo "${pair%%=*}: $(number "${pair%%=*}"), not ${pair#*=}"; return 1; }
  done
}

# ---- the double pendulum, against its two angles
"$LAGC" run models/double_pendulum.lag th1=1 th2=-0.5 --until 3 --method dop853 --tol 1e-13 --json >"$TMP/out"
x=$(awk -v a="$(number th1)" 'BEGIN { printf "%.15g", sin(a) }')
y=$(awk -v a="$(number th1)" -v b="$(number th2)" 'BEGIN { printf "%.15g", -cos(a) - cos(b) }')
for scene in swing ${SLOW:+thrice}; do
  # tolerance times the growth of errors along this motion; the last one by its order
  check "$scene by rk45" ends 1e-6 "r\\[1\\].x=$x" "r\\[2\\].y=$y" -- $models/two_rods.lag $scene --method rk45
  check "$scene by dop853" ends 1e-9 "r\\[1\\].x=$x" "r\\[2\\].y=$y" -- $models/two_rods.lag $scene --method dop853 --tol 1e-12
  check "$scene by rk4" ends 1e-8 "r\\[1\\].x=$x" "r\\[2\\].y=$y" -- $models/two_rods.lag $scene --method rk4 --step 1e-3
  check "$scene by verlet8" ends 1e-9 "r\\[1\\].x=$x" "r\\[2\\].y=$y" -- $models/two_rods.lag $scene --method verlet8 --step 1e-2
  check "$scene by variational" ends 2e-3 "r\\[1\\].x=$x" "r\\[2\\].y=$y" -- $models/two_rods.lag $scene --method variational --step 1e-3
done
check "what was not set moves, and the report says so" says 'start moved to the constraints: y from 0 to 0.8 m' $models/rod.lag below
check "velocities, too" says "  and y' from 0 to -0.6 m/s" $models/rod.lag below
cat >"$TMP/loop.lag" <<'END'
model loop
coord a, b, c
kinetic = a'^2/2 + b'^2 + c'^2/2 + a'*b'*cos(a - b)
potential = -2*cos(a) - cos(b) - cos(c)
constraint l: sin(a) + sin(b) - sin(c) = 0
scene s { start a' = -0.93; span 3 }
END
# rk4 differs from a run with a tolerance of 1e-14 by 6.5e-8, at hundredths of a second; the second run of an estimate, whose start is off by roundings, is assembled alike
check "what was not set is open in the second run of an error estimate, too" says 'error about [12]e-07' "$TMP/loop.lag" s --method rk4 --step 0.0197
check "what was set stays" says '"start_moved": {"y": \[0, 0.80*[0-9]*\], "y.": \[0, -0.[56][0-9]*\]}' $models/rod.lag below --json
check "what follows from others is named" says 'constraints: 3, 2 independent at the start; redundant: sum' $models/two_rods.lag thrice
check "and in the JSON report" says '"rank": 2, "redundant": \["sum"\]' $models/two_rods.lag thrice --json

# ---- RATTLE: digits of the algorithm in 60-digit arithmetic (tests/unit/test_rt_constraints.c)
check "verlet is RATTLE" ends 1e-11 x=0.2692700072386528 y=-0.9630647243055349 "x'=-4.185581063924644" "y'=-1.170275906630961" -- \
  $models/rod.lag drop --method verlet --step 0.01
slow check "in long double, too" says 'constraint residual: [0-9.]*e-19, of rates [0-9.]*e-1[89]' $models/rod.lag drop --method verlet --step 0.01 --precision long
slow check "dop853 in long double" says 'constraint residual: [0-9.]*e-19, of rates [0-9.]*e-1[89]' $models/rod.lag drop --method dop853 --tol 1e-15 --precision long

# ---- through positions where all bars lie in one line: b stays 0, the cranks are one pendulum
for m in rk45 dop853 ${SLOW:+"variational --step 1e-3"} "variational --step 1.1e-2" ${SLOW:+"verlet4 --step 1e-2"}; do
  check "four bars by $m" ends 1e-9 "b\\[1\\]=0" "b\\[2\\]=0" -- $models/four_bars.lag --method $m
  check "their energy" within "$(number energy_drift)" 0 2.2e-4 # of order 2: 121 times the 1.5e-6 of the step that is 11 times smaller is 1.8e-4
done

# 40 in a row, so many that a band solver is used. Near 10 s all links come to lie on one line: there rates are not corrected along
# the remaining 6e-6 = eps^(1/3) of a constraint, where steps err by 1e-8 (cf. the energy): 6e-14 for each link of 80 at random.
rates=5e-13
slow check "forty four-bars" ends 1e-7 "apart=0" -- tests/hard/cases/mbs_a02_fourbar_N10.lag -D N=40 --method dop853 --tol 1e-10
slow check "their energy" within "$(number energy_drift)" 0 1e-8
rates=

# ---- a tolerance that no step near there can keep: the run passes, or says in seconds where it creeps
passes_or_says() { # with another rounding the run may pass
  timeout 120 "$LAGC" run tests/hard/cases/mbs_a02_fourbar_N2.lag --method 'dop853(atol=1e-15)' --tol 1e-15 --no-gsl >"$TMP/out" 2>&1
  case $? in
    0) return 0 ;;
    3) grep -q 'the last 10000 steps advanced the time by only [0-9.e-]* s: constraint [a-z]*\[.\] (line [0-9]*) is within .* a larger tolerance, or steps of equal size' "$TMP/out" && grep -q 'constraint residual: [0-9.]*e-1[56]' "$TMP/out" ;;
    *) return 1 ;;
  esac
}
check "steps that creep end" passes_or_says

# ---- held at rest where all coordinates are 0, so that no coordinate gives a scale: impulses are found all the same
cat >"$TMP/at_rest.lag" <<'EOF'
model at_rest "Held at 0 on all sides, where nothing shows a length: by forms in x, y, z, and by distances whose terms are constants"
coord x [m], y [m], z [m], a [rad]
param m = 1 [kg] > 0, g = 9.81 [m/s^2] > 0, l = 1 [m] > 0, J = 0.3 [kg*m^2] > 0
kinetic = m/2*(x'^2 + y'^2 + z'^2) + J/2*a'^2
potential = m*g*(y + 0.37*x + 0.11*z)
effect forms {
  constraint one: 0.3*x + 0.7*y + 0.1*z = 0 [m]
  constraint two: 0.7*x - 0.3*y + 0.2*z = 0 [m]
  constraint three: 0.7*x + 0.2*y - 0.6*z = 0 [m]
}
effect distances {
  constraint circle: (x + 0.6*l)^2 + (y + 0.8*l)^2 = l^2
  constraint other: 0.3*x + 0.7*y + x*y/l = 0 [m]
  constraint plane: z = 0.2*x
}
effect tied {
  constraint sine: x = l*sin(a)
  constraint cosine: y = l*(1 - cos(a))*0.7 + 0.1*x
  constraint turn: a = 0.1*x/l
  constraint third: z = 0.3*x - 0.1*y
}
scene forms { use forms; span 1 [s]; output x, y, z, a every 0.1 [s] }
scene distances { use distances; span 1 [s]; output x, y, z, a every 0.1 [s] }
scene tied { use tied; span 1 [s]; output x, y, z, a every 0.1 [s] }
EOF
still() { # no coordinate moves by more than rounding of lengths of 1
  "$LAGC" run "$TMP/at_rest.lag" "$@" --quiet -o "$TMP/rows.csv" || return 1
  awk -F, 'NR > 1 { for (i = 2; i <= 4; i++) if (!($i*$i < 1e-30)) { print; bad = 1 } } END { exit bad || NR < 12 }' "$TMP/rows.csv"
}
for scene in forms distances tied; do
  for m in variational verlet verlet4 symplectic_euler; do
    one_of 6 || continue
    check "at rest: $scene, $m" still $scene --method $m --step 1e-3
    check "by long steps: $scene, $m" still $scene --method $m --step 0.02
  done
done

# ---- stiff: a pendulum in honey, m x'' = -c x' + ...; c th' = -m g sin(th)/l up to (m/c)^2 g/l = 1e-9, so tan(th/2) = e^(-m g t/(c l))
cat >"$TMP/honey.lag" <<'EOF'
model honey "A pendulum in honey, in Cartesian coordinates"
coord x [m], y [m]
param m = 1 [kg] > 0, g = 9.81 [m/s^2], l = 1 [m] > 0, c = 1e5 [N*s/m]
lagrangian = m/2*(x'^2 + y'^2) - m*g*y
dissipation = c/2*(x'^2 + y'^2)
constraint rod: x^2 + y^2 = l^2
scene sinks { start x = 1 [m]; span 10000 [s]; output x, y every 100 [s] }
EOF
sinks=$(awk 'BEGIN { a = 2*atan2(exp(-0.981), 1); printf "%.15g", sin(a) }')
check "stiff, by radau" ends 1e-8 "x=$sinks" -- "$TMP/honey.lag" --method radau --tol 1e-11
steps=$(number steps)
check "in long steps" within "$steps" 0 5000 # dop853 needs 10^8: its steps are below 6 m/c
on_the_rod() { "$LAGC" run "$TMP/honey.lag" --method radau --tol 1e-8 --quiet -o "$TMP/rows.csv" && awk -F, 'NR > 1 { c = $2*$2 + $3*$3 - 1; if (c*c > 1e-30) { print; bad = 1 } } END { exit bad || NR < 100 }' "$TMP/rows.csv"; }
check "rows between steps lie on the constraint" on_the_rod

# ---- constraints of velocities
check "a ball on a turntable by dop853" ends 1e-8 x=0.3044234691 y=0.0017758793 -- $models/rolling_ball.lag --tol 1e-10
check "by a rule of order 2" says 'exact x: largest deviation [0-9.]*e-0[6-9]' $models/rolling_ball.lag --method variational --step 0.01
check "by one of order 4" says 'exact x: largest deviation [0-9.]*e-1[0-9]' $models/rolling_ball.lag --method verlet4 --step 0.01

# A bead on x*y' = y*x', a line through the origin, where the constraint's coefficients vanish and change their sign. On y = x/2 with the
# masses 1 and 2: 3/2 x'' = -3 x - 0.35, so x = -7/60 + 67/60 cos(sqrt(2) t), here at 10.
cat >"$TMP/origin.lag" <<'END'
model origin
coord x [m], y [m]
param m = 1 [kg] > 0, M = 2 [kg] > 0, k = 3 [N/m], c = 0.7 [N]
kinetic = m/2*x'^2 + M/2*y'^2
potential = k/2*x^2 + c*y
constraint ratio: x*y' = y*x'
scene s { start x = 1, y = 0.5; span 10; output x, y every 10 }
END
through() { # WITHIN METHOD
  run "$TMP/origin.lag" --method "$2" --step 1e-3 -o "$TMP/rows.csv" --quiet && within "$(awk -F, 'END { print $2 }' "$TMP/rows.csv")" -0.12221500604804831 "$1" &&
    within "$(awk -F, 'END { print $3 }' "$TMP/rows.csv")" -0.061107503024024155 "$1"
}
for method in rk45 rk4; do check "coefficients that change their sign: $method" through 1e-8 $method; done

# ---- constraints of velocities that keep a function of positions keep it to rounding: x^2 + y^2, without trend (as rates alone it is 9e-6
# off by then); and u - r th - V sin(w t)/w, of terms that grow to 1e6. An event that moves positions moves to other values.
kept() { # LEN
  run $models/kept.lag "$1" --method "$2" $3 -o "$TMP/rows.csv" --quiet && awk -F, -v t="$4" 'NR > 1 {
    l = $2 - ($1 > 500 ? 0.5 : 1); s = $3 - 0.1; if (l*l > t*t || s*s > 1e-18) { print; bad = 1 } } END { exit bad || NR < 6 }' "$TMP/rows.csv"
}
check "what a rate keeps is kept: rk45" kept go rk45 "--tol 1e-6" 1e-15
check "after an event, too" kept cut rk45 "--tol 1e-6" 1e-15
check "dop853" kept cut dop853 "--tol 1e-9" 1e-15
slow check "variational" kept cut variational "--step 1e-2" 1e-10 # Newton's method ends where all coordinates together are rounding
keeps() { "$LAGC" check $models/kept.lag go >"$TMP/out" && grep -qF 'constraint rod keeps x^2/2 + y^2/2 as it is' "$TMP/out" && grep -qF 'constraint roll keeps u - r*th - V*sin(w*t)/w as' "$TMP/out" && ! grep -q 'blade keeps' "$TMP/out"; }
check "lagc check says what they keep" keeps

# ---- rows between steps, and states after events
worst() { awk -F, 'NR > 1 { c = $2*$2 + $3*$3 - 1; r = $2*$4 + $3*$5; c = c < 0 ? -c : c; r = r < 0 ? -r : r; m = c > m ? c : m; m = r > m ? r : m } END { exit !(m < 4e-15) }' "$TMP/rows.csv"; }
for m in rk4 rk45 dop853 variational verlet; do
  check "rows of $m" run $models/rod.lag drop --method $m --every 0.003 -o "$TMP/rows.csv"
  check "lie on the constraint" worst
done
# At y = -1/2, v^2 = g l; the event halves x' and stops y', which leaves v/4; the rod keeps the part along the circle, v/8, so x' = v/16.
check "an event that moves velocities off the constraint" ends 10 x=0 -- $models/rod.lag hit --events "$TMP/events.csv"
check "leaves the part that is along it" sh -c 'tail -1 "$1" | awk -F, "{ d = \$9 + sqrt(9.81)/16; exit !(d*d < 1e-16) }"' - "$TMP/events.csv"

# ---- bad input
check "exactly" refused 'the start contradicts its constraints: constraint rod (line 6) is off by 0.21 m^2' $models/rod.lag exact
check "no start at all" refused 'no start obeys the constraints' $models/rod.lag far
check "with the constraint's line" grep -q '(line [67])' "$TMP/err"
for m in gauss taylor; do
  check "$m refuses" refused "method $m cannot hold constraints (rod); rk45, dop853 and variational can" $models/rod.lag drop --method $m
done
check "so do Galerkin methods of higher order" refused 'with constraints it is 2' $models/rod.lag drop --method 'variational(order=4)'
check "and variational has no tangent" refused 'method variational has no derivative of its steps with constraints; dop853, rk45, rk4 and radau have' $models/rod.lag drop --tangent --method variational
cannot() { # cannot WORDS COMMAND...
  words=$1
  shift
  "$LAGC" "$@" >"$TMP/out" 2>"$TMP/err"
  [ $? = 2 ] && grep -qF -e "$words" "$TMP/err"
}
check "nor Lyapunov exponents" cannot 'method verlet has no derivative of its steps with constraints' lyapunov $models/rod.lag drop --method verlet
check "a step that is too long" sh -c '"$0" run "$1" drop --method variational --step 0.6 2>&1 | grep -qE "no impulse was found.*take smaller steps|the step is too long"' "$LAGC" $models/rod.lag
check "without a method, one that can is chosen" says 'method dop853' $models/rod.lag drop --tol 1e-12

# ---- a run that is saved and resumed is the same run
run $models/rod.lag drop --method variational --step 0.01 --until 5 --save-state "$TMP/state" && run $models/rod.lag drop --resume "$TMP/state" --until 10 --json
whole=$(number x)
run $models/rod.lag drop --method variational --step 0.01 --json
is "resumed bit by bit" "$(number x)" "$whole"
run $models/kept.lag cut --until 5 --save-state "$TMP/state" && run $models/kept.lag cut --resume "$TMP/state" --until 10 --json
whole=$(number x)
run $models/kept.lag cut --until 10 --json
is "with what constraints keep" "$(number x)" "$whole"

# A constraint on velocities that keeps a function of positions and t: d/dt (x - t^2 y - w t) = 0.
printf 'model leaf\ncoord x, y\nparam w = 2\nkinetic = x'"'"'^2/2 + y'"'"'^2/2\nconstraint c: x'"'"' = 2*t*y + t^2*y'"'"' + w\nscene s { start y = 1; span 3 }\n' >"$TMP/leaf.lag"
leaf() { "$LAGC" check "$TMP/leaf.lag" >"$TMP/out" 2>&1; cat "$TMP/out"; grep -q 'constraint c keeps x - t^2\*y - w\*t as it is at the start' "$TMP/out"; }
check "a constraint on velocities that keeps a function of t, too" leaf
tap_end
