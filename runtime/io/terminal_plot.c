/* Plots in a terminal. Enters: a table; leaves: charts of braille dots (2 by 4 a character): the first columns
 * against time, or one column against another. Holds: rows of a curve are joined by lines, so that steep curves have
 * no gaps. */
#include <math.h>
#include <string.h>

#include "io/io.h"

enum { COLS = 70, MOST_ROWS = 24, CHART_ROWS = 16, MOST_CHARTS = 6 };

static const unsigned char dot[4][2] = {{0x01, 0x08}, {0x02, 0x10}, {0x04, 0x20}, {0x40, 0x80}};

typedef struct Chart {
  unsigned char cell[MOST_ROWS][COLS];
  int rows;
  double x0, x1, y0, y1;
} Chart;

static void plot(Chart *c, int x, int y) {
  if (x >= 0 && x < 2 * COLS && y >= 0 && y < 4 * c->rows) c->cell[y / 4][x / 2] |= dot[y % 4][x % 2];
}

static int to_x(const Chart *c, double x) { return (int)lrint((x - c->x0) / (c->x1 - c->x0) * (2 * COLS - 1)); }

static int to_y(const Chart *c, double y) { return (int)lrint((c->y1 - y) / (c->y1 - c->y0) * (4 * c->rows - 1)); }

static void line(Chart *c, int xa, int ya, int xb, int yb) {
  int dx = xb - xa, dy = yb - ya, ax = dx < 0 ? -dx : dx, ay = dy < 0 ? -dy : dy, n = ax > ay ? ax : ay;
  for (int i = 0; i <= n; i++) plot(c, xa + (n ? i * dx / n : 0), ya + (n ? i * dy / n : 0));
}

static void range(const Table *t, int col, double least, double *lo, double *hi) {
  *lo = HUGE_VAL;
  *hi = -HUGE_VAL;
  lag_table_range(t, col, lo, hi);
  lag_widen_range(lo, hi, least, 0);
}

static void draw(Chart *c, const Table *t, int col_x, int col) {
  int have = 0, xa = 0, ya = 0;
  for (size_t i = 0; i < t->nrows; i++) {
    double x = lag_table_cell(t, i, col_x), y = lag_table_cell(t, i, col);
    if (!isfinite(x) || !isfinite(y)) {
      have = 0;
      continue;
    }
    int xb = to_x(c, x), yb = to_y(c, y);
    line(c, have ? xa : xb, have ? ya : yb, xb, yb);
    have = !t->points;
    xa = xb;
    ya = yb;
  }
}

static void print_x_axis(FILE *f, const Chart *c, const Column *name) {
  char left[32], right[32], middle[200];
  snprintf(left, sizeof left, "%.5g", c->x0);
  snprintf(right, sizeof right, "%.5g", c->x1);
  lag_column_label(name, middle, sizeof middle);
  int gap = COLS - (int)strlen(left) - (int)strlen(right) - (int)strlen(middle), half = gap > 1 ? gap / 2 : 1;
  fprintf(f, "%13s%s%*s%s%*s%s\n", "", left, half, "", middle, gap > half ? gap - half : 1, "", right);
}

static void print_chart(FILE *f, const Chart *c, const Column *name) {
  char title[200];
  fprintf(f, "%s\n", lag_column_label(name, title, sizeof title));
  for (int r = 0; r < c->rows; r++) {
    if (r == 0 || r == c->rows - 1) {
      fprintf(f, "%11.4g \xe2\x94\xa4", r ? c->y0 : c->y1); /* U+2524 */
    } else {
      fprintf(f, "%11s \xe2\x94\x82", ""); /* U+2502 */
    }
    for (int x = 0; x < COLS; x++) {
      unsigned char b = c->cell[r][x]; /* U+2800 + b in UTF-8 */
      fprintf(f, "\xe2%c%c", 0xa0 | b >> 6, 0x80 | (b & 0x3f));
    }
    putc('\n', f);
  }
}

/* Equal scales for two axes of one unit, so that a circle looks round: widens the narrower range. Dots are taken as
 * square. */
static void same_scale(Chart *c) {
  double wide = (c->x1 - c->x0) / (2 * COLS), high = (c->y1 - c->y0) / (4 * c->rows);
  double more_x = wide < high ? (high - wide) * COLS : 0, more_y = high < wide ? (wide - high) * 2 * c->rows : 0;
  c->x0 -= more_x;
  c->x1 += more_x;
  c->y0 -= more_y;
  c->y1 += more_y;
}

static void path(FILE *f, const Table *t, int col_x, int col_y) {
  Chart c = {.rows = MOST_ROWS};
  range(t, col_x, 0, &c.x0, &c.x1);
  range(t, col_y, 0, &c.y0, &c.y1);
  if (strcmp(t->cols[col_x].unit, t->cols[col_y].unit) == 0) same_scale(&c);
  draw(&c, t, col_x, col_y);
  print_chart(f, &c, &t->cols[col_y]);
  print_x_axis(f, &c, &t->cols[col_x]);
}

static void against_time(FILE *f, const Table *t, const PlottedCurves *d, int n) {
  for (int k = 0; k < n; k++) {
    Chart c = {.rows = n == 1 ? CHART_ROWS : n <= 3 ? CHART_ROWS / 2 : 5};
    range(t, 0, 0, &c.x0, &c.x1);
    range(t, d->y[k], 1e-4, &c.y0, &c.y1); /* the labels of the axis have four digits */
    draw(&c, t, 0, d->y[k]);
    print_chart(f, &c, &t->cols[d->y[k]]);
    if (k == n - 1) print_x_axis(f, &c, &t->cols[0]);
  }
}

void lag_sketch_write(FILE *f, const Table *t, const PlottedCurves *d) {
  int n = d->n < MOST_CHARTS ? d->n : MOST_CHARTS;
  if (d->yname && (d->n == 1 || d->x[0] != 0)) {
    for (int k = 0; k < n; k++) path(f, t, d->x[k], d->y[k]);
  } else {
    against_time(f, t, d, n);
  }
  if (d->n > n) fprintf(f, "%13s(and %d more columns)\n", "", d->n - n);
}
