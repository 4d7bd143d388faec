#!/bin/sh
# `make test` builds its simulators at -O0, users get -O2: models of the gallery put out the same bytes with both.
. tests/tap.sh
. tests/exec/lib_levels.sh
for m in models/*.lag; do
  one_of 16 || continue
  name=$(basename "$m" .lag)
  check "$name" same_rows "$name"
done
tap_end
