# shellcheck shell=sh
# The published problems as C: $TMP/*.c, and $TMP/scenes.c with the list of their scenes.
emit_cases() {
  {
    echo '#include "lag_model.h"'
    for m in tests/exec/cases/*.lag; do
      n=$(basename "$m" .lag)
      "$LAGC" emit "$m" --method taylor -o "$TMP/$n.c"
      sed -n 's/^const lag_scene \(.*\) = {/extern const lag_scene \1;/p' "$TMP/$n.c"
    done
    echo 'extern const lag_scene *const all_scenes[];'
    echo 'const lag_scene *const all_scenes[] = {'
    sed -n 's/^const lag_scene \(.*\) = {/  \&\1,/p' "$TMP"/*.c
    echo '  0};'
  } >"$TMP/scenes.txt"
  mv "$TMP/scenes.txt" "$TMP/scenes.c"
}

# The tap of the command, as part of this one.
tap_of() {
  "$@" >"$TMP/out"
  while read -r line; do
    case $line in
      "ok "*) check "${line#ok * - }" true ;;
      "not ok "*) check "${line#not ok * - }" false ;;
      "# "*) echo "$line" ;;
    esac
  done <"$TMP/out"
}
