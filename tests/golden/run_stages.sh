#!/bin/sh
# Golden tests of the back half. Each is two files, NAME.lag and NAME.expected:
#   tests/golden/prog    the program of the accelerations, as `lagc emit --dump=prog` lists it
#   tests/golden/c       the model's part of the emitted C, without the arithmetic that stands before it
# run_emitted.sh has checksums of the whole gallery; these few show what has changed. BLESS=1 rewrites the expectations, on purpose.
. tests/tap.sh
program() { "$LAGC" emit "$1" --dump=prog -o "$TMP/model.c"; }
text() { "$LAGC" emit "$1"; }
for lag in tests/golden/prog/*.lag; do golden "$lag" "${lag%.lag}.expected" 0 program "$lag"; done
for lag in tests/golden/c/*.lag; do golden "$lag" "${lag%.lag}.expected" 0 text "$lag"; done
tap_end
