#!/bin/sh
# lagc design: the measurements with the most information, against closed forms and a search over all subsets (design/reference.py); what it refuses.
. tests/tap.sh
cat >"$TMP/spring.lag" <<'M'
model spring
coord x [m], y [m]
param m = 2 [kg] > 0, k = 8 [N/m] > 0, x0 = 0.5 [m], unused = 1
lagrangian = m/2*(x'^2 + y'^2) - k/2*x^2
scene go { start x = x0, y' = 0.2 [m/s]; span 3 [s]; output x, y every 0.1 [s] }
M
design() { "$LAGC" design "$TMP/spring.lag" "$@" --json >"$TMP/json" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }; }
chosen() { python3 -c 'import json, sys; print(" ".join("%s@%.3g" % (m["output"][0], m["t"]) for m in json.load(open(sys.argv[1]))["measurements"]))' "$TMP/json"; }
error() { python3 -c 'import json, sys; print(repr(json.load(open(sys.argv[1]))[sys.argv[3]][sys.argv[2]]))' "$TMP/json" "$1" "${2:-errors}"; }
# y = y0 + v0 t: the ends of the span, and their neighbours; errors of the slope sigma/span and of the start sigma.
check "a straight line" design --fit "y,y'" --sigma 0.01 --columns y --best 2
is "its ends" "y@0 y@3" "$(chosen)"
near "the error of its start" 1e-9 0.01 "$(error 'y(0)')"
near "the error of its slope, sqrt(2) sigma/span" 1e-9 0.00471404520791 "$(error "y'(0)")"
check "four of them" design --fit "y,y'" --sigma 0.01 --columns y --best 4
is "the ends and their neighbours" "y@0 y@0.1 y@2.9 y@3" "$(chosen)"
# x = x0 cos wt, w = 2: dx/dk = -x0 t sin(wt)/(2 m w), in t = 0..3 largest in size where tan wt = -wt, wt = 4.913, t = 2.457
check "one time for the stiffness" design --fit k --sigma 0.01 --columns x --best 1
is "where t sin wt is largest" "x@2.5" "$(chosen)"
near "the error of k there" 1e-7 "$(awk 'BEGIN { printf "%.12g", 0.01*8/(0.5*2.5*-sin(5)) }')" "$(error k)"
all_subsets() { design --fit "k,x0,m" --prior 'm~normal(2, 0.3)' --sigma x=0.01 --sigma y=0.02 --best 3 && python3 tests/exec/design/reference.py >"$TMP/want" && [ "$(chosen)" = "$(head -1 "$TMP/want")" ] || { chosen; cat "$TMP/want"; return 1; }; }
check "three of 31, as by a search over all subsets" all_subsets
for name in k x0 m; do near "the error of $name" 1e-6 "$(sed -n "s/^$name //p" "$TMP/want")" "$(error $name)"; done
text() { "$LAGC" design "$TMP/spring.lag" --fit k,x0 --sigma 0.01 --best 3 >"$TMP/out" && grep -q '^best 3 of 62 measurements, at 31 times from 0 to 3 s:$' "$TMP/out" && grep -q '^  x \[m\] at t = 1.7, 2.3, 2.7 s$' "$TMP/out" && grep -q '^  k .* N/m$' "$TMP/out" || { cat "$TMP/out"; return 1; }; }
check "as text; of two values, by the same search" text
observed() { design --fit "y'" --sigma 0.01 --observe 'y^2' --columns 'y^2' --best 1 && [ "$(chosen)" = "y@3" ]; }
check "an observed expression" observed
refused() { # TEXT ARGS...
  text=$1
  shift
  "$LAGC" design "$TMP/spring.lag" "$@" >"$TMP/out" 2>&1
  [ $? = 2 ] && grep -q -e "$text" "$TMP/out" || { cat "$TMP/out"; return 1; }
}
check "what nothing feels" refused 'no measurement feels a change of unused by' --fit k,unused --sigma 0.01
# the mass of a pendulum cancels, but for rounding: its expected error was 3e9 kg
pendulum() { "$LAGC" design models/cartesian_pendulum.lag --fit m --sigma 0.01 --columns x >"$TMP/out" 2>&1; [ $? = 2 ] && grep -q 'no measurement feels a change of m by 1; leave it out of --fit' "$TMP/out" || { cat "$TMP/out"; return 1; }; }
check "what nothing feels, but for rounding" pendulum
check "what only acts together" refused 'no measurement feels a change of m by [-0-9.]*, k by [-0-9.]*; leave one of these out' --fit m,k --sigma 0.01
check "no error" refused 'how exact is a measured value of x \[m\]? Write --sigma x=0.01' --fit k
check "too few" refused '1 measurements cannot determine 2 quantities; write --best 2 or more' --fit k,x0 --sigma 0.01 --best 1
check "nothing to find" refused 'what are the measurements to determine? --fit g,l' --sigma 0.01
check "no such output" refused 'no output of the scene is left' --fit k --sigma 0.01 --columns q
tap_end
