#!/bin/sh
# make install: installed files, a user's program through pkg-config, and lagc outside the source tree.
# make uninstall: nothing is left.
. tests/tap.sh
[ -z "${COVERAGE:-}" ] || skip_all "make install would build without gcov"
unset LAGC_OPTIMISE # as users build

prefix=$TMP/usr
: "${PRECISIONS=long quad}"
# PRECISIONS: none in `make test`, as it builds none.
install_it() { "$MAKE" BUILD="$BUILD" PRECISIONS="$PRECISIONS" install PREFIX="$prefix"; }
check "make install" install_it

more_files=
[ -z "$GSL" ] || more_files='lib/liblag_gsl.a lib/pkgconfig/liblag_gsl.pc'
for p in png hdf5 mpi; do
  [ ! -e "$BUILD/liblag_$p.a" ] || more_files="$more_files lib/liblag_$p.a lib/liblag_$p.libs"
done
for p in $PRECISIONS; do
  more_files="$more_files lib/liblag_$p.a"
  for h in lag lag_band lag_kkt lag_lanes lag_libraries lag_math lag_method lag_model lag_sincos lag_support lag_tree; do more_files="$more_files lib/lag-$p/$h.h"; done
done
so=liblag.so.$(sed -n 's/^.define LAG_ABI //p' runtime/include/lag_model.h)
[ ! -f "$BUILD/lag.wasm" ] || more_files="$more_files lib/lag.wasm"
[ ! -f "$BUILD/lagc.wasm.gz" ] || more_files="$more_files lib/lagc.wasm.gz"
case $("$CC" -dumpmachine) in *linux* | *bsd*) more_files="$more_files lib/liblag.so lib/$so" ;; *) so= ;; esac
models=$(cd models && ls -d -- *.lag *.csv lib/*.lag lib/*.csv lib/*.json 2>/dev/null)
want=$(for f in bin/lagc include/lag.h include/lag_band.h include/lag_kkt.h include/lag_lanes.h include/lag_libraries.h include/lag_math.h include/lag_method.h include/lag_model.h include/lag_sincos.h include/lag_support.h include/lag_tree.h lib/lag-run lib/liblag.a lib/pkgconfig/liblag.pc $more_files \
  share/doc/lagc/LICENSE share/doc/lagc/README.md share/man/man1/lagc.1 share/bash-completion/completions/lagc \
  lib/cmake/lagc/lagcConfig.cmake lib/cmake/lagc/lagcConfigVersion.cmake \
  share/zsh/site-functions/_lagc share/fish/vendor_completions.d/lagc.fish share/lagc/lag.tmLanguage.json share/lagc/lagc_mex.c share/lagc/python/lagc.py; do
  echo "$f"
done
for m in $models; do echo "share/lagc/models/$m"; done)
files() { (cd "$1" && find . ! -type d | sed 's|^\./||' | LC_ALL=C sort); }
is "what is installed" "$(printf '%s\n' "$want" | LC_ALL=C sort)" "$(files "$prefix")"

staged() {
  "$MAKE" BUILD="$BUILD" PRECISIONS="$PRECISIONS" install PREFIX=/opt/lagc DESTDIR="$TMP/stage" &&
    [ "$(files "$TMP/stage/opt/lagc")" = "$(files "$prefix")" ] &&
    grep -x 'prefix=/opt/lagc' "$TMP/stage/opt/lagc/lib/pkgconfig/liblag.pc"
}
check "DESTDIR is where, PREFIX is what the files say" staged

# ---- a program of a user's own ----
away=$TMP/away
mkdir -p "$away"
cat >"$away/main.c" <<'END'
#include <lag.h>
#include <stdio.h>
#include <stdlib.h>

/* x'' = -x from x = 1: x(pi) = -1 */
static const lag_var q_names[] = {{"x", "m", 1, 0, 0, 0}};
static int accel(const void *self, double t, const double *q, const double *v, const double *z, const double *p,
                 const double *u, double *a, double *zd, double *w) {
  (void)self, (void)t, (void)v, (void)z, (void)p, (void)u, (void)zd, (void)w;
  a[0] = -q[0];
  return LAG_OK;
}
static const lag_model oscillator = {
    .abi = LAG_ABI, .real_size = sizeof(double), .name = "oscillator", .doc = "", .effects = "", .nq = 1, .q = q_names, .accel = accel};

int main(void) {
  printf("%s %s %s\n", oscillator.name, LAG_VERSION, lag_methods[0]->name);
  return 0;
}
END
with_pkg_config() {
  PKG_CONFIG_PATH=$prefix/lib/pkgconfig
  export PKG_CONFIG_PATH
  # shellcheck disable=SC2046 # flags
  "$CC" -std=c11 -Wall -Wextra -o "$away/main" "$away/main.c" ${link:-} $(pkg-config --cflags --libs "$@") && LD_LIBRARY_PATH=$prefix/lib "$away/main"
}
needs() { readelf -d "$1" | grep -q "NEEDED.*liblag"; }
version=$(sed -n 's/^.define LAG_VERSION "\(.*\)"/\1/p' runtime/include/lag.h)
is "lagc has the version of liblag" "lagc $version" "$("$prefix/bin/lagc" version)"
is "and the newest release of CHANGELOG.md" "$version" "$(sed -n 's/^## \([0-9][0-9.]*\),.*/\1/p' CHANGELOG.md | head -n 1)"
if command -v pkg-config >/dev/null; then
  check "a program, through pkg-config" with_pkg_config liblag
  is "it runs" "oscillator $version rk45" "$(LD_LIBRARY_PATH=$prefix/lib "$away/main" 2>&1)"
  mkdir -p "$away/a b" && sed '1s/.*/prefix=a b/; /^libdir/s/=.*/=${prefix}\/lib/' "$prefix/lib/pkgconfig/liblag.pc" >"$away/a b/liblag.pc"
  is "a folder with a space" '-La\ b/lib' "$(PKG_CONFIG_PATH="$away/a b" pkg-config --libs-only-L liblag | sed 's/ *$//')"
  is "the version of liblag.pc" "$version" "$(PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config --modversion liblag)"
  [ -z "$GSL" ] || check "and with the gsl-* methods" with_pkg_config liblag_gsl
  if [ -n "$so" ]; then
    check "it is linked with the shared library" needs "$away/main"
    statically() { link=-static && with_pkg_config --static liblag && ! needs "$away/main" && [ "$("$away/main")" = "oscillator $version rk45" ]; }
    check "--static: it needs no library" statically
    is "the shared library has the soname of the ABI" "$so" "$(readelf -d "$prefix/lib/liblag.so" | sed -n 's/.*SONAME.*\[\(.*\)\]/\1/p')"
    empty "only lag_* is visible in it" "$(nm -D --defined-only "$prefix/lib/$so" | awk '$3 !~ /^lag_/')"
    other() { nm -D --defined-only "$prefix/lib/$so" | awk '{ print $3 }' | sort >"$TMP/visible" && sed -n '/^typedef/d; /lag_library\|lag_png_write\|lag_hdf5_write/d; s/^[a-z].* \**\(lag_[a-z_0-9]*\)(.*/\1/p' runtime/include/lag.h runtime/include/lag_method.h | sort -u | comm -23 - "$TMP/visible"; }
    empty "all functions of lag.h are visible in it, but for those of optional libraries" "$(other)"
  fi
else
  skip "a program, through pkg-config" "no pkg-config"
fi

# ---- a project with CMake: the pendulum as a header, its energy at rest -m g l, and as C for the runtime; made anew when the model changes ----
if command -v cmake >/dev/null; then
  cat >"$away/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.18)
project(swing C)
find_package(lagc 0.1 REQUIRED)
lagc_add_model(pend pendulum.lag SCENE small)
lagc_add_model(swinging pendulum.lag RUNTIME)
add_executable(game game.c)
target_link_libraries(game PRIVATE pend swinging)
add_executable(with_shared "${MAIN}")
target_link_libraries(with_shared PRIVATE lagc::lag_shared)
if(TWICE)
  lagc_add_model(game pendulum.lag)
endif()
END
  cat >"$away/game.c" <<'END'
#include <lag.h>
#include <stdio.h>
#include "pend.h"
int main(void) {
  pend_params p;
  double q[1] = {0}, v[1] = {0}, e[2];
  pend_defaults(&p);
  pend_energy(0, q, v, &p, e);
  printf("%.2f %s\n", e[0], LAG_ABI > 0 ? "pendulum" : "");
  return 0;
}
END
  cp models/pendulum.lag "$away"
  [ -n "$so" ] || sed -i.bak '/_shared/d' "$away/CMakeLists.txt"
  made() { (cd "$away" && cmake -S . -B made -DMAIN=main.c -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_BUILD_TYPE=Release && cmake --build made) && "$away/made/game" >"$TMP/game"; }
  check "a project with CMake" made
  with_shared() { needs "$away/made/with_shared" && "$away/made/with_shared"; } # CMake writes the folder into programs that are not installed
  [ -z "$so" ] || check "a program with lagc::lag_shared" with_shared
  is "computes with the model" "0.00 pendulum" "$(cat "$TMP/game")"
  sed 's/project(swing C)/project(swing CXX)/; s/^lagc_add_model(.*RUNTIME)/if(REFUSED)\n  &\nendif()/; /_shared/d; s/ swinging)/)/; s/game\.c/game.cpp/' "$away/CMakeLists.txt" >"$TMP/CMakeLists.txt"
  sed '/lag\.h/d; s/LAG_ABI > 0/1/' "$away/game.c" >"$TMP/game.cpp"
  plus() { mkdir -p "$away/plus plus" && cp models/pendulum.lag "$TMP/CMakeLists.txt" "$TMP/game.cpp" "$away/plus plus" &&
    (cd "$away/plus plus" && cmake -S . -B made -DCMAKE_PREFIX_PATH="$prefix" && cmake --build made) && [ "$("$away/plus plus/made/game")" = "0.00 pendulum" ]; }
  check "a project of C++ alone, in a folder with a space" plus
  no_c() { ! cmake -DREFUSED=1 "$away/plus plus/made" >"$TMP/out" 2>&1 && tr -s ' \n' ' ' <"$TMP/out" | grep -F 'write project(... C) or enable_language(C)'; }
  check "which is told what C for the runtime needs" no_c
  twice() { ! cmake -DREFUSED=0 -DTWICE=1 "$away/plus plus/made" >"$TMP/out" 2>&1 && tr -s ' \n' ' ' <"$TMP/out" | grep -F 'there is a target game already'; }
  check "and that a model needs a target of its own" twice
  remade() {
    sed -i.bak 's/(y + l)/y/' "$away/pendulum.lag" && ! cmp -s "$away/pendulum.lag" models/pendulum.lag && cmake --build "$away/made" && "$away/made/game" >"$TMP/game"
  }
  check "a model that changes is compiled again" remade
  is "and counts" "-9.81 pendulum" "$(cat "$TMP/game")"
  wrong_version() { sed -i.bak 's/lagc 0.1/lagc 7.0/' "$away/CMakeLists.txt" && ! (cd "$away" && cmake -S . -B other -DCMAKE_PREFIX_PATH="$prefix") >"$TMP/out" 2>&1 && grep -q 'requested version' "$TMP/out"; }
  check "another version is refused" wrong_version
else
  skip "a project with CMake" "no cmake"
fi

# ---- a release: two archives of one commit have the same bytes ----
if git rev-parse --verify -q HEAD >/dev/null 2>&1; then
  packed() { "$MAKE" BUILD="$TMP/$1" dist >"$TMP/out" 2>&1 || { cat "$TMP/out"; return 1; }; }
  check "make dist" packed one
  slow check "once more" packed two
  same() { cmp "$TMP/one/lagc-$version.tar.gz" "$TMP/two/lagc-$version.tar.gz" && tar tzf "$TMP/one/lagc-$version.tar.gz" | grep -qx "lagc-$version/Makefile"; }
  slow check "the same bytes" same
fi

deb() { # the package unpacked elsewhere runs a model of its gallery
  "$MAKE" BUILD="$BUILD" PRECISIONS= deb >"$TMP/out" 2>&1 || { cat "$TMP/out"; return 1; }
  dpkg-deb -f "$BUILD"/lagc_*.deb Depends | grep -q '^libc6' && dpkg-deb -x "$BUILD"/lagc_*.deb "$TMP/deb" &&
    (unset LAGC LAG_HOME && cd "$TMP" && "$TMP/deb/usr/bin/lagc" run @pendulum --quiet -o deb.csv) && [ -s "$TMP/deb.csv" ] && [ -f "$TMP/deb/usr/lib/python3/dist-packages/lagc.py" ]
}
if command -v dpkg-deb >/dev/null 2>&1; then slow check "make deb" deb; fi

shared() {
  "$CC" -shared -Wl,-z,text -Wl,--no-undefined -o "$TMP/liblag.so" -Wl,--whole-archive "$prefix/lib/liblag.a" -Wl,--no-whole-archive -lm
}
check "liblag goes into a shared object" shared
no_compiler() { "$MAKE" CC=/nowhere/cc BUILD="$TMP/none" help && "$MAKE" CC=/nowhere/cc BUILD="$TMP/none" clean && [ ! -e "$TMP/none" ]; }
check "help and clean need no compiler" no_compiler

# ---- lagc, from the installed tree, in another folder ----
lagc_away() { (cd "$away" && unset LAG_HOME && "$prefix/bin/lagc" "$@"); }
check "lagc check" lagc_away check "$prefix/share/lagc/models/double_pendulum.lag"
check "lagc run" lagc_away run "$prefix/share/lagc/models/double_pendulum.lag" --until 0.1 -o rows.csv
check "it wrote its rows" [ -s "$away/rows.csv" ]
check "lagc build" lagc_away build "$prefix/share/lagc/models/double_pendulum.lag" --no-gsl -o sim
no_gsl() { "$away/sim" --until 0.1 && ! "$away/sim" --until 0.1 --method gsl-rk8pd; }
check "a simulator without GSL runs, and has no gsl-* methods" no_gsl
without_so() { ! needs "$away/sim"; }
[ -z "$so" ] || check "it does not need the shared library" without_so

precise() { lagc_away run "$prefix/share/lagc/models/kepler.lag" --until 0.1 --precision "$1"; }
for p in $PRECISIONS; do slow check "precision: $p" precise "$p"; done

# lagc from a tree that was moved, and with LAG_HOME of another tree.
moved() { mv "$prefix" "$TMP/moved" && (cd "$away" && "$TMP/moved/bin/lagc" run @double_pendulum --until 0.1); }
check "a tree that was moved works where it is" moved
by_home() { (cd "$away" && cp "$TMP/moved/bin/lagc" . && LAG_HOME=$TMP/moved ./lagc run "$TMP/moved/share/lagc/models/double_pendulum.lag" --until 0.2); }
check "LAG_HOME says where the runtime is" by_home

uninstall_it() { mv "$TMP/moved" "$prefix" && "$MAKE" BUILD="$BUILD" uninstall PREFIX="$prefix"; }
check "make uninstall" uninstall_it
is "nothing is left" "" "$(files "$prefix")"
tap_end
