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
const N = 9
coord th[N]
let u[i in 1..N] = sum(j in 1..i, sin(th[j]))
let h[i in 1..N] = -sum(j in 1..i, cos(th[j]))
kinetic = x'^2/2 + sum(i in 1..N, (u[i]'^2 + h[i]'^2)/2)
potential = sum(i in 1..N, h[i] + exp(sin(u[i])*cos(h[i])))
END
check 'products of sines of sums, whose normal forms are long' timeout 10 "$LAGC" check "$dir/powers.lag" # 0.2 s, and 20 s where dL/dq is judged by them
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
{ echo 'let w = sin(tanh(sinh(tanh(1/cosh(t)))))'; echo "lagrangian = 3/2*x'^2 + w'*x'/8 + atan(tan(tanh(w)))"; } | model grows
within() { (ulimit -t "$1" && "$LAGC" check "$2"); }
slow check 'a rate whose antiderivatives grow' within 25 "$dir/grows.lag" # 4 s of processor, and 50 s where what grows is followed
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
