/* Rows of tables become generators: the numbers that an entry has at several choices of parameters become an
 * expression of these; then each generator is proved, named and listed. */

#include "symmetry/find_symmetries_impl.h"
#include "symmetry/symmetry_names.h"

/* The tables of a family, one a choice of parameter values; those at CHOICE_MOVED and above are made when needed
 * (moved). changes: how rows were shortened. */
typedef struct {
  const Family *family;
  GeneratorTable *at;
  int moved;
  VEC(RowChange) changes;
} FamilyTables;

/* --- numbers to expressions --- */

/* The table of a family at a choice of parameter values; no rows where the equations could not be solved reliably. */
static GeneratorTable generator_table_at(SymmetrySearch *s, const Family *f, uint32_t choice) {
  uint32_t shown = s->ansatz->shown;
  if (f->kind == TIME_LISTED) {
    int sure;
    GeneratorTable t = table_listed(s->scratch, s->ansatz, &f->times, s->choices.at[choice], &sure);
    return sure ? t : (GeneratorTable){0};
  }
  const SolutionSpace *space = noether_space_at(s, choice);
  if (!space->sure) return (GeneratorTable){0};
  return f->kind == TIME_POWERS ? table_powers(s->scratch, space, shown)
                                : table_periodic(s->scratch, space, shown, f->rate2[choice]);
}

/* Whether the tables at all choices, made here where missing, have one shape. */
static int shapes_agree(SymmetrySearch *s, FamilyTables *t) {
  int agree = 1;
  for (uint32_t i = CHOICE_MOVED; i < noether_choices(s) && !t->moved; i++) {
    t->at[i] = generator_table_at(s, t->family, i);
    for (uint32_t k = 0; k < t->changes.n && table_same_shape(&t->at[0], &t->at[i]); k++)
      agree = table_change(s->scratch, &t->at[i], t->changes.at[k]) && agree;
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
  for (uint32_t i = 0; i < CHOICE_MOVED; i++) x[i] = t->at[i].at[at];
  Expr known = recognise_by_two(&s->choices, x, &rate, rate != 0);
  if (known || !moved) return known;
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
  uint32_t n = t->moved && shapes_agree(s, t) ? noether_choices(s) : CHOICE_MOVED,
           width = t->at[0].blocks * t->at[0].shown;
  long double *kept = ARENA_ARRAY(s->scratch, long double, (size_t)n * width);
  RowChange changes[CHANGES_MOST];
  for (uint32_t i = 0; i < n; i++)
    memcpy(kept + (size_t)i * width, t->at[i].at + (size_t)row * width, width * sizeof *kept);
  uint32_t count = table_shorten(s->scratch, &t->at[0], row, changes);
  int found = count > 0;
  for (uint32_t i = CHOICE_SECOND; i < n; i++)
    for (uint32_t k = 0; k < count && found; k++)
      found = table_same_shape(&t->at[0], &t->at[i]) && table_change(s->scratch, &t->at[i], changes[k]);
  found = found && row_coefficients(s, t, row, moved, c);
  for (uint32_t i = 0; i < n && !found; i++)
    memcpy(t->at[i].at + (size_t)row * width, kept + (size_t)i * width, width * sizeof *kept);
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

/* Coefficients of a row of the table at the first choice, c[blocks*shown]; the row may be shortened. 0: one is not
 * recognised. Cheap ways first: tables at all choices are made last. */
static int recognise_row(SymmetrySearch *s, FamilyTables *t, uint32_t row, Expr *c) {
  if (row_coefficients(s, t, row, 0, c) || shorter_coefficients(s, t, row, 0, c)) return 1;
  if (!shapes_agree(s, t)) return 0;
  return row_coefficients(s, t, row, 1, c) || shorter_coefficients(s, t, row, 1, c) ||
         scaled_coefficients(s, t, row, c);
}

/* --- generators --- */

/* The function of time that a block of a family stands for. */
static Expr time_function(SymmetrySearch *s, const Family *f, uint32_t block) {
  ExprGraph *g = s->g;
  Expr t = expr_symbol(g, s->e->m->time)->node;
  if (f->kind == TIME_LISTED) return f->times.f[block];
  if (f->kind == TIME_POWERS) return expr_pow_num(g, t, num_int(block));
  Expr phase = expr_mul(g, f->rate, t), power = expr_pow_num(g, t, num_int(block / 2));
  if (f->kind == TIME_CIRCULAR) return expr_mul(g, power, expr_fn(g, block % 2 ? EX_SIN : EX_COS, phase));
  return expr_mul(g, power, expr_fn(g, EX_EXP, block % 2 ? expr_neg(g, phase) : phase));
}

/* Scales a row so that its numbers are whole, without a common factor. */
static void clear_fractions(SymmetrySearch *s, Expr *c, size_t n) {
  Num common = num_int(0);
  for (size_t k = 0; k < n; k++) {
    Num number = num_int(1);
    if (expr_is_zero(s->g, c[k])) continue;
    if (expr_is_num(s->g, c[k])) number = expr_number(s->g, c[k]);
    else expr_pair(s->g, c[k], EX_SUM, 0, &number);
    common = num_is_zero(common) ? num_abs(number) : num_gcd(common, number);
  }
  if (num_is_zero(common) || !num_is_exact(common)) return;
  for (size_t k = 0; k < n; k++) c[k] = expr_scale(s->g, num_div(num_int(1), common), c[k]);
}

/* Lowest whole exponent of x in the monomials c; 0: none is negative. */
static int32_t lowest_power(const ExprGraph *g, const Expr *c, size_t n, Expr x) {
  int32_t lowest = 0;
  for (size_t k = 0; k < n; k++) {
    Num number, power;
    Expr term = expr_pair(g, c[k], EX_SUM, 0, &number);
    for (uint32_t i = 0; i < expr_pairs(g, term, EX_PROD); i++)
      if (expr_pair(g, term, EX_PROD, i, &power) == x && num_is_int(power) && power.num < lowest)
        lowest = (int32_t)power.num;
  }
  return lowest;
}

/* Clears parameters from denominators: m1/m2*x1 + x2 becomes m1*x1 + m2*x2. */
static void clear_parameters(SymmetrySearch *s, Expr *c, size_t n) {
  ExprGraph *g = s->g;
  for (uint32_t p = 0; p < s->choices.n; p++) {
    Expr x = expr_symbol(g, s->choices.param[p])->node;
    int32_t lowest = lowest_power(g, c, n, x);
    if (lowest == 0) continue;
    Expr factor = expr_pow_num(g, x, num_int(-lowest));
    for (size_t k = 0; k < n; k++) c[k] = expr_mul(g, c[k], factor);
  }
}

static Expr phi(SymmetrySearch *s, uint32_t k) {
  return k ? expr_symbol(s->g, s->ansatz->q[k - 1])->node : expr_int(s->g, 1);
}

/* xi and *tau from the coefficients c. */
static Expr *components(SymmetrySearch *s, const FamilyTables *t, const Expr *c, Expr *tau) {
  const Ansatz *a = s->ansatz;
  Expr *xi = ARENA_ARRAY(s->e->m->arena, Expr, a->n + 1);
  *tau = expr_int(s->g, 0);
  for (uint32_t i = 0; i < a->n; i++) xi[i] = expr_int(s->g, 0);
  for (uint32_t m = 0; m < t->at[0].blocks; m++, c += a->shown) {
    Expr of_time = time_function(s, t->family, m);
    *tau = expr_add(s->g, *tau, expr_mul(s->g, c[0], of_time));
    for (uint32_t j = 0; j < a->xi.n; j++) {
      if (expr_is_zero(s->g, c[1 + j])) continue;
      Expr term = expr_mul(s->g, c[1 + j], of_time);
      term = expr_mul(s->g, term, phi(s, a->xi.at[j].k));
      xi[a->xi.at[j].i] = expr_add(s->g, xi[a->xi.at[j].i], term);
    }
  }
  return xi;
}

/* Generator from coefficients to->c, cleared of fractions. */
static void make_generator(SymmetrySearch *s, const FamilyTables *t, const CoordinateNames *names, GeneratorRow *to) {
  size_t n = (size_t)t->at[0].blocks * s->ansatz->shown;
  clear_parameters(s, to->c, n);
  clear_fractions(s, to->c, n);
  to->ansatz = s->ansatz;
  to->kind = t->family->kind;
  to->blocks = t->at[0].blocks;
  orient_generator(names, to);
  to->by.xi = components(s, t, to->c, &to->by.tau);
}

/* Whether the verdict counts as proved. Contacts are open at random states, so that their constraints do not matter. */
static int is_proved(const SymmetrySearch *s, const Noether *is) {
  return (is->is == INVARIANT || is->is == INVARIANT_UP_TO_F) && !is->broken &&
         (!is->by_value || s->ansatz->held.n == 0);
}

/* Lists a row with recognised coefficients, if it is proved. */
static int add_row(SymmetrySearch *s, const FamilyTables *t, Expr *c) {
  GeneratorRow r = {.c = c};
  CoordinateNames names = coordinate_names(s->e);
  make_generator(s, t, &names, &r);
  FoundSymmetry found = {.is = noether_prove(s->e, &r.by), .by = r.by, .rate = t->family->rate};
  if (!is_proved(s, &found.is)) return 0;
  name_symmetry(&names, &r, &found);
  vec_push(s->e->m->arena, &s->out->all, found);
  return 1;
}

/* Adds a row to the listed ones; 0: it depends on them linearly. */
static int add_independent(DenseRows *listed, const long double *row) {
  long double *kept = listed->at + (size_t)listed->n * listed->width;
  memcpy(kept, row, listed->width * sizeof *kept);
  if (dense_gram_schmidt(listed->width, kept, listed->at, listed->n) < 1e-6L) return 0;
  listed->n++;
  return 1;
}

int noether_add_family(SymmetrySearch *s, const Family *f) {
  FamilyTables t = {.family = f, .at = ARENA_ARRAY(s->scratch, GeneratorTable, noether_choices(s))};
  for (uint32_t i = 0; i < CHOICE_MOVED; i++) t.at[i] = generator_table_at(s, f, i);
  for (uint32_t i = 0; i < CHOICE_MOVED; i++)
    if (f->kind == TIME_LISTED && !t.at[i].shown) return 0; /* rounding decides at these values */
  uint32_t width = t.at[0].blocks * t.at[0].shown, rows = t.at[0].rows;
  DenseRows listed = {.width = width, .at = ARENA_ARRAY(s->scratch, long double, (size_t)(rows + 1) * width + 1)};
  int agree = table_same_shape(&t.at[0], &t.at[1]);
  for (uint32_t row = 0; agree && row < rows && listed.n < rows && search_goes_on(s->limit, 0); row++) {
    Expr *c = ARENA_ARRAY(s->scratch, Expr, width + 1);
    const long double *values = t.at[0].at + (size_t)row * width;
    if (!recognise_row(s, &t, row, c) || !add_independent(&listed, values)) continue;
    if (!add_row(s, &t, c)) listed.n--;
  }
  s->out->unproved += rows - listed.n;
  return t.at[0].shown != 0;
}
