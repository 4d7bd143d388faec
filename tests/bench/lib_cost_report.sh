#!/bin/sh
# make cost-report: models/COST.md and its pictures models/cost_NAME.svg: what accuracy costs in time, for eight models that differ in kind. Times are
# those of this machine, now; the sentences below each table are written by hand, and are to be read again after a change of methods.
: "${LAGC:=build/lagc}" "${CC:=cc}"
page=models/COST.md
part=$page.part-$$
trap 'rm -f "$part" "$part.text" "$part.csv" "$part.json" "$part.lag"' EXIT
machine=$(sed -n 's/^model name[^:]*: //p' /proc/cpuinfo 2>/dev/null | head -n 1)

cat >"$part" <<END
# What accuracy costs in time
Eight models that differ in kind, each by every method that can integrate it. The error is the largest difference from a reference at 16 times, relative to the
largest value of its kind and unit; times are processor times in ms. Written by \`make cost-report\`, on ${machine:-an unknown processor} with
$("$CC" --version | head -n 1); other machines have other times, and much the same ratios. \`lagc help cost\` says more.
END

# row NAME TITLE WORDS...: a section with its command, picture, table and the sentences on standard input
row() {
  name=$1 title=$2
  shift 2
  "$LAGC" cost "$@" --seconds "${SECONDS_EACH:-20}" -o "models/cost_$name.svg" >"$part.text" || exit 1
  {
    printf '\n## %s\n```\nlagc cost %s\n```\n![time against error](cost_%s.svg)\n\n' "$title" "$*" "$name"
    awk '/time .ms. for an error of/ { n = NF - 6; printf "| time [ms] for an error of |"; for (i = 7; i <= NF; i++) printf " %s |", $i; printf "\n| --- |"
        for (i = 7; i <= NF; i++) printf " ---: |"; print ""; on = 1; next }
      /^\* the fastest of all/ { on = 0 }
      on { printf "| %s |", $1; for (i = 2; i <= NF; i++) if ($i ~ /\*$/) { sub(/\*/, "", $i); printf " **%s** |", $i } else printf " %s |", $i; print "" }' "$part.text"
    printf '\nThe fastest settings: '
    awk '/^cheapest setting for an error of/ { error = $7; sub(/:/, "", error); getline; sub(/.*--method /, ""); printf "%s`%s` for %s", n++ ? ", " : "", $0, error }
      END { print "." }' "$part.text"
    echo
    cat
  } >>"$part"
}
row pendulum 'A pendulum, from the horizontal' models/pendulum.lag wide <<'END'
The solution is analytic everywhere, so the series of `taylor` converge fast, and each digit more costs it little: from 1e-4 to 1e-12 twice the time. Methods
of order 8 take a third more time for each digit pair. For a picture any method will do; for digits take `taylor`.
END
row double_pendulum 'A double pendulum, chaotic motion about to begin' models/double_pendulum.lag swing <<'END'
Accelerations cost more here, and depend on velocities, so the splitting methods become implicit, fifty times as slow as `dop853`. `rk45` is the fastest up
to three digits, `taylor` from four digits on. The last digit that a double has is the only one that `taylor` does not reach.
END
row kepler 'A comet, a hundred turns at e = 0.9' models/kepler.lag orbit e=0.9 --until 628.3185307179586 <<'END'
Speeds at the two ends of the orbit differ by a factor of 19: methods with equal steps must take the smallest everywhere, and pay for it by factors of 15 and more.
Errors grow with time, as t or t^2, and a hundred turns take digits from everyone: none has an error below 1e-10. What geometric methods are for, an energy
that does not drift, the next table shows.
END
# A table of its own: the same orbit over 10^4 turns, at about as many evaluations a turn. Errors are known in closed form: at whole turns the planet is back at
# its start. Growth: the slope of log error against log t over 16 times, 0.25 and less is bounded.
long_kepler() {
  cat <<'END'

## What geometric methods are for: 10^4 turns at e = 0.2
Each method makes about as many evaluations of the force. The error is that of the position, in semi-major axes, the phase's that of the direction, in radians,
both after 10^4 whole turns, when the planet should be back at its start; the energy's is the largest one on the way, relative. Beside each: how it grows.

```
END
  sed 's/ monitor energy 1e-8$//; s/^  monitor energy 1e-8$/  # no monitor: methods may lose what they lose/' models/kepler.lag >"$part.lag"
  cat <<'END'
lagc run kepler.lag orbit e=0.2 --until 62831.85307179586 --every 3926.990816987242 --method METHOD ... -o rows.csv   # without the monitor of the scene
```

| method | calls a turn | time [s] | position | | phase | | energy | |
| --- | ---: | ---: | ---: | --- | ---: | --- | ---: | --- |
END
  while read -r method setting; do
    # shellcheck disable=SC2086 # options
    "$LAGC" run "$part.lag" orbit e=0.6 --until 62831.853071795864769 --every 3926.9908169872415481 --method "$method" $setting -o "$part.csv" --json >"$part.json" 2>"$part.text" || { cat "$part.text"; exit 1; }
    calls=$(sed 's/.*"rhs_calls": \([0-9]*\).*/\1/' "$part.json")
    seconds=$(sed 's/.*"wall_s": \([0-9.e-]*\).*/\1/' "$part.json")
    drift=$(sed 's/.*"energy_drift": \([0-9.e-]*\).*/\1/' "$part.json")
    trend=$(sed 's/.*"energy": {[^}]*"trend": "\([a-z]*\)".*/\1/; s/oscillates/bounded/; s/grows/t/' "$part.json")
    awk -F, -v name="$method $setting" -v calls="$calls" -v seconds="$seconds" -v drift="$drift" -v trend="$trend" '
      function size(x) { return x < 0 ? -x : x }
      function law(k,    i, n, x, y, sx, sy, sxx, sxy, slope) { # of e[k, 1..16]
        for (i = 1; i <= 16; i++) if (e[k, i] > 0) { x = log(i); y = log(e[k, i]); n++; sx += x; sy += y; sxx += x*x; sxy += x*y }
        if (n < 8) return "-"
        slope = (n*sxy - sx*sy)/(n*sxx - sx*sx)
        return slope < 0.25 ? "bounded" : slope < 1.5 ? "t" : "t^2"
      }
      NR == 1 { for (i = 1; i <= NF; i++) { h = $i; sub(/ .*/, "", h); at[h] = i }; next }
      { x = $at["x"]; y = $at["y"] }
      NR == 2 { x0 = x; next }
      { k = NR - 2; e[1, k] = sqrt((x - x0)^2 + y^2); e[2, k] = size(atan2(y, x)); for (i = 1; i <= 2; i++) if (e[i, k] > most[i]) most[i] = e[i, k] }
      END { printf "| `%s` | %.0f | %.2f |", name, calls/1e4, seconds
        for (i = 1; i <= 2; i++) printf (most[1] > 0.5 ? " lost | |" : " %.1e | " law(i) " |"), most[i]
        printf " %.1e | %s |\n", drift, trend }' "$part.csv"
  done <<'END'
verlet --step 0.0065449846949787354
verlet4 --step 0.039269908169872414
verlet8 --step 0.12566370614359174
rk4 --step 0.026179938779914941
rk45 --tol 1e-9
dop853 --tol 1e-13
taylor --tol 1e-12
END
  cat <<'END'

At equal work the geometric methods end with an energy that is wrong by as much as after the first turn, and a phase that has drifted in proportion to time. The others lose
energy with each turn, so that their phase drifts as the square of time. High order beats both, until it, too, has run long enough: choose by the length of the run.
END
}
long_kepler >>"$part"
row planets 'The outer planets, a century' models/outer_planets.lag centuries --until 3e9 <<'END'
Orbits of small eccentricity around one dominant mass: `wisdom_holman`, exact on each planet's ellipse and with its pulls between by a corrector, is the fastest down to six
digits, by a factor of 1.5 to 2, at two to eight steps an orbit of Jupiter. `taylor` leads from there to rounding, where the equal steps of `verlet8` get the last digit.
Implicit methods solve equations that explicit ones need not, and take fifty times as long.
END
row henon_heiles 'A star in a galaxy: Henon and Heiles, regular motion' models/henon_heiles.lag regular <<'END'
A polynomial potential has the cheapest series of all: `taylor` is the fastest at every error. The time for 1e-12 is twice that for 1e-2. `verlet8` follows at two to
eight times its time.
END
row stiff 'A stiff spring' models/spring_pendulum.lag stiff <<'END'
The spring is fast, but nothing damps it: its oscillation must be resolved, whatever the method, and implicit methods gain nothing by longer steps. `taylor` leads from
1e-4 on. Below 1e-10 rounding of the spring's force is left, and only equal steps that average it, `verlet8`, go on to 1e-12.
END
row loop 'A closed loop: a slider-crank mechanism' models/slider_crank.lag idle <<'END'
With constraints there is no Taylor series, and `dop853` leads at every error below 1e-3, `rk45` above. Each right-hand side solves for the multipliers, and each step ends
on the constraints, which costs all methods the same. The variational integrator keeps the energy, at a hundred times the time for six digits.
END
row chain 'A chain of 20 links' models/chain.lag swing -D N=20 <<'END'
Accelerations of 20 links cost some 20 times those of one; series cost more than that, so `dop853` leads up to eight digits, `taylor` from ten. The free end moves
chaotically, so digits are lost with time. Implicit methods, with matrices of 40 rows, take 30 times as long for two digits.
END
mv "$part" "$page"
echo "see $page"
