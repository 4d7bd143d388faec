#!/bin/sh
# Who calls whom: files call each other in circles of at most 8. A larger circle stands below with its size and the reason; it may shrink, not grow.
. tests/tap.sh
if ! command -v python3 >/dev/null || ! command -v nm >/dev/null; then
  skip "circles of calls" "no python3 with nm"
  tap_end
  exit
fi

# HALF SIZE FILE: a circle that FILE is in
known='
src 10 emit/header_steps the texts of a header'"'"'s methods, which declare and define in turns
'
large() {
  python3 tests/exec/calls.py "$BUILD/obj/$1" 8 2>&1 | while read -r word size files; do
    allowed=$(echo "$known" | while read -r half most file reason; do
      case " $half $files " in *" $1 "*" $file "*) [ -n "$reason" ] && echo "$most" ;; esac
    done)
    [ "$word" = CIRCLE ] && [ "${allowed:-8}" -ge "$size" ] || echo "$word $size $files"
  done
}
for half in src runtime; do empty "circles of calls in $half" "$(large $half)"; done
tap_end
