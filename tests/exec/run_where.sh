#!/bin/sh
# lagc cost --where: shares of a run's time. Shares follow what is known of a run from outside: rows alone cost time where nothing else does, exp() is
# the C library's, elimination of a full matrix is linear algebra.
. tests/tap.sh
where() { "$LAGC" cost "$@" --where --json --seconds 1 >"$TMP/json" 2>"$TMP/err" || { cat "$TMP/err"; return 1; }; }
holds() { # CONDITION of the shares and values: $name
  awk -v condition="$1" '{ gsub(/[{}",:]/, " "); for (i = 1; i < NF; i++) v[$i] = $(i + 1) }
    END { n = split("right_hand_side derivatives linear_algebra newton method constraints events monitors output library other", part, " ")
      for (i = 1; i <= n; i++) sum += v[part[i]]
      if (sum < 0.999 || sum > 1.001) { print "the shares add up to " sum; exit 1 }
      split(condition, c, " "); x = v[c[1]]
      print condition, x; exit !(c[2] == ">" ? x > c[3] : x < c[3]) }' "$TMP/json"
}

if [ "$(uname -s)" != Linux ]; then
  echo "ok 1 # skip samples are taken on Linux"
  echo 1..1
  exit
fi

cat >"$TMP/hard.lag" <<'END'
model hard
coord x
lagrangian = x'^2/2 - sum(k in 1..6, exp(-k*x^2) + exp(k*x/7) + x^2^k/100)
scene rows { start x = 1; span 1; output x every 1e-3; method rk4(step=0.01) }
scene steps { start x = 1; span 20; output x every 10; method rk4(step=1e-4) }
END
check "a run of rows" where "$TMP/hard.lag" rows
check "is output" holds "output > 0.8"
check "a run of steps" where "$TMP/hard.lag" steps
check "is no output" holds "output < 0.05"
check "but the library's exp" holds "library > 0.1"

check "a chain of stiff links by radau" where models/fput_stiff.lag --method radau --tol 1e-9 --until 1
check "has linear algebra" holds "linear_algebra > 0.05"
slow check "by rk45" where models/fput_stiff.lag --method rk45 --tol 1e-9 --until 1
slow check "has none" holds "linear_algebra < 0.005"
check "gauss" where models/chain.lag --method gauss --until 2
check "has Newton's method" holds "newton > 0.1"
check "and derivatives of the Lagrangian" holds "derivatives > 0.02"
check "a mechanism" where models/slider_crank.lag spun --until 1
check "has constraints" holds "constraints > 0.01"

check "as text" sh -c '"$0" cost models/pendulum.lag --where --seconds 0.5 >"$1"' "$LAGC" "$TMP/text"
for line in '^model pendulum, scene small, to t = .* s by ' '^  output: rows as CSV .* %' '^this processor makes at most' '^functions with the largest shares'; do
  check "says: $line" grep -q -e "$line" "$TMP/text"
done
refused() { # NAME PATTERN ARGS...
  name=$1 pattern=$2
  shift 2
  "$LAGC" cost "$@" >"$TMP/text" 2>"$TMP/err"
  check "$name is refused" [ $? = 2 ]
  check "with a way out" grep -q -e "$pattern" "$TMP/err"
}
refused "--method without --where" 'has no meaning for --cost.*--where' models/pendulum.lag --method rk4
refused "--target with --where" 'has no meaning for --where' models/pendulum.lag --where --target 1e-6
refused "a method that does not exist" 'rk4' models/pendulum.lag --where --method rk5
refused "no time" 'for example --seconds 60' models/pendulum.lag --where --seconds 0
refused "a span of zero" 'nothing to compute' models/pendulum.lag --where --until 0
stripped() { "$LAGC" build models/pendulum.lag -o "$TMP/bare" && strip "$TMP/bare" && { "$TMP/bare" --cost --where 2>"$TMP/err"; [ $? = 2 ]; } && grep -q strip "$TMP/err"; }
check "a program without names says so" stripped
tap_end
