#!/bin/sh
# The notebooks of runtime/python, executed: python/check_notebook.py and check_fit_notebook.py have the checks.
. tests/tap.sh
python=
for p in python3 /usr/bin/python3; do "$p" -c 'import numpy, nbclient, ipykernel' 2>/dev/null && { python=$p; break; }; done
[ -n "$python" ] || skip_all "there is no Python with NumPy, nbclient and ipykernel"
case $LAGC in /*) ;; *) LAGC=$(pwd)/$LAGC ;; esac
export LAGC PYTHONDONTWRITEBYTECODE=1 IPYTHONDIR="$TMP/ipython" JUPYTER_RUNTIME_DIR="$TMP/jupyter" JUPYTER_PATH="$TMP/share"
# The kernel of the Python that has the packages.
"$python" -m ipykernel install --prefix "$TMP/share" >/dev/null 2>&1
mv "$TMP/share/share/jupyter/kernels" "$TMP/share/kernels"
check "the notebook" "$python" -W ignore tests/exec/python/check_notebook.py runtime/python/double_pendulum.ipynb
[ ! -e "${BUILD:-build}/liblag_gsl.a" ] || check "the notebook of a fit" "$python" -W ignore tests/exec/python/check_fit_notebook.py runtime/python/fit.ipynb
tap_end
