#!/bin/sh
# Scenes and effects; the command line, which says the same and takes precedence; closed forms; monitors. Expected values:
# closed forms, and equivalent scenes written in another way.
cd "$(dirname "$0")/../.." || exit 2
. tests/tap.sh
dir=$TMP/scenes
mkdir -p "$dir/parts"

# final NAME ARGUMENTS...: the final value of NAME in a run
final() {
  name=$1
  shift
  "$LAGC" run "$@" --json 2>"$dir/err" | sed -n "s/.*\"final\": {\\(.*\\)}}.*/, \\1/; s/.*, \"$name\": \\([-0-9.e+]*\\).*/\\1/p"
}
calc() { awk "BEGIN { e = exp(1); printf \"%.17g\", $1 }"; }

# Free particles with drag c and a wind w: x' = (v0 - w/c) exp(-c t/m) + w/c.
cat >"$dir/m.lag" <<'END'
model m "Free particles, in air when asked for"
const n = 3
coord x[n] [m], r: vec2 [m], b[2]: vec2 [m]
param m[n] = 1 [kg] > 0, mr = 2 [kg] > 0, half [kg] = mr/2
lagrangian = sum(i in 1..n, m[i]/2*x[i]'^2) + mr/2*dot(r', r') + sum(i in 1..2, half/2*dot(b[i]', b[i]'))
effect air {
  param c = 0.5 [N*s/m], twice = 2*c
  dissipation = c/2*x[1]'^2
  observe loss [W] = c*x[1]'^2
}
effect wind {
  requires air
  excludes storm
  param w = 1 [N]
  force x[1] = w
}
effect storm { param w = 3 [N]; force x[1] = w }
scene vacuum { start x[i in 1..n]' = i, r' = (1, 2), b[2]' = (0, 3); span 1 [s] }
scene drag { like vacuum; use air }
scene thick { like vacuum; use air(c = 2) }
scene thicker { like thick; air.c = 3 }
scene thin { air.c = 0.25; like thick }
scene windy { like thick; use wind(w = 2) }
scene calm { use none; like windy }
scene gale { use none, storm; like windy }
scene last { span 2 [s]; like vacuum }
scene again { like windy; use air(c = 1), wind }
END
m=$dir/m.lag

# ---- effects
near "no effect" 1e-12 1 "$(final 'x\[1\]' "$m" vacuum)"
near "an effect with its own value" 1e-9 "$(calc '2*(1 - e^-0.5)')" "$(final 'x\[1\]' "$m" drag)"
near "use air(c = 2)" 1e-9 "$(calc '(1 - e^-2)/2')" "$(final 'x\[1\]' "$m" thick)"
near "air.c = 3, after what it is like" 1e-9 "$(calc '(1 - e^-3)/3')" "$(final 'x\[1\]' "$m" thicker)"
near "like is first wherever it stands: air.c = 0.25 before it wins" 1e-9 "$(calc '4*(1 - e^-0.25)')" "$(final 'x\[1\]' "$m" thin)"
near "span before like wins" 1e-12 2 "$(final 'x\[1\]' "$m" last)"
# m = 1, c = 2, w = 2: v -> 1, which is v0
near "one that requires another" 1e-9 1 "$(final 'x\[1\]' "$m" windy)"
near "used again with another value" 1e-9 "$(calc '2 - (1 - e^-1)')" "$(final 'x\[1\]' "$m" again)"
near "use none turns off what the scene is like, and what was said of it" 1e-12 1 "$(final 'x\[1\]' "$m" calm)"
near "use none, then another" 1e-12 2.5 "$(final 'x\[1\]' "$m" gale)"
check "all scenes are well" "$LAGC" check "$m"
bad() { # NAME WORDS SCENE
  { cat "$m"; echo "$3"; } >"$dir/bad.lag"
  check "$1" says 1 "$2" "$LAGC" check "$dir/bad.lag"
}
bad "a missing requirement" 'the effect `wind` requires `air`' 'scene z { like vacuum; use wind }'
bad "effects that exclude each other" 'exclude each other' 'scene z { like windy; use storm }'
bad "the scene's own value of an effect that it does not use" 'not in use here: `use air`' 'scene z { like vacuum; air.c = 2 }'
bad "a value that the effect does not have" 'did you mean `air.twice`' 'scene z { use air(twicee = 2) }'
bad "a cycle of two" 'inherits from itself' 'scene y { like z }
scene z { like y }'
bad "a scene like none" 'unknown scene `nowhere`' 'scene z { like nowhere }'

# ---- the command line
near "a parameter of an effect" 1e-9 "$(calc '(1 - e^-2)/2')" "$(final 'x\[1\]' "$m" drag air.c=2)"
near "by its last name, where that is unique" 1e-9 "$(calc '(1 - e^-2)/2')" "$(final 'x\[1\]' "$m" drag c=2)"
near "over the scene" 1e-9 "$(calc '(1 - e^-1)')" "$(final 'x\[1\]' "$m" thick air.c=1)"
near "a member of a family" 1e-9 "$(calc '4*(1 - e^-0.5)*1')" "$(final 'x\[1\]' "$m" drag 'm[1]=2' c=1 "x[1]'=2")"
near "all of a family: parameters" 1e-9 "$(calc '2*(1 - e^-0.5)')" "$(final 'x\[1\]' "$m" drag m=2 c=1)"
near "all of a family: velocities" 1e-12 5 "$(final 'x\[3\]' "$m" vacuum "x'=5")"
near "and then one" 1e-12 7 "$(final 'x\[3\]' "$m" vacuum "x'=5" "x[3]'=7")"
near "the start of a member" 1e-12 12 "$(final 'x\[2\]' "$m" vacuum 'x[2]=10')"
near "a component" 1e-12 5 "$(final 'r.x' "$m" vacuum r.x=4)"
near "of a velocity" 1e-12 8 "$(final 'r.y' "$m" vacuum "r.y'=8")"
near "of a member" 1e-12 9 "$(final 'b\[2\].y' "$m" vacuum 'b[2].y=6')"
near "of all members" 1e-12 6 "$(final 'b\[1\].y' "$m" vacuum 'b.y=6')"
check "of the right sign" says 2 'declares m[1] > 0' "$LAGC" run "$m" m=-1
check "a vector as a whole is refused" says 2 'r has parts: set r.x' "$LAGC" run "$m" r=1
check "a member too many" says 2 'did you mean x[1]?' "$LAGC" run "$m" 'x[4]=1'
check "an effect as a whole" says 2 'air has parts: set air.c' "$LAGC" run "$m" drag air=1
check "an effect that is off" says 2 'effect storm is not in scene drag' "$LAGC" run "$m" drag storm.w=1
check "with a scene that has it" says 2 'or write one: scene drag_storm { like drag; use storm }' "$LAGC" run "$m" drag storm.w=1
check "a constant" says 2 'write -D n=5' "$LAGC" run "$m" n=5
# Energy at the end: `half` follows mr unless it is set.
near "a parameter that follows another" 1e-12 "$(calc '(1 + 4 + 9)/2 + 5*4/2 + 9*2/2')" "$(final energy "$m" vacuum mr=4)"
near "and is given" 1e-12 "$(calc '(1 + 4 + 9)/2 + 5*4/2 + 9/2')" "$(final energy "$m" vacuum mr=4 half=1)"

cat >"$dir/signs.lag" <<'END'
model signs
coord x [1]
param a = 1 > 0, b = 1 >= 0, c = -1 < 0, d = -1 <= 0
lagrangian = x'^2/2 + (a + b + c + d)*x
scene s { start x = 0 [1]; span 1 [s] }
END
# Each at -1/2, 0 and 1/2
for row in "a > no no yes" "b >= no yes yes" "c < yes no no" "d <= yes yes no"; do
  set -- $row
  name=$1 sign=$2
  shift 2
  for value in -0.5 0 0.5; do
    if [ "$1" = yes ]; then check "$name = $value, declared $sign 0" "$LAGC" run "$dir/signs.lag" $name=$value
    else check "$name = $value, declared $sign 0, is refused" says 2 "the model declares $name $sign 0" "$LAGC" run "$dir/signs.lag" $name=$value; fi
    shift
  done
done

# ---- names of effects
cat >"$dir/e.lag" <<'END'
model e "effects with names of their own"
coord x [m]
param m = 1 [kg] > 0, k = 4 [N/m], c = 7 [kg/s], v = (1, 2)
lagrangian = m/2*x'^2 - k/2*x^2
effect drag { param c = 1 [kg/s], w[2] = 1, u = (1, 2); dissipation = c/2*x'^2; observe cc = c + w[1]*0 [kg/s]; observe uu = u.y; observe ww = w[2] }
effect e1 { coord y [m]; lagrangian = m*y'^2/2 - k/2*y^2 }
effect e2 { coord y [m], z[2] [m]; lagrangian = m*y'^2/2 - k/2*y^2 + m/2*(z[1]'^2 + z[2]'^2) }
scene s { use drag(c=3); start x=1; span 1; output c, drag.c, cc, uu, ww every 1}
scene n6 { like s; use none; use drag }
scene n7 { like s; use none, drag }
scene n9 { like n6; use drag }
scene n10 { drag.c = 2; like n6 }
scene n11 { like s; drag.u.y = 9; drag.w[2] = 5 }
scene n12 { use drag(u.y = 8), e1, e2; start e1.y = 1 [m], e2.y = 2, e2.z[2] = 3, x = 4; span 1 }
scene n13 { like n12; use none; use e1; start y = 5 }
END
e=$dir/e.lag
first() { "$LAGC" run "$e" "$@" -o - --quiet 2>/dev/null | sed -n 2p | cut -d, -f2-; }
check "an effect's name may be one of the model, declared before it" "$LAGC" check "$e"
is "use drag(c = 3): the effect's c, not the model's" '7,3,3,2,1' "$(first s)"
is "use none drops what was said before: used again" '7,1,1,2,1' "$(first n6)"
is "in one statement" '7,1,1,2,1' "$(first n7)"
is "through one more scene" '7,1,1,2,1' "$(first n9)"
is "what is said after it stays" '7,2,2,2,1' "$(first n10)"
is "components and members in a scene" '7,3,3,9,5' "$(first n11)"
is "and on the command line" '7,3,3,4,6 7,3,3,4,6' "$(first s u.y=4 w=6) $(first s drag.u.y=4 'drag.w[1]=6' 'w[2]=6')"
is "coordinates of one name in two effects" "t [s],x [m],e1.y [m],e2.y [m],z[1] [m],z[2] [m]" \
  "$("$LAGC" run "$e" n12 -o - --quiet 2>/dev/null | sed -n 1p | cut -d, -f1-6)"
is "start somewhere" "4,1,2,0,3" "$(first n12 | cut -d, -f1-5)"
is "on the command line too" "4,7,2,0,3" "$(first n12 e1.y=7 | cut -d, -f1-5)"
is "one of them has its plain name, and starts of the others are dropped" "4,5,0,0" "$(first n13 | cut -d, -f1-4)"

# ---- momenta: m*(x' + l*th[1]') = 2, m*l^2*th[2]' = 36, m*r' = (2, 4), m*b[2]' = (6, 8)
cat >"$dir/p.lag" <<'END'
model p
coord x [m], th[2] [rad], r: vec2 [m], b[2]: vec2 [m]
param m = 2 [kg], l = 3 [m], q = 5 [kg*m/s]
let px = x + l*sin(th[1])
lagrangian = m/2*px'^2 + m*l^2/2*(th[1]'^2 + th[2]'^2) + m/2*(dot(r', r') + dot(b[1]', b[1]') + dot(b[2]', b[2]')) - 1 [N]*x
observe a = p_x
observe c[1] = p_th[2]
observe d = p_r + p_b[2]
expect p_x = m*px'
expect p_b[2].y = m*b[2].y'
scene s { start th[2]' = 2, x' = 1, r' = (1, 2), b[2]' = (3, 4); output a, c[1], d, p_x, p_th[2], p_r, p_r.x, p_b[1], p_b[2].y, l*p_x every 1; span 1 [s] }
END
is "momenta" "2,36,8,12,2,36,2,4,2,0,0,8,6" "$("$LAGC" run "$dir/p.lag" -o - --quiet 2>/dev/null | sed -n 2p | cut -d, -f2-)"
check "in expectations" sh -c '"$0" check "$1" | grep -q "2 of 2 expectations proved"' "$LAGC" "$dir/p.lag"

# ---- -D on every command
five() { "$@" 2>&1 | grep -q '1\.\.5\|x\[5\]\|x_5\|X_5\|7 coord\|ok'; }
has_five() { grep -q 'x\[5\]\|X_5' "$1"; }
check "-D n=5: derive" five "$LAGC" derive "$m" -D n=5
check "-Dn=5: emit" five "$LAGC" emit "$m" -Dn=5
check "-D: header" five "$LAGC" header "$m" -D n=5
check "-D: run" five "$LAGC" run "$m" -D n=5
check "-D: check" says 1 'out of range' sh -c 'sed "s/start x.i in 1..n./start x[3]/" "$1" >"$2/d.lag"; "$0" check "$2/d.lag" -D n=2' "$LAGC" "$m" "$dir"
"$LAGC" build "$m" -D n=5 -o "$dir/sim" && "$LAGC" plot "$m" -D n=5 --y 'x[5]' -o "$dir/p.svg" --quiet &&
  "$LAGC" animate "$m" -D n=5 --points 'x[5],r.x' -o "$dir/p.html" --quiet
check "-D: build" five "$dir/sim" "x[5]'=2"
check "-D: plot" has_five "$dir/p.svg"
check "-D: animate" has_five "$dir/p.html"

cat >"$dir/c.lag" <<'END'
model c "Constants of the command line"
const A = -2, h = 50 [cm], w = 2*3 [rad/s]
coord x [m], th [deg]
param a = A, b [m] = h, f = w
lagrangian = 1 [kg]/2*x'^2 + 1 [kg*m^2]/2*th'^2
scene s { start x = h; output a, b, f; span 1 }
scene minus { start th = -1/2 [deg] }
scene minuses { start th = --1/2 [deg] }
scene plus { start th = +1/2 [deg] }
END
c=$dir/c.lag
constants() { "$LAGC" run "$c" s -o - --quiet "$@" 2>/dev/null | sed -n 2p | cut -d, -f2-; }
is "-D: as declared" '-2,0.5,6' "$(constants)"
is "-D: signs" '-3,0.5,6 -0.5,0.5,6 3,0.5,6 3,0.5,6' "$(constants -D A=-3) $(constants -DA=-.5) $(constants -D A=+3) $(constants -D A=--3)"
is "-D: a bare number is in the declared unit, or that of the value" '-2,0.25,7' "$(constants -D h=25 -D w=7)"
is "-D: units and formulas" '6,0.02,0.5' "$(constants -D 'A=2*3' -D 'h=20[mm]' -D 'w=(A/12) [rad/s]')"
check "-D: a number without end" says 1 '-D A:1:' "$LAGC" check "$c" -D A=1e
check "-D: a sign alone" says 1 'expected an expression after' "$LAGC" check "$c" -D A=-
check "-D: an unknown name" says 1 'unknown name `B`' "$LAGC" check "$c" -D A=B
check "-D: the wrong unit" says 1 'this value is in [s]' "$LAGC" check "$c" -D 'h=2[s]'
check "-D: the wrong shape" says 1 '`h` is a number, and a vector of 2 components is given here' "$LAGC" check "$c" -D 'h=(1,2)'
near "a negative fraction has the unit" 1e-12 -0.5 "$(final th "$c" minus)"
near "with two signs" 1e-12 0.5 "$(final th "$c" minuses)"
near "with a plus" 1e-12 0.5 "$(final th "$c" plus)"

# ---- include: relative to the including file
printf 'model whole "in parts"\ninclude "parts/body.lag"\nscene s { span 2 [s] }\n' >"$dir/whole.lag"
printf 'include "../coords.lag"\nlagrangian = 1 [kg]/2*x%s^2 - 1 [N/m]/2*x^2\n' "'" >"$dir/parts/body.lag"
printf 'coord x [m]\ninclude "parts/body.lag"\n' >"$dir/coords.lag"
check "a cycle through two files" says 1 'includes itself' "$LAGC" check "$dir/whole.lag"
printf 'coord x [m]\n' >"$dir/coords.lag"
near "files in files" 1e-8 "$(calc 'cos(2)')" "$(final x "$dir/whole.lag" x=1)"
near "from another folder" 1e-8 "$(calc 'cos(2)')" "$(cd "$dir/parts" && case $LAGC in /*) ;; *) LAGC=$OLDPWD/$LAGC ;; esac && final x ../whole.lag x=1)"

# ---- closed forms
cat >"$dir/o.lag" <<'END'
model o "An oscillator, a turning wheel, a decay"
coord x [m], th [deg] periodic
state z
param m = 1 [kg] > 0, k = 4 [N/m] > 0
input push [N] = 0
let w = sqrt(k/m)
lagrangian = m/2*x'^2 - k/2*x^2 + 1 [kg*m^2]/2*th'^2
force x = push
flow z' = -z/(1 [s])
scene s {
  start x = 1, x' = 0.5 [m/s], th' = 100, z = 2
  output x, th every 0.5 [s]
  exact x = x(0)*cos(w*t) + x'(0)/w*sin(w*t) + push/k*(1 - cos(w*t)), x' = x'(0)*cos(w*t) - w*(x(0) - push/k)*sin(w*t)
  exact th = th(0) + th'(0)*t - 720 [deg], z = z(0)*exp(-t/(1 [s]))
  method rk4(step = 0.01)
  span 10 [s]
}
scene wrong { like s; exact x = 1.001*x(0)*cos(w*t) }
scene watched { monitor exact 1e-6; like s }
scene strict { like watched; monitor error(x) 1e-9 }
scene lax { like strict; monitor error(x) 1e-2 }
scene late { monitor (x^2 + (x'/w)^2) 1e-6; like s }
END
o=$dir/o.lag
deviation() { # NAME largest|final ARGUMENTS...
  name=$1 which=$2
  shift 2
  "$LAGC" run "$@" --json 2>"$dir/err" | sed -n "s/.*\"exact\": {\\(.*}\\)}.*/, \\1/; s/.*, \"$name\": {\\([^}]*\\)}.*/, \\1/; s/.*, \"$which\": \\([-0-9.e+]*\\).*/\\1/p"
}
# RK4 lags by t w (w h)^4/120 radians, a difference of that times the speed's amplitude, less its loss: 2nd order terms.
lag=$(calc '10*2*0.02^4/120')
# x = cos(2t) + sin(2t)/4 is late by lag t/10: by lag t/10 (sin(2t) - cos(2t)/4)
most=$(awk -v lag="$lag" 'BEGIN { for (t = 0; t <= 10; t += 0.01) { d = lag*t/10*(sin(2*t) - cos(2*t)/4); d = d < 0 ? -d : d; if (d > m) m = d }; printf "%.17g", m }')
near "the largest deviation is what RK4 errs" "$(calc "0.02*$lag")" "$most" "$(deviation x largest "$o" s)"
near "the final one has a sign" "$(calc "0.05*$lag")" "$(calc "$lag*(sin(20) - 0.25*cos(20))")" "$(deviation x final "$o" s)"
near "it follows start and parameters of the command line" 1e-7 0 "$(deviation x largest "$o" s x=3 "x'=-2" k=1)"
near "and inputs" 1e-7 0 "$(deviation x largest "$o" s push=2)"
near "an angle that is two turns off is none" 1e-9 0 "$(deviation th largest "$o" s)"
near "in declared units" 1e-9 1 "$(sed 's/- 720 \[deg\]/- 721 [deg]/' "$o" >"$dir/off.lag"; deviation th final "$dir/off.lag" s)"
near "a state" 1e-8 0 "$(deviation z largest "$o" s)"
near "a closed form that is wrong" 1e-4 "$(calc 'sqrt(0.001^2 + 0.25^2)')" "$(deviation x largest "$o" wrong)"
near "backwards" 1e-6 0 "$(deviation x largest "$o" s --until -5)"
check "the report says it" sh -c '"$0" run "$1" s | grep -q "^exact x: largest deviation 2.4[0-9]*e-08 m, final "' "$LAGC" "$o"
"$LAGC" run "$o" s --observe 'error(x)' --observe 'exact(x)' --observe '(x - exact(x))^2' -o "$dir/o.csv" --quiet
consistent() { awk -F, 'NR > 1 { d = $2 - $5 - $4; e = $4^2 - $6; if (d > 1e-16 || d < -1e-16 || e > 1e-25 || e < -1e-25) exit 1 } END { exit NR != 22 }' "$dir/o.csv"; }
check "columns: x, exact(x) and their difference" consistent
"$LAGC" run "$o" s --until 4 --save-state "$dir/state" --quiet
is "saved and resumed" "$(deviation x largest "$o" s) $(deviation x final "$o" s)" \
  "$(deviation x largest "$o" --resume "$dir/state") $(deviation x final "$o" --resume "$dir/state")"
check "header: what needs the start is left out" sh -c '"$0" header "$1" watched | grep -q "Those with closed forms.*left out"' "$LAGC" "$o"

# Temperatures: the table, the start and the constant are points on a scale, the deviation is a difference.
cat >"$dir/cup.lag" <<'END'
model cup "Coffee that cools in a room"
state T [degC]
param tau = 100 [s] > 0
input room [degC] = "room.csv"
flow T' = (room - T)/tau
event warm: T - 50 [degC] falling { T = T + 1 [K] }
scene s {
  start T = 80 [degC]
  exact T = room + (T(0) - room)*exp(-t/tau)
  output T, room, exact(T), error(T) every 10 [s]
  span 60 [s]
}
END
printf 't,room [degC]\n0,20\n50,20\n100,20\n' >"$dir/room.csv"
near "a table in degC" 1e-7 "$(calc '20 + 60*e^-0.6')" "$(final T "$dir/cup.lag")"
near "a start in degC" 1e-7 "$(calc '20 + 40*e^-0.6')" "$(sed 's/50 \[degC\]/0 [degC]/' "$dir/cup.lag" >"$dir/cold.lag"; final T "$dir/cold.lag" T=60)"
near "a constant in degC" 1e-7 "$(calc '30 + 50*e^-0.6')" "$(final T "$dir/cup.lag" room=30)"
near "a deviation in K" 1e-7 0 "$(deviation T final "$dir/cup.lag" room=30)"
is "columns of temperatures, and of a difference" 't [s],T [degC],room [degC],exact(T) [degC],error(T) [K]' "$("$LAGC" run "$dir/cup.lag" -o - 2>/dev/null | head -1)"
check "an event's log in degC" sh -c '"$0" run "$1" --until 80 --events - 2>/dev/null | grep -Eq "^69.31[0-9.]*,warm,(50|49.9999999)[0-9.]*,(51|50.99999)"' "$LAGC" "$dir/cup.lag"

# ---- monitors
check "a monitor that holds" "$LAGC" run "$o" watched --quiet
check "of a wrong closed form" says 3 ' is past its limit' "$LAGC" run "$o" watched --quiet k=1 --method 'rk4(step=1)'
check "a limit given once more is the new one" says 3 'past its limit 1e-09' "$LAGC" run "$o" strict --quiet
check "also when it is laxer" "$LAGC" run "$o" lax --quiet
check "a monitor before the outputs of another scene" "$LAGC" run "$o" late --quiet
is "adds to the outputs" "t [s],x [m],th [deg],x^2 + (x'/w)^2 [m^2]" "$("$LAGC" run "$o" late -o - 2>/dev/null | head -1)"
check "past its limit the run fails with status 3" says 3 "monitor x^2 + (x'/w)^2: drift" "$LAGC" run "$o" late --quiet --method 'rk4(step=0.1)'
check "what was computed stays" sh -c '! "$0" run "$1" late --quiet --method "rk4(step=0.5)" -o "$2/m.csv" 2>/dev/null && [ "$(wc -l <"$2/m.csv")" -gt 1 ]' "$LAGC" "$o" "$dir"
cat >"$dir/e.lag" <<'END'
model e
coord x
lagrangian = x'^2/2 - x^2/2
scene s { start x = 1; monitor energy 1e-6; span 10 }
END
cat >>"$dir/e.lag" <<'END'
scene dropped { like s; monitor none }
scene other { like s; monitor none, (x^2) 9 }
END
check "monitor none: no monitor" "$LAGC" run "$dir/e.lag" dropped --quiet --method 'rk4(step=0.5)'
check "and then another" "$LAGC" run "$dir/e.lag" other --quiet --method 'rk4(step=0.5)'
is "the column of what was dropped is gone" "t [s],x,x',energy,x^2" "$("$LAGC" run "$dir/e.lag" other --quiet -o - 2>/dev/null | sed -n 1p)"
check "a monitor without a limit" says 1 '`monitor energy` has no limit' sh -c 'echo "scene n { monitor energy }" | cat "$1/e.lag" - >"$1/h.lag"; "$0" check "$1/h.lag"' "$LAGC" "$dir"
check "an expression needs parentheses" says 1 'an expression in parentheses' \
  sh -c 'sed "s/energy 1e-6/x + 1 1e-6/" "$1/e.lag" >"$1/g.lag"; "$0" check "$1/g.lag"' "$LAGC" "$dir"
check "energy: rk45 holds it" "$LAGC" run "$dir/e.lag" --quiet
check "energy: rk4 with long steps does not" says 3 'monitor energy: drift' "$LAGC" run "$dir/e.lag" --quiet --method 'rk4(step=0.5)'
is "a scene with a monitor has the usual outputs" "t [s],x,x',energy" "$(sed 's/energy 1e-6/(x*x) 9/' "$dir/e.lag" >"$dir/f.lag"; "$LAGC" run "$dir/f.lag" -o - 2>/dev/null | head -1 | cut -d, -f1-4)"

# The work of forces is not part of the energy's drift; outputs have no such balance.
printf "model fade\ncoord x\nlagrangian = x'^2/2 - x^2/2\nforce x = -0.1*x'\nscene s { start x = 1; span 10; output x; monitor x 1e-3 }\n" >"$dir/fade.lag"
of_an_output() { says 3 "monitor x: drift" "$LAGC" run "$dir/fade.lag" --quiet --method gsl-rk8pd && ! grep -q "forces bring" "$TMP/err"; }
if [ -n "${GSL:-}" ]; then check "a monitor of the first output says nothing of forces" of_an_output; else skip "no GSL"; fi

# A method on the command line replaces the same method of the scene, with its options.
printf "model me\ncoord x\nlagrangian = x'^2/2 - x^2/2\nscene a { start x = 1; span 1; method rk4(step = 0.5) }\nscene b { like a; method dop853 }\n" >"$dir/method.lag"
is "options go with their method" "model me, scene b, method dop853(tol=1e-09)" "$("$LAGC" run "$dir/method.lag" b | head -1)"
# Emitted C lists the coordinates with closed forms, and no others.
printf "model cf\ncoord x, y\nlagrangian = (x'^2 + y'^2)/2 - (x^2 + y^2)/2\nscene s { start x = 1, y = 2; span 1; exact y = 2*cos(t) }\n" >"$dir/cf.lag"
is "the closed form is of coordinate 1" "static const int exact_of_s[] = {1};" "$("$LAGC" emit "$dir/cf.lag" | grep '^static const int exact_of')"
tap_end
