/* Projection onto the constraints, and the sizes against which residuals are judged. Enters: a state near the
 * constraints; leaves: the nearest one on them in the mass metric, positions first. Holds: a state that obeys them
 * to rounding stays as it is, bit by bit. */
#include <float.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"
#include "numeric/magnitudes.h"
#include "numeric/workspace.h"

/* The layout of pb->held; behind it a state for lag_rhs_prepare. */
typedef struct ConstraintScratch {
  const lag_constraints *of;
  double *c, *r, *before, *g, *size, *A; /* [n], [n], [n], [n], [n], [njacobian] */
  double *wanted;                 /* [n] changes that a correction is to make; g is scratch of what judges them */
  /* [n] sizes of the terms of the rates, and of the holonomic constraints, where they were last met */
  double *terms[2];
  double *d, *force, *step;       /* [nq], [nq], [nq] */
  double *other;                  /* [2 nq + nz] */
  double *M;                      /* [nmass] */
} ConstraintScratch;

size_t lag_constraint_scratch_size(const lag_model *m) {
  const lag_constraints *of = m->constraints;
  return of ? (size_t)(8 * of->n + of->njacobian + of->nmass + 3 * m->nq + 2 * (2 * m->nq + m->nz)) : 0;
}

static ConstraintScratch layout(const lag_problem *pb) {
  ConstraintScratch w = {.of = pb->model->constraints};
  const size_t n = (size_t)w.of->n, nq = (size_t)pb->nq;
  const lag_part parts[] = {{&w.c, n},
                            {&w.r, n},
                            {&w.before, n},
                            {&w.g, n},
                            {&w.size, n},
                            {&w.wanted, n},
                            {&w.terms[0], n},
                            {&w.terms[1], n},
                            {&w.A, (size_t)w.of->njacobian},
                            {&w.M, (size_t)w.of->nmass},
                            {&w.d, nq},
                            {&w.force, nq},
                            {&w.step, nq},
                            {&w.other, 0}};
  lag_workspace_slice(pb->held, sizeof parts / sizeof *parts, parts);
  return w;
}

int lag_residuals(lag_problem *pb, double t, const double *y, double *c, double *r) {
  int rc = lag_inputs(pb, t), nq = pb->nq;
  rc = rc ? rc
          : pb->model->constraints->residuals(pb->model->constraints, t, y, y + nq, y + 2 * nq, pb->p, pb->u, c, r,
                                              pb->work);
  for (int k = 0; pb->kept && k < pb->model->constraints->nholonomic; k++)
    c[k] = isnan(pb->kept[k]) ? 0 : c[k] - pb->kept[k];
  return rc;
}

void lag_release_integrals(lag_sim *s) {
  const lag_constraints *of = s->scene->model->constraints;
  for (int k = 0; of && k < of->n; k++) s->kept[k] = of->of[k].holonomic ? 0 : NAN;
}

int lag_hold_integrals(lag_sim *s, double t, const double *y) {
  const lag_constraints *of = s->scene->model->constraints;
  if (!of) return LAG_OK;
  ConstraintScratch w = layout(&s->pb);
  memset(s->kept, 0, (size_t)of->n * sizeof *s->kept);
  int rc = lag_residuals(&s->pb, t, y, w.c, w.r);
  for (int k = 0; k < of->nholonomic && rc == 0; k++) s->kept[k] = of->of[k].holonomic ? 0 : w.c[k];
  return rc;
}

int lag_least_change(lag_problem *pb, double t, const double *y, int holonomic, const double *g, double *d,
                     double *force) {
  const lag_constraints *of = pb->model->constraints;
  int rc = lag_inputs(pb, t), nq = pb->nq;
  return rc ? rc
            : (holonomic ? of->position : of->velocity)(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, g, d, force,
                                                        pb->work);
}

/* ---- sizes of residuals */

/* size[n] := first-order change of each constraint when every coordinate (velocity) moves from 0 to its value. */
static int sizes(lag_problem *pb, const ConstraintScratch *w, double t, const double *y, int holonomic, double *size) {
  const lag_constraints *of = w->of;
  int nq = pb->nq, n = holonomic ? of->nholonomic : of->n, at = holonomic ? 0 : nq, rc = lag_inputs(pb, t);
  rc = rc ? rc : of->matrices(of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, w->A, w->M, pb->work);
  if (rc) return rc;
  memset(size, 0, (size_t)n * sizeof *size);
  for (int e = 0; e < of->njacobian; e++) {
    int row = of->jacobian[e].row;
    if (row < n) size[row] += fabs(w->A[e] * y[at + of->jacobian[e].col]);
  }
  return 0;
}

double lag_unit_magnitude(const lag_problem *pb, const double *x, int i) {
  const lag_var *q = pb->model->q;
  double most = 0;
  for (int j = 0; j < pb->nq; j++)
    most = fabs(x[j]) > most && (q[i].unit == q[j].unit || strcmp(q[i].unit, q[j].unit) == 0) ? fabs(x[j]) : most;
  return most;
}

int lag_are_alike(const lag_var *a, const lag_var *b) {
  return a->periodic == b->periodic && strcmp(a->unit, b->unit) == 0;
}

double lag_typical_magnitude(const lag_problem *pb, const double *y, int holonomic, int i) {
  const lag_var *q = &pb->model->q[i];
  const double unknown = 1e-6; /* of the unit: a run from 0 has no length, and what rounding moved off 0 is none */
  int from_zero = pb->begin && !(lag_unit_magnitude(pb, pb->begin, i) > 0);
  double time = holonomic      ? 1
                : pb->span > 0 ? pb->span
                               : 1,
         most = lag_unit_magnitude(pb, holonomic ? y : y + pb->nq, i);
  if (most > 0 && from_zero) most = fmax(most, unknown / time);
  most = fmax(most, lag_unit_magnitude(pb, y, i) / time);
  return lag_component_scale(most, q->periodic, q->unit);
}

/* Raises size[n] to the residuals of a state displaced by typical magnitudes: there may be no terms of first order,
 * as of a folded linkage or a body at rest. */
static int displaced_sizes(lag_problem *pb, const ConstraintScratch *w, double t, const double *y, int holonomic,
                           double *size) {
  int nq = pb->nq, n = holonomic ? w->of->nholonomic : w->of->n, at = holonomic ? 0 : nq;
  double *c = w->c, *r = w->r;
  double reach = 0;
  const lag_var *q = pb->model->q;
  memcpy(w->other, y, (size_t)pb->n * sizeof *y);
  for (int i = 0; i < nq; i++) {
    reach = i > 0 && lag_are_alike(&q[i], &q[i - 1]) ? reach : lag_typical_magnitude(pb, y, holonomic, i);
    w->other[at + i] += reach * lag_uneven(i);
  }
  int rc = lag_residuals(pb, t, w->other, c, r);
  for (int k = 0; k < n && rc == 0; k++) size[k] = fmax(size[k], fabs(holonomic ? c[k] : r[k]));
  return rc;
}

int lag_constraint_terms(lag_problem *pb, double t, const double *y, int holonomic, double *size) {
  ConstraintScratch w = layout(pb);
  int rc = sizes(pb, &w, t, y, holonomic, size);
  return rc ? rc : displaced_sizes(pb, &w, t, y, holonomic, size);
}

int lag_worst_constraint(lag_problem *pb, double t, const double *y, int holonomic, double *worst) {
  const lag_constraints *of = pb->model->constraints;
  ConstraintScratch w = layout(pb);
  double most;
  if (lag_constraint_terms(pb, t, y, holonomic, w.g) || lag_residuals(pb, t, y, w.c, w.r)) return -1;
  return lag_worst_residual(holonomic ? of->nholonomic : of->n, holonomic ? w.c : w.r, w.g, DBL_EPSILON,
                            worst ? worst : &most);
}

const char *lag_line_text(const lag_constraint *c, char text[32]) {
  text[0] = '\0';
  if (c->line > 0) snprintf(text, 32, " (line %d)", c->line);
  return text;
}

void lag_report_residual(lag_problem *pb, int k, int holonomic, double residual, const char *words) {
  const lag_constraint *c = &pb->model->constraints->of[k];
  const char *level = c->holonomic == holonomic ? "" : holonomic ? "*s" : c->unit[0] ? "/s" : "1/s";
  size_t length = strlen(c->unit);
  char line[32], unit[64];
  if (level[0] == '*' && length > 2 && strcmp(c->unit + length - 2, "/s") == 0) { /* m/s*s is m */
    length -= 2;
    level = "";
  }
  snprintf(unit, sizeof unit, "%s%.*s%s", c->unit[0] || level[0] ? " " : "", (int)(length ? length : 1),
           c->unit[0] || level[0] != '*' ? c->unit : "1", level);
  if (isnan(residual))
    snprintf(pb->words, sizeof pb->words, "constraint %s%s is not met%s", c->name, lag_line_text(c, line), words);
  else
    snprintf(pb->words, sizeof pb->words, "constraint %s%s is off by %.3g%s%s", c->name, lag_line_text(c, line),
             residual, unit, words);
  pb->detail = pb->words;
}

/* ---- Newton's iteration */

/* Whether the rest of a correction d, its part `left`, is rounding of the largest component with the same unit: one
 * that is 0 never stops moving. */
static int is_rounding(const lag_problem *pb, const double *x, const double *d, double left) {
  const lag_var *q = pb->model->q;
  const char *unit = NULL;
  double most = 0;
  for (int i = 0; i < pb->nq; i++) {
    double rest = left * fabs(d[i]), rounding = 4 * DBL_EPSILON;
    if (rest <= rounding * fabs(x[i])) continue;
    if (!unit || strcmp(unit, q[i].unit) != 0) most = lag_unit_magnitude(pb, x, i);
    unit = q[i].unit;
    if (!(rest <= rounding * most)) return 0;
  }
  return 1;
}

/* Reports the worst of constraints that cannot be met. */
static int report_unmet(lag_problem *pb, const ConstraintScratch *w, double t, const double *y, int holonomic) {
  int k = lag_worst_constraint(pb, t, y, holonomic, NULL);
  if (k >= 0) {
    lag_report_residual(pb, k, holonomic, fabs(holonomic ? w->c[k] : w->r[k]),
                       holonomic ? ", and no small change of the coordinates satisfies it"
                                 : " for any velocities: it contradicts the others");
  }
  pb->bad_t = t;
  return LAG_ERETRY;
}

/* g := -A x */
static void negative_product(const ConstraintScratch *w, int n, const double *x, double *g) {
  memset(g, 0, (size_t)n * sizeof *g);
  for (int e = 0; e < w->of->njacobian; e++) {
    const lag_entry *at = &w->of->jacobian[e];
    if (at->row < n) g[at->row] -= w->A[e] * x[at->col];
  }
}

int lag_constraint_is_met(lag_problem *pb, double t, const double *y, int holonomic, const double *residual) {
  const double rounding = 0x1p10 * DBL_EPSILON, time = holonomic || !(pb->span > 0) ? 1 : pb->span;
  ConstraintScratch w = layout(pb);
  double *terms = w.terms[holonomic], worst;
  int n = holonomic ? w.of->nholonomic : w.of->n, met = 1;
  /* terms from the last time suffice where the answer is clear */
  for (int k = 0; k < n; k++) met &= fabs(residual[k]) <= rounding * terms[k] / 4;
  if (met) return 1;
  if (lag_worst_constraint(pb, t, y, holonomic, &worst) < 0) return 0;
  if (worst <= 0x1p10) { /* only then: terms of a state off the constraints may have any size */
    memcpy(terms, w.g, (size_t)n * sizeof *terms);
    return 1;
  }
  /* a unit that was 0 throughout at the start has no scale: one unit counts */
  for (int e = 0; e < w.of->njacobian && pb->begin; e++) {
    const lag_entry *at = &w.of->jacobian[e];
    if (at->row < n && !(lag_unit_magnitude(pb, pb->begin, at->col) > 0)) w.g[at->row] += fabs(w.A[e]) / time;
  }
  met = pb->begin != NULL;
  for (int k = 0; k < n; k++) met &= fabs(residual[k]) <= rounding * w.g[k];
  return met;
}

/* A level of constraints: 1 of positions, 0 of velocities. c and r are the residuals of y, before and after. */
typedef struct Level {
  const ConstraintScratch *w;
  double t, *y;
  int holonomic;
} Level;

static double *residuals_of(const Level *l) { return l->holonomic ? l->w->c : l->w->r; }

/* Whether all residuals are roundings of their terms of first order: a function of the state, not of what came before,
 * so that resumed runs have the same bits. */
static int are_rounded(lag_problem *pb, const Level *l, int n, int turn) {
  const double rounding = 2 * DBL_EPSILON;
  double *size = l->w->size;
  if (turn == 1 && sizes(pb, l->w, l->t, l->y, l->holonomic, size)) memset(size, 0, (size_t)n * sizeof *size);
  int rounded = 1;
  for (int k = 0; k < n && rounded; k++) rounded = fabs(residuals_of(l)[k]) <= rounding * size[k];
  return rounded;
}

/* g := minus the residuals; 0 after a correction that leaves roundings, which are never 0 in all of many loops. Headers
 * have no such end, and to rounding the digits of models with so many. */
static int residuals(lag_problem *pb, const Level *l, int turn, double *g) {
  enum { MANY = 16 };
  int n = l->holonomic ? l->w->of->nholonomic : l->w->of->n;
  int rc = turn ? lag_residuals(pb, l->t, l->y, l->w->c, l->w->r) : 0;
  int done = rc == 0 && turn && n > MANY && are_rounded(pb, l, n, turn);
  for (int k = 0; k < n; k++) g[k] = done ? 0 : -residuals_of(l)[k];
  return rc;
}

static int correct(lag_problem *pb, const Level *l, const double *g, double *d) {
  int rc = lag_least_change(pb, l->t, l->y, l->holonomic, g, d, l->w->force);
  if (rc < 0 || (rc == 0 && lag_not_finite(pb->nq, d) < 0)) return rc;
  return report_unmet(pb, l->w, l->t, l->y, l->holonomic);
}

/* Instance of kernels/hold.h. */
#define LAG_HOLD_MODEL lag_problem *pb, const Level *l
#define LAG_HOLD_RESIDUALS(turn, g) residuals(pb, l, turn, g)
#define LAG_HOLD_CHANGE(g, d) correct(pb, l, g, d)
#define LAG_HOLD_ROUNDING(x, d, left) is_rounding(pb, x, d, left)
#define LAG_HOLD_MET(done) ((void)(done), lag_constraint_is_met(pb, l->t, l->y, l->holonomic, residuals_of(l)))
#include "kernels/hold.h"

static int newton(lag_problem *pb, const ConstraintScratch *w, double t, double *y, double *lost, int holonomic) {
  const Level l = {w, t, y, holonomic};
  int n = holonomic ? w->of->nholonomic : w->of->n, at = holonomic ? 0 : pb->nq, unmet = 0;
  const lag_held_level of = {n, pb->nq, y + at, lost ? lost + at : NULL, w->wanted, w->before, w->d};
  int rc = lag_hold_turns(pb, &l, &of, &unmet);
  return rc == 0 && unmet ? report_unmet(pb, w, t, y, holonomic) : rc;
}

int lag_project(lag_problem *pb, double t, double *y, double *lost) {
  if (!pb->model->constraints || lag_not_finite(pb->n, y) >= 0) { /* the method reports states that are not finite */
    return LAG_OK;
  }
  ConstraintScratch w = layout(pb);
  const char *said = pb->detail;
  int rc = lag_residuals(pb, t, y, w.c, w.r);

  rc = rc ? rc : newton(pb, &w, t, y, lost, 1);
  rc = rc ? rc : newton(pb, &w, t, y, lost, 0);
  pb->detail = rc ? pb->detail : said;
  return rc < LAG_ESINGULAR ? LAG_EMODEL : rc;
}

/* Largest distance of coordinate i from 0, now or at the start; at least 1e-10 of its unit. */
static double extent(const lag_problem *pb, const double *y0, const double *y, int i) {
  double begin = pb->begin ? lag_unit_magnitude(pb, pb->begin, i) : 0;
  return fmax(fmax(lag_typical_magnitude(pb, y0, 1, i), lag_typical_magnitude(pb, y, 1, i)), fmax(begin, 1e-10));
}

/* w->other[j] := the largest |led| of coordinates with the unit of i that a constraint on positions ties to j; for
 * the coordinates j of constraints. */
static void find_tied(const ConstraintScratch *w, const lag_problem *pb, const double *led, int i) {
  const lag_entry *e = w->of->jacobian, *end = e + w->of->njacobian;
  const lag_var *q = pb->model->q;
  double *row = w->before, *tied = w->other;
  for (int k = 0; k < w->of->nholonomic; k++) row[k] = 0;
  for (int j = 0; j < pb->nq; j++) tied[j] = 0;
  for (const lag_entry *a = e; a < end; a++)
    if (a->row < w->of->nholonomic && strcmp(q[a->col].unit, q[i].unit) == 0)
      row[a->row] = fmax(row[a->row], fabs(led[a->col]));
  for (const lag_entry *a = e; a < end; a++)
    if (a->row < w->of->nholonomic) tied[a->col] = fmax(tied[a->col], row[a->row]);
}

/* Largest part of its extent by which a step leads a coordinate that a constraint on positions ties to i. */
static double led_part(const ConstraintScratch *w, const lag_problem *pb, const double *y0, const double *y,
                       const double *led, int i) {
  const lag_entry *e = w->of->jacobian, *end = e + w->of->njacobian;
  double most = 0;
  for (const lag_entry *a = e; a < end; a++)
    for (const lag_entry *b = e; a->col == i && a->row < w->of->nholonomic && b < end; b++)
      if (b->row == a->row) most = fmax(most, fabs(led[b->col]) / extent(pb, y0, y, b->col));
  return most;
}

int lag_projection_leap(const lag_problem *pb, const double *y0, const double *y, const double *moved,
                        const double *led) {
  const ConstraintScratch w = layout(pb);
  const lag_var *q = pb->model->q;
  const double small = 1e-6;
  double reach = 0;
  int found = -1, like = -1; /* the coordinates for whose unit w.other is, and for which reach is */
  for (int i = 0; i < pb->nq; i++) {
    double most = fabs(led[i]);
    if (!(fabs(moved[i]) > 2 * most + small * fabs(y[i]))) continue;
    if (found < 0 || strcmp(q[found].unit, q[i].unit) != 0) find_tied(&w, pb, led, found = i);
    most = fmax(most, w.other[i]);
    if (like < 0 || !lag_are_alike(&q[like], &q[i])) reach = extent(pb, y0, y, like = i);
    if (!(fabs(moved[i]) > 2 * most + small * reach)) continue;
    const double part = led_part(&w, pb, y0, y, led, i);
    /* where a crank passes a dead centre its slider moves by the square of the turn */
    if (fabs(moved[i]) > 2 * most + (small + fmin(part * part, 1e-2)) * reach) return i;
  }
  return -1;
}

int lag_report_leap(lag_problem *pb, double t, const double *y, int i, double moved) {
  int k = lag_worst_constraint(pb, t, y, 1, NULL);
  if (k >= 0) {
    char words[128];
    const lag_var *q = &pb->model->q[i];
    snprintf(words, sizeof words,
             " after a step, and meeting it would move %s by %.3g %s: it jumps, or the step is too long", q->name,
             fabs(moved) / q->factor, q->unit);
    lag_report_residual(pb, k, 1, NAN, words);
  }
  pb->bad_t = t;
  return LAG_ERETRY;
}

int lag_project_step(lag_problem *pb, double t, const double *y0, double *y, double *lost) {
  if (!pb->model->constraints) return LAG_OK;
  ConstraintScratch w = layout(pb);
  size_t bytes = (size_t)pb->nq * sizeof(double);

  memcpy(w.step, y, bytes);
  int rc = lag_project(pb, t, y, lost);
  for (int i = 0; i < pb->nq; i++) {
    w.d[i] = y[i] - w.step[i];
    w.force[i] = w.step[i] - y0[i];
  }
  int i = rc ? -1 : lag_projection_leap(pb, y0, y, w.d, w.force);
  if (i < 0) return rc;
  double moved = w.d[i];
  memcpy(y, w.step, bytes);
  return lag_report_leap(pb, t, y, i, moved);
}

int lag_project_tangent(lag_problem *pb, double t, const double *y, double *e) {
  if (!pb->model->constraints) return LAG_OK;
  ConstraintScratch w = layout(pb);
  int nq = pb->nq, rc = lag_inputs(pb, t);

  rc = rc ? rc : w.of->matrices(w.of, t, y, y + nq, y + 2 * nq, pb->p, pb->u, w.A, w.M, pb->work);
  for (int level = 0; level < 2 && rc == 0; level++) {
    double *x = e + level * nq;
    if (!level && !w.of->nholonomic) continue;
    negative_product(&w, level ? w.of->n : w.of->nholonomic, x, w.g);
    rc = lag_least_change(pb, t, y, !level, w.g, w.d, w.force);
    for (int i = 0; i < nq && rc == 0; i++) x[i] += w.d[i];
  }
  return rc;
}
