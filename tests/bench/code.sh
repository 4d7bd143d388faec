#!/bin/sh
# Emitted code next to code written by hand and to SymPy's, as a table in Markdown: operations, instructions a call
# (callgrind counts them, so they do not depend on what else the machine does), times as ratios taken in turns in one run,
# and how long lagc and the C compiler take. Peers are in hand/ and sympy_peer.py; all C is compiled with the same flags.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}"
here=tests/bench
. $here/lib_rows.sh
PYTHON=
for p in python3 /usr/bin/python3; do "$p" -c 'import sympy' 2>/dev/null && PYTHON=$p && break; done
command -v valgrind >/dev/null && VALGRIND=yes || VALGRIND=

flags='-O2 -std=gnu11 -ffp-contract=fast'
echo 'int main(void) { return 0; }' >"$TMP/probe.c"
if "$CC" -march=x86-64-v3 "$TMP/probe.c" -o "$TMP/probe" 2>/dev/null && grep -q avx2 /proc/cpuinfo; then flags="$flags -march=x86-64-v3"; fi

# ---- measuring

# driver SCENE MODEL.c PEER.c... -- "names of peers" options...: builds $TMP/driver and checks that all agree
driver() {
  scene=$1 files=
  shift
  while [ "$1" != -- ]; do files="$files $1"; shift; done
  peers=$2 list=
  shift 2
  for p in $peers; do list="$list X($p)"; done
  # shellcheck disable=SC2086 # lists of words
  "$CC" $flags "$@" -I"$INC" -I$here "-DSCENE=$scene" "-DPEERS=$list" $here/driver.c $files -lm -o "$TMP/driver"
  "$TMP/driver" check >"$TMP/check" || { echo "they do not compute the same:"; cat "$TMP/check"; exit 1; }
}

# instructions NAME [CALLS]: instructions of one call, without those of its caller; - without valgrind.
instructions() {
  [ -n "$VALGRIND" ] || { echo -; return; }
  function=$1 calls=${2:-1600}
  [ "$1" != ours ] || function=accel
  for n in "$calls" $((2*calls)); do
    valgrind --tool=callgrind --toggle-collect="$function" --callgrind-out-file=/dev/null "$TMP/driver" count "$1" "$n" 2>&1 |
      sed -n 's/.*Collected : *//p'
  done | awk -v calls="$calls" '{ n[NR] = $1 }
    END { if (!(n[2] > n[1])) { print "bench code: callgrind sees no call of the function: is it inlined or stripped?" >"/dev/stderr"; exit 1 }
          printf "%.0f", (n[2] - n[1])/calls }'
}
instructions_of_all() { # "PEERS" [CALLS]: `name count` lines in $TMP/counts
  for f in ours $1; do count=$(instructions "$f" ${2:-}) || exit 1; echo "$f $count"; done >"$TMP/counts"
}
of() { awk -v n="$1" -v c="${3:-2}" '$1 == n { print $c }' "$TMP/$2"; } # NAME counts|times [COLUMN]

# Writes SymPy's C to OUT, operations and seconds to $TMP/sympy. Fails without SymPy.
sympy() { [ -n "$PYTHON" ] && "$PYTHON" $here/sympy_peer.py "$@" >"$TMP/sympy"; }

# ---- the table

over() { awk -v a="$1" -v b="$2" 'BEGIN { if (a + 0 <= 0 || b + 0 <= 0) print "-"; else printf "%.2f", a/b }'; }

echo "Compiled with \`$flags\`."
echo
table

# Instructions are counted with the C library's sine; times are measured with the default one of emitted C.
math=
if "$LAGC" help emit 2>/dev/null | grep -q -e --math; then math='--math libm'; fi

# ---- the double pendulum
# shellcheck disable=SC2086 # none or two words
"$LAGC" emit models/double_pendulum.lag swing $math -o "$TMP/double_pendulum.c"
peers='textbook best' more=
if sympy chain 2 "$TMP/double_pendulum_sympy.c" inverse; then peers="$peers sympy sympy_inverse" more=$TMP/double_pendulum_sympy.c; fi
# shellcheck disable=SC2086 # none or one
driver double_pendulum_swing "$TMP/double_pendulum.c" $here/hand/double_pendulum.c $more -- "$peers"
instructions_of_all "$peers"
ours=$(of ours counts)
for p in $peers; do
  case $p in best) limit=326 met=$(at_most "$ours" 326) ;; *) limit='' met='' ;; esac
  row "double pendulum, instructions a call" "${limit:+<= $limit}" "$p $(of "$p" counts)" "$ours" "$(over "$ours" "$(of "$p" counts)")" "$met"
done
"$LAGC" emit models/double_pendulum.lag swing -o "$TMP/double_pendulum.c"
# shellcheck disable=SC2086 # none or one
driver double_pendulum_swing "$TMP/double_pendulum.c" $here/hand/double_pendulum.c $more -- "$peers"
"$TMP/driver" time >"$TMP/times"
for p in $peers; do
  r=$(of "$p" times 3) limit='' met=''
  case $p in best) limit='<= 0.5, with the inline sincos' met=$(at_most "$r" 0.5) ;; esac
  row "double pendulum, time" "$limit" "$p $(of "$p" times) ns" "$(of ours times) ns" "$r" "$met"
done


# Target over 8 lanes, in nanoseconds per lane (lanes.c): 2.8, or eight times the speed of the hand-written code, which
# varies with the machine in the same way.
if grep -q ' avx512dq ' /proc/cpuinfo 2>/dev/null; then
  # shellcheck disable=SC2086 # a list of words
  "$CC" $flags -march=x86-64-v4 -mprefer-vector-width=512 -Wno-psabi -DLAG_LANES=8 -DSCENE=double_pendulum_swing -I"$INC" \
    $here/lanes.c "$TMP/double_pendulum.c" -lm -o "$TMP/lanes"
  lane=$(for _ in 1 2 3; do "$TMP/lanes" | sed 's/.*accelerations \([0-9.]*\).*/\1/'; done | sort -n | head -n 1)
  eighth=$(of best times | awk '{ printf "%.2f", $1/8 }')
  row "double pendulum, 8 lanes, time a lane" '<= 2.8 ns, or 1.0 of best/8' "best/8 $eighth ns" "$lane ns" "$(over "$lane" "$eighth")" \
    "$(at_most "$lane" "$(echo "$eighth" | awk '{ print ($1 > 2.8 ? $1 : 2.8) }')")"
else
  row "double pendulum, 8 lanes, time a lane" '<= 2.8 ns, or 1.0 of best/8' '' '-' '' 'not measured: no AVX-512'
fi

# ---- operations of the chain
for pair in 2:60 4:190 8:600; do
  n=${pair%:*} limit=${pair#*:}
  ours=$("$LAGC" derive models/chain.lag -DN="$n" --ops | awk '{ print $1 }')
  peer=-
  if sympy chain "$n" "$TMP/ignored.c"; then peer=$(of ops sympy); fi
  row "chain of $n, operations (SymPy: M and f; ours: accelerations)" "<= $limit" "sympy $peer" "$ours" "$(over "$ours" "$peer")" "$(at_most "$ours" "$limit")"
done

# ---- the chain's accelerations
for pair in 10:2000 20:4000; do
  n=${pair%:*} limit=${pair#*:}
  # shellcheck disable=SC2086 # none or two words
  "$LAGC" emit models/chain.lag $math -DN="$n" -o "$TMP/chain.c"
  peers='dense linear' more=
  if sympy chain "$n" "$TMP/chain_sympy.c"; then peers="$peers sympy" more=$TMP/chain_sympy.c; echo "$n $(of seconds sympy)" >>"$TMP/sympy_derives"; fi
  # shellcheck disable=SC2086 # none or one
  driver chain_swing "$TMP/chain.c" $here/hand/chain.c $more -- "$peers" "-DN=$n"
  instructions_of_all "$peers" 160
  ours=$(of ours counts)
  for p in $peers; do
    row "chain of $n, instructions a call" "<= $limit" "$p $(of "$p" counts)" "$ours" "$(over "$ours" "$(of "$p" counts)")" "$(at_most "$ours" "$limit")"
  done
  "$LAGC" emit models/chain.lag -DN="$n" -o "$TMP/chain.c"
  # shellcheck disable=SC2086 # none or one
  driver chain_swing "$TMP/chain.c" $here/hand/chain.c $more -- "$peers" "-DN=$n"
  "$TMP/driver" time >"$TMP/times"
  for p in $peers; do
    row "chain of $n, time" '' "$p $(of "$p" times) ns" "$(of ours times) ns" "$(of "$p" times 3)" ''
  done
  # shellcheck disable=SC2086 # a list of words
  [ "$n" != 20 ] || [ -z "$more" ] || sympy_compile=$(seconds 1 "$CC" $flags -I"$INC" -I$here -c "$more" -o "$TMP/ignored.o")
done

# ---- growth
for n in 50 100 1000; do
  "$LAGC" emit models/chain.lag -DN="$n" -o "$TMP/chain.c"
  driver chain_swing "$TMP/chain.c" $here/hand/chain.c -- linear "-DN=$n"
  "$TMP/driver" time >"$TMP/times"
  echo "$n $(instructions ours 32) $(of ours times)" >>"$TMP/growth"
  [ "$n" = 50 ] || row "chain of $n, time" '<= 0.9' "linear $(of linear times) ns" "$(of ours times) ns" "$(of linear times 3)" "$(at_most "$(of linear times 3)" 0.9)"
done
slope() { awk -v c="$1" '{ n[NR] = log($1); y[NR] = $c } END { if (y[1] == "-") print "-"; else printf "%.3f", (log(y[NR]) - log(y[1]))/(n[NR] - n[1]) }' "$TMP/growth"; }
row 'chain, slope of log instructions against log N, 50 to 1000' '<= 1.15' 'dense: 3' "$(slope 2)" '' "$(at_most "$(slope 2)" 1.15)"
row 'chain, slope of log time against log N, 50 to 1000' '<= 1.15' 'dense: 3' "$(slope 3)" '' "$(at_most "$(slope 3)" 1.15)"

# ---- lagc and the C compiler
for pair in 20:0.05 100:0.3 1000:5; do
  n=${pair%:*} limit=${pair#*:}
  s=$(seconds 7 "$LAGC" emit models/chain.lag -DN="$n" -o "$TMP/emitted_$n.c")
  k=$(kilobytes 1 "$LAGC" emit models/chain.lag -DN="$n" -o "$TMP/emitted_$n.c")
  peer=$(awk -v n="$n" '$1 == n { print "sympy " $2 " s" }' "$TMP/sympy_derives" 2>/dev/null || true)
  row "lagc emit, chain of $n" "<= $limit s" "$peer" "$s s" '' "$(at_most "$s" "$limit")"
  row "lagc emit, chain of $n, memory" '< 1 GB' '' "$((k/1024)) MB" '' "$(at_most "$k" 1000000)"
done
for pair in 20:0.5 1000:2; do
  n=${pair%:*} limit=${pair#*:} peer=
  # shellcheck disable=SC2086 # a list of words
  s=$(seconds 5 "$CC" $flags -I"$INC" -c "$TMP/emitted_$n.c" -o "$TMP/ignored.o")
  [ "$n" != 20 ] || peer=${sympy_compile:+sympy $sympy_compile s}
  row "C compiler, chain of $n" "<= $limit s" "$peer" "$s s" '' "$(at_most "$s" "$limit")"
done

# ---- long models: a string, bodies
long_model() { # WHAT LIMIT SCENE MODEL PEER.c "PEERS" options...: at most LIMIT of the time of the peers
  what=$1 most=$2 scene=$3 model=$4 peer=$5 peers=$6
  shift 6
  s=$("$TMP/rusage" timeout 600 "$LAGC" emit "$model" "$@" -o "$TMP/long.c" 2>&1 | awk '/^rusage/ { print $2 }')
  if [ ! -s "$TMP/long.c" ]; then
    row "$what" "<= $most" "$peers" 'not emitted in 600 s' '' 'not met'
    return
  fi
  bytes=$(wc -c <"$TMP/long.c")
  row "$what: size of the C" '< 65536 bytes' '' "$bytes" '' "$(at_most "$bytes" 65535)"
  row "$what: lagc emit" '' '' "$s s" '' ''
  if [ "$bytes" -gt 1000000 ]; then
    row "$what: time" "<= $most" "$peers" 'too long to compile' '' 'not met'
    return
  fi
  # shellcheck disable=SC2086 # a list of words
  s=$(seconds 1 "$CC" $flags -I"$INC" -c "$TMP/long.c" -o "$TMP/ignored.o")
  row "$what: C compiler" '' '' "$s s" '' ''
  sizes=$(for o in "$@"; do case $o in -D*) printf '%s ' "$o" ;; esac; done)
  # shellcheck disable=SC2086 # a list of words
  driver "$scene" "$TMP/long.c" "$peer" -- "$peers" -DSCENE_START -DWITHIN=0.3 $sizes
  "$TMP/driver" time >"$TMP/times"
  for p in $peers; do
    r=$(of "$p" times 3)
    row "$what: time" "<= $most" "$p $(of "$p" times) ns" "$(of ours times) ns" "$r" "$(at_most "$r" "$most")"
  done
}
long_model 'string of 10,000 masses' 1.3 string_hard models/string.lag $here/hand/string.c 'loop twice' hard -DN=10000
for n in 6 24 256; do
  long_model "$n gravitating bodies" 0.8 bodies_drift $here/models/bodies.lag $here/hand/bodies.c 'pairs ordered' -DN=$n
done

# ---- in space
"$LAGC" emit $here/models/spherical_chain.lag -o "$TMP/spherical.c"
if sympy spherical 5 "$TMP/spherical_sympy.c"; then
  driver spherical_chain_swing "$TMP/spherical.c" "$TMP/spherical_sympy.c" -- sympy -DSCENE_START -DWITHIN=0.5
  instructions_of_all sympy 160
  "$TMP/driver" time >"$TMP/times"
  r=$(of sympy times 3)
  row 'spherical chain of 5, time' '<= 0.5' "sympy $(of sympy times) ns" "$(of ours times) ns" "$r" "$(at_most "$r" 0.5)"
  row 'spherical chain of 5, instructions a call' '' "sympy $(of sympy counts)" "$(of ours counts)" "$(over "$(of ours counts)" "$(of sympy counts)")" ''
else
  row 'spherical chain of 5, time' '<= 0.5' 'SymPy is not installed' '-' '' 'not measured'
fi
"$LAGC" emit $here/models/gyroscope.lag -o "$TMP/gyroscope.c"
peers=by_hand more=
if sympy gyroscope 3 "$TMP/gyroscope_sympy.c"; then peers="by_hand sympy" more=$TMP/gyroscope_sympy.c; fi
# shellcheck disable=SC2086 # none or one
driver gyroscope_nutation "$TMP/gyroscope.c" $here/hand/gyroscope.c $more -- "$peers" -DSCENE_START -DWITHIN=0.5
instructions_of_all "$peers"
"$TMP/driver" time >"$TMP/times"
for p in $peers; do
  r=$(of "$p" times 3) limit='' met=''
  [ "$p" != sympy ] || limit='<= 1' met=$(at_most "$r" 1)
  row 'gyroscope, time' "$limit" "$p $(of "$p" times) ns" "$(of ours times) ns" "$r" "$met"
  row 'gyroscope, instructions a call' '' "$p $(of "$p" counts)" "$(of ours counts)" "$(over "$(of ours counts)" "$(of "$p" counts)")" ''
done
