#!/bin/sh
# Rows of tables of `make bench`, and the time and memory of a command. Needs CC and TMP.
"$CC" -O2 tests/bench/rusage.c -o "$TMP/rusage"

# seconds TIMES COMMAND...: the least CPU seconds; kilobytes TIMES COMMAND...: the most memory.
least() { # COLUMN TIMES COMMAND...
  column=$1 times=$2
  shift 2
  while [ "$times" -gt 0 ]; do
    "$TMP/rusage" "$@" 2>&1 >/dev/null | awk -v c="$column" '/^rusage / { print $c }'
    times=$((times - 1))
  done | sort -n | head -n 1
}
seconds() { least 2 "$@"; }
kilobytes() { least 3 "$@"; }

at_most() { awk -v a="$1" -v b="$2" 'BEGIN { print a == "-" ? "not measured" : a <= b ? "met" : "not met" }'; }
row() { printf '| %s | %s | %s | %s | %s | %s |\n' "$@"; }
table() {
  row 'what' 'to reach' 'peers' 'ours' 'ours/peer' ''
  row --- --- --- --- --- ---
}
