#!/bin/sh
# Sensitivities and gradients over contacts with friction, constraints with `while`, and guides: against closed forms, and
# against differences of runs (sensitivity/differences.py). Refusals, where there is no derivative.
. tests/tap.sh
S=tests/exec/sensitivity

last() { # MODEL SCENE NAMES ARGS...: the derivatives at the end
  title="$(basename "$1" .lag) $2"
  model=$1 scene=$2 names=$3
  shift 3
  "$LAGC" run "$model" "$scene" --sensitivity "$names" "$@" >"$TMP/out" 2>&1 || cat "$TMP/out"
}
close() { # NAME WANT: relative, absolute below 1; the runs have a tolerance of 1e-12, and differences of order 6 eleven digits
  near "$title: $1" 1e-9 "$2" "$(awk -v n="$1" '$1 == n { print $2 }' "$TMP/out")"
}

# A block is thrown up a slope, stops and slides down: u = g (sin a + mu cos a) takes its speed v, d = g (sin a - mu cos a) brings it back.
slid() {
  awk -v g=9.81 -v a=0.4 -v mu="$1" -v v=2 -v t=1.2 -v by="$2" -v back="$3" 'BEGIN { s = sin(a); c = cos(a); u = g*(s + mu*c); d = g*(s - mu*c); r = t - v/u
    ug = s + mu*c; dg = s - mu*c; um = g*c; dm = -g*c; ua = g*(c - mu*s); da = g*(c + mu*s)
    uy = by == "g" ? ug : by == "mu" ? um : by == "a" ? ua : 0; dy = by == "g" ? dg : by == "mu" ? dm : by == "a" ? da : 0
    S = v*v/2/u - back*d*r*r/2; D = -v*v/2/u/u*uy - back*(dy*r*r/2 + d*r*v/u/u*uy) + (by == "v")*(v/u + back*d*r/u)
    printf "%.15g", D*c - (by == "a")*S*s }'
}
for name in g a mu v; do
  last $S/slope.lag go g,a,mu,v
  close "dx/d$name" "$(slid 0.3 $name 1)"
  last $S/slope.lag stuck g,a,mu,v # where it stops it stays
  close "dx/d$name" "$(slid 0.5 $name 0)"
done
for method in $(one_of 2 rk45 radau 'rk4(step=1e-3)'); do # of radau the tolerance is that of y
  last $S/slope.lag stuck mu,v --method "$method"
  close dx/dmu "$(slid 0.5 mu 0)"
done
# Dropped on a table it loses mu times the speed of its fall: a stop takes (v - mu V)/(mu g), V = sqrt(2 g h); by h = 0.5 the fall lasts V/g.
last $S/slope.lag drop g,mu,v,y
drop="g = 9.81; V = sqrt(g); u = 2 - 0.2*V"
close dx/dv "$(awk "BEGIN { $drop; printf \"%.15g\", V/g + u/0.2/g }")"
close dx/dmu "$(awk "BEGIN { $drop; printf \"%.15g\", -u*V/0.2/g - u^2/2/g/0.04 }")"
close "dx/dy(0)" "$(awk "BEGIN { $drop; printf \"%.15g\", (2 - u)/V }")"
# A clutch takes two wheels to one speed W = (I w + M t1)/(I + J), and lets go at t2.
last $S/clutch.lag engage I,M,t1,t2,w
close "da'/dt1" 0
close "da'/dt2" "$(awk 'BEGIN { printf "%.15g", 0.1/3 - 0.1 }')"
close db/dt1 "$(awk 'BEGIN { printf "%.15g", -3.1/3 }')"
close db/dt2 "$(awk 'BEGIN { printf "%.15g", 0.1/3 }')"
close db/dw "$(awk 'BEGIN { printf "%.15g", 2/3 }')"
close db/dM "$(awk 'BEGIN { printf "%.15g", 1/3 + 1/6 + 2/3 }')"
close "da'/dI" "$(awk 'BEGIN { printf "%.15g", (3*3 - 3.2)/9 - 0.1 }')"
# A rope catches: at T = (sqrt(l^2 - b^2) - x0)/v, from where the mass circles at v b/l^2.
last $S/catch.lag go l,b,v,x0
caught() {
  awk -v by="$1" 'BEGIN { l = 1; b = 0.6; v = 1.3; x0 = -0.2; c = sqrt(l*l - b*b); T = (c - x0)/v; s = 2 - T; w = v*b/l/l; f = atan2(b, c) - w*s
    d["l"] = -b/l/c + 2*w/l*s + w*l/v/c; d["b"] = 1/c - v/l/l*s - w*b/v/c; d["v"] = -b/l/l*s - w*T/v; d["x0"] = -w/v
    printf "%.15g", (by == "l")*cos(f) - l*sin(f)*d[by] }'
}
for name in l b v x0; do close "dx/d$name" "$(caught $name)"; done
# A bead on a hoop with friction by its own force: where it sticks.
last $S/hoop.lag rests mu,g,th,w,R
for pair in $(python3 $S/hoop.py | sed 's/ \([-0-9]\)/=\1/g'); do close "${pair%=*}" "${pair#*=}"; done

# ---- against differences of runs, to 1e-8
differ() { # MODEL SCENE NAME=VALUE...
  model=$1
  shift
  check "$model $1, against differences" python3 $S/differences.py "$LAGC" $S/$model.lag "$1" 1e-8 $(shift && echo "$@")
}
differ rope go g=9.81 l=1 v=1 y0=-0.2                        # under its weight
differ belt go m=1 k=1 v=0.2 mu=0.25 mu_s=0.4 g=1 x0=0.5     # sticks and slips, by static friction
differ spun_ball go R=0.1 g=9.81 mu=0.3 e=0.7 w=20 v=1 h=1   # bounces with spin
differ spun_ball roll R=0.1 g=9.81 mu=0.3 w=5 v=1            # slides, then rolls
differ spun_ball thud R=0.1 g=9.81 mu=0.3 w=5 v=1 h=1        # falls, stays closed, slides, rolls
differ two go g=9.81 b=0.3 h=0.4 mu=0.3 v=2                  # two feet that stop together
differ off go g=9.81 R=1 v=0.8 mu=0.1                        # leaves a cylinder
differ feet go m=1 M=2 a=0.3 v=1 k=5                         # one constraint ends where another begins
differ latch go m=1 k=3 M=2 c=0.7 x0=1 b=0.2                 # an event lets a constraint begin
differ knock s l=1.2 g=9.81 a=2 w=0.5 e=0.9 T=0.7            # an event and a kick on a constraint
differ hoop go g=9.81 R=1 mu=0.2 th=1.2 w=0.5
differ slider go m=1 k=4 mu=0.3 mu_s=0.4 g=9.81 A=6 w=2 x0=0.1
differ plate slides m=1 mu=0.3 v=1 u=0.7 k=2 b=3             # in space, while it slips
# Whirled round by its speed it presses outwards, and inwards where slow: corners of |N|. By mu alone: w moves the end too far for differences.
differ top go mu=0.05

# ---- gradients: the transpose of sensitivities
dot() { # MODEL SCENE VALUE NAMES
  "$LAGC" run "$S/$1.lag" "$2" --gradient "$3" --json >"$TMP/gradient" 2>"$TMP/err" && "$LAGC" run "$S/$1.lag" "$2" --sensitivity "$4" --json >"$TMP/forward" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }
  python3 - "$TMP/gradient" "$TMP/forward" "$3" <<'X'
import json, sys
adjoint, forward = (json.loads(open(f).read()) for f in sys.argv[1:3])
adjoint, forward = adjoint["gradient"][sys.argv[3]], forward["sensitivity"][sys.argv[3]]
size = max(abs(x) for x in forward.values())
bad = [(k, adjoint[k], x) for k, x in forward.items() if abs(adjoint[k] - x) > 1e-12*size]
sys.exit(str(bad) if bad or not size else 0)
X
}
check "gradient: a slope" dot slope go x g,a,mu,v
check "gradient: a clutch" dot clutch engage b I,J,M,t1,t2,w
check "gradient: a hoop" dot hoop go x g,R,mu,th,w
check "gradient: a rope" dot rope go x g,l,v,y0

# ---- where there is no derivative
refused() { # TEXT MODEL SCENE NAMES
  "$LAGC" run "$S/$2.lag" "$3" --sensitivity "$4" >"$TMP/out" 2>&1
  [ $? = 3 ] && grep -q -e "$1" "$TMP/out" || { cat "$TMP/out"; return 1; }
}
check "friction at its limit" refused "at t = 0 s the friction of floor.slip holds with all its force: neighbouring motions slip or stick" slope edge a
check "a slip in space that ends" refused "event floor sticks.x .*: a slip in space ends, before which its direction turns ever faster" plate stops mu
check "two supports at once" refused "event left changes the state at t = .*: neighbouring motions go on with other contacts closed" plank go g,a
check "two brakes by clocks of their own" refused "event one changes the state at t = 1 s: another event does so at the same time" brakes go t1
last $S/brakes.lag go v # which does not tell the clocks apart
close dy/dv 2
check "a constraint that happens to be met" refused "event pin changes the state at t = .*: neighbouring motions do not meet its constraint there" brake go v
tap_end
