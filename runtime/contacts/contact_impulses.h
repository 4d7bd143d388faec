/* Impulses of many contacts at once, with friction in one or two tangential directions. */
#pragma once

/* Rows of a sparse matrix: row r has the entries first[r] .. first[r + 1] - 1. Indices are doubles, since they lie in blocks of doubles. */
typedef struct lag_sparse_rows {
  double *first, *col, *value;
} lag_sparse_rows;

/* A contact: rows row (the gap) and row + 1 .. row + tangents (slip velocities). least: the least rate of the gap after the impulse. Friction drives the slip velocity to the
 * nearest point of a ball (an interval in a plane), about centre[tangents], of this radius. strikes: 1 in an impact; rate, slip[tangents]: at the begin. */
typedef struct lag_pressing {
  double contact, row, tangents, mu, least, radius, centre[2], strikes, rate, slip[2];
} lag_pressing;

/* Finds impulses P >= 0 along gaps, and of friction within mu times them, so that velocities v + D P obey these laws: the rate A v + b of a gap is at least
 * `least`, and equal where P > 0; slip velocities are in the ball where friction can hold them there, else friction is at its limit and acts towards its centre.
 * Where an impact would bring in energy, as friction by the slip at the end may, its ball is made that of the mean slip, whose diameter goes from -slip to the centre.
 * A, D: one row each for each impulse, D = M^-1 A^T; response[rows]: the diagonal of A D, 0: no impulse moves this row; b[rows]. P[rows]: a guess, then the impulses; v[]: without
 * impulses, then with them. Ends where a sweep changes no rate by more than `enough`. Returns the number of sweeps; `most` + 1 where these do not suffice.
 *
 * Projected Gauss-Seidel, contact by contact, forth and back: M. Jean, Comput. Methods Appl. Mech. Eng. 177 (1999) 235, DOI 10.1016/S0045-7825(98)00383-1. */
int lag_contact_impulses(int n, lag_pressing *of, const lag_sparse_rows *A, const lag_sparse_rows *D, const double *response, const double *b, double enough, int most, double *P, double *v);

/* Whether a contact takes part in a step h: its gap is closed at the middle, or may close until the end. r0, r1: rates at the begin, and at the end without contacts; pace: rates
 * that forces and curvature cause in a step. */
int lag_contact_takes_part(double gap, double r0, double r1, double pace, double h);
/* Whether it strikes: the gap closes faster than forces and curvature alone make it close in a step. */
int lag_contact_strikes(double r0, double pace);
/* Fills in c->least, centre and radius. bend: change of the rate of the gap by its curvature until the middle; e: restitution of an impact, 0 where there is none; back: the same along the surface;
 * slip[c->tangents]: at the begin. */
void lag_contact_law(lag_pressing *c, double gap, double r0, double bend, double h, double e, double back, int strikes, const double *slip);

/* The product of row r with x. */
double lag_row_product(const lag_sparse_rows *A, int r, const double *x);
