/* lag_band.h: large linear systems with constraints, within a band; part of lag_kkt.h. LAG_NO_BAND leaves it out. */
#ifndef LAG_BAND_H
#define LAG_BAND_H

#include "lag_lanes.h"

/* ---- numbers ---- */
#ifdef LAG_LANES
#define LAG_LANE_FN(f) f
#else
#define LAG_LANE_FN(f) LAG_FN(f)
#endif

/* y[n] := an arbitrary right-hand side, so that nothing cancels. Returns its 1-norm. */
static LAG_LANE lag_any_side(int n, LAG_LANE *y) {
  LAG_LANE u = 0, size = 0;
  for (int i = 0; i < n; i++) {
    u += (LAG_LANE)0.618033988749894848;
    if (u > 1) u -= 1;
    size += u;
    y[i] = i % 2 ? -u : u;
  }
  return size;
}

/* ---- band ---- */
#ifndef LAG_NO_BAND
/* The whole system [M A^T; A 0] within a band, for large systems: along chains, ladders and loops of any number of
 * links its work grows linearly, also where M is singular, or M^-1 full. Few constraints over many coordinates, as on
 * the sum of a family, stand in a border of the band: it is solved by Schur's complement. Unknowns are in the order
 * of Cuthill and McKee (ACM '69: Proc. 24th nat. conf., 157, DOI 10.1145/800195.805928), begun at an end; the
 * factorization is L U with row exchanges, which widen the band by half at most, where the pivots of L D L^T would
 * fill it (Golub & Van Loan, 4.3 and 4.4). All scratch is of LAG_LANE. */
#define LAG_BAND_LEAST 62
#define LAG_BAND_EDGES 6
#define LAG_BAND_WIDE 64 /* neighbours of a constraint in the border: a band would be at least half as wide */
#define LAG_BAND_BORDER 8

/* The adjacency graph and the order of the unknowns: neighbours of unknown i are next[first[i]] to next[first[i +
 * 1]]; order[place[i]] = i. Places of the border come last; its edges are not in the graph. */
typedef struct lag_band {
  int all, edges, half; /* half: half bandwidth, the largest difference of neighbours' places */
  int inner;            /* unknowns within the band */
  LAG_LANE *edge, *first, *next, *order, *place, *scale, *rows, *pivot;
  LAG_LANE *end, *deep; /* last column of each row that is not zero, last row of each column */
  const LAG_LANE *row; /* of A, of each constraint; none: all rows */
  LAG_LANE *across, *solved; /* rows of the border, inner elements each, and their solutions within the band */
  const struct lag_band *core; /* Schur's complement of the border; none: no border */
} lag_band;

/* Positions at[step*k], k < count, outside of which [M | A] is zero; none: at = 0. number[row of A], of those that are
 * not zero, and row[number]. */
typedef struct lag_entries {
  const unsigned *at;
  int step, count;
  LAG_LANE *number, *row;
} lag_entries;

/* Notes edge i, j, unless its element x is zero. Returns 0 where there are too many for a band. */
static int lag_edge(lag_band *b, int i, int j, LAG_LANE x) {
  if (!(x < 0 || x > 0)) return 1;
  if (b->edges == LAG_BAND_EDGES*b->all) return 0;
  b->edge[b->edges++] = (LAG_LANE)i*(LAG_LANE)b->all + (LAG_LANE)j;
  return 1;
}

/* place[all] := -1, and the last places for constraints with many neighbours (first[i], of each unknown), if they are
 * few; sets inner. */
static void lag_find_border(int n, lag_band *b) {
  int wide = 0;
  for (int i = n; i < b->all; i++) wide += b->first[i] > LAG_BAND_WIDE;
  b->inner = b->all - (wide <= LAG_BAND_BORDER ? wide : 0);
  for (int i = 0, at = b->inner; i < b->all; i++) {
    const int border = b->inner < b->all && i >= n && b->first[i] > LAG_BAND_WIDE;
    b->place[i] = (LAG_LANE)(border ? at++ : -1);
    if (border) b->order[at - 1] = (LAG_LANE)i;
  }
}

/* Lists the edges of the graph, i > j, as numbers i*all + j, and the neighbours of each unknown. Returns 0 where
 * there are too many for a band. */
static int lag_edges(int n, int m, const LAG_LANE *M, const LAG_LANE *A, const lag_entries *of, lag_band *b) {
  b->edges = 0;
  for (int k = 0; k < of->count; k++) {
    const int at = (int)of->at[of->step*k], inertia = at < n*n, from = inertia ? at : at - n*n, j = from%n;
    const int i = inertia ? from/n : n + (int)of->number[from/n];
    if (j < i && !lag_edge(b, i, j, inertia ? M[from] : A[from])) return 0;
  }
  for (int i = 0; i < b->all && !of->at; i++) {
    const LAG_LANE *const row = i < n ? M + i*n : A + (i - n)*n;
    for (int j = 0; j < (i < n ? i : n); j++)
      if (!lag_edge(b, i, j, row[j])) return 0;
  }
  for (int i = 0; i <= b->all; i++) b->first[i] = 0;
  for (int e = 0; e < b->edges; e++) {
    const int i = (int)(b->edge[e]/(LAG_LANE)b->all), j = (int)(b->edge[e] - (LAG_LANE)i*(LAG_LANE)b->all);
    b->first[i] += 1, b->first[j] += 1;
  }
  lag_find_border(n, b);
  for (int e = 0; e < b->edges; e++) { /* the border's edges out of the graph */
    const int i = (int)(b->edge[e]/(LAG_LANE)b->all), j = (int)(b->edge[e] - (LAG_LANE)i*(LAG_LANE)b->all);
    if (b->place[i] >= 0) b->first[i] -= 1, b->first[j] -= 1;
  }
  for (int i = 0; i < b->all; i++) b->first[i + 1] += b->first[i];
  for (int e = b->edges - 1; e >= 0; e--) {
    const int i = (int)(b->edge[e]/(LAG_LANE)b->all), j = (int)(b->edge[e] - (LAG_LANE)i*(LAG_LANE)b->all);
    if (b->place[i] >= 0) continue;
    b->next[(int)(b->first[i] -= 1)] = (LAG_LANE)j;
    b->next[(int)(b->first[j] -= 1)] = (LAG_LANE)i;
  }
  return m <= n;
}

/* Breadth-first numbering: places from `at` on go to unknown i, its neighbours, and so on. Returns the first free
 * place. */
static int lag_walk(const lag_band *b, int i, int at) {
  int end = at;
  b->order[end] = (LAG_LANE)i, b->place[i] = (LAG_LANE)end++;
  for (; at < end; at++) {
    const int here = (int)b->order[at];
    for (int e = (int)b->first[here]; e < (int)b->first[here + 1]; e++) {
      const int beside = (int)b->next[e];
      if (b->place[beside] < 0) b->order[end] = (LAG_LANE)beside, b->place[beside] = (LAG_LANE)end++;
    }
  }
  return end;
}

/* Cuthill-McKee order: each connected component is numbered from its far end, found by two earlier walks; sets half. */
static void lag_places(lag_band *b) {
  int at = 0;
  for (int i = 0; i < b->all; i++) {
    if (b->place[i] >= 0) continue; /* in a component before, or in the border */
    int end = lag_walk(b, i, at);
    for (int turn = 0; turn < 2 && end - at > 2; turn++) { /* of two unknowns both ends are far */
      const int from = (int)b->order[end - 1];
      for (int k = at; k < end; k++) b->place[(int)b->order[k]] = -1;
      end = lag_walk(b, from, at);
    }
    at = end;
  }
  b->half = 0;
  for (int i = 0; i < b->all; i++)
    for (int e = (int)b->first[i]; e < (int)b->first[i + 1]; e++) {
      const int far = (int)(b->place[i] - b->place[(int)b->next[e]]);
      b->half = far > b->half ? far : b->half;
    }
}

/* Matrix element of edge e; *i, *j: its unknowns. */
static LAG_LANE lag_element(int n, const lag_band *b, int e, const LAG_LANE *M, const LAG_LANE *A, int *i, int *j) {
  *i = (int)(b->edge[e]/(LAG_LANE)b->all), *j = (int)(b->edge[e] - (LAG_LANE)*i*(LAG_LANE)b->all);
  return *i < n ? M[*i*n + *j] : A[(b->row ? (int)b->row[*i - n] : *i - n)*n + *j];
}

/* Fills the band: rows of 3 half + 1 elements, the last `half` for exchanges, scaled so that M has ones on its
 * diagonal and each constraint a largest element of 1; end: last column of each row; deep: last row of each column. */
static void lag_band_fill(int n, const lag_band *b, const LAG_LANE *M, const LAG_LANE *A) {
  const int h = b->half, width = 3*h + 1;
  int i, j;
  for (int k = 0; k < b->all; k++) b->scale[k] = k < n && M[k*n + k] > 0 ? 1/LAG_LANE_FN(sqrt)(M[k*n + k]) : k < n;
  for (int e = 0; e < b->edges; e++) {
    const LAG_LANE x = LAG_LANE_FN(fabs)(lag_element(n, b, e, M, A, &i, &j))*b->scale[j];
    if (i >= n && x > b->scale[i]) b->scale[i] = x;
  }
  for (int k = n; k < b->all; k++) b->scale[k] = b->scale[k] > 0 ? 1/b->scale[k] : 1;
  for (int k = 0; k < b->inner*width; k++) b->rows[k] = 0;
  for (int k = 0; k < (b->all - b->inner)*b->inner; k++) b->across[k] = 0;
  for (int k = 0; k < n; k++) b->rows[(int)b->place[k]*width + h] = M[k*n + k]*b->scale[k]*b->scale[k];
  for (int k = 0; k < b->inner; k++) b->end[k] = (LAG_LANE)k;
  for (int e = 0; e < b->edges; e++) {
    const LAG_LANE x = lag_element(n, b, e, M, A, &i, &j)*b->scale[i]*b->scale[j];
    const int r = (int)b->place[i], c = (int)b->place[j];
    if (r >= b->inner) {
      b->across[(r - b->inner)*b->inner + c] = x;
      continue;
    }
    b->rows[r*width + c - r + h] = b->rows[c*width + r - c + h] = x;
    const int low = r < c ? r : c, high = r < c ? c : r;
    if (b->end[low] < high) b->end[low] = (LAG_LANE)high;
  }
  for (int k = 0; k < b->inner; k++) b->deep[k] = k > 0 && b->deep[k - 1] > b->end[k] ? b->deep[k - 1] : b->end[k];
}

/* Factors the band, L U with row exchanges. Returns 0 where a pivot is 0. */
static int lag_band_factor(const lag_band *b) {
  const int h = b->half, width = 3*h + 1;
  for (int k = 0; k < b->inner; k++) {
    const int last = (int)b->deep[k];
    int top = k;
    LAG_LANE *const row = b->rows + k*width + h; /* row[c]: column k + c */
    for (int r = k + 1; r <= last; r++)
      if (LAG_LANE_FN(fabs)(b->rows[r * width + k - r + h]) > LAG_LANE_FN(fabs)(b->rows[top * width + k - top + h]))
        top = r;
    b->pivot[k] = (LAG_LANE)top;
    const LAG_LANE ends = b->end[k];
    b->end[k] = b->end[top], b->end[top] = ends;
    for (int c = 0; c <= 2*h && top != k; c++) {
      LAG_LANE *const other = b->rows + top*width + k + c - top + h;
      const LAG_LANE was = row[c];
      row[c] = *other;
      *other = was;
    }
    if (!(LAG_LANE_FN(fabs)(row[0]) > 0)) return 0;
    const int right = (int)b->end[k] - k;
    for (int r = k + 1; r <= last; r++) {
      LAG_LANE *const below = b->rows + r*width + k - r + h;
      const LAG_LANE factor = below[0] /= row[0];
      if (!(factor < 0 || factor > 0)) continue;
      for (int c = 1; c <= right; c++) below[c] -= factor*row[c];
      if (b->end[r] < b->end[k]) b->end[r] = b->end[k];
    }
  }
  return 1;
}

/* y[inner] := the solution within the band for the right-hand side y. */
static void lag_band_inner(const lag_band *b, LAG_LANE *y) {
  const int h = b->half, width = 3*h + 1;
  for (int k = 0; k < b->inner; k++) {
    const int top = (int)b->pivot[k];
    const LAG_LANE x = y[top];
    y[top] = y[k];
    y[k] = x;
    const int last = (int)b->deep[k];
    const LAG_LANE *below = b->rows + (k + 1)*width + h - 1;
    for (int r = k + 1; r <= last; r++, below += width - 1) y[r] -= *below*x;
  }
  for (int k = b->inner - 1; k >= 0; k--) {
    const int right = (int)b->end[k] - k;
    const LAG_LANE *const row = b->rows + k*width + h;
    LAG_LANE x = y[k];
    for (int c = 1; c <= right; c++) x -= row[c]*y[k + c];
    y[k] = x/row[0];
  }
}

/* y[all] := the solution for the right-hand side y, both scaled and in the order of places. */
static void lag_band_solve(const lag_band *b, LAG_LANE *y) {
  lag_band_inner(b, y);
  if (!b->core) return;
  for (int k = 0; k < b->all - b->inner; k++)
    for (int i = 0; i < b->inner; i++) y[b->inner + k] -= b->across[k*b->inner + i]*y[i];
  lag_band_inner(b->core, y + b->inner);
  for (int k = 0; k < b->all - b->inner; k++)
    for (int i = 0; i < b->inner; i++) y[i] -= b->solved[k*b->inner + i]*y[b->inner + k];
}

/* Estimate of the 1-norm of the inverse of a symmetric matrix (W. Hager, SIAM J. Sci. Stat. Comput. 5 (1984) 311,
 * DOI 10.1137/0905023), of its order alone below 1e6. y[all] and z[all] are scratch. */
static LAG_LANE lag_band_inverse(const lag_band *b, LAG_LANE *y, LAG_LANE *z) {
  LAG_LANE size = 0, whole = lag_any_side(b->all, y);
  int at = -1;
  for (int turn = 0; turn < 4; turn++) {
    LAG_LANE now = 0;
    int most = 0;
    for (int i = 0; i < b->all && turn; i++) y[i] = i == at;
    lag_band_solve(b, y);
    for (int i = 0; i < b->all; i++) now += LAG_LANE_FN(fabs)(y[i]), z[i] = y[i] < 0 ? -1 : 1;
    now /= whole;
    if (!(now > size)) return turn ? size : now;
    size = now;
    whole = 1;
    lag_band_solve(b, z);
    for (int i = 1; i < b->all; i++) most = LAG_LANE_FN(fabs)(z[i]) > LAG_LANE_FN(fabs)(z[most]) ? i : most;
    if (most == at || LAG_LANE_FN(fabs)(z[most]) < (LAG_LANE)1e6) break;
    at = most;
  }
  return size;
}

/* core := the Schur complement of the border, factored: a band that is full, in w. Returns 0 where it is singular, or
 * the band alone is so ill-conditioned that its solutions say little. y[all] and z[all] are scratch. */
static int lag_band_core(lag_band *b, lag_band *core, LAG_LANE *w, LAG_LANE *y, LAG_LANE *z) {
  const int p = b->all - b->inner, width = 3*p - 2;
  lag_band alone = *b;
  alone.all = b->inner;
  if (!(lag_band_inverse(&alone, y, z) <= (LAG_LANE)1e5)) return 0;
  core->inner = p, core->half = p - 1, core->rows = w, core->pivot = w + p*width;
  core->end = core->pivot + p, core->deep = core->end + p;
  b->core = core;
  for (int i = 0; i < p*width; i++) core->rows[i] = 0;
  for (int k = 0; k < p; k++) {
    LAG_LANE *const solved = b->solved + k*b->inner;
    for (int i = 0; i < b->inner; i++) solved[i] = b->across[k*b->inner + i];
    lag_band_inner(b, solved);
    core->end[k] = core->deep[k] = (LAG_LANE)(p - 1);
    for (int j = 0; j < p; j++) {
      LAG_LANE *const s = &core->rows[j*width + k - j + p - 1];
      for (int i = 0; i < b->inner; i++) *s -= b->across[j*b->inner + i]*solved[i];
    }
  }
  return lag_band_factor(core);
}

/* y := residual of the right-hand side (f, g) for the solution x, 0 if NULL, scaled and in the order of places. */
static void lag_band_rest(int n, const lag_band *b, const LAG_LANE *M, const LAG_LANE *A, const LAG_LANE *side,
                          const LAG_LANE *x, LAG_LANE *y) {
  int i, j;
  for (int k = 0; k < b->all; k++) y[(int)b->place[k]] = side[k] - (x && k < n ? M[k*n + k]*x[k] : 0);
  for (int e = 0; e < b->edges && x; e++) {
    const LAG_LANE a = lag_element(n, b, e, M, A, &i, &j);
    y[(int)b->place[i]] -= a*x[j];
    y[(int)b->place[j]] -= i < n ? a*x[i] : -a*x[i];
  }
  for (int k = 0; k < b->all; k++) y[(int)b->place[k]] *= b->scale[k];
}

/* Solves the system of lag_kkt if its band fits into w[room] and its condition is at most 1e10 (each constraint has a
 * part of some 1e-5 of its own, so neither rank nor least norm is in question), with one step of refinement, two where
 * the condition is above 1e8. x and l hold f and g. Returns whether it has solved the system; M and A stay. */
static int lag_banded(int n, int m, const LAG_LANE *M, const LAG_LANE *A, const lag_entries *of, LAG_LANE *x,
                      LAG_LANE *l, LAG_LANE *w, int room) {
  const int all = n + m;
  lag_band b = {all, 0, 0, all, w, w + LAG_BAND_EDGES*all, 0, 0, 0, 0, 0, 0, 0, 0, of->row, 0, 0, 0}, core = b;
  b.next = b.first + all + 1, b.order = b.next + 2 * LAG_BAND_EDGES * all, b.place = b.order + all,
  b.scale = b.place + all, b.pivot = b.scale + all;
  LAG_LANE *const side = b.pivot + all, *const y = side + all, *const z = y + all;
  b.end = z + all, b.deep = b.end + all;
  b.rows = b.deep + all;
  if (b.rows - w > room || !lag_edges(n, m, M, A, of, &b)) return 0;
  lag_places(&b);
  const int border = all - b.inner;
  if (3*b.half + 1 + 2*border + 3*border > (room - (int)(b.rows - w))/all) return 0;
  b.across = b.rows + b.inner*(3*b.half + 1), b.solved = b.across + border*b.inner;
  lag_band_fill(n, &b, M, A);
  if (!lag_band_factor(&b)) return 0;
  if (border && !lag_band_core(&b, &core, b.solved + border*b.inner, y, z)) return 0;
  const LAG_LANE inverse = lag_band_inverse(&b, y, z);
  if (!(inverse <= (LAG_LANE)1e10)) return 0;
  for (int i = 0; i < all; i++) side[i] = i < n ? x[i] : l[i - n], z[i] = 0;
  for (int turn = 0; turn < (inverse > (LAG_LANE)1e8 ? 3 : 2); turn++) {
    lag_band_rest(n, &b, M, A, side, turn ? z : 0, y);
    lag_band_solve(&b, y);
    /* the symmetric system is that of (x, -l) */
    for (int i = 0; i < all; i++) z[i] += (i < n ? 1 : -1)*b.scale[i]*y[(int)b.place[i]];
  }
  for (int i = 0; i < all; i++) *(i < n ? x + i : l + i - n) = z[i];
  return 1;
}

#endif

/* ---- end ---- */
#endif
