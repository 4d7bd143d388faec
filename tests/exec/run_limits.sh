#!/bin/sh
# Models that could take for ever, as TAP: each ends in an answer, or in a message that names a limit, within seconds.
# (The time limit is far above the usual time; without the guards these models would not finish in a day.)
cd "$(dirname "$0")/../.." || exit 2
. tests/tap.sh
dir=$TMP/run_limits.$$
mkdir -p "$dir" || exit 2
trap 'rm -rf "$dir"' EXIT

# model NAME < statements: a file with one coordinate
model() {
  { printf 'model m "limits"\ncoord x\n'; cat; } >"$dir/$1.lag"
}
lines() { awk -v n="$1" "BEGIN { for (i = 1; i <= n; i++) $2 }"; }

# answer NAME: `check` and `emit` succeed, `derive` prints less than a megabyte
answer() {
  for c in check emit; do
    timeout 60 "$LAGC" $c "$dir/$1.lag" >"$dir/out" 2>"$dir/err" || { echo "$c: exit status $?"; head -c 2000 "$dir/err"; return 1; }
  done
  timeout 60 "$LAGC" derive "$dir/$1.lag" >"$dir/out" 2>"$dir/err" || { echo "derive: exit status $?"; return 1; }
  [ "$(wc -c <"$dir/out")" -lt "${2:-1000000}" ] || { echo "derive prints $(wc -c <"$dir/out") bytes"; return 1; }
}
# limit NAME STATUS WORDS: `check` ends with that status and message
limit() {
  timeout 60 "$LAGC" check "$dir/$1.lag" >"$dir/out" 2>"$dir/err"
  code=$?
  head -c 2000 "$dir/err"
  [ "$code" = "$2" ] && grep -q -e "$3" "$dir/err"
}

# starved NAME: with 400 MB, of the 2 GB that lagc allows itself, `check` reports the end of memory
starved() {
  (ulimit -v 400000 && limit "$1" 2 'out of memory')
}

model powers <<'END'
lagrangian = x'^2/2 + x^(10^9) + x^1e300 + (1 + x)^(2^62) + 0^0 + (x)^(1/3) + (-8)^(1/3)*x
END
check 'huge exponents, 0^0, roots of negative numbers' answer powers
model doubled <<'END'
function f(a) = sin(a) + cos(a)
function g(a) = f(f(f(f(f(f(f(f(a))))))))
lagrangian = x'^2/2 + g(g(g(g(x))))
END
check 'a function doubled 32 times' answer doubled
grep -q 'too long to print' "$dir/out"
is 'derive says what it does not print' 0 $?
{ echo 'let a1 = x'; lines 60 'printf "let a%d = a%d*sin(a%d) + a%d\n", i + 1, i, i, i'; echo "lagrangian = x'^2/2 + a61"; } | model lets
check 'a let doubled 60 times' answer lets
{ echo 'let a0 = x'; lines 100000 'printf "let a%d = a%d + x\n", i, i - 1'; echo "lagrangian = x'^2/2 + a100000"; } | model chain
slow check 'a chain of 100,000 lets' answer chain 10000000
{ echo 'let a0 = x'; lines 20000 'printf "let a%d = sin(a%d) + x\n", i, i - 1'; echo "lagrangian = x'^2/2 + a20000"; } | model sines
slow check 'a chain of 20,000 sines' answer sines 10000000
{ printf "lagrangian = x'^2/2"; lines 20000 'printf " + %d*x^%d", i, i'; echo; } | model sum
slow check 'a sum of 20,000 powers' answer sum 10000000
{ printf "lagrangian = x'^2/2 + "; lines 1000 'printf "if(x > %d, ", i'; printf x; lines 1000 'printf ", %d)", i'; echo; } | model ifs
slow check '1,000 choices inside each other' answer ifs
{ lines 1500 'printf "scene s%d { start x = 1 }\neffect e%d { force x = %d }\n", i, i, i'; echo "lagrangian = x'^2/2"; } | model scenes
slow check '1,500 scenes and 1,500 effects' answer scenes

{ printf "lagrangian = x'^2/2 + "; lines 30000 'printf "sin("'; printf x; lines 30000 'printf ")"'; echo; } | model deep
# The derivatives of an expression, a product for each level, need gigabytes: refused before they are made.
at_once() { (ulimit -t 2; ulimit -v 200000; limit deep 1 'functions are nested 30000 deep here, and at most 2000 in one expression'); }
check '30,000 sines inside each other' at_once
{ lines 40000 'printf "observe o%d = x*%d\n", i, i'; printf "lagrangian = x'^2/2\nscene s { start x = 1; span 1; output x"; lines 40000 'printf ", o%d", i'; echo ' every 1 }'; } | model outputs
names() { (ulimit -t 3; "$LAGC" check "$dir/outputs.lag" >/dev/null); } # 0.2 s; 5.5 where each name takes as long as its line
check '40,000 outputs on a line' names
{ echo 'function f0(a) = a*a + 1'; lines 40 'printf "function f%d(a) = f%d(f%d(a))\n", i, i - 1, i - 1'; echo "lagrangian = x'^2/2 + f40(x)"; } | model power_tower
slow check 'a function applied 2^40 times' starved power_tower
model integral <<'END'
coord y
let a = 2*atan(tanh(y/2))
let b = cos(2*atan2(-(2*a + t), sqrt(1 + (tanh(sin(y)) - atan(tanh(1/4)))^2)))^3
lagrangian = (x'^2 + y'^2)/2 - b/(1 - b^2)*x' - y/2 - b
END
check 'a potential of 300,000 terms, which is not looked for' timeout 20 "$LAGC" check "$dir/integral.lag" # 1 s, and 50 s where it is
model infinite <<'END'
lagrangian = x'^2/2 + 1e999*x
END
check 'a number past the range of a double' limit infinite 1 'a number here is not finite'
model overflow <<'END'
lagrangian = x'^2/2 + 1e300*x^(1e100)
END
check 'a derivative past the range of a double' limit overflow 1 'a number in the equations of motion is not finite'
{ printf "let a = x"; lines 50000 "printf \"'\""; echo; echo "lagrangian = x'^2/2"; } | model primes
check '50,000 primes' limit primes 1 'second derivative'
{ lines 1000 'printf "let a%d = a%d\n", i, i % 1000 + 1'; echo "lagrangian = x'^2/2"; } | model ring
check 'a ring of 1,000 lets' limit ring 1 'is circular'
{ printf "lagrangian = x'^2/2 + "; lines 40 'printf "sum(i in 1..2, "'; printf x; lines 40 'printf ")"'; echo; } | model sums
slow check '40 sums inside each other' limit sums 1 'sums inside sums run through more than'
{ lines 20000 'printf "let a%d = q%d\n", i, i'; echo "lagrangian = x'^2/2"; } | model unknown
slow check '20,000 unknown names' limit unknown 1 'unknown name'
echo "lagrangian = x'^2/2 - sum(i in 1..1000000, i)*x" | model longest
check 'the longest range there may be' timeout 60 "$LAGC" check "$dir/longest.lag"
table() { # ROWS: a model with an input of so many
  awk -v n="$1" 'BEGIN { print "t [s],u"; for (i = 1; i <= n; i++) print i "," i % 2 }' >"$dir/table.csv"
  { echo "lagrangian = x'^2/2 + u*x"; echo "input u = \"table.csv\""; } | model table
}
table 100000
check 'the longest table' timeout 60 "$LAGC" check "$dir/table.lag"
table 100001
check 'a longer one' limit table 1 'a table has at most 100000 rows'
tap_end
