#!/bin/sh
# The examples of grammar/LANGUAGE.md: a block that begins with `model` passes `lagc check`, every
# other one parses. Prints TAP.
LAGC=${LAGC:-build/lagc}
DUMP=${DUMP:-build/test/bin/dump_syntax}
dir=$(mktemp -d) || exit 1
trap 'rm -rf "$dir"' EXIT
awk -v dir="$dir" '
  /^```lag$/ { file = sprintf("%s/%02d.lag", dir, ++n); next }
  /^```$/ { file = ""; next }
  file { print > file }' grammar/LANGUAGE.md
count=0
failed=0
for f in "$dir"/*.lag; do
  count=$((count + 1))
  first=$(head -n 1 "$f")
  case $first in
    model*) what="checks: $first"; "$LAGC" check "$f" > "$dir/out" 2>&1; status=$? ;;
    *) what="parses: $first"; "$DUMP" "$f" > "$dir/out" 2>&1; status=$? ;;
  esac
  if [ $status -eq 0 ]; then
    echo "ok $count - $what"
  else
    failed=1
    echo "not ok $count - $what"
    sed 's/^/# /' "$dir/out"
  fi
done
[ $count -gt 10 ] || { echo "not ok $((count + 1)) - examples found"; failed=1; }
echo "1..$count"
exit $failed
