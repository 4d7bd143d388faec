# shellcheck shell=sh
# For suites that hold motions of small models against closed forms: run_contact_friction.sh, run_moreau.sh. `near` takes the place of that of tap.sh.
. tests/tap.sh

model() { cat >"$TMP/$1.lag"; }
run() { # run MODEL ARGS...: JSON in $TMP/json, rows in $TMP/csv
  name=$1
  shift
  "$LAGC" run "$TMP/$name.lag" "$@" --quiet -o "$TMP/csv" --json >"$TMP/json" 2>"$TMP/err" || { cat "$TMP/json" "$TMP/err"; return 1; }
}
number() { sed -n "s/.*\"$1\": \\([-0-9.e+]*\\).*/\\1/p" "$TMP/json"; }
final() { sed 's/.*"final": {//' "$TMP/json" | sed -n "s/.*\"$1\": \\([-0-9.e+]*\\).*/\\1/p"; }
cell() { awk -F, -v t="$1" -v c="$2" '$1 == t { print $c }' "$TMP/csv"; } # TIME COLUMN
calc() { awk "BEGIN { printf \"%.17g\", $1 }"; }

model_refused() { # model_refused WORDS COMMAND MODEL ARGS...: a refusal with these words
  words=$1 command=$2 name=$3
  shift 3
  "$LAGC" "$command" "$TMP/$name.lag" "$@" >"$TMP/log" 2>&1 && { cat "$TMP/log"; return 1; }
  grep -q -e "$words" "$TMP/log" || { cat "$TMP/log"; return 1; }
}
