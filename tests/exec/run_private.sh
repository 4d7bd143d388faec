#!/bin/sh
# Safety of files: outputs are made exclusively, simulators run only from folders that are the user's own, interrupted commands leave nothing,
# includes and tables are regular files, and invisible characters are shown.
cd "$(dirname "$0")/../.." || exit 2
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
model=$(pwd)/models/spring.lag
dir=$TMP/run_private.$$
mkdir -p "$dir/cache" "$dir/tmp" || exit 2
chmod 755 "$dir"
trap 'rm -rf "$dir"' EXIT
XDG_CACHE_HOME=$dir/cache TMPDIR=$dir/tmp
export XDG_CACHE_HOME TMPDIR
unset LAG_HOME LAGC_CACHE_MIB
cache=$dir/cache/lagc
here=$(pwd)
cd "$dir" || exit 2
entry() { find "$cache" -maxdepth 1 -type f ! -name '*.lock' ! -name '*.run' ! -name '*.cc' | head -n 1; }
mode() { stat -c %a "$1"; }

# ---- outputs
"$LAGC" build "$model" -o "$dir/sim" || exit 2
echo keep >victim
ln -s victim out.csv.part
./sim --until 1 --every 0.1 -o out.csv --quiet
is 'run: a link planted at an old temporary name is not followed' keep "$(cat victim)"
check 'run: the rows are there' grep -q '^t' out.csv
is 'run: a new file has the mode that umask says' 640 "$(umask 027; ./sim --until 1 -o new.csv --quiet; mode new.csv)"
chmod 604 new.csv
./sim --until 1 -o new.csv --quiet
is 'run: an existing file keeps its mode' 604 "$(mode new.csv)"
"$LAGC" emit "$model" -o new.c; chmod 600 new.c; "$LAGC" emit "$model" -o new.c
is 'emit: an existing file keeps its mode' 600 "$(mode new.c)"
is 'build: a program has the mode that umask says' 750 "$(umask 027; "$LAGC" build "$model" -o sim2; mode sim2)"
echo old >target; ln -s target link
./sim --until 1 -o link --quiet
check 'run: a link that is ours leads to the file' grep -q '^t' target
check 'run: and is still a link' test -L link
ln -s nowhere/at/all dangling
fails_with() { want=$1; shift; "$@" >log 2>&1; got=$?; cat log; [ $got = "$want" ]; }
check 'run: a link to nowhere is refused' fails_with 2 ./sim --until 1 -o dangling --quiet
echo first >stream
"$LAGC" emit "$model" -o /dev/stdout >>stream
check 'emit: /dev/stdout goes on where the stream is' sh -c 'head -n 1 stream | grep -q first && grep -q lag_scene stream'
./sim --until 1 --every 0.5 -o /dev/stdout --quiet >rows
check 'run: likewise' grep -q '^t' rows
check 'run: /dev/null' ./sim --until 1 -o /dev/null --quiet
check 'run: it is still a device' test -c /dev/null

# Two runs with one output: either's rows, whole.
./sim m=1 --until 50 --every 0.001 -o one.csv --quiet; ./sim m=2 --until 50 --every 0.001 -o two.csv --quiet
never_mixed() {
  for _ in 1 2 ${SLOW:+3 4 5}; do
    ./sim m=1 --until 50 --every 0.001 -o both.csv --quiet & first=$!
    ./sim m=2 --until 50 --every 0.001 -o both.csv --quiet; wait $first
    cmp -s both.csv one.csv || cmp -s both.csv two.csv || return 1
  done
  ! ls both.csv.part* 2>/dev/null
}
check 'two runs with one output do not mix' never_mixed

# A run that is killed leaves no file under the final name, and the next one removes its remains.
./sim --until 1e6 --every 0.01 -o killed.csv --quiet & victim=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do ls killed.csv.part-* >/dev/null 2>&1 && break; sleep 0.2; done
part=$(ls killed.csv.part-*)
{ kill -9 $victim; wait $victim; } 2>/dev/null
check 'kill -9: there is a temporary file' [ -n "$part" ]
check 'kill -9: no partial file' test ! -e killed.csv
./sim --until 1e6 --every 0.01 -o killed.csv --quiet & live=$!
for _ in 1 2 3 4 5 6 7 8 9 10; do ls killed.csv.part-$live-* >/dev/null 2>&1 && break; sleep 0.2; done
./sim --until 1 -o killed.csv --quiet
check 'the next run removes it' test ! -e "$part"
check 'but not that of a run that lives' test -e "$(ls killed.csv.part-$live-*)"
kill -TERM $live; wait $live
check 'SIGTERM: nothing is left' sh -c '! ls killed.csv.part* 2>/dev/null'

i=100
while [ $i -lt 160 ]; do : >"many.csv.part-$i-1"; i=$((i + 1)); done
check 'remains of more runs than files can be open' sh -c 'ulimit -n 40; ./sim --until 1 -o many.csv --quiet && ! ls many.csv.part* 2>/dev/null'

# ---- simulators
evil() { printf '#!/bin/sh\necho EVIL >"%s"\n' "$dir/evil" >"$1"; chmod 755 "$1"; }
clean_run() { rm -f "$dir/evil"; "$LAGC" run "$model" --compile always --quiet && [ ! -e "$dir/evil" ]; }
check 'run: a simulator is kept' sh -c '"$0" run "$1" --compile always --quiet && [ -n "$(ls "$2")" ]' "$LAGC" "$model" "$cache"
is 'the cache is for the user alone' 700 "$(mode "$cache")"
e=$(entry)
evil "$dir/planted"
rm "$e"; ln -s "$dir/planted" "$e"
check 'run: a link in the cache is not run' clean_run
rm -f "$e"; cp "$dir/planted" "$e"; chmod 775 "$e"
check 'run: what others can write is not run' clean_run
rm -f "$e"; cp "$dir/planted" "$e"; ln "$e" "$dir/hard"
check 'run: what has another name is not run' clean_run
if [ "$(id -u)" = 0 ]; then
  rm -f "$e"; cp "$dir/planted" "$e"; chown 65534 "$e"
  check "run: another user's simulator is not run" clean_run
fi
mkdir "$dir/open"; chmod 777 "$dir/open"
check 'run: a cache where others can put another folder is not used' sh -c 'XDG_CACHE_HOME="$2/open" "$0" run "$1" --compile always --quiet && ! ls "$2"/open/lagc/* 2>/dev/null' "$LAGC" "$model" "$dir"
is 'an open cache is closed' 755 "$(chmod 777 "$cache"; "$LAGC" run "$model" --compile always --quiet; mode "$cache")"
chmod 777 "$dir/tmp" "$dir/open"
check 'without a safe folder of the environment, /tmp has one' sh -c 'cd "$2" && HOME="$2/open" XDG_CACHE_HOME="$2/open" TMPDIR="$2/open" "$0" run "$1" --compile always --quiet' "$LAGC" "$model" "$dir"
chmod 700 "$dir/tmp"

# ---- interruptions while the C compiler works
cat >slow_cc <<'END'
#!/bin/sh
case "$*" in *-dM* | *--version*) exec cc "$@" ;; esac
: >"$TMPDIR/of_the_compiler" 2>/dev/null
echo $$ >"$PID_FILE"
sleep 60
exec cc "$@"
END
chmod 755 slow_cc
export PID_FILE="$dir/pid"
start() { # in the background, as a user's shell would
  rm -f "$PID_FILE"
  CC=$dir/slow_cc "$LAGC" "$@" >log 2>&1 &
  command=$!
  for _ in $(seq 100); do [ -s "$PID_FILE" ] && break; sleep 0.1; done
}
leftovers() { find "$cache" "$dir/tmp" -mindepth 1 \( -name 'lagc-build*' -o -name '*.lock' \); find "$dir" -maxdepth 1 -name 'made*'; find "$dir/tmp" -name of_the_compiler; }
for signal in TERM HUP; do # background commands of a script ignore INT
  start build "$model" -o made
  kill -$signal $command; wait $command; got=$?
  is "build, SIG$signal: the status says so" "$((128 + $(kill -l $signal 2>/dev/null | grep -x '[0-9]*' || { [ $signal = TERM ] && echo 15 || echo 1; })))" "$got"
  kill "$(cat "$PID_FILE")" 2>/dev/null
  "$LAGC" cache >log
  empty "build, SIG$signal: the next command removes what is left" "$(leftovers)"
done
"$LAGC" cache --clear >/dev/null
start run "$model" --compile always --quiet
kill -9 $command 2>/dev/null; wait $command 2>/dev/null
kill "$(cat "$PID_FILE")" 2>/dev/null
check 'run, kill -9: there are remains' [ -n "$(leftovers)" ]
is 'run, kill -9: no simulator' '' "$(entry)"
"$LAGC" cache >log
empty 'the next command removes them' "$(leftovers)"
mkdir "$cache/lagc-build-abcdef" "$cache/lagc-build-abcdeg"; : >"$cache/lagc-build-abcdeg/model.c"
"$LAGC" cache >log
empty 'and what a kill left before the lock was made' "$(leftovers)"

# ---- limit of the cache
"$LAGC" run "$model" --compile always --quiet; "$LAGC" run "$here/models/kepler.lag" --compile always --quiet
is 'cache: two simulators' 2 "$("$LAGC" cache | sed -n 's/^simulators *//p')"
check 'cache: its folder, size and limit' sh -c '"$0" cache >log && grep -q "^folder  *$1\$" log && grep -q "^size  *[1-9]" log && grep -q "^limit  *1024 MiB" log' "$LAGC" "$cache"
newest=$(ls -t "$cache" | head -n 1)
"$LAGC" run "$model" --compile always --quiet
check 'what was used last is the newest' [ "$(ls -t "$cache" | head -n 1)" != "$newest" ]
LAGC_CACHE_MIB=0 "$LAGC" methods >/dev/null
is 'cache: beyond the limit only what is needed stays' 1 "$("$LAGC" cache | sed -n 's/^simulators *//p')"
check 'cache --clear' sh -c '"$0" cache --clear | grep -q "removed 1 simulator," && [ -z "$(ls "$1")" ]' "$LAGC" "$cache"
check 'cache: another word' fails_with 2 "$LAGC" cache --nothing

# ---- includes and tables
mkfifo pipe
refuses() { timeout 20 "$LAGC" check "$1" >log 2>&1; got=$?; cat log; [ $got = 1 ] && grep -q 'not a regular file' log; }
for what in pipe /dev/zero "$dir/tmp"; do
  printf 'include "%s"\nmodel m\ncoord x\nlagrangian = x'"'"'^2/2\n' "$what" >inc.lag
  check "include $what" refuses inc.lag
  printf 'model m\ncoord x [m]\ninput u [N] = "%s"\nparam m = 1 [kg]\nkinetic = m/2*x'"'"'^2\nforce x = u\n' "$what" >tab.lag
  check "table $what" refuses tab.lag
done
unwritten() { timeout 20 "$LAGC" check pipe >log 2>&1; got=$?; cat log; [ $got = 2 ] && grep -q 'nothing writes to this pipe' log; }
slow check 'a model that is a pipe without a writer' unwritten
late() { { sleep 0.2; cat "$model"; } >pipe & "$LAGC" check pipe; }
check 'a model through a pipe, late' late

# ---- invisible characters
rlo=$(printf '\342\200\256')
esc=$(printf '\033')
clean() { ! grep -q "$rlo\|$esc\|$(printf '\302\233')\|$(printf '\177')" "$1"; }
says() { want=$1; shift; "$@" >log 2>&1; cat -v log; grep -qF "$want" log && clean log; }
body="coord x
lagrangian = x'^2/2"
printf 'model m "A %s title"\n%s\n' "$rlo" "$body" >hidden.lag
check 'a title that turns the text is refused' says 'does not show, U+202E' "$LAGC" check hidden.lag
printf 'model m # %s\n%s\n' "$rlo" "$body" >hidden.lag
check 'and a comment' says 'does not show, U+202E' "$LAGC" check hidden.lag
printf 'model m\ncoord x%s\nlagrangian = 1\n' "$rlo" >hidden.lag
check 'and a name' says 'U+202E' "$LAGC" check hidden.lag
printf 'model m "\302\2332J"\n%s\n' "$body" >hidden.lag
check 'and a control character' says 'U+009B' "$LAGC" check hidden.lag
check 'a file name in a message' says '<U+001B>[31mx<U+202E>.lag' "$LAGC" check "${esc}[31mx$rlo.lag"
check "and in a simulator's" says '<U+001B>[31mx<U+202E>' ./sim --resume "${esc}[31mx$rlo"
printf 't [s],%s [N]\n0,1\nnot %s a number\n' "$rlo" "$esc" >push.csv
printf 'model m\ncoord x [m]\ninput u [N] = "push.csv"\nparam m = 1 [kg]\nkinetic = m/2*x'"'"'^2\nforce x = u\n' >tab.lag
check 'a table in a message' says '<U+' "$LAGC" check tab.lag
check 'a line break in a word' says 'word 2 has a line break or a tab' "$LAGC" check "$(printf 'a\nlagc: fine.lag')"
check 'and in a value' says 'word 4 has a line break or a tab' "$LAGC" run tab.lag -o "$(printf 'a\tb.csv')"
check "and a simulator's" says 'word 2 has a line break or a tab' ./sim --resume "$(printf 'a\nb')"
check 'a state from a pipe, which nobody fills' says 'pipe is not a regular file' timeout 10 ./sim --resume pipe
tap_end
