#!/bin/sh
# Every compilation compares its programs with the text. Here wrong rewrites are planted in sym/, and wrong steps after it, one at a time:
# the compiler that results must refuse one of tests/exec/self_check/*.lag with an internal error, and write nothing.
. tests/tap.sh
libs= # what lagc is linked with
grep -q "^ZIP_FOUND := yes" "$BUILD/config.mk" && libs="-lminizip -lz"
grep -q "^XZ_FOUND := yes" "$BUILD/config.mk" && libs="$libs -llzma"

models=$(echo tests/exec/self_check/*.lag models/chain.lag models/turntable.lag models/rattleback.lag models/guiding_centre.lag tests/exec/models/euler_pole.lag)

# The compiler with one file changed: its object stands before the library, so that the library's own is not taken.
build_with() {
  mkdir -p "$TMP/$(dirname "$1")"
  cp "$(dirname "$1")"/*.h "$TMP/$(dirname "$1")/"
  sed "$2" "$1" >"$TMP/$1"
  if cmp -s "$1" "$TMP/$1"; then
    echo "the pattern is not there: $2"
    return 1
  fi
  "${CC%% *}" -std=c11 -w -O1 -D_XOPEN_SOURCE=700 -Isrc -I"$BUILD/gen" -c -o "$TMP/wrong.o" "$TMP/$1" &&
    "${CC%% *}" -o "$TMP/lagc" "$BUILD/obj/src/main.o" "$TMP/wrong.o" "$BUILD/liblagc.a" $libs -lm
}

# caught FILE PATTERN: a compiler with this mistake refuses one of the models.
caught() {
  rm -f "$TMP/lagc" "$TMP/out.c"
  build_with "$1" "$2" || return 1
  for m in $models; do
    timeout 20 "$TMP/lagc" emit "$m" -o "$TMP/out.c" >"$TMP/said" 2>&1
    if grep -q 'internal error: .*\(the text gives .*, the compiled program\|no finite accelerations\)' "$TMP/said"; then
      [ ! -e "$TMP/out.c" ] || echo "it was written all the same"
      [ ! -e "$TMP/out.c" ]
      return
    fi
    rm -f "$TMP/out.c"
  done
  echo "no model shows it; the last said:"
  head -n 5 "$TMP/said"
  return 1
}

for m in $models; do check "agrees: $m" "$LAGC" emit "$m" -o "$TMP/right.c"; done

# Almost singular mass matrices, by Cramer's rule too: the program's error is due to the condition, and no mistake.
agrees() { # agrees TEXT OPTIONS...
  printf 'model m\ncoord x, y\n%s\n' "$1" >"$TMP/bad.lag"
  shift
  "$LAGC" emit "$TMP/bad.lag" "$@" -o "$TMP/right.c"
}
bead="param m = 0.1 > 0, g = 9.81
let z = x^3*y + y^4
kinetic = m/2*(x'^2 + y'^2 + z'^2)
potential = m*g*z
scene s { start x = 40, y = 30, x' = 0.3, y' = -0.7; span 5; output x'', y'' every 0.1 }"
check "steep: outputs of accelerations" agrees "$bead"
check "series of long sums, with several scenes" "$LAGC" build models/kuramoto.lag --method taylor --bytes -o "$TMP/kuramoto"
check "steep: Taylor coefficients" agrees "$bead" --method taylor
check "steep: two catenaries" agrees "param m = 0.1, a = 1, b = 2, g = 9.81
let z = a*cosh(x/a) + b*cosh(y/b)
kinetic = m/2*(x'^2 + y'^2 + z'^2)
potential = m*g*z
scene s { start x = 0.3, y = 0.2 }"
for form in "(y*sinh(x))'" "(y*cosh(x))'" "(cosh(x)*cos(y))'" "(y/x^9)'" "y' + 1e4*(x - y^2)'"; do
  check "steep: $form" agrees "param m = 0.7
lagrangian = m/2*(x'^2 + ($form)^2)
scene s { start x = 1, y = 1 }"
done

# Mistakes in self_check/ are mistakes of the judge: each rule of its partial derivatives is tested, too.
n=0
while IFS='|' read -r file pattern; do
  [ -n "$file" ] || continue
  n=$((n + 1))
  one_of 9 || continue
  check "$n: src/$file: $pattern" caught "src/$file" "$pattern"
done <<'ROWS'
sym/diff.c|s/#define NEG(a) expr_neg(g, a)/#define NEG(a) a/
sym/diff.c|s/#define ONE_LESS(a) expr_sub/#define ONE_LESS(a) expr_add/
sym/diff.c|s/i == 0 ? x : expr_neg(g, y)/i == 0 ? x : y/
sym/canonicalize.c|s/one.number = num_add(one.number,/one.number = num_sub(one.number,/
sym/canonicalize.c|s/return expr_symmetry(op) == ODD ? expr_neg(g, f) : f/return f/
sym/canonicalize.c|s/\[EX_SIGN\] = {ODD/[EX_COS] = {ODD, ONE}, &/
sym/stable_forms.c|s/num_mul(num_int(2), c), product/c, product/
sym/stable_forms.c|s/if (f == EX_SIN) c = num_neg(c);//
sym/stable_forms.c|s/minus = expr_sub(g, ra, b)/minus = expr_sub(g, b, ra)/
sym/addition_theorems.c|s/Frac cos = frac_sub(f, cc, ss)/Frac cos = frac_add(f, cc, ss)/
sym/addition_theorems.c|s/if (k < 0) sum.sin = frac_neg(n->field, sum.sin);//
sym/trig_simplify.c|s/sines \/ 2 % 2 ?/0 ?/
sym/frac.c|s/poly_scale(f->ring, num_int(-1), a.num)/a.num/
sym/frac.c|s/poly_add(r, x, y), .den = den/poly_add(r, x, x), .den = den/
sym/normal_form.c|s/if (expr_op(n->g, e) == EX_COS) return cs.cos;/if (expr_op(n->g, e) == EX_COS) return cs.sin;/
sym/poly.c|s/\*content = num_neg(\*content);.*//
sym/radicals.c|s/num_pow(num_int(prime), num_int(whole),/num_pow(num_int(prime), num_int(whole + 1),/
sym/simplify.c|s/inverse = expr_pow_num(g, common, num_int(-1))/inverse = expr_pow_num(g, common, num_int(1))/
sym/finite_quotients.c|s/num_int(k - out)/num_int(k)/
sym/finite_quotients.c|s/expr_neg(g, expr_arg(g, E, 0))/expr_arg(g, E, 0)/
lower/lower.c|s/IR_ADD : IR_SUB, first, second/IR_SUB : IR_ADD, first, second/
lower/lower.c|s/wanted > 0 || negative ? IR_ADD : IR_SUB/IR_ADD/
model/rotation.c|s/num_int(2), turned\[k\]/num_int(1), turned[k]/
ir/prog.c|s/prog_op(p, IR_SUB, x, ab)/prog_op(p, IR_ADD, x, ab)/
ir/reassociate.c|s/x.minus ? prog_op(b->to, IR_SUB, y.slot, x.slot)/0 ? prog_op(b->to, IR_SUB, y.slot, x.slot)/
model/input_rates.c|s/seed\[m->time\] = expr_int(m->g, 1)/seed[m->time] = expr_int(m->g, 0)/
mech/lagrange.c|s/expr_sub(g, dLdq\[i\], convective\[i\])/expr_add(g, dLdq[i], convective[i])/
lower/gram_schmidt.c|s/Slot f = op(y->l, IR_DIV, product(y, weighted, u), d)/Slot f = op(y->l, IR_DIV, d, product(y, weighted, u))/
mech/lagrange.c|s/= expr_sub(g, Q\[d.at\[i\].index\]/= expr_add(g, Q[d.at[i].index]/
mech/derive_equations.c|s/e->energy = expr_sub(g, moving, l0)/e->energy = expr_add(g, moving, l0)/
mech/constrain.c|s/expr_neg(e->g, rate(e, r\[at\], "_drift"))/rate(e, r[at], "_drift")/
mech/first_order.c|s/H = expr_neg(w->g, still)/H = still/
mech/kinetic_squares.c|s/collect_squares(s, expr_scale(g, p, weight), term)/collect_squares(s, weight, term)/
self_check/tape_partial.c|s/"cos") == 0) return negative(t, product(t, tape_function(t, "sin", a), da));/"cos") == 0) return product(t, tape_function(t, "sin", a), da);/
self_check/tape_partial.c|s/return p->index == ALL ? tape_op(t, TAPE_RATE, r, 0, 0)/return p->index == ALL ? r/
symmetry/charges.c|s/with\[m->energy_sym\] = e->energy_stable/with[m->energy_sym] = m->lagrangian/
model/resolve_name.c|s/strcmp(name, "V") == 0) e = m->potential/strcmp(name, "V") == 0) e = m->kinetic/
model/resolve_name.c|s/expr_diff(b->g, b->m->lagrangian, v)/expr_diff(b->g, b->m->kinetic, v)/
self_check/tape_partial.c|s/level ? known(p, i.a, level - 1) : 0/0/
self_check/tape_partial.c|s/da ? tape_op(t, TAPE_RATE, da, 0, 0) : 0/0/
self_check/tape_partial.c|s/"log") == 0) return quotient/"log") == 0) return product/
self_check/tape_partial.c|s/num_sub(power, num_int(1))/power/
self_check/tape_partial.c|s/return db ? sum(t, base,/return db ? sum(t, 0,/
self_check/tape_partial.c|s/return chosen(t, i.a, db, dc)/return chosen(t, i.a, dc, db)/
self_check/tape_partial.c|s/negative(t, product(t, i.a, db))),/product(t, i.a, db)),/
ROWS

# An exact identity that loses digits near 0 alone, where the text divides by x: sin(u)^2 = (1 - cos(2 u))/2.
half='expr_sub(g, g->one, expr_fn(g, EX_COS, expr_scale(g, num_int(2), expr_arg(g, base, 0))))'
fewer_digits() { build_with "$1" "$2" && "$TMP/lagc" emit tests/exec/self_check/removable.lag -o "$TMP/out.c" 2>&1 | grep 'near a zero of a divisor .* fewer digits than this text'; }
check "a rewrite that cancels near a removable singularity" fewer_digits src/sym/canonicalize.c \
  "s/^  if (num_is_one(e)) return base;/&\\n  if (expr_op(g, base) == EX_SIN \\&\\& num_equal(e, num_int(2))) return expr_scale(g, num_div(num_int(1), num_int(2)), $half);/"
check "and one that simplify refuses" fewer_digits src/sym/simplify.c 's/ && keeps_digits(g, e, .*, e)))/)/'
check "no warning without" sh -c '[ -z "$("$0" emit tests/exec/self_check/removable.lag -o "$1" 2>&1)" ]' "$LAGC" "$TMP/right.c"

# Programs that only `modes` and `lyapunov` need.
linearisation() { build_with "$1" "$2" && ! "$TMP/lagc" modes models/double_pendulum.lag >"$TMP/said" 2>&1 && grep 'internal error: the linearisation: the text gives' "$TMP/said"; }
check "the linearisation" linearisation src/mech/linearise.c 's/expr_sub(e->g, e->f\[i\], inertia\[i\])/expr_add(e->g, e->f[i], inertia[i])/'
check "the columns of its entries" linearisation src/lower/lower_program_set.c 's/((IrEntry){dr.at\[k\].row, dr.at\[k\].col})/((IrEntry){dr.at[k].row, dr.at[k ? k - 1 : 0].col})/'

# Programs of headers.
of_header() { # MODEL WORDS FILE PATTERN
  build_with "$3" "$4" && ! "$TMP/lagc" header "$1" --with all -o "$TMP/out.h" >"$TMP/said" 2>&1 && grep "internal error: $2: the text gives" "$TMP/said" && [ ! -e "$TMP/out.h" ]
}
check "a header's mass matrix" of_header models/double_pendulum.lag 'the mass matrix and the bias' src/lower/lower_programs.c 's/prog_store(l.p, 0, M->col \* e->n + M->row, lower_slot(&l, M->e), name)/prog_store(l.p, 0, M->col * e->n + M->row, lower_slot(\&l, e->mass.at[0].e), name)/'
slow check "its bias" of_header models/double_pendulum.lag 'the mass matrix and the bias' src/lower/lower_program_set.c 's/bias\[i\] = expr_neg(e->g, f\[i\])/bias[i] = f[i]/'
check "the bias with constraints" of_header models/slider_crank.lag 'the mass matrix and the bias' src/mech/linearise.c 's/e->constraints.n ? expr_substitute(e->g, e->f\[i\], with, n, "") : e->f\[i\]/e->Q[i]/'
check "inverse dynamics" of_header models/double_pendulum.lag 'inverse dynamics' src/mech/linearise.c 's/expr_sub(e->g, x\[i\], f\[i\])/expr_add(e->g, x[i], f[i])/'
check "derivatives by inputs" of_header tests/exec/callbacks/driven.lag 'the derivatives by inputs' src/mech/linearise.c 's/by == BY_PARAMS ? m->params.at\[d.at\[k\].index\].place : d.at\[k\].index;/d.at[k].index; if (by == BY_INPUTS) continue;/'
check "derivatives by parameters" of_header models/double_pendulum.lag 'the derivatives by parameters' src/lower/lower_program_set.c 's/vec_push(u->arena, &u->by_params_dr, at);/vec_push(u->arena, \&u->by_params_dr, ((IrEntry){dr.at[0].row, at.col}));/'
check "rows of constraints" of_header models/slider_crank.lag 'the linearisation' src/mech/linearise.c 's/r\[i\] = k->demand\[i\];/r[i] = expr_int(e->g, 0);/'
check "multipliers of a header" of_header models/slider_crank.lag 'the residual of the equation of motion of [a-z]*' src/lower/lower_constraints.c 's/l.multipliers\[k\], e->constraints.of\[k\]->name/l.multipliers[0], e->constraints.of[k]->name/'
check "the linearisation of a flow" of_header models/lorenz.lag 'the linearisation' src/lower/lower_program_set.c 's/((IrEntry){dr.at\[k\].row, dr.at\[k\].col})/((IrEntry){dr.at[k].row, dr.at[k ? k - 1 : 0].col})/'

# Derivatives by the argument of a function are reported as not compared.
printf 'model m\ncoord x\nfunction f(s) = d(s^3, s)\nlagrangian = x'"'"'^2/2 - f(x)\n' >"$TMP/argument.lag"
check "what is not compared is said" sh -c "'$LAGC' check --verbose '$TMP/argument.lag' | grep -q 'not compared: the equations of motion, whose text has \`d\`'"
printf 'model m\ncoord x\nlagrangian = x'"'"'^2/2 - x^2\nscene s { start x = 1; span 1; exact x = cos(sqrt(2)*t); output x, 2*energy, error(x), p_x }\n' >"$TMP/exact.lag"
check "outputs that are not" sh -c "'$LAGC' check --verbose '$TMP/exact.lag' | grep -q '^  not compared: the outputs error(x)\$'"

# Correct programs that were once refused: columns beside one of their own components; 1 - tanh(x)^2 far out, which rounding makes 0;
# 0 times an undefined value.
right() { # TEXT: agrees, and its outputs are compared
  printf '%s\n' "$1" >"$TMP/right.lag"
  "$LAGC" check --verbose "$TMP/right.lag" >"$TMP/said" 2>&1 && grep '^compared' "$TMP/said" && ! grep 'not compared\|no state allowed a comparison' "$TMP/said"
}
free="model m
coord r: vec2, x, y, th[2]
lagrangian = (dot(r', r') + x'^2 + y'^2 + th[1]'^2 + th[2]'^2)/2 - x^2/2"
check "a vector behind its component" right "$free
scene s { start r = (1, 2); output r.x, r every 0.1 }"
for of in "tanh(x)'" "d(tanh(x), x)" "d(d(tanh(x), x), x)" "d((1 + tanh(30*x))/2, x)" "d(tanh(100*x)^2, x)"; do
  check "far out: $of" right "$free
scene s { start x = 40; output $of every 0.1 }"
done
check "a flow of tanh'" right "$free
state q
flow q' = d(tanh(100*x), x)
scene s { start x = 1; output q every 0.1 }"
for of in "if(x > 0.5, 1, 0)*sqrt(1 - y^2)" "max(1 - y, 0)*sqrt(1 - y)" "max(1 - y^2, 0)*log(1 - y^2)" "(sign(x) + 1)*log(y)" "d(asin(min(x^2, 5*y)), x)"; do
  check "0 times nothing: $of" right "$free
scene s { start x = 0.3; output $of every 0.1 }"
done
check "0 times nothing, in a force" right "$free
force x = if(abs(y) < 1, 1, 0)*sqrt(1 - y^2)
scene s { start x = 0.3; output x every 0.1 }"
check "functions of one's own" right "$free
function cube(s) = s^3
scene s { start x = 1; output cube(cube(x) + y)*cube(x) every 0.1 }"
check "a let that is called as a function is" right "$free
let sin = x^2
scene s { start x = 0.3; output sin(x)*sin every 0.1 }"

# An output that rounding decides leaves the others compared; so do the members of a family that is named as a whole.
count() { printf '%s\n' "$1" >"$TMP/count.lag"; "$LAGC" check --verbose "$TMP/count.lag" 2>&1 | sed -n 's/^compared.*: \([0-9]*\) values.*/\1/p'; }
few=$(count "$free
scene s { start x = 1; output x^2*y, energy every 0.1 }")
check "values are counted" [ "$few" -gt 10 ]
is "beside what rounding decides" "$few" "$(count "$free
scene s { start x = 1; output x^2*y, max(x*y, y*x), sign(x - 3*x/3), energy every 0.1 }")"
is "a value that is zero is compared" "$(count "$free
scene s { start x = 1; output y every 0.1 }")" "$(count "$free
scene s { start x = 1; output y - y every 0.1 }")"
family="$free
for i in 1..2 { observe s[i] = sin(th[i])*energy }
let q[i in 1..2] = th[i]^2*r"
is "members of families" "$(count "$family
scene s { start x = 1; output s[1], s[2], q[1], q[2], th[1]', th[2]' every 0.1 }")" "$(count "$family
scene s { start x = 1; output s, q, th' every 0.1 }")"
tap_end
