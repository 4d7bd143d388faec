# shellcheck shell=sh
# Helpers for suites that are scripts: `. tests/tap.sh` at their head, `tap_end` at their end.
tap_n=0
tap_bad=0

# check NAME COMMAND...: ok when the command succeeds; what it prints is shown when it does not.
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

# empty NAME TEXT: ok when the text is empty, a list of what is wrong otherwise.
empty() {
  tap_expected=
  tap_got=$2
  check "$1" tap_empty
}
tap_empty() { [ -z "$tap_got" ] || { printf '%s\n' "$tap_got"; return 1; }; }

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
