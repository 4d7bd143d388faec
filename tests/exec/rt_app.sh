#!/bin/sh
# The command line of a built simulator, on the hand-written one in rt_sim.c.
. tests/tap.sh
"$CC" -std=c11 -O1 -g -I"$INC" tests/exec/rt_sim.c "$BUILD/liblag.a" -lm -o "$TMP/sim" || exit 1
cd "$TMP" || exit 1

status() { # status EXPECTED ARGS...: exit status of the simulator; output in out, err
  want=$1
  shift
  ./sim "$@" >out 2>err
  got=$?
  [ "$got" = "$want" ]
}
says() { # says EXPECTED WORDS ARGS...: and standard error holds the words
  want=$1 words=$2
  shift 2
  status "$want" "$@" && grep -qF -e "$words" err
}
no_part() { ! ls ./*.part* 2>/dev/null | grep -q .; }

# --- report, rows
check "a name that says another kind of file" says 2 "-o x.h5: it writes CSV, or NumPy where the name ends in .npy; write -o x.csv" -o x.h5
check "of a picture" says 2 "x.png: this program writes pictures as SVG;" --svg x.png
check "default scene" status 0
check "report names scene, method and energy" grep -q "scene drop, method dop853" out
check "a model without charges claims nothing of its energy" grep -q "energy change: .*(not decided: its rate is not known)" out
check "named scene" status 0 swing
check "conserved energy is called drift" grep -q "energy drift" out
check "quiet is quiet" sh -c './sim swing --quiet >out 2>err && ! [ -s out ] && ! [ -s err ]'
check "rows to a file" status 0 swing -o rows.csv
check "101 rows and a head" [ "$(wc -l <rows.csv)" = 102 ]
check "head has names, units, RFC 4180 quotes" [ "$(head -1 rows.csv)" = 't [s],th [deg],"E ""total"", T+V [J]"' ]
check "times are what a person writes" sh -c "sed -n 5p rows.csv | grep -q '^0.3,'"
check "last row is the end" sh -c "tail -1 rows.csv | grep -q '^10,'"
check "no .part is left" no_part
./sim swing -o - >std.csv 2>err
check "rows to standard output are the same" cmp rows.csv std.csv
check "the report goes to standard error then" grep -q "reached t = 10" err
./sim swing --until 0.25 -o end.csv --quiet
check "the end has a row off the grid" sh -c "tail -1 end.csv | grep -q '^0.25,' && [ \$(wc -l <end.csv) = 5 ]"
./sim swing --until=-1 --every=0.25 -o back.csv --quiet
check "backwards" sh -c "tail -1 back.csv | grep -q '^-1,' && [ \$(wc -l <back.csv) = 6 ]"

# --- npy: magic, version 3.0, header length a multiple of 64 in all, data of nrows*ncols*8 bytes
./sim swing -o a.npy --quiet
magic=$(od -An -tx1 -N8 a.npy | tr -d ' \n')
len=$(od -An -tu1 -j8 -N4 a.npy | awk '{print $1 + 256 * $2}')
check "npy magic and version 3.0" [ "$magic" = 934e554d50590300 ]
check "npy header is padded to 64" [ $(((len + 12) % 64)) = 0 ]
check "npy holds the rows" [ "$(wc -c <a.npy)" = $((12 + len + 101 * 3 * 8)) ]
check "npy header is a dictionary with the shape" sh -c "head -c $((12 + len)) a.npy | grep -a -q \"'fortran_order': False, 'shape': (101,), }\""
check "npy fields" sh -c "head -c $((12 + len)) a.npy | grep -a -qF '[(\"t [s]\"' || head -c $((12 + len)) a.npy | grep -a -qF '[((\"t [s]\", \"t\"), '"
od -An -v -tf8 -j$((12 + len)) a.npy | tr -s ' \n' '\n' | sed '/^$/d' | awk 'NR % 3 == 1 { printf "%.6g\n", $1 }' >npy_t
sed 1d rows.csv | cut -d, -f1 | awk '{ printf "%.6g\n", $1 }' >csv_t
check "npy and CSV agree on times" cmp npy_t csv_t

# --- events: the ball from 1 m lands at t1 = sqrt(2/9.81) with -sqrt(2*9.81), leaves with 0.9 of it, and lands the k-th time at
# t1 (1 + 2 (e + ... + e^(k-1)))
check "log of events" status 0 drop --events ev.csv -o rows.csv
check "the report counts, with first and last" grep -Eq "^event ground: 8 times, first at t = 0.4515236409857[0-9]* s, last at 4.69162673904" out
check "and says where the log is" grep -q "^16 events in ev.csv" out
check "head of the log" [ "$(head -1 ev.csv)" = "t [s],event,y [m],y' [m/s],y after [m],y' after [m/s]" ]
check "landing, before and after" awk -F, 'NR == 2 { t = sqrt(2/9.81); v = sqrt(2*9.81)
  exit !($2 == "ground" && ($1 - t)^2 < 1e-24 && ($4 + v)^2 < 1e-20 && ($6 - 0.9*v)^2 < 1e-20 && $5 == $3) }' ev.csv
check "an event without action changes nothing" sh -c "grep apex ev.csv | awk -F, '{ n++; if (\$3 != \$5 || \$4 != \$6) exit 1 } END { exit n != 8 }'"
check "json counts, with times" sh -c './sim drop --json | grep -qE "\"events\": \{\"ground\": \{\"count\": 8, \"first\": 0.4515236409857"'
check "json: never" sh -c './sim drop --until 0.1 --json | grep -qF "\"ground\": {\"count\": 0, \"first\": null, \"last\": null}"'
# --- measures: the same closed forms; y is 0.81 m at the top of the first flight
check "measures" status 0 drop --measure 'hit(ground, 2);2 hit(ground) [1 0 s]' --measure 'count(ground)' --measure 'top=y 1 hit(ground) 2 hit(ground) + 2 / at() [1 0 m]' --measure '9th;9 hit(ground)'
check "the time of an event" grep -Eq '^  hit\(ground, 2\)  *1\.2642661947[0-9]* s$' out
check "a number of events" grep -Eq '^  count\(ground\)  *8$' out
check "a value at a time that is a measure, by its name" grep -Eq '^  top  *0\.8(1|1000000000[0-9]*|0999999999[0-9]*) m$' out
check "a measure without a value" grep -Eq '^  9th  *none: ground happens 8 times$' out
check "measures in json" sh -c './sim drop --measure "n=count(ground)" --measure "9th=9 hit(ground)" --json | grep -qF "\"measures\": {\"n\": 8, \"9th\": null}"'
check "rows and pictures with measures are those without" sh -c './sim drop -o plain.csv --svg plain.svg --events plain_ev.csv --quiet && ./sim drop -o m.csv --svg m.svg --events m_ev.csv --measure "y max()" --measure "count(ground)" | grep -Eq "count\(ground\) *8" &&
  cmp plain.csv m.csv && cmp plain.svg m.svg && cmp plain_ev.csv m_ev.csv'
check "a wrong measure, before anything is written" says 2 "--measure 1 hit(grund): no event is called grund; did you mean ground?" drop --measure '1 hit(grund)' -o no.csv
check "leaves nothing" sh -c '! [ -e no.csv ]'
check "two measures of one name" says 2 "another measure is called so" drop --measure 'a=end()' --measure 'a=y max()'
check "a measure without a name" says 2 "a name is missing before" drop --measure '=end()'
check "a measure that is not compiled" says 2 "lagc compiles them: \`measure top = max(x)\` in the scene" drop --measure 'max(y)'
for m in 'y max' 'yy' '+' 'y +' 'y y' 'max()' 'at()' 'y at()' 'y max(1)' 'y 1..2' '"y' '[1 0 s]' '' ';' 'hit(ground)' '1x' 'y )' 'y sin(' "$(awk 'BEGIN { while (i++ < 600) printf "1 " }')" "$(awk 'BEGIN { while (i++ < 300) printf "y" }')"; do
  check "words that are no measure: $(printf %.20s "$m")" status 2 drop "--measure=$m"
done
check "measures of an analysis" says 2 "--measure has no meaning for --cost" drop --cost --measure end
check "a log needs events" says 2 "has no events" swing --events none.csv
check "a log on standard output" sh -c './sim drop --events - 2>err | cmp - ev.csv && grep -q "reached t = 5" err'
check "two logs on standard output" says 2 "written twice" drop --events - -o -
check "a log and json on standard output" says 2 "both write to standard output" drop --events - --json
check "a log that cannot be written" says 2 "cannot write" drop --events none/e.csv
check "a failing run keeps its log" sh -c './sim drop --until 100 --events zeno.csv >zeno.err 2>&1; [ $? = 3 ] && [ $(grep -c ground zeno.csv) -gt 20 ]'
check "events that pile up are told from each other" grep -q "event ground repeats in ever shorter intervals" zeno.err
./sim drop --until 2 --events one.csv --save-state s --quiet && ./sim --resume s --events two.csv --json >two.json
check "a resumed run logs the rest" sh -c 'sed 1d two.csv | cat one.csv - | cmp - ev.csv'
check "and counts the whole" grep -q '"ground": {"count": 8, "first": 0.4515236409857' two.json
if [ -w /dev/full ]; then
  check "a log on a full disk" says 2 "cannot write /dev/full" drop --events /dev/full -o rows2.csv
  check "leaves no rows either" sh -c '! ls rows2.csv ./*.part* 2>/dev/null'
fi

# --- JSON
check "json" status 0 swing --json
check "json is one line, braces balance" awk '{ a = gsub(/{/, "{"); b = gsub(/}/, "}"); if (a != b || a < 4 || NR > 1) exit 1 }' out
for key in model scene method status t_end steps rejected rhs_calls wall_s energy_drift charges events constraint_residual final; do
  check "json has $key" grep -q "\"$key\": " out
done
check "json strings are escaped" grep -qF '"E \"total\", T+V": -0.69' out
check "json has monitors" grep -q '"monitors": {.*"H": [0-9.e-]*}' out
check "json of a failed run" status 3 wall --json
check "json says failed, and why" sh -c 'grep -q "\"status\": \"failed\"" out && grep -q "no finite value" out'
check "json has null where there is no energy" grep -q '"energy_drift": null' out
if command -v python3 >/dev/null 2>&1; then
  check "json parses" sh -c './sim drop --json | python3 -m json.tool'
fi

# --- values
check "parameter" sh -c './sim swing l=2 --json >a && ./sim swing >b --json && ! cmp -s a b'
check "suffix of a dotted name" sh -c './sim drop c=0.5 -o c1.csv --quiet && ./sim drop drag.c=0.5 -o c2.csv --quiet && cmp c1.csv c2.csv'
check "coordinate in its unit" sh -c "./sim swing th=90 -o - 2>/dev/null | sed -n 2p | grep -q '^0,90,'"
check "velocity" sh -c "./sim fixed \"th'=45\" -o - 2>/dev/null | sed -n 2p | grep -Eq '^0,[0-9.]*,45\$'"
check "input held constant" sh -c "./sim drop wind=9.81 --json | grep -q '\"y\": 1[,}]'"
check "--opt=value and two words" sh -c './sim swing --tol=1e-10 -o t1.csv --quiet && ./sim swing --tol 1e-10 -o t2.csv --quiet && cmp t1.csv t2.csv'
check "method with options" sh -c './sim swing --method "rk4(step=0.01)" | grep -q "rk4(step=0.01)"'
check "scene's method and step" sh -c './sim fixed | grep -q "rk4(step=0.001)"'
check "--method help" sh -c './sim --method help | grep -q "verlet6 *6 *6 *fixed *both *partly *no *yes"'
check "--help" sh -c './sim --help | grep -q -- --save-state'

# --- mistakes
check "unknown name" says 2 "did you mean l?" swing ll=2
check "wrong sign" says 2 "declares l > 0" swing l=-1
check "not a number" says 2 '"1e-13x" is not a number' swing l=1e-13x
check "hexadecimal and nan are not numbers" sh -c './sim swing l=nan; [ $? = 2 ] && ./sim swing l=0x1p3; [ $? = 2 ]'
check "tolerance zero" says 2 "must be positive" --tol 0
check "tolerance too strict" says 2 "1e-15 or more" --tol 1e-20
check "negative step" says 2 "--step 1e-3" --step -1
check "empty span" says 2 "nothing to compute" --until 0
check "bad every" says 2 "must be positive" --every 0
check "unknown option" says 2 "did you mean --method?" --methd rk4
check "an option twice" says 0 "note: --until 1 gives way to 2" --until 1 --until 2
check "a value twice" says 0 "note: g=1 gives way to g=2" g=1 g=2
check "unknown method" says 2 "unknown method rk9; did you mean rk4?" --method rk9
check "a method that is near none has a list, which does not hide the message" says 2 "unknown method simpson; --method help lists them" --method simpson
check "in one line" [ "$(wc -l <err)" = 1 ]
check "method that does not fit" says 2 "lagc build MODEL --method verlet" drop --method verlet
check "unknown option of a method" says 2 "no option" --method "rk4(stp=1)"
check "unknown scene says how to build it" says 2 "lagc run models/rt_sim.lag workshop" workshop
check "effect that is not built in" says 2 "scene drop_moon { like drop; use moon }" drop moon.c=1
check "two uses of standard output" says 2 "-o - and --json" --json -o -
check "plot of an unknown column" says 2 "no output is named" swing --svg x.svg --plot-y nothing
check "a directory that is not there" says 2 "cannot write" -o none/rows.csv
check "a picture that cannot be written is said before the run" says 2 "cannot write" fixed --until 1e6 --svg none/x.svg
check "too many rows are refused" says 2 "a larger --every" fixed --every 1e-300 -o x.csv
check "a step that does not move time" says 2 "time would not move" fixed --step 1e-320
# Steps in parentheses are checked as --step is.
for o in "rk4(step=0)" "rk4(step=-1)" "rk45(step=-1e-3)" "dop853(max_step=0)" "rk4(step=1e400)"; do
  check "$o" says 2 "a step must be a positive number; write for example" --method "$o"
done
check "the same message for --step" says 2 "step 0: a step must be a positive number; write for example --step 1e-3" --step 0
for o in "rk4(step=1e-300)" "rk45(step=1e-300)" "rk45(max_step=1e-40)" "rk45(adapt=off, step=1e-17)"; do
  check "$o" says 2 "time would not move" --method "$o"
done
for o in "rk4(step=nan)" "rk4(step=inf)" "rk4(step=0x1p3)" "rk45(atol=nan)"; do
  check "$o" says 2 "it is a number" --method "$o"
done
check "a tolerance beyond all numbers" says 2 "must be finite" --method "rk45(atol=1e400)"
check "one file for two results" says 2 "written twice" fixed -o same --svg same
check "one file for two results, spelled otherwise" says 2 "written twice" fixed -o same --svg ./same
check "a device is no state" says 2 "is not a regular file" fixed --resume /dev/zero
if [ -w /dev/full ]; then
  check "a full disk" says 2 "cannot write" drop -o /dev/full
fi
check "nothing is left after mistakes" sh -c '! ls x.svg none 2>/dev/null && ! ls ./*.part* 2>/dev/null'

# --- failure keeps rows
check "a failing run exits 3" status 3 wall -o wall.csv
check "it says so with time and reason" grep -q "FAILED: at t = 1 s: the model gives no finite value" out
check "rows up to the failure are kept" sh -c 'grep -q "up to the failure" out && tail -1 wall.csv | grep -Eq "^(0.75|1),"'
check "no .part is left after a failure" no_part

# --- a run in two parts is the whole run, byte for byte
every=0.125
two_parts() { # two_parts CUT ARGS...
  cut=$1
  shift
  ./sim "$@" --until 4 --every $every -o whole.csv --json >whole.json 2>/dev/null &&
    ./sim "$@" --until "$cut" --every $every -o one.csv --quiet --save-state state &&
    ./sim --resume state --until 4 -o two.csv --json >two.json 2>/dev/null &&
    sed 1d two.csv | cat one.csv - >both.csv && cmp whole.csv both.csv &&
    took='s/"wall_s": [^,]*,//; s/"chosen": [^"n]*\("[^"]*"\|null\), //; s/"error": [^,]*, "error_growth": [^,]*, "error_seen_to": [^,]*, "error_known_to": [^,]*, "error_up_to_there": [^,]*, "error_at_most": [^,]*, "formula_noise": [^,]*, "horizon": [^,]*, //' && # the second part chooses no method and has no estimate
    sed "$took" whole.json >w.json && sed "$took" two.json >t.json && cmp w.json t.json
}
every=1.1 # 3 times 1.1 is 3.3000000000000003: one row there, and none beside it
check "cut where a row is but for rounding" two_parts 3.3 swing
every=0.125
for cut in 0.125 1.5 2 3.875; do
  check "what is chosen with events, cut at $cut" two_parts $cut drop
  check "rk45 with events, cut at $cut" two_parts $cut drop --method rk45
  check "rk4 with events, cut at $cut" two_parts $cut drop --method "rk4(step=0.01)"
  check "rk45 and monitors, cut at $cut" two_parts $cut swing --tol 1e-8 l=1.7 --method rk45
  check "rk4, cut at $cut" two_parts $cut fixed th=20
  check "dop853 with events, cut at $cut" two_parts $cut drop --method dop853
  for m in symplectic_euler verlet verlet4 verlet6 verlet8; do
    check "$m, cut at $cut" two_parts $cut fixed th=20 --method "$m(step=0.01)"
  done
done
check "backwards, in two parts" sh -c './sim swing --until -2 -o w.csv --quiet && ./sim swing --until -1 -o 1.csv --quiet --save-state s &&
  ./sim --resume s --until -2 -o 2.csv --quiet && sed 1d 2.csv | cat 1.csv - | cmp - w.csv'
check "resume keeps its values" says 2 "leave out" --resume state l=2
./sim swing l=1.7 th=60 --method "rk4(step=0.01)" --tol 1e-8 --until 2 --quiet --save-state repeat
check "a state names its program" grep -q "^program rt_sim$" repeat
check "what it was saved with may be said again" status 0 swing l=1.7 th=60 --method "rk4(step=0.01)" --tol 1e-8 --until 3 --resume repeat
check "or a part of it" status 0 --resume repeat --until 3 l=1.7 --step 0.01 --method rk4
check "another value is refused" says 2 "another value of l" --resume repeat --until 3 th=60 l=1.8
check "another start is refused" says 2 "another value of th" --resume repeat --until 3 th=61
check "another tolerance is refused" says 2 "leave out --tol" --resume repeat --until 3 --tol 1e-9
check "another method is refused" says 2 "leave out --method" --resume repeat --until 3 --method rk45
check "another step is refused" says 2 "leave out --method" --resume repeat --until 3 --method "rk4(step=0.02)"
./sim drop wind=0.5 --until 1 --quiet --save-state repeat
check "another input is refused" says 2 "another value of wind" --resume repeat wind=0.4
check "the same one is not" status 0 --resume repeat wind=0.5
check "resume of another scene" says 2 "saved from scene fixed" swing --resume state
check "resume backwards" says 2 "would go back" --resume state --until 1
sed 's/0x1/0x2/' state >damaged
check "a damaged state" says 2 "damaged" --resume damaged
check "no state at all" says 2 "not a state" --resume rows.csv

# --- signals: a run of hours is stopped after half a second
interrupt() { # SIGNAL STATUS
  rm -f long.*
  ./sim fixed --until 1e9 --every 100 -o long.csv --save-state long.state >out 2>err &
  pid=$!
  sleep 0.5
  kill "-$1" $pid
  wait $pid
  [ $? = "$2" ]
}
for signal in 'HUP 129' 'TERM 143'; do
  # shellcheck disable=SC2086 # two words
  check "SIG$signal" interrupt $signal
  check "it says where, after SIG$signal" grep -q "interrupted at t = " out
  check "leaves rows and state, and no .part" sh -c 'test -s long.csv && test -s long.state && ! ls ./*.part*'
done
check "Ctrl-C exits 130" interrupt INT 130
check "it says where" grep -q "interrupted at t = " out
check "rows are complete" sh -c 'no=$(wc -l <long.csv); [ "$no" -gt 2 ] && tail -c1 long.csv | od -An -tx1 | grep -q 0a'
check "no .part is left after Ctrl-C" no_part
check "the state was saved" sh -c 'head -1 long.state | grep -q "lag-state 1"'

# --- pictures
check "svg" status 0 swing --svg p.svg
check "svg is closed and has both panels" sh -c 'tail -1 p.svg | grep -q "</svg>" && grep -q "\[deg\]" p.svg && grep -q "\[J\]" p.svg'
check "svg escapes names" grep -q "E &quot;total&quot;" p.svg
check "one against the other" status 0 fixed --svg q.svg --plot-x th --plot-y "th'"
check "html" status 0 swing --html a.html --points th,th
check "html says what it shows" sh -c 'grep -q "\"shapes\": \[\[\"rod\".*\[\"ball\", \"body\", \"(th, th)\"" a.html && tail -1 a.html | grep -q "</html>"'
check "names with commas and quotes" status 0 swing --html b.html --points 'E "total", T+V,E "total", T+V;E "total", T+V,E "total", T+V' --no-rods
check "are escaped in a script" sh -c 'grep -qF "\"(E \\\"total\\\", T+V, " b.html'
check "html of what points?" says 2 "add --points" swing --html c.html
check "points of what?" says 2 "need an animation" swing --points th,th
check "a point that is no output" says 2 "no output is named tt; did you mean t?" swing --html c.html --points th,tt
check "half a point" says 2 "two names of outputs" swing --html c.html --points th
check "points in two units" says 2 "needs one unit" swing --html c.html --points 't,th'
check "html that cannot be written is said before the run" says 2 "cannot write" fixed --until 1e9 --html none/x.html --points th,th
check "a failing run leaves its animation up to there" sh -c './sim wall --html d.html --points y,y >/dev/null 2>&1; [ $? = 3 ] && grep -q "</html>" d.html'
check "nothing is left after mistakes" sh -c '! ls c.html none ./*.part* 2>/dev/null'
check "sketch" sh -c './sim swing --sketch --quiet | grep -q "t \[s\]"'
tap_end
