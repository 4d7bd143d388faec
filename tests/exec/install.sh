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
for p in $PRECISIONS; do
  more_files="$more_files lib/liblag_$p.a lib/lag-$p/lag.h lib/lag-$p/lag_model.h"
done
models=$(cd models && ls -d -- *.lag *.csv 2>/dev/null)
want=$(for f in bin/lagc include/lag.h include/lag_kkt.h include/lag_math.h include/lag_model.h include/lag_sincos.h lib/liblag.a lib/pkgconfig/liblag.pc $more_files \
  share/doc/lagc/LICENSE share/doc/lagc/README.md share/man/man1/lagc.1 share/bash-completion/completions/lagc \
  share/zsh/site-functions/_lagc share/fish/vendor_completions.d/lagc.fish share/lagc/lag.tmLanguage.json; do
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
static int accel(double t, const double *q, const double *v, const double *z, const double *p, const double *u,
                 double *a, double *zd, double *w) {
  (void)t, (void)v, (void)z, (void)p, (void)u, (void)zd, (void)w;
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
  "$CC" -std=c11 -Wall -Wextra -o "$away/main" "$away/main.c" $(pkg-config --cflags --libs "$1") && "$away/main"
}
version=$(sed -n 's/^.define LAG_VERSION "\(.*\)"/\1/p' runtime/include/lag.h)
is "lagc has the version of liblag" "lagc $version" "$("$prefix/bin/lagc" version)"
is "and the newest release of CHANGELOG.md" "$version" "$(sed -n 's/^## \([0-9][0-9.]*\),.*/\1/p' CHANGELOG.md | head -n 1)"
if command -v pkg-config >/dev/null; then
  check "a program, through pkg-config" with_pkg_config liblag
  is "it runs" "oscillator $version rk45" "$("$away/main" 2>&1)"
  is "the version of liblag.pc" "$version" "$(PKG_CONFIG_PATH=$prefix/lib/pkgconfig pkg-config --modversion liblag)"
  [ -z "$GSL" ] || check "and with the gsl-* methods" with_pkg_config liblag_gsl
else
  skip "a program, through pkg-config" "no pkg-config"
fi

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

precise() { lagc_away run "$prefix/share/lagc/models/kepler.lag" --until 0.1 --precision "$1"; }
for p in $PRECISIONS; do slow check "precision: $p" precise "$p"; done

# lagc from a tree that was moved, and with LAG_HOME of another tree.
moved() { mv "$prefix" "$TMP/moved" && (cd "$away" && "$TMP/moved/bin/lagc" run "$TMP/moved/share/lagc/models/double_pendulum.lag" --until 0.1); }
check "a tree that was moved works where it is" moved
by_home() { (cd "$away" && cp "$TMP/moved/bin/lagc" . && LAG_HOME=$TMP/moved ./lagc run "$TMP/moved/share/lagc/models/double_pendulum.lag" --until 0.2); }
check "LAG_HOME says where the runtime is" by_home

uninstall_it() { mv "$TMP/moved" "$prefix" && "$MAKE" BUILD="$BUILD" uninstall PREFIX="$prefix"; }
check "make uninstall" uninstall_it
is "nothing is left" "" "$(files "$prefix")"
tap_end
