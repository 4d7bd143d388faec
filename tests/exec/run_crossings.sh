#!/bin/sh
# Events are located alike by runs, headers, sweeps and FMUs: crossings twice and many times within one step. Closed forms: x = sin t rises through a at
# asin(a), sin(w t + 1) at (2 pi k - 1)/w.
. tests/tap.sh
here=tests/exec/crossings two=tests/exec/crossings/two_crossings.lag

# The program NAME of a header: `NAME STEP TIME [VALUE]` prints events, `index time` a line.
program() { # NAME MODEL FLAGS...
  name=$1
  "$LAGC" header "$2" --with events --prefix m -o "$TMP/m.h" || return 1
  shift 2
  "$CC" -std=c99 -O0 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wundef -Werror "$@" -iquote "$TMP" $here/until_event.c -lm -o "$TMP/$name"
}
check "headers without a warning" program two $two -DINPUTS= '-DSET(x)=p.a = x'
check "with constraints, states and inputs" program strikes $here/strikes.lag '-DINPUTS=0,' '-DSET(x)=(void)(x)'
stopped() { "$LAGC" run "$two" "$@" 2>&1 | sed -n 's/^stopped by an event at t = \([0-9.]*\) s$/\1/p'; }

# 2 acos(0.9995) = 0.063 of a step of 0.5. The error of x, 3 h^5/120 = 8e-4 after three steps, moves the time by 8e-4/cos(1.54), 0.025.
run=$(stopped)
near "a run finds both crossings in one step" 0.03 1.5391722324292690 "$run"
near "the header, at the time of the run to the error of its dense output" 5e-5 "$run" "$("$TMP/two" 0.5 6 | sed 's/^0 //')"
# 2 acos(0.99995) = 0.02 of a step of 0.1, and 15 h^5/120 = 1.3e-6 moves the time by 1.3e-4.
run=$(stopped a=0.99995 --step 0.1)
near "a run, within a step of 0.1" 2e-4 1.5607962601207306 "$run"
near "the header" 1e-6 "$run" "$("$TMP/two" 0.1 6 0.99995 | sed 's/^0 //')"
slow check "in float" program float $two -DINPUTS= '-DSET(x)=p.a = x' -DM_REAL=float
[ ! -e "$TMP/float" ] || near "to the rounding of x over cos(1.56)" 1e-4 "$run" "$("$TMP/float" 0.1 6 0.99995 | sed 's/^0 //')"

# Below 0.9999995 x is less than 1e-3 s away from its top; a change of x by 1e-9, ten times the tolerance, moves the time by 1e-6.
"$LAGC" sweep $two a=0.9,0.9999995 --method dop853 --tol 1e-10 --measure 'T=hit(top)' -o "$TMP/sweep.csv" >/dev/null 2>&1
near "a sweep" 1e-6 1.5697963267535632 "$(sed -n '/^0.9999995,/p' "$TMP/sweep.csv" | cut -d, -f2)"
fmu() {
  mkdir -p "$TMP/fmu" && { unzip -q "$TMP/two.fmu" -d "$TMP/fmu" || python3 -m zipfile -e "$TMP/two.fmu" "$TMP/fmu"; } || return 1
  "$LAGC" run $two a=2 --method dop853 --tol 1e-10 --every 0.7 --quiet -o "$TMP/rows.csv" &&
    "$CC" -std=c11 -D_GNU_SOURCE -DFMI=2 tests/exec/fmu_import.c -o "$TMP/import" -ldl -lm && "$TMP/import" "$TMP/fmu" "$(echo "$TMP"/fmu/binaries/*/*)" cs "$TMP/rows.csv" 1e-8 1 a=0.9999995 >"$TMP/said"
  cat "$TMP/said"
  close_to "$(sed -n 's/^stopped at //p' "$TMP/said")" 1.5697963267535632 1e-6
}
"$LAGC" fmu $two --fmi 2 -o "$TMP/two.fmu" >"$TMP/said" 2>&1
if grep -q "without minizip" "$TMP/said"; then skip "an FMU" "apt-get install libminizip-dev"; else check "an FMU" fmu; fi

# 32 strikes, 0.6 a step of 0.02 s, and 16 in one of 0.5 s; their function knows t alone, so that only rounding is left. Other events as in the run.
strike() { awk -v w=200 '{ pi = 3.14159265358979324; t = (2*pi*NR - 1)/w; d = $2 - t; if (d*d > worst*worst) worst = d } END { print NR, (worst*worst < 1e-28 ? "exact" : worst) }'; }
"$TMP/strikes" 0.02 1 >"$TMP/fine"
is "strikes of a clock, on a constraint, with an input and a state" "32 exact" "$(grep '^0' "$TMP/fine" | strike)"
is "in steps of 0.5 s" "32 exact" "$("$TMP/strikes" 0.5 1 | grep '^0' | strike)"
"$LAGC" run $here/strikes.lag --events "$TMP/events.csv" --quiet >/dev/null 2>&1
near "another event, at the time of the run, whose steps do not end at strikes; rk4 is off by 9e-8 beside dop853 at 1e-13" 1e-7 "$(sed -n 's/,side,.*//p' "$TMP/events.csv")" "$(sed -n 's/^1 //p' "$TMP/fine")"

# The bouncing ball falls for sqrt(2/9.81) s.
cxx=$(command -v g++ || command -v clang++)
scalar() { # NUMBER OPTIONS...
  n=$1
  shift
  "$LAGC" header models/bouncing_ball.lag --with events --prefix m -o "$TMP/m.h" && "$cxx" -O0 -w "-DSCALAR=$n" "$@" -iquote "$TMP" $here/scalar.cpp -o "$TMP/scalar" && close_to "$("$TMP/scalar")" 0.45152364098573092 2e-16
}
if [ -n "$cxx" ]; then
  check "dual numbers" scalar 1 -std=c++98
  [ ! -e /usr/include/eigen3/unsupported/Eigen/AutoDiff ] || slow check "Eigen's AutoDiffScalar" scalar 2 -std=c++14 -I/usr/include/eigen3
else
  skip "dual numbers" "there is no C++ compiler"
fi
tap_end
