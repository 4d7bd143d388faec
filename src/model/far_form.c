/* Terms of a sum by a tree: factor*c_i*c_j/sqrt(d^2 + soft), of two bodies whose places are coordinates.
 *
 * In: the term for the first pair, in canonical form. Out: its parts, or a message with the first that does not fit. */
#include <string.h>

#include "model/quantified_sum.h"
#include "sym/diff.h"
#include "sym/prove.h"
#include "sym/sum_nest.h"

typedef struct {
  Eval *ev;
  const struct Quantified *q;
  ExprGraph *g;
  FarForm form;
  Expr charge_j, square; /* square: d^2 + soft */
  const char *why;
} Far;

#define OTHER_DISTANCE "the distance is not the root of the squares of differences of coordinates"

enum { OF_I = 1, OF_J = 2, OF_MOTION = 4 };

/* Whether a symbol is of body i or j, or moves. */
static unsigned part_of(const Far *f, const Symbol *s) {
  const unsigned motion = 1u << SYM_COORD | 1u << SYM_VEL | 1u << SYM_STATE | 1u << SYM_RATE;
  int64_t part;
  const Read *r = quantified_read_of(f->q, s, &part);
  unsigned of = motion & 1u << s->kind ? OF_MOTION : 0;
  if (s->kind == SYM_LOCAL) return of | (s->name == f->q->i ? OF_I : OF_J);
  for (uint32_t k = 0; r && k < r->e->ndims; k++) of |= (r->at[k].by_i ? OF_I : 0) | (r->at[k].by_j ? OF_J : 0);
  return of;
}

static unsigned parts_of(const Far *f, Expr e) {
  unsigned of = 0;
  ExprList l = expr_topo(f->g, &e, 1);
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(f->g, l.at[k]) == EX_SYM) of |= part_of(f, expr_sym_of(f->g, l.at[k]));
  return of;
}

/* The symbol that the other body has in the place of this one. */
static Expr swapped_symbol(const Far *f, Expr e) {
  const Symbol *s = expr_sym_of(f->g, e);
  int64_t part;
  const Read *r = quantified_read_of(f->q, s, &part);
  if (s->kind == SYM_LOCAL) return expr_named_symbol(f->g, s->name == f->q->i ? f->q->j : f->q->i);
  if (!r) return e;
  Read other = *r;
  for (uint32_t k = 0; k < r->e->ndims; k++)
    other.at[k].by_i = r->at[k].by_j, other.at[k].by_j = r->at[k].by_i;
  return expr_symbol(f->g, quantified_symbol(f->ev->b->m, f->q, &other, part))->node;
}

static Expr swapped(const Far *f, Expr e) {
  ExprMap m = expr_map(f->ev->b->arena);
  ExprList l = expr_topo(f->g, &e, 1);
  for (uint32_t k = 0; k < l.n; k++)
    if (expr_op(f->g, l.at[k]) == EX_SYM) expr_map_set(&m, l.at[k], swapped_symbol(f, l.at[k]));
  return expr_replace_by(f->g, e, &m);
}

static int no(Far *f, const char *why) {
  if (!f->why) f->why = why;
  return 0;
}

/* Square of a length: of hypot(a, b) the sum of both squares. */
static Expr square_of(ExprGraph *g, Expr e) {
  if (expr_op(g, e) != EX_HYPOT) return expr_pow_num(g, e, num_int(2));
  Expr a = square_of(g, expr_arg(g, e, 0)), b = square_of(g, expr_arg(g, e, 1));
  return expr_add(g, a, b);
}

/* Takes base^exponent, a factor that moves: 1/sqrt(square). */
static int take_root(Far *f, Expr base, Num exponent) {
  int half = num_equal(exponent, num_ratio(-1, 2)), whole = num_equal(exponent, num_int(-1));
  if (f->square || (!half && !(whole && expr_op(f->g, base) == EX_HYPOT)))
    return no(f, "its terms contain the places in another way than 1/distance");
  f->square = half ? base : square_of(f->g, base);
  return 1;
}

static int take_factor(Far *f, Expr base, Num exponent) {
  ExprGraph *g = f->g;
  unsigned of = parts_of(f, base);
  if (of & OF_MOTION) return take_root(f, base, exponent);
  if ((of & OF_I) && (of & OF_J)) return no(f, "a factor of its terms does not split in one for each body");
  Expr *to = of & OF_I ? &f->form.charge : of & OF_J ? &f->charge_j : &f->form.factor;
  Expr factor = expr_pow_num(g, base, exponent);
  *to = expr_mul(g, *to, factor);
  return 1;
}

static int split_term(Far *f, Expr term) {
  ExprGraph *g = f->g;
  Num c = num_int(1);
  if (expr_op(g, term) == EX_SUM && expr_pairs(g, term, EX_SUM) > 1)
    return no(f, "its terms are sums: a tree takes one term, and other sums stand beside it");
  Expr product = expr_op(g, term) == EX_SUM ? expr_pair(g, term, EX_SUM, 0, &c) : term;
  f->form.charge = f->charge_j = expr_int(g, 1);
  f->form.factor = expr_num(g, c);
  for (ExprPair base = {0}; expr_next_pair(g, product, EX_PROD, &base);)
    if (!take_factor(f, base.of, base.num)) return 0;
  if (!f->square) return no(f, "its terms do not contain the places of two bodies");
  return swapped(f, f->form.charge) == f->charge_j || no(f, "the factors of both bodies differ");
}

/* The square is scale*distance + rest. */
static int scale_distance(Far *f, Expr distance, Expr rest) {
  ExprGraph *g = f->g;
  SymId x = f->form.n ? expr_sym_id(g, f->form.at_i[0]) : 0;
  Expr slope = f->form.n ? expr_diff(g, f->square, x) : 0, twice = slope ? expr_diff(g, slope, x) : 0;
  Expr scale = twice ? expr_scale(g, num_ratio(1, 2), twice) : 0;
  if (parts_of(f, rest)) return no(f, "the softening differs from pair to pair");
  if (!scale || parts_of(f, scale)) return no(f, OTHER_DISTANCE);
  Expr part = expr_mul(g, scale, distance), sum = expr_add(g, part, rest), gap = expr_sub(g, f->square, sum);
  if (!expr_is_zero(g, gap) && prove_zero(g, gap, NULL) != PROVED_ZERO) return no(f, OTHER_DISTANCE);
  f->form.soft = expr_div(g, rest, scale);
  Expr root = expr_pow_num(g, scale, num_ratio(-1, 2));
  f->form.factor = expr_mul(g, f->form.factor, root);
  return 1;
}

/* Takes the coordinates below the root: those of i, less those of j, squared, are d^2. */
static int find_places(Far *f) {
  ExprGraph *g = f->g;
  ExprList l = expr_topo(g, &f->square, 1);
  Expr distance = expr_int(g, 0), zero = distance, rest = f->square;
  for (uint32_t k = 0; k < l.n; k++) {
    unsigned of = expr_op(g, l.at[k]) == EX_SYM ? part_of(f, expr_sym_of(g, l.at[k])) : 0;
    if (!(of & OF_MOTION)) continue;
    if (expr_sym_of(g, l.at[k])->kind != SYM_COORD || !(of & (OF_I | OF_J)))
      return no(f, "the distance is not that of two bodies");
    expr_replace_nodes(g, &rest, 1, &l.at[k], &zero, 1, &rest);
    if (of & OF_J) continue;
    if (f->form.n == 3) return no(f, "a place has at most three coordinates");
    Expr other = swapped_symbol(f, l.at[k]), d = expr_sub(g, l.at[k], other);
    f->form.at_i[f->form.n] = l.at[k];
    f->form.at_j[f->form.n++] = other;
    Expr d2 = expr_pow_num(g, d, num_int(2));
    distance = expr_add(g, distance, d2);
  }
  return scale_distance(f, distance, rest);
}

/* All pairs of consecutive bodies: j in a..i-1, or in i+1..b. */
static int find_members(Far *f) {
  const struct Quantified *q = f->q;
  int below = !q->from.by_i && q->to.by_i == 1 && q->to.first == -1 && q->lo <= q->from.first + 1;
  int above = q->from.by_i == 1 && q->from.first == 1 && !q->to.by_i && q->hi >= q->to.first - 1;
  if (!below && !above) return no(f, "its range is not that of all pairs");
  f->form.first = below ? q->from.first - q->lo : 0;
  f->form.members = (below ? q->hi - q->from.first : q->to.first - q->lo) + 1;
  return 1;
}

const FarForm *quantified_far(Eval *ev, const struct Quantified *q, Expr term) {
  Far f = {.ev = ev, .q = q, .g = ev->b->g, .form = {.term = term, .theta = q->theta, .begin = q->far->span.begin,
                    .end = q->far->span.end}};
  if (split_term(&f, term) && find_places(&f) && find_members(&f)) {
    FarForm *form = ARENA_NEW(ev->b->arena, FarForm);
    *form = f.form;
    return form;
  }
  refuse(ev->b, q->far->span, "this is no sum that a tree takes: %s" HELP
         "a tree takes potentials of 1/r, `sum(i in 1..N, sum(j in 1..i-1, -G*m[i]*m[j]/norm(r[i] - r[j]), "
         "by tree(0.5)))`, softened by `sqrt(d^2 + eps^2)`; without `by` all pairs are taken one by one", f.why);
  return NULL;
}
