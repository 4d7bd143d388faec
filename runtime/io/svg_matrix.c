/* A matrix of scatter plots: each of the last columns of a table over each of the first, and over the ones before
 * it. Holds: panels of a row share their y axis, those of a column their x axis. */
#include <math.h>

#include "io/svg_panel.h"

enum { GAP = 12, MOST_WIDTH = 1080, WIDEST = 300, MOST_POINTS = 5000 };

/* Whether row i is drawn, where `part` of all rows are: multiples of the golden ratio avoid the period of a grid. */
static int keeps(size_t i, double part) {
  double at = (double)i * 0.6180339887498948482;
  return part >= 1 || at - floor(at) < part;
}

static void dots(FILE *f, const Panel *p, const Table *t, int x, int y, double part) {
  double width = fmin(5, lag_dot_width(fmin(part, 1) * (double)t->nrows));
  fprintf(
      f, "<path fill=\"none\" stroke=\"%s\" stroke-opacity=\"0.6\" stroke-width=\"%.1f\" stroke-linecap=\"round\" d=\"",
      lag_colour[0], width);
  for (size_t i = 0; i < t->nrows; i++) {
    double a = lag_table_cell(t, i, x), b = lag_table_cell(t, i, y);
    if (keeps(i, part) && isfinite(a) && isfinite(b)) fprintf(f, "M%.1f %.1fh0", lag_panel_x(p, a), lag_panel_y(p, b));
  }
  fputs("\"/>\n", f);
}

static void range_of(const Table *t, int col, double *lo, double *hi) {
  *lo = HUGE_VAL;
  *hi = -HUGE_VAL;
  lag_table_range(t, col, lo, hi);
  lag_widen_range(lo, hi, 1e-12, 0.06);
}

void lag_matrix_write(const Picture *picture, const ScatterMatrix *m) {
  FILE *f = picture->f;
  const Table *t = m->table;
  int rows = t->ncols - m->first, columns = t->ncols - 1;
  double w = fmin(WIDEST, (double)(MOST_WIDTH - GAP * (columns - 1)) / columns), h = 0.8 * w,
         part = (double)MOST_POINTS / (double)t->nrows;
  char xlabel[sizeof(Column) + 4], ylabel[sizeof(Column) + 4], note[80];
  lag_svg_head(picture, LEFT + (int)((w + GAP) * columns) + 20, TOP + 20 + (int)((h + GAP) * rows) + BOTTOM);
  if (part < 1) {
    snprintf(note, sizeof note, "about %d of %zu runs, evenly chosen", MOST_POINTS, t->nrows);
    lag_svg_text(f, LEFT, TOP, "fill=\"#666\"", note);
  }
  for (int row = 0; row < rows; row++)
    for (int x = 0; x < m->first + row; x++) {
      /* a column begins below the measure that it shows, and reaches down */
      int y = m->first + row, last = row + 1 == rows;
      Panel p = {.x = LEFT + (w + GAP) * x,
                 .y = TOP + 20 + (h + GAP) * row, .w = w, .h = h, .xlog = x < m->first && m->log[x],
                 .xlabel = lag_column_label(&t->cols[x], xlabel, sizeof xlabel)};
      range_of(t, x, &p.x0, &p.x1);
      range_of(t, y, &p.y0, &p.y1);
      lag_svg_axes(f, &p, x ? NULL : lag_column_label(&t->cols[y], ylabel, sizeof ylabel), last);
      dots(f, &p, t, x, y, part);
    }
}
