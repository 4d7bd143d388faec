#!/bin/sh
# Large families whose texts follow from small ones (model/family_size.h): the same text as from the model of the size itself, in a time and a memory that do not depend on the
# size; and texts in which some member far from the ends is special, which must not follow.
. tests/tap.sh

mkdir -p "$TMP/whole"
# text NAME LINE...: a file of the name
text() {
  file=$1.lag
  shift
  printf '%s\n' 'model sizes "bodies on a line"' 'const N = 100' 'coord x[N]' 'param k = 1 > 0, h = 0.1 > 0' "$@" 'scene go { span 1 }' >"$TMP/$file"
}
# Messages without what they quote of the text.
messages() { sed -n 's/`[^`]*`//g; s/^[^ ]*: \(error\|warning\|note\)/\1/p' "$1"; }
# even COMMAND FILE SIZE: what the command writes is that of a text with the number in the place of N, which has no constant whose value could be another one
even() {
  sed "s/^const N = .*//; s/\\bN\\b/$3/g" "$TMP/$2" >"$TMP/whole/$2"
  (cd "$TMP" && "$LAGC_AT" $1 "$2" -D N="$3" >small.out 2>small.err) || { cat "$TMP/small.err"; return 1; }
  (cd "$TMP/whole" && "$LAGC_AT" $1 "$2" >../whole.out 2>../whole.err) || { cat "$TMP/whole.err"; return 1; }
  messages "$TMP/whole.err" >"$TMP/whole.said"
  messages "$TMP/small.err" | cmp - "$TMP/whole.said" && cmp "$TMP/small.out" "$TMP/whole.out"
}
case $LAGC in /*) LAGC_AT=$LAGC ;; *) LAGC_AT=$PWD/$LAGC ;; esac

bodies="kinetic = sum(i in 1..N, k/2*x[i]'^2)"
pairs='potential = -sum(i in 1..N, sum(j in 1..i-1, k/sqrt((x[i] - x[j])^2 + h^2)))'
ring='potential = sum(i in 1..N, k/2*(x[if(i < N, i+1, 1)] - x[i])^2)'

# ---- the text is that of the size itself
text pairs "$bodies" "$pairs" 'symmetry shift(s): x[i in 1..N] -> x[i] + s'
text ring "$bodies" "$ring + k*x[N/2]^2 - sum(i in 3..N-2, h*i/(N + 1 - i)*cos(x[N + 1 - i]))" 'force x[i in 2..N-1] = -h*(i - 1)*x[i]'"'"
text parity "$bodies" "$ring + sum(i in 1..N, (-1)^i*h*x[i])" 'observe all = sum(i in 1..N, x[i])/k'
for command in emit check derive; do check "$command, pairs, N = 2101" even $command pairs.lag 2101; done
check "emit, pairs, N = 4096" even emit pairs.lag 4096
for command in emit check derive noether 'derive --format latex' 'derive --format c' 'emit --standalone'; do
  check "$command, a ring, N = 2106" even "$command" ring.lag 2106
done
text mod "$bodies" "$(echo "$ring" | sed 's/if(i < N, i+1, 1)/mod(i, N) + 1/')" 'symmetry shift(s): x[i in 1..N] -> x[i] + s'
text if "$bodies" "$ring" 'symmetry shift(s): x[i in 1..N] -> x[i] + s'
check 'emit, a ring by mod' even emit mod.lag 2106
rings() { for file in mod if; do "$LAGC" "$1" "$TMP/$file.lag" -D N="$2" >"$TMP/$file.out" 2>"$TMP/$file.err" || return 1; done; cmp "$TMP/mod.out" "$TMP/if.out" && ! grep 'written out' "$TMP/mod.err"; }
sed -i 's/mod(i, N) + 1/mod(i - 2, N) + 1/' "$TMP/mod.lag" && sed -i 's/if(i < N, i+1, 1)/if(i > 1, i-1, N)/' "$TMP/if.lag"
for size in 7 2106; do check "emit, a ring by mod, which is that by if, N = $size" rings emit $size; done
check 'derive, every second member otherwise' even derive parity.lag 2100
# lines are filled alike, whether members have numbers of three digits or of four
text few "$bodies" 'potential = h*x[N-2]' 'observe ends = x[N-32] + x[N-31] + x[N-30] + x[N-29] + x[N-4] + x[N-3] + x[N-2] + x[N-1] + x[N]'
check 'emit, few members in lines' even emit few.lag 2183
text scales 'coord w' 'param g = 1' "kinetic = sum(i in 1..N, 1/2*x[i]'^2) + k*w'^2" 'potential = g*x[N-2] + g*x[1]'
check 'emit, terms that are short enough for one line' even emit scales.lag 3935
text band 'coord w' "kinetic = sum(i in 1..N, 1/2*x[i]'^2) + sum(i in 1..N-1, k/4*(x[i+1]' - x[i]')^2) + k*w'^2" 'potential = h*(x[31] - x[N/2])^2 - k*cos(x[3] - x[N-30])'
check 'emit, a band of masses' even emit band.lag 5448
# a part of the range that has 2000 terms is a sum, and one that has fewer is not
text part "$bodies" 'potential = sum(i in 20..N-32, h*x[i]^2)'
for size in 2050 2051 2100; do check "emit, $((size - 51)) of $size terms" even emit part.lag $size; done
# operations of trees do not grow as those of all pairs
text tree 'coord y[N]' "kinetic = sum(i in 1..N, k/2*(x[i]'^2 + y[i]'^2))" \
  'potential = -sum(i in 1..N, sum(j in 1..i-1, k/sqrt((x[i] - x[j])^2 + (y[i] - y[j])^2 + h^2), by tree(0.5)))'
check 'emit, a tree' even emit tree.lag 2500
# the last line says where a rate of the energy stands that it does not say itself, whatever its length
text rate 'function f(a) = if(a > 0, a^3, a^2)' "$bodies" 'potential = sum(m in 1..N, h*(x[m] - x[N + 1 - m])^2)' \
  "dissipation = sum(i in 1..N-1, h/2*(x[i+1]' - x[i]')^2)" 'force x[i in 2..N-1] = h*(x[i+1] + x[i-1])*x[i]'
check 'derive, a long rate of the energy' even derive rate.lag 5630
# sums in forces and flows of members, whose momenta are not listed one by one; a function of two means
text rotors 'state z[N]' "$bodies" "force x[i in 1..N] = k*sum(j in 1..N, sin(x[j] - x[i])) - h*x[i]'" \
  "for i in 2..N-1 { force x[i] = h*sum(j in 1..i-1, z[j]*(x[i]' - x[j]')/(1 + (x[i] - x[j])^2)) }" \
  "for i in 1..N { flow z[i]' = sum(j in i..N, if(i == j, 0, h)*sin(x[i])*z[j]) - k*z[i] }"
for command in emit check derive noether; do check "$command, forces and flows by sums" even $command rotors.lag 2101; done
text means "$bodies" 'let C = sum(i in 1..N, cos(x[i]))/N' 'let S = sum(i in 1..N, sin(x[i]))/N' 'potential = N*exp(-(C^2 + S^2)*k)'
for command in emit check; do check "$command, a function of two means" even $command means.lag 2101; done
# the charge of a sum that stays one, in the model with an effect
text spent "$bodies" "potential = sum(i in 1..N, h*cos(x[i]))" "effect drag { dissipation = h*x[1]'^2; potential = h*x[2]^2 }" "effect slow { dissipation = h*x[1]'^2 }"
check 'noether, an effect takes energy from sums' even noether spent.lag 2100
charge="Q1 = sum(i in 1..2100, k*x[i]'^2/2) + sum(i in 1..2100, h*cos(x[i])) + h*x[2]^2"
spends() { "$LAGC" noether "$TMP/spent.lag" -D N=2100 >"$TMP/spent.out" 2>&1 && grep -qF "$charge" "$TMP/spent.out" && [ "$(grep -c 'Q1 =' "$TMP/spent.out")" = 2 ]; }
check 'its charge is that of the model and what the effect adds' spends

# headers, whose lists of names are as long as the families
for file in pairs ring parity mod few scales band part tree rate spent; do check "header, $file, N = 2234" even header $file.lag 2234; done
check 'header, pairs, N = 4096' even 'header --with names' pairs.lag 4096

# ---- neither time nor memory depends on the size; 60 MB hold some 300 coordinates, and 10^6 take 3 GB
bounded() { (ulimit -v 60000 && "$LAGC" "$@" >"$TMP/bounded.out" 2>&1) || { tail -3 "$TMP/bounded.out"; return 1; }; }
if [ -z "${SAN:-}" ] && (ulimit -v 60000) 2>/dev/null; then
  for command in emit check derive noether; do check "$command of 10^6 bodies in 60 MB" bounded $command "$TMP/pairs.lag" -D N=1000000; done
  check 'header of 20,000 bodies in 60 MB' bounded header "$TMP/pairs.lag" -D N=20000 -o "$TMP/bounded.h"
fi
# projections onto a constraint over all members sum no pairs, and its row fills no matrix: 0.1 s of 3, where either takes 5 and more
text centred 'param m[N] = 1 > 0' "kinetic = sum(i in 1..N, m[i]/2*x[i]'^2)" "$pairs" 'constraint com: sum(i in 1..N, m[i]*x[i]) = 0'
quick() { (ulimit -t 3; "$LAGC" check "$TMP/$1.lag" -D N="$2" >"$TMP/quick.out" 2>&1) || { tail -3 "$TMP/quick.out"; return 1; }; }
[ -n "${SAN:-}" ] || check 'check of 800 members whose centre is held, in 3 s' quick centred 800
# values of long sums are sampled once for all members: .3 s of 3, where sums in each sample took 19
[ -n "${SAN:-}" ] || check 'check of a function of two means of 2001 members, in 3 s' quick means 2001
# forces that couple all members: .1 s of 3, where their potential was looked for in 55
text coupled "$bodies" 'let C = sum(i in 1..N, cos(x[i]))/N' 'let S = sum(i in 1..N, sin(x[i]))/N' 'force x[i in 1..N] = k*(S*cos(x[i]) - C*sin(x[i]))'
[ -n "${SAN:-}" ] || check 'check of 400 members that a mean field moves, in 3 s' quick coupled 400
# constraints take memory for the coordinates that they contain, not for all: 128 MB for each matrix of 4000 rows, of which there were 5 in a run
text pinned "$bodies" 'potential = sum(i in 1..N-1, h*(x[i+1] - x[i])^2)' 'constraint pin: x[1] = 0' 'scene off { start x = 1; span 0.01; output x[1] every 0.01 }'
pinned() { (ulimit -v 150000 && "$LAGC" run "$TMP/pinned.lag" off -D N=4000 -o "$TMP/pinned.csv" --quiet) && [ "$(sed 1d "$TMP/pinned.csv" | cut -d, -f2 | sort -u)" = 0 ]; }
text mean "$bodies" 'constraint mean: sum(i in 1..N, x[i]) = 0'
sparse() { (ulimit -v 100000 && "$LAGC" emit "$TMP/mean.lag" -D N=3000 -o "$TMP/mean.c"); }
told() { ! (ulimit -v 500000 && "$LAGC" run "$TMP/mean.lag" -D N=4000 --quiet) 2>"$TMP/told.err" && grep -q 'the start on the constraints takes 384 MB for the 4000 coordinates' "$TMP/told.err"; }
if [ -z "${SAN:-}" ]; then
  check 'a run of 4000 members, one of them pinned, in 150 MB' pinned
  check 'C of one constraint over 3000 members in 100 MB' sparse
  check 'a start that needs more memory says so' told
fi
# a start looks for the largest coordinate of a unit once, not for each member: 0.5 s of 3, 9 and more otherwise
text walled 'coord th[N] [rad]' "kinetic = sum(i in 1..N, (x[i]'^2 + th[i]'^2)/2)" 'contact floor[i in 1..N]: x[i] >= -h, restitution = 0' \
  'contact wall: x[1] >= -h, restitution = 0' 'scene rows { start x[i in 1..N] = k*(i - 4*floor(i/4)); span 1 }'
[ -n "${SAN:-}" ] || check 'check of 20000 members and a single contact, in 3 s' quick walled 20000
"$LAGC" emit "$TMP/pairs.lag" -D N=200000 -o "$TMP/large.c"
compiles() { "$CC" -std=c11 -O0 -Wall -Werror -I"$INC" -c -o "$TMP/large.o" "$TMP/large.c"; }
check 'the C of 200,000 bodies compiles; its sums do not lie on the stack' compiles
check 'they are static' grep -q 'static _Thread_local LAG_REAL sum_of_thread\[200000\]' "$TMP/large.c"

# ---- members of large families by their names: free motion, r = (1 + 2 t, 10 + 20 t, 100 + 200 t) i, and states z = i; two units
cat >"$TMP/named.lag" <<'END'
model named "free points that turn"
const N = 3000
coord r[N]: vec3 [m], a[N] [rad]
state z[N]
param m = 1 [kg] > 0, J = 1 [kg*m^2] > 0
param c[N] = 2
kinetic = sum(i in 1..N, m/2*dot(r[i]', r[i]') + J/2*a[i]'^2)
for i in 1..N { flow z[i]' = 0*c[i] }
scene go {
  start r[i in 1..N] = (i, 10*i, 100*i) [m], r[i in 1..N]' = (2*i, 20*i, 200*i) [m/s], a[i in 1..N] = i, z[i in 1..N] = i
  span 1 [s]
}
END
named() { # CPU seconds are few: at 8 units a look-up, 15,000 columns took minutes
  (ulimit -t 20 && "$LAGC" sweep "$TMP/named.lag" 'c[2999]=3,4' --until 1 --method rk4 --step 0.5 --compile never --quiet -o "$TMP/named.csv") || return 1
  awk -F, 'NR == 1 { for (i = 1; i <= NF; i++) { name = $i; sub(/ .*/, "", name); gsub(/"/, "", name); at[name] = i } next }
    { n++; ok += $at["c[2999]"] == n + 2 && $at["r[1].x"] == 3 && $at["r[2999].y"] == 89970 && $at["r[3000].z"] == 900000 &&
      $at["r[1234].z\047"] == 246800 && $at["a[3000]"] == 3000 && $at["z[7]"] == 7 && $at["z[3000]"] == 3000 }
    END { exit !(ok == 2 && n == 2) }' "$TMP/named.csv" || { cut -c1-200 "$TMP/named.csv"; return 1; }
}
check 'a sweep has all members of large families by their names' named

# ---- texts with members, or numbers, that are special far from the ends
# special COMMAND WHAT LINE...: the first file gives the text of the size, too
special() {
  command=$1 what=$2
  shift 2
  text special "$@"
  check "$what: $command" even $command special.lag 2099
}
special emit 'a member by its number' "$bodies" "$ring + k*x[1500]^2"
special emit 'members from a number on' "$bodies" "potential = sum(i in 1..N, if(i > 1500, 2, 1)*k*x[i]^2)"
negative() { special check "$1" "kinetic = sum(i in 1..N, if($2, -1, 1)*k/2*x[i]'^2)" "$ring"; }
negative 'masses from a number on' 'i > 1500'
negative 'masses by a scaled index' '0.001*i > 1.5'
negative 'masses by a product' '30*30 < i'
negative 'masses by a sum of small numbers' 'i > 30 + 30 + 30 + 30 + 30 + 30 + 30 + 30 + 30 + 30 + 30 + 30 + 30'
negative 'masses by the index twice over' 'i > 2*(2*(2*(2*(2*30))))'
negative 'masses by a function' 'floor(i/1000) > 0'
special emit 'the third part of the range' "$bodies" "potential = sum(i in 1..N, if(3*i < N, 2, 1)*k*x[i]^2)"
special emit 'members by a remainder' "$bodies" "potential = sum(i in 1..N, k*x[mod(i, 7) + 1]*x[i])"
special emit 'a constant that ends its growth' 'const M = min(N, 1500)' "$bodies" "potential = sum(i in 1..M, k*x[i]^2)"
special emit 'a constant that jumps' 'const M = if(N > 1500, 2, 3)' "$bodies" "potential = sum(i in 1..N, M*k*x[i]^2)"
special emit 'a function that jumps' 'function f(a) = if(a > 1500, 2, 1)' "$bodies" "potential = sum(i in 1..N, f(i)*k*x[i]^2)"
special check 'masses that become negative' "kinetic = sum(i in 1..N, (2 - 0.0011*i)*k/2*x[i]'^2)" "$ring"
special check 'masses that a sine makes negative' "kinetic = sum(i in 1..N, cos(0.001*i)*k/2*x[i]'^2)" "$ring"
special check 'masses whose terms cancel' "kinetic = sum(i in 1..N, ((3 - i) + 0.999*i)*k/2*x[i]'^2)" "$ring"
special check 'masses of parameters that become negative' "kinetic = sum(i in 1..N, (k*2 - 0.0011*k*i)/2*x[i]'^2)" "$ring"
special check 'masses of parameters that a sine makes negative' "kinetic = sum(i in 1..N, cos(0.001*k*i)*k/2*x[i]'^2)" "$ring"
special check 'a parameter of each that becomes negative' 'param c[i in 1..N] = 2*k - 0.001*i' "kinetic = sum(i in 1..N, c[i]/2*x[i]'^2)" "$ring"
special check 'terms of masses' "kinetic = sum(i in 1..N, k*2*x[i]'^2 - 0.0011*k*i*x[i]'^2)" "$ring"
special check 'terms of masses, by their number' "kinetic = 1500*k*x[1]'^2 + sum(i in 2..N, k*x[i]'^2) - sum(j in 1..N, k*x[1]'^2)" "$ring"
special check 'a value by the size' 'param c = N' "kinetic = sum(i in 1..N, (1500 - c)/2*x[i]'^2)" "$ring"
special check "a scene's value by the size" 'param c = 1' "kinetic = sum(i in 1..N, (1500 - c)/2*x[i]'^2)" "$ring" 'scene first { c = N }'
special check 'a function of a value by the size' 'function f(a) = 1500 - a' 'param c = N' "kinetic = sum(i in 1..N, f(c)/2*x[i]'^2)" "$ring"
special emit 'a constant with the name of an index' 'const j = 200' "kinetic = sum(i in 1..N, if(j < i and i < N/2, 1, -1)*k/2*x[i]'^2)" "$ring + sum(j in 1..3, x[j]^2)"
special emit 'a parameter with decimals' 'param c = 0.001*N' "$bodies" "potential = sum(i in 1..N, c*x[i]^2)"
special emit 'a length over the number' "$bodies" "potential = sum(i in 1..N, k/N*x[i]^2)"

# ---- M = 3000 k - N k of x[1]: a cell of sums beside whose terms others read x[1]'
printf '%s\n' 'model shared' 'const N = 2500' 'coord x[N]' 'param k = 1 > 0' "kinetic = 1500*k*x[1]'^2 - sum(i in 1..N, k*x[1]'^2/2) + sum(i in 2..N, x[i]'^2/2)" 'potential = sum(i in 1..N, x[i]^2/2)' >"$TMP/shared.lag"
check 'a constant mass less a sum' says 0 '2500 coordinates; mass matrix constant, positive definite' "$LAGC" check "$TMP/shared.lag"
check 'one that the sum cancels' says 1 'singular in every state: without inertia: `x[1]`' "$LAGC" check "$TMP/shared.lag" -D N=3000
tap_end
