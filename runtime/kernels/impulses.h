/* impulses.h: laws of contacts and dry friction by projected Gauss-Seidel. Includes scalar.h.
 *
 * Enters: velocities without contacts and friction, response of the motion to each; their laws. Leaves: impulses and
 * velocities that obey all laws, for any number of contacts: the problem of numeric/complementarity.h with boxes of
 * friction that depend on the forces which press. Each law in turn, until a sweep changes nothing noticeably: M. Jean,
 * Comput. Methods Appl. Mech. Eng. 177 (1999) 235, DOI 10.1016/S0045-7825(98)00383-1. Gap and friction of a contact
 * are found at once where each moves the other by much; impulses that drift go in strides; those that swing are damped.
 *
 * lagc copies the sections below into headers, with their prefix for LAG_ and lag_. LAG_REAL is a scalar. Memory is
 * the caller's; nothing is kept between calls. */
#ifndef LAG_IMPULSES_H
#define LAG_IMPULSES_H

#include "kernels/band_matrix.h"
#include "kernels/coulomb.h"

/* ---- impulses ---- */

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
 * couple: response of the gap to friction. */
typedef struct lag_pressing {
  LAG_REAL contact, row, tangents, mu, hold, slack, least, radius, centre[2], strikes, rate, slip[2], turn[2], tail[2];
  LAG_REAL opposite, head, next, couple[2];
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
} lag_impulses;

static inline LAG_REAL lag_rate_of(const lag_impulses *s, int r) { return lag_row_product(&s->A, r, s->v) + s->b[r]; }

static inline int lag_rows_are_opposite(const lag_sparse_rows *A, int a, int b) {
  const LAG_REAL rounding = LAG_C(1e-12);
  int i = (int)A->first[a], j = (int)A->first[b], same = (int)A->first[a + 1] - i == (int)A->first[b + 1] - j;
  for (; same && i < (int)A->first[a + 1]; i++, j++)
    same = (int)A->col[i] == (int)A->col[j] &&
           LAG_FN(fabs)(A->value[i] + A->value[j]) <= rounding*LAG_FN(fabs)(A->value[i]);
  return same;
}

/* Finds the pairs on both sides of a rail. Nothing determines by how much both press: the guess is the least. */
static inline void lag_find_opposites(const lag_impulses *s) {
  const LAG_REAL none = LAG_C(-1.0);
  for (int i = 0; i < s->n; i++) s->of[i].opposite = s->of[i].head = none;
  for (int i = 0; i < s->n; i++) {
    const int row = (int)s->of[i].row, first = (int)s->A.first[row];
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

/* c->couple := responses of its gap to its friction. */
static inline void lag_find_coupling(const lag_impulses *s, lag_pressing *c) {
  const int r = (int)c->row;
  for (int k = 0; k < (int)c->tangents; k++) {
    c->couple[k] = LAG_C(0.0);
    for (int d = (int)s->D.first[r + 1 + k]; d < (int)s->D.first[r + 2 + k]; d++)
      for (int e = (int)s->A.first[r]; e < (int)s->A.first[r + 1]; e++)
        if ((int)s->A.col[e] == (int)s->D.col[d]) c->couple[k] += s->A.value[e]*s->D.value[d];
  }
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

/* One turn of a contact in a plane whose friction moves the gap by little; returns the largest change of a rate. */
static inline LAG_REAL lag_contact_turn_flat(const lag_impulses *s, const lag_pressing *c, LAG_REAL part) {
  const LAG_REAL zero = LAG_C(0.0);
  const int r = (int)c->row;
  const LAG_REAL response = s->response[r], slow = s->response[r + 1];
  LAG_REAL change = zero;
  if (response > zero) {
    const LAG_REAL by = lag_larger(zero, s->P[r] + (c->least - lag_rate_of(s, r))/response) - s->P[r];
    change = LAG_FN(fabs)(by)*response;
    if (!(change <= zero)) lag_press(s, c, part*by);
  }
  if (!(slow > zero)) return change;
  const LAG_REAL slip = lag_rate_of(s, r + 1), was = s->P[r + 1];
  const LAG_REAL free = slip - slow*was;
  LAG_REAL to = free;
  lag_into_ball(1, c->centre, c->radius, &to);
  LAG_REAL x = was + (to - slip)/slow;
  const LAG_REAL most = lag_contact_grip(c, s->P[r], (to - free)*c->slip[0] > zero);
  if (LAG_FN(fabs)(x) > most) x = lag_smaller(lag_larger(x, -most), most);
  lag_add_impulse(&s->D, r + 1, part*(x - was), s->P, s->v);
  return lag_larger(change, LAG_FN(fabs)(x - was)*slow);
}

/* One turn of any contact. Along the gap and across in turn, or both at once where
 * friction moves the gap by more than half of its own response, as in a brake that locks itself. */
static inline LAG_REAL lag_contact_turn(const lag_impulses *s, const lag_pressing *c, LAG_REAL part) {
  const LAG_REAL zero = LAG_C(0.0), two = LAG_C(2.0);
  const int r = (int)c->row, n = (int)c->tangents;
  if (n == 1 && !(two*c->mu*LAG_FN(fabs)(c->couple[0]) > s->response[r]))
    return lag_contact_turn_flat(s, c, part);
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

/* Whether friction of size rub holds: it is another than that of a contact that slips. */
static inline int lag_contact_holds(const lag_pressing *c, LAG_REAL P, LAG_REAL rub, LAG_REAL epsilon) {
  const LAG_REAL one = LAG_C(1.0), most = c->mu*P;
  return rub < most*(one - LAG_C(64.0)*epsilon) || (c->hold > c->mu && rub > most*(one + LAG_C(1e-9)));
}

/* Contacts that static friction at its limit does not hold slip from then on; returns how many. */
static inline int lag_contacts_loosen(const lag_impulses *s) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  int loose = 0;
  for (int i = 0; i < s->n; i++) {
    lag_pressing *const c = &s->of[i];
    const int r = (int)c->row + 1, n = (int)c->tangents;
    LAG_REAL slip[2] = {zero, zero}, x[2] = {zero, zero}, slow = zero;
    if (!(c->hold > c->mu)) continue;
    for (int k = 0; k < n; k++) slow += s->response[r + k], slip[k] = lag_rate_of(s, r + k), x[k] = s->P[r + k];
    lag_coulomb law = lag_contact_coulomb(c, slow, s->P[r - 1]);
    const LAG_REAL most = law.turned, rub = lag_length_of(x[0], x[1]);
    law.holds = law.turned = (LAG_REAL)HUGE_VAL;
    if (slow > zero) lag_friction_turn(&law, slip, x);
    if (!(rub >= most*(one - LAG_C(1e-9)) && lag_length_of(x[0], x[1]) > most*(one + LAG_C(1e-9)))) continue;
    c->hold = c->mu, c->slack = -one;
    loose++;
  }
  return loose;
}

/* Whether friction by the slip at the end brings in energy in an impact; then its ball becomes that of the
 * mean slip, whose diameter goes from -slip to the centre. */
static inline int lag_contact_soften(const lag_impulses *s, lag_pressing *c, LAG_REAL enough) {
  const LAG_REAL zero = LAG_C(0.0), two = LAG_C(2.0), *const P = s->P;
  const int r = (int)c->row, n = (int)c->tangents;
  LAG_REAL work = P[r]*(c->rate + lag_rate_of(s, r)), size = P[r], width = zero;
  if (!(c->strikes > zero) || c->radius > zero) return 0;
  for (int k = 0; k < n; k++) {
    work += P[r + 1 + k]*(c->slip[k] + lag_rate_of(s, r + 1 + k));
    size += LAG_FN(fabs)(P[r + 1 + k]);
    width = lag_length_of(width, c->slip[k] + c->centre[k]);
  }
  if (!(work > enough*size && width > zero)) return 0;
  for (int k = 0; k < n; k++) c->centre[k] = (c->centre[k] - c->slip[k])/two;
  c->radius = width/two;
  return 1;
}

/* Impulses that go on in one direction, sweep by sweep, go there at once: by the geometric series of their changes, in
 * strides that double. Returns the next stride; 0: they turn. A.C. Aitken, Proc. R. Soc. Edinb. 57 (1937) 269. */
static inline LAG_REAL lag_contact_stride(const lag_impulses *s, LAG_REAL stride) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  LAG_REAL both = zero, now = zero, before = zero;
  for (int i = 0; i < s->n; i++)
    for (int r = (int)s->of[i].row; r <= (int)(s->of[i].row + s->of[i].tangents); r++) {
      const LAG_REAL went = s->P[r] - s->was[r];
      both += went*s->went[r];
      now += went*went;
      before += s->went[r]*s->went[r];
      s->went[r] = went;
    }
  const int goes_on = both > zero && both*both > LAG_C(0.98)*now*before;
  const LAG_REAL left = both < before ? both/(before - both) : stride;
  const LAG_REAL by = goes_on ? lag_smaller(left, stride) : zero;
  for (int i = 0; i < s->n; i++)
    for (int r = (int)s->of[i].row; r <= (int)(s->of[i].row + s->of[i].tangents); r++) {
      const LAG_REAL to = s->P[r] + by*s->went[r];
      lag_add_impulse(&s->D, r, (r > (int)s->of[i].row ? to : lag_larger(to, zero)) - s->P[r], s->P, s->v);
      s->was[r] = s->P[r];
    }
  return goes_on ? LAG_C(2.0)*stride : one;
}

/* Impulses of many contacts after two sweeps: conjugate directions, which begin anew where changes grow.
 * *before: square of the last change. M. Silcowitz-Hansen, S. Niebe, K. Erleben, Vis. Comput. 26 (2010) 893, DOI
 * 10.1007/s00371-010-0502-6. */
static inline void lag_contact_conjugate(const lag_impulses *s, LAG_REAL *before) {
  const LAG_REAL zero = LAG_C(0.0);
  const int rows = (int)(s->of[s->n - 1].row + s->of[s->n - 1].tangents) + 1;
  LAG_REAL now = zero;
  for (int r = 0; r < rows; r++) now += (s->P[r] - s->was[r])*(s->P[r] - s->was[r]);
  const LAG_REAL part = LAG_SELECT(now < *before, now/(*before), zero);
  for (int r = 0; r < rows; r++) {
    const LAG_REAL by = part*s->went[r];
    s->went[r] = by + (s->P[r] - s->was[r]);
    lag_add_impulse(&s->D, r, by, s->P, s->v);
    s->was[r] = s->P[r];
  }
  *before = now;
}

/* Few planar contacts: responses W of all rates to all impulses; impulses and rates, and those of the sweeps; how each
 * row stands, and whether that may be off by what held rows give way; the equations of all rows that stand so. */
enum { LAG_FEW_ROWS = 16 };
enum { LAG_RUB_NONE, LAG_RUB_MOST, LAG_RUB_LEAST, LAG_RUB_ABOVE, LAG_RUB_BELOW, LAG_RUBS }; /* friction; a gap: 0, 1 */
typedef struct lag_contact_equations {
  int rows, stand[LAG_FEW_ROWS], gives;
  LAG_REAL W[LAG_FEW_ROWS*LAG_FEW_ROWS], a[LAG_FEW_ROWS*LAG_FEW_ROWS], was[LAG_FEW_ROWS], at[LAG_FEW_ROWS];
  LAG_REAL P[LAG_FEW_ROWS], rate[LAG_FEW_ROWS], change[LAG_FEW_ROWS], pivot[LAG_FEW_ROWS], scale[LAG_FEW_ROWS];
} lag_contact_equations;

/* Not 0: the contacts are too many, in space, or on two sides of a rail. */
static inline int lag_few_begin(const lag_impulses *s, lag_contact_equations *w) {
  w->rows = w->gives = 0;
  for (int i = 0; i < s->n; i++) {
    const lag_pressing *const c = &s->of[i];
    w->rows += 1 + (int)c->tangents;
    if (w->rows > LAG_FEW_ROWS || c->tangents > LAG_C(1.0) || c->opposite >= LAG_C(0.0)) return 1;
  }
  for (int r = 0; r < w->rows; r++) {
    w->P[r] = w->was[r] = s->P[r];
    w->rate[r] = w->at[r] = lag_rate_of(s, r);
    for (int k = 0; k < w->rows; k++) {
      LAG_REAL sum = LAG_C(0.0);
      for (int d = (int)s->D.first[k]; d < (int)s->D.first[k + 1]; d++)
        for (int e = (int)s->A.first[r]; e < (int)s->A.first[r + 1]; e++)
          if ((int)s->A.col[e] == (int)s->D.col[d]) sum += s->A.value[e]*s->D.value[d];
      w->W[r*w->rows + k] = sum;
    }
  }
  return 0;
}

/* Row r: its rate goes to `to` where it is held, else its impulse to `by` times that of the row before, and `to`. A
 * held row gives way a little, so that rows which depend on others go to their limits. */
static inline void lag_few_row(lag_contact_equations *w, int r, int held, LAG_REAL to, LAG_REAL by) {
  LAG_REAL *const a = w->a + r*w->rows;
  for (int k = 0; k < w->rows; k++) a[k] = held ? w->W[r*w->rows + k] : LAG_C(0.0);
  w->change[r] = to - (held ? w->rate[r] : w->P[r]);
  a[r] = held ? a[r] + LAG_C(1e-10)*a[r] : LAG_C(1.0);
  if (held || !(by > LAG_C(0.0) || by < LAG_C(0.0))) return;
  a[r - 1] = -by;
  w->change[r] += by*w->P[r - 1];
}

/* Goes to where all rows obey as they stand. Not 0: nowhere. */
static inline int lag_few_step(const lag_impulses *s, lag_contact_equations *w) {
  const LAG_REAL zero = LAG_C(0.0);
  const int n = w->rows;
  lag_band_matrix m = {n, n - 1, w->a, w->pivot};
  for (int i = 0; i < s->n; i++) {
    const lag_pressing *const c = &s->of[i];
    const int r = (int)c->row, stand = w->stand[r + 1];
    lag_few_row(w, r, w->stand[r], w->stand[r] ? c->least : zero, zero);
    if (!(c->tangents > zero)) continue;
    const LAG_REAL side = stand == LAG_RUB_MOST ? LAG_C(1.0) : stand == LAG_RUB_LEAST ? -LAG_C(1.0) : zero;
    const LAG_REAL rest = lag_contact_grip(c, zero, 0), by = lag_contact_grip(c, LAG_C(1.0), side*c->slip[0] > zero);
    const LAG_REAL end = c->centre[0] + (stand == LAG_RUB_BELOW ? -c->radius : c->radius);
    const int held = stand >= LAG_RUB_ABOVE;
    lag_few_row(w, r + 1, held, held ? end : side*rest, side*(by - rest));
  }
  if (lag_band_matrix_factor(&m, w->scale)) return 1;
  lag_band_matrix_solve(&m, w->change);
  for (int k = 0; k < n; k++) w->P[k] += w->change[k];
  for (int r = 0; r < n; r++)
    for (int k = 0; k < n; k++) w->rate[r] += w->W[r*n + k]*w->change[k];
  return 0;
}

/* Whether friction that stands at 0 or at a limit obeys its law but for what held rows give way. free: the slip without
 * it. */
static inline int lag_few_stays(const lag_contact_equations *w, const lag_pressing *c, LAG_REAL slow, LAG_REAL free) {
  const int r = (int)c->row, stand = w->stand[r + 1];
  const LAG_REAL give = LAG_C(1e-9)*slow*LAG_FN(fabs)(w->P[r]), slip = w->rate[r + 1];
  const LAG_REAL low = c->centre[0] - c->radius, high = c->centre[0] + c->radius;
  if (stand == LAG_RUB_NONE) return free >= low - give && free <= high + give;
  return (stand == LAG_RUB_MOST && slip <= low + give) || (stand == LAG_RUB_LEAST && slip >= high - give);
}

/* Lets rows stand as the laws have it; returns how many stood otherwise. */
static inline int lag_few_stand(const lag_impulses *s, lag_contact_equations *w) {
  const LAG_REAL zero = LAG_C(0.0);
  int others = 0;
  for (int i = 0; i < s->n; i++) {
    const lag_pressing *const c = &s->of[i];
    const int r = (int)c->row, n = (int)c->tangents;
    const LAG_REAL slow = n > 0 ? s->response[r + 1] : zero, P = lag_larger(zero, w->P[r]);
    const int presses = s->response[r] > zero && w->P[r] + (c->least - w->rate[r])/s->response[r] > zero;
    others += w->stand[r] != presses;
    w->stand[r] = presses;
    if (n == 0) continue;
    LAG_REAL slip = w->rate[r + 1], x = w->P[r + 1];
    lag_coulomb law = lag_contact_coulomb(c, slow, P);
    law.holds = law.turned = (LAG_REAL)HUGE_VAL;
    const LAG_REAL free = slip - slow*x;
    int stand = LAG_RUB_NONE;
    if (slow > zero) lag_friction_turn(&law, &slip, &x);
    if (slow > zero && (slip < free || slip > free)) stand = slip < free ? LAG_RUB_ABOVE : LAG_RUB_BELOW;
    const LAG_REAL most = lag_contact_grip(c, P, (slip - free)*c->slip[0] > zero);
    if (stand != LAG_RUB_NONE && LAG_FN(fabs)(x) > most) stand = x > zero ? LAG_RUB_MOST : LAG_RUB_LEAST;
    if (w->gives && slow > zero && lag_few_stays(w, c, slow, free)) stand = w->stand[r + 1];
    others += w->stand[r + 1] != stand;
    w->stand[r + 1] = stand;
  }
  return others;
}

/* Whether rows that stand so obey the laws; Newton's method on these if not: P. Alart, A. Curnier, Comput. Methods
 * Appl. Mech. Eng. 92 (1991) 353, DOI 10.1016/0045-7825(91)90022-X. */
static inline int lag_few_agree(const lag_impulses *s, lag_contact_equations *w, int turns) {
  for (int same = 0; same < 2;) {
    if (turns-- == 0 || lag_few_step(s, w)) return 0;
    same = lag_few_stand(s, w) ? 0 : same + 1;
  }
  return 1;
}

/* Row by row the next of all ways to stand; 0: there are no more. */
static inline int lag_few_next(const lag_impulses *s, int *stand) {
  for (int i = 0; i < s->n; i++)
    for (int r = (int)s->of[i].row, k = 0; k <= (int)s->of[i].tangents; k++) {
      if (++stand[r + k] < (k ? (int)LAG_RUBS : 2)) return 1;
      stand[r + k] = 0;
    }
  return 0;
}

/* Impulses that obey all laws where sweeps creep, as where slips of a rigid body at two contacts are almost one row: by
 * Newton's method, else from all ways to stand of up to three contacts those nearest to the impulses of the sweeps. Not
 * 0: it found them. */
static inline int lag_contact_newton(const lag_impulses *s) {
  enum { TURNS = 30, MOST = 6 };
  lag_contact_equations w;
  LAG_REAL best[LAG_FEW_ROWS], least = (LAG_REAL)HUGE_VAL;
  int stand[LAG_FEW_ROWS] = {0}, found;
  if (lag_few_begin(s, &w)) return 0;
  for (int r = 0; r < w.rows; r++) w.stand[r] = 0;
  lag_few_stand(s, &w);
  found = lag_few_agree(s, &w, TURNS);
  for (int r = 0; r < w.rows; r++) best[r] = w.P[r];
  w.gives = 1; /* only beside the sweeps' impulses: other solutions may be far */
  for (int more = !found && w.rows <= MOST; more; more = lag_few_next(s, stand)) {
    LAG_REAL far = LAG_C(0.0);
    for (int r = 0; r < w.rows; r++) w.P[r] = w.was[r], w.rate[r] = w.at[r], w.stand[r] = stand[r];
    if (!lag_few_agree(s, &w, 2)) continue;
    for (int r = 0; r < w.rows; r++) far += (w.P[r] - w.was[r])*(w.P[r] - w.was[r]);
    for (int r = 0; r < w.rows && far < least; r++) best[r] = w.P[r];
    least = lag_smaller(least, far);
    found = 1;
  }
  for (int r = 0; r < w.rows && found; r++) lag_add_impulse(&s->D, r, best[r] - s->P[r], s->P, s->v);
  return found;
}

/* Part of `enough` in which rows that depend on others may swing for ever: of many contacts more, after long. */
static inline LAG_REAL lag_contact_swing(int contacts, int sweep) {
  enum { FEW = 8, LONG = 20000 };
  return contacts > FEW && sweep >= LONG ? LAG_C(1e10) : LAG_C(1e7);
}

/* Finds impulses P >= 0 along gaps, and of friction within mu times them, so that velocities v + D P obey these
 * laws: the rate A v + b of a gap is at least `least`, and equal where P > 0; slip velocities are in the ball
 * where friction can hold them there, else friction is at its limit and acts towards its centre. P: a guess,
 * then the impulses; v: without impulses, then with them. Ends where a sweep changes no rate by more than
 * `enough`, or after 20 by s->loose. Returns the number of sweeps, forth and back in turn; `most` + 1 where
 * these do not suffice. */
static inline int lag_contact_impulses(const lag_impulses *s, LAG_REAL enough, int most) {
  enum { MANY = 32, SOME = 20, QUICK = 3000 };
  const LAG_REAL zero = LAG_C(0.0);
  /* change 1000 sweeps ago: rows that depend on others agree to their own rounding only */
  LAG_REAL before = enough*LAG_C(1e8), stride = LAG_C(1.0), square = zero;
  lag_find_opposites(s);
  for (int i = 0; i < s->n; i++) lag_find_coupling(s, &s->of[i]);
  for (int i = 0; i < s->n; i++)
    for (int k = (int)s->of[i].row; k <= (int)(s->of[i].row + s->of[i].tangents); k++) {
      const LAG_REAL guess = LAG_SELECT(s->response[k] > zero, s->P[k], zero);
      s->P[k] = s->was[k] = s->went[k] = zero;
      lag_add_impulse(&s->D, k, guess, s->P, s->v);
      if (s->n > MANY) s->was[k] = guess;
    }
  for (int sweep = 1; sweep <= most; sweep++) {
    LAG_REAL change = zero;
    const int conjugate = s->n > MANY && sweep <= QUICK;
    const LAG_REAL part = conjugate ? LAG_C(1.0) : lag_contact_damping(sweep);
    int softer = 0;
    for (int i = 0; i < s->n; i++) {
      const LAG_REAL one = lag_contact_turn(s, &s->of[sweep % 2 ? i : s->n - 1 - i], part);
      change = LAG_SELECT(one > change || !lag_is_number(one), one, change);
    }
    if (sweep >= SOME && change <= s->loose) change = zero;
    if (change > enough && (sweep == 200 || sweep % 5000 == 0) && lag_contact_newton(s)) change = zero;
    for (int i = 0; i < s->n && !(change > enough); i++) softer += lag_contact_soften(s, &s->of[i], enough);
    if (!(change > enough) && softer == 0 && lag_contacts_loosen(s) == 0) return sweep;
    if (sweep % 1000 == 0 && change <= lag_contact_swing(s->n, sweep)*enough && change >= LAG_C(0.9)*before)
      return sweep;
    if (sweep % 1000 == 0) before = change;
    if (conjugate && sweep % 2 == 0) lag_contact_conjugate(s, &square);
    if (!conjugate && sweep % 32 == 0 && sweep > 200) stride = lag_contact_stride(s, stride);
  }
  return most + 1;
}

/* ---- end ---- */
#endif
