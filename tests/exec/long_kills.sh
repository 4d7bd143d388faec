#!/bin/sh
# Files under stress: two users on one machine, two commands with one output, a full disk, 50 kills at random moments. No mixed result, no foreign
# code; nothing left after SIGINT and SIGTERM; after SIGKILL no partial file under its final name, and the next command removes the remains.
. tests/tap.sh
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
here=$(pwd)
dir=$(mktemp -d /tmp/long_kills.XXXXXX) || exit 2 # a folder that another user can enter, too
chmod 755 "$dir"
mkdir "$dir/cache" "$dir/tmp"
XDG_CACHE_HOME=$dir/cache TMPDIR=$dir/tmp
CCACHE_DISABLE=1 # ccache would keep files of its own in that cache
export XDG_CACHE_HOME TMPDIR CCACHE_DISABLE
mounted=
trap '[ -z "$mounted" ] || umount "$mounted"; rm -rf "$dir"' EXIT
cp models/spring.lag models/kepler.lag "$dir"
cd "$dir" || exit 2
"$LAGC" build spring.lag -o sim || exit 2

# ---- two users: neither runs, spoils or is stopped by files of the other in shared folders
shared=$dir/shared
if [ "$(id -u)" = 0 ] && command -v setpriv >/dev/null && setpriv --reuid 65534 --regid 65534 --clear-groups test -x "$LAGC"; then
  mkdir "$shared"
  chmod 1777 "$shared"
  other() { setpriv --reuid 65534 --regid 65534 --clear-groups env HOME=/nonexistent "$@"; }
  # The other user was there first: with the cache folder that this user would take, a simulator in it, and links at names of outputs.
  other mkdir "$shared/lagc" "$shared/lagc-0"
  "$LAGC" run spring.lag --compile always --quiet
  for e in cache/lagc/*; do
    for d in lagc lagc-0; do
      printf '#!/bin/sh\necho EVIL >"%s/evil"\n' "$shared" | other tee "$shared/$d/${e##*/}" >/dev/null
      other chmod 777 "$shared/$d/${e##*/}"
    done
  done
  echo keep >precious
  other ln -s "$dir/precious" "$shared/out.csv"
  other ln -s "$dir/precious" "$shared/out.csv.part"
  mine() { XDG_CACHE_HOME=$shared TMPDIR=$shared "$LAGC" run spring.lag --compile always --until 1 --json >log 2>&1 && grep -q '"status": "ok"' log && [ ! -e "$shared/evil" ]; }
  check "a cache that another user has made is not used" mine
  check "once more" mine
  ./sim --until 1 -o "$shared/out.csv" --quiet 2>log
  is "another user's link at an output is not followed" keep "$(cat precious)"
  check "that is said" grep -q 'cannot write' log
  ./sim --until 1 -o "$shared/other.csv" --quiet
  other "$LAGC" derive spring.lag -o "$shared/other.csv" 2>/dev/null
  check "another user's output stays" grep -q '^t' "$shared/other.csv"
  both() {
    XDG_CACHE_HOME=$shared TMPDIR=$shared "$LAGC" run spring.lag --compile always --until 5 --quiet & a=$!
    other env XDG_CACHE_HOME="$shared" TMPDIR="$shared" "$LAGC" run spring.lag --compile always --until 5 --quiet || return 1
    wait $a && [ ! -e "$shared/evil" ]
  }
  check "two users at once, one TMPDIR" both
else
  skip "two users on one machine" "needs root, setpriv, and a compiler that others can run"
fi

# ---- two commands with one output, ten times
./sim m=1 --until 50 --every 0.001 -o one.csv --quiet; ./sim m=2 --until 50 --every 0.001 -o two.csv --quiet
never_mixed() {
  for _ in 1 2 3 4 5 6 7 8 9 10; do
    ./sim m=1 --until 50 --every 0.001 -o both.csv --quiet & first=$!
    ./sim m=2 --until 50 --every 0.001 -o both.csv --quiet; wait $first
    cmp -s both.csv one.csv || cmp -s both.csv two.csv || return 1
    "$LAGC" build spring.lag -o built & first=$!
    "$LAGC" build kepler.lag -o built; wait $first
    ./built --help >/dev/null || return 1
  done
  ! ls both.csv.part* built.part* 2>/dev/null
}
check "two commands with one output do not mix" never_mixed

# ---- a full disk: old files stay as they are, nothing new is left, and the message gives the reason
if [ "$(id -u)" = 0 ] && mkdir full && mount -t tmpfs -o size=512k tmpfs full 2>/dev/null; then
  mounted=$dir/full
  echo old >full/out.csv
  refused() { "$@" >log 2>&1; got=$?; cat log; [ $got = 2 ] && grep -q 'No space left' log; }
  check "rows on a full disk" refused ./sim --until 100 --every 0.001 -o full/out.csv --quiet
  is "the old rows stay" old "$(cat full/out.csv)"
  check "a simulator on a full disk" refused "$LAGC" build spring.lag -o full/sim
  mkdir full/cache
  check "a cache on a full disk" sh -c 'XDG_CACHE_HOME=$1/full/cache "$0" run spring.lag --compile always --quiet >log 2>&1; [ $? = 2 ] && grep -qi "no space left\|failed" log' "$LAGC" "$dir"
  is "nothing is left" "cache
out.csv" "$(ls full)"
  empty "nor in the cache" "$(find full/cache -type f ! -name '*.cc')"
  check "and with room again it works" sh -c 'umount "$1/full" && mkdir -p "$1/full/cache" && XDG_CACHE_HOME=$1/full/cache "$0" run spring.lag --compile always --quiet' "$LAGC" "$dir"
  mounted=
else
  full_disk() { (trap '' XFSZ; ulimit -f 1; "$@"); }
  echo old >out.csv
  check "rows, files limited to 512 bytes" sh -c '! "$@"' x full_disk ./sim --until 100 --every 0.001 -o out.csv --quiet
  is "the old rows stay" old "$(cat out.csv)"
  skip "a full disk" "no tmpfs can be mounted here: files were limited in size instead"
fi

# ---- 50 kills at random moments of builds and runs, a third of them SIGKILL, SIGTERM and SIGINT each
rm -rf cache/lagc tmp/*
random() { awk -v seed="$1" 'BEGIN { srand(seed); printf "%.3f", 0.01 + rand() * rand() * 2 }'; }
after_kill() { # SIGNAL: checks after the command has ended
  [ ! -e out.csv ] || tail -n 1 out.csv | grep -q '^[0-9.e+-]*,' || { echo 'rows in part'; return 1; }
  [ ! -e made ] || ./made --help >/dev/null || { echo 'a simulator in part'; return 1; }
  for f in cache/lagc/????????????????????????????????; do
    [ -e "$f" ] || continue
    if readelf -lW "$f" | grep -q INTERP; then "$f" --help; else nm -D "$f"; fi >/dev/null || { echo 'a simulator or library in part, in the cache'; return 1; }
  done
  [ "$1" = KILL ] || ! remains || { echo "left after SIG$1"; return 1; }
}
remains() { ls -d cache/lagc/lagc-build-* tmp/* out.csv.part-* made.part-* state.part-* 2>/dev/null; }
# A group of its own for each command, as an interactive shell makes it: SIGINT is not ignored in it.
launch='import os, signal, sys
signal.signal(signal.SIGINT, signal.SIG_DFL)
os.setpgid(0, 0)
open("started", "w").close()
os.execvp(sys.argv[1], sys.argv[1:])'
one_kill() { # NUMBER
  case $(($1 % 3)) in 0) signal=KILL ;; 1) signal=TERM ;; 2) signal=INT ;; esac
  case $(($1 % 2)) in
    0) set -- "$1" build spring.lag -o made ;;
    1) set -- "$1" run spring.lag --until "$1"e7 --every 1 -o out.csv --save-state state --quiet ;;
  esac
  number=$1
  shift
  rm -f out.csv made state started
  [ $((number % 4)) != 0 ] || "$LAGC" cache --clear >/dev/null
  python3 -c "$launch" "$LAGC" "$@" >log 2>&1 &
  command=$!
  for _ in $(seq 300); do [ -e started ] && break; sleep 0.1; done
  sleep "$(random "$number")"
  kill -$signal $command 2>/dev/null
  (sleep 120; kill -9 $command 2>/dev/null) & watch=$!
  wait $command
  kill $watch 2>/dev/null || { echo "it does not end: $signal, number $number"; return 1; }
  after_kill $signal || { cat log; echo "command: $*, number $number"; return 1; }
}
fifty() {
  for number in $(seq "${KILLS:-50}"); do one_kill "$number" || return 1; done
}
if command -v python3 >/dev/null; then
  check "${KILLS:-50} kills at random moments" fifty
  # Waits for C compilers that a kill has orphaned: files that they write after a folder is emptied are removed by the command after the next.
  for _ in $(seq 60); do ps -eo args | grep -v grep | grep -q "lagc-build-" || break; sleep 1; done
  "$LAGC" run spring.lag --compile always --until 1 -o out.csv --save-state state --quiet
  "$LAGC" build spring.lag -o made
  empty "the next commands remove what is left" "$(remains)"
  check "and do their work" sh -c './made --until 1 --quiet && grep -q "^t" out.csv && grep -q "^sum" state'
else
  skip "50 kills" "needs python3, for SIGINT in the background"
fi
tap_end
