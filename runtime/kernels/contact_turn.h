/* contact_turn.h: laws of a contact, and the turn of one among many. Includes scalar.h.
 *
 * Enters: velocities, impulses and responses of all contacts; leaves: those after one contact has obeyed its laws while
 * the others keep theirs. Gap and friction are found at once where each moves the other by much.
 *
 * lagc copies the section below into headers, with their prefix for LAG_ and lag_. LAG_REAL is a scalar. Memory is the
 * caller's; nothing is kept between calls. */
#ifndef LAG_CONTACT_TURN_H
#define LAG_CONTACT_TURN_H

#include "kernels/coulomb.h"

/* ---- contact_turns ---- */

/* Rows of a sparse matrix: row r has the entries first[r] .. first[r + 1] - 1. Indices are scalars, since
 * they lie in blocks of scalars. */
typedef struct lag_sparse_rows {
  LAG_REAL *first, *col, *value;
} lag_sparse_rows;

/* A contact: rows row (the gap) and row + 1 .. row + tangents (slip velocities). mu, hold: friction that
 * slips, and the most that holds, by the force of the gap; slack: what it may be more, where the contact rests at the
 * begin, else -1. least: the least rate of the gap after the impulse. Friction drives the slip velocity to the nearest
 * point of a ball (an interval in a plane), about centre[tangents], of this radius. strikes: 1 in an impact; rate,
 * slip[tangents]: at the begin, by directions at the middle; turn, tail[tangents]: change of the slip by theirs until
 * there, and on to the end.
 * opposite: the contact on the other side of the same rail, or -1; head, next: of chains by first column;
 * couple: response of the gap to friction; shared: columns that all rows of A and D have, where friction moves the
 * gap by little, else 0; response, slow: of the gap and, in a plane, of the slip; give, ease: 1 over them. */
typedef struct lag_pressing {
  LAG_REAL row, tangents, shared, least, mu, hold, slack, radius, centre[2], slip[2], couple[2], response, slow, give;
  LAG_REAL ease, contact, strikes, rate, turn[2], tail[2], opposite, head, next;
} lag_pressing;

/* The product of row r with x. */
static inline LAG_REAL lag_row_product(const lag_sparse_rows *A, int r, const LAG_REAL *x) {
  LAG_REAL sum = LAG_C(0.0);
  for (int e = (int)A->first[r]; e < (int)A->first[r + 1]; e++) sum += A->value[e]*x[(int)A->col[e]];
  return sum;
}

/* --- laws --- */

/* Whether a contact takes part in a step h: its gap is closed at the middle, or may close until the end. r0,
 * r1: rates at the begin, and at the end without contacts; pace: rates that forces and curvature cause in a
 * step. */
static inline int lag_contact_takes_part(LAG_REAL gap, LAG_REAL r0, LAG_REAL r1, LAG_REAL pace, LAG_REAL h) {
  const LAG_REAL zero = LAG_C(0.0);
  return gap <= zero || (gap + h/LAG_C(2.0)*(lag_smaller(r0, r1) - pace) <= zero && r0 >= -pace);
}

/* Whether it strikes: the gap closes faster than forces and curvature alone make it close in a step. */
static inline int lag_contact_strikes(LAG_REAL r0, LAG_REAL pace) { return r0 < -pace; }

/* Fills in c->least, centre and radius from the others. bend: change of the rate of the gap by its curvature until the
 * middle; e: restitution of an impact, 0 where there is none; back: the same along the surface.
 *
 * Half a gap is left by its rate -gap/h, and the next middle has none. On a curve that bends towards the body
 * the rate is that which curvature takes away until the end; the middle lies inside by h/4 of it, and a body
 * deeper than that is led out, no faster than the gap closed. */
static inline void lag_contact_law(lag_pressing *c, LAG_REAL gap, LAG_REAL bend, LAG_REAL h, LAG_REAL e,
                                   LAG_REAL back) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0), two = LAG_C(2.0), r0 = c->rate;
  const int strikes = c->strikes > zero;
  const LAG_REAL down = lag_smaller(bend, zero), part = LAG_SELECT(strikes, back, (one + back)/two);
  const LAG_REAL left = gap - down*(h/LAG_C(4.0));
  LAG_REAL size = zero;
  c->least = LAG_SELECT(left > zero || down < zero, -down - left/h, zero);
  if (r0 > zero || down < zero) c->least = lag_smaller(-r0, c->least);
  if (strikes) c->least = lag_larger(-down, -lag_smaller(lag_larger(e, zero), one)*r0);
  for (int j = 0; j < (int)c->tangents; j++) {
    const LAG_REAL slip = c->slip[j] - c->turn[j];
    c->centre[j] = -part*slip - c->tail[j];
    size = lag_length_of(size, slip);
  }
  c->radius = LAG_SELECT(strikes, zero, (one - back)/two*size);
}

/* --- sweeps --- */

/* Changes impulse r by dP. */
static inline void lag_add_impulse(const lag_sparse_rows *D, int r, LAG_REAL dP, LAG_REAL *P, LAG_REAL *v) {
  P[r] += dP;
  for (int e = (int)D->first[r]; e < (int)D->first[r + 1]; e++) v[(int)D->col[e]] += dP*D->value[e];
}

/* Contacts of[n] of a step. A, D: one row each for each impulse, D = M^-1 A^T; response[rows]: the diagonal of
 * A D, 0: no impulse moves this row; b[rows]: rate without velocities. P[rows], v[]: impulses, velocities. */
typedef struct lag_impulses {
  int n;
  lag_pressing *of;
  lag_sparse_rows A, D;
  const LAG_REAL *response, *b;
  LAG_REAL *P, *v;
  LAG_REAL *was, *went; /* [rows] impulses some sweeps ago, and their changes until then */
  LAG_REAL loose;       /* change of a rate in a sweep that is enough after many sweeps; 0: none */
  int nv;
  LAG_REAL *v_was;      /* [nv] velocities some sweeps ago, of many contacts */
} lag_impulses;

static inline LAG_REAL lag_rate_of(const lag_impulses *s, int r) { return lag_row_product(&s->A, r, s->v) + s->b[r]; }

/* The first entry of row r from e on that is not 0. */
static inline int lag_row_entry(const lag_sparse_rows *A, int r, int e) {
  while (e < (int)A->first[r + 1] && !(A->value[e] < LAG_C(0.0) || A->value[e] > LAG_C(0.0))) e++;
  return e;
}

static inline int lag_rows_are_opposite(const lag_sparse_rows *A, int a, int b) {
  const LAG_REAL rounding = LAG_C(1e-12);
  const int end = (int)A->first[a + 1], other = (int)A->first[b + 1];
  int i = lag_row_entry(A, a, (int)A->first[a]), j = lag_row_entry(A, b, (int)A->first[b]), same = 1;
  for (; same && i < end && j < other; i = lag_row_entry(A, a, i + 1), j = lag_row_entry(A, b, j + 1))
    same = (int)A->col[i] == (int)A->col[j] &&
           LAG_FN(fabs)(A->value[i] + A->value[j]) <= rounding*LAG_FN(fabs)(A->value[i]);
  return same && i == end && j == other;
}

/* Finds the pairs on both sides of a rail. Nothing determines by how much both press: the guess is the least. */
static inline void lag_find_opposites(const lag_impulses *s) {
  const LAG_REAL none = LAG_C(-1.0);
  for (int i = 0; i < s->n; i++) s->of[i].opposite = s->of[i].head = none;
  for (int i = 0; i < s->n; i++) {
    const int row = (int)s->of[i].row, first = lag_row_entry(&s->A, row, (int)s->A.first[row]);
    if (first == (int)s->A.first[row + 1]) continue;
    lag_pressing *const chain = &s->of[(int)s->A.col[first] % s->n];
    for (int j = (int)chain->head; j >= 0; j = (int)s->of[j].next) {
      const int other = (int)s->of[j].row;
      const LAG_REAL both = lag_smaller(s->P[row], s->P[other]);
      if (!lag_rows_are_opposite(&s->A, row, other)) continue;
      s->of[i].opposite = (LAG_REAL)j;
      s->of[j].opposite = (LAG_REAL)i;
      s->P[row] -= both;
      s->P[other] -= both;
    }
    s->of[i].next = chain->head;
    chain->head = (LAG_REAL)i;
  }
}

/* Whether friction of a contact in a plane moves its gap by more than half of its own response, as in a brake that
 * locks itself. */
static inline int lag_contact_locks(const lag_impulses *s, const lag_pressing *c) {
  return LAG_C(2.0)*c->mu*LAG_FN(fabs)(c->couple[0]) > s->response[(int)c->row];
}

/* c->couple := responses of its gap to friction, and of friction to the gap where rows share columns. */
static inline void lag_find_coupling(const lag_impulses *s, lag_pressing *c) {
  const LAG_REAL zero = LAG_C(0.0);
  const int r = (int)c->row, n = (int)c->tangents;
  for (int k = 0; k < n; k++) {
    c->couple[k] = zero;
    for (int d = (int)s->D.first[r + 1 + k]; d < (int)s->D.first[r + 2 + k]; d++)
      for (int e = (int)s->A.first[r]; e < (int)s->A.first[r + 1]; e++)
        if ((int)s->A.col[e] == (int)s->D.col[d]) c->couple[k] += s->A.value[e]*s->D.value[d];
  }
  c->response = s->response[r], c->slow = n > 0 ? s->response[r + 1] : zero;
  c->give = LAG_C(1.0)/c->response, c->ease = LAG_C(1.0)/c->slow;
  const int moves = c->response > zero && (n == 0 || c->slow > zero);
  if (!moves || n > 1 || c->opposite >= zero || (n == 1 && lag_contact_locks(s, c))) c->shared = zero;
}

/* Changes the impulse of the gap of c by dP, and first that on the other side of its rail. */
static inline void lag_press(const lag_impulses *s, const lag_pressing *c, LAG_REAL dP) {
  const int other = c->opposite < LAG_C(0.0) ? -1 : (int)s->of[(int)c->opposite].row;
  LAG_REAL less = LAG_C(0.0);
  if (other >= 0 && dP > less) less = lag_smaller(dP, s->P[other]);
  if (less > LAG_C(0.0)) lag_add_impulse(&s->D, other, -less, s->P, s->v);
  lag_add_impulse(&s->D, (int)c->row, dP - less, s->P, s->v);
}

/* Most friction that holds c under the impulse P of its gap; turned: the slip turns round in the step. */
static inline LAG_REAL lag_contact_grip(const lag_pressing *c, LAG_REAL P, int turned) {
  const int rests = c->slack >= LAG_C(0.0);
  return (rests || turned ? c->hold : c->mu)*P + (rests ? c->slack : LAG_C(0.0));
}

/* Coulomb's law of c under the impulse P of its gap; slow: response of its slip. */
static inline lag_coulomb lag_contact_coulomb(const lag_pressing *c, LAG_REAL slow, LAG_REAL P) {
  const lag_coulomb law = {(int)c->tangents, slow, c->radius, lag_contact_grip(c, P, 0), lag_contact_grip(c, P, 1),
                           (LAG_REAL)HUGE_VAL, c->centre, c->slip};
  return law;
}

/* A contact alone, while the others keep theirs: its impulse, friction x, rates under them. slow: response of a slip to
 * friction, the trace, which is no less than the largest eigenvalue, and the same in all directions. */
typedef struct lag_contact_alone {
  const lag_pressing *of;
  LAG_REAL response, slow, impulse, rate, slip[2], x[2];
} lag_contact_alone;

/* x := friction where the impulse of the gap is P. Returns the rate of the gap. */
static inline LAG_REAL lag_contact_rate(const lag_contact_alone *a, LAG_REAL P, LAG_REAL *x) {
  const lag_pressing *const c = a->of;
  const lag_coulomb law = lag_contact_coulomb(c, a->slow, P);
  LAG_REAL slip[2], rate = a->rate + a->response*(P - a->impulse);
  for (int k = 0; k < law.n; k++) {
    slip[k] = a->slip[k] + c->couple[k]*(P - a->impulse);
    x[k] = a->x[k];
  }
  if (a->slow > LAG_C(0.0)) lag_friction_turn(&law, slip, x);
  for (int k = 0; k < law.n; k++) rate += c->couple[k]*(x[k] - a->x[k]);
  return rate;
}

/* The impulse of the gap at which its rate is the least one, with friction by its law; of several, as of wedged bodies,
 * the nearest to the present one. Strides that double, then regula falsi with the Illinois rule (M. Dowell, P. Jarratt,
 * BIT 11 (1971) 168, DOI 10.1007/BF01934364). */
static inline LAG_REAL lag_contact_balance(const lag_contact_alone *a) {
  const LAG_REAL zero = LAG_C(0.0), two = LAG_C(2.0), least = a->of->least;
  LAG_REAL x[2], last = a->impulse, P = last, at = lag_contact_rate(a, P, x) - least, at_last = at;
  LAG_REAL stride = -at/a->response;
  while ((at < zero) == (at_last < zero) && (at < zero || (at > zero && P > zero))) {
    last = P, at_last = at;
    P = lag_larger(zero, P + stride);
    at = lag_contact_rate(a, P, x) - least;
    stride *= two;
    if (!lag_is_number(P)) return a->impulse;
  }
  if ((at < zero) == (at_last < zero) || !(at < zero || at > zero)) return P;
  for (int turn = 0; turn < 100; turn++) {
    const LAG_REAL to = P - at*((P - last)/(at - at_last)), at_to = lag_contact_rate(a, to, x) - least;
    if (!(to < P || to > P) || !(at_to < zero || at_to > zero)) return to;
    if ((at_to < zero) == (at < zero)) at_last /= two;
    else last = P, at_last = at;
    P = to, at = at_to;
  }
  return P;
}

/* Changes friction of contact c by this part towards x; returns the largest change of a rate without damping. */
static inline LAG_REAL lag_contact_rub(const lag_impulses *s, const lag_pressing *c, const LAG_REAL *x, LAG_REAL w,
                                        LAG_REAL part) {
  const int r = (int)c->row + 1;
  LAG_REAL change = LAG_C(0.0);
  for (int k = 0; k < (int)c->tangents; k++) {
    const LAG_REAL by = x[k] - s->P[r + k];
    change = lag_larger(change, LAG_FN(fabs)(by)*w);
    lag_add_impulse(&s->D, r + k, part*by, s->P, s->v);
  }
  return change;
}

/* Part of each change that a sweep makes: contacts whose friction loads each other swing for ever by whole ones. */
static inline LAG_REAL lag_contact_damping(int sweep) {
  return sweep < 500 ? LAG_C(1.0) : sweep < 3000 ? LAG_C(0.5) : sweep < 20000 ? LAG_C(0.2) : LAG_C(0.05);
}

/* The impulse of a gap with the rate g under P; friction of a contact in a plane with the slip g under x, where the
 * gap has the impulse P. A number that is none stays so. */
static inline LAG_REAL lag_gap_law(const lag_pressing *c, LAG_REAL P, LAG_REAL g) {
  const LAG_REAL to = P + (c->least - g)*c->give;
  return (to + LAG_FN(fabs)(to))/LAG_C(2.0); /* the larger of it and 0, without a branch */
}
static inline LAG_REAL lag_flat_law(const lag_pressing *c, LAG_REAL x, LAG_REAL g, LAG_REAL P) {
  const LAG_REAL low = c->centre[0] - c->radius, high = c->centre[0] + c->radius, free = g - c->slow*x;
  LAG_REAL to = LAG_SELECT(low > free, low, free);
  to = LAG_SELECT(high < to, high, to);
  const int turned = c->hold > c->mu && (to - free)*c->slip[0] > LAG_C(0.0);
  const LAG_REAL most = c->hold > c->mu ? lag_contact_grip(c, P, turned) : c->mu*P, least = -most;
  x += (to - g)*c->ease;
  x = LAG_SELECT(most < x, most, x);
  return LAG_SELECT(least > x, least, x);
}

/* One turn of a contact in a plane whose friction moves the gap by little; returns the largest change of a rate. */
static inline LAG_REAL lag_contact_turn_flat(const lag_impulses *s, const lag_pressing *c, LAG_REAL part) {
  const LAG_REAL zero = LAG_C(0.0);
  const int r = (int)c->row;
  LAG_REAL change = zero;
  if (c->response > zero) {
    const LAG_REAL by = lag_gap_law(c, s->P[r], lag_rate_of(s, r)) - s->P[r];
    change = LAG_FN(fabs)(by)*c->response;
    if (!(change <= zero)) lag_press(s, c, part*by);
  }
  if (!(c->slow > zero)) return change;
  const LAG_REAL by = lag_flat_law(c, s->P[r + 1], lag_rate_of(s, r + 1), s->P[r]) - s->P[r + 1];
  lag_add_impulse(&s->D, r + 1, part*by, s->P, s->v);
  return lag_larger(change, LAG_FN(fabs)(by)*c->slow);
}

/* The same of a contact whose rows of A and D have the same columns. */
static inline LAG_REAL lag_contact_turn_shared(const lag_impulses *s, const lag_pressing *c, LAG_REAL part) {
  const LAG_REAL zero = LAG_C(0.0), *const v = s->v;
  const int r = (int)c->row, n = (int)c->shared, rubs = c->tangents > zero;
  const LAG_REAL *const col = s->A.col + (int)s->A.first[r], *const A = s->A.value + (int)s->A.first[r];
  const LAG_REAL *const T = rubs ? A + n : A, *const D = s->D.value + (int)s->D.first[r], *const E = D + n;
  LAG_REAL gap = s->b[r], slip = zero, rub = zero;
  for (int k = 0; k < n; k++) {
    const LAG_REAL x = v[(int)col[k]];
    gap += A[k]*x;
    slip += T[k]*x;
  }
  const LAG_REAL P = s->P[r], to = lag_gap_law(c, P, gap), by = to - P;
  LAG_REAL change = LAG_FN(fabs)(by)*c->response;
  if (rubs) {
    const LAG_REAL was = s->P[r + 1];
    slip += s->b[r + 1] + part*by*c->couple[0];
    rub = lag_flat_law(c, was, slip, P + part*by) - was;
    const LAG_REAL other = LAG_FN(fabs)(rub)*c->slow;
    change = LAG_SELECT(other > change, other, change);
    s->P[r + 1] = was + part*rub;
  }
  if (!(change <= zero)) {
    s->P[r] = P + part*by;
    for (int k = 0; k < n; k++) s->v[(int)col[k]] += part*by*D[k] + part*rub*E[k];
  }
  return change;
}

/* One turn of any contact. Along the gap and across in turn, or both at once where friction moves the gap by much. */
static inline LAG_REAL lag_contact_turn(const lag_impulses *s, const lag_pressing *c, LAG_REAL part) {
  const LAG_REAL zero = LAG_C(0.0), two = LAG_C(2.0);
  const int r = (int)c->row, n = (int)c->tangents;
  if (c->shared > zero) return lag_contact_turn_shared(s, c, part);
  if (n == 1 && !lag_contact_locks(s, c)) return lag_contact_turn_flat(s, c, part);
  lag_contact_alone a = {c, s->response[r], zero, s->P[r], zero, {zero, zero}, {zero, zero}};
  LAG_REAL change = zero, x[2] = {zero, zero}, couple = zero, to = s->P[r];
  for (int k = 0; k < n; k++) {
    a.slow += s->response[r + 1 + k];
    a.x[k] = s->P[r + 1 + k];
    couple = lag_length_of(couple, c->couple[k]);
  }
  if (a.response > zero) {
    const int at_once = two*c->mu*couple > a.response && a.slow > zero;
    a.rate = lag_rate_of(s, r);
    for (int k = 0; k < n && at_once; k++) a.slip[k] = lag_rate_of(s, r + 1 + k);
    to = lag_larger(zero, s->P[r] + (c->least - a.rate)/a.response);
    if (at_once) to = lag_contact_balance(&a);
    change = LAG_FN(fabs)(to - s->P[r])*a.response;
    lag_press(s, c, part*(to - s->P[r]));
  }
  if (!(a.slow > zero)) return change;
  for (int k = 0; k < n; k++) {
    a.slip[k] = lag_rate_of(s, r + 1 + k);
    x[k] = a.x[k];
  }
  const lag_coulomb law = lag_contact_coulomb(c, a.slow, s->P[r]);
  lag_friction_turn(&law, a.slip, x);
  return lag_larger(change, lag_contact_rub(s, c, x, a.slow, part));
}

/* ---- end ---- */
#endif
