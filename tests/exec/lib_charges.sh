# shellcheck shell=sh
# Fields of charges in the JSON report $TMP/out.

# of CHARGE FIELD
of() { sed -n "s/.*\"$1\": {\([^}]*\)}.*/\1, /p" "$TMP/out" | sed -n "s/.*\"$2\": \"\{0,1\}\([^,\"]*\)\"\{0,1\}, .*/\1/p"; }
below() { awk -v a="$1" -v b="$2" 'BEGIN { exit !(a != "" && a + 0 <= b + 0) }'; }
between() { awk -v a="$1" -v lo="$2" -v hi="$3" 'BEGIN { exit !(a != "" && a >= lo + 0 && a <= hi + 0) }'; }
