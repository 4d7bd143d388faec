#!/bin/sh
# A string of 27,000 masses with cubic springs and 256 bodies that attract each other: graphs of a million nodes each. They compile
# within 2 GB and a stack of 256 KB (nothing recurses on the user's text), and agree with loops written by hand.
. tests/tap.sh
bench=tests/bench

emits() { # OUTPUT COMMAND...: less than 4 MB of C, within five minutes
  (ulimit -v 2000000 && ulimit -s 256 && timeout 300 "$@" -o "$TMP/$output") && [ "$(wc -c <"$TMP/$output")" -lt 4000000 ]
}
like_by_hand() { # SCENE PEER NAME OPTIONS...
  "$CC" -O1 -std=gnu11 -w -I"$INC" -I$bench "-DSCENE=$1" "-DPEERS=X($3)" -DSCENE_START -DWITHIN=0.3 $4 $bench/driver.c "$TMP/$output" \
    $bench/hand/$2.c -lm -o "$TMP/driver" && "$TMP/driver" check
}
output=string.c
check "a string of 27,000 masses is emitted" emits "$LAGC" emit models/string.lag hard -DN=27000
# The C compiler takes a minute and 1.3 GB for it.
[ "${ROWS:-all}" = some ] || check "it computes what a loop by hand computes" like_by_hand string_hard string loop -DN=27000
output=bodies.c
check "256 bodies are emitted" emits "$LAGC" emit $bench/models/bodies.lag
tap_end
