/* Draws values of all symbols, rounds them to doubles, lets values that are given by others follow, and projects
 * onto the constraints. */
#include "claims/sample_points.h"

#include <math.h>

#include "mech/states.h"
#include "sym/prove.h"

struct SamplePoints {
  const Eqns *e;
  const Model *m;
  ExprGraph *g;
  SymId *y, *p;
  uint32_t ny, np;
  const Param **param; /* [np] */
  StateSolver *solver;
  EvalTape *equations; /* f and rates */
  long double *values;
  uint32_t nvalues;
};

SamplePoints *sample_points_new(const Eqns *e) {
  const Model *m = e->m;
  Arena *a = m->arena;
  SamplePoints *s = ARENA_NEW(a, SamplePoints);
  *s = (SamplePoints){.e = e, .m = m, .g = e->g};
  s->y = ARENA_ARRAY(a, SymId, 2 * (size_t)m->coords.n + m->states.n + 1);
  s->p = ARENA_ARRAY(a, SymId, m->params.n + 1);
  s->param = ARENA_ARRAY(a, const Param *, m->params.n + 1);
  for (uint32_t i = 0; i < m->coords.n; i++) s->y[s->ny++] = m->coords.at[i].q;
  for (uint32_t i = 0; i < m->coords.n; i++) s->y[s->ny++] = m->coords.at[i].v;
  for (uint32_t i = 0; i < m->states.n; i++) s->y[s->ny++] = m->states.at[i].z;
  for (uint32_t i = 0; i < m->params.n; i++) {
    if (m->params.at[i].fixed) continue;
    s->param[s->np] = &m->params.at[i];
    s->p[s->np++] = m->params.at[i].sym;
  }
  Expr *roots = ARENA_ARRAY(a, Expr, e->n + m->states.n + 1);
  for (uint32_t i = 0; i < e->n; i++) roots[s->nvalues++] = e->f[i];
  for (uint32_t i = 0; i < m->states.n; i++) roots[s->nvalues++] = e->flow[i];
  s->equations = eval_tape(e->g, roots, s->nvalues);
  s->values = ARENA_ARRAY(a, long double, s->nvalues + 1);
  if (e->constraints.n) s->solver = states_new(e);
  return s;
}

SymList sample_state_symbols(const SamplePoints *s) { return (SymList){s->y, s->ny}; }
SymList sample_parameters(const SamplePoints *s) { return (SymList){s->p, s->np}; }

static long double value_of(SamplePoints *s, Expr e, const long double *symbols) {
  long double out = 0;
  expr_eval(s->g, &e, 1, symbols, &out);
  return out;
}

static void round_symbols(const SymId *at, uint32_t n, long double *symbols) {
  for (uint32_t i = 0; i < n; i++) symbols[at[i]] = (double)symbols[at[i]];
}

void sample_default(SamplePoints *s, uint32_t i, long double *symbols) {
  if (s->param[i]->value) symbols[s->p[i]] = (double)value_of(s, s->param[i]->value, symbols);
}

void sample_follow(SamplePoints *s, long double *symbols) {
  const Model *m = s->m;
  for (uint32_t i = 0; i < s->np; i++) {
    Expr value = s->param[i]->value;
    if (value && expr_kinds(s->g, value) & 1u << SYM_PARAM) sample_default(s, i, symbols);
  }
  for (uint32_t i = 0; i < m->inputs.n; i++)
    if (m->inputs.at[i].value) symbols[m->inputs.at[i].sym] = value_of(s, m->inputs.at[i].value, symbols);
  for (uint32_t i = 0; i < m->contacts.n; i++) symbols[m->contacts.at[i].closed] = symbols[m->contacts.at[i].force] = 0;
}

static int is_open(SamplePoints *s, const Contact *c, const long double *symbols) {
  return c->margin || c->is_tangent || value_of(s, c->gap, symbols) >= 0;
}

/* Reflects coordinates in contacts that are passed, one after the other, until none is: a tower of blocks has no
 * open state among random ones. S. Agmon, The relaxation method for linear inequalities, Canad. J. Math. 6 (1954)
 * 382, doi:10.4153/CJM-1954-037-2. */
static void open_contacts(SamplePoints *s, long double *symbols) {
  enum { SWEEPS = 50 };
  uint32_t nq = s->m->coords.n, passed = 1;
  long double *slope = ARENA_ARRAY(s->m->arena, long double, nq + 1);
  for (int sweep = 0; sweep < SWEEPS && passed; sweep++) {
    passed = 0;
    vec_each(const Contact, c, s->m->contacts) {
      if (is_open(s, c, symbols)) continue;
      long double gap = value_of(s, c->gap, symbols), square = 0;
      passed++;
      for (uint32_t k = 0; k < nq; k++) {
        long double at = symbols[s->y[k]], step = 1e-9L * (1 + fabsl(at));
        symbols[s->y[k]] = at + step;
        slope[k] = (value_of(s, c->gap, symbols) - gap) / step;
        symbols[s->y[k]] = at;
        square += slope[k] * slope[k];
      }
      for (uint32_t k = 0; k < nq && square > 0; k++) symbols[s->y[k]] -= 2 * gap / square * slope[k];
    }
  }
}

/* Whether the equations have real values, and no contact is passed. */
static int is_inside(SamplePoints *s, const long double *symbols) {
  eval_run(s->equations, symbols, s->values);
  for (uint32_t i = 0; i < s->nvalues; i++)
    if (!isfinite(s->values[i])) return 0;
  for (uint32_t i = 0; i < s->m->contacts.n; i++)
    if (!is_open(s, &s->m->contacts.at[i], symbols)) return 0;
  return !s->m->domain || value_of(s, s->m->domain, symbols) != 0;
}

static int draw(SamplePoints *s, uint32_t k, uint32_t seed, long double *symbols) {
  const Model *m = s->m;
  if (k > POINTS_START_LIKE + POINTS_RANDOM) sample_state_wide(s->g, seed, symbols);
  else sample_state(s->g, seed, symbols);
  symbols[m->time] = m->scene.t0 + fabsl(symbols[m->time]); /* a function may refuse times before the start */
  for (uint32_t i = 0; i < s->np; i++)
    if (k <= POINTS_START_LIKE || s->param[i]->given) sample_default(s, i, symbols);
  round_symbols(s->p, s->np, symbols);
  sample_follow(s, symbols);
  if (k == 0) {
    symbols[m->time] = m->scene.t0;
    for (uint32_t i = 0; i < s->ny; i++) symbols[s->y[i]] = 0;
    model_eval_starts(m, symbols);
  }
  if (k) open_contacts(s, symbols);
  if (s->solver && !states_project(s->solver, symbols)) return 0;
  round_symbols(s->y, s->ny, symbols);
  round_symbols(&m->time, 1, symbols);
  sample_follow(s, symbols);
  return is_inside(s, symbols);
}

int sample_point(SamplePoints *s, uint32_t k, long double *symbols) {
  enum { DRAWS = 20 };
  for (uint32_t i = 0; i < (k ? DRAWS : 1); i++)
    if (draw(s, k, 1 + k + i * POINTS, symbols)) return 1;
  return 0;
}

const char *sample_text(const SamplePoints *s, const long double *symbols) {
  StrBuf b = strbuf(s->m->arena);
  for (uint32_t i = 0; i < s->ny + s->np; i++) {
    SymId sym = i < s->ny ? s->y[i] : s->p[i - s->ny];
    sb_printf(&b, "%s%s = %.6Lg", i ? ", " : "", expr_symbol(s->g, sym)->name, symbols[sym]);
  }
  sb_printf(&b, ", t = %.6Lg", symbols[s->m->time]); /* also where the model does not need it: the function may */
  return sb_text(&b);
}
