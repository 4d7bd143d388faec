#!/bin/sh
# lagc cost: errors against errors worked out by hand, measured orders, the Pareto front and the target recomputed from the JSON
# object, omitted methods with reasons, bad input. Nothing here depends on how long anything takes.
. tests/tap.sh
. tests/exec/lib_precision.sh
sweep=0.5 # seconds of a sweep of one method
[ -z "${SLOW:-}" ] || { sweep=1 && unset LAGC_OPTIMISE; }

# cost ARGS...: rows of `method knob error seconds front cheapest order`
cost() {
  "$LAGC" cost "$@" --json >"$TMP/json" 2>"$TMP/err" || return 1
  sed 's/{"method"/\n&/g; s/{"tolerance"/\n&/g; s/{"step"/\n&/g' "$TMP/json" | tr -d '{}[]' | awk -F ', ' '
    /^"method"/ { split($1, m, "\""); method = m[4]; sub(/.*: /, "", $2); order = $2 }
    /^"(tolerance|step)"/ { for (i = 1; i <= 8; i++) sub(/.*: /, "", $i); print method, $1, $2, $3, $7, $8, order }' >"$TMP/runs"
}

# RK4 on x'' = -w^2 x multiplies x + i x'/w by R(-i w h) a step, R(z) = 1 + z + z^2/2 + z^3/6 + z^4/24; the motion is
# cos(w t). k = 4, m = 1: w = 2; 16 times up to 20 s. Rounding is 1e-16 a step, of errors that are 1e-9 and more.
check "a spring by rk4" cost models/spring.lag free --methods rk4 --seconds $sweep
rk4_by_hand() {
  [ "$(wc -l <"$TMP/runs")" -gt 8 ] || return 1
  awk '$3 > 1e-9 {
    n = 20/$2; wh = 2*$2; a = 1 - wh^2/2 + wh^4/24; b = -(wh - wh^3/6)
    re = 1; im = 0; worst = 0
    for (i = 1; i <= n; i++) {
      x = re*a - im*b; im = re*b + im*a; re = x
      if (i % (n/16) == 0) {
        t = i*$2; c = cos(2*t); s = -sin(2*t)
        dx[i] = (re - c)^2; dv[i] = (im - s)^2
      }
    }
    for (i in dx) { e = sqrt(dx[i]); if (e > worst) worst = e; e = sqrt(dv[i]); if (e > worst) worst = e }
    delete dx; delete dv
    if ((worst - $3)^2 > (3e-3*worst + 1e-13)^2) { # scales are 1 and w, as 8 places of each step of the reference show them: 1 - cos(h/16)
      printf "step %s: error %s, not %.6e\n", $2, $3, worst; bad = 1 }
  } END { exit bad }' "$TMP/runs"
}
check "its errors are those of the recursion" rk4_by_hand

# 0.15: contribution of higher terms where rounding does not show yet.
check "a pendulum by methods of fixed steps" cost models/pendulum.lag --until 4 --methods "rk4,verlet4${SLOW:+,symplectic_euler,verlet,variational,gauss}" --seconds ${SLOW:+1}2
order() { awk -v m="$1" '$1 == m { print $7; exit }' "$TMP/runs"; }
has_order() { check "$1 has order $2" awk -v got="$(order "$1")" -v want="$2" 'BEGIN { exit !(got != "" && got != "null" && (got - want)^2 < 0.15^2) }'; }
has_order rk4 4
has_order verlet4 4
slow has_order symplectic_euler 1
slow has_order verlet 2
slow has_order 'variational(order=2)' 2
slow has_order 'variational(order=4)' 4
slow has_order 'gauss(stages=1)' 2
slow has_order 'gauss(stages=2)' 4

# The front and the target are functions of errors and times: recomputed.
check "all methods, with a target" cost models/pendulum.lag --until 2 --seconds 2 --target 1e-8
front() {
  awk '{ e[NR] = $3; t[NR] = $4; f[NR] = $5 } END {
    for (i = 1; i <= NR; i++) {
      best = "true"
      for (j = 1; j <= NR; j++) if (t[j] <= t[i] && e[j] <= e[i] && (t[j] < t[i] || e[j] < e[i])) best = "false"
      if (best != f[i]) { print "run", i, "is", f[i], "not", best; bad = 1 }
      n += best == "true"
    }
    exit bad || n < 3 || NR < 50 }' "$TMP/runs"
}
check "the front is what nothing beats" front
cheapest() { awk '$6 == "true" { n++; e = $3; t = $4 } { if ($3 <= 1e-8 && (best == "" || $4 < best)) best = $4 } END { exit !(n == 1 && e <= 1e-8 && t == best) }' "$TMP/runs"; }
check "the cheapest that reaches the target" cheapest
all_there() { for m in rk45 dop853 rk4 verlet8 'gauss(stages=4)' radau taylor; do grep -qF "$m " "$TMP/runs" || { echo "no $m"; return 1; }; done; }
check "every method of liblag is there" all_there

text() { "$LAGC" cost "$@" >"$TMP/text" 2>"$TMP/err"; }
check "as a table" text models/pendulum.lag --until 2 --methods rk45,verlet --target 1e-6 --seconds $sweep
says() { check "it says: $1" grep -q -e "$1" "$TMP/text"; }
says '^reference: taylor'
if ! has_precision long; then
  slow skip "a reference of 19 digits" "long double is a double"
else
  says 'taylor, 19 digits, itself uncertain by [0-9.]*e-1[6-9]'
  # A model with constraints has no Taylor series; dop853 computes with as many digits as errors of doubles are judged by.
  "$LAGC" cost tests/exec/models/rod.lag --until 2 --methods rk4 --seconds 15 >"$TMP/rod"
  check "with constraints, enough digits" awk '/uncertain by/ { x = $NF; exit } END { print x; exit !(x > 1e-20 && x < 1e-16) }' "$TMP/rod"
fi
says '^cheapest setting for an error of 1e-06: .* ms, error '
# The method that it names reaches the stated error, by the pendulum's closed form (checked in models/pendulum.facts).
named() { sed -n 's/^  lagc run //p' "$TMP/text" >"$TMP/words" && read -r words <"$TMP/words" && sh -c "$LAGC run $words --quiet -o $TMP/rows.csv" && [ -s "$TMP/rows.csv" ]; }
check "the command that it names runs" named
without_quad() { LAG_HOME=$TMP/home "$LAGC" cost models/pendulum.lag --until 1 --methods rk4 --seconds $sweep >"$TMP/text" && grep -q '^reference: taylor, 15 digits' "$TMP/text"; }
mkdir -p "$TMP/home/lib" && cp "$BUILD"/liblag.a "$BUILD"/liblag_gsl.a "$TMP/home/lib" 2>"$TMP/err"
cp -r "$INC" "$TMP/home/include"
check "without more digits it is one of doubles" without_quad
compiles() { XDG_CACHE_HOME=$TMP/fresh "$LAGC" cost models/spring.lag --methods rk4 --seconds 0.02 2>&1 >/dev/null | grep -c 'compiled first'; }
is "--seconds that compiling exceeds, before it compiles" 1 "$(compiles)"
is "but not of a model that is compiled" 0 "$(compiles)"
unreached() { text models/pendulum.lag --until 2 --methods symplectic_euler --seconds 0.3 --target 1e-12; [ $? = 3 ]; }
check "a target out of reach is exit status 3" unreached
says '^no setting has an error of 1e-12 or less; the smallest found is'

check "a flow" text models/lorenz.lag --until 1 --methods rk45,verlet,taylor --seconds $sweep --runs
says '^not in the table: verlet: .*states'
says '^. taylor(tol=1e-09)'
check "methods that are left out for one reason, in one line" text models/lorenz.lag --until 1 --methods verlet,variational,verlet4,rk45 --seconds 0.3
says '^not in the table: verlet, verlet4, variational(order=2), .*: cannot integrate a model with states'
check "and no other" [ "$(grep -c "^not in the table" "$TMP/text")" = 1 ]

check "nothing moves" text models/pendulum.lag th=0 "th'=0" --until 1 --seconds 0.3 --methods rk4
says '^note: nothing moves, so that every method is exact'
# a ball that stops at the floor, 1 m below, does so after sqrt(2/9.81) = 0.451524 s
sed 's/{ y. = -e.y. }/{ stop }/' models/bouncing_ball.lag >"$TMP/falls.lag"
check "an event" text "$TMP/falls.lag" drop --seconds 0.3 --methods rk45
says '^an event ends the run at about t = 0.45152'
check "what is left of the equations" text models/pendulum.lag --until 1 --seconds 0.3 --methods rk4 --error residual
says '^error: what is left of the equations of motion in the middle of steps'
check "a picture" text models/pendulum.lag --until 1 --seconds $sweep --methods rk4,rk45,verlet,verlet4 -o "$TMP/cost.svg" --quiet
check "is whole" grep -q '</svg>' "$TMP/cost.svg"
check "has a curve for each that is named" [ "$(grep -c '<path fill="none".*stroke-linejoin' "$TMP/cost.svg")" = 4 ]
check "the band of twice the least time ends at the frame" awk '/stroke="none" d=/ { n++; gsub(/.* d="|".*/, ""); gsub(/[MLZ]/, " "); m = split($0, c, " ")
  for (i = 1; i < m; i += 2) bad += c[i] < 91.9 || c[i] > 560.1 || c[i + 1] < 51.9 || c[i + 1] > 490.1 } END { exit !(n == 1 && !bad) }' "$TMP/cost.svg"
check "with its name" grep -q '>rk4' "$TMP/cost.svg"
check "errors fall to the right, powers of ten at equal distances, to 0.1 pixel" awk -F '["><%]+' '/text-anchor="middle">10</ { x[++n] = $3; k[n] = $(NF - 3) }
  END { for (i = 3; i <= n; i++) { d = (k[i] - k[1])*(x[2] - x[1]) - (k[2] - k[1])*(x[i] - x[1]); bad += d*d > 9 }
    exit !(n >= 3 && !bad && (k[2] - k[1])*(x[2] - x[1]) < 0) }' "$TMP/cost.svg"
is "names of limits stand above the frame, where no curve is" 0 "$(grep -c 'rotate(-90).*>\(rounding\|reference\)<' "$TMP/cost.svg")"
check "and no other output" [ ! -s "$TMP/text" ]
check "all runs as rows" text models/pendulum.lag --until 1 --seconds $sweep --methods rk4 -o "$TMP/cost.csv" --sketch
check "their head" grep -qx 'method,knob,setting,error,seconds,spread,steps,calls,front' "$TMP/cost.csv"
check "errors fall from row to row" awk -F, 'NR > 2 && NR < 9 { if (!($4 < last)) bad = 1 } { last = $4 } END { exit bad || NR < 9 }' "$TMP/cost.csv"
says '^processor time .s. against error'
says '^ *a rk4$'
check "and as JSON" sh -c '"$0" cost models/pendulum.lag --until 1 --seconds 0.5 --methods rk4 --quiet -o "$1" && grep -q "\"left_out_from\"" "$1"' "$LAGC" "$TMP/cost.json"

refused() { # NAME PATTERN ARGS...
  name=$1 pattern=$2
  shift 2
  text "$@"
  status=$?
  check "$name is refused" [ "$status" = 2 ]
  check "with advice" grep -q -e "$pattern" "$TMP/err"
}
# The error of something else. The energy of a spring by rk4 falls as its recursion does: |R(i w h)|^2 a step, 1 - (w h)^6/72 for small steps.
check "the error of the energy" cost models/spring.lag free --methods rk4 --seconds $sweep --error energy
check "as its recursion" awk '$2 < 0.05 && $3 > 1e-11 { n = 20/$2; want = n*(2*$2)^6/72; if ((want - $3)^2 > (0.05*want)^2) { print $2, $3, want; bad = 1 }; k++ } END { exit bad || k < 2 }' "$TMP/runs"
check "the error at the end" cost models/spring.lag free --methods rk4 --seconds $sweep --error final
check "is a run" [ "$(wc -l <"$TMP/runs")" -gt 5 ]
# The residual of rk4 in the middle of a step: its motion there is the quintic of positions, velocities and accelerations at both ends, and for velocities the
# cubic (runtime/core/hermite.c): written out here for x'' = -4 x, with rates of up to 2 and 4.
check "the residual of the equations" cost models/spring.lag free --methods rk4 --seconds $sweep --error residual
residual_by_hand() {
  awk 'function size(x) { return x < 0 ? -x : x }
  $3 > 1e-9 {
    h = $2; n = 20/h; a = 1 - (2*h)^2/2 + (2*h)^4/24; b = -(2*h - (2*h)^3/6); q = 1; v = 0; worst = 0 # q + i v/2 is multiplied by a + i b
    for (i = 1; i <= n; i++) {
      p = q*a - v/2*b; u = 2*(q*b + v/2*a); A = -4*q; B = -4*p
      middle = (q + p)/2 + 5*h/32*(v - u) + h^2/64*(A + B); rate = (15/8*(p - q) - 7*h/16*(v + u) + h^2/32*(B - A))/h
      speed = (v + u)/2 + h/8*(A - B); force = (1.5*(u - v) - h/4*(A + B))/h
      if (i < n) { x = size(rate - speed)/2; y = size(force + 4*middle)/4; if (x > worst) worst = x; if (y > worst) worst = y }
      q = p; v = u
    }
    k++
    if ($3 > 1.02*worst || $3 < 0.98*worst) { print h, $3, worst; bad = 1 } # the largest rates at the ends of steps of an accurate run are 2 and 4 to 2 %
  }
  END { exit bad || k < 5 }' "$TMP/runs"
}
check "is that of its interpolant" residual_by_hand
nothing() { text models/spring.lag free --error nothing; [ $? = 1 ] && grep -q 'unknown name' "$TMP/err"; }
check "an error of nothing is refused" nothing

# How errors grow on Kepler's orbit, e = 0.6, twenty turns and more: phases of geometric methods in proportion to time and their energies not at all; phases of
# others as its square, and their energies in proportion to it (Hairer, Lubich, Wanner, Geometric Numerical Integration (2006), table I.2.1).
growths() { # of a method's runs with errors of 1e-10 to 0.03: the law that most of them have
  sed 's/{"method"/\n&/g; s/{"\(tolerance\|step\)"/\n&/g' "$TMP/json" | awk -v m="\"$1\"" '/^{"method"/ { on = index($0, m) } on && /"growth"/ { e = $0; sub(/.*"error": /, "", e); g = $0; sub(/.*"growth": "?/, "", g); sub(/["}].*/, "", g)
    if (e + 0 < 0.03 && e + 0 > 1e-10) n[g]++ } END { for (g in n) if (n[g] > most) { most = n[g]; best = g } print best }'
}
methods=verlet4,rk45 phases='t t^2' energies='bounded t' turns=20
[ -z "${SLOW:-}" ] || methods=verlet4,rk45,rk4,dop853 turns=100 phases='t t^2 t^2 t^2' energies='bounded t t t'
each_growth() { echo $(for m in $(echo "$methods" | tr , ' '); do growths "$m"; done); }
check "Kepler's orbit" cost tests/exec/kepler.lag --until "$turns*2*pi" --methods $methods --seconds ${SLOW:+1}3
is "the growth of its errors" "$phases" "$(each_growth)"
check "and of its energy's" cost tests/exec/kepler.lag --until "$turns*2*pi" --methods $methods --seconds ${SLOW:+1}3 --error energy
is "is one power less" "$energies" "$(each_growth)"

# Steps of a program's own: the error is that of a run with this step; Verlet's method, whose phase error is w t (w h)^2/24, here 6.7 h^2, follows
# to within 0.3 up to 0.21 s, found in factors of sqrt(2).
of_method() { sed 's/{"method"/\n&/g' "$TMP/json" | grep "\"method\": \"$1\"" | sed "s/.*\"$2\": \([^,}]*\).*/\1/"; }
check "runs with a step" cost models/spring.lag free --methods rk4 --seconds 4
expected=$(awk '$2 == 0.01953125 { print $3 }' "$TMP/runs")
check "steps of 0.02 s" cost models/spring.lag free --realtime 0.01953125 --seconds 6
check "rk4: the same error" awk -v a="$(of_method rk4 error)" -v b="$expected" 'BEGIN { print a, b; exit !(a > 0 && (a - b)^2 < (1e-9*b)^2) }'
check "Verlet's largest step" awk -v h="$(of_method verlet largest_step)" 'BEGIN { print h; exit !(h > 0.15 && h < 0.23) }'
check "a step takes time, the longest more" awk -v m="$(of_method verlet step_s)" -v w="$(of_method verlet worst_s)" 'BEGIN { print m, w; exit !(m > 0 && w > m && w < 0.01) }'
check "with its command" text models/spring.lag free --realtime 0.02 --seconds 1
says '^best: '
says '^  lagc run .*--method ".*step=0.02)"'
check "the fastest with an error of 1e-3" text models/spring.lag free --realtime 0.02 --target 1e-3 --seconds 1
says '^fastest: '
ranked() { awk '/^[* ] [a-z].*[0-9]e-[0-9]/ { sub(/^../, ""); if ($2 + 0 > 1e-3) next; if ($3 + 0 < last) bad = 1; last = $3 + 0; n++ } END { exit bad || n < 2 }' "$TMP/text"; }
check "those that meet it come first, by time" ranked
refused "a step of nothing" 'example --realtime 1e-3' models/spring.lag --realtime 0
hopeless() { text models/spring.lag free k=1e6 --until 1 --realtime 0.5 --seconds 1; [ $? = 3 ] && grep -q 'take shorter steps' "$TMP/text"; }
check "steps that are too long are said" hopeless

check "with -D" text models/chain.lag -D N=3 g=5 --until 1 --methods rk4 --seconds $sweep
says '^  lagc run models/chain.lag swing -D N=3 g=5 --until 1 --method rk4 --step '
check "with words that a shell reads otherwise" text models/pendulum.lag "th=30[deg]" --until 1 --methods rk4 --seconds $sweep
says "^  lagc run models/pendulum.lag small 'th=30\[deg\]' --until 1 --method rk4 --step "

# What the time allows: coarse settings first, and what was left out is said.
check "in a short time" text models/double_pendulum.lag --seconds 1
says '^left out, as three times slower than others or for want of time: '
splitting() { # NUMBER OPTION...: rows of the table of times
  number=$1
  shift
  text models/pendulum.lag --until 2 --seconds 2 "$@" && [ "$(grep -c '^  verlet' "$TMP/text")" = "$number" ]
}
check "one method of each family" splitting 1
check "or all of them" splitting 4 --all
check "those that are named" splitting 3 --methods verlet,verlet4,verlet6
check "and not that others are left out" sh -c '! grep "one method of each" "$0"' "$TMP/text"

# Digits are lost with time, also those of the reference: errors are compared as far as it has some.
if has_precision long; then
  check "a chaotic motion longer than any digits" text models/double_pendulum.lag chaos --until 300 --seconds 1 --methods taylor
  says '^the reference ends at t = .* s (an event ends the run, no digit is left, or it takes too long): errors are compared up to there'
fi

# Computed once for the same motion, kept beside the simulator.
references() { XDG_CACHE_HOME=$TMP/cache "$LAGC" cache | sed -n 's/^references *\([0-9]*\).*/\1/p'; }
if has_precision long; then
  kept() { # one that time cuts short is not kept: a busy machine has time enough
    XDG_CACHE_HOME=$TMP/cache "$LAGC" cost models/spring.lag "$@" --seconds 5 --methods rk4 --quiet && references
  }
  mkdir -p "$TMP/cache"
  is "a reference is kept" "1 1 2 3" "$(echo "$(kept free)" "$(kept free --target 1e-3)" "$(kept free k=5)" "$(kept free --until 3)")"
fi

interrupted() { # Ctrl-C: what is known is printed
  "$LAGC" cost models/double_pendulum.lag --seconds 60 >"$TMP/text" 2>"$TMP/err" &
  pid=$!
  sleep 4
  kill -TERM $pid
  wait $pid
  [ $? = 143 ] && grep -q '^interrupted' "$TMP/text" && grep -q '^cheapest setting' "$TMP/text"
}
# The bicycle's 7292 operations: gcc takes most of ten seconds for second derivatives of L alone.
in_time() { text models/bicycle.lag --quiet -o "$TMP/bicycle.json" && grep -q 'second derivatives of L are left out' "$TMP/err" && grep -q '"method": "radau' "$TMP/bicycle.json"; }
slow check "a model that takes long to compile" in_time
slow check "an interrupted sweep prints what it knows" interrupted

# A scene's monitor is a demand: no answer is stopped by it. rk4 loses (w h)^6/72 of the energy a step, so 1e-6 of it in 20 s at steps of 0.023 s at most.
watched() {
  sed 's/^scene free.*/&\n  monitor energy 1e-6/' models/spring.lag >"$TMP/watched.lag"
  text "$TMP/watched.lag" free --methods rk4 --seconds $sweep --target 1 || return 1
  h=$(sed -n 's/^  lagc run .* --step //p' "$TMP/text")
  echo "step $h"
  awk -v h="$h" 'BEGIN { exit !(h > 0.01 && h < 0.024) }' && grep -q "^.lagc run. refuses cheaper settings: monitor energy" "$TMP/text"
}
check "answers keep the scene's monitors" watched

# How far each precision carries: against the time at which motions of this precision and of the next one part by 0.3 of their size. The growth is known from
# doubles alone, and varies along chaos: hence 20 %.
parts() { # TIME BETWEEN ROWS, PRECISIONS AND TOLERANCES...
  every=$1 coarse=$2 fine=$4
  "$LAGC" run "$model" $scene --until "$until" --every "$every" --precision "$coarse" --method taylor --tol "$3" --quiet -o "$TMP/a.csv" 2>"$TMP/err" &&
    "$LAGC" run "$model" $scene --until "$until" --every "$every" --precision "$fine" --method taylor --tol "$5" --quiet -o "$TMP/b.csv" 2>"$TMP/err" || return 1
  paste -d , "$TMP/a.csv" "$TMP/b.csv" | awk -F , 'NR > 1 { h = NF/2; for (i = 2; i <= 3; i++) { v = $i < 0 ? -$i : $i; if (v > s) s = v
    d = $i - $(i + h); if (d < 0) d = -d; if (d > 0.3*s) { print $1; exit } } }'
}
carries() { sed 's/{"precision"/\n&/g' "$TMP/json" | sed -n "s/.*\"precision\": \"$1\", \"horizon\": \([^,]*\).*/\1/p"; }
precisions() {
  model=models/$1.lag scene=$2 until=$3
  "$LAGC" cost "$model" "$scene" --until "$until" --methods rk45 --seconds 5 --json >"$TMP/json" || return 1
  set -- "$(carries double)" "$(parts "$4" double 2e-15 long 1e-18)" "$(carries long)" "$(parts "$4" long 1e-18 quad 1e-26)" "$(carries quad)"
  echo "$*"
  awk -v a="$1" -v b="$2" -v c="$3" -v d="$4" -v e="$5" 'BEGIN { exit !(b > 0 && a > 0.8*b && a < 1.2*b && d > 0 && c > 0.8*d && c < 1.2*d && e > c) }'
}
if has_precision long && has_precision quad; then
  slow check "the precisions of the double pendulum" precisions double_pendulum chaos 60 0.05
  slow check "of the Lorenz attractor" precisions lorenz butterfly 80 0.05
  slow check "of Henon and Heiles" precisions henon_heiles chaos 2000 1
fi
check "what a regular motion loses" cost models/spring.lag free --methods rk4 --seconds $sweep
check "is little" awk -v h="$(carries double)" 'BEGIN { print h; exit !(h == "null" || h > 1e9) }'

refused "an unknown method" 'did you mean verlet' models/pendulum.lag --methods verlet5
check "a method at one value of its option" text models/pendulum.lag --until 2 --methods "gauss(stages=2),rk4" --seconds 1 --all
check "is that one" [ "$(grep -c '^  gauss' "$TMP/text")" = 1 ]
refused "a value that is not tried" 'gauss(stages=1) to 4' models/pendulum.lag --methods "gauss(stages=9)"
refused "a target of zero" 'example --target 1e-8' models/pendulum.lag --target 0
refused "no time to spend" 'example --seconds 60' models/pendulum.lag --seconds 0
refused "a time in words" 'is not a number' models/pendulum.lag --seconds long
refused "a picture of another kind" 'cost writes a picture, .svg or .png' models/pendulum.lag -o cost.jpg
refused "no time to run" 'nothing to compute' models/pendulum.lag --until 0
refused "a tolerance" 'it runs all methods' models/pendulum.lag --tol 1e-9
echo garbage >"$TMP/garbage"
"$LAGC" build models/pendulum.lag --method taylor -o "$TMP/sim" >"$TMP/out" 2>&1
bad_reference() { "$TMP/sim" --cost --against "$TMP/garbage" 2>"$TMP/err"; [ $? = 2 ] && grep -q 'holds no reference' "$TMP/err"; }
check "what is no reference is refused" bad_reference
# With more digits than doubles have lagc computes the reference in them, from the given values and up to the given time.
precise_reference() {
  "$LAGC" cost models/pendulum.lag th='30[deg]' --until 2 --methods rk4 --seconds 0.5 --runs >"$TMP/out" || return 1
  "$LAGC" build models/pendulum.lag --precision long --method taylor -o "$TMP/precise" && "$TMP/precise" --reference th=0.52359877559829882 --until 2 >"$TMP/reference"
  "$TMP/sim" --cost th=0.52359877559829882 --until 2 --methods rk4 --seconds 0.5 --runs --against "$TMP/reference" >"$TMP/other" || return 1
  errors() { awk '/step=/ { sub(/^\*/, ""); print $1, $2 }' "$1" | head -4; }
  grep -q '^reference: taylor, 19 digits' "$TMP/out" && [ "$(errors "$TMP/out")" = "$(errors "$TMP/other")" ]
}
if has_precision long; then check "a reference from the start of the command" precise_reference; fi
own_reference() { "$TMP/sim" --reference >"$TMP/reference" && "$TMP/sim" --cost --against "$TMP/reference" --methods rk45 --runs >"$TMP/out" && grep -q 'rk45(tol=1e-10)' "$TMP/out"; }
check "one simulator's reference serves another" own_reference
check "--math libm" "$LAGC" cost models/pendulum.lag --math libm --methods verlet4 --until 1 --seconds 0.5 --quiet
# Beside other programs, too, the time is the clock's: a command that was stopped for two seconds has none left but for a third of what it was given.
ends_in_time() {
  "$LAGC" build models/figure_eight.lag --method taylor -o "$TMP/cost_sim" || return 1
  "$TMP/cost_sim" --cost --seconds 1 --until 3e5 >"$TMP/out" 2>&1 &
  sleep 0.3; kill -STOP $!; sleep 2; kill -CONT $!
  begin=$(date +%s%N); wait $!
  took=$((($(date +%s%N) - begin)/1000000)); echo "$took ms"; cat "$TMP/out"
  [ $took -lt 900 ]
}
[ "$(date +%N)" = N ] || slow check "a command that was stopped ends in time" ends_in_time
tap_end
