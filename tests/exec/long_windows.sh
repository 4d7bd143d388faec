#!/bin/sh
# Windows: compiler and runtime built by MinGW, run by wine. Texts are the bytes of Linux; simulators and FMUs move as on Linux.
. tests/tap.sh
one_day_in 3 0
: "${MAKE:=make}"
cc=x86_64-w64-mingw32-gcc
command -v $cc >/dev/null || skip_all "no MinGW: apt-get install gcc-mingw-w64-x86-64-posix"
command -v wine >/dev/null || skip_all "no wine: apt-get install wine wine64"
WINEPREFIX=$(pwd)/$BUILD/wine
export WINEPREFIX WINEDEBUG=-all
unset DISPLAY
# Now and then wine's server hangs up on a program ("wine client error"), or a service of wine's own falls beside a program that ended well
# ("wine: Unhandled page fault" with status 0; a fault of the program itself has another status): the program is then run once more.
mkdir -p "$TMP/bin"
cat >"$TMP/bin/wine" <<END
#!/bin/sh
for turn in 1 2 3; do
  "$(command -v wine)" "\$@" >"$TMP/said.\$\$" 2>"$TMP/errors.\$\$"
  status=\$?
  grep -q 'wine client error' "$TMP/errors.\$\$" || { [ \$status = 0 ] && grep -q '^wine: Unhandled' "$TMP/errors.\$\$"; } || break
done
cat "$TMP/said.\$\$"
cat "$TMP/errors.\$\$" >&2
rm -f "$TMP/said.\$\$" "$TMP/errors.\$\$"
exit \$status
END
chmod +x "$TMP/bin/wine"
PATH=$TMP/bin:$PATH
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
tree=$BUILD/windows usr=$TMP/usr

made() { env -u CC "$MAKE" -s -j2 CC=$cc AR=x86_64-w64-mingw32-ar CFLAGS=-O0 BUILD="$tree" PRECISIONS= WERROR=-Werror PREFIX="$usr" "$@"; }
check "it builds without warnings" made all
check "it is installed" made install
[ -x "$usr/bin/lagc.exe" ] && [ -f "$usr/lib/liblag.a" ] || { tap_end; exit; }
wineserver -p600 # it waits for programs so long, and is ended below
wine wineboot -i >/dev/null 2>&1

# ---- texts: golden suites with lagc.exe in the place of lagc
printf '#!/bin/sh\nexec wine "%s" "$@"\n' "$(pwd)/$tree/lagc.exe" >"$TMP/lagc" && chmod +x "$TMP/lagc"
RELAY_PREFIX="lagc.exe: "
export XDG_CACHE_HOME="$TMP/cache"
mkdir -p "$XDG_CACHE_HOME"
same() { # COMMAND...: of a third of the gallery, another for each command
  for m in $(ls models/*.lag | awk -v third=$third 'NR % 3 == third'); do
    export LAG_HOME="$usr" # whose share/lagc/models/lib has what models include
    "$LAGC" "$@" "$m" >"$TMP/here" 2>&1
    here=$?
    "$TMP/lagc" "$@" "$m" >"$TMP/there" 2>&1
    there=$?
    [ $here = $there ] && cmp -s "$TMP/here" "$TMP/there" || echo "$m: exit status $there; $(diff "$TMP/here" "$TMP/there" | head -n 4)"
  done
}
third=0
for words in check derive emit header 'emit --method taylor'; do
  third=$(((third + 1) % 3))
  # shellcheck disable=SC2086 # some words
  empty "$words: the bytes of Linux for a third of the gallery" "$(same $words)"
done
# Where lagc.exe needs a C compiler, windows_cc.c plays its part: it copies a simulator that was made here.
$cc -O1 tests/exec/windows_cc.c -o "$TMP/wcc.exe"
cross() { CC=$cc LAG_HOME=$usr "$LAGC" build "$@"; }
cross tests/golden/ok/method.lag -o "$TMP/method.exe"
for suite in run_eqns run_stages run_errors; do
  relay env -u SLOW PART=4 TMP="$TMP/$suite" LAGC="$TMP/lagc" LAG_HOME="$usr" CC="$TMP/wcc.exe" WINDOWS_CC_MADE="$TMP/method.exe" sh -c 'mkdir -p "$TMP" && exec sh tests/golden/'$suite.sh
done
unfound() { says 1 'a_b.csv' "$TMP/lagc" check "$(wine winepath -w "$TMP/table.lag")"; }
printf 'model m\ncoord x\ninput f = "a_b.csv"\nlagrangian = x%s^2/2 + f*x\n' "'" >"$TMP/table.lag"
check "a table that is missing" unfound
printf 't,f\n0,0\n1,1\n' >"$TMP/a_b.csv"
beside() { "$TMP/lagc" check "$(wine winepath -w "$TMP/table.lag")"; }
check "a table is found beside a model whose path has backslashes" beside

# ---- simulators: made here, run there
# The runs of both are compiled from the same C; sine and cosine are lagc's own, and the other functions of MinGW's library differ from glibc's in
# the last bit: a run with an error of 1e-10 then differs by 1e-8 at most; a run of + - * / and sqrt not at all.
moves() { # TOLERANCE MODEL SCENE OPTIONS...
  tolerance=$1 model=$2 scene=$3
  shift 3
  "$LAGC" build "$model" -o "$TMP/sim" && cross "$model" -o "$TMP/sim.exe" &&
    "$TMP/sim" "$scene" "$@" --quiet -o "$TMP/here.csv" && wine "$TMP/sim.exe" "$scene" "$@" --quiet -o "$TMP/there.csv" || return 1
  case $tolerance in 0) cmp "$TMP/here.csv" "$TMP/there.csv" && return ;; esac
  paste -d , "$TMP/here.csv" "$TMP/there.csv" | awk -F , -v t="$tolerance" 'NR > 1 {
    for (i = 1; i <= NF/2; i++) { d = $i - $(i + NF/2); if (d < 0) d = -d; if (d > most) most = d }
    if (NF % 2) bad = 1 } END { print "off by " most; exit bad || NR < 3 || !(most <= t) }'
}
while read -r tolerance name scene options; do
  # shellcheck disable=SC2086 # options
  check "$name in wine" moves "$tolerance" "models/$name.lag" "$scene" $options
done <<END
0 double_pendulum swing --until 2
0 bouncing_ball drop --until 3
0 lorenz butterfly --until 2
1e-8 slider_crank idle --until 2
1e-8 toda sound --until 2
END
"$LAGC" build models/double_pendulum.lag -o "$TMP/sim" && cross models/double_pendulum.lag -o "$TMP/sim.exe"
check "it needs no library but Windows' own" sh -c '! x86_64-w64-mingw32-objdump -p "$0" | grep "DLL Name" | grep -v -i -e kernel32 -e msvcrt' "$TMP/sim.exe"
resumed() {
  wine "$TMP/sim.exe" --until 1 --quiet --save-state "$TMP/state" && "$TMP/sim" --resume "$TMP/state" --until 2 --quiet -o "$TMP/a.csv" &&
    wine "$TMP/sim.exe" --resume "$TMP/state" --until 2 --quiet -o "$TMP/b.csv" && cmp "$TMP/a.csv" "$TMP/b.csv"
}
check "a state saved there goes on here, with the same bytes" resumed
files() {
  for x in svg npy html; do
    case $x in
      npy) set -- -o ;; html) set -- --points 'x2,y2' --html ;; *) set -- --svg ;;
    esac
    "$TMP/sim" --quiet "$@" "$TMP/a.$x" && wine "$TMP/sim.exe" --quiet "$@" "$TMP/b.$x" && cmp "$TMP/a.$x" "$TMP/b.$x" || return 1
  done
  wine "$TMP/sim.exe" --quiet -o "$TMP/b.npy" && ! ls "$TMP"/*.part-* 2>/dev/null # over an existing file, nothing left
}
check "pictures, pages and arrays are the bytes of Linux, also over existing files" files
rows() {
  wine "$TMP/sim.exe" --quiet -o - --until 1 >"$TMP/there.csv" 2>"$TMP/wine.err" || { cat "$TMP/wine.err"; return 1; }
  "$TMP/sim" --quiet -o - --until 1 | cmp - "$TMP/there.csv"
}
rows_of_two() { rows >/dev/null || rows; } # wine itself failed to start once in 20 beside other work
check "rows on standard output have no carriage returns" rows_of_two
check "a wrong word" says 2 'no such parameter' wine "$TMP/sim.exe" nosuch=3
check "an output that would be the state to go on from" says 2 'would be overwritten' wine "$TMP/sim.exe" --resume "$TMP/state" --until 2 -o "$TMP/state"

# ---- lagc.exe run
run() { # COMPILER WORDS...: of lagc.exe
  (export CC="$1" LAG_HOME="$usr" WINDOWS_CC_MADE="$TMP/sim.exe" && shift && exec "$TMP/lagc" "$@")
}
check "without a C compiler" says 2 'the C compiler `gcc` cannot be run; install one (gcc or clang), or set CC' run '' run models/double_pendulum.lag --compile always
run cc cache --clear >/dev/null
check "no build folder is left" sh -c '[ -z "$(ls "$0")" ]' "$TMP/cache/lagc"
runs() { run "$TMP/wcc.exe" run models/double_pendulum.lag --compile always --until 1 --quiet -o - >"$TMP/there.csv" && "$TMP/sim" --until 1 --quiet -o - | cmp - "$TMP/there.csv"; }
check "it compiles and runs" runs
check "the cache has the simulator" says 0 'simulators  1' run cc cache
cached() { mv "$TMP/sim.exe" "$TMP/away.exe" && runs && mv "$TMP/away.exe" "$TMP/sim.exe"; }
check "it runs again from the cache" cached
check "the status of a simulator" says 2 'no such parameter' run "$TMP/wcc.exe" run models/double_pendulum.lag nosuch=3
check "the cache is cleared" says 0 'removed 1 simulator' run cc cache --clear
built() { run "$TMP/wcc.exe" build models/double_pendulum.lag -o "$TMP/built.exe" && cmp "$TMP/built.exe" "$TMP/sim.exe"; }
check "lagc build" built
check "lagc verify is refused" says 2 'not for Windows' run '' verify models/double_pendulum.lag --against models/double_pendulum_textbook.c:rhs
check "a model is not overwritten" says 2 'would be overwritten' run "$TMP/wcc.exe" emit models/pendulum.lag -o models/pendulum.lag

# ---- FMUs: made here, imported there
unpack() { rm -rf "$2" && mkdir -p "$2" && if command -v unzip >/dev/null; then unzip -q "$1" -d "$2"; else python3 -m zipfile -e "$1" "$2"; fi; }
imported() { # VERSION MODE MODEL SCENE TOLERANCE
  "$LAGC" fmu "models/$3.lag" "$4" --fmi "$1" --also-cc $cc -o "$TMP/win.fmu" && unpack "$TMP/win.fmu" "$TMP/fmu" &&
    "$LAGC" run "models/$3.lag" "$4" --until 2 --every 0.05 --quiet -o "$TMP/rows.csv" &&
    wine "$TMP/import$1.exe" "$TMP/fmu" "$(wine winepath -w "$TMP/fmu"/binaries/*/*.dll)" "$2" "$TMP/rows.csv" "$5" 20
}
for v in 2 3; do
  check "the importer for FMI $v" $cc -std=c11 -D__USE_MINGW_ANSI_STDIO=1 -O1 -DFMI=$v tests/exec/fmu_import.c -o "$TMP/import$v.exe"
  while read -r mode name scene tolerance; do
    check "an FMU of $name in wine, FMI $v, $mode" imported $v "$mode" "$name" "$scene" "$tolerance"
  done <<END
cs pendulum small 1e-8
me double_pendulum swing 1e-6
cs bouncing_ball drop 1e-8
saved motor_pendulum lift 1e-8
END
done
wineserver -k >/dev/null 2>&1
tap_end
