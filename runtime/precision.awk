# Translates a C source of the runtime to another scalar: `double` becomes LAG_REAL, and with it change
#   numbers           0.1 is 0.1L or 0.1Q, so that coefficients keep all the digits that they are written with
#   functions         sqrt is sqrtl or sqrtq, strtod strtold or strtoflt128
#   limits            DBL_EPSILON is LDBL_EPSILON or FLT128_EPSILON
#   formats           %g is %Lg or %Qg (a modifier that libquadmath teaches printf), %.17g has all digits, %.15g all significant ones
# Comments stay, and so does a line that says `(as it stands)`. Use:
# awk -v kind=long|quad -v digits=N -f runtime/precision.awk FILE, N the digits with which a number reads back unchanged.
BEGIN {
  suffix = kind == "quad" ? "Q" : "L"
  limits = kind == "quad" ? "FLT128_" : "LDBL_"
  n = split("acos acosh asin asinh atan atan2 atanh cbrt ceil copysign cos cosh erfc exp exp2 expm1 fabs floor fma fmax fmin fmod " \
            "frexp hypot ilogb ldexp llround log log10 log1p log2 logb lrint lround nearbyint nextafter pow remainder rint round scalbn sin sinh sqrt tan tgamma " \
            "tanh trunc", names, " ")
  for (i = 1; i <= n; i++) renamed[names[i]] = names[i] (kind == "quad" ? "q" : "l")
  renamed["strtod"] = kind == "quad" ? "strtoflt128" : "strtold"
  renamed["double"] = "LAG_REAL"
  n = split("EPSILON MIN MAX DIG MANT_DIG MAX_EXP MIN_EXP", names, " ")
  for (i = 1; i <= n; i++) renamed["DBL_" names[i]] = limits names[i]
}

# Conversions in a string.
function formats(s,    out, c) {
  out = ""
  while (match(s, /%[-+#0]*[0-9*]*(\.[0-9*]+)?[aefgAEFG%]/)) {
    c = substr(s, RSTART, RLENGTH)
    if (c !~ /%$/) {
      sub(/\.17/, "." digits, c)
      sub(/\.15/, "." (digits - 3), c)
      c = substr(c, 1, length(c) - 1) suffix substr(c, length(c))
    }
    out = out substr(s, 1, RSTART - 1) c
    s = substr(s, RSTART + RLENGTH)
  }
  return out s
}

/\(as it stands\)/ { print; next }

{
  rest = $0
  out = ""
  while (rest != "") {
    if (comment) {
      i = index(rest, "*/")
      out = out (i ? substr(rest, 1, i + 1) : rest)
      rest = i ? substr(rest, i + 2) : ""
      comment = !i
    } else if (match(rest, /^"([^"\\]|\\.)*"/)) {
      text = substr(rest, 1, RLENGTH)
      rest = substr(rest, RLENGTH + 1)
      out = out ($0 ~ /^[ \t]*#/ ? text : formats(text))
    } else if (match(rest, /^'([^'\\]|\\.)+'/)) {
      out = out substr(rest, 1, RLENGTH)
      rest = substr(rest, RLENGTH + 1)
    } else if (substr(rest, 1, 2) == "/*") {
      comment = 1
      out = out "/*"
      rest = substr(rest, 3)
    } else if (match(rest, /^[A-Za-z_][A-Za-z_0-9]*/)) {
      word = substr(rest, 1, RLENGTH)
      out = out (word in renamed ? renamed[word] : word)
      rest = substr(rest, RLENGTH + 1)
    } else if (match(rest, /^(0[xX][0-9a-fA-F]*\.?[0-9a-fA-F]*[pP][-+]?[0-9]+|[0-9]+\.[0-9]*([eE][-+]?[0-9]+)?|\.[0-9]+([eE][-+]?[0-9]+)?|[0-9]+[eE][-+]?[0-9]+)/)) {
      out = out substr(rest, 1, RLENGTH) suffix
      rest = substr(rest, RLENGTH + 1)
    } else if (match(rest, /^(0[xX][0-9a-fA-F]+|[0-9]+)[uUlL]*/)) {
      out = out substr(rest, 1, RLENGTH)
      rest = substr(rest, RLENGTH + 1)
    } else {
      out = out substr(rest, 1, 1)
      rest = substr(rest, 2)
    }
  }
  print out
}
