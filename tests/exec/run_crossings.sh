#!/bin/sh
# Events are located alike by runs, headers, sweeps and FMUs: crossings twice and many times within one step. Closed forms: x = sin t rises through a at
# asin(a), sin(w t + 1) at (2 pi k - 1)/w.
. tests/tap.sh
here=tests/exec/crossings two=tests/exec/crossings/two_crossings.lag

# Events of a header, `index time` a line.
header() { # MODEL STEP TIME [FLAGS...]
  "$LAGC" header "$1" --with events --prefix m -o "$TMP/m.h" || return 1
  step=$2 time=$3
  shift 3
  "$CC" -std=c99 -O0 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Wdouble-promotion -Wshadow -Wundef -Werror "-DSTEP=$step" "-DTIME=$time" "$@" -iquote "$TMP" $here/until_event.c \
    -lm -o "$TMP/until" && "$TMP/until"
}
stopped() { "$LAGC" run "$two" "$@" 2>&1 | sed -n 's/^stopped by an event at t = \([0-9.]*\) s$/\1/p'; }

# 2 acos(0.9995) = 0.063 of a step of 0.5. The error of x, 3 h^5/120 = 8e-4 after three steps, moves the time by 8e-4/cos(1.54), 0.025.
run=$(stopped)
near "a run finds both crossings in one step" 0.03 1.5391722324292690 "$run"
near "the header, at the time of the run to the error of its dense output" 5e-5 "$run" "$(header $two 0.5 6 -DINPUTS= -DBEFORE= | sed 's/^0 //')"
# 2 acos(0.99995) = 0.02 of a step of 0.1, and 15 h^5/120 = 1.3e-6 moves the time by 1.3e-4.
run=$(stopped a=0.99995 --step 0.1)
near "a run, within a step of 0.1" 2e-4 1.5607962601207306 "$run"
near "the header" 1e-6 "$run" "$(header $two 0.1 6 -DINPUTS= '-DBEFORE=p.a = 0.99995;' | sed 's/^0 //')"
slow near "the header in float, to the rounding of x over cos(1.56)" 1e-4 "$run" "$(header $two 0.1f 6 -DINPUTS= '-DBEFORE=p.a = 0.99995f;' -DM_REAL=float | sed 's/^0 //')"

# Below 0.9999995 x is less than 1e-3 s away from its top; a change of x by 1e-9, ten times the tolerance, moves the time by 1e-6.
"$LAGC" sweep $two a=0.9,0.9999995 --method dop853 --tol 1e-10 --measure 'T=hit(top)' -o "$TMP/sweep.csv" >/dev/null 2>&1
near "a sweep" 1e-6 1.5697963267535632 "$(sed -n '/^0.9999995,/p' "$TMP/sweep.csv" | cut -d, -f2)"
fmu() {
  "$LAGC" fmu $two --fmi 2 -o "$TMP/two.fmu" && mkdir -p "$TMP/fmu" && { unzip -q "$TMP/two.fmu" -d "$TMP/fmu" || python3 -m zipfile -e "$TMP/two.fmu" "$TMP/fmu"; } || return 1
  "$LAGC" run $two a=2 --method dop853 --tol 1e-10 --every 0.7 --quiet -o "$TMP/rows.csv" &&
    "$CC" -std=c11 -D_GNU_SOURCE -DFMI=2 tests/exec/fmu_import.c -o "$TMP/import" -ldl -lm && "$TMP/import" "$TMP/fmu" "$(echo "$TMP"/fmu/binaries/*/*)" cs "$TMP/rows.csv" 1e-8 1 a=0.9999995 >"$TMP/said"
  cat "$TMP/said"
  close_to "$(sed -n 's/^stopped at //p' "$TMP/said")" 1.5697963267535632 1e-6
}
if "$LAGC" fmu $two -o "$TMP/two.fmu" 2>&1 | grep -q "without minizip"; then skip "an FMU" "apt-get install libminizip-dev"; else check "an FMU" fmu; fi

# 32 strikes, 0.6 a step of 0.02 s, and 16 in one of 0.5 s; their function knows t alone, so that only rounding is left. Other events as in the run.
strike() { awk -v w=200 '{ pi = 3.14159265358979324; t = (2*pi*NR - 1)/w; d = $2 - t; if (d*d > worst*worst) worst = d } END { print NR, (worst*worst < 1e-28 ? "exact" : worst) }'; }
header $here/strikes.lag 0.02 1 '-DINPUTS=0,' -DBEFORE= >"$TMP/fine" 2>"$TMP/err"
is "strikes of a clock, on a constraint, with an input and a state" "32 exact" "$(grep '^0' "$TMP/fine" | strike)"
is "in steps of 0.5 s" "32 exact" "$(header $here/strikes.lag 0.5 1 '-DINPUTS=0,' -DBEFORE= 2>&1 | grep '^0' | strike)"
"$LAGC" run $here/strikes.lag --events "$TMP/events.csv" --quiet >/dev/null 2>&1
near "another event, at the time of the run, whose steps do not end at strikes; rk4 is off by 9e-8 beside dop853 at 1e-13" 1e-7 "$(sed -n 's/,side,.*//p' "$TMP/events.csv")" "$(sed -n 's/^1 //p' "$TMP/fine")"
tap_end
