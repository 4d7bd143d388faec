#!/bin/sh
# Units in use, as TAP: inferred units, degrees Celsius, values with units on the command line. Expected numbers are closed forms, by awk.
cd "$(dirname "$0")/../.." || exit 2
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
cd "$TMP" || exit 2

# ---- inferred units ----
cat >found.lag <<'EOF'
model found "one unit is enough"
coord x [m], y
state q
param m [kg] = 1, k = 3, c = 0.1, l = 0.5, g = 9.81, w = 2, n = 2, R = 5, A = 1, free = 3, V0 = 2
param who[2] = {1, 2}
input u = A*sin(w*t)
function spring(x, k) = k/2*x^2
function len(a, b) = sqrt(a^2 + b^2)
lagrangian = m/2*(x'^2 + y'^2) - spring(x - l, k) - m*g*y - V0*(x/y)^(7/5)
dissipation = c/2*x'^2
force x = u
flow q' = (x/l)^n - q/R
observe r = len(x, y)
observe s = who[1]*x + y
event e: y + 2 [m] rising { x' = -x' }
effect more {
  param b = 2
  force y = -b*y'
}
scene s { start x = 1, y = 20 [cm], q = 1; use more; output x, y, y', r, s, u, q, b, free, energy }
EOF
found() { "$LAGC" check found.lag | sed -n 's/^units found: //p'; }
# By hand: k/2*x^2 and c/2*x'^2 beside m/2*x'^2, F = A, q' = 1 - q/R, (x/l)^n and x/y pure numbers.
is "units that were found" "y [m], q [s], k [kg/s^2], c [kg/s], l [m], g [m/s^2], w [1/s], n [1], R [s], A [N], V0 [J], who [1], u [N], more.b [kg/s]" "$(found)"
is "columns have the units that were found" "t [s],x [m],y [m],y' [m/s],r [m],s [m],u [N],q [s],b [kg/s],free,energy [J]" \
  "$("$LAGC" run found.lag -o - --quiet --until 0.1 | head -n 1)"
"$LAGC" build found.lag -o found
is "and so has --help" "parameters: m = 1 [kg], k = 3 [kg/s^2], c = 0.1 [kg/s], l = 0.5 [m], g = 9.81 [m/s^2], w = 2 [1/s], n = 2, R = 5 [s], A = 1 [N], free = 3, V0 = 2 [J], who[1] = 1, who[2] = 2, more.b = 2 [kg/s]" \
  "$(./found --help | grep '^parameters:')"
sed 's/^param m \[kg\]/param m/; s/coord x \[m\]/coord x/; s/2 \[m\]/2/' found.lag >bare.lag
is "a model in which nothing has a unit finds none" "" "$("$LAGC" check bare.lag | grep '^units found')"

# Units are printed as the model's author writes them.
sed 's/^param m/param stiff = 1 [N\/m], m/' found.lag >spelled.lag
check "found units are spelled as in the model" sh -c '"$0" check spelled.lag | grep -q "k \[N/m\]"' "$LAGC"

# Inferred units change texts only.
sed 's/, k = 3/, k = 3 [kg\/s^2]/; s/, c = 0.1/, c = 0.1 [kg\/s]/; s/coord x \[m\], y/coord x [m], y [m]/' found.lag >written.lag
programs() { "$LAGC" derive "$1" --format c; }
is "the same program as with written units" "$(programs written.lag)" "$(programs found.lag)"

# ---- kinetic energy in joules, potential in newtons ----
printf '%s\n' 'model m' 'coord x [m]' 'param m = 1 [kg] > 0, k = 2 [N/m]' "kinetic = m/2*x'^2" 'potential = k*x' >wrong.lag
check "J and N do not make a Lagrangian" says 1 'this is in [N], another part of the Lagrangian in [J]' "$LAGC" check wrong.lag
sed 's/ \[[^]]*\]//' wrong.lag | sed 's/ \[[^]]*\]//' >plain.lag
check "without units the same is accepted" "$LAGC" check plain.lag

# ---- degrees Celsius ----
cat >tea.lag <<'EOF'
model tea "Newton's law of cooling"
state T [degC]
param Ta = 20 [degC], k = 0.1 [1/min], start = 363.15 [K]
flow T' = -k*(T - Ta)
observe above [K] = T - Ta
observe sky [degC] = if(t < 1 [s], 20 [degC] - 5 [K], max(T, 0 [degC]))
scene s { start T = 90; span 30 [min]; tolerance 1e-12; output T, T', above, sky, Ta every 30 [min] }
scene kelvin { like s; start T = start }
EOF
# last row: T, T', above, sky, Ta at 30 min, within 1e-7: T = Ta + (90 - Ta) exp(-0.1*30), in degC.
cooled() { # START AMBIENT FILE
  awk -F, -v T0="$1" -v Ta="$2" 'function off(x, y) { return x - y > 1e-7 || y - x > 1e-7 }
    NR == 1 { if ($0 != "t [s],T [degC],T'"'"' [K/s],above [K],sky [degC],Ta [degC]") print "head: " $0 }
    NR == 2 && (off($2, T0) || off($5, 15)) { print "start: " $0 }
    END { T = Ta + (T0 - Ta)*exp(-3)
      if (NR != 3 || $1 != 1800 || off($2, T) || off($3, -(T - Ta)*0.1/60) || off($4, T - Ta) || off($5, T) || off($6, Ta)) print "end: " $0 ", not " T }' "$3"
}
run() { "$LAGC" run tea.lag "$@" -o tea.csv --quiet; }
run s && empty "degC in starts and outputs" "$(cooled 90 20 tea.csv)"
run kelvin && empty "a start in kelvin" "$(cooled 90 20 tea.csv)"
run s T=60 Ta=10 && empty "degC at the command line" "$(cooled 60 10 tea.csv)"
run s 'T=333.15 [K]' 'Ta=10 [degC]' && empty "kelvin at the command line" "$(cooled 60 10 tea.csv)"
"$LAGC" run tea.lag s --until 0.001 >report
check "the report counts in degC" grep -q '^  T  *89.99.* degC$' report

# ---- values with units ----
cat >pend.lag <<'EOF'
model pend "an angle in degrees, a length in centimetres"
coord th [deg] periodic
state q
param l = 50 [cm] > 0, g = 9.81 [m/s^2], r[2] = {1, 2} [m], e: vec2 = (1, 2) [m], ratio = 1, T0 = 20 [degC]
input u [N*m] = 0
lagrangian = l^2/2*th'^2 + g*l*cos(th)
force th = u/(1 [kg])
flow q' = -q/(1 [s])
effect drag {
  param c = 0.1 [m^2/s]
  dissipation = c/2*th'^2
}
scene s { use drag; start q = 1; span 1 [s]; output th, th', l, r, e, ratio, drag.c, u, q, T0 every 1 [s] }
EOF
given() { "$LAGC" run pend.lag -o - --quiet "$@" | sed -n 2p; }
is "declared units" "0,1,2,3,4,5,6,7,8,9,10,11,12" \
  "$(given th=1 "th'=2" l=3 'r[1]=4' 'r[2]=5' e.x=6 e.y=7 ratio=8 drag.c=9 u=10 q=11 T0=12)"
is "other units" "0,180,360,100,0.5,2000,0.01,1000,0.5,0.25,0.002,3,27" \
  "$(given 'th=1/2 [rev]' "th' = 1 [rev/s]" 'l=1[m]' 'r[1]=50 [cm]' 'r[2]=2[km]' 'e.x=1 [cm]' 'e.y=1 [km]' 'ratio=1/2' 'c=2500[cm^2/s]' 'u=2[mJ]' 'q=3[1]' 'T0=300.15[K]' |
     sed 's/,27[.0-9]*$/,27/')"
is "formulas" "0,90,1,2.5" "$(given 'th=180/2' 'ratio=2*pi/(2*pi)' 'q=5/2' | awk -F, '{ print $1 "," $2 "," $9 "," $12 }')"
rows_at() { "$LAGC" run pend.lag -o - --quiet "$@" | cut -d, -f1 | tr '\n' ' '; }
is "--until and --every" "t [s] 0 60 120 " "$(rows_at --until '2 [min]' '--every=1[min]')"
"$LAGC" run pend.lag --method rk4 --step '1[ms]' >out
check "--step" grep -q 'rk4(step=0.001)' out
check "another dimension" says 2 'this value is in [s], but [cm] is needed here' "$LAGC" run pend.lag 'l=3[s]'
check "a time in metres" says 2 'this value is in [m], but [s] is needed here' "$LAGC" run pend.lag --until '3[m]'
check "an unknown unit" says 2 'unknown unit `sec`' "$LAGC" run pend.lag --until '3[sec]'
check "an unknown name" says 2 'unknown name `ll`' "$LAGC" run pend.lag 'll=3[m]'
check "a vector" says 2 'set its components' "$LAGC" run pend.lag 'e=3[m]'
check "what no run sets" says 2 'a run cannot set' "$LAGC" run pend.lag "energy=3[J]"
check "a bracket that stays open" says 2 'the `]` of this unit is missing' "$LAGC" run pend.lag 'l=3[m'
check "past the numbers there are" says 2 'not a finite number' "$LAGC" run pend.lag 'th=1e308[rad]'
printf '%s\n' 'model m' 'const e = (1, 0)' 'coord x' "lagrangian = e.x*x'^2" >vector.lag
check "-D gives a number" says 1 'is a vector of 2 components' "$LAGC" check vector.lag -D e=3
printf '%s\n' 'model m' 'const h = 50 [cm]' 'coord x [m]' "lagrangian = 1 [kg]*x'^2" 'scene s { start x = h }' >const.lag
is "-D gives it in the constant's unit" "0,0.25" "$("$LAGC" run const.lag -D h=25 -o - --quiet --until 1 --every 1 | sed -n 2p | cut -d, -f1-2)"
"$LAGC" build pend.lag -o pend
check "a simulator takes numbers, and says who converts" says 2 'lagc run converts' ./pend 'l=1[m]'
check "times too" says 2 'lagc run converts' ./pend --until '1[min]'
tap_end
