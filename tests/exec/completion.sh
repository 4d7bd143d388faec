#!/bin/sh
# Completion: candidates of `lagc complete` for the last word of a command line, and of the scripts for bash, zsh and fish,
# each run by its shell, if installed, without a terminal. Every command and every option that
# the parser knows (dump_words) is offered.
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
"$BIN/dump_words" >"$TMP/words"
mkdir -p "$TMP/here/a folder"
cp models/double_pendulum.lag models/cart_pendulum.lag models/chain.lag models/kepler.lag "$TMP/here"
cp models/pendulum.lag "$TMP/here/a folder"
touch "$TMP/here/rows.csv" "$TMP/here/rows.npy" "$TMP/here/chaos.svg"
cat >"$TMP/here/broken.lag" <<'END'
model broken
coord x [m]
lagrangian = x'^2 +
scene first "a scene of a model with a mistake" { span 1 }
END
cd "$TMP/here" || exit 1

# offers WORD...: the candidates for the last word, on one line
offers() { "$LAGC" complete "$@" | cut -f 1 | tr '\n' ' ' | sed 's/ $//'; }
offered() { # offered CANDIDATE WORD...: the candidate is offered
  want=$1
  shift
  "$LAGC" complete "$@" | cut -f 1 | grep -q -x -F -e "$want"
}

# ---- candidates ----
is "commands" "$(sed -n 's/^command //p' "$TMP/words")" "$("$LAGC" complete '' | cut -f 1)"
is "a command" 'run' "$(offers ru)"
is "with what it does" "run	simulate" "$("$LAGC" complete ru)"
missing_options() {
  sed -n 's/^command //p' "$TMP/words" | grep -v -x -e completion -e help -e version | while read -r c; do
    "$LAGC" complete "$c" double_pendulum.lag - | cut -f 1 >"$TMP/offered"
    sed -n "s/^[a-z]* $c \\(-.*\\)/$c \\1/p" "$TMP/words" | grep -v ' -h$' | awk 'NR == FNR { has[$1]; next } !($2 in has)' "$TMP/offered" -
  done
}
empty "options" "$(missing_options)"
is "no options of another command" '' "$(offers check double_pendulum.lag --meth)"
is "models" ':files lag' "$(offers run '')"
is "scenes, then what can be set" "swing workshop shove M= m= l= g= x= x'= th= th'=" "$(offers run cart_pendulum.lag '')"
is "scenes of check: nothing can be set" 'swing workshop shove' "$(offers check cart_pendulum.lag '')"
is "a scene, with what it says of itself" 'first	a scene of a model with a mistake' "$("$LAGC" complete run broken.lag '')"
is "a parameter of an effect that the scene uses" 'drag.c=' "$(offers run cart_pendulum.lag workshop dr)"
is "not of one that it does not use" '' "$(offers run cart_pendulum.lag swing dr)"
is "an option between them is no scene" 'drag.c=' "$(offers run cart_pendulum.lag --until 5 workshop dr)"
is "a velocity" "th'=" "$(offers run cart_pendulum.lag "th'")"
is "its unit" 'drag.c=	parameter, [N*s/m]' "$("$LAGC" complete run cart_pendulum.lag workshop drag)"
is "members of a family, as many as -D says" 'th[1]= th[2]= th[3]= th[4]= th[5]=' "$(offers run chain.lag -D N=5 'th[' | sed "s/ th.[1-5].'=//g")"
is "and with -DN=2" 'th[1]= th[2]=' "$(offers run chain.lag -DN=2 'th[' | sed "s/ th.[1-5].'=//g")"
is "constants" 'N=' "$(offers run chain.lag -D '')"
is "methods" 'verlet verlet4 verlet6 verlet8' "$(offers run kepler.lag --method verlet)"
is "in the same word" '--method=dop853' "$(offers run kepler.lag --method=dop)"
listed() { "$LAGC" methods | awk '/^  method / { table = 1; next } !NF { table = 0 } table { print $1 }' | sort; }
is "all methods" "$(listed)" "$("$LAGC" complete run kepler.lag --method '' | cut -f 1 | grep -v -x help | sort)"
is "names in an expression" 'm1*x1 m1*x2' "$(offers plot double_pendulum.lag --y 'm1*x')"
is "functions in an expression" '2*atan( 2*atan2(' "$(offers plot double_pendulum.lag --y '2*ata')"
is "no names after a number" '' "$(offers plot double_pendulum.lag --y 2)"
is "choices" 'text latex c' "$(offers derive kepler.lag --format '')"
is "choices with commas" '--dump=ast,eqns' "$(offers check kepler.lag --dump=ast,e)"
is "files of rows" ':files csv npy' "$(offers run kepler.lag -o '')"
is "files of a header" ':files h hpp' "$(offers header kepler.lag -o '')"
is "any file" ':files' "$(offers run kepler.lag --resume '')"
is "a number is the user's" '' "$(offers run kepler.lag --until '')"
is "topics" 'scenes scene' "$(offers help sce)"
is "shells" 'bash zsh fish' "$(offers completion '')"
silent() { "$LAGC" complete "$@" >out 2>&1 && ! [ -s out ]; }
case $LAGC_SAN in /*) san=$LAGC_SAN ;; *) san=$OLDPWD/$LAGC_SAN ;; esac
sane() {
  for word in '' "th'" --method=r -DN ${SLOW:+s - --m --y=2*s --dump=a,}; do
    for first in run help ${SLOW:+plot check ''}; do
      "$LAGC" complete ${first:+"$first"} cart_pendulum.lag "$word" >out 2>&1
      LAG_HOME=$LAG_TREE "$san" complete ${first:+"$first"} cart_pendulum.lag "$word" >san 2>&1 && cmp out san || { head san; return 1; }
    done
  done
}
check "under sanitizers" sane
check "a file that is not there" silent run none.lag ''
check "an unknown command" silent frobnicate ''
check "no word at all" silent

# ---- bash: the function, as readline calls it ----
if command -v bash >/dev/null; then
  "$LAGC" completion bash >"$TMP/lagc.bash"
  cat >"$TMP/call.bash" <<'END'
# call.bash SCRIPT WORD...: the words as bash has broken them; prints COMPREPLY
source "$1"
shift
COMP_WORDS=("$@")
COMP_CWORD=$(($# - 1))
_lagc "$1"
printf '%s\n' "${COMPREPLY[@]}" | LC_ALL=C sort | tr '\n' ' ' | sed 's/ $//'
END
  replies() { bash --norc --noprofile "$TMP/call.bash" "$TMP/lagc.bash" "$LAGC" "$@" 2>&1; }
  is "bash: a command" 'run' "$(replies ru)"
  is "bash: models and folders" 'a folder broken.lag cart_pendulum.lag chain.lag double_pendulum.lag kepler.lag' "$(replies run '')"
  is "bash: a model in a folder" 'a folder/pendulum.lag' "$(replies run 'a\ folder/p')"
  is "bash: a scene" 'chaos' "$(replies run double_pendulum.lag cha)"
  is "bash: a model whose name has a space" 'fading' "$(replies run 'a\ folder/pendulum.lag' fa)"
  is "bash: a model in quotes" 'fading' "$(replies run '"a folder/pendulum.lag"' fa)"
  is "bash: a velocity, quoted" "th\\'=" "$(replies run cart_pendulum.lag "th\\'")"
  is "bash: inside quotes nothing is quoted" "th'=" "$(replies run cart_pendulum.lag "\"th'")"
  is "bash: an option" '--method' "$(replies run kepler.lag --meth)"
  is "bash: a word broken at =" 'dop853' "$(replies run kepler.lag --method = dop)"
  is "bash: broken, with nothing after it" 'c latex text' "$(replies derive kepler.lag --format =)"
  is "bash: settings before it" 'dop853' "$(replies run kepler.lag mu = 2 --method = dop)"
  is "bash: a file after =" 'chaos.svg' "$(replies run kepler.lag --svg = c | sed 's/a folder *//')"
  is "bash: files by their suffix" 'rows.csv rows.npy' "$(replies run kepler.lag -o rows)"
  is "bash: in quotes" 'm1*x1 m1*x2' "$(replies plot double_pendulum.lag --y "'m1*x")"
  is "bash: an expression without quotes" 'm1\*x1 m1\*x2' "$(replies plot double_pendulum.lag --y 'm1*x')"
  is "bash: complete -F _lagc" 'complete -F _lagc lagc' "$(bash --norc -c 'source "$0"; complete -p lagc' "$TMP/lagc.bash")"
else
  skip "completion for bash" "no bash"
fi

# ---- zsh: compadd, compset and _files stand for the shell's own ----
if command -v zsh >/dev/null; then
  "$LAGC" completion zsh >"$TMP/lagc.zsh"
  cat >"$TMP/call.zsh" <<'END'
# call.zsh SCRIPT WORD...: candidates handed to the shell
script=$1
shift
compdef() { :; }
compset() { print -r -- "compset $*"; }
_files() { print -r -- "files $*"; }
compadd() { print -r -- "$((${argv[(I)-S]} ? 1 : 0)) ${(P)${@[-1]}}"; }
source $script
words=("$@")
CURRENT=$#
PREFIX=${words[-1]}
_lagc
END
  given() { zsh -f "$TMP/call.zsh" "$TMP/lagc.zsh" "$LAGC" "$@" 2>&1; }
  is "zsh: a command" '0 run' "$(given ru)"
  is "zsh: scenes, and settings without a space after them" "0 swing workshop shove
1 M= m= l= g= x= x'= th= th'=" "$(given run cart_pendulum.lag '')"
  is "zsh: a model in a folder" '0 fading' "$(given run 'a\ folder/pendulum.lag' fa)"
  is "zsh: files by their suffix" 'compset -P --[a-z-]#=
files -g *.(csv|npy)(-.)' "$(given run kepler.lag -o '')"
  is "zsh: any file" 'compset -P --[a-z-]#=
files ' "$(given run kepler.lag --resume '')"
  is "zsh: in the same word" '0 --method=dop853' "$(given run kepler.lag --method=dop)"
  is "zsh: the file of a function" '#compdef lagc' "$(head -n 1 "$TMP/lagc.zsh")"
else
  skip "completion for zsh" "no zsh"
fi

# ---- fish: asked as a user asks ----
if command -v fish >/dev/null; then
  "$LAGC" completion fish >"$TMP/lagc.fish"
  PATH=$(dirname "$LAGC"):$PATH # fish completes the command of this name
  asked() { HOME=$TMP fish --no-config -c 'source $argv[1]; complete -C $argv[2]' "$TMP/lagc.fish" "lagc $1" 2>&1 | cut -f 1 | LC_ALL=C sort | tr '\n' ' ' | sed 's/ $//'; }
  is "fish: a command" 'run' "$(asked ru)"
  is "fish: models and folders" 'a folder/ broken.lag cart_pendulum.lag chain.lag double_pendulum.lag kepler.lag' "$(asked 'run ')"
  is "fish: a scene" 'chaos' "$(asked 'run double_pendulum.lag cha')"
  is "fish: a model in a folder" 'fading' "$(asked "run 'a folder/pendulum.lag' fa")"
  is "fish: files by their suffix" 'a folder/ rows.csv rows.npy' "$(asked 'run kepler.lag -o ')"
  is "fish: a file after =" '--svg=chaos.svg' "$(asked 'run kepler.lag --svg=c')"
  is "fish: in the same word" '--method=dop853' "$(asked 'run kepler.lag --method=dop')"
else
  skip "completion for fish" "no fish"
fi
tap_end
