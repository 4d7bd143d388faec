#!/bin/sh
# Who calls whom: files call each other in circles of at most 8.
. tests/tap.sh
if ! command -v python3 >/dev/null || ! command -v nm >/dev/null; then
  skip "circles of calls" "no python3 with nm"
  tap_end
  exit
fi

for half in src runtime; do empty "circles of calls in $half" "$(python3 tests/exec/calls.py "$BUILD/obj/$half" 8 2>&1)"; done
tap_end
