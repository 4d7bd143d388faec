#!/bin/sh
# Equilibria and small motion about them, as `lagc modes` finds them: Lagrange's points for three mass ratios, with Jacobi's constant and the
# squares of the eigenvalues; the frequencies of a chain. Digits: cases.json.
. tests/tap.sh
. tests/hard/lib_cases.sh

[ -n "$GSL" ] || skip_all "lagc modes needs GSL"
# The reference values of CASE at PLACE, NAME VALUE or VALUE a line.
reference() {
  awk -v id="$1" -v place="$2" '/^   "id": / { here = index($0, "\"" id "\"") }
    here && index($0, "    \"" place "\": ") == 1 { on = 1; if (!/[[{]$/) { gsub(/.*: "|",?$/, ""); print; on = 0 }; next }
    on && /^    [}\]]/ { on = 0 }
    on { gsub(/[",\[{]|^ *|: *$/, ""); sub(/:/, ""); if (/[0-9a-zA-Z]/) print }' $hard/cases.json
}
within() { # GOT EXPECTED TOLERANCE, the numbers a word each
  awk -v a="$1" -v b="$2" -v tol="$3" 'BEGIN { n = split(a, x, " "); if (n == 0 || n != split(b, y, " ")) exit 1
    for (i = 1; i <= n; i++) { d = x[i] - y[i]; print "off by", d; if (!(d <= tol && -d <= tol)) bad = 1 }; exit bad }'
}
number() { sed -n "s/.*\"$1\": \([-+0-9.e]*\).*/\1/p"; }

model=$hard/cases/cr3bp_lagrange_points.lag
points() { # PLACE MU
  i=0
  for point in L1 L2 L3 L4; do
    i=$((i + 1))
    "$LAGC" modes $model $point mu="$2" --json >"$TMP/modes.json"
    found=$(sed 's/.*"equilibrium"//; s/"pairs".*//' "$TMP/modes.json")
    x=$(echo "$found" | number x)
    y=$(echo "$found" | number y)
    values=$(reference cr3bp-lagrange-points "$1")
    if [ $point = L4 ]; then
      check "$1: L4" within "$x $y" "$(echo "$values" | sed -n '/^L4/,/^C_J/p' | sed '1d;$d' | tr '\n' ' ')" 1e-13
    else
      check "$1: $point" within "$x $y" "$(echo "$values" | sed -n "s/^$point //p") 0" 1e-13
    fi
    constant=$(echo "$values" | sed -n '/^C_J/,/^res/p' | sed '1d;$d' | sed -n "${i}p")
    "$LAGC" run $model $point mu="$2" x="$x" y="$y" --observe C_J --observe ax --observe ay --until 1e-9 --method rk4 --step 1e-9 --json >"$TMP/run.json"
    check "$1: Jacobi's constant at $point, and no acceleration" within \
      "$(number C_J <"$TMP/run.json") $(number ax <"$TMP/run.json") $(number ay <"$TMP/run.json")" "$constant 0 0" 1e-13
    squares "$1" $point
  done
}
# The squares of the eigenvalues, re im each, of the last `lagc modes`.
squares() { # PLACE POINT
  values=$(reference cr3bp-lagrange-points "$1" | sed -n "/^lambda2_$2/,/^lambda2_L4/p" | sed '/^lambda2/d')
  [ "$2" = L4 ] && values=$(reference cr3bp-lagrange-points "$1" | sed -n '/^lambda2_L4/,$p' | sed 1d)
  case $2 in L1 | L4) ;; *) return ;; esac
  values=$(echo "$values" | tr -d '()j' | awk '{ if (NF == 1) print $1, 0; else print $1, $2 $3 }' | sort -k2,2g -k1,1g | tr '\n' ' ')
  found=$(tr '{' '\n' <"$TMP/modes.json" | sed -n 's/^"re": \([^,]*\), "im": \([^,]*\),.*/\1 \2/p' |
    awk '{ for (sign = -1; sign <= ($1*$2 == 0 ? -1 : 1); sign += 2) printf "%.17g %.17g\n", $1*$1 - $2*$2, 2*$1*$2*sign }' | sort -k2,2g -k1,1g | tr '\n' ' ')
  # A limit, see README.md: where all modes oscillate about L4, two digits are lost on the way from the matrices to their eigenvalues.
  [ "$2" = L4 ] && [ "$1" != mu_0.3 ] && allowed=4e-12 || allowed=1e-13
  check "$1: small motion about $2" within "$found" "$values" $allowed
}
points EarthMoon_mu_0.012150585609624 0.012150585609624
points Arenstorf_mu_0.012277471 0.012277471
points mu_0.3 0.3

"$LAGC" modes $hard/cases/oscillator_chain_N10.lag --json >"$TMP/modes.json"
rates=$(tr '{' '\n' <"$TMP/modes.json" | sed -n 's/^"re": [^,]*, "im": \([^,]*\),.*/\1/p' | sed -n '1p;2p;$p' | tr '\n' ' ')
check "a chain's frequencies" within "$rates" "$(for k in omega_1 omega_2 omega_N; do reference oscillator-chain-N10 $k; done | tr '\n' ' ')" 1e-13
tap_end
