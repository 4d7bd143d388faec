#!/bin/sh
# Runs that lagc has made before start without deriving: the same numbers and messages, and nothing old where a text, a table, a word or a file changed.
cd "$(dirname "$0")/../.." || exit 2
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
dir=$TMP/run_known.$$
mkdir -p "$dir/cache" || exit 2
trap 'rm -rf "$dir"' EXIT
XDG_CACHE_HOME=$dir/cache LAGC_OPTIMISE=-O0
export XDG_CACHE_HOME LAGC_OPTIMISE
unset LAG_HOME LAGC_CACHE_MIB
cd "$dir" || exit 2
cat >m.lag <<'EOF'
model m
include "part.lag"
include "bodies.lag"
coord x
param k = 1, idle = 2
input u = "u.csv"
kinetic = ball(5, 1)*x'^2/4
force x = -k*pull(x) + u
scene s { start x = 1; span 1; output x, x' }
EOF
echo 'function pull(x) = x + 1e-13*sqrt(x + 10)' >part.lag
printf 't,u\n0,0\n5,0\n' >u.csv
lag_run() { "$LAGC" run m.lag --tol 1e-12 --quiet -o rows.csv "$@" >out 2>err; }
# The last x: of x'' = -k x + u from x(0) = 1 by hand, k and u constant.
last() { awk -F, 'END { printf "%.9f", $2 }' rows.csv; }
motion() { awk "BEGIN { k = $1; u = ${2:-0}; printf \"%.9f\", u/k + (1 - u/k)*cos(sqrt(k)) }"; }
runs() { "$LAGC" cache | awk '$1 == "runs" { print $2 }'; }
gives() { # gives NUMBER WORDS...
  expected=$1; shift
  lag_run "$@"
  cat err
  [ "$(last)" = "$expected" ] || { echo "$(last), expected $expected"; return 1; }
}
known_by() { # HOW: the rows are those of the first
  for _ in 1 2; do "$LAGC" run units.lag free --quiet --compile "$1" -o "$1.csv" || return 1; cmp never.csv "$1.csv" || return 1; done
}
check 'a first run' gives "$(motion 1)"
is 'is kept' 1 "$(runs)"
cp err err1
check 'its message' grep -q 'm.lag:5:.*warning: .*idle' err1
check 'the same run' gives "$(motion 1)"
check 'has the same message' cmp err err1
check 'another number' gives "$(motion 4)" k=4
check 'and another' gives "$(motion 2.25)" k=2.25
is 'is the same entry but for the names that are given' 2 "$(runs)"
touch -d '2 days ago' cache/lagc/*.run
check 'a known run' gives "$(motion 4)" k=4
is 'has used its entry' 1 "$(find cache/lagc -name '*.run' -mtime -1 | wc -l)"
for f in cache/lagc/*.run; do printf x | dd of="$f" bs=1 seek=40 conv=notrunc 2>/dev/null; done
check 'a damaged entry' gives "$(motion 4)" k=4
lag_run
echo 'function pull(x) = 4*x + 1e-13*sqrt(x + 10)' >part.lag
check 'a part of the model that changed' gives "$(motion 4)"
printf 't,u\n0,2\n5,2\n' >u.csv
check 'a table that changed' gives "$(motion 4 2)"
printf 't,u\n0,1\n5,1\n' >v.csv
check 'a table of the command line' gives "$(motion 4 1)" u=v.csv
printf 't,u\n0,3\n5,3\n' >v.csv
check 'that changed' gives "$(motion 4 3)" u=v.csv
check 'another formula of an input' gives "$(motion 4 1)" 'u=1'
check 'a number in its place' gives "$(motion 4 2)" 'u=2'
check 'a formula' gives "$(motion 4 1)" u=k
cp u.csv k
check 'that is now the name of a file' gives "$(motion 4 2)" u=k
lag_run
echo 'function ball(m, r) = m*8' >bodies.lag
check 'a file beside the model that was in the library' gives "$(awk 'BEGIN { printf "%.9f", 0.5 + 0.5*cos(sqrt(4/20)) }')"
rm bodies.lag
lag_run; cp m.lag kept.lag; rm rows.csv; ln -s part.lag rows.csv; cp part.lag kept.part
refused() { ! lag_run && grep -q 'rows.csv would be overwritten: it is a part of the model' err && cmp part.lag kept.part; }
check 'an output that has become a link to a part of the model' refused
rm rows.csv
for _ in 1 2; do
  "$LAGC" run m.lag x=-9.9 "x'=-20" --quiet --method dop853 >out 2>err
  check 'a run without a finite value: the place in the text' grep -q 'part.lag:1:.*note: the run ends here, where this expression has no finite value' err
done
sed 's/^scene.*/scene s { start x = 2; span 1; output x }/' kept.lag >m.lag
check 'a model that changed' gives "$(awk 'BEGIN { printf "%.9f", 0.5 + 1.5*cos(2) }')"

# A run compiles the programs of its scene alone, which scenes with the same effects share; build has all. Sines are linked.
cat >units.lag <<'EOF'
model units
coord x
param k = 1
kinetic = x'^2/2
potential = -k*cos(x)
effect drag { param c = 1; dissipation = c/2*x'^2 }
scene free { start x = 1; span 1; output x }
scene other { start x = 2; span 1; output x }
scene slow { like free; use drag }
EOF
printf '#!/bin/sh\necho "$*" >>%s/words\nexec %s "$@"\n' "$dir" "$CC" >cc_words
chmod 755 cc_words
units() { # WORDS...: number of files that this command compiles
  : >words
  CC=$dir/cc_words "$LAGC" "$@" >out 2>&1
  grep -o 'model_[0-9]*[.]c' words | sort -u | wc -l
}
is 'a run: one of two units' 1 "$(units run units.lag free --quiet --compile always)"
is 'another scene: its own' 1 "$(units run units.lag other --quiet --compile always)"
is 'the other unit' 1 "$(units run units.lag slow --quiet --compile always)"
is 'both scenes in a picture: both' 2 "$(units plot units.lag free slow --svg p.svg --compile always)"
is 'build: both' 2 "$(units build units.lag -o sim)"
check 'a scene of the other unit' ./sim slow --quiet
check 'sines are linked' grep -q -e -DLAG_LINKED_SINES words

# Evaluated or compiled: all of the above, with the simulators that are compiled; and a known run takes one that is there by now.
"$LAGC" cache --clear >out
for how in never auto always auto; do check "known, --compile $how" known_by $how; done
is 'runs that are known' 3 "$(runs)"

# The columns of a record are outputs of the program.
"$LAGC" run units.lag free --every 0.1 --quiet -o record.csv
fits() { "$LAGC" fit units.lag free --data record.csv --fit k >out 2>&1; }
check 'a fit' fits
sed -i '1s/x.*/y/' record.csv
other_columns() { ! fits && grep -q 'column y:1:1: error: unknown name `y`' out; }
check 'of other columns' other_columns

# A start of a rotation is compiled.
cat >top.lag <<'EOF'
model top
coord R: rotation
param I = 1
kinetic = I/2*(omega(R).x^2 + omega(R).y^2 + omega(R).z^2)
observe w = omega(R).x
scene s { start omega(R) = (0, 0, 1); span 1; output w }
EOF
spin() { "$LAGC" run top.lag "omega(R)=($1, 0, 0)" --quiet -o rows.csv >out 2>err; cat err; [ "$(awk -F, 'END { printf "%.3f", $2 }' rows.csv)" = "$1" ]; }
for w in 0.250 0.500 0.250; do check "a rate of rotation, $w" spin $w; done
tap_end
