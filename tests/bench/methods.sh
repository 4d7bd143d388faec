#!/bin/sh
# Time against error of dop853 and taylor, next to integrators of others with right-hand sides written by hand, in one run: GSL's rk8pd,
# dop853 inlined by hand, Boost.odeint's rkf78, SUNDIALS' CVODE (Adams) and ARKODE (order 8), SciPy's DOP853, and, for the chains, the code that
# SymPy writes in the dop853 by hand; those that are installed (Debian: libgsl-dev, libboost-dev, libsundials-dev, python3-scipy,
# python3-sympy). In brackets: the processor's time over that of rk8pd, and over that of dop853 inlined by hand.
set -eu
: "${LAGC:=build/lagc}" "${CC:=cc}" "${CXX:=c++}" "${BUILD:=build}" "${INC:=runtime/include}" "${TMP:=$(mktemp -d)}"

here=tests/bench
"$LAGC" emit models/double_pendulum.lag swing --fix all --method taylor -o "$TMP/double_pendulum.c"
"$LAGC" emit $here/models/henon_heiles.lag --fix all --method taylor -o "$TMP/henon_heiles.c"
"$LAGC" emit $here/models/kepler.lag hundred --fix all --method taylor -o "$TMP/kepler.c"
"$LAGC" emit $here/models/kepler.lag narrow --fix all --method taylor -o "$TMP/narrow.c"
"$LAGC" emit $here/models/outer_planets.lag --fix all --method taylor -o "$TMP/outer_planets.c"
"$LAGC" emit $here/models/oscillators.lag --fix all --method taylor -o "$TMP/oscillators.c"
sed -i 's/\([^.]\)\<kepler\>/\1kepler_model_2/g' "$TMP/narrow.c" # two scenes of a model in one program; lag_model has a member .kepler
for n in 10 20; do
  "$LAGC" emit models/chain.lag swing -DN=$n --method taylor -o "$TMP/chain_$n.c"
  sed -i "s/\\<chain\\>/chain_model_$n/g; s/\\<chain_/chain_${n}_/g" "$TMP/chain_$n.c"
done

# Peers are available if they compile.
has() { # COMPILER WORDS...
  compiler=$1
  shift
  # shellcheck disable=SC2086 # a list of words
  $compiler -O2 -I"$INC" -Iruntime "$@" >/dev/null 2>&1
}
peers='' libs=''
compile() { has "$CC" -std=gnu11 -c "$here/$1.c" -o "$TMP/$1.o"; }
if compile peer_gsl; then peers="$peers -DBENCH_GSL $TMP/peer_gsl.o" libs="$libs -lgsl -lgslcblas"; else echo "there is no GSL"; fi
if compile peer_sundials; then
  peers="$peers -DBENCH_SUNDIALS $TMP/peer_sundials.o" libs="$libs -lsundials_cvode -lsundials_arkode -lsundials_nvecserial"
else
  echo "there is no SUNDIALS"
fi
if has "${CXX:-c++}" -c $here/peer_odeint.cc -o "$TMP/peer_odeint.o"; then
  peers="$peers -DBENCH_ODEINT $TMP/peer_odeint.o" libs="$libs -lstdc++"
else
  echo "there is no Boost.odeint"
fi
for n in 10 20; do
  "$CC" -O2 -std=gnu11 -DN=$n -Ddense=dense_$n -Dlinear=linear_$n -c $here/hand/chain.c -o "$TMP/by_hand_$n.o"
done
sympy=
for p in python3 /usr/bin/python3; do
  for n in 10 20; do
    "$p" $here/sympy_peer.py chain $n "$TMP/sympy_$n.txt" >/dev/null 2>&1 && # not *.c: those are the models
      "$CC" -O2 -std=gnu11 -w -I$here -Dsympy=sympy_$n -x c -c "$TMP/sympy_$n.txt" -o "$TMP/sympy_$n.o" || continue 2
  done
  sympy=-DBENCH_SYMPY peers="$peers -DBENCH_SYMPY $TMP/sympy_10.o $TMP/sympy_20.o"
  break
done
[ -n "$sympy" ] || echo "there is no SymPy"
# shellcheck disable=SC2086 # none or one
"$CC" -O3 -std=gnu11 -w -I"$INC" -Iruntime $sympy -c $here/peer_inlined.c -o "$TMP/peer_inlined.o"

run() { # WHICH FLAGS...
  which=$1
  shift
  # shellcheck disable=SC2086 # lists of words
  "$CC" -O2 -std=gnu11 -ffp-contract=off -fno-tree-slp-vectorize "$@" $peers -I"$INC" "$TMP"/*.c $here/methods.c "$TMP"/peer_inlined.o "$TMP"/by_hand_*.o "$BUILD/liblag.a" $libs -lm \
    -o "$TMP/methods" 2>"$TMP/err" || {
    echo "not with $*: $(head -n 1 "$TMP/err")"
    return
  }
  echo "emitted C compiled with -O2 $*"
  "$TMP/methods" $which || echo "cannot run here"
}
run all
for p in python3 /usr/bin/python3; do
  "$p" -c 'import scipy' 2>/dev/null && "$p" $here/peer_scipy.py && break
done || echo "there is no SciPy"
run own -march=x86-64-v3
