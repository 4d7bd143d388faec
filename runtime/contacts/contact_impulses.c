/* Projected Gauss-Seidel for impulses of contacts. Enters: velocities without contacts, and the laws of the contacts that take part; leaves: velocities with them. Holds: each
 * contact obeys its own law after its turn; the last sweep changes none of them noticeably. */
#include "contacts/contact_impulses.h"

#include <math.h>

double lag_row_product(const lag_sparse_rows *A, int r, const double *x) {
  double sum = 0;
  for (int e = (int)A->first[r]; e < (int)A->first[r + 1]; e++) sum += A->value[e] * x[(int)A->col[e]];
  return sum;
}

int lag_contact_takes_part(double gap, double r0, double r1, double pace, double h) {
  return gap <= 0 || (gap + h / 2 * (fmin(r0, r1) - pace) <= 0 && r0 >= -pace);
}

int lag_contact_strikes(double r0, double pace) { return r0 < -pace; }

/* Half a gap is left by its rate -gap/h, and the next middle has none. On a curve that bends towards the body the rate is that which curvature takes away until the end; the middle lies inside
 * by h/4 of it, and a body deeper than that is led out, no faster than the gap closed. */
void lag_contact_law(lag_pressing *c, double gap, double r0, double bend, double h, double e, double back, int strikes, const double *slip) {
  double size = 0, down = fmin(bend, 0), part = strikes ? back : (1 + back) / 2, left = gap - down * (h / 4);
  c->least = left > 0 || down < 0 ? -down - left / h : 0;
  if (r0 > 0 || down < 0) c->least = fmin(-r0, c->least);
  if (strikes) c->least = fmax(-down, -fmin(fmax(e, 0), 1) * r0);
  for (int j = 0; j < (int)c->tangents; j++) {
    c->slip[j] = slip[j];
    c->centre[j] = -part * slip[j];
    size = hypot(size, slip[j]);
  }
  c->radius = strikes ? 0 : (1 - back) / 2 * size;
  c->strikes = strikes ? 1 : 0;
  c->rate = r0;
}

/* Changes impulse r by dP. */
static void add_impulse(const lag_sparse_rows *D, int r, double dP, double *P, double *v) {
  P[r] += dP;
  for (int e = (int)D->first[r]; e < (int)D->first[r + 1]; e++) v[(int)D->col[e]] += dP * D->value[e];
}

/* x := the point of the ball nearest to x[n]. */
static void into_ball(int n, const double *centre, double radius, double *x) {
  double far = n > 1 ? hypot(x[0] - centre[0], x[1] - centre[1]) : fabs(x[0] - centre[0]);
  for (int k = 0; k < n && far > radius; k++) x[k] = centre[k] + (x[k] - centre[k]) * (radius / far);
}

/* One turn of a contact; returns the largest change of a rate. */
static double turn(const lag_pressing *c, const lag_sparse_rows *A, const lag_sparse_rows *D, const double *response, const double *b, double *P, double *v) {
  static const double origin[2] = {0, 0};
  int r = (int)c->row, n = (int)c->tangents;
  double change = 0, free[2] = {0, 0}, hold[2], w = 0;
  if (response[r] > 0) {
    double rate = lag_row_product(A, r, v) + b[r], wanted = fmax(0, P[r] + (c->least - rate) / response[r]);
    change = fabs(wanted - P[r]) * response[r];
    add_impulse(D, r, wanted - P[r], P, v);
  }
  for (int k = 1; k <= n; k++) w += response[r + k]; /* the trace: no less than the largest eigenvalue, and the same in all directions */
  if (!(w > 0)) return change;
  for (int k = 0; k < n; k++) hold[k] = free[k] = lag_row_product(A, r + 1 + k, v) + b[r + 1 + k] - w * P[r + 1 + k];
  into_ball(n, c->centre, c->radius, hold);
  for (int k = 0; k < n; k++) hold[k] = (hold[k] - free[k]) / w;
  into_ball(n, origin, c->mu * P[r], hold);
  for (int k = 0; k < n; k++) {
    change = fmax(change, fabs(hold[k] - P[r + 1 + k]) * w);
    add_impulse(D, r + 1 + k, hold[k] - P[r + 1 + k], P, v);
  }
  return change;
}

/* Whether friction by the slip at the end brings in energy in an impact; then its ball becomes that of the mean slip. */
static int soften(lag_pressing *c, const lag_sparse_rows *A, const double *b, double enough, const double *P, const double *v) {
  int r = (int)c->row, n = (int)c->tangents;
  double work = P[r] * (c->rate + lag_row_product(A, r, v) + b[r]), size = P[r], width = 0;
  if (!(c->strikes > 0) || c->radius > 0) return 0;
  for (int k = 0; k < n; k++) {
    work += P[r + 1 + k] * (c->slip[k] + lag_row_product(A, r + 1 + k, v) + b[r + 1 + k]);
    size += fabs(P[r + 1 + k]);
    width = hypot(width, c->slip[k] + c->centre[k]);
  }
  if (!(work > enough * size && width > 0)) return 0;
  for (int k = 0; k < n; k++) c->centre[k] = (c->centre[k] - c->slip[k]) / 2;
  c->radius = width / 2;
  return 1;
}

int lag_contact_impulses(int n, lag_pressing *of, const lag_sparse_rows *A, const lag_sparse_rows *D, const double *response, const double *b, double enough, int most, double *P, double *v) {
  for (int i = 0; i < n; i++)
    for (int k = (int)of[i].row; k <= (int)(of[i].row + of[i].tangents); k++) {
      double guess = response[k] > 0 ? P[k] : 0;
      P[k] = 0;
      add_impulse(D, k, guess, P, v);
    }
  for (int sweep = 1; sweep <= most; sweep++) {
    double change = 0;
    for (int i = 0; i < n; i++) {
      double one = turn(&of[sweep % 2 ? i : n - 1 - i], A, D, response, b, P, v);
      change = one > change || isnan(one) ? one : change;
    }
    int softer = 0;
    for (int i = 0; i < n && !(change > enough); i++) softer += soften(&of[i], A, b, enough, P, v);
    if (!(change > enough) && softer == 0) return sweep;
  }
  return most + 1;
}
