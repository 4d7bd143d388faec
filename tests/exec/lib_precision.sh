# shellcheck shell=sh
# For tests of --precision: compilers and options for models and tests. Tests skip where a precision is not available; `make test` builds none,
# so that a library there may be older than its sources.
has_precision() { case " ${PRECISIONS-long quad} " in *" $1 "*) [ -f "$BUILD/liblag_$1.a" ] ;; *) false ;; esac; }

# compile_precise long|quad PROGRAM FILE.c... : C as lagc emits it, and C of tests that was through `precise`.
compile_precise() {
  precise_kind=$1
  precise_out=$2
  shift 2
  case $precise_kind in
    long) set -- "$@" -std=c11 '-DLAG_REAL=long double' '-DLAG_FN(x)=x##l' '-DLAG_C(x)=x##L' '-DLAG_NUMBER(x)=x##L' ;;
    quad) set -- "$@" -std=gnu11 -include quadmath.h -DLAG_REAL=__float128 '-DLAG_FN(x)=x##q' '-DLAG_C(x)=x##Q' '-DLAG_NUMBER(x)=x##Q' ;;
  esac
  [ "$precise_kind" = quad ] && precise_lib=-lquadmath || precise_lib=
  "$CC" -w -O1 -ffp-contract=off -DLAG_TAYLOR_ORDER=64 "$@" -I"$BUILD/lag-$precise_kind" "$BUILD/liblag_$precise_kind.a" $precise_lib -lm -o "$precise_out"
}

# precise long|quad FILE.c: the test with its doubles replaced by long doubles or __float128.
precise() { awk -v kind="$1" -v digits=36 -f runtime/precision.awk "$2"; }
