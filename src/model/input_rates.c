/* Rates of inputs. Where the text takes u', or an equation needs it, u' is an input behind u, and u'' behind u': a
 * program, a header or an FMU has the value and its rates as inputs. Their formulas are derivatives of u's formula,
 * their tables the derivatives of the quintic through u's rows. Only what is needed is declared: a build of the
 * model notes what it lacks, and the next one has it (build_model.c). */
#include <math.h>
#include <string.h>

#include "model/resolve_impl.h"
#include "sym/diff.h"

enum { HIGHEST = 2 };

static void want_input_rate(Builder *b, uint32_t input, int order) {
  while (b->m->inputs.at[input].order) input--, order++;
  InputRates *r = b->rates_wanted;
  Name name = b->m->inputs.at[input].name;
  order = order > HIGHEST ? HIGHEST : order;
  for (uint32_t i = 0; i < r->of.n; i++) {
    if (r->of.at[i].name != name) continue;
    r->missing |= r->of.at[i].order < order;
    if (r->of.at[i].order < order) r->of.at[i].order = order;
    return;
  }
  r->missing = 1;
  vec_push(b->arena, &r->of, ((InputRate){name, order}));
}

void want_rates_of(Builder *b, Expr e, int order) {
  ExprList l = expr_topo(b->g, &e, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    if (expr_op(b->g, l.at[i]) != EX_SYM) continue;
    const Symbol *s = expr_sym_of(b->g, l.at[i]);
    if (s->kind == SYM_INPUT && s->index < b->m->inputs.n && !model_is_contact_switch(b->m, expr_sym_id(b->g, l.at[i])))
      want_input_rate(b, s->index, order);
  }
}

void want_rates_of_momenta(Builder *b) {
  const unsigned both = 1u << SYM_INPUT | 1u << SYM_VEL;
  Expr L = b->m->lagrangian;
  if (!L || (expr_kinds(b->g, L) & both) != both) return;
  ExprList l = expr_topo(b->g, &L, 1);
  for (uint32_t i = 0; i < l.n; i++) { /* sums are read term by term */
    ExprOp op = expr_op(b->g, l.at[i]);
    if (op != EX_SUM && op != EX_DEF && (expr_kinds(b->g, l.at[i]) & both) == both) want_rates_of(b, l.at[i], 1);
  }
}

void declare_input_rates(Builder *b, uint32_t input) {
  Model *m = b->m;
  const InputRates *r = b->rates_wanted;
  int wanted = 0;
  for (uint32_t i = 0; i < r->of.n; i++)
    if (r->of.at[i].name == m->inputs.at[input].name) wanted = r->of.at[i].order;
  for (int order = 1; order <= wanted; order++) {
    const Input *of = &m->inputs.at[m->inputs.n - 1];
    Input rate = {.name = intern_printf(b, "%s'", of->name),
                  .span = of->span,
                  .unit = unit_per_second(b, &of->unit),
                  .order = order};
    rate.sym = declare_symbol(b, SYM_INPUT, m->inputs.n, rate.name, SIGN_UNKNOWN,
                              dim_per_second(b->dims, b->dim_of.at[of->sym]));
    m->inputs.at[m->inputs.n - 1].rate = m->inputs.n;
    vec_push(b->arena, &m->inputs, rate);
  }
}

/* The quintic through the rows of a cubic; NULL, reported, where there is none. */
static const Spline *quintic(Builder *b, const Input *in) {
  const Spline *rows = in->table;
  const char *name = in->file;
  if (rows->jet) return rows;
  if (in->holds) {
    diag_error(b->diags, in->span,
               "the rate of `%s` is needed, and its table `%s` holds each value until the next row" HELP
               "a position that jumps has no velocity: leave `hold` out, for a smooth curve through the rows",
               in->name, name);
    return NULL;
  }
  for (uint32_t i = 1; i < rows->n; i++)
    if (rows->row[i][0] == nextafter(rows->row[i - 1][0], HUGE_VAL)) {
      diag_error(b->diags, in->span,
                 "the rate of `%s` is needed, and its table `%s` jumps at t = %.9g" HELP
                 "a position that jumps has no velocity: leave the second row of that time out",
                 in->name, name, rows->row[i - 1][0]);
      return NULL;
    }
  if (rows->n < SPLINE_QUINTIC_ROWS) {
    diag_error(b->diags, in->span,
               "the rate of `%s` is needed, and its table `%s` has %u rows: a smooth curve needs %d" HELP
               "add rows, or write the input as a formula of t",
               in->name, name, rows->n, SPLINE_QUINTIC_ROWS);
    return NULL;
  }
  double(*jet)[4] = arena_alloc(b->arena, rows->n * sizeof *jet);
  for (uint32_t i = 0; i < rows->n; i++) memcpy(jet[i], rows->row[i], 2 * sizeof jet[i][0]);
  if (!spline_fit_quintic(b->arena, jet, rows->n)) {
    diag_error(b->diags, in->span,
               "the curve through `%s` has no finite rates" HELP
               "rows are too close, or values too far apart, for double precision",
               name);
    return NULL;
  }
  Spline *s = ARENA_NEW(b->arena, Spline);
  *s = (Spline){rows->n, rows->row, (const double(*)[4])jet};
  return s;
}

static double slope(const Spline *s, uint32_t i) {
  return fabs((s->row[i + 1][1] - s->row[i][1]) / (s->row[i + 1][0] - s->row[i][0]));
}

/* Warns of a table with a step: from one row to the next it changes at 20 times the rate on both sides, so that the
 * curve between these rows follows no measured motion. */
static void warn_of_steps(Builder *b, const Input *in) {
  const Spline *s = in->table;
  for (uint32_t i = 1; s && i + 2 < s->n; i++) {
    if (!(slope(s, i) > 20 * fmax(slope(s, i - 1), slope(s, i + 1)))) continue;
    diag_warning(b->diags, in->span,
                 "the rate of `%s` is needed, and its table `%s` steps from %.6g to %.6g between t = %.6g and %.6g",
                 in->name, in->file, s->row[i][1], s->row[i + 1][1], s->row[i][0], s->row[i + 1][0]);
    diag_help(b->diags, "add rows between them that resolve the motion; in its place a curve overshoots there. "
                               "A value that steps has no rate; one without rates may step: `hold(\"%s\")`", in->file);
    return;
  }
}

/* Warns of a formula with corners or jumps, where the rate has none. */
static void warn_of_corners(Builder *b, const Input *in) {
  ExprList l = expr_topo(b->g, &in->value, 1);
  for (uint32_t i = 0; i < l.n; i++) {
    ExprOp op = expr_op(b->g, l.at[i]);
    if (op != EX_ABS && op != EX_SIGN && op != EX_FLOOR && op != EX_MIN && op != EX_MAX && op != EX_SELECT) continue;
    diag_warning(
        b->diags, ast_expr(b->ast, in->text)->span,
        "the rate of `%s` is needed, and its formula may have corners or jumps: the motion lacks their impulses",
        in->name);
    diag_help(b->diags, "smooth it: a position that jumps has no velocity, one with a corner no acceleration");
    return;
  }
}

void fill_input_rates(Builder *b) {
  Model *m = b->m;
  vec_each(Input, in, m->inputs) {
    if (!in->rate) continue;
    Input *rate = &m->inputs.at[in->rate];
    if (in->table) in->table = quintic(b, in);
    if (!in->order && !in->integral) warn_of_steps(b, in);
    if (in->value && in->text && !in->order) warn_of_corners(b, in);
    rate->table = in->table;
    rate->file = in->file;
    rate->value = in->value ? expr_diff(b->g, in->value, m->time) : 0;
  }
}

void model_seed_time(const Model *m, Expr *seed) {
  seed[m->time] = expr_int(m->g, 1);
  for (uint32_t i = 0; i < m->inputs.n; i++)
    if (m->inputs.at[i].rate)
      seed[m->inputs.at[i].sym] = expr_symbol(m->g, m->inputs.at[m->inputs.at[i].rate].sym)->node;
}
