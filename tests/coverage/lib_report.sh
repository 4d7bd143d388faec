#!/bin/sh
# make coverage: the share of lines of src and runtime that suites reached, a row a folder and the sum.
#   sh tests/coverage/lib_report.sh BUILD      after a run of suites against a build with --coverage
# Generated files do not count.
cd "$(dirname "$0")/../.." || exit 2
find "$1/obj/src" "$1/obj/runtime" -name '*.gcno' | sort | while read -r notes; do
  source=${notes#"$1/obj/"}
  # gcov says nothing of a file that no program ran: all of its lines are missed.
  gcov -n "$notes" 2>/dev/null | awk -F "[':% ]+" -v file="${source%.gcno}.c" '
    /^File / { mine = index($0, "'\''" file "'\''") }
    /^Lines executed/ && mine { print file, $3, $5; mine = 0 }'
done | awk '
  function row(name, lines, reached) { printf "%6.1f %%  %6d of %6d  %s\n", lines ? 100*reached/lines : 100, reached, lines, name }
  { folder = $1; sub(/\/[^\/]*$/, "", folder); if (!(folder in lines)) order[++n] = folder
    lines[folder] += $3; reached[folder] += $3*$2/100; all += $3; all_reached += $3*$2/100 }
  END { for (i = 1; i <= n; i++) row(order[i], lines[order[i]], reached[order[i]]); row("in total", all, all_reached) }'
