#!/bin/sh
# lagc help: each command, statement, function, unit and option that the compiler knows (its tables, by dump_words) has
# help; the overview leads to help; a slip is answered with the nearest topic; commands that help shows work.
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
"$BIN/dump_words" >"$TMP/words"

words() { sed -n "s/^$1 //p" "$TMP/words"; } # words KIND

# ---- everything has help ----
explains() { "$LAGC" help "$1" >"$TMP/out" 2>"$TMP/err" && [ -s "$TMP/out" ] && ! [ -s "$TMP/err" ]; }
without_help() {
  { words statement; words slot; words function; words unit; words prefixed; words command
    words '[a-z]* [a-z]*' | sort -u; echo methods; } | while read -r word; do explains "$word" || echo "no help on $word"; done
}
empty "every word of the language, function, unit, command and option" "$(without_help)"

# Places of help: a statement has a row or a chapter, a function a row of its table, a unit a place in its list.
chapter() { "$LAGC" help "$1"; }
is "a statement" "  \`span 20 [s]\`
      from 0 to 20 s; negative runs backwards; without it 10 s

\`lagc help scenes\` says more." "$(chapter span)"
is "a function" "  \`atan2(y, x)\`
      the angle of the point (x, y), from -pi to pi

\`lagc help functions\` says more." "$(chapter atan2)"
is "a unit" 'unit:
  [N] = kg*m/s^2; takes the SI prefixes' "$(chapter N)"
is "a base unit" 'unit:
  [s] of the SI, a base unit; takes the SI prefixes' "$(chapter s)"
is "a unit with a prefix" 'unit:
  [kN], with an SI prefix; `lagc help units` has the table' "$(chapter kN)"
is "an option" 'option of run, plot, animate, orbit, continue, lyapunov, fit, design, sweep,
effects:
  --tol X               tolerance, relative to values and to the size of the
                        motion' "$(chapter tol)"
is "an option with its dashes" "$(chapter tol)" "$(chapter --tol)"
check "a value of an option" sh -c '"$0" help latex | grep -q "^  --format text|latex|c$" && "$0" help long | grep -q -- "--precision"' "$LAGC"
is "a word of paper" "losses are a Rayleigh function, \`dissipation = c/2*x'^2\`, or a \`force\`" "$(chapter damping | head -n 1)"
check "a word that is a function and a unit" sh -c '"$0" help min | grep -q "smaller" && "$0" help min | grep -q "60 s"' "$LAGC"
check "embedding is what header does" sh -c '"$0" help embedding | cmp - "$1"' "$LAGC" /dev/stdin <<END
$(chapter header)
END

# Lists of the reference, which is written by hand, are complete.
not_listed() {
  chapter functions >"$TMP/functions"
  chapter sum >>"$TMP/functions"
  words function | while read -r f; do grep -q "\`$f(" "$TMP/functions" || echo "the reference has no function $f"; done
  sed -n '/^The units: /,/^$/p' grammar/LANGUAGE.md | tr ' ;,()' '\n\n\n\n\n' >"$TMP/units"
  chapter units | sed -n '/^The table/,$p' | tr ' *' '\n\n' >"$TMP/table"
  { words unit; words prefixed; } | sort >"$TMP/all_units"
  sed 's/\.$//' "$TMP/units" | sort -u | comm -13 - "$TMP/all_units" | sed 's/^/the reference has no unit /'
  sort -u "$TMP/table" | comm -13 - "$TMP/all_units" | sed 's/^/the table has no unit /'
}
empty "functions and units of the reference" "$(not_listed)"

# A simulator's own help has the options that lagc passes on, in 80 columns.
handed() { for c in run plot modes cost lyapunov sweep; do words "passed $c"; done | grep -e -- | sort -u; }
LAGC_OPTIMISE=-O0 "$LAGC" build models/pendulum.lag -o "$TMP/pendulum" && "$TMP/pendulum" --help >"$TMP/own"
untold() { for o in $(handed); do grep -q -e "^  $o " -e "^  -., $o " -e "^  $o\$" "$TMP/own" || echo "$o"; done; }
check "lagc passes options on" [ "$(handed | wc -l)" -gt 40 ]
empty "a simulator's --help has each of them" "$(untold)"
empty "80 columns of a simulator's help" "$(sed '1,/name=value   /d' "$TMP/own" | awk 'length > 80')"

# The compiler under sanitizers prints the same.
differs() {
  { words statement; words command | grep -v methods; [ -z "${SLOW:-}" ] || words function; echo; echo units; } | while read -r t; do
    one_of 4 || continue
    "$LAGC_SAN" help ${t:+"$t"} >"$TMP/san" 2>&1 && "$LAGC" help ${t:+"$t"} | cmp -s - "$TMP/san" || echo "$t: $(head -n 3 "$TMP/san")"
  done
}
empty "under sanitizers" "$(differs)"

# ---- the overview ----
"$LAGC" help >"$TMP/overview"
leads_nowhere() {
  sed -n 's/^  \([a-z-]*\)  *.*/\1/p' "$TMP/overview" | while read -r topic; do explains "$topic" || echo "$topic"; done
}
empty "the overview's topics" "$(leads_nowhere)"
not_in_overview() { { words command | grep -v -x -e help -e version; words statement; } | while read -r w; do grep -q -w -e "$w" "$TMP/overview" || echo "$w"; done; }
empty "the overview knows every command and statement" "$(not_in_overview)"
is "it lists functions once, and chapters by their titles" "1  closed-forms          Closed forms" \
  "$(grep -c -w atan2 "$TMP/overview")$(grep closed-forms "$TMP/overview")"
is "lagc alone is lagc help" "$(cat "$TMP/overview")" "$("$LAGC")"
is "lagc --help, too" "$(cat "$TMP/overview")" "$("$LAGC" --help)"
differing() { words command | while read -r c; do "$LAGC" "$c" --help >"$TMP/out" 2>&1 && "$LAGC" help "$c" | cmp -s - "$TMP/out" || echo "$c"; done; }
empty "lagc COMMAND --help is lagc help COMMAND" "$(differing | grep -v -x -e help -e version)"

# All fits into 80 columns: characters, not bytes.
wide() {
  { words command; sed -n 's/^  \([a-z-]*\)  *.*/\1/p' "$TMP/overview"; } | while read -r t; do
    echo "[$t]" && chapter "$t"
  done | sed 's/[^ -~][^ -~]*/?/g' | awk '/^\[/ { t = $0 } length > 80 { print t ": " $0 }'
}
empty "80 columns" "$(wide)"

# ---- slips ----
says() { # says WORDS ARGS...: exit status 2, nothing on standard output, and a message that begins so
  want="lagc: $1"
  shift
  got=$("$LAGC" "$@" 2>&1 >"$TMP/out")
  [ $? = 2 ] && ! [ -s "$TMP/out" ] && [ "${got#"$want"}" != "$got" ] || { echo "$got"; return 1; }
}
check "a mistyped statement" says 'no help on `lagrangain`: did you mean `lagrangian`?' help lagrangain
check "a mistyped option" says 'no help on `--metod`: did you mean `--method`?' help --metod
check "a mistyped function" says 'no help on `sinn`: did you mean `sin`?' help sinn
check "nothing near" says 'no help on `xyzzy`; `lagc help` lists the topics' help xyzzy
m=models/pendulum.lag
check "a command of other tools leads to what does exist" says 'unknown command `eigenvalues`: `lagc modes MODEL` finds the equilibrium' eigenvalues $m
check "a command for what lagc does not do" says 'unknown command `optimise`: controls are not optimised here; `lagc sweep` scans ranges' optimise $m
check "a mistyped command" says 'unknown command `rum`: did you mean `run`?' rum $m
check "no command" says "a command is missing before $m: \`lagc run $m\`" $m
check "no model" says 'a model is missing; usage: lagc check MODEL [SCENE] [--allow-numeric] [--verbose]' check
check "an option of another command" says '`--phase` is an option of `lagc plot`; `lagc help run` lists those of `lagc run`' run $m --phase th
check "a mistyped option of the simulator is said before one is built" says '`lagc run` has no option `--untill`: did you mean `--until`?' run $m --untill 5
check "an option by the name that it has elsewhere" says '`lagc run` has no option `--dt`; here it is called `--step`' run $m --dt 0.1
check "with its value behind an equals sign" says '`lagc run` has no option `--rtol`; here it is called `--tol`' run $m --rtol=1e-3
check "which a command without such an option does not have" says '`lagc check` has no option `--dt`; `lagc help check` lists them' check $m --dt 0.1
check "one dash" says '`lagc run` has no option `-tol`: did you mean `--tol`?' run $m -tol 1e-9
check "an option that is nowhere near" says '`lagc check` has no option `--frobnicate`; `lagc help check` lists them' check $m --frobnicate
check "an option that is none of this command" says '`--format` is an option of `lagc derive`; `lagc help check` lists those of `lagc check`' check $m --format c
check "a value is missing" says '--until needs a value: --until T' run $m --until
check "two lists of files" says '--data stands twice; several files are one list: --data a.csv,b.csv' fit $m --data a.csv --data b.csv --fit g
check "options and constants twice: a note" sh -c "'$LAGC' derive $m --format latex --format text 2>&1 >/dev/null | grep -qx 'lagc: note: --format latex gives way to text' && '$LAGC' emit models/chain.lag -D N=3 -D N=4 2>&1 >/dev/null | grep -qx 'lagc: note: -D N=3 gives way to 4'"
check "a value too many" says '--json takes no value' run $m --json=1
check "a wrong choice" says '--format takes text, latex, c, not `html`' derive $m --format html
check "a wrong stage" says '--dump takes ast, eqns, passes, prog, with commas between several, not `asm`' derive $m --dump ast,asm
check "a definition that is none" says '-D takes CONST=VALUE, for example -D N=50' derive $m -D N
check "completion for no shell" says 'which shell? write `lagc completion bash`' completion
check "-DN=3, -D N=3, --define N=3" sh -c '
  for d in "-DN=3" "-D N=3" "--define=N=3" "--define N=3"; do "$0" derive models/string.lag $d --ops; done | sort -u | awk "END { exit NR != 1 }"' "$LAGC"

# ---- natural words: the first screen has the command, the statement or the call ----
finds() { # finds ANSWER WORDS...: the answer stands in the first 40 lines
  want=$1
  shift
  "$LAGC" help "$@" 2>&1 | head -n 40 >"$TMP/found"
  grep -qF -e "$want" "$TMP/found" || { head -n 4 "$TMP/found"; return 1; }
}
while IFS='|' read -r words answer; do
  check "help $words" finds "$answer" $words
done <<'END'
linearize|lagc linearize
linearisation of my model|--with linear
eigenfrequencies|lagc modes
normal modes|lagc modes
python example|m = lagc.load(
monte carlo|--samples
the Jacobian in C|lagc header MODEL --with jac
bounce|contact floor: y >= 0, restitution
a ball bounces off a wall|restitution
chaos|lagc lyapunov
poincaré section|--section
stiff equations|radau
time step|--step
save a table|-o FILE.csv
read csv|input u [N] = "FILE.csv"
gif|lagc animate
delay|cannot be written
noise|stochastic forces are not followed
fit parameters|lagc fit: 
cluster|lagc sweep MODEL RANGES --mpi
air resistance|dissipation
latex|--format text|latex|c
conserved quantities|lagc noether
moment of inertia|bodies.lag
rolling without slipping|constraint roll
run faster|lagc cost
licence|0BSD
stop a run|`stop` ends
microcontroller|lagc header
checkpoint|--save-state
restart a run|--resume
piecewise|if(x > 0, a, b)
heaviside|if(t > 1, 1, 0)
modulo|floor(x/n)
ode45|dop853
lqr|lagc linearize
slope|m*g*s*sin(a)
inclined plane|m*g*s*sin(a)
boundary value problem|shooting
dirac delta|kick
limit cycle|--skip
coriolis force|let X
transfer function|lagc linearize
magnetic field|charged_particle
degrees of freedom|lagc check
natural frequency|lagc modes
normal force|lambda(NAME)
dense output|--every
fixed point|lagc modes
blow up|lagc check
equations of motion|lagc derive
END
is "options for experts stand in one place" "0 1" "$("$LAGC" help run | grep -c -e '--math\|--dump\|--fix\|--no-gsl\|--define\|--precision') $(chapter expert | grep -c -e '--math own')"
check "the tutorial" finds "A first quarter of an hour" tutorial
sed -n 's/^BROUGHT //p' "$TMP/words" >"$TMP/brought" # words | meanings
every_word() { sed 's/ *|.*//' "$TMP/brought" | tr ' ' '\n' | while read -r w; do ! one_of 16 || explains "$w" || echo "$w"; done; }
empty "the words of the table of synonyms have an answer" "$(every_word)"
shown() { sed -n 's/^WAY //p' "$TMP/words" | grep -o '`lagc [a-z]*' | sort -u; }
empty "the table names commands that exist" "$(shown | while read -r _ c; do words command | grep -q -x "$c" || echo "$c"; done)"
meant() { sed 's/.*| *//' "$TMP/brought" | tr ' ' '\n' | sort -u; }
cat grammar/*.md README.md models/TUTORIAL.md runtime/python/README.md src/commands/command_table.c runtime/app/options.def >"$TMP/documents"
unsaid() { meant | while read -r w; do grep -qiwF -e "$w" "$TMP/documents" || echo "$w"; done; }
empty "synonyms are words that the documents have" "$(unsaid)"

# ---- commands that help shows ----
embeds() {
  mkdir -p "$TMP/embed" && chapter header | sed -n 's/^  \(lagc header .*\)/\1/p' | sed "s|^lagc|$LAGC|; s|-o |-o $TMP/embed/|" | sh -e &&
    { chapter header | sed -n 's/^  #/#/p'; echo 'int main(void) { return !PEND_IMPLEMENTATION_IS_THERE; }'; } |
      sed 's/PEND_IMPLEMENTATION_IS_THERE/(sizeof(pend_params) > 0)/' >"$TMP/embed/main.c" &&
    "$CC" -std=c99 -Wall -o "$TMP/embed/main" "$TMP/embed/main.c" -lm && "$TMP/embed/main"
}
check "the header of lagc help header" embeds
is "lagc help methods is run --method help" "$("$LAGC" run $m --method help)" "$("$LAGC" help methods)"

# ---- methods of integration, by their names ----
is "a method: its row" "$(chapter methods | grep '^  verlet ')" "$(chapter verlet | grep '^  verlet ')"
is "its words and options" "$(chapter methods | sed -n '/^  verlet:/,/^$/p')" "$(chapter verlet | sed -n '/^  verlet:/,/^$/p')"
no_help() { for w in $(chapter methods | sed -n 's/^  \([a-z0-9_-]*\)  *[0-9].*/\1/p') equilibrium picture; do explains "$w" || echo "$w"; done; }
empty "every method has help" "$(no_help)"
[ -z "$GSL" ] || check "steppers of GSL that went name the one that stays" says 'unknown method gsl-msadams; did you mean gsl-rk8pd?' build $m --method gsl-msadams
[ -z "$GSL" ] || check "for stiff models, too" says 'unknown method gsl-msbdf; did you mean gsl-bsimp?' build $m --method 'gsl-msbdf(step=1)'
check "a mistyped method" says 'no help on `verlett`: did you mean `verlet`?' help verlett
tap_end
