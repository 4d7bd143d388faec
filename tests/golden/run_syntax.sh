#!/bin/sh
# Golden tests of the front end. Each is two files:
#   tests/golden/ast/NAME.lag + NAME.expected   the listing of its Ast
#   tests/golden/err/NAME.lag + NAME.expected   the messages, exactly as printed
# Files of golden/err whose name begins with `syntax_` (and `include_`) belong to the front end.
#   sh tests/golden/run_syntax.sh [DUMP]   DUMP: the built tests/unit/dump_syntax.c
#   BLESS=1 rewrites the expectations, on purpose.
. tests/tap.sh
dump=${1:-${BIN:-build/test/bin}/dump_syntax}
for lag in tests/golden/ast/*.lag tests/golden/err/syntax_*.lag tests/golden/err/include_*.lag; do
  case $lag in tests/golden/ast/*) status=0 ;; *) status=1 ;; esac
  golden "$lag" "${lag%.lag}.expected" "$status" "$dump" "$lag"
done
tap_end
