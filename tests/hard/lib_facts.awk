# cases.json, unused.txt, expected.txt -> what differs: a value that is no reference value of its case, a tolerance that is not the one the case states, a
# reference value that stands neither in expected.txt nor in unused.txt. cases.json has a member a line; its depth is its indentation.
function trim(s) { gsub(/^ *"?|"?,?$/, "", s); return s }

FILENAME ~ /unused/ { if (split($0, part, " [|] ") == 3) excused[part[1], part[2]] = 1; next }
FILENAME ~ /json$/ {
  match($0, /^ */)
  depth = RLENGTH
  key = ""
  value = $0
  if (match($0, /^ *"[^"]*": /)) {
    key = substr($0, depth + 2, RLENGTH - depth - 4)
    value = substr($0, RLENGTH + 1)
  }
  value = trim(value)
  for (d in path) if (d + 0 >= depth) delete path[d]
  path[depth] = key
  if (depth == 3 && key == "id") id = value
  if (depth >= 4 && path[3] == "reference" && value !~ /^[]{}[]*$/) {
    leaf[id, value] = leaf[id, value] "|" path[4]
    name[id, value] = key
  }
  if (path[3] == "check" && path[4] == "abs_tol_max_norm_of_state" && depth == 5) stated[id, key] = value
  else if (path[3] == "initial_state" && depth == 4 && key == "theta") first[id] = value
  else if (path[3] == "check" && depth == 4) text[id] = text[id] " " value
  next
}

# The number that a text states, as it is written.
function states(id, number,    n, i, words) {
  n = split(text[id], words, /[^-+0-9.eE]+/)
  for (i = 1; i <= n; i++) if (words[i] ~ /^[0-9]/ && words[i] + 0 == number + 0) return 1
  return 0
}
# A tolerance that is relative: to the first angle, to the energy, to the value; the number in the text that makes it.
function relative(    scale, n, i, words) {
  if (text[$1] ~ /to 6 digits/ && $4 == "energy") return is(1e-6*$5)
  scale = text[$1] ~ /theta RELATIVE to theta0/ && $4 != "c_energy" ? first[$1] : $5
  n = split(text[$1] ~ /RELATIVE|relative/ ? text[$1] : "", words, /[^-+0-9.eE]+/)
  for (i = 1; i <= n; i++) if (words[i] ~ /^[0-9]/ && is(words[i]*scale)) return 1
  return 0
}
# Written to two digits or more.
function is(x) { return $6 > 0.97*x && $6 < 1.03*x }
function complain(what) { print "line " FNR ": " $0 ": " what }

# What is no output of the scene.
function of_run() { return $4 ~ /^(energy|residual|drift|growth)$/ }

# Of the places where the value stands, the one of the line's time; else the first.
function place(of,    n, i, labels) {
  n = (of, $5) in leaf ? split(substr(leaf[of, $5], 2), labels, "|") : 0
  for (i = 1; i <= n; i++) if (labels[i] ~ /^t=[0-9.]+$/ && substr(labels[i], 3) + 0 == $3 + 0) return labels[i]
  return n ? labels[1] : $3 ~ /^[0-9]/ ? "t=" $3 + 0 : ""
}

{
  of = $1 == "trap-redundant-pendulum" && $4 != "residual" ? "mbs-a01-pendulum" : $1
  label = place(of)
  used[of, $5] = 1
  if (!((of, $5) in leaf) && !(($1, $4) in excused) && !of_run() && !states($1, $5)) complain("no reference value of " of)
  if (((of, $5) in leaf) && label ~ /^t=[0-9.]+$/ && $3 ~ /^[0-9]/ && substr(label, 3) + 0 != $3 + 0) complain("the value is that of " label)
  if ($6 ~ /^quad:/) {
    if (stated[$1, label] !~ /not reachable in double/) complain("doubles reach it: " stated[$1, label])
  } else if (of_run()) {
    if (!states($1, $6) && !relative()) complain("no such tolerance: " text[$1])
  } else if (($1, label) in stated && name[of, $5] != "rod_tension") {
    if (stated[$1, label] + 0 != $6 + 0) complain("the tolerance is " stated[$1, label])
  } else if (!states($1, $6) && !relative()) {
    complain("no such tolerance: " text[$1])
  }
}

END {
  for (k in leaf) {
    split(k, part, SUBSEP)
    fine = k in used
    n = split(substr(leaf[k], 2), labels, "|")
    for (i = 1; i <= n; i++) if ((part[1], labels[i]) in excused) fine = 1
    if (!fine) print part[1] " | " leaf[k] " | " name[k] " stands in no line of expected.txt"
  }
}
