/* slipping_forces.h: friction of bodies that slip, by the forces that press them. Enters: the part of its size with
 * which each friction acts; pressing forces N, linear in frictions. Leaves: frictions x with x + mode mu |N| = 0, found
 * together by Newton's method; of a contact N has its sign. Holds: what is left is rounding, also where friction
 * presses the guide that causes it; from mu |dN/dx| = 1 on no motion or several follow.
 *
 * An instance defines before it includes this text:
 *   LAG_MODEL, LAG_THE_MODEL      the first parameters of functions: the model; the same as arguments
 *   LAG_PRESSING(w)               a status; mu[n] and N[3 n] for frictions x[n]
 *   LAG_SLIPPING_FAILS(w, k, by)  a status: friction k presses its guide with `by` times the friction that follows */
#ifndef LAG_SLIPPING_FORCES_H
#define LAG_SLIPPING_FORCES_H

#include "kernels/band_matrix.h"
#include "kernels/coulomb.h"

/* ---- slipping ---- */

typedef struct lag_slipping {
  int n, guides;          /* frictions, and those of guides */
  int alone;              /* no friction holds a body, which leaves others one motion */
  LAG_REAL epsilon, size; /* rounding of LAG_REAL; the largest friction so far, whose rounding others have, too */
  LAG_REAL *of, *parts;   /* [n] the instance's number; components of N of a guide, 0: of a contact */
  LAG_REAL *mode, *mu, *x, *left, *change; /* [n] left: x + mode mu |N| */
  LAG_REAL *N, *N0, *toward, *C;           /* [3 n], direction of N; [3 n n] change of N by a friction of 1 */
  LAG_REAL *known;                         /* [n] whether that column of C is known, from the same state */
  LAG_REAL *a, *pivot, *scale;             /* the Jacobian of `left` */
} lag_slipping;

#define LAG_SLIPPING_ROOM(n) ((n)*(19 + 4*(n)))

static inline void lag_slipping_place(lag_slipping *w, int most, LAG_REAL *room) {
  w->of = room, w->parts = room += most, w->mode = room += most, w->mu = room += most, w->x = room += most;
  w->left = room += most, w->change = room += most, w->N = room += most, w->N0 = room += 3*most;
  w->toward = room += 3*most, w->pivot = room += 3*most, w->scale = room += most, w->C = room += most;
  w->a = room += 3*most*most, w->known = room + most*most;
  for (int k = 0; k < most; k++) w->known[k] = LAG_C(0.0);
}

static inline int lag_slipping_parts(const lag_slipping *w, int k) {
  return w->parts[k] > LAG_C(0.0) ? (int)w->parts[k] : 1;
}

static inline int lag_slipping_acts(const lag_slipping *w, int k) {
  return w->mode[k] > LAG_C(0.0) || w->mode[k] < LAG_C(0.0);
}

static inline LAG_REAL lag_slipping_norm(const LAG_REAL *x, int n) {
  LAG_REAL size = LAG_FN(fabs)(x[0]);
  for (int i = 1; i < n; i++) size = lag_length_of(size, x[i]);
  return size;
}

/* left, toward, and *largest friction; N and mu for the frictions x. */
static inline int lag_slipping_left(LAG_MODEL, lag_slipping *w, LAG_REAL *largest) {
  const LAG_REAL zero = LAG_C(0.0);
  int status = 0;
  *largest = zero;
  LAG_TRY(LAG_PRESSING(w));
  for (int k = 0; k < w->n; k++) {
    const LAG_REAL *const N = w->N + 3*k;
    const int parts = lag_slipping_parts(w, k), guide = w->parts[k] > zero;
    const LAG_REAL size = guide ? lag_slipping_norm(N, parts) : N[0], most = w->mode[k]*w->mu[k]*size;
    w->left[k] = w->x[k] + most;
    *largest = lag_larger(LAG_FN(fabs)(most), *largest);
    for (int c = 0; c < parts; c++)
      w->toward[3*k + c] = guide && size > zero ? N[c]/size : c == 0 ? LAG_C(1.0) : zero;
  }
  return status;
}

/* C, from N without frictions: exact in a unit that is not small. A friction of mode 0 stays 0. */
static inline int lag_slipping_slopes(LAG_MODEL, lag_slipping *w, LAG_REAL largest) {
  const LAG_REAL unit = lag_larger(LAG_C(1.0), largest), zero = LAG_C(0.0);
  int status = 0;
  for (int i = 0; i < 3*w->n; i++) w->N0[i] = w->N[i];
  for (int j = 0; j < w->n; j++) {
    const int acts = lag_slipping_acts(w, j);
    if (w->known[j] > zero) continue;
    w->x[j] = unit;
    if (acts) LAG_TRY(LAG_PRESSING(w));
    w->x[j] = zero;
    for (int i = 0; i < 3*w->n; i++) w->C[3*w->n*j + i] = acts ? (w->N[i] - w->N0[i])/unit : zero;
    w->known[j] = acts ? LAG_C(1.0) : zero;
  }
  for (int i = 0; i < 3*w->n; i++) w->N[i] = w->N0[i];
  return status;
}

/* Numbers that keep C of n frictions between calls at one place[size]: a state, and what else C depends on. */
#define LAG_SLOPES_ROOM(n, size) ((size) + (n)*(3*(n) + 1))

/* C := columns known at the same place. */
static inline void lag_slipping_recall(lag_slipping *w, const LAG_REAL *place, int size, LAG_REAL *kept) {
  int same = 1;
  for (int i = 0; i < size; i++) {
    same = same && !(kept[i] < place[i] || kept[i] > place[i]);
    kept[i] = place[i];
  }
  for (int k = 0; k < w->n; k++) w->known[k] = same ? kept[size + k] : LAG_C(0.0);
  for (int i = 0; i < 3*w->n*w->n; i++) w->C[i] = kept[size + w->n + i];
}

static inline void lag_slipping_keep(const lag_slipping *w, int size, LAG_REAL *kept) {
  for (int k = 0; k < w->n; k++) kept[size + k] = w->known[k];
  for (int i = 0; i < 3*w->n*w->n; i++) kept[size + w->n + i] = w->C[i];
}

/* Part of friction k by which it presses its own guide: from 1 on it feeds itself. */
static inline LAG_REAL lag_slipping_gain(const lag_slipping *w, int k) {
  return w->mu[k]*lag_slipping_norm(w->C + 3*(w->n*k + k), lag_slipping_parts(w, k));
}

/* x += Newton's step. Not 0: there is none. */
static inline int lag_slipping_step(lag_slipping *w) {
  lag_band_matrix A = {w->n, w->n - 1, w->a, w->pivot};
  for (int k = 0; k < w->n; k++) {
    w->change[k] = -w->left[k];
    for (int j = 0; j < w->n; j++) {
      const LAG_REAL *const C = w->C + 3*(w->n*j + k);
      LAG_REAL *const a = lag_band_matrix_at(&A, k, j);
      *a = k == j ? LAG_C(1.0) : LAG_C(0.0);
      for (int c = 0; c < lag_slipping_parts(w, k); c++) *a += w->mode[k]*w->mu[k]*w->toward[3*k + c]*C[c];
    }
  }
  if (lag_band_matrix_factor(&A, w->scale)) return -1;
  lag_band_matrix_solve(&A, w->change);
  for (int k = 0; k < w->n; k++) w->x[k] += w->change[k];
  return 0;
}

/* x[n] := the frictions. Where one passes through 0 its rounding is that of the others. */
static inline int lag_slipping_solve(LAG_MODEL, lag_slipping *w) {
  const int rounds = w->guides ? 30 : 4;
  LAG_REAL largest, most = LAG_C(0.0);
  int status = 0, far = 1, acting = 0;
  for (int k = 0; k < w->n; k++) w->x[k] = LAG_C(0.0);
  for (int k = 0; k < w->n; k++) acting += lag_slipping_acts(w, k);
  if (acting == 0) return status;
  LAG_TRY(lag_slipping_left(LAG_THE_MODEL, w, &largest));
  LAG_TRY(lag_slipping_slopes(LAG_THE_MODEL, w, largest));
  for (int k = 0; k < w->n && w->alone; k++)
    if (lag_slipping_acts(w, k) && w->parts[k] > LAG_C(0.0) && lag_slipping_gain(w, k) >= LAG_C(1.0))
      return LAG_SLIPPING_FAILS(w, k, lag_slipping_gain(w, k));
  for (int round = 0; round < rounds && far; round++) {
    if (lag_slipping_step(w)) return LAG_SLIPPING_FAILS(w, -1, LAG_C(0.0));
    LAG_TRY(lag_slipping_left(LAG_THE_MODEL, w, &largest));
    most = LAG_C(0.0);
    for (int k = 0; k < w->n; k++) most = lag_larger(LAG_FN(fabs)(w->left[k]), most);
    far = !(most <= LAG_C(16.0)*w->epsilon*lag_larger(w->size, largest));
  }
  w->size = lag_larger(w->size, largest);
  /* rounding of a single force that nothing but rounding presses */
  const int alone = acting == 1 && w->alone && lag_is_number(most);
  return alone || !w->guides || most <= LAG_C(5e4)*w->epsilon*w->size
             ? 0
             : LAG_SLIPPING_FAILS(w, 0, lag_slipping_gain(w, 0));
}

/* ---- end ---- */
#endif
