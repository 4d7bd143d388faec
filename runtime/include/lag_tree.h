/* lag_tree.h: sums of 1/r over all pairs of bodies, far ones by the cells of a tree. Includes lag_lanes.h.
 *
 * J. Barnes & P. Hut, Nature 324 (1986) 446, doi:10.1038/324446a0. Cells are halved across their longest side. A cell
 * that looks smaller than the opening angle from all bodies of a group counts by its charge, dipole and quadrupole; all
 * bodies of a group share one list of cells (J. E. Barnes, J. Comput. Phys. 87 (1990) 161,
 * doi:10.1016/0021-9991(90)90232-P). The opening angle 0 opens all cells: then the sum is the direct one, in another
 * order. */
#ifndef LAG_TREE_H
#define LAG_TREE_H

#include "lag_lanes.h"

/* ---- tree: front ---- */
#define LAG_TREE_GROUP 16
#define LAG_TREE_NODES(n) ((n)/2 + 64) /* where there are no more, cells keep many bodies */
#define LAG_TREE_NUMBERS(n) (8*(n) + 24*LAG_TREE_NODES(n))
#define LAG_TREE_INTS(n) ((n) + (3 + 3*LAG_MOST_SHARES)*LAG_TREE_NODES(n))
#define LAG_TREE_SHARED 2000 /* bodies from which threads share the groups */

/* Bodies first .. end - 1 in the tree's order, in a box. center, charge, dipole, quadrupole xx yy zz xy xz yz; weight:
 * of the |charges|; size2, far2: squares of the longest side, and of the largest distance from center in the box. */
typedef struct {
  double center[3], charge, dipole[3], quadrupole[6], low[3], high[3], weight, size2, far2;
} lag_tree_cell;

/* In: n bodies, component c of place k is q[first[c] + step*k]. Out: of sum number `energy` and, for place k, slope[c]
 * + by*k; -1: not wanted. */
typedef struct {
  int n, parts, step, first[3], energy, slope[3], by, cells;
  double factor, soft, theta;
  double *body, *field;  /* [4n] places and charges; potential and its derivatives: in the tree's order */
  lag_tree_cell *cell;
  int *order, *begin, *end, *child, *lists; /* child: the first of two; 0: none. lists: of each thread that shares */
} lag_tree;

/* In memory of its own: numbers[LAG_TREE_NUMBERS(n)], ints[LAG_TREE_INTS(n)]. */
LAG_UNUSED static void lag_tree_open(lag_tree *w, int n, double *numbers, int *ints) {
  const int cells = LAG_TREE_NODES(n);
  w->n = n, w->body = numbers, w->field = numbers + 4*(long)n;
  w->cell = (lag_tree_cell *)(void *)(numbers + 8*(long)n);
  w->order = ints, w->begin = ints + n, w->end = w->begin + cells, w->child = w->end + cells;
  w->lists = w->child + cells;
}

LAG_UNUSED static void lag_tree_sum(lag_tree *w, const LAG_REAL *q, const LAG_REAL *charge, const LAG_REAL *numbers,
                                    LAG_REAL *sum);

/* ---- tree ---- */
/* The box of the bodies of a cell. */
LAG_UNUSED static void lag_tree_box(lag_tree *w, int k) {
  lag_tree_cell *x = &w->cell[k];
  const double *y = w->body + 4*(long)w->begin[k];
  double side = 0;
  for (int c = 0; c < 3; c++) x->low[c] = x->high[c] = y[c];
  for (int b = w->begin[k]; b < w->end[k]; b++, y += 4)
    for (int c = 0; c < 3; c++) {
      x->low[c] = y[c] < x->low[c] ? y[c] : x->low[c];
      x->high[c] = y[c] > x->high[c] ? y[c] : x->high[c];
    }
  for (int c = 0; c < 3; c++) side = x->high[c] - x->low[c] > side ? x->high[c] - x->low[c] : side;
  x->size2 = side*side;
}

LAG_UNUSED static void lag_tree_exchange(lag_tree *w, int a, int b) {
  double *x = w->body + 4*(long)a, *y = w->body + 4*(long)b;
  const int was = w->order[a];
  w->order[a] = w->order[b], w->order[b] = was;
  for (int c = 0; c < 4; c++) {
    const double here = x[c];
    x[c] = y[c], y[c] = here;
  }
}

/* Bodies of a cell on the lower side of the middle of its longest side come first; returns where the others begin. */
LAG_UNUSED static int lag_tree_part(lag_tree *w, int k) {
  const lag_tree_cell *x = &w->cell[k];
  int c = 0, a = w->begin[k], b = w->end[k];
  for (int d = 1; d < 3; d++) c = x->high[d] - x->low[d] > x->high[c] - x->low[c] ? d : c;
  const double middle = 0.5*x->low[c] + 0.5*x->high[c];
  while (a < b)
    if (w->body[4*(long)a + c] < middle) a++;
    else lag_tree_exchange(w, a, --b);
  return a;
}

/* Cells, each before its two parts. */
LAG_UNUSED static void lag_tree_divide(lag_tree *w) {
  w->cells = 1, w->begin[0] = 0, w->end[0] = w->n;
  for (int k = 0; k < w->cells; k++) {
    w->child[k] = 0;
    lag_tree_box(w, k);
    if (w->end[k] - w->begin[k] <= LAG_TREE_GROUP || w->cells + 2 > LAG_TREE_NODES(w->n)) continue;
    const int middle = lag_tree_part(w, k);
    if (middle == w->begin[k] || middle == w->end[k]) continue; /* all at one place, or no numbers */
    w->child[k] = w->cells;
    w->begin[w->cells] = w->begin[k], w->end[w->cells++] = middle;
    w->begin[w->cells] = middle, w->end[w->cells++] = w->end[k];
  }
}

/* Adds a part with these moments at a place. */
LAG_UNUSED static void lag_tree_moment(lag_tree_cell *x, const double *at, double charge, const double *p,
                                       const double *s) {
  const double a = at[0] - x->center[0], b = at[1] - x->center[1], c = at[2] - x->center[2];
  x->charge += charge;
  x->dipole[0] += p[0] + charge*a, x->dipole[1] += p[1] + charge*b, x->dipole[2] += p[2] + charge*c;
  x->quadrupole[0] += s[0] + (2*p[0] + charge*a)*a;
  x->quadrupole[1] += s[1] + (2*p[1] + charge*b)*b;
  x->quadrupole[2] += s[2] + (2*p[2] + charge*c)*c;
  x->quadrupole[3] += s[3] + p[0]*b + p[1]*a + charge*a*b;
  x->quadrupole[4] += s[4] + p[0]*c + p[2]*a + charge*a*c;
  x->quadrupole[5] += s[5] + p[1]*c + p[2]*b + charge*b*c;
}

/* The center of the |charges|. */
LAG_UNUSED static void lag_tree_center(lag_tree *w, int k) {
  lag_tree_cell *x = &w->cell[k];
  double sum[3] = {0, 0, 0};
  x->weight = 0;
  for (int b = w->begin[k]; b < w->end[k] && !w->child[k]; b++) {
    const double *y = w->body + 4*(long)b, size = y[3] < 0 ? -y[3] : y[3];
    x->weight += size;
    for (int c = 0; c < 3; c++) sum[c] += size*y[c];
  }
  for (int half = 0; half < 2 && w->child[k]; half++) {
    const lag_tree_cell *y = &w->cell[w->child[k] + half];
    x->weight += y->weight;
    for (int c = 0; c < 3; c++) sum[c] += y->weight*y->center[c];
  }
  x->far2 = 0;
  for (int c = 0; c < 3; c++) {
    const double at = x->weight > 0 ? sum[c]/x->weight : 0.5*x->low[c] + 0.5*x->high[c];
    const double below = at - x->low[c], above = x->high[c] - at, most = below > above ? below : above;
    x->center[c] = at;
    x->far2 += most*most;
  }
}

LAG_UNUSED static void lag_tree_moments(lag_tree *w) {
  static const double none[6] = {0, 0, 0, 0, 0, 0};
  for (int k = w->cells - 1; k >= 0; k--) {
    lag_tree_cell *x = &w->cell[k];
    lag_tree_center(w, k);
    x->charge = 0;
    for (int c = 0; c < 3; c++) x->dipole[c] = 0;
    for (int c = 0; c < 6; c++) x->quadrupole[c] = 0;
    for (int b = w->begin[k]; b < w->end[k] && !w->child[k]; b++) {
      const double *y = w->body + 4*(long)b;
      lag_tree_moment(x, y, y[3], none, none);
    }
    for (int half = 0; half < 2 && w->child[k]; half++) {
      const lag_tree_cell *y = &w->cell[w->child[k] + half];
      lag_tree_moment(x, y->center, y->charge, y->dipole, y->quadrupole);
    }
  }
}

/* Of a group: cells that count as one, and cells whose bodies count one by one. */
typedef struct {
  int *far, *near, *stack, nfar, nnear;
} lag_tree_lists;

LAG_UNUSED static void lag_tree_walk(const lag_tree *w, const lag_tree_cell *group, lag_tree_lists *of) {
  const double angle2 = w->theta*w->theta;
  int depth = 0;
  of->nfar = of->nnear = 0;
  of->stack[depth++] = 0;
  while (depth) {
    const int k = of->stack[--depth];
    const lag_tree_cell *x = &w->cell[k];
    double gap2 = 0;
    for (int c = 0; c < 3; c++) {
      const double below = group->low[c] - x->center[c], above = x->center[c] - group->high[c];
      const double gap = below > above ? below : above;
      gap2 += gap > 0 ? gap*gap : 0;
    }
    if (x->size2 < angle2*gap2 && x->far2 < gap2) of->far[of->nfar++] = k;
    else if (!w->child[k]) of->near[of->nnear++] = k;
    else of->stack[depth++] = w->child[k] + 1, of->stack[depth++] = w->child[k];
  }
}

/* A group: places of its bodies, and sums of the potential and its derivatives there. */
typedef struct {
  double x[LAG_TREE_GROUP], y[LAG_TREE_GROUP], z[LAG_TREE_GROUP];
  double v[LAG_TREE_GROUP], dx[LAG_TREE_GROUP], dy[LAG_TREE_GROUP], dz[LAG_TREE_GROUP];
} lag_tree_group;

/* Differences to a place, and u = 1/sqrt(d^2 + soft). */
typedef struct {
  double a[LAG_TREE_GROUP], b[LAG_TREE_GROUP], c[LAG_TREE_GROUP], u[LAG_TREE_GROUP];
} lag_tree_gap;

LAG_UNUSED static void lag_tree_gaps(const lag_tree_group *g, const double *at, double soft, int self,
                                     lag_tree_gap *d) {
  const double x = at[0], y = at[1], z = at[2];
  for (int k = 0; k < LAG_TREE_GROUP; k++) {
    d->a[k] = g->x[k] - x, d->b[k] = g->y[k] - y, d->c[k] = g->z[k] - z;
    d->u[k] = d->a[k]*d->a[k] + d->b[k]*d->b[k] + d->c[k]*d->c[k] + soft;
  }
  if (self >= 0) d->u[self] = INFINITY;
  for (int k = 0; k < LAG_TREE_GROUP; k++) d->u[k] = sqrt(d->u[k]);
  for (int k = 0; k < LAG_TREE_GROUP; k++) d->u[k] = 1.0/d->u[k];
}

/* Adds a body; self: its place in the group, or -1. */
LAG_UNUSED static void lag_tree_add_body(lag_tree_group *g, const double *body, double soft, int self) {
  lag_tree_gap d;
  lag_tree_gaps(g, body, soft, self, &d);
  const double charge = body[3];
  for (int k = 0; k < LAG_TREE_GROUP; k++) {
    const double v = charge*d.u[k], slope = v*(d.u[k]*d.u[k]);
    g->v[k] += v;
    g->dx[k] -= slope*d.a[k], g->dy[k] -= slope*d.b[k], g->dz[k] -= slope*d.c[k];
  }
}

/* Adds a cell: with u = 1/sqrt(d^2 + soft), Q u + u^3 d.p + (3 u^5 d.S d - u^3 tr S)/2. */
LAG_UNUSED static void lag_tree_add_cell(lag_tree_group *g, const lag_tree_cell *x, double soft) {
  const double *p = x->dipole, *s = x->quadrupole, trace = s[0] + s[1] + s[2];
  lag_tree_gap d;
  lag_tree_gaps(g, x->center, soft, -1, &d);
  for (int k = 0; k < LAG_TREE_GROUP; k++) {
    const double a = d.a[k], b = d.b[k], c = d.c[k], u = d.u[k], u2 = u*u, u3 = u*u2, u5 = u3*u2;
    const double sa = s[0]*a + s[3]*b + s[4]*c, sb = s[3]*a + s[1]*b + s[5]*c, sc = s[4]*a + s[5]*b + s[2]*c;
    const double dp = p[0]*a + p[1]*b + p[2]*c, ds = a*sa + b*sb + c*sc;
    const double radial = u3*x->charge + u5*(3.0*dp - 1.5*trace + 7.5*(ds*u2));
    g->v[k] += x->charge*u + u3*(dp - 0.5*trace) + 1.5*u5*ds;
    g->dx[k] += u3*p[0] + 3.0*u5*sa - radial*a;
    g->dy[k] += u3*p[1] + 3.0*u5*sb - radial*b;
    g->dz[k] += u3*p[2] + 3.0*u5*sc - radial*c;
  }
}

/* The field at the bodies of cell k, by a thread. */
LAG_UNUSED static void lag_tree_group_field(const lag_tree *w, int k, int thread) {
  const int first = w->begin[k], n = w->end[k] - first, cells = LAG_TREE_NODES(w->n);
  lag_tree_group g = {{0}, {0}, {0}, {0}, {0}, {0}, {0}};
  lag_tree_lists of = {w->lists + 3*(long)cells*thread, 0, 0, 0, 0};
  of.near = of.far + cells, of.stack = of.near + cells;
  lag_tree_walk(w, &w->cell[k], &of);
  for (int from = 0; from < n; from += LAG_TREE_GROUP) {
    const int to = n - from < LAG_TREE_GROUP ? n - from : LAG_TREE_GROUP;
    const double *y = w->body + 4*(long)(first + from);
    double *field = w->field + 4*(long)(first + from);
    for (int b = 0; b < LAG_TREE_GROUP; b++) {
      const int at = b < to ? b : 0;
      g.x[b] = y[4*at], g.y[b] = y[4*at + 1], g.z[b] = y[4*at + 2];
      g.v[b] = g.dx[b] = g.dy[b] = g.dz[b] = 0;
    }
    for (int c = 0; c < of.nfar; c++) lag_tree_add_cell(&g, &w->cell[of.far[c]], w->soft);
    for (int c = 0; c < of.nnear; c++)
      for (int b = w->begin[of.near[c]]; b < w->end[of.near[c]]; b++) {
        const int self = b - first - from;
        lag_tree_add_body(&g, w->body + 4*(long)b, w->soft, self >= 0 && self < to ? self : -1);
      }
    for (int b = 0; b < to; b++)
      field[4*b] = g.v[b], field[4*b + 1] = g.dx[b], field[4*b + 2] = g.dy[b], field[4*b + 3] = g.dz[b];
  }
}

/* The field at all bodies. */
LAG_UNUSED static void lag_tree_fields(lag_tree *w) {
  lag_tree_divide(w);
  lag_tree_moments(w);
#ifdef LAG_OPENMP
#pragma omp parallel for schedule(dynamic, 8) num_threads(LAG_SHARES) if(w->n >= LAG_TREE_SHARED)
  for (int k = 0; k < w->cells; k++)
    if (!w->child[k]) lag_tree_group_field(w, k, omp_get_thread_num());
#else
  for (int k = 0; k < w->cells; k++)
    if (!w->child[k]) lag_tree_group_field(w, k, 0);
#endif
}

#ifdef LAG_LANES
#define LAG_TREE_LANES LAG_LANES
#define LAG_TREE_LANE(x) ((x)[lane])
#else
#define LAG_TREE_LANES 1
#define LAG_TREE_LANE(x) (x)
#endif

/* sum[...] += factor times the sum over pairs of charge[i]*charge[j]/sqrt(d^2 + soft), and its derivatives by places;
 * numbers: factor, soft, opening angle. */
LAG_UNUSED static void lag_tree_sum(lag_tree *w, const LAG_REAL *q, const LAG_REAL *charge, const LAG_REAL *numbers,
                                    LAG_REAL *sum) {
  for (int lane = 0; lane < LAG_TREE_LANES; lane++) {
    double energy = 0;
    const double factor = (double)LAG_TREE_LANE(numbers[0]);
    w->soft = (double)LAG_TREE_LANE(numbers[1]), w->theta = (double)LAG_TREE_LANE(numbers[2]);
    for (int k = 0; k < w->n; k++) {
      double *y = w->body + 4*(long)k;
      for (int c = 0; c < 3; c++) y[c] = c < w->parts ? (double)LAG_TREE_LANE(q[w->first[c] + w->step*k]) : 0;
      y[3] = (double)LAG_TREE_LANE(charge[k]);
      w->order[k] = k;
    }
    lag_tree_fields(w);
    for (int k = 0; k < w->n; k++) {
      const double size = w->body[4*(long)k + 3], *field = w->field + 4*(long)k;
      energy += size*field[0];
      for (int c = 0; c < w->parts; c++)
        if (w->slope[c] >= 0)
          LAG_TREE_LANE(sum[w->slope[c] + w->by*w->order[k]]) += (LAG_LANE)(factor*size*field[1 + c]);
    }
    if (w->energy >= 0) LAG_TREE_LANE(sum[w->energy]) += (LAG_LANE)(0.5*factor*energy);
  }
}

/* ---- end ---- */
#endif
