# shellcheck shell=sh
# Helpers for suites that are scripts: `. tests/tap.sh` at their head, `tap_end` at their end.
tap_n=0
tap_bad=0

# check NAME COMMAND...: ok when the command succeeds; its output is shown when it fails.
check() {
  tap_n=$((tap_n + 1))
  tap_name=$1
  shift
  if "$@" >"$TMP/tap_output" 2>&1; then
    echo "ok $tap_n - $tap_name"
  else
    tap_bad=$((tap_bad + 1))
    echo "not ok $tap_n - $tap_name"
    sed 's/^/# /' "$TMP/tap_output"
  fi
}

# is NAME EXPECTED GOT
is() {
  tap_expected=$2
  tap_got=$3
  check "$1" tap_same
}
tap_same() {
  [ "$tap_expected" = "$tap_got" ] || {
    printf 'expected: %s\n     got: %s\n' "$tap_expected" "$tap_got"
    return 1
  }
}

# empty NAME TEXT: ok when the text, a list of faults, is empty.
empty() {
  tap_expected=
  tap_got=$2
  check "$1" tap_empty
}
tap_empty() { [ -z "$tap_got" ] || { printf '%s\n' "$tap_got"; return 1; }; }

# near NAME TOLERANCE EXPECTED GOT: ok when the numbers differ by at most the tolerance.
near() { check "$1" tap_near "$2" "$3" "$4"; }
tap_near() {
  echo "got $3, expected $2 within $1"
  awk -v t="$1" -v e="$2" -v g="$3" 'BEGIN { d = g - e; exit !(g != "" && d <= t && -d <= t) }'
}

# says STATUS WORDS COMMAND...: the command ends with this status and prints these words, on standard error if the status is not 0.
says() {
  tap_status=$1 tap_words=$2
  shift 2
  "$@" >"$TMP/out" 2>"$TMP/err" </dev/null
  tap_got=$?
  cat "$TMP/out" "$TMP/err"
  if [ "$tap_status" = 0 ]; then cat "$TMP/out" >>"$TMP/err"; fi
  [ "$tap_got" = "$tap_status" ] && grep -qF -e "$tap_words" "$TMP/err"
}

skip() {
  tap_n=$((tap_n + 1))
  echo "ok $tap_n - $1 # SKIP $2"
}

skip_all() {
  echo "1..0 # SKIP $1"
  exit 0
}

tap_end() {
  echo "1..$tap_n"
  [ "$tap_bad" = 0 ]
}
