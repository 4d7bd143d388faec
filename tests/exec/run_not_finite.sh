#!/bin/sh
# A value that is not finite is reported as such, with equation, time and state, and not as a singular mass matrix; a singular mass matrix is
# reported with its condition. Each model ends where its comment says.
. tests/tap.sh

model() { # model NAME KINETIC START [MORE]
  printf 'model %s\ncoord x, y, z\nparam m = 1 > 0\nkinetic = %s\npotential = -x\n%s\nscene s { start %s; span 10; output x }\n' "$1" "$2" "${4:-}" "$3" >"$TMP/$1.lag"
}
ends() { # ends MODEL METHOD WORDS...: status 3, all of the words are printed, and a singular matrix is not mentioned if "finite" is among them
  "$LAGC" run "$TMP/$1.lag" --method "$2" >"$TMP/out" 2>&1
  [ $? = 3 ] || { cat "$TMP/out"; return 1; }
  cat "$TMP/out"
  shift 2
  for words; do
    grep -qF -e "$words" "$TMP/out" || { echo "does not say: $words"; return 1; }
    case $words in *finite*) ! grep -q 'singular,' "$TMP/out" || return 1 ;; esac
  done
}

# sqrt and log of 1 - x have no value from x = 1 on: M in a definite one that is eliminated, one that is solved by pivoting, one with redundant constraints.
model definite "m/2*(x'^2 + (x' + y')^2*(2 + sqrt(1 - x)) + z'^2 + (y' + z')^2)" "x' = 1"
model pivoting "m/4*(x'^2 + y'^2 + z'^2) + 0.1*x'*y'*z + 0.02*log(1 - x)*z'*y' + 0.3*x'*z'" "x = 0.2, x' = 5"
model redundant "m/2*(x'^2 + y'^2 + z'^2*(2 + sqrt(1 - x)))" "x' = 5" "constraint a: y = 2*x
constraint b: 3*y = 6*x"
for name in definite pivoting redundant; do
  check "no number, and not singular: $name" ends $name rk4 "gives no finite value for x'" "last good state, t = "
done

# The expression of the text: its line and column, its arguments, and the state.
places() { # places METHOD LINE:COLUMN WHAT STATE <MODEL
  cat >"$TMP/place.lag"
  "$LAGC" run "$TMP/place.lag" --method $1 >"$TMP/out" 2>"$TMP/err"
  [ $? = 3 ] && grep -q "place.lag:$2: note: the run ends here, where $3" "$TMP/err" && grep -q "= at $4" "$TMP/err" || { cat "$TMP/out" "$TMP/err"; return 1; }
}
for method in dop853 taylor radau 'rk4 --step 0.01'; do
check "sqrt in a force, by $method" places "$method" 4:16 'this expression has no finite value at -[0-9.e-]*$' "x = 0.19" <<'EOF'
model m
coord x
kinetic = x'^2/2
force x = -3 - sqrt(x - 0.2)
scene s { start x = 1; span 10; output x }
EOF
done
check "in a function, which an effect asks for" places dop853 3:35 'this expression has no finite value at -[0-9.e-]*$' "x = 0.39" <<'EOF'
model m
coord x
function height(u) = 2 + 1/4 + 3* log(2*u - 0.8)
kinetic = x'^2/2
effect fall { force x = -1 - 1e-9*height(x) }
scene s { start x = 1; span 10; use fall; output x }
EOF
check "a division, in a family" places 'rk4 --step 0.01' 4:46 'this expression has no finite value: 1 divided by 0$' "x\[1\] = 1, x\[1\]' = -1, x\[2\] = 0" <<'EOF'
model m
coord x[2]
kinetic = sum(i in 1..2, x[i]'^2)/2
potential = sum(i in 1..2, 1e-30*(x[i]^2 +   1/x[i]))
scene s { start x[1] = 1, x[1]' = -1, x[2] = 0; span 1; output x[1] }
EOF
check "derivatives alone" places 'rk4 --step 0.01' 3:31 'the derivatives of this expression have no finite value at 0$' "x = 0" <<'EOF'
model m
coord x, y
lagrangian = x'^2/2 + y'^2/2 -sqrt(x) - y
scene s { start x = 0; span 1; output x }
EOF
check "a flow" places dop853 3:16 'this expression has no finite value at -[0-9.e-]*$' "z = 0.4" <<'EOF'
model m
state z
flow z' = -1 - sqrt(z - 0.5)
scene s { start z = 1; span 10; output z }
EOF
check "and no process is left" sh -c "sleep 0.2; ! ps -ef | grep -v grep | grep -q '$TMP/place.lag'"

# Singular where x = 0, and near it.
model start "m/2*(x'^2*x^2 + y'^2 + z'^2)" "x = 0"
model reached "m/2*(x'^2*x^2 + y'^2 + z'^2)" "x = -1"
check "singular at the start, with its condition" ends start dop853 "the mass matrix is singular" "the condition of that is above 1e+15" "by the inertia of x"
check "steps that shrink before it say why" ends reached dop853 "the step became too small" "the condition of the mass matrix is " "by the inertia of x"

# A value that the motion does not need: the energy, an output. cosh(x) overflows beyond 710.47.
lacks() { # WORDS WORDS <MODEL: a run that goes on; its report and the note have these words
  cat >"$TMP/lacks.lag"
  "$LAGC" run "$TMP/lacks.lag" -o "$TMP/lacks.csv" >"$TMP/out" 2>&1 && cat "$TMP/out" && grep -q -e "$1" "$TMP/out" && grep -q -e "$2" "$TMP/out"
}
check "the energy: expression and state" lacks "^energy: not finite at t = 1 s: x = 899.9, x' = " 'lacks.lag:4:17: note: this expression has no finite value at 899.9' <<'EOF'
model m
coord x
kinetic = x'^2/2
potential = log(cosh(x))
scene s { start x = 900.4; span 1; output x }
EOF
check "an output: expression and state" lacks '^note: the output w has no finite value at t = 1.05 s' 'lacks.lag:4:17: note: this expression has no finite value at 710.5' <<'EOF'
model m
coord x
kinetic = x'^2/2
observe w = log(cosh(x))
scene s { start x = 700, x' = 10; span 2; output x, w every 0.05 }
EOF
tap_end
