# shellcheck shell=sh
# A compiler built with -O0 under sanitizers, and simulators under sanitizers: no command draws a report.
. tests/tap.sh
[ -n "$LAGC_SAN" ] || skip_all "no compiler under sanitizers"
case $LAGC_SAN in /*) san=$LAGC_SAN ;; *) san=$(pwd)/$LAGC_SAN ;; esac
if [ ! -d "$TMP/tree" ]; then
  mkdir -p "$TMP/tree"
  ln -s "${san%/*}" "$TMP/tree/lib"
  ln -s "$(pwd)/runtime/include" "$TMP/tree/include"
  # The last -O counts: simulators are compiled fast, and no load is left out of them.
  printf '#!/bin/sh\nexec %s -g %s "$@" -O0\n' "$CC" "$SAN_FLAGS" >"$TMP/cc"
  chmod +x "$TMP/cc"
fi

# clean WORD...: lagc with these arguments draws no report of a sanitizer, no crash, no leak. A refusal is allowed.
clean() {
  LAG_HOME=$TMP/tree CC=$TMP/cc ASAN_OPTIONS=exitcode=99 UBSAN_OPTIONS=exitcode=99 timeout 300 "$san" "$@" >"$said.out" 2>"$said.err" </dev/null
  code=$?
  case $code in 0 | 1 | 2 | 3) return ;; esac
  echo "lagc $*: status $code"
  head -n 20 "$said.err"
}

# End of a short run of the first scene of emitted C: a part of its span.
a_part_of_the_span() {
  awk -v part="$2" '
    function number(s) { gsub(/LAG_NUMBER\(|\)|,/, "", s); return s + 0 }
    /^  \.t0 = .*\.t1 = / { for (i = 1; i < NF; i++) if ($i == ".t0") t0 = number($(i + 2)); else if ($i == ".t1") t1 = number($(i + 2)); exit }
    END { printf "%.6g", t0 + (t1 > t0 ? (t1 - t0)/part : 1) }' "$1"
}

# sometimes COMMAND...: one of three in turns where `turn` is a number, which says where to begin; all where it is not set.
sometimes() {
  [ -n "${turn:-}" ] || { "$@"; return; }
  turn=$((turn + 1))
  [ $((turn % 3)) != 0 ] || "$@"
}

# every_command MODEL: prints faults
every_command() {
  m=$1
  said=$TMP/$(basename "$m" .lag)
  clean check "$m" --allow-numeric
  for format in text latex c; do sometimes clean derive "$m" --format "$format"; done
  clean derive "$m" --hamiltonian
  clean derive "$m" --ops
  clean noether "$m" --degree 2 --involution
  clean action "$m"
  for format in latex json; do sometimes clean noether "$m" --format "$format"; done
  clean check "$m" --dump=ast,eqns,passes,prog
  clean emit "$m" --with linear --math libm --fix all -o "$said.c"
  for method in taylor radau variational rk45; do sometimes clean emit "$m" --method "$method" -o "$said.c"; done
  clean header "$m" -o "$said.h"
  clean emit "$m" -o "$said.c"
  end=$(a_part_of_the_span "$said.c" 50)
  sooner=$(a_part_of_the_span "$said.c" 500)
  clean build "$m" -o "$said.sim"
  clean run "$m" --until "$end" -o "$said.csv" --json
  sometimes clean plot "$m" --until "$end" -o "$said.svg"
  sometimes clean animate "$m" --until "$end" -o "$said.html"
  sometimes clean modes "$m"
  sometimes clean lyapunov "$m" --until "$sooner"
  sometimes clean effects "$m" --until "$sooner"
  sometimes clean cost "$m" --until "$sooner" --seconds 0.5 --methods rk4,rk45,dop853 -o "$said.cost.svg"
  clean complete run "$m" ''
}
