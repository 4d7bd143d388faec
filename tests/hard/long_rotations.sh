#!/bin/sh
# The cases of rigid bodies once more, by `coord R: rotation` (tests/hard/rotations) instead of Euler's angles, against the same digits and tolerances:
# free bodies, a top, and disks that roll. Between steps and over 10^5 of them the length of the quaternion and the energy stay.
. tests/tap.sh
. tests/hard/lib_cases.sh
models=$hard/rotations

check "the cases are emitted" emit_cases all
check "and compile" compile_cases "$TMP/hard"
cat >"$TMP/runs.txt" <<'E2'
# 1e-14 a step, 300 to 1000 steps
quick * dop853 tol=1e-14 atol=1e-15
# 1e-13: 5000 steps
quick * rk45 tol=1e-13 atol=1e-15 most=200000
# of order 6 in 4000 to 64000 steps
quick * verlet6 steps=4000..64000
E2
by() { "$TMP/hard" $hard/cases.json "${2:-$hard/expected.txt}" "$TMP/runs.txt" quick "$1"; }
for id in hlw-free-rigid-body top-nutation ${SLOW:+rb-dzhanibekov rolling-disk-upright-stable rolling-disk-upright-unstable}; do relay by $id; done

wrong() { # CASE FROM TO: the case fails when a digit is another
  sed "/^$1 /s/$2/$3/" $hard/expected.txt >"$TMP/wrong" && ! cmp -s "$TMP/wrong" $hard/expected.txt && grep dop853 "$TMP/runs.txt" >"$TMP/dop853" && mv "$TMP/dop853" "$TMP/runs.txt" &&
    ! by "$1" "$TMP/wrong" >/dev/null
}
check "a wrong digit is seen" wrong top-nutation '0\.36670434663' 0.36670434673
tap_end
