#!/bin/sh
# Files that cannot be written, missing compilers and libraries, as TAP: a message on stderr with the file and the reason,
# exit status 2, and no file left, whole or in part. A device or a pipe is never replaced by a file.
cd "$(dirname "$0")/../.." || exit 2
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
model=$(pwd)/models/spring.lag
dir=$TMP/run_files.$$
mkdir -p "$dir/out" "$dir/cache" "$dir/tmp" || exit 2
trap 'rm -rf "$dir"' EXIT
XDG_CACHE_HOME=$dir/cache TMPDIR=$dir/tmp
export XDG_CACHE_HOME TMPDIR
unset LAG_HOME

# refused STATUS WORDS COMMAND...: exit status, the words in the message, nothing in $dir/out
refused() {
  want=$1 words=$2
  shift 2
  "$@" >"$dir/stdout" 2>"$dir/stderr" </dev/null
  got=$?
  cat "$dir/stderr"
  [ "$got" = "$want" ] || { echo "exit status $got, expected $want"; return 1; }
  grep -q -e "$words" "$dir/stderr" || { echo "no \`$words\` in the message"; return 1; }
  left=$(find "$dir/out" "$dir/tmp" ! -type d; find "$dir/out" "$dir/tmp" -mindepth 1 -type d)
  [ -z "$left" ] || { echo "left: $left"; return 1; }
}
# With files limited to 512 bytes, as on a full disk.
full_disk() { (ulimit -f 1; "$@"); }
is_fifo() { [ -p "$dir/fifo" ]; }

if [ -c /dev/full ]; then
  for c in emit header derive; do
    check "$c: the device is full" refused 2 'cannot write /dev/full' "$LAGC" $c "$model" -o /dev/full
  done
  check 'a full standard output' refused 2 'cannot write standard output' sh -c '"$0" derive "$1" >/dev/full' "$LAGC" "$model"
  check 'check, a full standard output' refused 2 'cannot write standard output' sh -c '"$0" check "$1" >/dev/full' "$LAGC" "$model"
  check 'methods, a full standard output' refused 2 'cannot write standard output: No space' sh -c '"$0" methods >/dev/full' "$LAGC"
  "$LAGC" cache --clear >/dev/null
  check 'version, a full standard output' refused 2 'cannot write standard output' sh -c '"$0" --version >/dev/full' "$LAGC"
fi
for c in emit header derive build; do
  check "$c: no such folder" refused 2 "out/no/file" "$LAGC" $c "$model" -o "$dir/out/no/file"
  check "$c: a file is no folder" refused 2 'stdout/file' "$LAGC" $c "$model" -o "$dir/stdout/file"
  check "$c: a folder is no file" refused 2 "cannot write $dir/out" "$LAGC" $c "$model" -o "$dir/out"
done
for c in emit header; do
  check "$c: the disk is full" refused 2 'cannot write .*out/file' full_disk "$LAGC" $c "$model" -o "$dir/out/file"
done
check 'build: the disk is full' refused 2 'cannot write' full_disk "$LAGC" build "$model" -o "$dir/out/sim"
check 'run: the disk is full' refused 2 'cannot write' full_disk "$LAGC" run "$model" --compile always
check 'run: the cache is empty after that' sh -c '! ls -A "$0" | grep -v "[.]cc$"' "$dir/cache/lagc"


# An entry of the cache that a loss of power has cut short, or that holds other bytes, is built anew.
"$LAGC" run "$model" --compile always --quiet
entry=$(ls -d "$dir"/cache/lagc/* | grep -v '[.][a-z]*$')
size=$(wc -c <"$entry")
head -c $((size*2/3)) "$entry" >"$dir/cut" && cat "$dir/cut" >"$entry"
check 'run: a simulator that is cut short' "$LAGC" run "$model" --compile always --quiet --until 1
is 'it is whole again' "$size" "$(wc -c <"$entry")"
dd if=/dev/zero of="$entry" bs=1000 seek=8 count=9 conv=notrunc 2>/dev/null
check 'run: a simulator with zeroed bytes' "$LAGC" run "$model" --compile always --quiet --until 1
# A limit of file sizes does not end a run without a word; rows that were begun do not stay.
for type in csv npy; do
  check "run: no room for rows of .$type" refused 2 "cannot write $dir/out/rows.$type: File too large" \
    full_disk "$entry" --until 100 --every 0.01 -o "$dir/out/rows.$type"
done
full_disk "$entry" --until 100 --svg "$dir/out/picture.svg" >"$dir/said" 2>&1
is 'no room for a picture: the report names none' 0 "$(grep -c 'picture in' "$dir/said")"

mkfifo "$dir/fifo"
mkdir "$dir/own"
cp "$model" "$dir/own/spring.lag"
for command in emit header build derive; do
  check "$command: the model is not overwritten" refused 2 'would be overwritten' "$LAGC" $command "$dir/own/spring.lag" -o "$dir/own/spring.lag"
done
check 'run: the model is not overwritten' refused 2 'would be overwritten' "$LAGC" run "$dir/own/spring.lag" -o "$dir/own/spring.lag"
check 'the model is as it was' cmp "$model" "$dir/own/spring.lag"
"$LAGC" run "$dir/own/spring.lag" --until 1 --save-state "$dir/own/state" --quiet
sed 's/^potential = /potential = 2*/; s/^lagrangian = /lagrangian = 2*/' "$model" >"$dir/own/spring.lag"
check 'resume: other equations' refused 2 'equations differ' "$LAGC" run "$dir/own/spring.lag" --resume "$dir/own/state" --until 2

check 'build: a pipe is not replaced' refused 2 'not an ordinary file' "$LAGC" build "$model" -o "$dir/fifo"
check 'build: it is still a pipe' is_fifo
cat "$dir/fifo" >"$dir/piped" &
"$LAGC" emit "$model" -o "$dir/fifo"
wait $!
"$LAGC" emit "$model" -o "$dir/plain"
check 'emit: a pipe is written to' cmp "$dir/plain" "$dir/piped"
check 'emit: it is still a pipe' is_fifo

echo old >"$dir/old"
ln -s old "$dir/link"
"$LAGC" emit "$model" -o "$dir/link"
check 'emit: through a symbolic link' cmp "$dir/plain" "$dir/old"
check 'emit: the link is still a link' test -L "$dir/link"
echo old >"$dir/old"
check 'emit: an old file stays when the disk is full' refused 2 'cannot write' full_disk "$LAGC" emit "$model" -o "$dir/old"
is 'emit: it is as it was' old "$(cat "$dir/old")"

if [ "$(id -u)" != 0 ]; then
  mkdir "$dir/closed"
  chmod 555 "$dir/closed"
  for c in emit header build; do
    check "$c: a folder without permission" refused 2 'Permission denied' "$LAGC" $c "$model" -o "$dir/closed/file"
  done
else
  skip 'a folder without permission' 'root may write everywhere'
fi

check 'run: no C compiler' refused 2 '/nonexistent. cannot be run' env CC=/nonexistent "$LAGC" run "$model" --compile always
check 'build: no C compiler' refused 2 '/nonexistent. cannot be run' env CC=/nonexistent "$LAGC" build "$model" -o "$dir/out/sim"
check 'build: a C compiler that fails' refused 2 'false. failed' env CC=false "$LAGC" build "$model" -o "$dir/out/sim"
check 'build: a C compiler that writes nothing' refused 2 'cannot write' env CC=true "$LAGC" build "$model" -o "$dir/out/sim"
check 'LAG_HOME is wrong' refused 2 'LAG_HOME is /nonexistent' env LAG_HOME=/nonexistent "$LAGC" build "$model" -o "$dir/out/sim"
check 'no such model' refused 2 'cannot read' "$LAGC" check "$dir/nothing.lag"
check 'the model is a folder' refused 2 'cannot read' "$LAGC" check "$dir"
check 'an unknown scene' refused 1 'unknown scene .nope' "$LAGC" emit "$model" nope -o "$dir/out/file"
check 'an unknown constant' refused 1 '-D NOPE: the model declares no such constant' "$LAGC" emit "$model" -D NOPE=3 -o "$dir/out/file"
check 'no -o for build' refused 2 'needs -o' "$LAGC" build "$model"
# ---- a file name with the ending of another kind of file ----
while read -r words; do
  want=${words##*: } words=${words%%: *}
  # shellcheck disable=SC2086 # a command and its options
  check "$words" refused 2 "$want" "$LAGC" ${words%% *} "$model" ${words#* }
done <<'END'
run -o x.json: run writes CSV, or NumPy where the name ends in .npy; --json prints the report as JSON; write -o x.csv
run -o x.h5: write -o x.csv
run --output=x.svg: --svg FILE draws
run --svg a.jpg: write --svg a.svg
run --html a.svg: write --html a.html
run --events e.json: write --events e.csv
plot -o x.html: `lagc animate` writes HTML
animate -o x.mp4: write -o x.html
cost -o x.html: write -o x.svg
lyapunov -o x.json: write -o x.csv
derive -o x.svg: derive writes text; write -o x
derive --format latex -o x.c: write -o x.tex
noether -o x.pdf: noether writes text
header -o x.c: header writes a C header
emit -o x.h: `lagc header` writes headers
build -o x.c: build writes a program
END
check 'derive writes LaTeX to .tex' "$LAGC" derive "$model" -o "$dir/eq.tex"
check 'as --format latex does' sh -c "'$LAGC' derive '$model' --format latex | cmp - '$dir/eq.tex'"
check 'noether writes JSON to .json' "$LAGC" noether "$model" -o "$dir/q.json"
check 'as --format json does' sh -c "'$LAGC' noether '$model' --format json | cmp - '$dir/q.json'"
check 'a suffix that nobody knows' "$LAGC" run "$model" --quiet -o "$dir/rows.dat"
check 'NumPy in capitals' sh -c "'$LAGC' run '$model' --quiet -o '$dir/rows.NPY' && head -c 6 '$dir/rows.NPY' | grep -q NUMPY"
tap_end
