/* Consistent states by damped Gauss-Newton steps, stage by stage; refusal of constraints that no force can hold. */
#include "numeric/consistent_state.h"

#include <math.h>
#include <string.h>

#include "numeric/magnitudes.h"

enum { MOST_STEPS = 100, MOST_HALVINGS = 30, TRIES = 9 };

void lag_loose_directions(int n, const double *held, const double *held_beside, double *loose) {
  const double part = 0.05; /* change of a squared projection: twice the effect of turning a direction by a hundredth */
  for (int i = 0; i < n; i++) loose[i] = held_beside[i] - held[i] > part;
}

static void copy(const lag_level *w, double *to, const double *from) { memcpy(to, from, (size_t)w->n * sizeof *to); }

/* The worst constraint at x, -1 where terms or residuals have no value; *times: its residual in units of the
 * rounding of its terms. */
static int worst(lag_level *w, double *times) {
  *times = HUGE_VAL;
  if (w->terms(w, w->terms_here) || w->residuals(w, w->residual)) return -1;
  return lag_worst_residual(w->rows, w->residual, w->terms_here, w->rounding, times);
}

/* Merit function: sum of squared residuals relative to their terms at the start. Infinite where it has no value, so
 * that no step leads there. */
static double merit(lag_level *w) {
  double s = 0;
  if (w->residuals(w, w->residual)) return HUGE_VAL;
  for (int k = 0; k < w->rows; k++) {
    double x = w->residual[k] / w->size[k];
    s += x * x;
  }
  return isfinite(s) ? s : HUGE_VAL;
}

static void move(lag_level *w, const double *from, double part) {
  for (int a = 0; a < w->nfree; a++) w->x[w->free[a]] = from[w->free[a]] + part * w->d[a];
}

double lag_level_weight(const lag_level *w, int i) {
  const double open = 1e-3;
  return w->at > LAG_MOVES_FIRST && !w->alike && w->stage(w, i) < w->at ? open : 1;
}

/* The part of the step d that moves no position by more than half of what is typical: far steps lead to other
 * solutions. The whole step where it solves the problem, as where constraints are linear. */
static double longest_part(lag_level *w, double before) {
  double part = 1;
  if (!w->positions) return 1;
  move(w, w->from, 1);
  if (merit(w) <= 1e-20 * before) return 1;
  w->scales(w, w->x, w->reach);
  for (int a = 0; a < w->nfree; a++) {
    double most = 0.5 * w->reach[w->free[a]], d = fabs(w->d[a]);
    if (most > 0 && d * part > most) part = most / d;
  }
  return part;
}

/* Whether the constraints hold to rounding: of their terms here, or at the request, from which components have come
 * that are near 0. */
static int arrived(lag_level *w) {
  double times;
  if (w->terms(w, w->terms_here) || w->residuals(w, w->residual)) return 0;
  for (int k = 0; k < w->rows; k++) w->terms_here[k] = fmax(w->terms_here[k], w->has_terms[k] != 0.0 ? w->size[k] : 0);
  lag_worst_residual(w->rows, w->residual, w->terms_here, w->rounding, &times);
  return times <= 0x1p10;
}

/* Damped Gauss-Newton steps from x; returns whether they arrive at the constraints. */
static int descend(lag_level *w) {
  double before = merit(w);
  for (int step = 0; step < MOST_STEPS && before > 0 && w->nfree > 0; step++) {
    double now = HUGE_VAL;
    copy(w, w->from, w->x);
    if (w->direction(w, 0, w->d)) return 0;
    double part = longest_part(w, before);
    for (int i = 0; i < MOST_HALVINGS && !(now < before); i++, part /= 2) {
      move(w, w->from, part);
      now = merit(w);
    }
    if (!(now <= before)) copy(w, w->x, w->from);
    if (!(now < before * (1 - 1e-6))) break;
    before = now;
  }
  return arrived(w);
}

/* Goes a part of the step along[n] from best, and to the constraints; returns whether that is nearer to `asked`. */
static int is_nearer(lag_level *w, double part, double before) {
  for (int a = 0; a < w->nfree; a++) w->x[w->free[a]] = w->best[w->free[a]] + part * w->along[a];
  return descend(w) && w->distance(w) < before * (1 - 1e-14);
}

/* Moves x along the constraints towards `asked`, as long as steps, or parts of them, lead nearer. */
static void approach(lag_level *w) {
  const double least = 1e-3;
  int nearer = 1;
  for (int step = 0; step < MOST_STEPS && nearer; step++) {
    double part = 1, before;
    copy(w, w->best, w->x);
    if (w->residuals(w, w->residual) || w->direction(w, 1, w->along)) break;
    before = w->distance(w);
    while (!(nearer = is_nearer(w, part, before)) && part > least) part /= 2;
    if (!nearer) copy(w, w->x, w->best);
  }
}

/* Whether a constraint contains component i. */
static int is_held(const lag_level *w, int i) {
  int e = 0;
  while (e < w->entries && !(w->row[e] < w->rows && w->col[e] == i)) e++;
  return e < w->entries;
}

/* Whether x is as near to the request as to leave no other solution nearer, for all that one looks: within a tenth
 * of what is typical. */
static int is_near(lag_level *w) {
  int near = 1;
  w->scales(w, w->asked, w->reach);
  for (int i = 0; i < w->n; i++) near &= fabs(w->x[i] - w->asked[i]) <= 0.1 * w->reach[i];
  return near;
}

/* x := place k of the search: the request, then states displaced from it, ever further. */
static void go_to_place(lag_level *w, int k) {
  static const double beside[TRIES] = {0, 1e-3, -1e-3, 0.03, -0.03, 0.3, -0.3, 1, -1};
  double typical = 0;
  for (int i = 0; i < w->n; i++) typical = fmax(typical, fabs(w->asked[i]));
  copy(w, w->x, w->asked);
  for (int a = 0; a < w->nfree; a++) w->x[w->free[a]] += beside[k] * (typical > 0 ? typical : 1) * lag_uneven(a);
}

/* x := a state as far from the request as the nearest one found, or a half or a third as far, in some direction. */
static void go_around(lag_level *w, int k) {
  double far = 0;
  w->scales(w, w->asked, w->reach);
  for (int i = 0; i < w->n; i++)
    far = w->reach[i] > 0 ? fmax(far, fabs(w->nearest[i] - w->asked[i]) / w->reach[i]) : far;
  copy(w, w->x, w->asked);
  for (int a = 0; a < w->nfree; a++)
    w->x[w->free[a]] += far / (1 + k % 3) * w->reach[w->free[a]] * (k >> a % 8 & 1 ? 1 : -1) * lag_uneven(a + k);
}

/* Whether x is another place than `nearest`, and not by whole turns. */
static int is_elsewhere(const lag_level *w) {
  const double turn = 6.283185307179586477;
  for (int a = 0; a < w->nfree; a++) {
    double d = w->x[w->free[a]] - w->nearest[w->free[a]], left = d - turn * round(d / turn);
    if (fabs(left) > 1e-3 * w->reach[w->free[a]]) return 1;
  }
  return 0;
}

/* Notes that x is a solution, too: the nearest one, or another one. */
static void note_other(lag_level *w, int nearer, double far, double *next) {
  int isolated = w->at == LAG_MOVES_FIRST && w->nfree <= w->rows;
  w->scales(w, w->asked, w->reach);
  if (!isolated || !is_elsewhere(w) || (!nearer && w->ambiguous && !(far < *next))) return;
  copy(w, w->other, nearer ? w->nearest : w->x);
  *next = nearer ? HUGE_VAL : far;
  w->ambiguous = 1;
}

/* Goes from x to the constraints, and along them towards the request; keeps the state if it is nearer than least[0];
 * least[1]: distance of the other solution. */
static void try_from_here(lag_level *w, double *least) {
  if (!descend(w)) return;
  approach(w);
  double far = w->distance(w);
  int nearer = far < *least * (1 - 1e-9);
  if (*least < HUGE_VAL) note_other(w, nearer, far, least + 1);
  if (!nearer) return;
  *least = far;
  copy(w, w->nearest, w->x);
}

/* Reaches the constraints by moving free components. Positions: the first place that leads there; where that is far
 * from the request, the nearest of solutions from all around. */
static int reach_constraints(lag_level *w) {
  enum { AROUND = 24, FEW = 24 }; /* places; components that may move: a search of many takes long */
  double least[2] = {HUGE_VAL, HUGE_VAL};
  w->ambiguous = 0;
  if (!w->positions) return w->nfree > 0 && (go_to_place(w, 0), descend(w));
  for (int k = 0; k < TRIES && w->nfree > 0 && !(*least < HUGE_VAL); k++) {
    go_to_place(w, k);
    try_from_here(w, least);
  }
  for (int k = 0; k < AROUND && w->at == LAG_MOVES_LAST && w->nfree <= FEW && !(*least < HUGE_VAL); k++) {
    w->scales(w, w->asked, w->reach);
    for (int i = 0; i < w->n; i++) w->nearest[i] = w->asked[i] + 3 * w->reach[i]; /* an angle may have to turn round */
    go_around(w, k);
    try_from_here(w, least);
  }
  if (!(*least < HUGE_VAL)) return 0;
  copy(w, w->x, w->nearest);
  for (int k = 0; k < AROUND && w->nfree <= FEW && !is_near(w); k++) {
    go_around(w, k);
    try_from_here(w, least);
    copy(w, w->x, w->nearest);
  }
  return 1;
}

/* w->free := the components that may move at this stage. */
static void choose_free(lag_level *w, int stage) {
  w->nfree = 0;
  w->at = stage;
  for (int i = 0; i < w->n; i++)
    if (w->stage(w, i) <= stage && is_held(w, i)) w->free[w->nfree++] = i;
}

/* ---- states that are refused */

/* The worst constraint, which cannot be met, or is not met by a state that must hold exactly. */
static lag_start_kind refuse(lag_level *w, lag_start_kind kind, int *constraint) {
  double times;
  *constraint = worst(w, &times);
  return *constraint < 0 || !isfinite(w->residual[*constraint]) ? LAG_START_NO_VALUE : kind;
}

/* slope[rows] := first-order change of each constraint when every component moves by its typical magnitude, here or
 * as requested. */
static int find_slopes(lag_level *w) {
  double *here = w->from, *asked = w->d;
  memset(w->slope, 0, (size_t)w->rows * sizeof *w->slope);
  if (w->jacobian(w, w->A)) return 0;
  w->scales(w, w->x, here);
  w->scales(w, w->asked, asked);
  for (int e = 0; e < w->entries; e++)
    if (w->row[e] < w->rows) w->slope[w->row[e]] += fabs(w->A[e]) * fmax(here[w->col[e]], asked[w->col[e]]);
  return 1;
}

static int is_flat(const lag_level *w, int k) { return w->has_terms[k] != 0.0 && w->slope[k] < 1e-6 * w->size[k]; }

/* Moves x by a hundredth, in components that a constraint contains or in all, then to the constraints; returns
 * whether it arrives. */
static int go_beside(lag_level *w, int all) {
  choose_free(w, LAG_MOVES_LAST);
  w->scales(w, w->x, w->d);
  for (int i = 0; i < w->n; i++) w->x[i] += !all && !is_held(w, i) ? 0 : 0.01 * w->d[i] * lag_uneven(i);
  return descend(w);
}

/* Whether constraint k, whose derivatives vanish at x, has vanishing derivatives at a displaced solution, too; not
 * so for a linkage at its dead centre. x stays. */
static int is_flat_beside(lag_level *w, int k) {
  copy(w, w->best, w->x);
  int flat = !go_beside(w, 0) || !find_slopes(w) || is_flat(w, k);
  copy(w, w->x, w->best);
  find_slopes(w);
  return flat;
}

/* Refuses a constraint whose derivatives vanish where it holds, as those of x^2 = 0: no force can hold it. A
 * constraint without terms, as with a factor that is 0, is left alone. reached: x obeys the constraints; else
 * w->residual are those at x. */
static lag_start_kind check_derivatives(lag_level *w, int reached, int *constraint) {
  if (!w->positions || !find_slopes(w)) return LAG_START_FOUND;
  for (int k = 0; k < w->rows; k++) {
    if (w->is_contact(w, k)) continue;
    *constraint = k;
    if (!isfinite(w->slope[k]) && reached) return LAG_START_STEEP;
    int holds = reached || fabs(w->residual[k]) <= 1e-6 * w->size[k];
    if (is_flat(w, k) && holds && (!reached || is_flat_beside(w, k))) return LAG_START_FLAT;
  }
  return LAG_START_FOUND;
}

/* w->size := sizes of terms at x, 1 where there are none; w->has_terms: whether there are. */
static void look_at_terms(lag_level *w) {
  int rc = w->terms(w, w->size);
  for (int k = 0; k < w->rows; k++) {
    w->has_terms[k] = rc == 0 && w->size[k] > 0 && isfinite(w->size[k]);
    w->size[k] = w->has_terms[k] != 0.0 ? w->size[k] : 1;
  }
}

static lag_start_kind find_state(lag_level *w, int *constraint) {
  double off;
  *constraint = -1;
  if (w->rows == 0) return LAG_START_FOUND;
  copy(w, w->asked, w->x);
  worst(w, &off);
  look_at_terms(w);
  if (!isfinite(merit(w))) return refuse(w, LAG_START_NONE, constraint);
  if (off <= 2) return check_derivatives(w, 1, constraint);
  if (w->exactly && !(off <= sqrt(w->rounding) / w->rounding)) return refuse(w, LAG_START_BROKEN, constraint);
  w->alike = 0;
  for (int stage = LAG_MOVES_FIRST; stage <= LAG_MOVES_LAST; stage++) {
    int before = w->nfree;
    choose_free(w, stage);
    if ((stage == LAG_MOVES_FIRST || w->nfree != before) && reach_constraints(w))
      return check_derivatives(w, 1, constraint);
  }
  w->alike = 1;
  if (reach_constraints(w)) return check_derivatives(w, 1, constraint);
  copy(w, w->x, w->asked);
  descend(w); /* as near as possible, for the message */
  lag_start_kind kind = check_derivatives(w, 0, constraint);
  return kind != LAG_START_FOUND ? kind : refuse(w, LAG_START_NONE, constraint);
}

lag_start_kind lag_consistent_state(lag_level *w, int *constraint) {
  w->ambiguous = 0;
  lag_start_kind kind = find_state(w, constraint), with = kind;
  while (!w->positions && w->close_gap && with == LAG_START_FOUND && w->close_gap(w)) {
    int which;
    copy(w, w->nearest, w->x);
    copy(w, w->x, w->asked);
    with = find_state(w, &which);
    if (with != LAG_START_FOUND) copy(w, w->x, w->nearest);
  }
  return kind;
}

/* Number of components, free or not, that differ from the request. */
static int count_moved(const lag_level *w, int free) {
  int moved = 0;
  for (int i = 0; i < w->n; i++) {
    int a = 0;
    while (a < w->nfree && w->free[a] != i) a++;
    moved += (a < w->nfree) == free && (w->x[i] > w->asked[i] || w->x[i] < w->asked[i]);
  }
  return moved;
}

/* Whether A d = -change. */
static int meets_change(lag_level *w, const double *change) {
  const double rounding = 1e-9, of_others = 1e-13; /* lag_kkt solves to about 1e-12 of the terms; zeros to rounding */
  double most = 0;
  int meets = 1;
  for (int k = 0; k < w->rows; k++) w->slope[k] = change[k], w->terms_here[k] = fabs(change[k]);
  for (int a = 0; a < w->nfree; a++)
    for (int e = 0; e < w->entries; e++)
      if (w->row[e] < w->rows && w->col[e] == w->free[a])
        w->slope[w->row[e]] += w->A[e] * w->d[a], w->terms_here[w->row[e]] += fabs(w->A[e] * w->d[a]);
  for (int k = 0; k < w->rows; k++) most = fmax(most, w->terms_here[k]);
  for (int k = 0; k < w->rows; k++) meets &= fabs(w->slope[k]) <= rounding * w->terms_here[k] + of_others * most;
  return meets;
}

int lag_state_change(lag_level *w, const double *change, double *d) {
  memset(d, 0, (size_t)w->n * sizeof *d);
  w->alike = 0;
  for (int stage = LAG_MOVES_FIRST; stage <= LAG_MOVES_LAST && w->rows; stage++) {
    choose_free(w, stage);
    memcpy(w->residual, change, (size_t)w->rows * sizeof *change);
    if (!w->nfree || count_moved(w, 0) || w->direction(w, 0, w->d) || !meets_change(w, change)) continue;
    for (int a = 0; a < w->nfree; a++) d[w->free[a]] = w->d[a];
    return w->nfree <= w->rows || !count_moved(w, 1);
  }
  return w->rows == 0;
}

int lag_state_beside(lag_level *w) {
  look_at_terms(w);
  return go_beside(w, 1);
}
