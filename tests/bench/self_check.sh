#!/bin/sh
# Cost of the comparison with the text: its share of the instructions of `lagc emit`, by callgrind. Target: a tenth of the compilation.
set -eu
: "${LAGC:=build/lagc}" "${TMP:=$(mktemp -d)}"
command -v valgrind >/dev/null || {
  echo "no valgrind: apt-get install valgrind"
  exit 0
}
for model in double_pendulum chain free_body rattleback string fput outer_planets pleiades schwarzschild satellite; do
  valgrind --tool=callgrind --callgrind-out-file="$TMP/calls" "$LAGC" emit "models/$model.lag" -o "$TMP/model.c" >/dev/null 2>&1
  callgrind_annotate --inclusive=yes --threshold=100 "$TMP/calls" | awk -v model="$model" '
    /PROGRAM TOTALS/ { total = $1 }
    /:self_check( |$)/ && !own { own = $1 } # the file is ??? in a compiler without -g
    END { if (!own) { print "bench self_check: callgrind names no function self_check: is the compiler stripped?"; exit 1 }
          gsub(",", "", total); gsub(",", "", own); printf "%-18s %10.2f million instructions, of which the comparison %5.1f %%\n", model, total/1e6, 100*own/total }'
done
