# shellcheck shell=sh
# same_rows MODEL ARGUMENTS...: models/MODEL.lag puts out the same bytes by simulators of -O0 and of -O2.
same_rows() {
  levels_model=$1
  shift
  for level in 0 2; do
    rm -f "$TMP/rows$level.csv"
    LAGC_OPTIMISE=-O$level "$LAGC" run "models/$levels_model.lag" "$@" --quiet -o "$TMP/rows$level.csv" || return 1
  done
  cmp "$TMP/rows0.csv" "$TMP/rows2.csv"
}
