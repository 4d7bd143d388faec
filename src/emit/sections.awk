# Text of emitted headers as C, from a .in file: a constant for each of its sections, which begins with a comment
# `---- NAME ----`. A line takes part in all headers, or has a mark and `|` before it (header_impl.h: header_template);
# in a section `NAME: as it stands` lines have no marks.
/^\/\* ---- / {
  if (name) print "  \"\";"
  name = $3
  plain = sub(/:$/, "", name)
  comment = !/\*\/$/
  print "static const char *const " name " ="
  next
}
comment { comment = !/\*\/$/; next }
{
  if (!plain && $0 !~ /^.\|/) $0 = " |" $0
  gsub(/[\\"]/, "\\\\&")
  print "  \"" $0 "\\n\""
}
END { print "  \"\";" }
