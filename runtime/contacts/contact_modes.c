/* The modes of contacts with friction, by trying all combinations, or by changes of single ones. Contract:
 * contact_modes.h. */
#include "contacts/contact_modes.h"

#include <math.h>
#include <string.h>

#include "numeric/complementarity.h"
#include "numeric/dense.h"

/* Relative tolerances: of a force or an acceleration that may be 0; of two motions that are one. Forces that
 * contacts share are those of least size, as by springs that give way by `soft` of an acceleration, if they obey
 * Coulomb's law, else others that do. */
static const double nothing = 1e-9, alike = 1e-6, soft = 1e-12;

typedef struct Trial {
  int n, rows;
  lag_touch *of;
  const double *W, *pull;
  int held[2 * LAG_MOST_TOUCHES]; /* rows whose acceleration is 0 */
  double first_size[2 * LAG_MOST_TOUCHES];
  int edge[LAG_MOST_TOUCHES];
  int may_wedge; /* forces that only their own size bounds, and prestress */
  /* [sets of closed contacts, as bits] some of them can press on each other without any load */
  unsigned char prestress[1 << LAG_TRIED_TOUCHES];
  int breaks; /* contacts at rest that slip although static friction may hold them */
  /* [rows], [rows rows], accelerations, those of the first motion found, forces of it, sizes of the terms */
  double *x, *A, *a, *first, *force, *size;
} Trial;

/* Mode number k of a contact, in the order in which they are tried; 0: there are no more. A guide has no open one, and
 * slips with a force to either side, from which those of several components are sought. */
static int choose(lag_touch *c, int k) {
  static const lag_contact_mode modes[] = {LAG_CONTACT_STICKS, LAG_CONTACT_SLIPS, LAG_CONTACT_SLIPS, LAG_CONTACT_OPEN};
  if (k >= (c->guide ? 5 : 4)) return 0;
  c->mode = c->guide ? modes[k > 0] : modes[k];
  c->to = (c->guide ? k % 2 == 0 : k == 2) ? -1 : 1;
  c->presses = k > 2 ? -1 : 1;
  return 1;
}

/* Whether a contact may have its present mode. */
static int may_be(const lag_touch *c) {
  if (c->mode == LAG_CONTACT_STICKS) return c->tangent >= 0 && c->mu > 0 && c->slip == 0 && !c->cannot_stick;
  if (c->mode == LAG_CONTACT_SLIPS) return c->tangent < 0 || c->second ? c->to > 0 : c->slip == 0 || c->slip == c->to;
  return 1;
}

/* Row k says that its acceleration is 0 (held), or x[k] + factor x[other] = 0. */
static void set_row(Trial *t, int k, int held, int other, double factor) {
  double *row = t->A + k * t->rows;
  memcpy(row, t->W + k * t->rows, (size_t)t->rows * sizeof *row);
  if (held) row[k] = row[k] > 0 ? row[k] * (1 + soft) : 1;
  else memset(row, 0, (size_t)t->rows * sizeof *row);
  if (!held) {
    row[k] = 1;
    if (other >= 0) row[other] = factor;
  }
  t->x[k] = held ? -t->pull[k] : 0;
  t->held[k] = held;
}

/* Row i says that x[i] is the force of its guide along `toward`. */
static void set_guide_row(Trial *t, int i) {
  const lag_touch *c = &t->of[i];
  set_row(t, i, 0, -1, 0);
  for (int k = 0; k < c->parts; k++) {
    const double *from = c->pressed + k * (1 + t->rows);
    t->x[i] += c->toward[k] * from[0];
    for (int j = 0; j < t->rows; j++) t->A[i * t->rows + j] -= c->toward[k] * from[1 + j];
  }
}

static void set_rows(Trial *t) {
  for (int i = 0; i < t->n; i++) {
    const lag_touch *c = &t->of[i];
    if (c->guide) set_guide_row(t, i);
    else set_row(t, i, c->mode != LAG_CONTACT_OPEN, -1, 0);
    for (int k = 0; k <= (c->second > 0) && c->tangent >= 0; k++)
      set_row(t, k ? c->second : c->tangent, c->mode == LAG_CONTACT_STICKS, c->mode == LAG_CONTACT_SLIPS ? i : -1,
              (c->second ? c->way[k] : c->to) * c->mu);
  }
}

static void find_accelerations(Trial *t) {
  for (int k = 0; k < t->rows; k++) {
    t->a[k] = t->pull[k];
    t->size[k] = fabs(t->pull[k]);
    for (int j = 0; j < t->rows; j++) {
      t->a[k] += t->W[k * t->rows + j] * t->x[j];
      t->size[k] += fabs(t->W[k * t->rows + j] * t->x[j]);
    }
  }
}

/* Turns `toward` of guide c into the direction of its force at x. Returns whether it has turned. */
static int turn_guide(const Trial *t, lag_touch *c) {
  double N[3], size = 0, turned = 0;
  for (int k = 0; k < c->parts; k++) {
    const double *from = c->pressed + k * (1 + t->rows);
    N[k] = from[0];
    for (int j = 0; j < t->rows; j++) N[k] += from[1 + j] * t->x[j];
    size = hypot(size, N[k]);
  }
  for (int k = 0; k < c->parts && size > 0; k++) {
    turned = fmax(turned, fabs(N[k] / size - c->toward[k]));
    c->toward[k] = N[k] / size;
  }
  return turned > nothing;
}

static double friction_of(const Trial *t, const lag_touch *c) {
  return c->second ? hypot(t->x[c->tangent], t->x[c->second]) : fabs(t->x[c->tangent]);
}

/* Whether c begins to slip in space, in a direction that is sought. */
static int seeks_way(const lag_touch *c) { return c->second && c->mode == LAG_CONTACT_SLIPS && !c->slip; }

/* Turns the way of slipping of c to that of the acceleration, where friction has the same size: by a step of a
 * projected gradient. Returns whether it has turned. */
static int turn_way(const Trial *t, lag_touch *c) {
  const double *W = t->W, a[2] = {t->a[c->tangent], t->a[c->second]};
  double by = c->mu * t->x[(int)(c - t->of)] *
              (W[c->tangent * t->rows + c->tangent] + W[c->second * t->rows + c->second]);
  double next[2] = {c->way[0] * by + a[0], c->way[1] * by + a[1]}, size = hypot(next[0], next[1]), turned = 0;
  for (int k = 0; k < 2 && size > 0; k++) {
    turned = fmax(turned, fabs(next[k] / size - c->way[k]));
    c->way[k] = next[k] / size;
  }
  return turned > nothing;
}

/* First ways of slipping in space: against the forces that would hold the contacts. Returns whether some are sought. */
static int choose_ways(Trial *t) {
  int seeks[LAG_MOST_TOUCHES], some = 0;
  for (int i = 0; i < t->n; i++) {
    some |= seeks[i] = seeks_way(&t->of[i]);
    if (seeks[i]) t->of[i].mode = LAG_CONTACT_STICKS;
  }
  if (!some) return 0;
  set_rows(t);
  int rc = lag_solve_dense((size_t)t->rows, 1, t->A, t->x);
  for (int i = 0; i < t->n; i++) {
    lag_touch *c = &t->of[i];
    if (!seeks[i]) continue;
    double size = rc ? 0 : friction_of(t, c);
    c->mode = LAG_CONTACT_SLIPS;
    c->way[0] = size > 0 ? -t->x[c->tangent] / size : 1;
    c->way[1] = size > 0 ? -t->x[c->second] / size : 0;
  }
  return 1;
}

/* Forces of the modes: of guides with several components by Newton's method, of the others at once. 0: none, or a
 * guide slips that presses to its other side. */
static int solve(Trial *t) {
  enum { ROUNDS = 50, OF_WAYS = 2000 };
  int turned = 1, rounds = choose_ways(t) ? OF_WAYS : ROUNDS;
  for (int i = 0; i < t->n; i++)
    for (int k = 0; k < t->of[i].parts; k++) t->of[i].toward[k] = k ? 0 : t->of[i].presses;
  for (int round = 0; turned && round < rounds; round++) {
    set_rows(t);
    if (lag_solve_dense((size_t)t->rows, 1, t->A, t->x)) return 0;
    turned = 0;
    for (int i = 0; i < t->n; i++) {
      lag_touch *c = &t->of[i];
      int other = c->guide && turn_guide(t, c);
      if (other && c->parts == 1 && c->mode == LAG_CONTACT_SLIPS) return 0;
      turned |= other;
    }
    find_accelerations(t);
    for (int i = 0; i < t->n; i++) turned |= seeks_way(&t->of[i]) && turn_way(t, &t->of[i]);
  }
  find_accelerations(t);
  return !turned;
}

/* The acceleration that unit force of row k makes there. */
static double response(const Trial *t, int k) { return t->W[k * t->rows + k]; }

/* Scale of row k. */
static double scale(const Trial *t, int k) { return response(t, k) > 0 ? 1 / sqrt(response(t, k)) : 1; }

/* Whether forces D change no acceleration, beside the largest of their terms: those of a row may be rounding all. */
static int changes_nothing(const Trial *t, const double *D) {
  double most = 0, size = 0;
  for (int k = 0; k < t->rows; k++) {
    double a = 0, terms = 0;
    for (int j = 0; j < t->rows; j++) {
      a += t->W[k * t->rows + j] * D[j];
      terms += fabs(t->W[k * t->rows + j] * D[j]);
    }
    most = fmax(most, scale(t, k) * fabs(a));
    size = fmax(size, scale(t, k) * terms);
  }
  return most <= alike * size;
}

/* D[directions][rows] := changes of the forces that change no acceleration. Returns their number. */
static int free_forces(Trial *t, double *D) {
  int n = t->rows, count = 0;
  double pivot[2 * LAG_MOST_TOUCHES], none[2 * LAG_MOST_TOUCHES] = {0}, x[2 * LAG_MOST_TOUCHES];
  memcpy(x, t->x, (size_t)n * sizeof *x);
  set_rows(t);
  memcpy(t->x, x, (size_t)n * sizeof *x);
  for (int k = 0; k < n; k++) {
    double *row = t->A + k * n;
    int held = t->held[k];
    if (held) row[k] = response(t, k);
    for (int j = 0; j < n; j++) row[j] *= (held ? scale(t, k) : 1 / scale(t, k)) * scale(t, j);
  }
  lag_gauss_jordan(n, t->A, none, pivot, lag_dependent_row);
  for (int j = 0; j < n; j++) {
    int has_pivot = 0;
    for (int r = 0; r < n; r++) has_pivot |= pivot[r] == j;
    if (has_pivot) continue;
    double *d = D + count * n;
    for (int k = 0; k < n; k++) d[k] = k == j ? scale(t, j) : 0;
    for (int r = 0; r < n; r++)
      if (pivot[r] >= 0) d[(int)pivot[r]] = -t->A[r * n + j] / t->A[r * n + (int)pivot[r]] * scale(t, (int)pivot[r]);
    count += changes_nothing(t, d);
  }
  return count;
}

static int is_shared(Trial *t) {
  double D[4 * LAG_MOST_TOUCHES * LAG_MOST_TOUCHES];
  return free_forces(t, D) > 0;
}

static double rounding(const Trial *t, int k) { return response(t, k) > 0 ? nothing * t->size[k] / response(t, k) : 0; }

/* Whether row k has no acceleration. */
static int rests(const Trial *t, int k) { return fabs(t->a[k]) <= alike * t->size[k]; }

/* Whether forces and accelerations are allowed in the contact's mode. */
static int fits(const Trial *t, int i) {
  const lag_touch *c = &t->of[i];
  if (c->mode == LAG_CONTACT_OPEN) return t->a[i] >= -nothing * t->size[i];
  if (!c->guide && (!(t->x[i] > rounding(t, i)) || !(response(t, i) > 0) || !rests(t, i))) return 0;
  if (c->mode == LAG_CONTACT_STICKS)
    return rests(t, c->tangent) && (!c->second || rests(t, c->second)) &&
           friction_of(t, c) <= lag_touch_holds(c) * t->x[i] * (1 + nothing) + rounding(t, c->tangent);
  if (c->second && !c->slip)
    return c->way[0] * t->a[c->tangent] + c->way[1] * t->a[c->second] >=
           -nothing * (t->size[c->tangent] + t->size[c->second]);
  return c->tangent < 0 || c->slip || c->to * t->a[c->tangent] >= -nothing * t->size[c->tangent];
}

static int all_fit(const Trial *t) {
  int i = 0;
  while (i < t->n && fits(t, i)) i++;
  return i == t->n;
}

/* Forces of a combination: unique; shared, and of least size; shared, and others chosen within Coulomb's cones. */
enum { NONE, UNIQUE, LEAST, CHOSEN };

/* Chooses forces within Coulomb's cones, and returns whether the bodies are wedged: their size is arbitrary. */
static int choose_forces(Trial *t) {
  double D[4 * LAG_MOST_TOUCHES * LAG_MOST_TOUCHES], c[2 * LAG_MOST_TOUCHES + 1];
  int n = free_forces(t, D), wedged = lag_cone_forces(t->n, t->of, t->rows, t->x, n, D, c);
  find_accelerations(t);
  return wedged;
}

/* Whether static friction, larger than that of slipping, may hold a contact at rest. */
static int is_held(const lag_touch *c) {
  return c->tangent >= 0 && c->slip == 0 && !c->cannot_stick && c->hold > c->mu;
}

static int count_breaks(const Trial *t) {
  int n = 0;
  for (int i = 0; i < t->n; i++) n += is_held(&t->of[i]) && t->of[i].mode == LAG_CONTACT_SLIPS;
  return n;
}

/* Whether contacts a and others in `set` press on each other, each of them needed: forces p > 0 without a load, as
 * on both sides of a rail. */
static int is_ring(const Trial *t, int set, int a) {
  double A[LAG_MOST_TOUCHES * LAG_MOST_TOUCHES], p[LAG_MOST_TOUCHES], left = 1;
  int of[LAG_MOST_TOUCHES], n = 0;
  for (int i = 0; i < t->n; i++) {
    if (set >> i & 1 && !(response(t, i) > 0)) return 0;
    if (i != a && set >> i & 1) of[n++] = i;
  }
  for (int k = 0; k < n * n; k++)
    A[k] = t->W[of[k / n] * t->rows + of[k % n]] * scale(t, of[k / n]) * scale(t, of[k % n]);
  for (int k = 0; k < n; k++) p[k] = -t->W[of[k] * t->rows + a] * scale(t, of[k]) * scale(t, a);
  if (n == 0 || lag_solve_dense((size_t)n, 1, A, p)) return 0;
  for (int k = 0; k < n; k++) {
    if (!(p[k] > alike)) return 0;
    left += p[k] * t->W[a * t->rows + of[k]] * scale(t, of[k]) * scale(t, a);
  }
  return fabs(left) <= lag_dependent_row;
}

static void find_prestress(Trial *t) {
  for (int set = 1; set < 1 << t->n; set++) {
    int first = 0, some = 0;
    for (int i = t->n - 1; i >= 0; i--) {
      if (!(set >> i & 1)) continue;
      first = i;
      some |= t->prestress[set & ~(1 << i)];
    }
    t->prestress[set] = some || is_ring(t, set, first);
  }
}

/* Whether closed contacts can press on each other by a force that nothing determines; the least is none: one of them
 * is open. */
static int has_prestress(const Trial *t) {
  int set = 0;
  for (int i = 0; i < t->n; i++) set |= (t->of[i].mode != LAG_CONTACT_OPEN) << i;
  return t->prestress[set];
}

static int find_motion(Trial *t) {
  if (count_breaks(t) != t->breaks || (!t->may_wedge && has_prestress(t))) return NONE;
  for (int i = 0; i < t->n; i++)
    if (!may_be(&t->of[i])) return NONE;
  if (!solve(t)) return NONE;
  if (all_fit(t)) return is_shared(t) ? LEAST : UNIQUE;
  return is_shared(t) && (!choose_forces(t) || t->may_wedge) && all_fit(t) ? CHOSEN : NONE;
}

static int same_motion(const Trial *t) {
  for (int k = 0; k < t->rows; k++)
    if (!(fabs(t->a[k] - t->first[k]) <= alike * fmax(t->size[k], t->first_size[k]))) return 0;
  return 1;
}

/* The next combination, k[n] being the numbers of the modes; 0: that was the last. */
static int next(Trial *t, int *k) {
  for (int i = 0; i < t->n; i++) {
    if (choose(&t->of[i], ++k[i])) return 1;
    choose(&t->of[i], k[i] = 0);
  }
  return 0;
}

/* Guides that slip press to the sides that the last solution shows. Returns whether one has changed. */
static int change_sides(const Trial *t) {
  int changed = 0;
  for (int i = 0; i < t->n; i++) {
    lag_touch *c = &t->of[i];
    int presses = c->toward[0] < 0 ? -1 : 1;
    if (!c->guide || c->parts != 1 || c->mode != LAG_CONTACT_SLIPS || presses == c->presses) continue;
    c->presses = presses;
    changed = 1;
  }
  return changed;
}

/* Where a contact begins to slip: edge[n] := whether no forces hold the contacts at rest but with this one at the
 * edge of its cone; the side to which it would slip. */
static void find_edges(Trial *t) {
  int leaves = 0;
  for (int i = 0; i < t->n; i++) {
    lag_touch *c = &t->of[i];
    leaves |= c->cannot_stick;
    c->mode = c->tangent >= 0 && c->slip == 0 ? LAG_CONTACT_STICKS : LAG_CONTACT_SLIPS;
    c->to = c->slip ? c->slip : 1;
    c->presses = 1;
  }
  for (int turn = 0; leaves && !solve(t); turn++)
    if (turn == t->n || !change_sides(t)) return;
  if (!leaves) return;
  choose_forces(t);
  for (int i = 0; i < t->n; i++) {
    const lag_touch *c = &t->of[i];
    double most = lag_touch_holds(c) * t->x[i], force = c->tangent >= 0 ? friction_of(t, c) : 0;
    if (c->mode == LAG_CONTACT_STICKS && most - force <= alike * (fabs(most) + force))
      t->edge[i] = t->x[c->tangent] > 0 ? -1 : 1;
  }
}

/* Choices that are one motion: the lowest rank is taken. The fewest contacts slip, but all those that begin to; and
 * forces are those of least size. */
static int rank_of(const Trial *t, int kind) {
  int rank = kind == CHOSEN;
  for (int i = 0; i < t->n; i++)
    rank += t->of[i].tangent >= 0 && t->of[i].mode == LAG_CONTACT_SLIPS ? t->edge[i] ? -2 : 2 : 0;
  return rank;
}

static void keep(const Trial *t, lag_touch *found, int kind) {
  size_t bytes = (size_t)t->rows * sizeof(double);
  memcpy(found, t->of, (size_t)t->n * sizeof *found);
  memcpy(t->force, t->x, bytes);
  for (int i = 0; i < t->n; i++) found[i].shared = kind != UNIQUE && found[i].mode == LAG_CONTACT_STICKS;
}

/* Prestress of a motion: contacts at their limits that begin no slip, or do not open; and the size of the forces. */
typedef struct Prestress {
  int idle;
  double size;
} Prestress;

static Prestress prestress_of(const Trial *t) {
  Prestress p = {0, 0};
  for (int i = 0; i < t->n; i++) {
    const lag_touch *c = &t->of[i];
    const int slips = c->mode == LAG_CONTACT_SLIPS && c->tangent >= 0 && !c->slip;
    p.size += response(t, c->guide ? c->tangent : i) * t->x[i] * t->x[i];
    if (slips) p.idle += rests(t, c->tangent) && (!c->second || rests(t, c->second));
    else p.idle += c->mode == LAG_CONTACT_OPEN && rests(t, i);
  }
  return p;
}

/* Of two motions by different prestress the one with less counts: -1, a; 1, b; 0: neither, as without prestress. */
static int with_less(const Prestress *a, const Prestress *b) {
  if (a->idle != b->idle) return a->idle < b->idle ? -1 : 1;
  if (a->idle == 0 || fabs(a->size - b->size) <= alike * (a->size + b->size)) return 0;
  return a->size < b->size ? -1 : 1;
}

/* Tries all combinations; found := the motion, if there is one. */
static int try_all(Trial *t, lag_touch *found) {
  int k[LAG_MOST_TOUCHES] = {0}, motions = 0, rank = 0, kind;
  Prestress least = {0, 0};
  for (int i = 0; i < t->n; i++) choose(&t->of[i], 0);
  do {
    if ((kind = find_motion(t)) == NONE) continue;
    const Prestress now = prestress_of(t);
    const int differs = motions && !same_motion(t), order = differs ? with_less(&now, &least) : 0;
    if (differs && order == 0) motions = 2;
    if (differs ? order >= 0 : motions && rank_of(t, kind) >= rank) continue;
    if (!motions || differs) {
      memcpy(t->first, t->a, (size_t)t->rows * sizeof *t->a);
      memcpy(t->first_size, t->size, (size_t)t->rows * sizeof *t->a);
      least = now;
      motions = 1;
    }
    rank = rank_of(t, kind);
    keep(t, found, kind);
  } while (next(t, k));
  return motions;
}

/* Tries all combinations with as few contacts that break loose as have a motion. */
static int try_breaks(Trial *t, lag_touch *found) {
  int most = 0, motions = 0;
  for (int i = 0; i < t->n; i++) most += is_held(&t->of[i]);
  for (t->breaks = 0; t->breaks <= most && !motions; t->breaks++) motions = try_all(t, found);
  return motions;
}

/* ---- more contacts than combinations can be tried of */

/* The mode with which the search begins: closed, sticking at rest, but for contacts that begin to slip together. */
static void choose_first(const Trial *t, int i) {
  lag_touch *c = &t->of[i];
  c->mode = LAG_CONTACT_STICKS;
  c->mode = may_be(c) && !t->edge[i] ? LAG_CONTACT_STICKS : LAG_CONTACT_SLIPS;
  c->to = c->slip ? c->slip : t->edge[i] < 0 ? -1 : 1;
  c->presses = 1;
}

/* Changes the mode of contact i, which does not fit at the forces at hand. */
static void change_mode(const Trial *t, int i) {
  lag_touch *c = &t->of[i];
  if (c->mode == LAG_CONTACT_OPEN) {
    choose_first(t, i);
  } else if (!c->guide && !(t->x[i] > rounding(t, i))) {
    c->mode = LAG_CONTACT_OPEN;
  } else if (c->mode == LAG_CONTACT_STICKS) {
    c->mode = LAG_CONTACT_SLIPS;
    c->to = t->x[c->tangent] > 0 ? -1 : 1;
  } else if (c->cannot_stick || !(c->mu > 0)) {
    c->to = -c->to;
  } else {
    c->mode = LAG_CONTACT_STICKS;
  }
}

/* The next contact of the order that does not fit; t->n: all fit. */
static int first_misfit(const Trial *t, const int *order) {
  int i = 0;
  while (i < t->n && fits(t, order[i])) i++;
  return i < t->n ? order[i] : t->n;
}

/* Changes modes, of contacts that do not fit the first in order[n], until all fit. */
static int pivot_in_order(Trial *t, const int *order, lag_touch *found) {
  enum { ROUNDS = 300 };
  for (int i = 0; i < t->n; i++) choose_first(t, i);
  for (int round = 0; round < ROUNDS; round++) {
    if (!solve(t)) {
      if (!change_sides(t)) return 0;
      continue;
    }
    int i = first_misfit(t, order);
    if (i == t->n || (is_shared(t) && !choose_forces(t) && all_fit(t))) {
      keep(t, found, is_shared(t) ? LEAST : UNIQUE);
      return 1;
    }
    solve(t); /* the least forces again */
    change_mode(t, i);
  }
  return 0;
}

/* The search may cycle, as responses of guides are no P-matrix: it begins again without edges, and in other orders. */
static int pivot(Trial *t, lag_touch *found) {
  enum { ORDERS = 16 };
  int order[LAG_MOST_TOUCHES];
  unsigned dice = 1;
  for (int i = 0; i < t->n; i++) order[i] = i;
  for (int turn = 0; turn < ORDERS; turn++) {
    if (pivot_in_order(t, order, found)) return 1;
    if (turn == 0) memset(t->edge, 0, sizeof t->edge);
    for (int i = t->n - 1; i > 0 && turn > 0; i--) {
      dice = dice * 1664525u + 1013904223u;
      int k = (int)((dice >> 16) % (unsigned)(i + 1)), was = order[i];
      order[i] = order[k];
      order[k] = was;
    }
  }
  return 0;
}

int lag_contact_modes(int n, lag_touch *of, int rows, const double *W, const double *pull, double *x, double *room) {
  Trial t = {n,
             rows,
             of,
             W,
             pull,
             {0},
             {0},
             {0},
             0,
             {0},
             0,
             x,
             room,
             room + rows * rows,
             room + rows * (rows + 1),
             room + rows * (rows + 2),
             room + rows * (rows + 3)};
  lag_touch found[LAG_MOST_TOUCHES];
  int few = n <= LAG_TRIED_TOUCHES, motions;
  find_edges(&t);
  if (few) find_prestress(&t);
  motions = few ? try_breaks(&t, found) : pivot(&t, found);
  if (few && !motions) {
    t.may_wedge = 1;
    motions = try_breaks(&t, found);
  }
  if (motions) {
    memcpy(of, found, (size_t)n * sizeof *of);
    memcpy(x, t.force, (size_t)rows * sizeof *x);
  }
  return motions;
}
