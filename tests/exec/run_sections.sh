#!/bin/sh
# Poincare sections: crossings of an oscillator at the times and values of its closed form; of Henon and Heiles' star on the
# surface and of the right energy, as many as the motion has; the same points in pictures, in two halves of a run, and by an
# event's name in a simulator; refusals.
. tests/tap.sh

# section FILE ARGS...: rows without their head
section() {
  to=$1
  shift
  "$LAGC" run "$@" --quiet -o "$TMP/rows.csv" && sed 1d "$TMP/rows.csv" >"$to"
}

# ---- x = cos 2t: falling at (k + 1/4) pi with x' = -2, rising at (k + 3/4) pi with 2; in 20 s 7 and 6 times.
# The tolerance 1e-11 leaves an error of some 1e-10 after 20 s, and half of that in time, by the slope; radau's dense output has order
# 3, and is good to 1e-8.
oscillates() { # METHOD DIRECTION FIRST EVERY SIGN COUNT (pi/4 times FIRST, pi/2 times EVERY)
  near=1e-9
  [ "$1" = radau ] && near=1e-8
  section "$TMP/osc" models/spring.lag free --method "$1" --section "x $2" || return 1
  awk -F, -v first="$3" -v every="$4" -v sign="$5" -v count="$6" -v near=$near '
    function off(a, b) { return a > b ? a - b : b - a }
    { pi = atan2(0, -1); t = pi/4*first + pi/2*every*(NR - 1); s = sign ? sign : NR % 2 ? -1 : 1
      if (off($1, t) > near || off($2, 0) > 2e-14 || off($3, 2*s) > near || off($4, 2) > near) { print NR, $0, "not at", t; bad = 1 } }
    END { if (NR != count) print NR, "rows"; exit bad || NR != count }' "$TMP/osc"
}
for method in ${SLOW:+rk45} dop853 taylor ${SLOW:+radau} 'verlet8(step=0.01)' ${SLOW:+'gauss(stages=4, step=0.05)'}; do
  check "$method: falling" oscillates "$method" falling 1 2 -1 7
  check "$method: rising" oscillates "$method" rising 3 2 1 6
  check "$method: both ways" oscillates "$method" crossing 1 1 0 13
done
check "a surface that moves: where the phase of a drive is zero" sh -c "
  $LAGC run models/spring.lag driven drive.w=2 --section 'sin(2 [rad/s]*t) rising' --observe t --until 20 --quiet -o - |
  awk -F, 'NR > 1 { d = \$1 - (NR - 1)*atan2(0, -1); if (d > 1e-12 || -d > 1e-12) bad = 1 } END { exit bad || NR != 7 }'"

# ---- Henon and Heiles: x = 0, x' > 0 and E = 1/8. The last digit of t, 2e-13 at 1000, moves x by as much.
section "$TMP/star" models/henon_heiles.lag chaos --section 'x rising'
on_surface() {
  awk -F, '{ if ($2 > 2e-12 || -$2 > 2e-12 || $4 <= 0 || $7 - 1/8 > 1e-11 || 1/8 - $7 > 1e-11) { print; bad = 1 } } END { exit bad || NR < 100 }' "$TMP/star"
}
check "the star: on the surface, to the right, of its energy" on_surface
crossings() { # crossings counted in rows at equal times
  "$LAGC" run models/henon_heiles.lag chaos --every 0.01 --quiet -o - | awk -F, 'NR > 2 && $2 > 0 && before <= 0 && NR > 3 { n++ } NR > 1 { before = $2 } END { print n }'
}
is "as many as rows in time show" "$(crossings)" "$(wc -l <"$TMP/star" | tr -d ' ')"
# An independent figure: y in |y| <= the oval that x = x' = 0 and E bound, y^2/2 - y^3/3 <= 1/8.
check "inside the oval of the energy" awk -F, '{ e = $5^2/2 + $3^2/2 - $3^3/3; if (e > 1/8 + 1e-11) exit 1 }' "$TMP/star"

# ---- the same points elsewhere
dots() { # OPTIONS...
  "$LAGC" plot models/henon_heiles.lag chaos --section 'x rising' "$@" --quiet -o "$TMP/star.svg" && grep -o 'h0' "$TMP/star.svg" | wc -l | tr -d ' '
}
is "a dot for each in a picture" "$(wc -l <"$TMP/star" | tr -d ' ')" "$(dots --x y --y "y'")"
check "and no curve, no ends" sh -c "! grep -q 'L[0-9].* [0-9].*L\\|>start<' '$TMP/star.svg'"
halves() {
  m=models/henon_heiles.lag
  "$LAGC" run $m chaos --section 'x rising' --until 500 --save-state "$TMP/half" --quiet -o "$TMP/a.csv" &&
    "$LAGC" run $m chaos --section 'x rising' --resume "$TMP/half" --quiet -o "$TMP/b.csv" && sed -s 1d "$TMP/a.csv" "$TMP/b.csv" | cmp - "$TMP/star"
}
check "two halves of a run have the points of the whole" halves
is "the report counts them" "section x rising: 7 times" "$("$LAGC" run models/spring.lag free --section 'x falling' | sed -n 's/^section x falling/section x rising/; s/, first.*//p')"
check "a sketch in the terminal" sh -c "$LAGC run models/henon_heiles.lag chaos --section 'x rising' --sketch --plot-x y --plot-y \"y'\" | grep -q '⠐\|⠂\|⡀\|⠠'"
# ---- A periodic angle is zero once a turn, in one direction: of the zeros of its sine those with a positive cosine and that sign of the rate.
turns() { # SECTION SIGN B: of th2 + B th1
  pend="models/double_pendulum.lag chaos --until 100 --observe th1' --observe th2' --quiet"
  # shellcheck disable=SC2086
  "$LAGC" run $pend --section "$1" -o "$TMP/turns.csv" && "$LAGC" run $pend --section "sin(th2 + $3*th1) crossing" -o "$TMP/sines.csv" || return 1
  awk -F, -v sign="$2" -v b="$3" '
    FNR == 1 {next}
    FILENAME ~ /sines/ {if (cos($3 + b*$2) > 0 && ($8 + b*$7)*sign > 0) want[++n] = $1; next}
    {d = $1 - want[++k]; if (d*d > 1e-16) bad = 1}
    END {print n, k; exit !(n == k && n > 20 && !bad)}' "$TMP/sines.csv" "$TMP/turns.csv"
}
check "th2 rising" turns 'th2 rising' 1 0
check "th2 falling" turns 'th2 falling' -1 0
check "-th2 rising" turns '-th2 rising' -1 0
check "th2 - th1 rising" turns 'th2 - th1 rising' 1 -1

simulator() {
  "$LAGC" build models/bouncing_ball.lag -o "$TMP/ball" && "$TMP/ball" drop --section floor --until 2 --quiet -o "$TMP/ball.csv" &&
    "$LAGC" run models/bouncing_ball.lag drop --section 'y falling' --until 2 --quiet -o "$TMP/y.csv" && [ "$(wc -l <"$TMP/ball.csv")" -gt 1 ]
}
check "a simulator takes the name of an event" simulator

# ---- refusals
refused() { # STATUS TEXT ARGS...
  status=$1
  text=$2
  shift 2
  "$LAGC" run "$@" >"$TMP/out" 2>&1
  [ $? = "$status" ] && grep -q -e "$text" "$TMP/out" || { cat "$TMP/out"; return 1; }
}
star=models/henon_heiles.lag
check "no direction" refused 2 "a direction is missing; write --section 'x rising', falling" $star --section x
check "another direction" refused 2 "\`sideways\` is no direction; write --section 'x rising'" $star --section "x sideways"
check "a name that the model has not" refused 1 "unknown name .vx" $star --section 'vx rising'
check "its mistake is shown with a caret" grep -q '| \^~' "$TMP/out"
check "and a way out" grep -q '= ' "$TMP/out"
check "an acceleration" refused 1 "cannot contain accelerations" $star --section "x'' rising"
check "the energy" refused 1 "cannot contain accelerations.*energy" $star --section 'energy rising'
check "a vector" refused 1 "a number is needed here" models/charged_particle.lag --section 'r rising'
check "with --every" refused 2 "leave one of them out" $star --section 'x rising' --every 1
check "with --html" refused 2 "leave one of them out" $star --section 'x rising' --html a.html --points x,y
nearest() { "$TMP/ball" drop --section flor >"$TMP/out" 2>&1; [ $? = 2 ] && grep -q 'did you mean "floor"' "$TMP/out"; }
check "a simulator names the nearest event" nearest
tap_end
