# Text of emitted headers as C, from a .in file: a constant for each of its sections, which begins with a comment
# `---- NAME ----`. A line takes part in all headers, or has a mark and `|` before it (header_impl.h: header_template);
# in a section `NAME: as it stands` lines have no marks. `<<NAME` is a section before.
/^\/\* ---- / {
  if (name) print "  \"\";"
  name = $3
  plain = sub(/:$/, "", name)
  comment = !/\*\/$/
  print "static const char *const " name " ="
  next
}
comment { comment = !/\*\/$/; next }
/^<</ { printf "%s", text[substr($0, 3)]; next }
{
  if (!plain && $0 !~ /^.\|/) $0 = " |" $0
  gsub(/[\\"]/, "\\\\&")
  text[name] = text[name] "  \"" $0 "\\n\"\n"
  print "  \"" $0 "\\n\""
}
END { print "  \"\";" }
