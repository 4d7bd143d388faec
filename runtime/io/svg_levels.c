/* Curves beneath those of a path: where a value over the panel is equal (level curves, by marching squares), or the
 * value along its middle line. Holds: levels lie such that curves about a minimum are as far from each other as
 * ellipses of equal steps; a saddle has a level of its own, darker, the separatrix. */
#include <math.h>
#include <stdlib.h>

#include "io/svg_panel.h"

enum { ACROSS = 121, DOWN = 105, LEVELS = 12, MOST_SADDLES = 4, FINE = 16 };

typedef struct Grid {
  const Panel *p;
  const Beneath *b;
  int closed;    /* 1: the left and the right side are the same */
  double *value; /* [DOWN][ACROSS], from the lowest y on */
} Grid;

static double at(const Grid *g, int i, int j) { return g->value[j * ACROSS + i]; }
static double grid_x(const Panel *p, double i) { return p->x0 + (p->x1 - p->x0) * i / (ACROSS - 1); }
static double grid_y(const Panel *p, double j) { return p->y0 + (p->y1 - p->y0) * j / (DOWN - 1); }

/* The eight neighbours of a point, in the order of a turn. */
static const int turn[8][2] = {{1, 0}, {1, 1}, {0, 1}, {-1, 1}, {-1, 0}, {-1, -1}, {0, -1}, {1, -1}};

/* The value at a neighbour. */
static double beside(const Grid *g, int i, int j) { return at(g, g->closed ? (i + ACROSS - 1) % (ACROSS - 1) : i, j); }

/* A saddle has neighbours above and below it in four sectors or more. */
static int is_saddle(const Grid *g, int i, int j) {
  int changes = 0;
  double here = at(g, i, j), before = beside(g, i + turn[7][0], j + turn[7][1]) - here;
  for (int k = 0; k < 8; k++) {
    double now = beside(g, i + turn[k][0], j + turn[k][1]) - here;
    if (!isfinite(now)) return 0;
    changes += now > 0 ? before <= 0 : before > 0;
    before = now;
  }
  return changes >= 4;
}

/* The value between the points of the grid. */
static double value_at(const Grid *g, double i, double j) {
  return g->b->value(g->b->of, grid_x(g->p, i), grid_y(g->p, j));
}

/* The value of the saddle beside a point: Newton's method with central differences. */
static double saddle_value(const Grid *g, double i, double j) {
  enum { ROUNDS = 6 };
  const double d = 0.25;
  double x = i, y = j;
  for (int k = 0; k < ROUNDS; k++) {
    double here = value_at(g, x, y), left = value_at(g, x - d, y), right = value_at(g, x + d, y),
           below = value_at(g, x, y - d), above = value_at(g, x, y + d);
    double xx = (left - 2 * here + right) / (d * d), yy = (below - 2 * here + above) / (d * d),
           gx = (right - left) / (2 * d), gy = (above - below) / (2 * d);
    double xy = (value_at(g, x + d, y + d) - value_at(g, x + d, y - d) - value_at(g, x - d, y + d) +
                 value_at(g, x - d, y - d)) /
                (4 * d * d);
    double det = xx * yy - xy * xy;
    x -= (yy * gx - xy * gy) / det;
    y -= (xx * gy - xy * gx) / det;
    if (!(det < 0 && fabs(x - i) <= 1 && fabs(y - j) <= 1)) return at(g, (int)i, (int)j);
  }
  return value_at(g, x, y);
}

/* level[MOST_SADDLES] := values of different saddles; range: that of all values. Returns their number. */
static int saddles(const Grid *g, double range, double *level) {
  int n = 0;
  for (int j = 1; j + 1 < DOWN; j++)
    for (int i = !g->closed; i + 1 < ACROSS; i++) {
      if (!is_saddle(g, i, j)) continue;
      double e = saddle_value(g, i, j);
      int known = n == MOST_SADDLES;
      for (int k = 0; k < n && !known; k++) known = fabs(level[k] - e) < 2e-3 * range;
      if (!known) level[n++] = e;
    }
  return n;
}

/* Corners of a square, in the order of a turn. */
static const int corner[5][2] = {{0, 0}, {1, 0}, {1, 1}, {0, 1}, {0, 0}};

/* The part of the way from a corner to the next at which the value is the level: regula falsi (Illinois). from, to:
 * what the values there are above it. */
static double crossing(const Grid *g, const double start[2], const double end[2], double level, double from,
                       double to) {
  enum { ROUNDS = 5 };
  double lo = 0, hi = 1, part = from / (from - to);
  for (int k = 0; k < ROUNDS; k++) {
    double here = value_at(g, start[0] + part * (end[0] - start[0]), start[1] + part * (end[1] - start[1])) - level;
    if (!isfinite(here) || here == 0) break;
    int beyond = (here > 0) == (to > 0);
    *(beyond ? &hi : &lo) = part;
    *(beyond ? &to : &from) = here;
    *(beyond ? &from : &to) /= 2;
    part = lo + (hi - lo) * from / (from - to);
  }
  return part;
}

/* The curve within a square of the grid; value: at its corners. */
static void curve_in_square(FILE *f, const Grid *g, double i, double j, double side, const double value[4],
                            double level) {
  double place[4][2];
  int n = 0;
  for (int k = 0; k < 4; k++) {
    const int *a = corner[k], *b = corner[k + 1];
    double from = value[k] - level, to = value[(k + 1) % 4] - level;
    if (!isfinite(from) || !isfinite(to)) return;
    if ((from > 0) == (to > 0)) continue;
    const double start[2] = {i + side * a[0], j + side * a[1]}, end[2] = {i + side * b[0], j + side * b[1]};
    double part = crossing(g, start, end, level, from, to);
    place[n][0] = lag_panel_x(g->p, grid_x(g->p, start[0] + part * (end[0] - start[0])));
    place[n++][1] = lag_panel_y(g->p, grid_y(g->p, start[1] + part * (end[1] - start[1])));
  }
  for (int k = 0; k + 1 < n; k += 2)
    fprintf(f, "M%.1f %.1fL%.1f %.1f", place[k][0], place[k][1], place[k + 1][0], place[k + 1][1]);
}

/* Whether a saddle lies within two squares of this one. */
static int is_near_saddle(const Grid *g, int i, int j) {
  for (int b = j - 1; b <= j + 2; b++)
    for (int a = i - 1; a <= i + 2; a++) {
      int inside = b > 0 && b + 1 < DOWN && (g->closed || (a > 0 && a + 1 < ACROSS));
      if (inside && is_saddle(g, g->closed ? (a + ACROSS - 1) % (ACROSS - 1) : a, b)) return 1;
    }
  return 0;
}

/* The curve within a square, in FINE*FINE parts: at a saddle straight lines over a whole square would bend a
 * crossing. */
static void fine_curve(FILE *f, const Grid *g, int i, int j, double level) {
  const double side = 1. / FINE;
  double value[4];
  for (int b = 0; b < FINE; b++)
    for (int a = 0; a < FINE; a++) {
      for (int k = 0; k < 4; k++) value[k] = value_at(g, i + side * (a + corner[k][0]), j + side * (b + corner[k][1]));
      curve_in_square(f, g, i + side * a, j + side * b, side, value, level);
    }
}

static void level_curve(FILE *f, const Grid *g, double level, int is_separatrix, const char *attributes) {
  fprintf(f, "<path class=\"level\" fill=\"none\" %s d=\"", attributes);
  for (int j = 0; j + 1 < DOWN; j++)
    for (int i = 0; i + 1 < ACROSS; i++) {
      const double value[4] = {at(g, i, j), at(g, i + 1, j), at(g, i + 1, j + 1), at(g, i, j + 1)};
      if (is_separatrix && is_near_saddle(g, i, j)) fine_curve(f, g, i, j, level);
      else curve_in_square(f, g, i, j, 1, value, level);
    }
  fputs("\"/>\n", f);
}

/* Returns the number of saddles. */
static int draw_levels(FILE *f, const Grid *g) {
  double least = HUGE_VAL, most = -HUGE_VAL, saddle[MOST_SADDLES];
  for (int k = 0; k < ACROSS * DOWN; k++) {
    if (!isfinite(g->value[k])) continue;
    least = fmin(least, g->value[k]);
    most = fmax(most, g->value[k]);
  }
  if (!(most > least)) return 0;
  for (int k = 1; k <= LEVELS; k++)
    level_curve(f, g, least + (most - least) * (k * k) / ((LEVELS + 1) * (LEVELS + 1)), 0,
                "stroke=\"#bbb\" stroke-width=\"0.8\"");
  int n = saddles(g, most - least, saddle);
  for (int k = 0; k < n; k++) level_curve(f, g, saddle[k], 1, "stroke=\"#666\" stroke-width=\"1.1\"");
  return n;
}

static void put_key(FILE *f, const Panel *p, int line, const char *stroke, const char *name) {
  double x = p->x + p->w + 14, y = p->y + p->h - 40 + 18 * line;
  fprintf(f, "<path d=\"M%.1f %.1fh20\" fill=\"none\" %s/>\n", x, y, stroke);
  lag_svg_text(f, x + 27, y + 4, "fill=\"#666\"", name);
}

/* The least value at height y. */
static double least_at(const Beneath *b, const Panel *p, double y) {
  double least = HUGE_VAL;
  for (int i = 0; i < ACROSS; i++) {
    double e = b->value(b->of, grid_x(p, i), y);
    if (isfinite(e)) least = fmin(least, e);
  }
  return least;
}

/* The lowest maximum of y = 0 over a period: the energy of a separatrix. */
static double lowest_maximum(const Beneath *b, const Panel *p) {
  double lowest = HUGE_VAL;
  for (int i = 0; i + 1 < ACROSS; i++) {
    double e[3];
    for (int k = 0; k < 3; k++) e[k] = b->value(b->of, grid_x(p, (i + k + ACROSS - 2) % (ACROSS - 1)), 0);
    if (e[1] > e[0] && e[1] >= e[2]) lowest = fmin(lowest, e[1]);
  }
  return lowest;
}

void lag_svg_levels_range(const Beneath *b, Panel *p) {
  enum { ROUNDS = 30 };
  const double wider = 1.25;
  double level = lowest_maximum(b, p), middle = (p->y0 + p->y1) / 2, half = p->y1 - middle;
  for (int k = 0; k < ROUNDS; k++, half *= wider) {
    if (least_at(b, p, middle + half) <= level || least_at(b, p, middle - half) <= level) continue;
    p->y0 = middle - half;
    p->y1 = middle + half;
    return;
  }
}

void lag_svg_levels(FILE *f, const Panel *p, const Beneath *b) {
  Grid g = {p, b, b->period > 0, malloc(ACROSS * DOWN * sizeof *g.value)};
  if (!g.value) return;
  for (int j = 0; j < DOWN; j++)
    for (int i = 0; i < ACROSS; i++) g.value[j * ACROSS + i] = b->value(b->of, grid_x(p, i), grid_y(p, j));
  int n = draw_levels(f, &g);
  free(g.value);
  put_key(f, p, 0, "stroke=\"#bbb\"", "equal energy");
  if (n) put_key(f, p, 1, "stroke=\"#666\"", "separatrix");
}

void lag_svg_profile_range(const Beneath *b, double x0, double x1, double *y0, double *y1) {
  double lowest = HUGE_VAL;
  for (int i = 0; i < ACROSS; i++) {
    double e = b->value(b->of, x0 + (x1 - x0) * i / (ACROSS - 1), 0);
    if (isfinite(e)) lowest = fmin(lowest, e);
  }
  *y0 = fmin(*y0, lowest);
  *y1 += (*y1 - *y0) / 2;
}

void lag_svg_profile(FILE *f, const Panel *p, const Beneath *b) {
  int pen = 0;
  fputs("<path class=\"level\" fill=\"none\" stroke=\"#666\" stroke-width=\"1.2\" d=\"", f);
  for (int i = 0; i <= 4 * (ACROSS - 1); i++) {
    double x = grid_x(p, i / 4.), e = b->value(b->of, x, 0);
    int inside = isfinite(e) && e >= p->y0 && e <= p->y1;
    if (inside) fprintf(f, "%s%.2f %.2f", pen ? "L" : "M", lag_panel_x(p, x), lag_panel_y(p, e));
    pen = inside;
  }
  fputs("\"/>\n", f);
  put_key(f, p, 1, "stroke=\"#666\"", "potential");
}
