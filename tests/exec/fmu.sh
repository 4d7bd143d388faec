#!/bin/sh
# lagc fmu: FMUs imported by fmu_import.c, which is written from the standard, move as `lagc run` says; descriptions hold by the standard's schemas;
# equal models are equal bytes; what cannot be an FMU leaves no file.
. tests/tap.sh
here=tests/exec
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac

"$LAGC" fmu models/pendulum.lag -o "$TMP/first.fmu" 2>&1 | grep "without minizip" && skip_all "apt-get install libminizip-dev"
unpack() { # FMU FOLDER
  rm -rf "$2" && mkdir -p "$2" || return 1
  if command -v unzip >/dev/null; then unzip -q "$1" -d "$2"; else python3 -m zipfile -e "$1" "$2"; fi
}
command -v unzip >/dev/null || command -v python3 >/dev/null || skip_all "neither unzip nor python3"
for v in 2 3; do
  check "the importer, for FMI $v" "$CC" -std=c11 -D_GNU_SOURCE -Wall -Wextra -O0 -DFMI=$v $here/fmu_import.c -o "$TMP/import$v" -ldl -lm
done

# The versions of checks that are alike for both: one a day.
versions='2 3'
[ -n "${SLOW:-}" ] || versions=$((2 + ${DAY:-0} % 2))
make_fmu() { # MODEL VERSION [SCENE]: into $TMP/NAME.VERSION
  fmu=$TMP/$(basename "$1" .lag).$2
  [ -d "$fmu" ] || { "$LAGC" fmu "$1" ${3:+"$3"} --fmi "$2" -o "$fmu.fmu" && unpack "$fmu.fmu" "$fmu"; }
}

# moves VERSION MODE MODEL SCENE "RUN'S OPTIONS" TOLERANCE SUBSTEPS [name=value ...]: the FMU with these values, in SI, moves as `lagc run` with the options.
moves() {
  v=$1 mode=$2 model=$3 scene=$4 options=$5 tolerance=$6 substeps=$7
  shift 7
  make_fmu "$model" "$v" "$scene" || return 1
  # shellcheck disable=SC2086 # options
  "$LAGC" run "$model" "$scene" $options --quiet -o "$TMP/rows.csv" || return 1
  "$TMP/import$v" "$fmu" "$(echo "$fmu"/binaries/*/*)" "$mode" "$TMP/rows.csv" "$tolerance" "$substeps" "$@"
}

# Rows of cart_pendulum every 0.03 s: at its first impact, t = 0.5, the row would hold the state of one side.
# ---- ten models: co-simulation to 1e-8, model exchange by 20 steps of Runge and Kutta a row to 1e-6
while read -r name scene until every; do
  for v in 2 3; do
    one_of 6 || continue
    for kind in 'cs 1e-8' 'me 1e-6'; do
      check "$name, FMI $v, ${kind% *}" moves $v "${kind% *}" models/"$name".lag "$scene" "--until $until --every $every" "${kind#* }" 20
    done
  done
done <<END
pendulum small 4 0.05
double_pendulum swing 2 0.02
bouncing_ball drop 4 0.05
slider_crank idle 4 0.05
double_pendulum_real bench 2 0.02
lorenz butterfly 4 0.02
motor_pendulum lift 2 0.01
kepler orbit 4 0.02
damped_oscillator flutter 4 0.05
cart_pendulum shove 3 0.03
END
# ---- the scene's method: rk4 with steps of 0.1 s is off by 1e-5 from the motion, and equals that of the run
cat >"$TMP/byrow.lag" <<'LAG'
model byrow
coord x
input u = 0.3*cos(t)
lagrangian = x'^2/2 - x^2/2 - x^4/3
force x = u - 0.1*x'
scene rk4 { start x = 0.7, x' = 0.2; span 5; method rk4(step = 0.1); output x, x' every 0.5 }
scene rk45 { like rk4; method rk45; tolerance 1e-4 }
LAG
check "co-simulation by the scene's rk4" moves 2 cs "$TMP/byrow.lag" rk4 "" 1e-13 1
rm -rf "$TMP/byrow.2" # by rk45, steps end at rows, between which those of the run lie
check "by its rk45" moves 2 cs "$TMP/byrow.lag" rk45 "--method rk45 --tol 1e-11" 1e-3 1
check "that has its steps" grep -q "model_rk45_step_with(" "$TMP"/byrow.2/sources/fmu.c
rolled() { moves "$1" "$2" models/rolling_cylinder.lag solid_cylinder '--every 0.05' 1e-6 20 >"$TMP/said" && cat "$TMP/said" && grep -q '^stopped at 1.33725' "$TMP/said"; }
for v in 2 3; do
  for mode in cs me; do
    one_of 4 && check "an event that stops, FMI $v, $mode" rolled $v $mode
  done
done

# ---- parameters, starts, inputs, events of both directions
driven=$here/fmu/driven.lag
for v in 2 3; do make_fmu models/pendulum.lag $v small; done
check "inputs follow their formulas" moves 2 cs $driven s "" 1e-9 1
check "parameters and starts that follow others" moves 2 cs $driven s "m=3" 1e-9 1 m=3
check "a parameter by formula that is set, and a start" moves 2 me $driven s "m=3 M=1 x=2" 1e-7 20 m=3 M=1 x=2
check "an input that is set, the other by its formula" moves 3 cs $driven s "G=2" 1e-9 1 G=2
check "the same in model exchange" moves 2 me $driven s "G=2 w=3" 1e-7 20 G=2 w=3
check "a constraint that an input drives" moves 2 cs $here/fmu/pulled.lag s "" 1e-8 1
check "a restitution of the speed" moves 2 cs $here/fmu/bridges.lag s "" 1e-11 1
check "an input that is set after the start" moves 2 cs $driven s "G=2" 1e-9 1 @G=2
for v in $versions; do
  check "saved and serialized states give the same bits, FMI $v" moves $v saved $driven s "G=2" 1e-9 1 G=2
  check "what the importer must not do is refused with a message, FMI $v" sh -c '"$0" "$1" "$(echo "$1"/binaries/*/*)" refusals' "$TMP/import$v" "$TMP/pendulum.$v"
  make_fmu $here/fmu/halt.lag $v
  check "a force without a value ends steps, and an importer's trials, FMI $v" sh -c '"$0" "$1" "$(echo "$1"/binaries/*/*)" halts' "$TMP/import$v" "$TMP/halt.$v"
done
check "impacts that follow each other faster than steps" moves 2 cs $here/fmu/bounces.lag s "" 1e-8 1
check "events twice and more within a step" moves 2 cs $here/fmu/toss.lag s "" 1e-8 1
check "an event of both directions whose function jumps" moves 2 cs $here/fmu/jump.lag s "--method dop853" 1e-8 1
check "constraints hold in co-simulation, to rounding" moves 2 cs $here/fmu/held.lag s "" 1e-14 1
check "and in model exchange, to the tolerance" moves 2 me $here/fmu/held.lag s "" 2e-6 2
# Four bars lie in one line at t = 0.71 and 1.23: steps of 0.001 s at 1e-9 shrink into these places, and went on with another energy.
in_line() { moves "$1" cs tests/exec/models/four_bars.lag turn "--until 2 --every 0.001" 1e-6 1 >"$TMP/said" 2>&1; cat "$TMP/said"; grep -q 'status 2: fmu_import: DoStep' "$TMP/said"; }
for v in $versions; do
  check "where constraints depend on each other, a motion ends that may go on as another, FMI $v" in_line $v
done
walls() { moves 2 "$1" $here/fmu/walls.lag s "" "$2" 20 >"$TMP/said" && cat "$TMP/said" && grep -q '^stopped at 3' "$TMP/said"; }
check "events of both directions, several at a time, co-simulation" walls cs 1e-8
check "the same in model exchange" walls me 1e-6

# Impacts by an event accumulate at t = 1.354 s: an error, as of a run, and no fall through the floor; a slow body beside it moves on until then.
cat >"$TMP/ever_shorter.lag" <<'END'
model ever_shorter
coord y [m], z [m]
kinetic = 1 [kg]/2*(y'^2 + z'^2)
potential = 9.81 [N]*y
event floor: y falling { y' = -y'/2 }
scene s { start y = 1 [m], z' = 0.001 [m/s]; span 3 [s] }
END
accumulates() { # LAST TIME
  make_fmu "$TMP/ever_shorter.lag" 2 && printf 't [s],z [m]\n0,0\n%s,%s\n' "$1" "$(awk "BEGIN { print $1/1000 }")" >"$TMP/slow.csv" && "$TMP/import2" "$fmu" "$(echo "$fmu"/binaries/*/*)" cs "$TMP/slow.csv" 1e-12 1
}
check "impacts by an event" accumulates 1.35
check "that accumulate" eval '! accumulates 3 >"$TMP/said" 2>&1 && grep "DoStep" "$TMP/said"'

# ---- contacts: steps by Moreau's method in co-simulation, as a run by moreau takes them; outputs with forces and accelerations, an event beside them
cell=$here/fmu/cell.lag
ends() { moves "$1" cs $cell s "" 1e-11 1 >"$TMP/said" && cat "$TMP/said" && grep -q '^stopped at 4.5505' "$TMP/said"; }
for v in $versions; do
  check "contacts with friction, until an event stops them, FMI $v" ends $v
  check "saved and serialized, too, FMI $v" moves $v saved $cell s "mu=0.1" 1e-11 1 mu=0.1
done
# An event of the state within a step of moreau: at the time of the run, along the same parabolas.
within() {
  sed 's/^event far.*/event far: x + 0.9975 [m] falling { stop }/' $cell >"$TMP/state.lag" && "$LAGC" run "$TMP/state.lag" >"$TMP/said" && make_fmu "$TMP/state.lag" 2 s && "$LAGC" run $cell s --quiet -o "$TMP/rows.csv" || return 1
  t=$(sed -n 's/^stopped by an event at t = \([0-9.]*\) s$/\1/p' "$TMP/said")
  printf '%s\n6,0,0,0,0,0,0,0\n' "$(head -n 47 "$TMP/rows.csv")" >"$TMP/long.csv"
  "$TMP/import2" "$fmu" "$(echo "$fmu"/binaries/*/*)" cs "$TMP/long.csv" 1e-11 1 >"$TMP/said" 2>&1
  cat "$TMP/said" && close_to "$(sed -n 's/^stopped at //p' "$TMP/said")" "$t" 1e-8
}
slow check "an event of the state within a step" within
check "contacts without friction" moves 2 cs models/room.lag bounce "--method moreau(step=0.0006) --until 1.8 --every 0.12" 1e-11 1
lists() { grep -q '<CoSimulation' "$TMP"/cell.*/modelDescription.xml && ! grep -q -e '<ModelExchange' -e 'event(floor)' -e 'name="floor' "$TMP"/cell.*/modelDescription.xml && grep -q 'event(far)' "$TMP"/cell.*/modelDescription.xml; }
check "they have no model exchange, no inputs and no events of their own" lists

# ---- dry friction: bodies stick and slip in co-simulation, and their forces are those that hold them; these are off by the change in a step of 2e-4 s, positions by less
belt=$here/fmu/belt.lag
for v in 2 3; do
  one_of 2 || continue
  check "dry friction, with a static limit and an input, FMI $v" moves $v cs $belt s "" 2e-4 1
  check "saved and serialized, too, FMI $v" moves $v saved $belt s "mu=0.2" 2e-4 1 mu=0.2
done
check "a crank on guides, and the force of one" moves 2 cs $here/fmu/guides.lag coast "--tol 1e-11" 2e-6 1 # the tolerance of steps is 1e-6
# A slider between two rails: of which of them it presses, and how much, from the start on, where no step has been taken. By events, too, where the force passes from one to the
# other 7e-4 s before a row, by 4 N/s
cat >"$TMP/rails.lag" <<'END'
model rails
coord a [rad], b [rad], x [m], y [m]
param r = 0.1 [m] > 0, l = 0.25 [m] > 0, m = 1.5 [kg] > 0
kinetic = 0.01 [kg*m^2]/2*a'^2 + m/2*(x'^2 + y'^2) + 1e-3 [kg*m^2]*b'^2
constraint pin: (x, y) = (r*cos(a) + l*cos(b), r*sin(a) - l*sin(b))
contact low: y >= 0, restitution = 0
contact high: y <= 0 [m], restitution = 0
scene s { start a = 1, b = asin(r*sin(1)/l), x = r*cos(1) + l*cos(asin(r*sin(1)/l)), a' = 5 [rad/s]; span 1 [s]; output a, lambda(low), lambda(high) every 0.01 [s] }
END
for v in $versions; do
  check "forces of rails, from the start on, FMI $v" moves $v cs "$TMP/rails.lag" s "--method moreau(step=1e-4)" 1e-11 1
  check "as by events, FMI $v" moves $v cs "$TMP/rails.lag" s "" 3e-3 1
done
check "beside a contact, with friction of a coordinate" moves 2 cs $here/fmu/stopped.lag coast "--method moreau(step=1e-3)" 1e-9 1
check "a body that is held by friction stays where it is" moves 2 cs $here/fmu/brake.lag s "" 1e-4 1

# ---- kicks: time events
kicked=$here/fmu/kicked.lag
kicks() { moves "$1" cs $kicked s "T=0.6" 1e-9 1 T=0.6 >"$TMP/said" && cat "$TMP/said" && grep -q '^stopped at 9.123' "$TMP/said"; }
for v in $versions; do
  check "kicks, one of them with the period of a parameter, FMI $v" kicks $v
  check "kicks in model exchange, as time events, FMI $v" moves $v me $kicked s "" 1e-6 20
done

# ---- directional derivatives: of all rates and outputs; of driven, m moves M, and w moves F, until these are set
while read -r name known; do
  for v in 2 3; do
    one_of 6 || continue
    # shellcheck disable=SC2086 # a list of names
    check "directional derivatives of $(basename "$name" .lag), FMI $v" moves $v derivatives "$name" "$(sed -n 's/^scene \([a-z_0-9]*\).*/\1/p' "$name" | head -n 1)" "--until 0.01" 1e-7 1 $known
  done
done <<END
$driven m w x x' M k c F G w
models/pendulum.lag th th' m l g
models/motor_pendulum.lag th th' i
models/lorenz.lag x y z
$here/fmu/held.lag x y x' y' l m g
models/double_pendulum.lag th1 th2 th1' th2' m1 l2 g
$here/fmu/units.lag th th' T i U R
END

pushed() { make_fmu models/slider_crank.lag 2 idle && ! grep -q providesDirectionalDerivative "$fmu/modelDescription.xml"; }
check "no derivatives where an output contains multipliers" pushed

# ---- sources
strict() { "$CC" -std=c99 -Wall -Wextra -Wpedantic -Wno-unused-function -Werror "$@" -c "$fmu/sources/fmu.c" -o "$TMP/source.o"; }
named() { strict "-DFMI$1_FUNCTION_PREFIX=pendulum_" && nm -g --defined-only "$TMP/source.o" | grep -q " pendulum_fmi$1DoStep$"; }
visible() { nm -D --defined-only "$fmu"/binaries/*/*.so | grep -v -e " fmi$1" -e ' _edata$' -e ' _end$' -e ' __bss_start$'; } # three of the linker's
sanitized() {
  "$CC" -std=c11 -g -shared -fPIC $SAN_FLAGS "$fmu/sources/fmu.c" -o "$TMP/san.so" -lm && "$CC" -std=c11 -D_GNU_SOURCE -g -DFMI=2 $SAN_FLAGS $here/fmu_import.c -o "$TMP/import_san" -ldl -lm &&
    "$TMP/import_san" "$fmu" "$TMP/san.so" "$1" "$TMP/rows.csv" "${2:-1e-6}" 5
}
for v in 2 3; do
  make_fmu models/pendulum.lag $v
  check "sources are C99, FMI $v" strict
  check "sources take the prefix of a static library, FMI $v" named $v
  empty "only the standard's functions are visible, FMI $v" "$(visible $v)"
done
for name in brake kicked; do
  make_fmu "$here/fmu/$name.lag" 2
  check "sources are C99, $name" strict
done
if [ -n "${SAN_FLAGS:-}" ]; then
  moves 2 cs $belt s "" 2e-4 1 >/dev/null
  check "sources under sanitizers, dry friction" sanitized cs 2e-4
  moves 2 cs $kicked s "" 1e-9 1 >/dev/null
  check "sources under sanitizers, kicks" sanitized saved
  moves 2 cs $here/fmu/walls.lag s "" 1e-8 1 >/dev/null
  check "sources under sanitizers, co-simulation" sanitized saved
  check "sources under sanitizers, model exchange" sanitized me
fi

# ---- the archive and the description
make_again() {
  mkdir -p "$TMP/elsewhere" && cp models/pendulum.lag "$TMP/elsewhere/" &&
    TZ=Asia/Kathmandu TMPDIR=$TMP/elsewhere XDG_CACHE_HOME=$TMP/elsewhere "$LAGC" fmu "$TMP/elsewhere/pendulum.lag" small --fmi 2 -o "$TMP/elsewhere/again.fmu" &&
    cmp "$TMP/elsewhere/again.fmu" "$TMP/pendulum.2.fmu"
}
make_fmu models/pendulum.lag 2 small
check "equal models are equal bytes" make_again
tokens() { sed -n 's/.* \(guid\|instantiationToken\)="\([^"]*\)".*/\2/p' "$TMP/pendulum.$1/modelDescription.xml"; }
check "the token is another for another scene" sh -c '"$1" fmu models/pendulum.lag wide -o "$2/wide.fmu" && ! grep -aqF "$0" "$2/wide.fmu"' "$(tokens 2)" "$LAGC" "$TMP"
if command -v unzip >/dev/null; then
  check "the archive is whole" unzip -tq "$TMP/pendulum.3.fmu"
  is "its files are dated 1980-01-01, and not compressed" 5 "$(unzip -v "$TMP/pendulum.3.fmu" | grep -c 'Stored.* 1980-01-01 00:00 ')"
else
  skip "the archive is whole" "no unzip"
fi
make_fmu $here/fmu/units.lag 2 2>/dev/null
make_fmu $here/fmu/units.lag 3 2>/dev/null
valid() {
  for f in "$TMP"/*.2/modelDescription.xml; do xmllint --noout --schema tests/fmu/xsd/fmi2ModelDescription.xsd "$f" || return 1; done
  for f in "$TMP"/*.3; do
    xmllint --noout --schema tests/fmu/xsd/fmi3ModelDescription.xsd "$f/modelDescription.xml" && xmllint --noout --schema tests/fmu/xsd/fmi3BuildDescription.xsd "$f/sources/buildDescription.xml" || return 1
  done
}
if command -v xmllint >/dev/null; then
  check "descriptions hold by the standard's schemas" valid
else
  skip "descriptions hold by the standard's schemas" "no xmllint"
fi
# By hand from the model and the table of units: values in SI, display units, bounds, exponents.
said() { grep -cF -e "$1" "$TMP/units.2/modelDescription.xml"; }
for line in '<Unit name="rad"><BaseUnit rad="1"/><DisplayUnit name="deg" factor="57.29577951308232"/></Unit>' \
  '<Unit name="rad/s"><BaseUnit s="-1" rad="1"/><DisplayUnit name="deg/s" factor="57.29577951308232"/></Unit>' \
  '<Unit name="K"><BaseUnit K="1"/><DisplayUnit name="degC" factor="1" offset="-273.15"/></Unit>' \
  '<Unit name="A"><BaseUnit A="1"/><DisplayUnit name="mA" factor="1000"/></Unit>' \
  '<Unit name="V"><BaseUnit m="2" kg="1" s="-3" A="-1"/></Unit>' \
  'name="th" valueReference="1" causality="output" variability="continuous" initial="exact"><Real unit="rad" displayUnit="deg" start="1.5707963267948966"/>' \
  'name="T" valueReference="3" causality="output" variability="continuous" initial="exact"><Real unit="K" displayUnit="degC" start="293.15"/>' \
  'name="R" valueReference="9" description="&gt;= 0" causality="parameter" variability="tunable" initial="exact"><Real unit="kg*m^2/s^3/A^2" displayUnit="kohm" min="0" start="3000"/>' \
  'name="k" valueReference="10" description="&lt;= 0" causality="parameter" variability="tunable" initial="exact"><Real unit="N*m" max="0" start="-2"/>' \
  'name="U" valueReference="12" causality="input" variability="continuous"><Real unit="V" start="2"/>' \
  'description="Units of all kinds: &lt;, &gt; &amp; others; scene s; effects in use: none"' \
  '<DefaultExperiment startTime="0" stopTime="60" tolerance="1e-09"/>'; do
  is "description: ${line%% causality*}" 1 "$(said "$line")"
done

# ---- another machine
if [ -z "${SLOW:-}" ]; then :; elif command -v x86_64-w64-mingw32-gcc >/dev/null; then
  windows() { "$LAGC" fmu models/pendulum.lag --also-cc x86_64-w64-mingw32-gcc -o "$TMP/win.fmu" && unpack "$TMP/win.fmu" "$TMP/win" && head -c 2 "$TMP/win/binaries/win64/pendulum.dll" | grep -q MZ; }
  check "an FMU for Windows, too" windows
  is "it has two binaries" 2 "$(ls "$TMP"/win/binaries/*/* | wc -l | tr -d ' ')"
  only() { CC=x86_64-w64-mingw32-gcc "$LAGC" fmu models/pendulum.lag -o "$TMP/only.fmu" && unpack "$TMP/only.fmu" "$TMP/only" && cmp "$TMP/only/binaries/win64/pendulum.dll" "$TMP/win/binaries/win64/pendulum.dll"; }
  check "CC alone makes the same bytes, a second later" only
else
  skip "an FMU for Windows" "no compiler for it"
fi

# ---- refusals leave no file
refused() { # STATUS WORDS ARGUMENTS...
  status=$1 words=$2
  shift 2
  rm -f "$TMP/none.fmu"
  says "$status" "$words" "$LAGC" fmu "$@" && [ ! -e "$TMP/none.fmu" ]
}
check "a file of another kind" says 2 'writes an FMU' "$LAGC" fmu models/pendulum.lag -o "$TMP/none.zip"
check "an unknown version" refused 2 '2' models/pendulum.lag --fmi 1 -o "$TMP/none.fmu"
check "two binaries of one machine" refused 2 'name each machine once' models/pendulum.lag --also-cc "$CC" -o "$TMP/none.fmu"
check "another compiler that is not there" refused 2 'no-such-cc` cannot be run' models/pendulum.lag --also-cc no-such-cc -o "$TMP/none.fmu"
check "an unknown scene" refused 1 'small' models/pendulum.lag smal -o "$TMP/none.fmu"
check "no file named" refused 2 'needs -o FILE.fmu' models/pendulum.lag
check "a folder that is not there" refused 2 'cannot write' models/pendulum.lag -o "$TMP/nowhere/none.fmu"
check "a compiler that is not there" env CC=no-such-cc sh -c '"$0" fmu models/pendulum.lag -o "$1" 2>&1 | grep -q "no-such-cc. cannot be run" && [ ! -e "$1" ]' "$LAGC" "$TMP/none.fmu"
without() {
  for f in fmu/zip commands/pack; do
    "${CC%% *}" -std=c11 -w -D_XOPEN_SOURCE=700 -Isrc -I"$BUILD/gen" -c -o "$TMP/${f#*/}.o" "src/$f.c" || return 1
  done
  "${CC%% *}" -o "$TMP/lagc" "$BUILD/obj/src/main.o" "$TMP/zip.o" "$TMP/pack.o" "$BUILD/liblagc.a" -lm && rm -f "$TMP/none.fmu" && says 2 'apt-get install libminizip-dev' "$TMP/lagc" fmu models/pendulum.lag -o "$TMP/none.fmu" && [ ! -e "$TMP/none.fmu" ]
}
[ -n "${COVERAGE:-}" ] || check "a lagc that was built without minizip and liblzma" without
own() { cp models/pendulum.lag "$TMP/own.lag" && says 2 'would be overwritten' "$LAGC" fmu "$TMP/own.lag" -o "$TMP/own.lag" && cmp models/pendulum.lag "$TMP/own.lag"; }
check "the model is not overwritten" own
tap_end
