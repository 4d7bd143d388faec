/* Recognises generators' coefficients: the numbers that an entry of a table has at several choices of parameters become an expression of these. */
#include <math.h>

#include "symmetry/find_symmetries_impl.h"

GeneratorTable generator_table_at(SymmetrySearch *s, const Family *f, uint32_t choice) {
  uint32_t shown = s->ansatz->shown;
  if (f->kind == TIME_LISTED) {
    int sure;
    GeneratorTable t = table_listed(s->scratch, s->ansatz, &f->times, s->choices.at[choice], &sure);
    return sure ? t : (GeneratorTable){0};
  }
  const SolutionSpace *space = noether_space_at(s, choice);
  if (!space->sure) return (GeneratorTable){0};
  return f->kind == TIME_POWERS ? table_powers(s->scratch, space, shown) : table_periodic(s->scratch, space, shown, f->rate2[choice]);
}

/* Whether the tables at all choices, made here where missing, have one shape. */
static int shapes_agree(SymmetrySearch *s, FamilyTables *t) {
  int agree = 1;
  for (uint32_t i = CHOICE_MOVED; i < noether_choices(s) && !t->moved; i++) {
    t->at[i] = generator_table_at(s, t->family, i);
    for (uint32_t k = 0; k < t->changes.n && table_same_shape(&t->at[0], &t->at[i]); k++) agree = table_change(s->scratch, &t->at[i], t->changes.at[k]) && agree;
  }
  t->moved = 1;
  for (uint32_t i = CHOICE_SECOND; i < noether_choices(s); i++) agree = agree && table_same_shape(&t->at[0], &t->at[i]);
  return agree;
}

/* Expression of the entry at `row` and `place`, with the moved choices if `moved`; 0: not recognised. */
static Expr coefficient(SymmetrySearch *s, FamilyTables *t, uint32_t row, size_t place, int moved) {
  size_t at = (size_t)row * t->at[0].blocks * t->at[0].shown + place;
  long double *x = ARENA_ARRAY(s->scratch, long double, noether_choices(s));
  Expr rate = t->family->rate;
  Num c;
  for (uint32_t i = 0; i < CHOICE_MOVED; i++) x[i] = t->at[i].at[at];
  if (x[CHOICE_FIRST] == 0 && x[CHOICE_SECOND] == 0) return expr_int(s->g, 0);
  if (recognise_same(x, &c)) return expr_num(s->g, c);
  Expr ratio = recognise_ratio(&s->choices, x);
  if (!ratio) ratio = recognise_with_rates(&s->choices, x, &rate, rate != 0);
  if (ratio || !moved) return ratio;
  for (uint32_t i = CHOICE_MOVED; i < noether_choices(s); i++) x[i] = t->at[i].at[at];
  return recognise_monomial(&s->choices, x);
}

/* Expressions of all entries of a row; 0: one is not recognised. */
static int row_coefficients(SymmetrySearch *s, FamilyTables *t, uint32_t row, int moved, Expr *c) {
  for (size_t k = 0; k < (size_t)t->at[0].blocks * t->at[0].shown; k++)
    if (!(c[k] = coefficient(s, t, row, k, moved))) return 0;
  return 1;
}

/* Expressions of the row after shortening, which replaces it if they are recognised. */
static int shorter_coefficients(SymmetrySearch *s, FamilyTables *t, uint32_t row, int moved, Expr *c) {
  uint32_t n = t->moved && shapes_agree(s, t) ? noether_choices(s) : CHOICE_MOVED, width = t->at[0].blocks * t->at[0].shown;
  long double *kept = ARENA_ARRAY(s->scratch, long double, (size_t)n * width);
  RowChange changes[CHANGES_MOST];
  for (uint32_t i = 0; i < n; i++) memcpy(kept + (size_t)i * width, t->at[i].at + (size_t)row * width, width * sizeof *kept);
  uint32_t count = table_shorten(s->scratch, &t->at[0], row, changes);
  int found = count > 0;
  for (uint32_t i = CHOICE_SECOND; i < n; i++)
    for (uint32_t k = 0; k < count && found; k++) found = table_same_shape(&t->at[0], &t->at[i]) && table_change(s->scratch, &t->at[i], changes[k]);
  found = found && row_coefficients(s, t, row, moved, c);
  for (uint32_t i = 0; i < n && !found; i++) memcpy(t->at[i].at + (size_t)row * width, kept + (size_t)i * width, width * sizeof *kept);
  for (uint32_t k = 0; k < count && found; k++) vec_push(s->scratch, &t->changes, changes[k]);
  return found;
}

/* Expressions of the row times `scale` as sums of parameters; 0: one is none. */
static int linear_coefficients(SymmetrySearch *s, const FamilyTables *t, uint32_t row, Expr scale, Expr *c) {
  uint32_t n = t->at[0].blocks * t->at[0].shown, count = noether_choices(s);
  long double *x = ARENA_ARRAY(s->scratch, long double, count);
  for (uint32_t k = 0; k < n; k++) {
    for (uint32_t i = 0; i < count; i++) x[i] = t->at[i].at[(size_t)row * n + k] * choice_value(&s->choices, i, scale);
    c[k] = x[CHOICE_FIRST] == 0 && x[CHOICE_SECOND] == 0 ? expr_int(s->g, 0) : recognise_linear(&s->choices, x);
    if (!c[k]) return 0;
  }
  return 1;
}

/* The same with each parameter, and each sum of two, as the scale, which m1/(m1 + m2) of two bodies needs. */
static int scaled_coefficients(SymmetrySearch *s, const FamilyTables *t, uint32_t row, Expr *c) {
  enum { PARAMETERS_MOST = 12 };
  ExprGraph *g = s->g;
  if (s->choices.n > PARAMETERS_MOST) return 0;
  for (uint32_t i = 0; i < s->choices.n; i++)
    for (uint32_t k = 0; k <= i; k++) {
      Expr one = expr_symbol(g, s->choices.param[i])->node, other = expr_symbol(g, s->choices.param[k])->node;
      if (linear_coefficients(s, t, row, i == k ? one : expr_add(g, one, other), c)) return 1;
    }
  return 0;
}

/* Cheap ways first: tables at all choices are made last. */
int noether_recognise(SymmetrySearch *s, FamilyTables *t, uint32_t row, Expr *c) {
  if (row_coefficients(s, t, row, 0, c) || shorter_coefficients(s, t, row, 0, c)) return 1;
  if (!shapes_agree(s, t)) return 0;
  return row_coefficients(s, t, row, 1, c) || shorter_coefficients(s, t, row, 1, c) || scaled_coefficients(s, t, row, c);
}

