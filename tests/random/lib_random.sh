# shellcheck shell=sh
# random_check SEED FROM TO: models of that seed, each compared with its text; the last line counts.
"${CC%% *}" -std=c11 -O1 -w -D_XOPEN_SOURCE=700 -Isrc -I"$BUILD/gen" -o "$TMP/random_check" tests/random/check.c tests/random/model.c "$BUILD/liblagc.a" -lm
random_check() { "$TMP/random_check" "$1" "$2" "$3" >"$TMP/random.txt"; }
