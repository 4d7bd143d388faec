#!/bin/sh
# tests/run.sh itself: suites found, counts, messages. A runner that reports failures as passes is worse than none.
. tests/tap.sh

# A tree with a copy of the runner, and suites made for it.
tree=$TMP/tree
mkdir -p "$tree/tests/a" "$tree/tests/bench" "$tree/tests/unit" "$tree/bin"
cp tests/run.sh "$tree/tests/"
suite() { cat >"$tree/tests/$1.sh"; }
suite a/good <<'END'
echo "ok 1 - one"
echo "ok 2 - two"
echo "1..2"
END
suite a/bad <<'END'
echo "1..2"
echo "ok 1 - one"
echo "not ok 2 - two"
echo "# why it failed"
exit 1
END
suite a/exits_0_but_bad <<'END'
echo "not ok 1 - one"
echo "1..1"
END
suite a/crashes <<'END'
echo "1..2"
echo "ok 1 - one"
kill -SEGV $$
END
suite a/exits_3 <<'END'
echo "ok 1 - one"
echo "1..1"
echo "the reason"
exit 3
END
suite a/silent </dev/null
suite a/no_plan <<'END'
echo "ok 1 - one"
END
suite a/too_few <<'END'
echo "1..3"
echo "ok 1 - one"
END
suite a/skips_one <<'END'
echo "1..2"
echo "ok 1 - one"
echo "ok 2 - two # SKIP no clang"
END
suite a/skips_all <<'END'
echo "1..0 # SKIP no clang"
END
suite a/lib_shared <<'END'
echo "not ok 1 - a library is no suite"
END
suite a/long_one <<'END'
echo "ok 1 - long"
echo "1..1"
END
suite a/knows_bless <<'END'
echo "ok 1 - ${BLESS:+blessed}"
echo "1..1"
END
suite bench/speed <<'END'
echo "1 parsec"
echo "optimised by ${LAGC_OPTIMISE:-default}"
END
# A program as cmocka makes them: two groups are two plans; skipped tests are called `not ok`.
: >"$tree/tests/unit/test_groups.c"
cat >"$tree/bin/test_groups" <<'END'
#!/bin/sh
[ "$CMOCKA_MESSAGE_OUTPUT" = TAP ] || exit 9
printf '1..1\nok 1 - a\n# ok - one\n1..2\nok 1 - b\nnot ok 2 # SKIP c\n'
END
chmod +x "$tree/bin/test_groups"

run() { (unset CI; BUILD=out BIN=bin sh "$tree/tests/run.sh" "$@" 2>&1); }
last() { run "$@" | tail -n 1; }
says() {
  said=$(run "$1")
  printf '%s\n' "$said"
  printf '%s\n' "$said" | grep -q -- "$2"
}
fails() { ! run "$@"; }

is "passed" "2 passed, 0 failed" "$(last a/good)"
check "exit status 0 when all pass" run a/good
is "not ok" "1 passed, 1 failed" "$(last a/bad)"
check "exit status 1 after a failure" fails a/bad
check "the failing line is shown" says "a/bad" "not ok 2 - two"
check "and what follows it" says "a/bad" "# why it failed"
is "not ok and exit status 0" "0 passed, 1 failed" "$(last a/exits_0_but_bad)"
is "a crash is one failure" "1 passed, 1 failed" "$(last a/crashes)"
is "an exit status without not ok is one failure" "1 passed, 1 failed" "$(last a/exits_3)"
check "what it said is shown" says a/exits_3 "the reason"
is "a suite that says nothing failed" "0 passed, 1 failed" "$(last a/silent)"
is "a suite without a plan failed" "1 passed, 1 failed" "$(last a/no_plan)"
is "a suite that stops early failed" "1 passed, 1 failed" "$(last a/too_few)"
is "skipped" "1 passed, 0 failed, 1 skipped" "$(last a/skips_one)"
check "the reason is shown" says a/skips_one "skipped: no clang (two)"
is "a whole suite skipped" "0 passed, 0 failed, 1 skipped" "$(last a/skips_all)"
is "cmocka's groups and skips" "2 passed, 0 failed, 1 skipped" "$(last unit/)"
is "all of them" "11 passed, 7 failed, 3 skipped" "$(last)"
is "with long suites" "12 passed, 7 failed, 3 skipped" "$(last --long)"
is "a name that begins none, beside one that does" "no suite's name begins with: a/none" "$(last a/good a/none)"
check "is a failure" fails a/good a/none
is "long suites are those of make test-long" "no suite's name begins with: long_ (\`make test-long\` has those of long_)" "$(last a/good long_)"
check "the day that chooses rows is printed" says a/good "^rows of DAY=[0-9]"
# Eleven suites of exec/ in a tree of their own.
days=$TMP/days
mkdir -p "$days/tests/exec"
cp tests/run.sh "$days/tests/"
for n in 1 2 3 4 5 6 7 8 9 10 11; do printf 'echo "ok 1 - %s"\necho "1..1"\n' $n >"$days/tests/exec/part_$n.sh"; done
of_day() { BUILD=out sh "$days/tests/run.sh" --today "$@" 2>&1; }
of_days() { for day; do DAY=$day of_day | grep -o '^exec/part_[0-9]*'; done; }
is "--today takes each suite of exec/ on one of eight days" "11 suites, at most 2 a day" \
  "$(of_days 20800 20801 20802 20803 20804 20805 20806 20807 | sort | uniq -c | grep -c ' 1 exec') suites, at most $(of_days 20807 | grep -c .) a day"
is "but those that are named" "11 passed, 0 failed" "$(of_day exec | tail -n 1)"
check "and says so" sh -c "BUILD=out sh '$days/tests/run.sh' --today | grep -q 'of the suites of exec/ one in 8'"
check "benches are shown" says --bench "1 parsec"
check "they measure programs as users get them" says --bench "optimised by default"
is "only scripts that know BLESS are blessed" "1 passed, 0 failed" "$(last --bless)"
check "with BLESS set" grep -q blessed "$tree/out/test/log/a/knows_bless.log"
blessed_in_ci() { (export CI=1 && BUILD=out BIN=bin sh "$tree/tests/run.sh" --bless); }
not() { ! "$@"; }
check "never in CI" not blessed_in_ci
check "a prefix without a suite is a mistake" fails nothing
check "TIMES=1 shows processor time, and when a suite ended" env TIMES=1 BUILD=out BIN=bin sh -c "sh '$tree/tests/run.sh' a/good | grep -q 'processor [0-9.]* s, at [0-9]* s$'"
check "and its sum" env TIMES=1 BUILD=out BIN=bin sh -c "sh '$tree/tests/run.sh' a/good | grep -q '^processor time of all suites: [0-9]* s$'"
suite a/asks_python <<'END'
python3 -c 'print("ok 1 - a python3 that is a script is asked once where Python is")'
python3 -c 'print("1..1")'
END
mkdir "$TMP/shim"
printf '#!/bin/sh\necho >>"%s"\nexec "%s" "$@"\n' "$TMP/shim/calls" "$(command -v python3)" >"$TMP/shim/python3" && chmod +x "$TMP/shim/python3"
is "suites call Python, not a script that looks for it" "1 passed, 0 failed; calls of the script: 1" \
  "$(PATH=$TMP/shim:$PATH last a/asks_python); calls of the script: $(wc -l <"$TMP/shim/calls" | tr -d ' ')"
rm "$tree/tests/a/asks_python.sh"
suite a/slowest <<'END'
i=0; while [ $i -lt 300000 ]; do i=$((i + 1)); done
date +%s.%N
echo "ok 1 - slow"
echo "1..1"
END
suite a/fast <<'END'
date +%s.%N
echo "ok 1 - fast"
echo "1..1"
END
slowest_begins() {
  for _ in 1 2; do JOBS=1 run a/fast a/slowest >/dev/null; done
  sort -n "$tree/out/test/log/a/fast.log" "$tree/out/test/log/a/slowest.log" | grep -m 1 -e '^[0-9]*\.' >"$TMP/first"
  grep -qFx -f "$TMP/first" "$tree/out/test/log/a/slowest.log"
}
check "the slowest suite of the last run begins" slowest_begins
rm "$tree/tests/a/slowest.sh" "$tree/tests/a/fast.sh"
is "suites come in order, each once" "a/bad a/crashes" \
  "$(run a/crashes a/b a/bad | sed -n 's/^\(a[^ ]*\) .*/\1/p' | sort -u | tr '\n' ' ' | sed 's/ $//')"
tap_end
