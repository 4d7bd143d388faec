#!/bin/sh
# runtime/python/lagc.py, as it stands in the source tree: python/check_lagc.py has the checks; SLOW: rows of nine models, else of three.
. tests/tap.sh
python=
for p in python3 /usr/bin/python3; do "$p" -c 'import numpy, ctypes' 2>/dev/null && { python=$p; break; }; done
[ -n "$python" ] || skip_all "there is no Python with NumPy"
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
export LAGC TMP PYTHONDONTWRITEBYTECODE=1
PYTHONPATH=runtime/python relay "$python" tests/exec/python/check_lagc.py
sizes() { # of the structs of lag.h, which lagc.py repeats
  printf '#include <stdio.h>\n#include "lag.h"\nint main(void) { printf("%%zu %%zu %%zu\\n", sizeof(lag_option), sizeof(lag_stats), sizeof(lag_charge_stats)); }\n' >"$TMP/sizes.c" &&
    "$CC" -I"$INC" "$TMP/sizes.c" -o "$TMP/sizes" && "$TMP/sizes" >"$TMP/sizes.txt" &&
    PYTHONPATH=runtime/python "$python" -c 'import lagc, ctypes; print(*[ctypes.sizeof(s) for s in (lagc._Option, lagc._Stats, lagc._Charge)])' | cmp - "$TMP/sizes.txt"
}
check "structs have the sizes of lag.h" sizes
found() { # lagc is found beside the file, and in $PATH
  mkdir -p "$TMP/away/share/lagc/python" "$TMP/away/bin" && cp runtime/python/lagc.py "$TMP/away/share/lagc/python" &&
    printf '#!/bin/sh\nexec "%s" "$@"\n' "$LAGC" >"$TMP/away/bin/lagc" && chmod +x "$TMP/away/bin/lagc" &&
    (unset LAGC && cd "$TMP/away" && PYTHONPATH=$TMP/away/share/lagc/python "$python" -c "import lagc; print(lagc.load('$root/models/spring.lag').run(until=1))")
}
wheel() { # pip install runtime/python, without network, in an environment of its own; there without a C compiler, with the digits of a compiled model
  "$python" -m venv --system-site-packages "$TMP/venv" && PIP_NO_INDEX=1 "$TMP/venv/bin/pip" install -q ./runtime/python && cat >"$TMP/fresh.py" <<'P' &&
import sys
import lagc
assert lagc.__file__.startswith(sys.prefix), lagc.__file__
evaluated = lagc.load("@double_pendulum")
r = evaluated.run(until=1)
compiled = lagc.load("@double_pendulum", compile="always") if len(sys.argv) > 1 else evaluated
assert evaluated._compiled == (len(sys.argv) > 1) and len(r) == 101 and r.energy_drift < 1e-10, r
y = [1, 2, 3, 4]
print(*r.y[-1].tolist(), *evaluated.mass(0, y).ravel().tolist(), *evaluated.jac(0, y).ravel().tolist(), *evaluated.linearize(th1=0.1).A.ravel().tolist())
P
    (unset LAGC && cd "$TMP" && CC=/none/cc venv/bin/python fresh.py >evaluated && venv/bin/python fresh.py cc >compiled && cmp evaluated compiled && venv/bin/lagc --version)
}
if [ "${SLOW:-}" ] && ! "$python" -c 'import ensurepip' 2>/dev/null; then
  skip "a wheel" "python3-venv is not installed"
else
  [ -n "${COVERAGE:-}" ] || slow check "a wheel brings compiler, runtime and gallery, and needs no C compiler" wheel
fi
root=$(pwd)
check "an installed lagc.py finds its lagc" found
tap_end
