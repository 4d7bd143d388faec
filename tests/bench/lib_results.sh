#!/bin/sh
# Writes tests/bench/RESULTS.md: a section a suite, from the logs of those that have just run and, for the others, from the file as it was.
#   lib_results.sh LOGS SUITE...
set -eu
: "${CC:=cc}"
logs=$1
shift
results=tests/bench/RESULTS.md
old=$(mktemp)
[ ! -f "$results" ] || cat "$results" >"$old"

machine() {
  cpu=$(sed -n 's/^model name[^:]*: *//p' /proc/cpuinfo 2>/dev/null | head -n 1)
  echo "${cpu:-$(uname -m)}, $(getconf _NPROCESSORS_ONLN 2>/dev/null || echo 1) processors; $(uname -s)"
}
versions() {
  "$CC" --version | head -n 1
  if command -v valgrind >/dev/null; then valgrind --version; fi
  for p in python3 /usr/bin/python3; do "$p" -c 'import sympy; print("SymPy", sympy.__version__)' 2>/dev/null && break; done
  if command -v gsl-config >/dev/null; then echo "GSL $(gsl-config --version)"; fi
  getconf GNU_LIBC_VERSION 2>/dev/null || true
}
section() { # NAME: as it was
  awk -v head="## $1" '$0 == head { on = 1; print; next } /^## / { on = 0 } on' "$old"
}

{
  echo '# What `make bench` measured'
  echo
  echo 'Written by `make bench`, which rewrites the sections of the suites that it runs; the head of each script says what it measures.'
  echo 'Instruction counts do not depend on what else a machine does; times are ratios of functions that took turns in one run.'
  for f in tests/bench/*.sh; do
    name=$(basename "$f" .sh)
    case $name in lib_*) continue ;; esac
    echo
    case " $* " in
      *" bench/$name "*)
        echo "## $name"
        echo
        echo "On $(machine); $(versions | paste -s -d ';' | sed 's/;/; /g')."
        echo
        if grep -q '^| --- ' "$logs/bench/$name.log"; then cat "$logs/bench/$name.log"; else sed 's/^/    /' "$logs/bench/$name.log"; fi ;;
      *) section "$name" ;;
    esac
  done
} | cat -s >"$results.part"
mv "$results.part" "$results"
rm -f "$old"
