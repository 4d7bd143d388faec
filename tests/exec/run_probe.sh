#!/bin/sh
# The probe for compilers that store wrong numbers (src/toolchain/compiler_probe.in): its verdict on this compiler, and lagc and make after a failure.
: "${MAKE:=make}"
. tests/tap.sh
unset LAGC_OPTIMISE # the flags that users get
export XDG_CACHE_HOME="$TMP/cache"

# probe COMPILER FLAGS...: its exit status.
probe() {
  "$@" -x c src/toolchain/compiler_probe.in -o "$TMP/probe" && "$TMP/probe"
}
check "as the build compiles, nothing is wrong" probe $CC -O2
gcc_native() { # the flag cures faults of -march=native
  probe $CC -O2 -march=native -fno-tree-slp-vectorize
}
probe $CC -O2 -march=native >/dev/null 2>&1
case $? in
  0) skip "-march=native: found and mended" "this compiler, for this processor, is right" ;;
  1) check "-march=native: found and mended" gcc_native ;;
  *) skip "-march=native: found and mended" "the compiler has no -march=native" ;;
esac

# A compiler that says it is for AVX-512, and stores wrong numbers unless one of $MEND is among its options.
mkdir -p "$TMP/bin"
cat >"$TMP/bin/wrong" <<END
#!/bin/sh
echo "\$*" >>"$TMP/calls"
case " \$* " in *" -dM "*) echo "#define __AVX512F__ 1"; exit 0 ;; esac
for m in \$MEND; do case " \$* " in *" \$m "*) for o; do shift; case \$o in -march=*) ;; *) set -- "\$@" "\$o" ;; esac; done; exec $CC "\$@" ;; esac; done
for o; do
  shift
  case \$o in */probe.c | *probe.in) sed '/void copied/,/^}/s/= 0;/= a;/' "\$o" >"$TMP/bad.c"; o=$TMP/bad.c ;; esac
  set -- "\$@" "\$o"
done
exec $CC "\$@"
END
chmod +x "$TMP/bin/wrong"
built_with() { # MEND WORDS: the simulator says that it was built with these
  : >"$TMP/calls"
  "$LAGC" cache --clear >/dev/null # what was found out about this compiler
  MEND=$1 CC=$TMP/bin/wrong "$LAGC" build models/pendulum.lag -o "$TMP/sim" || return 1
  "$TMP/sim" --help | grep '^built by:' | grep -q -e "$2"
}
check "lagc: the flag that it has anyway mends it" built_with -fno-tree-slp-vectorize '-ffp-contract=off -fno-tree-slp-vectorize$'
check "lagc: another where that is not enough" built_with -march=x86-64-v3 '-ffp-contract=off -fno-tree-slp-vectorize -march=x86-64-v3$'
no_help() {
  rm -f "$TMP/none"
  "$LAGC" cache --clear >/dev/null
  MEND= CC=$TMP/bin/wrong "$LAGC" build models/pendulum.lag -o "$TMP/none" 2>"$TMP/err"
  [ $? = 2 ] && ! [ -e "$TMP/none" ] && grep -q 'stores wrong numbers.*set CC' "$TMP/err"
}
check "lagc: an error where nothing helps" no_help
is "a compiler that fails is asked again" 0 "$(ls "$TMP/cache/lagc" | grep -c 'cc$')"
once() { # the probe runs once for a compiler
  built_with -march=x86-64-v3 -march=x86-64-v3 && [ "$(grep -c -e -dM "$TMP/calls")" = 1 ] || return 1
  : >"$TMP/calls"
  MEND=-march=x86-64-v3 CC=$TMP/bin/wrong "$LAGC" build models/spring.lag -o "$TMP/sim" && ! grep -q -e -dM "$TMP/calls" && grep -q -e -march=x86-64-v3 "$TMP/calls" || return 1
  echo '# another' >>"$TMP/bin/wrong"
  MEND=-march=x86-64-v3 CC=$TMP/bin/wrong "$LAGC" build models/spring.lag -o "$TMP/sim" && grep -q -e -dM "$TMP/calls"
}
check "lagc: a compiler is probed once, and again when its file is another" once
plain() { "$LAGC" build models/pendulum.lag -o "$TMP/sim" && "$TMP/sim" --help | grep '^built by:' | grep -q -e '-ffp-contract=off -fno-tree-slp-vectorize$'; }
check "lagc: no other flag where nothing is wrong" plain
empty "the folder of the build is removed" "$(ls -d "$TMP"/sim.* "$TMP"/none.* 2>/dev/null)"

makes() { # CC: number of times the flag stands in the commands of make -n
  MEND=-fno-tree-slp-vectorize $MAKE -n BUILD="$TMP/b" CC="$1" all 2>/dev/null | grep -c -e '-O2 -fno-tree-slp-vectorize .*-c -o'
}
several() { [ "$(makes "$TMP/bin/wrong")" -gt 100 ]; }
check "make: the flag where numbers are wrong" several
is "make: no flag where nothing is wrong" 0 "$(makes "$CC")"

# ---- LAGC_OPTIMISE: the same bits at every level, and no other words
. tests/exec/lib_levels.sh
for words in ${SLOW:+"double_pendulum swing"} "slider_crank" "kepler --method taylor" ${SLOW:+"bouncing_ball"}; do
  check "the same rows at -O0 and at -O2: $words" same_rows $words
done
for level in -O9 O0 '-O2 -ffast-math' -Ofast; do
  check "LAGC_OPTIMISE='$level' is refused" says 2 'it takes -O0, -O1, -O2 or -O3' env LAGC_OPTIMISE="$level" "$LAGC" build models/pendulum.lag -o "$TMP/sim"
done
tap_end
