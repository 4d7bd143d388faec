#!/bin/sh
# `measure` statements and `lagc run --measure`: values against closed forms, their place in report and JSON, and what is refused.
. tests/tap.sh
cd "$TMP" || exit 1
case $LAGC in /*) ;; *) LAGC=$OLDPWD/$LAGC ;; esac
cat >hop.lag <<'LAG'
model hop "A ball that bounces, and a drop that is drawn sideways"
coord y [cm], x [m], th [deg] periodic
param m = 2 [kg] > 0, g = 9.81 [m/s^2] > 0, e = 0.8, w = 3 [rad/s] > 0
let height = y/1 [m]
kinetic = m/2*(y'^2 + x'^2 + th'^2*1 [m^2])
potential = m*g*y + m/2*w^2*(x^2 + th^2*1 [m^2])
event floor: y falling { y' = -e*y' }
event half: y - 0.5 [m] falling { stop }
scene drop {
  start y = 1 [m], x = 20 [cm], th = 30 [deg]
  span 10 [s]
  tolerance 1e-12
  measure end_time = end
  measure high = max(height)
  measure fall = (max(y) - min(y))*g*m
  measure turn = max(th)
  measure speed = max(hypot(x', y'))
  measure mean_th = mean(th)
  measure radian = max(th) - 1
  measure straight = pi - max(th)
  measure ratio = end*w/(2*pi)
}
scene low {
  like drop
  start y = 50 [cm]
  use none
  measure high = hit(floor, 2)
}
LAG
# values SCENE OPTIONS...: NAME VALUE lines of the measures, in vals
values() {
  "$LAGC" run hop.lag "$@" >out 2>err || return 1
  sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
}
# near NAME EXPECTED UNIT TOLERANCE
near() { awk -v n="$1" -v e="$2" -v u="$3" -v tol="$4" '$1 == n && $3 == u && ($2 - e <= tol) && (e - $2 <= tol) { ok = 1 } END { exit !ok }' vals; }

# The ball falls from 1 m to half of it: sqrt(2*0.5/9.81) s; x and th oscillate with 3 rad/s, and begin at their amplitude.
T=0.319275428407050 # sqrt(1/9.81)
check "a scene with measures runs" values drop
check "the run ends where an event stops it" near end_time $T s 1e-9
check "a let of pure numbers" near high 1 '' 1e-12
check "several units: SI, named by the compiler" near fall 9.81 J 1e-9
check "a declared unit" near turn 30 deg 1e-10
# the fastest is the end: y' = g T, x' = 0.2*3*sin(3 T)
check "an expression of the model" near speed "$(awk -v t=$T 'BEGIN { a = 9.81*t; b = 0.6*sin(3*t); printf "%.15g", sqrt(a*a + b*b) }')" m/s 1e-9
check "a mean" near mean_th "$(awk -v t=$T 'BEGIN { printf "%.15g", 30*sin(3*t)/(3*t) }')" deg 1e-9
check "a pure number beside an angle is in radians" near radian "$(awk 'BEGIN { printf "%.15g", 30 - 45/atan2(1, 1) }')" deg 1e-9
check "as pi is" near straight 150 deg 1e-9
check "a ratio of measures" near ratio "$(awk -v t=$T 'BEGIN { printf "%.15g", 3*t/8/atan2(1, 1) }')" '' 1e-10
# from 0.5 m the event of half is not met again before the floor: the second time at T (1 + 2*0.8)
check "a scene by like replaces a measure" values low --until 1.5
check "and keeps the others" near high "$(awk -v t=$T 'BEGIN { printf "%.15g", t*2.6 }')" s 1e-9
check "a measure of the command line replaces the scene's" values drop --measure 'high=max(y) - 10' --measure "v=y'(0.2)"
check "a plain number is in the unit beside it" near high 90 cm 1e-9
check "an option adds measures" near v -196.2 cm/s 1e-9
check "a name with parentheses" values drop --measure 'w^(2/3)=max(y)^(2/3)'
check "a let in an option" values drop --measure 'max(2*height)'
check "is known" grep -Eq '^  max\(2\*height\)  *2$' vals
check "an expression by --observe, in quotes" values drop --observe 'hypot(x, y)' --measure 'least=min("hypot(x, y)")'
check "is known, too" near least "$(awk -v t=$T 'BEGIN { x = 0.2*cos(3*t); printf "%.15g", sqrt(x*x + 0.25) }')" m 1e-9
"$LAGC" run hop.lag drop --json >json 2>err
check "JSON has them" grep -q '"measures": {"end_time": 0.3192754284.*"turn": \(30\|29.99999999999\)' json
# y' = -sqrt(2*9.81*0.5) m/s before the floor, 0.8 of it after
check "values at the times of events" values low --until 1.5 --measure "before=y'(hit(floor))" --measure "after=y'(hit(floor) + 1e-12)"
check "are those before" near before "$(awk 'BEGIN { printf "%.15g", -100*sqrt(9.81) }')" cm/s 1e-9
check "and change there" near after "$(awk 'BEGIN { printf "%.15g", 80*sqrt(9.81) }')" cm/s 1e-7
check "quiet has none" sh -c "'$LAGC' run hop.lag drop --quiet >out 2>&1 && ! [ -s out ]"
check "rows and measures together" sh -c "'$LAGC' run hop.lag low --until 1.5 -o rows.csv --svg p.svg | grep -q '^  high *0.830116113858'"

# --- functions of the language and of the model, units
cat >functions.lag <<'LAG'
model functions "x = 2 cos t and y = sin t, of the language's functions"
coord x [cm], y [m], T [degC]
param k = 1 [kg/s^2] > 0
function twice(a) = 2*a
function apart(a, b) = twice(a) - b
kinetic = 1 [kg]/2*(x'^2 + y'^2) + 1 [kg*m^2/K^2]/2*T'^2
potential = k/2*(x^2 + y^2)
scene s { start x = 2 [m], y' = 1 [m/s], T = 20; span 3; tolerance 1e-12; measure low = min(x, 1..) - min(x, ..1) }
LAG
"$LAGC" run functions.lag --measure 'a=sinh(end/1[s])' --measure 'b=sech(x(1)/1[m])' --measure 'c=apart(max(y), y(1))' --measure 'd=tanh(y(1)/1[m]) + cbrt(8) + floor(2.5)' \
  --measure 'e=max(x, 150)' --measure 'f=hypot(max(x), max(y))' --measure 'g=max(y*y)^(1/2)' --measure 'h=max(y)*k' --measure 'i=asin(max(y)/1[m])' --measure 'j=max(x)/min(x)' --measure 'k=T' \
  --measure 'l=drift(T)' --measure 'm=sign(min(x))*abs(min(x))' --measure 'n=pow(max(y), 2)' --measure 'o=max(twice(x) + 1)' --measure 'p=energy(1)/lagrangian(0)' --measure 'q=mod(-2.5*max(y), 2 [m])' --measure 't(2)' >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
check "a hyperbolic sine" near a 10.017874927409903 '' 1e-9      # sinh 3
check "a function that a text defines" near b 0.6086703740847927 '' 1e-9 # 1/cosh(2 cos 1)
check "functions of the model, in one another" near c 1.1585290151921035 m 1e-9 # 2 - sin 1
check "functions of the C library" near d 4.686587406998579 '' 1e-9     # tanh(sin 1) + 2 + 2
check "a plain number beside a quantity in a function" near e 150 cm 1e-9
check "quantities of two units" near f 2.2360679774997896 m 1e-9 # sqrt(4 + 1)
check "a unit to a power" near g 1 m 1e-9
check "a unit that is no declared one" near h 1 N 1e-9
check "an angle" near i 1.5707963267948966 rad 1e-4             # asin is steep there: the error's root
check "a ratio" near j -1.0101 '' 2e-2                           # min x = 2 cos 3 = -1.98
check "a remainder, of the sign of what divides" near q 1.5 m 1e-9 # -2.5 + 2*2
check "a temperature" near k 20 degC 1e-9
check "a difference of temperatures" near l 0 degC 1e-9
check "a sign" near m -197.998499 cm 1e-5                        # 2 cos 3
check "a power" near n 1 m^2 1e-9
check "a function of a quantity, along the run" near o 5 m 1e-9
check "the energy at a time" near p -1.6666666666666667 '' 1e-9     # E = (4 + 1)/2 J, L(0) = (1 - 4)/2 J
check "the time at a time" near 't(2)' 2 s 0
is "no warning" "" "$(cat err)"
check "windows without an end, in a scene" near low -306.05896 cm 1e-4 # 2 (cos 3 - cos 1) m
"$LAGC" run functions.lag --measure 'max(x) + max(k)' --measure 'y(1 [m])' --measure 'exp(max(y))' --measure 'i=end' >out 2>err
check "a constant has no largest value" grep -q 'does not change along the run' err
"$LAGC" run functions.lag --measure 'u=max(x) + k' --measure 'v=y(1 [m])' --measure 'w=exp(max(y))' >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
is "units that do not match draw warnings" 3 "$(grep -c '^--measure.*warning:' err)"
check "and the numbers are taken in SI" near u 3 '' 1e-9

# --- the largest Lyapunov exponent: that of `lagc lyapunov`; x'' = w^2 x: w, up to the turning of the vector until t = 2 s, exp(-2 w 2)/(18 s) = 2e-5
printf 'model ridge\ncoord x [m]\nparam w = 2 [rad/s]\nlagrangian = (x'"'"'^2 + w^2*x^2)/2*1 [kg]\nevent far: x - 1 [m] rising { stop }\nscene run { start x = 1e-30; span 20; tolerance 1e-11; measure rate = lyapunov; measure doubling = log(2)/lyapunov }\n' >ridge.lag
"$LAGC" run ridge.lag >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
check "an exponent" near rate 2 1/s 3e-5
check "in arithmetic" near doubling 0.34657359 s 5e-6
# MEGNO of |d| ~ exp(w t): w t/2, but for the turning of the first vector; of regular motion 2 (Cincotta and Simo), an ellipse but for its wobble
"$LAGC" run ridge.lag --measure 'm=megno' >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
check "megno of a ridge" near m 20 '' 1 # the first step's growth is that of a random vector
regular() { "$LAGC" run "$OLDPWD/models/kepler.lag" orbit --until 3000 --measure 'm=megno' >out 2>err; sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals; near m 2 '' 0.02; }
slow check "megno of an ellipse" regular
own() { "$LAGC" lyapunov "$OLDPWD/models/lorenz.lag" --until 40 --exponents 1 --json | sed 's/.*"exponents": \[\([^]]*\)\].*/\1/'; }
measured() { "$LAGC" run "$OLDPWD/models/lorenz.lag" --until 40 --measure lyapunov --json | sed 's/.*"lyapunov": \([^}]*\)}.*/\1/'; }
is "the one of lagc lyapunov, bit by bit" "$(own)" "$(measured)"
state() { "$LAGC" run "$OLDPWD/models/lorenz.lag" --until 40 --json "$@" | sed 's/.*"final": \({[^}]*}\).*/\1/'; }
is "the run is the one without it" "$(state)" "$(state --measure lyapunov)"
"$LAGC" run ridge.lag x=1e-4 >out 2>err
check "none of a run that an event stops" grep -q '^  rate *none: an event stops the run at t = 4.951' out # log(2/x)/w

# --- refused, nothing written: with exit status 1 and a caret by the compiler, with 2 by the simulator
stopped_with() {
  status=$1 want=$2
  shift 2
  "$LAGC" run hop.lag "$@" -o no.csv >out 2>err
  [ $? = "$status" ] && grep -qF -e "$want" err && ! [ -e no.csv ]
}
refused() { stopped_with 2 "$@"; }
wrong() { stopped_with 1 "$@" && grep -q '^ *| *^' err; }
check "an unknown name" wrong '--measure:1:5: error: unknown name `thh`' --measure 'max(thh)'
check "has the nearest" grep -q 'did you mean `th`?' err
check "an unknown event" wrong '--measure:1:5: error: no event is called `flor`' --measure 'hit(flor)'
check "has the nearest, too" grep -q 'did you mean `floor`?' err
check "a time before the first" wrong 'no event happens for the `0`th time' --measure 'hit(floor, 0)'
check "half a time" wrong 'no event happens for the `1.5`th time' --measure 'hit(floor, 1.5)'
check "a time that is a measure" wrong 'no event happens for the `max(x)`th time' --measure 'hit(floor, max(x))'
check "no expression" wrong 'expected an expression' --measure 'a='
check "a name that is missing" refused 'a name is missing before' --measure '=end'
check "two of one name" refused 'another measure is called so' --measure a=end --measure 'a=max(y)'
check "a function of a run that there is not" wrong 'unknown function `perod`' --measure 'perod(x)'
check "has the nearest as well" grep -q 'did you mean `period`?' err
check "nothing near" wrong 'of a run there are max, min, mean' --measure 'final(x)'
check "a constant" wrong 'does not change along the run' --measure 'max(m*g)'
check "a function of two" wrong 'a measure `atan2` is written `atan2(y, x)`' --measure 'atan2(max(y))'
check "a vector" wrong 'a measure is made of numbers' --measure 'max((x, y))'
check "an exponent of a method without tangent" says 2 'measure lyapunov: method gsl-rk8pd has no derivative of its steps' "$LAGC" run "$OLDPWD/models/lorenz.lag" --measure lyapunov --method gsl-rk8pd
saved() { "$LAGC" run "$OLDPWD/models/lorenz.lag" --until 1 --save-state state --quiet && says 2 "a saved state holds no tangent" "$LAGC" run "$OLDPWD/models/lorenz.lag" --resume state --until 2 --measure lyapunov; }
check "an exponent of a resumed run" saved
check "an exponent backwards" refused 'a mean over a long time, forwards' --measure lyapunov --until=-3
check "an extreme of an extreme" wrong 'a value of the whole run stands outside' --measure 'max(max(y))'

# ---- windows of time: of cos(t), whose extremes and integrals are known ----
cat >cosine.lag <<'LAG'
model cosine
coord x [m]
param w = 1 [1/s]
lagrangian = x'^2/2 - w^2*x^2/2
scene s { start x = 1; span 20; tolerance 1e-12; output x every 0.5; measure top = max(x, 1..2); measure square = mean(x^2, 1 [s]..2 [s]) }
LAG
"$LAGC" run cosine.lag --measure 'least=min(x, 1..2)' --measure 'mean=mean(x, 1..2)' --measure 'rms=rms(x, 1..2)' --measure 'drift=drift(x, 1..2)' --measure 'early=max(x, ..0.5)' \
  --measure 'late=min(x, 15..)' --measure 'T=period(x, 5..)' --measure 'never=max(x, 30..)' >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
check "an extreme at an end of a window" near top 0.5403023058681397 m 1e-11
check "the other" near least -0.4161468365471424 m 1e-11
check "a mean" near mean 0.0678264420177852 m 1e-11    # sin 2 - sin 1
check "a mean square, in a scene" near square 0.0834750194665974 m^2 1e-11 # 1/2 + (sin 4 - sin 2)/4
check "its root" near rms 0.2889204379523843 m 1e-11
check "a drift" near drift 0.9564491424152821 m 1e-11
check "a window from the begin" near early 1 m 1e-11
check "a window to the end" near late -1 m 1e-11       # at 5 pi = 15.7
check "a period" near T 6.283185307179586 s 1e-9
check "a window behind the end" grep -q 'never .*none: the run ends at t = 20 s, before the window of time begins' out
check "a window that is empty" wrong 'this window of time is empty' --measure 'max(y, 3..2)'
check "no window" wrong 'a measure `mean` is written `mean(x)` or `mean(x, 10..20)`' --measure 'mean(y, 3)'
check "no number" wrong 'write numbers: `max(x, 10..20)`' --measure 'max(y, 1..2 [m])'
"$LAGC" run cosine.lag --skip 3 --until 5.25 --measure 'late=max(x)' -o rows.csv >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
check "--skip: measures begin there" near late 0.51208547 m 1e-7 # cos 5.25
is "rows too" "3 5.25 6" "$(sed -n 2p rows.csv | cut -d, -f1) $(tail -n 1 rows.csv | cut -d, -f1) $(sed 1d rows.csv | grep -c ,)"
check "--skip beyond the end" says 2 '--skip 30: the run is from 0 to 20 s' "$LAGC" run cosine.lag --skip 30

# ---- contacts: a body on a table that is lifted by 20 t newtons leaves when that is its weight; it falls before from 0.5 m ----
cat >lift.lag <<'LAG'
model lift
coord y [m]
param m = 1 [kg] > 0, g = 10 [m/s^2] > 0
kinetic = m/2*y'^2
potential = m*g*y
force y = 20 [N/s]*t
contact table: y >= 0, restitution = 0
scene s { start y = 0; span 1; tolerance 1e-11 }
LAG
"$LAGC" run lift.lag --measure 'a=hit(table opens)' --measure 'n=count( table  opens )' --until 0.9 >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
check "a contact opens" near a 0.5 s 1e-9
check "once" grep -q '^ *n  *1' vals
# The second run, for values at times that are measures, begins with the contact open that the first one left closed. 1 kg falls through 0.1 m, pulled up by 20 N/s t.
"$LAGC" run lift.lag y=0.1 --measure "before=y'(hit(table))" --measure 'half=y(hit(table)/2)' --until 0.3 >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
awk 'BEGIN { t = 0.15; for (i = 0; i < 9; i++) t -= (0.1 - 10*t*t/2 + 20*t*t*t/6)/(10*t*t - 10*t); h = t/2
  printf "%.15g %.15g\n", 10*t*t - 10*t, 0.1 - 10*h*h/2 + 20*h*h*h/6 }' >want
read -r speed height <want
check "the speed before a contact that stays closed" near before "$speed" m/s 1e-9
check "the height on the way to it" near half "$height" m 1e-9
sed 's/span 1;/span 1; measure lifts = hit(table opens);/' lift.lag >lifts.lag
"$LAGC" run lifts.lag --until 0.9 >out 2>err
sed -n '/^measures/,/^steps/p' out | sed '1d;$d' >vals
check "a contact opens, as a measure of the scene" near lifts 0.5 s 1e-9
check "an event that does not" wrong 'no event is called `half opens`' --measure 'hit(half opens)'
tap_end
