/* impulses.h: impulses of contacts with friction by projected Gauss-Seidel. Includes scalar.h.
 *
 * Enters: velocities without contacts and friction, response of the motion to each; their laws. Leaves: impulses and
 * velocities that obey all laws, for any number of contacts: the problem of numeric/complementarity.h with boxes of
 * friction that depend on the forces which press. Each law in turn, until a sweep changes nothing noticeably: M. Jean,
 * Comput. Methods Appl. Mech. Eng. 177 (1999) 235, DOI 10.1016/S0045-7825(98)00383-1. Those of many contacts go on by
 * momentum; impulses that drift go in strides; those that swing are damped.
 *
 * lagc copies the section below into headers, with their prefix for LAG_ and lag_. LAG_REAL is a scalar. Memory is
 * the caller's; nothing is kept between calls. */
#ifndef LAG_IMPULSES_H
#define LAG_IMPULSES_H

#include "kernels/band_matrix.h"
#include "kernels/contact_turn.h"

/* ---- impulses ---- */

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

/* Impulses of many contacts after two sweeps: on by a part of their change, the more the longer they go on in one
 * direction; velocities are linear in them. *turns: since the last change of direction. H. Mazhar, T. Heyn, D. Negrut,
 * A. Tasora, ACM Trans. Graph. 34 (2015) 32, DOI 10.1145/2735627; B. O'Donoghue, E. Candes, Found. Comput. Math. 15
 * (2015) 715, DOI 10.1007/s10208-013-9150-3. The parts, 0.8 in a few turns and almost 1 in some hundred, take the
 * fewest sweeps in piles of discs. */
static inline void lag_contact_momentum(const lag_impulses *s, LAG_REAL *turns) {
  const LAG_REAL zero = LAG_C(0.0), one = LAG_C(1.0);
  const int rows = (int)(s->of[s->n - 1].row + s->of[s->n - 1].tangents) + 1, dense = s->D.first[rows] > s->nv;
  LAG_REAL back = zero;
  for (int r = 0; r < rows; r++) back += (s->was[r] + s->went[r] - s->P[r])*(s->P[r] - s->was[r]);
  const LAG_REAL k = *turns = LAG_SELECT(back > zero, zero, *turns + one);
  const LAG_REAL part = k/(k + one)*(LAG_C(0.8) + LAG_C(0.2)*k/(k + LAG_C(100.0)));
  for (int r = 0; r < rows; r++) {
    s->went[r] = part*(s->P[r] - s->was[r]);
    s->was[r] = s->P[r];
    if (dense) s->P[r] += s->went[r];
    else lag_add_impulse(&s->D, r, s->went[r], s->P, s->v);
  }
  for (int i = 0; i < s->nv && dense; i++) {
    const LAG_REAL by = part*(s->v[i] - s->v_was[i]);
    s->v_was[i] = s->v[i];
    s->v[i] += by;
  }
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
  LAG_REAL before = enough*LAG_C(1e8), stride = LAG_C(1.0), turns = zero;
  lag_find_opposites(s);
  for (int i = 0; i < s->n; i++) lag_find_coupling(s, &s->of[i]);
  for (int i = 0; i < s->n; i++)
    for (int k = (int)s->of[i].row; k <= (int)(s->of[i].row + s->of[i].tangents); k++) {
      const LAG_REAL guess = LAG_SELECT(s->response[k] > zero, s->P[k], zero);
      s->P[k] = s->was[k] = s->went[k] = zero;
      lag_add_impulse(&s->D, k, guess, s->P, s->v);
      if (s->n > MANY) s->was[k] = guess;
    }
  for (int i = 0; i < s->nv && s->n > MANY; i++) s->v_was[i] = s->v[i];
  for (int sweep = 1; sweep <= most; sweep++) {
    LAG_REAL change = zero;
    const int goes_on = s->n > MANY && sweep <= QUICK;
    const LAG_REAL part = goes_on ? LAG_C(1.0) : lag_contact_damping(sweep);
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
    if (goes_on && sweep % 2 == 0) lag_contact_momentum(s, &turns);
    if (!goes_on && sweep % 32 == 0 && sweep > 200) stride = lag_contact_stride(s, stride);
  }
  return most + 1;
}

/* ---- end ---- */
#endif
