#include "mech/freedom.h"

#include <math.h>

#include "mech/frobenius.h"
#include "mech/noether.h"
#include "sym/print.h"

/* The scene's start: parameters at their values, what it does not give at 0. */
static long double *start_of(const Eqns *e) {
  const Model *m = e->m;
  long double *symbols = ARENA_ARRAY(m->arena, long double, expr_symbol_count(e->g) + 1);
  symbols[m->pi] = 3.14159265358979323846264338327950288L;
  symbols[m->time] = (long double)m->scene.t0;
  for (uint32_t i = 0; i < m->params.n; i++)
    if (m->params.at[i].value) expr_eval(e->g, &m->params.at[i].value, 1, symbols, &symbols[m->params.at[i].sym]);
  for (uint32_t i = 0; i < m->scene.starts.n; i++) {
    const Start *s = &m->scene.starts.at[i];
    expr_eval(e->g, &s->value, 1, symbols, &symbols[s->target]);
  }
  return symbols;
}

static void report_infeasible(const Eqns *e, StateSolver *solver, const long double *symbols) {
  const Model *m = e->m;
  long double residual;
  uint32_t worst = states_worst(solver, symbols, &residual);
  const Constraint *k = e->constraints.of[worst];
  const char *unit = dim_text(m->dims, k->dim);
  diag_error(m->diags, k->span, "scene %s: no state near its start obeys the constraint `%s`; it is off by %.3Lg%s%s%s", m->scene.name, k->name,
             fabsl(residual), *unit == '1' ? "" : " [", *unit == '1' ? "" : unit, *unit == '1' ? "" : "]");
  diag_help(m->diags, "start nearer to where it holds; at a place where its derivatives vanish no direction leads there");
}

/* Whether the rank stays as it is without constraint k: then its reaction is not unique. */
static int is_dispensable(StateSolver *s, const Eqns *e, uint32_t k, uint32_t rank) {
  unsigned char *without = ARENA_ARRAY(e->m->arena, unsigned char, e->constraints.n);
  return states_rank(s, k, without) == rank;
}

static const char *plural(uint32_t n) { return n == 1 ? "" : "s"; }

static const char *kind_of(const Eqns *e, uint32_t k) {
  const Constraints *all = &e->constraints;
  if (k >= all->nholonomic) return "on velocities";
  return expr_kinds(e->g, all->c[k]) & 1u << SYM_TIME ? "holonomic, with explicit time" : "holonomic";
}

static void show_one(const Eqns *e, StateSolver *s, const unsigned char *counts, uint32_t k, uint32_t rank, StrBuf *out) {
  const Constraint *c = e->constraints.of[k];
  Place place = source_place(e->m->ast->sources, c->span.begin);
  if (noether_is_contact(e->m, c)) {
    sb_printf(out, "  contact %s (line %u): a constraint while it is closed\n", c->name, place.line);
    return;
  }
  sb_printf(out, "  constraint %s (line %u): %s", c->name, place.line, kind_of(e, k));
  if (!counts[k]) sb_puts(out, "; follows from those before it");
  if (rank < e->constraints.n - e->m->contacts.n && is_dispensable(s, e, k, rank)) sb_puts(out, "; its multiplier is not unique: the least one is taken");
  sb_putc(out, '\n');
}

static void show_integrability(const Eqns *e, StateSolver *s, StrBuf *out) {
  static const char *const words[] = {[INTEGRABLE_NO] = "are not integrable: the system is nonholonomic",
                                      [INTEGRABLE_PROVED] = "are integrable: they could be stated for positions",
                                      [INTEGRABLE_UNDECIDED] = "look integrable; that is not decided"};
  const Constraints *all = &e->constraints;
  if (all->nholonomic == all->n) return;
  sb_printf(out, "  constraints on velocities %s\n", words[frobenius(e, s)]);
  for (uint32_t i = all->nholonomic; i < all->nkept; i++) {
    sb_printf(out, "  constraint %s keeps ", all->of[i]->name);
    expr_print(e->g, all->c[i], PRINT_TEXT, out);
    sb_puts(out, " as it is at the start\n");
  }
}

/* From the start, or from places beside it, where it is in the middle between two ways out. */
static int obey_from(const Eqns *e, StateSolver *s, long double *symbols) {
  static const long double beside[] = {0, 1e-3L, 0.03L, 0.3L, 1};
  uint32_t n = expr_symbol_count(e->g) + 1;
  long double *tried = ARENA_ARRAY(e->m->arena, long double, n);
  for (size_t k = 0; k < sizeof beside / sizeof *beside; k++) {
    for (uint32_t i = 0; i < n; i++) tried[i] = symbols[i];
    for (uint32_t i = 0; i < e->n; i++) tried[e->m->coords.at[i].q] += beside[k] * (0.5L + fmodl(0.618033988749894848L * (i + 1), 1));
    if (!states_obey(s, tried)) continue;
    for (uint32_t i = 0; i < n; i++) symbols[i] = tried[i];
    return 1;
  }
  return states_obey(s, symbols);
}

int freedom_show(const Eqns *e, StrBuf *out) {
  const Constraints *all = &e->constraints;
  if (!all->n) return 1;
  StateSolver *s = states_new(e);
  long double *symbols = start_of(e);
  if (!obey_from(e, s, symbols)) {
    if (e->m->scene.starts.n) report_infeasible(e, s, symbols);
    else sb_printf(out, "scene %s: %u constraint%s; without a start nothing is said of their rank\n", e->m->scene.name, all->n, plural(all->n));
    return !e->m->scene.starts.n;
  }
  unsigned char *counts = ARENA_ARRAY(e->m->arena, unsigned char, all->n);
  uint32_t rank = states_rank(s, UINT32_MAX, counts), free = e->n - rank;
  uint32_t held = all->n - e->m->contacts.n;
  sb_printf(out, "scene %s: %u degree%s of freedom", e->m->scene.name, free, plural(free));
  if (held) sb_printf(out, "; %u constraint%s, of rank %u at the start", held, plural(held), rank);
  sb_putc(out, '\n');
  for (uint32_t k = 0; k < all->n; k++) show_one(e, s, counts, k, rank, out);
  show_integrability(e, s, out);
  return 1;
}
