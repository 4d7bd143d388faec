/* Headings, equations, names and definitions of listings; each line has a form for text and one for LaTeX. */
#include "report/listing_text.h"

#include "model/printed_text.h"
#include "sym/family_rows.h"
#include "symmetry/charges.h"

int text_latex(const Text *t) { return t->style == PRINT_LATEX; }
static void text_put(Text *t, const char *text, const char *in_latex) {
  sb_puts(t->out, text_latex(t) ? in_latex : text);
}

void text_heading(Text *t, const char *title) {
  if (text_latex(t)) sb_printf(t->out, "\n%% %s\n\\begin{align*}\n", title);
  else sb_printf(t->out, "\n%s\n", title);
  t->block = t->out->n;
  t->rows.n = 0;
}

void text_expr(Text *t, Expr e) {
  const double longest = 1e5, most_repeated = 8;
  uint32_t distinct;
  double size = expr_tree_size(t->g, e, &distinct);
  if (size <= longest || size <= most_repeated*distinct) {
    expr_print_checked(t->e->m, e, t->style, t->out);
    return;
  }
  text_put(t, "(", "\\text{(");
  sb_printf(t->out, "too long to print: %.2g parts written out, %u distinct ones; --format c shows the steps", size,
            distinct);
  text_put(t, ")", ")}");
}

/* Takes words that were written since the heading as lines of the block. */
static void take_words(Text *t) {
  Arena *a = t->e->m->arena;
  sb_text(t->out);
  for (const char *s = t->out->at + t->block, *to = t->out->at + t->out->n, *end; s < to; s = end + 1) {
    end = s + strcspn(s, "\n");
    vec_push(a, &t->rows, ((TextRow){.words = arena_strndup(a, s, (size_t)(end - s))}));
  }
  t->out->n = t->block;
}

/* "  left = right", left a name or, where that is NULL, an expression. */
static void equation(Text *t, const char *name, Expr left, Expr right, int last) {
  take_words(t);
  vec_push(t->e->m->arena, &t->rows, ((TextRow){NULL, name, left, right, last}));
}

static const char *row_text(Arena *a, void *data, uint32_t k) {
  Text own = *(const Text *)data;
  const TextRow *r = &own.rows.at[k];
  StrBuf line = strbuf(a);
  own.out = &line;
  if (r->words) return r->words;
  sb_puts(&line, "  ");
  if (r->name) sb_puts(&line, r->name);
  else text_expr(&own, r->left);
  text_put(&own, " = ", " &= ");
  text_expr(&own, r->right);
  text_put(&own, "", r->last ? "" : " \\\\");
  return sb_text(&line);
}

static ExprShape shape_of(Text *t, const TextRow *r) {
  ExprShape s = {0};
  Arena *a = t->e->m->arena;
  if (r->words) return (ExprShape){.parts = SHAPE_PARTS_MOST};
  if (r->name) expr_shape_add_name(a, r->name, &s);
  else expr_shape_add(t->g, a, r->left, &s);
  expr_shape_add(t->g, a, r->right, &s);
  return s;
}

void text_end(Text *t) {
  Arena *a = t->e->m->arena;
  take_words(t);
  ExprShape *shape = ARENA_ARRAY(a, ExprShape, t->rows.n + 1);
  for (uint32_t k = 0; k < t->rows.n; k++) shape[k] = shape_of(t, &t->rows.at[k]);
  sb_puts(t->out, family_lines(a, &(FamilyLines){t->rows.n, shape, row_text, t}, t->style));
  t->rows.n = 0;
  text_put(t, "", "\\end{align*}\n");
}

void text_equation(Text *t, Expr left, Expr right, int last) { equation(t, NULL, left, right, last); }
void text_named(Text *t, const char *text, const char *in_latex, Expr right, int last) {
  equation(t, text_latex(t) ? in_latex : text, 0, right, last);
}

const char *text_latex_name(Text *t, Name name) {
  StrBuf b = strbuf(t->e->m->arena);
  name_print(name, PRINT_LATEX, &b);
  return sb_text(&b);
}

void text_definitions(Text *t, const Expr *roots, uint32_t n) {
  ExprList l = expr_topo(t->g, roots, n);
  uint32_t total = 0, shown = 0;
  for (uint32_t i = 0; i < l.n; i++) total += expr_op(t->g, l.at[i]) == EX_DEF;
  if (!total) return;
  text_heading(t, "where");
  for (uint32_t i = 0; i < l.n; i++)
    if (expr_op(t->g, l.at[i]) == EX_DEF) text_equation(t, l.at[i], expr_arg(t->g, l.at[i], 0), ++shown == total);
  text_end(t);
}

void text_title(Text *t) {
  const Model *m = t->e->m;
  sb_printf(t->out, text_latex(t) ? "%% %s%s%s\n%% scene %s" : "%s%s%s\nscene %s", m->name, *m->doc ? ": " : "", m->doc,
            m->scene.name);
  for (uint32_t i = 0; i < m->effects.n; i++) sb_printf(t->out, "%s%s", i ? ", " : ", with ", m->effects.at[i]);
  sb_putc(t->out, '\n');
}

void text_constraints(Text *t) {
  const Constraints *k = &t->e->constraints;
  if (!k->n) return;
  text_heading(t, "constraints");
  for (uint32_t i = 0; i < k->n; i++)
    text_equation(t, i < k->nholonomic ? k->c[i] : k->r[i], expr_int(t->g, 0), i + 1 == k->n);
  text_end(t);
}

void text_momenta(Text *t) {
  const Eqns *e = t->e;
  uint32_t n = e->n + e->first.n; /* of second order, or of first order; never both */
  text_heading(t, "momenta");
  for (uint32_t i = 0; i < n; i++) {
    Name name = e->n ? e->m->coords.at[i].name : e->m->states.at[e->first.at[i]].name;
    const char *text = arena_printf(e->m->arena, "p_%s", name),
               *tex = arena_printf(e->m->arena, "p_{%s}", text_latex_name(t, name));
    Expr shown = e->n ? e->momenta[i] : e->first.theta[i];
    text_named(t, text, tex, shown, i + 1 == n);
  }
  text_end(t);
}

void text_charges(Text *t) {
  const Eqns *e = t->e;
  Arena *a = e->m->arena;
  if (e->ncharges < 2) return;
  int jumps = 0;
  for (uint32_t i = 1; i < e->ncharges; i++) jumps |= e->charges[i].proof.jumps;
  text_heading(t, jumps ? "charges of symmetries; some balances hold between jumps of L only: see `lagc check`"
                        : "charges of symmetries");
  for (uint32_t i = 1; i < e->ncharges; i++) {
    const Charge *c = &e->charges[i];
    const char *tex = text_latex_name(t, c->name);
    int last = i + 1 == e->ncharges, moves = !c->proof.power_unknown && !expr_is_zero(t->g, c->proof.power);
    if (!expr_is_zero(t->g, c->proof.F))
      text_named(t, arena_printf(a, "F(%s)", c->name), arena_printf(a, "F_{%s}", tex), c->proof.F, 0);
    text_named(t, c->name, arena_printf(a, "Q_{%s}", tex), c->proof.charge, last && !moves);
    if (moves)
      text_named(t, arena_printf(a, "d(%s)/dt", c->name), arena_printf(a, "\\dot{Q}_{%s}", tex), c->proof.power, last);
  }
  text_end(t);
}
