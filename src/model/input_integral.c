/* Integrals of records: `input v = integral(a)` is the integral of the table of the input a from its first row on,
 * `integral(a, level)` that of the table less its mean, which ends where it begins. The cubic of a table has quartics
 * and quintics as integrals, which the form of quintics holds exactly (base/spline.h). */
#include <math.h>
#include <string.h>

#include "model/builder.h"

int is_input_integral(const Builder *b, AstId rhs) {
  const AstExpr *x = ast_expr(b->ast, rhs);
  return x->kind == AST_CALL && strcmp(x->name, "integral") == 0 && !scope_own(&b->scope, x->name, NULL);
}

static int jumps(const Spline *s, uint32_t i) { return s->row[i + 1][0] == nextafter(s->row[i][0], HUGE_VAL); }

/* First and second derivative of the curve at row i; of two rows of one time each has that of its own side. */
static void rates_at(const Spline *s, uint32_t i, double rate[2]) {
  if (s->jet) {
    rate[0] = s->jet[i][2], rate[1] = s->jet[i][3];
    return;
  }
  int ends = i + 1 == s->n || (jumps(s, i) && i > 0);
  uint32_t k = ends ? i - 1 : i;
  if (jumps(s, k)) { /* the end of a table that holds */
    rate[0] = rate[1] = 0;
    return;
  }
  double h = s->row[k + 1][0] - s->row[k][0], m0 = s->row[k][2], m1 = s->row[k + 1][2];
  double chord = (s->row[k + 1][1] - s->row[k][1]) / h;
  rate[0] = ends ? chord + h * (m0 + 2 * m1) / 6 : chord - h * (2 * m0 + m1) / 6;
  rate[1] = s->row[i][2];
}

/* The integral of the curve over interval i, which holds a polynomial of degree 5 or less. */
static double over(const Spline *s, uint32_t i) {
  double h = s->row[i + 1][0] - s->row[i][0], u[2], w[2];
  if (jumps(s, i)) return 0;
  rates_at(s, i, u);
  rates_at(s, i + 1, w);
  double sum = (s->row[i][1] + s->row[i + 1][1]) / 2;
  if (!s->jet) return h * (sum - h * h * (u[1] + w[1]) / 24);
  return h * (sum + h * ((u[0] - w[0]) / 10 + h * (u[1] + w[1]) / 120));
}

static const Spline *integral(Builder *b, const Spline *of, int level) {
  double(*row)[3] = arena_alloc(b->arena, of->n * sizeof *row), (*jet)[4] = arena_alloc(b->arena, of->n * sizeof *jet);
  long double sum = 0, mean = 0;
  for (uint32_t i = 0; i + 1 < of->n && level; i++) mean += over(of, i);
  mean /= of->row[of->n - 1][0] - of->row[0][0];
  for (uint32_t i = 0; i < of->n; i++) {
    double rate[2], t = of->row[i][0];
    rates_at(of, i, rate);
    row[i][0] = jet[i][0] = t;
    row[i][1] = jet[i][1] = (double)(sum - mean * (t - of->row[0][0]));
    jet[i][2] = (double)(of->row[i][1] - mean);
    row[i][2] = jet[i][3] = rate[0];
    sum += i + 1 < of->n ? over(of, i) : 0;
  }
  Spline *s = ARENA_NEW(b->arena, Spline);
  *s = (Spline){of->n, (const double(*)[3])row, (const double(*)[4])jet};
  return s;
}

/* The input that is integrated, and whether it is levelled; NULL, reported. */
static const Input *integrand(Builder *b, const Input *in, int *level) {
  const AstExpr *x = ast_expr(b->ast, in->integral), *of = x->args ? ast_expr(b->ast, x->args) : NULL;
  const AstExpr *how = of && of->next ? ast_expr(b->ast, of->next) : NULL;
  const Entity *e = of && of->kind == AST_NAME ? scope_find(&b->scope, of->name, in->effect, NULL) : NULL;
  *level = how && how->kind == AST_NAME && strcmp(how->name, "level") == 0;
  int odd = how && (!*level || how->next);
  if (!e || e->kind != ENT_INPUT || odd || &b->m->inputs.at[e->index] >= in) {
    diag_error(b->diags, odd ? how->span : x->span, "%s" HELP
               "`input a [m/s^2] = \"quake.csv\", v [m/s] = integral(a), u [m] = integral(v)`; `integral(a, level)` "
               "takes the mean of the record away, so that it ends where it begins",
               odd ? "`integral` takes an input, and `level` or nothing behind it"
                   : "`integral` takes an input that is declared before");
    return NULL;
  }
  const Input *from = &b->m->inputs.at[e->index];
  if (!dim_equate(b->dims, dim_per_second(b->dims, b->dim_of.at[in->sym]), b->dim_of.at[from->sym], x->span)) {
    diag_error(b->diags, x->span, "`%s` is %s, and `%s`, its integral over the time, %s", of->name,
               in_dim(b, b->dim_of.at[from->sym]), in->name, in_dim(b, b->dim_of.at[in->sym]));
    diag_help(b->diags, "an acceleration in m/s^2 has a velocity in m/s, and that a position in m");
    return NULL;
  }
  return from;
}

void fill_input_integrals(Builder *b) {
  vec_each(Input, in, b->m->inputs) {
    int level;
    const Input *of = in->integral ? integrand(b, in, &level) : NULL;
    if (!of) continue;
    in->file = of->file;
    if (of->table) in->table = integral(b, of->table, level);
    else if (of->value && expr_is_zero(b->g, of->value)) in->value = of->value;
    else
      diag_error(b->diags, ast_expr(b->ast, in->integral)->span,
                 "in scene %s `%s` is a formula, and `integral` takes a table" HELP
                 "give `%s` its formula there, too: `%s = ...`",
                 b->m->scene.name, of->name, in->name, in->name);
  }
}
