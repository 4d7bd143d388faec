#!/bin/sh
# Other machines: compiler and runtime built for aarch64 (long double is quad there), run by qemu, and with musl as C library.
# `make test-long`: one of the two, by day. Emitted C is the text of tests/golden/emitted.txt; simulators give the digits of closed forms.
. tests/tap.sh
one_day_in 3 2
: "${MAKE:=make}" "${BUILD:=build}"

MODELS=${MODELS:-pendulum double_pendulum kepler rolling_cylinder bouncing_ball}

# built NAME CC AR: the whole of `make`, in $BUILD/port-NAME. FLEX and BISON run on this machine.
built() {
  env -u CC -u CFLAGS -u PRECISIONS "$MAKE" -s -j2 CC="$2" AR="$3" CFLAGS=-O0 BUILD="$BUILD/port-$1" all "$BUILD/port-$1/liblag_long.a"
}

# texts NAME RUNNER...: the compiler's texts have the checksums of emitted.txt.
texts() {
  tree=$BUILD/port-$1
  shift
  for m in $MODELS; do
    grep " models/$m.lag emit$\| models/$m.lag emit --method taylor$\| models/$m.lag derive$" tests/golden/emitted.txt >"$TMP/want"
    while read -r _ sum model words; do
      # shellcheck disable=SC2086 # words of a command, words of a runner
      got=$("$@" "$tree/lagc" $words "$model" 2>&1 | cksum | cut -d ' ' -f 1)
      [ "$got" = "$sum" ] || echo "$model $words"
    done <"$TMP/want"
  done
}

# cos 10, by mpmath with 50 digits
cos10=-0.83907152907645245225886394782406483
cat >"$TMP/osc.lag" <<'END_OF_MODEL'
model osc
coord x
param k = 0.1
lagrangian = x'^2/2 - 10*k*x^2/2
scene go { start x = 1; span 10; output x, x' every 5 }
END_OF_MODEL

# digits NAME CC PRECISION DIGITS TOL RUNNER...: a simulator that the port builds with its CC gives cos 10 to so many digits.
digits() {
  tree=$BUILD/port-$1 cc=$2 precision=$3 want=$(printf %s "$cos10" | cut -c "1-$(($4 + 3))") asked=$5
  shift 5
  mkdir -p "$TMP/home" && ln -sfn "$(pwd)/$tree" "$TMP/home/lib" && ln -sfn "$(pwd)/runtime/include" "$TMP/home/include"
  CC=$cc LAG_HOME=$TMP/home "$@" "$tree/lagc" build "$TMP/osc.lag" --method taylor --precision "$precision" -o "$TMP/osc" || return 1
  got=$("$@" "$TMP/osc" --tol "$asked" -o - --quiet | tail -n 1 | cut -d , -f 2)
  echo "got $got, expected $want..."
  case $got in "$want"*) ;; *) return 1 ;; esac
}

# port NAME CC AR DIGITS TOL RUNNER...: digits and tolerance of long doubles
port() {
  name=$1 cc=$2 ar=$3 most=$4 tol=$5
  shift 5
  check "$name: it builds" built "$name" "$cc" "$ar"
  [ -x "$BUILD/port-$name/lagc" ] || return
  empty "$name: emitted texts are the same" "$(texts "$name" "$@")"
  check "$name: a run with doubles" digits "$name" "$cc" double 14 1e-15 "$@"
  check "$name: a run with long doubles" digits "$name" "$cc" long "$most" "$tol" "$@"
}

# installed NAME CC AR: with folders of one's own choice, lagc finds the runtime there, and so does pkg-config.
installed() {
  usr=$TMP/usr
  set -- "$@" "$usr/lib/port/pkgconfig/liblag.pc"
  env -u CC -u CFLAGS "$MAKE" -s CC="$2" AR="$3" CFLAGS=-O0 BUILD="$BUILD/port-$1" PRECISIONS=long PREFIX="$usr" LIBDIR="$usr/lib/port" \
    INCLUDEDIR="$usr/include/lag" install &&
    [ -f "$usr/lib/port/liblag.a" ] && [ -f "$usr/include/lag/lag.h" ] && [ ! -e "$usr/lib/liblag.a" ] &&
    grep -x 'libdir=${prefix}/lib/port' "$4" && grep -x 'includedir=${prefix}/include/lag' "$4" &&
    (cd "$TMP" && unset LAG_HOME && CC=$2 "$usr/bin/lagc" run osc.lag)
}

if ! one_of 4; then :; elif command -v aarch64-linux-gnu-gcc >/dev/null && command -v qemu-aarch64 >/dev/null; then
  export QEMU_LD_PREFIX=/usr/aarch64-linux-gnu
  port aarch64 aarch64-linux-gnu-gcc aarch64-linux-gnu-ar 31 1e-32 qemu-aarch64
else
  skip aarch64 "apt-get install gcc-aarch64-linux-gnu libc6-dev-arm64-cross qemu-user"
fi
if ! one_of 4; then :; elif command -v musl-gcc >/dev/null; then
  port musl musl-gcc ar 17 1e-18 env
  check "musl: installed in other folders" installed musl musl-gcc ar
else
  skip musl "apt-get install musl-tools"
fi
tap_end
