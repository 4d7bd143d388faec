/* lag_support.h: functions that models of some kinds call: dense linear systems, curves through the rows of tables.
 * Includes lag_lanes.h. */
#ifndef LAG_SUPPORT_H
#define LAG_SUPPORT_H

#include "lag_lanes.h"

/* ---- solver: front ---- */
LAG_UNUSED static LAG_MASK lag_solve(int n, LAG_REAL *M, LAG_REAL *b);

/* ---- solver ---- */
/* M x = b by elimination with partial pivoting (Golub & Van Loan, Matrix Computations, 4th ed., algorithm 3.4.1):
 * M[n*n] row-major is destroyed, b becomes x. Rows are exchanged under a mask, so that each lane has its own pivots.
 * Zeros outside of a band are passed over: of rows exchanged within it, `below` rows and `below + above` columns follow
 * a pivot. Returns whether M is regular, or has elements that are no numbers: then x has some. */
LAG_UNUSED static LAG_MASK lag_solve(int n, LAG_REAL *M, LAG_REAL *b) {
  LAG_MASK regular = LAG_C(0.0) == LAG_C(0.0);
  int below = 0, above = 0;
  for (int i = 0; i < n; i++) {
    for (int j = 0; j < i - below; j++)
      if (LAG_ANY(M[i*n + j] != LAG_C(0.0))) below = i - j;
    for (int j = n - 1; j > i + above; j--)
      if (LAG_ANY(M[i*n + j] != LAG_C(0.0))) above = j - i;
  }
  for (int k = 0; k < n; k++) {
    const int rows = n - k > below ? k + below + 1 : n, end = n - k > below + above ? k + below + above + 1 : n;
    for (int i = k + 1; i < rows; i++) { /* the largest element of column k is moved to row k */
      const LAG_REAL here = LAG_FN(fabs)(M[i*n + k]);
      const LAG_MASK larger = LAG_OR(here > LAG_FN(fabs)(M[k*n + k]), here != here);
      if (!LAG_ANY(larger)) continue;
      for (int j = k; j <= end; j++) {
        LAG_REAL *const upper = j < end ? &M[k*n + j] : &b[k], *const lower = j < end ? &M[i*n + j] : &b[i];
        const LAG_REAL was = *upper;
        *upper = LAG_SELECT(larger, *lower, was);
        *lower = LAG_SELECT(larger, was, *lower);
      }
    }
    regular = LAG_AND(regular, LAG_NOT(LAG_FN(fabs)(M[k*n + k]) <= LAG_C(0.0)));
    if (!LAG_ANY(regular)) break;
    for (int i = k + 1; i < rows; i++) {
      const LAG_REAL factor = M[i*n + k]/M[k*n + k];
      for (int j = k + 1; j < end; j++) M[i*n + j] -= factor*M[k*n + j];
      b[i] -= factor*b[k];
    }
  }
  for (int k = n - 1; k >= 0; k--) {
    const int end = n - k > below + above ? k + below + above + 1 : n;
    for (int j = k + 1; j < end; j++) b[k] -= M[k*n + j]*b[j];
    b[k] /= M[k*n + k];
  }
  return regular;
}

/* ---- interval ---- */
/* The interval of the first lane: of n rows of this width, which begin with a time. */
LAG_UNUSED static int lag_interval(LAG_REAL t, int n, int width, const LAG_LANE *row) {
  int k = 0;
  for (int end = n - 1; end - k > 1;) {
    const int mid = (k + end)/2;
    if (LAG_ANY(t < LAG_C(0.0) + row[width*mid])) end = mid;
    else k = mid;
  }
  return k;
}

/* ---- cubic: front ---- */
#define LAG_ROW(t, y, m) {(LAG_LANE)(t), (LAG_LANE)(y), (LAG_LANE)(m)}
LAG_UNUSED static LAG_REAL lag_spline(LAG_REAL t, int n, const LAG_LANE (*row)[3]);

/* ---- cubic ---- */
/* The cubic between two rows of time, value and second derivative; outside of them the nearest value. */
LAG_UNUSED static LAG_REAL lag_cubic(LAG_REAL t, const LAG_LANE *a, const LAG_LANE *b) {
  const LAG_LANE h = b[0] - a[0];
  const LAG_REAL part = (t - a[0])/h, zero = LAG_C(0.0), one = LAG_C(1.0);
  const LAG_REAL x = LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, one, part)), rest = one - x;
  return rest*a[1] + x*b[1]
       - x*rest*(h*h/(LAG_LANE)6)*((one + rest)*a[2] + (one + x)*b[2]);
}

/* The curve through n rows. Between the first and the last row it has two continuous derivatives. */
LAG_UNUSED static LAG_REAL lag_spline(LAG_REAL t, int n, const LAG_LANE (*row)[3]) {
  int k = lag_interval(t, n, 3, row[0]);
  LAG_REAL y = lag_cubic(t, row[k], row[k + 1]);
  for (k++; k < n - 1; k++) { /* lanes that are further on */
    const LAG_MASK later = t >= LAG_C(0.0) + row[k][0];
    if (!LAG_ANY(later)) break;
    y = LAG_SELECT(later, lag_cubic(t, row[k], row[k + 1]), y);
  }
  return y;
}

/* ---- quintic: front ---- */
#define LAG_JET(t, y, d, m) {(LAG_LANE)(t), (LAG_LANE)(y), (LAG_LANE)(d), (LAG_LANE)(m)}
LAG_UNUSED static LAG_REAL lag_curve(LAG_REAL t, int n, const LAG_LANE (*row)[4], int order);

/* ---- quintic ---- */
/* Derivative 0, 1 or 2 of the quintic between two rows of time, value, first and second derivative; outside of them
 * the nearest value, and 0. */
LAG_UNUSED static LAG_REAL lag_quintic(LAG_REAL t, int order, const LAG_LANE *a, const LAG_LANE *b) {
  const LAG_LANE h = b[0] - a[0], m = h*a[2], s = h*h*a[3], half = (LAG_LANE)1/(LAG_LANE)2;
  const LAG_LANE A = b[1] - a[1] - m - half*s, B = h*b[2] - m - s, C = h*h*b[3] - s;
  const LAG_LANE c3 = (LAG_LANE)10*A - (LAG_LANE)4*B + half*C, c4 = (LAG_LANE)7*B - (LAG_LANE)15*A - C;
  const LAG_LANE c5 = (LAG_LANE)6*A - (LAG_LANE)3*B + half*C;
  const LAG_REAL part = (t - a[0])/h, zero = LAG_C(0.0), one = LAG_C(1.0);
  const LAG_REAL x = LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, one, part));
  if (order == 0) return a[1] + x*(m + x*(half*s + x*(c3 + x*(c4 + x*c5))));
  const LAG_REAL d = order == 1 ? (m + x*(s + x*((LAG_LANE)3*c3 + x*((LAG_LANE)4*c4 + x*((LAG_LANE)5*c5)))))/h
                                : (s + x*((LAG_LANE)6*c3 + x*((LAG_LANE)12*c4 + x*((LAG_LANE)20*c5))))/(h*h);
  return LAG_SELECT(part < zero, zero, LAG_SELECT(part > one, zero, d));
}

/* A derivative of the curve through n rows, which has four that are continuous. */
LAG_UNUSED static LAG_REAL lag_curve(LAG_REAL t, int n, const LAG_LANE (*row)[4], int order) {
  int k = lag_interval(t, n, 4, row[0]);
  LAG_REAL y = lag_quintic(t, order, row[k], row[k + 1]);
  for (k++; k < n - 1; k++) { /* lanes that are further on */
    const LAG_MASK later = t >= LAG_C(0.0) + row[k][0];
    if (!LAG_ANY(later)) break;
    y = LAG_SELECT(later, lag_quintic(t, order, row[k], row[k + 1]), y);
  }
  return y;
}

/* ---- near: front ---- */
/* Neighbours: for each of n members those of lower number nearer than `cut`, and a few more, ascending. Candidates are
 * kept while no member has moved half the skin from where they were found; as the caller passes over those beyond the
 * cut, its sums are the same to the last bit however old the list is (L. Verlet, Phys. Rev. 159 (1967) 98,
 * doi:10.1103/PhysRev.159.98; cells: B. Quentrec, C. Brot, J. Comput. Phys. 13 (1973) 430,
 * doi:10.1016/0021-9991(73)90046-6). */
#define LAG_NEAR_WIDTH 128 /* most candidates that are kept for a member */
#define LAG_NEAR_INTS(n) ((n)*(LAG_NEAR_WIDTH + 4 + LAG_MOST_SHARES) + 2)
#define LAG_NEAR_NUMBERS(n) (6*(n))

/* floor, bit by bit, without a call where the processor's instructions lack it. */
LAG_UNUSED static double lag_floor(double x) {
  if (!(fabs(x) < 4503599627370496.0)) return x;
  const double whole = (double)(long long)x;
  return whole > x ? whole - 1 : whole < x ? whole : x;
}

typedef struct {
  int n, parts, known;         /* known: the list is usable */
  int cells[3], first[3], step; /* component c of member k is q[first[c] + step*k] */
  double cut, reach, side[3], inverse[3]; /* side 0, inverse 0: open */
  double from[3], width[3];    /* of cells */
  double *x, *place;           /* [3n] where the list was made; the same in the box, by cell */
  int *count, *cell, *order, *at, *row, *list; /* at: place of each member in that order */
} lag_near;

#ifdef LAG_LANES
/* Each lane has neighbours of its own: all members of lower number. */
LAG_UNUSED static void lag_near_find(lag_near *w, const LAG_REAL *q, LAG_REAL cut, const LAG_REAL *side) {
  (void)w, (void)q, (void)cut, (void)side;
}

LAG_UNUSED static int lag_near_of(lag_near *w, int k, const int **list) {
  for (int j = 0; j < k; j++) w->row[j] = j;
  *list = w->row;
  return k;
}
#else
/* Square of the distance of two places in the box. */
LAG_UNUSED static double lag_near_square(const lag_near *w, const double *x, const double *y) {
  double square = 0;
  for (int c = 0; c < 3; c++) {
    const double d = fabs(x[c] - y[c]), back = w->side[c] - d, least = w->side[c] > 0 && back < d ? back : d;
    square += least*least;
  }
  return square;
}

LAG_UNUSED static int lag_near_index(const lag_near *w, int c, double x) {
  const int at = (int)((x - w->from[c])/w->width[c]);
  return at < 0 ? 0 : at < w->cells[c] ? at : w->cells[c] - 1;
}

/* Lays cells, at least as wide as the reach and not more than members; 0: a place is no number. */
LAG_UNUSED static int lag_near_lay(lag_near *w) {
  double all = 1;
  for (int c = 0; c < 3; c++) {
    double least = 0, most = 0;
    for (int k = 0; k < w->n && c < w->parts; k++) {
      const double x = w->x[3*k + c];
      if (!(fabs(x) < 1e9*w->reach)) return 0;
      least = !k || x < least ? x : least;
      most = !k || x > most ? x : most;
    }
    w->from[c] = w->side[c] > 0 ? 0 : least;
    const double size = w->side[c] > 0 ? w->side[c] : most - least, fit = size/w->reach;
    w->cells[c] = fit < 1 ? 1 : fit < 1024 ? (int)fit : 1024;
    w->width[c] = size;
    all *= w->cells[c];
  }
  for (; all > w->n + 1; all = (double)w->cells[0]*w->cells[1]*w->cells[2]) {
    const int c = w->cells[0] >= w->cells[1] && w->cells[0] >= w->cells[2] ? 0 : w->cells[1] >= w->cells[2] ? 1 : 2;
    w->cells[c] = (w->cells[c] + 1)/2;
  }
  for (int c = 0; c < 3; c++) {
    if (w->side[c] > 0 && w->cells[c] < 3) w->cells[c] = 1; /* so that no cell is its own neighbour's neighbour */
    w->width[c] = w->width[c] > 0 ? w->width[c]/w->cells[c] : 1;
  }
  return 1;
}

LAG_UNUSED static int lag_near_cell(const lag_near *w, const double *x) {
  int cell = 0;
  for (int c = w->parts - 1; c >= 0; c--) cell = cell*w->cells[c] + lag_near_index(w, c, x[c]);
  return cell;
}

/* Members by cell, ascending in each, and their places, in the box. */
LAG_UNUSED static void lag_near_sort(lag_near *w) {
  const int cells = w->cells[0]*w->cells[1]*w->cells[2];
  for (int k = 0; k <= cells; k++) w->cell[k] = 0;
  for (int k = 0; k < w->n; k++) {
    double x[3];
    for (int c = 0; c < 3; c++) x[c] = w->x[3*k + c] - w->side[c]*lag_floor(w->x[3*k + c]*w->inverse[c]);
    w->cell[w->row[k] = lag_near_cell(w, x)]++;
  }
  for (int k = 1; k <= cells; k++) w->cell[k] += w->cell[k - 1];
  for (int k = w->n - 1; k >= 0; k--) {
    const int s = w->at[k] = --w->cell[w->row[k]];
    w->order[s] = k;
    for (int c = 0; c < 3; c++) w->place[3*s + c] = w->x[3*k + c] - w->side[c]*lag_floor(w->x[3*k + c]*w->inverse[c]);
  }
}

/* The cells around that of a place: at most 27. */
LAG_UNUSED static int lag_near_around(const lag_near *w, const double *x, int *around) {
  int n = 1;
  around[0] = 0;
  for (int c = w->parts - 1; c >= 0; c--) {
    const int at = lag_near_index(w, c, x[c]), cells = w->cells[c];
    int of[27], more = 0;
    for (int d = -1; d <= 1; d++) {
      int to = at + d;
      if (w->side[c] > 0 && cells > 1) to = to < 0 ? to + cells : to < cells ? to : to - cells;
      if (to < 0 || to >= cells) continue;
      for (int k = 0; k < n; k++) of[more++] = around[k]*cells + to;
    }
    for (int k = 0; k < more; k++) around[k] = of[k];
    n = more;
  }
  return n;
}

/* Appends member j to the lists of those after it that are in reach: so each list ascends. */
LAG_UNUSED static void lag_near_append(lag_near *w, int j) {
  int around[27];
  const double *y = w->place + 3*w->at[j], square = w->reach*w->reach;
  const int n = lag_near_around(w, y, around);
  for (int a = 0; a < n; a++)
    for (int s = w->cell[around[a] + 1] - 1; s >= w->cell[around[a]] && w->order[s] > j; s--) {
      const int k = w->order[s];
      if (!(lag_near_square(w, w->place + 3*s, y) < square)) continue;
      if (w->count[k] < LAG_NEAR_WIDTH) w->list[LAG_NEAR_WIDTH*k + w->count[k]] = j;
      w->count[k]++;
    }
}

/* Whether the list is of this cut and these sides, and no member has moved half the skin since. */
LAG_UNUSED static int lag_near_holds(const lag_near *w, const LAG_REAL *q, double cut, const LAG_REAL *side) {
  const double far = 0.49*(w->reach - w->cut), limit = far*far;
  if (!w->known || w->cut < cut || w->cut > cut) return 0;
  for (int c = 0; c < w->parts; c++)
    if (w->side[c] < (double)side[c] || w->side[c] > (double)side[c]) return 0;
  for (int k = 0; k < w->n; k++) {
    double square = 0;
    for (int c = 0; c < w->parts; c++) {
      const double d = (double)q[w->first[c] + w->step*k] - w->x[3*k + c];
      square += d*d;
    }
    if (!(square < limit)) return 0;
  }
  return 1;
}

/* Makes the list for these places, where it does not hold any more. */
LAG_UNUSED static void lag_near_find(lag_near *w, const LAG_REAL *q, LAG_REAL cut, const LAG_REAL *side) {
  if (lag_near_holds(w, q, (double)cut, side)) return;
  for (int c = 0; c < w->parts; c++) {
    w->side[c] = (double)side[c];
    w->inverse[c] = w->side[c] > 0 ? 1/w->side[c] : 0;
  }
  w->cut = (double)cut;
  w->reach = 1.12*w->cut;
  for (int k = 0; k < w->n; k++)
    for (int c = 0; c < 3; c++) w->x[3*k + c] = c < w->parts ? (double)q[w->first[c] + w->step*k] : 0;
  w->known = lag_near_lay(w);
  if (!w->known) return;
  lag_near_sort(w);
  for (int k = 0; k < w->n; k++) w->count[k] = 0;
  for (int j = 0; j < w->n; j++) lag_near_append(w, j);
}

/* The members of lower number in reach of member k: *list, ascending; returns how many. */
LAG_UNUSED static int lag_near_of(lag_near *w, int k, const int **list) {
  int around[27], n = 0;
  *list = w->row;
  if (!w->known) {
    for (; n < k; n++) w->row[n] = n;
    return n;
  }
  *list = w->list + (long)LAG_NEAR_WIDTH*k;
  if (w->count[k] <= LAG_NEAR_WIDTH) return w->count[k];
  const double *y = w->place + 3*w->at[k];
  const int cells = lag_near_around(w, y, around);
  for (int a = 0; a < cells; a++)
    for (int s = w->cell[around[a]]; s < w->cell[around[a] + 1] && w->order[s] < k; s++)
      if (lag_near_square(w, w->place + 3*s, y) < w->reach*w->reach) w->row[n++] = w->order[s];
  for (int gap = n/2; gap > 0; gap /= 2) /* D. L. Shell, Commun. ACM 2 (1959) 30, doi:10.1145/368370.368387 */
    for (int i = gap; i < n; i++)
      for (int at = i; at >= gap && w->row[at - gap] > w->row[at]; at -= gap) {
        const int last = w->row[at];
        w->row[at] = w->row[at - gap];
        w->row[at - gap] = last;
      }
  *list = w->row;
  return n;
}
#endif

/* A list for n members in memory of its own: numbers[LAG_NEAR_NUMBERS(n)], ints[LAG_NEAR_INTS(n)]. */
LAG_UNUSED static void lag_near_open(lag_near *w, int n, int parts, int step, double *numbers, int *ints) {
  w->n = n, w->parts = parts, w->step = step, w->x = numbers, w->place = numbers + 3*n;
  w->count = ints, w->order = ints + n, w->at = ints + 2*n, w->cell = ints + 3*n, w->list = ints + 4*n + 2;
  w->row = w->list + (long)LAG_NEAR_WIDTH*n;
}

#ifdef LAG_OPENMP
/* Of the list of member k what a share adds up: of its own member all, of a later one those among its own. */
LAG_UNUSED static int lag_near_shared(const lag_near *w, int k, int share, int shares, const int **list) {
  const int from = LAG_SHARE_OF(w->n, share, shares), to = LAG_SHARE_OF(w->n, share + 1, shares);
  lag_near own = *w;
  if (share) own.row += (long)w->n*share;
  int n = lag_near_of(&own, k, list);
  if (k < to) return n;
  if (n && (*list)[0] >= to) return 0;
  while (n && (*list)[n - 1] >= to) n--;
  while (n && (*list)[0] < from) ++*list, n--;
  return n;
}
#endif

/* ---- end ---- */
#endif
