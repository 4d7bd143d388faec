#!/bin/sh
# models/lib/bodies.lag: each moment of inertia against the integral of m (distance from the axis)^2 over its shape, by the midpoint rule with 400 places each
# way (off by some 1/160000 of mass times size^2), of mass 3.
. tests/tap.sh
cat >"$TMP/all.lag" <<'END'
model all
include "bodies.lag"
coord x
lagrangian = x'^2/2
END
grep -o "^moment '[^']*'" tests/exec/run_bodies.sh | sed "s/^moment '//; s/'$//" >"$TMP/calls" # one run for all
while read -r call; do set -- "$@" --observe "$call + 0*x"; done <"$TMP/calls"
check "a run with all of them" "$LAGC" run "$TMP/all.lag" "$@" --until 1e-3 -o "$TMP/row.csv" --quiet
value() { sed -n 2p "$TMP/row.csv" | cut -d, -f "$(($(grep -nxF -e "$1" "$TMP/calls" | cut -d: -f 1) + 4))"; } # after t, x, x', energy
# integral INTEGRAND WEIGHT, of u and v from 0 to 1: 3 x (mean of the squared distance, with the weight)
integral() { awk "BEGIN { n = 400; for (i = 0; i < n; i++) for (j = 0; j < n; j++) { u = (i + 0.5)/n; v = (j + 0.5)/n; w = $2; top += w*($1); below += w } printf \"%.9g\", 3*top/below }"; }
moment() { near "$1" 4e-4 "$(integral "$2" "$3")" "$(value "$1")"; }
# Mean values over angles: of x^2 over a circle 1/2 r^2, over a sphere 1/3 r^2. u is a radius or a height, in parts of the whole.
moment 'rod_across(3, 2)' '(2*u - 1)^2' 1
moment 'rod_end(3, 2)' '(2*u)^2' 1
moment 'hoop(3, 2)' 4 1
moment 'hoop_across(3, 2)' '4*sin(6.283185307179586*u)^2' 1
moment 'disc(3, 2)' '(2*u)^2' u
moment 'disc_across(3, 2)' '(2*u)^2*sin(6.283185307179586*v)^2' u
moment 'tube(3, 2, 1)' '(1 + u)^2' '1 + u'
moment 'cylinder_across(3, 2, 5)' '(2*u)^2/2 + (5*v - 2.5)^2' u
moment 'ball(3, 2)' '2/3*(2*u)^2' 'u*u'
moment 'shell(3, 2)' '4*(1 - (2*u - 1)^2)' 1
moment 'cone(3, 2)' '(2*v*u)^2' 'v*v*u'
moment 'cone_tip(3, 2, 5)' '(2*v*u)^2/2 + (5*v)^2' 'v*v*u'
moment 'box(3, 2, 5)' '(2*u - 1)^2 + (5*v - 2.5)^2' 1
moment 'ellipsoid(3, 2, 5)' '(4 + 25)*u*u/3' 'u*u'
# a torus: rho = r + s cos, with weight rho s
moment 'ring(3, 2, 0.5)' '(2 + 0.5*u*cos(6.283185307179586*v))^2' 'u*(2 + 0.5*u*cos(6.283185307179586*v))'
moment 'beside(rod_across(3, 2), 3, 1)' '(2*u)^2' 1
empty "every function is tested" "$(sed -n 's/^function \([a-z_]*\).*/\1/p' models/lib/bodies.lag | while read -r f; do grep -q "moment '$f(" tests/exec/run_bodies.sh || echo "$f"; done)"
tap_end
