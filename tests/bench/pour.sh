#!/bin/sh
# 1000 discs with friction and 1000 balls poured into a box, by moreau: processor time a step of a compiled run in its first second, in which they fall,
# in the sixth tenth of it, when discs meet the most, and in the fourth second, in which they rest; time and memory of their C. To reach: 5 ms; 0.2 s.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${TMP:=$(mktemp -d)}"
. tests/bench/lib_rows.sh
table
for name in pour balls; do
  model=tests/bench/models/$name.lag
  "$LAGC" build "$model" -o "$TMP/sim"
  "$TMP/sim" --quiet --until 3 --save-state "$TMP/state" -o "$TMP/csv"
  pours=$(seconds 2 "$TMP/sim" --quiet --until 1 -o "$TMP/csv")
  half=$(seconds 2 "$TMP/sim" --quiet --until 0.5 -o "$TMP/csv")
  more=$(seconds 2 "$TMP/sim" --quiet --until 0.6 -o "$TMP/csv")
  rests=$(seconds 2 "$TMP/sim" --quiet --resume "$TMP/state" --until 4 -o "$TMP/csv")
  row "$name, 1000 that fall, ms a step" '<= 5' '' "$pours" '' "$(at_most "$pours" 5)"
  most=$(awk "BEGIN { print 10*($more - $half) }") # 100 steps; 1000 in the others
  row "$name, 1000 from 0.5 to 0.6 s, ms a step" '<= 5' '' "$most" '' "$(at_most "$most" 5)"
  row "$name, 1000 at rest, ms a step" '<= 5' '' "$rests" '' "$(at_most "$rests" 5)"
  for n in 50 1000; do
    took=$(seconds 2 "$LAGC" emit "$model" -D "N=$n" -o "$TMP/c")
    row "lagc emit, $name of $n" '<= 0.2 s' '' "$took s, $(kilobytes 1 "$LAGC" emit "$model" -D "N=$n" -o "$TMP/c") KB" '' "$(at_most "$took" 0.2)"
  done
done
