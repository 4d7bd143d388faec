/* Histograms: how many rows of a table lie in each part of the range of a column, one panel per column below each
 * other. Holds: parts are equally wide, the largest value belongs to the last; values that are not finite are left
 * out, and said. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg_panel.h"

enum { BARS_WIDTH = 626, BARS_HEIGHT = 240, APART = 56 };

/* Counts the finite values of a column between lo and hi in count[parts]. Returns the largest count. */
static long long count_values(const Table *t, int col, double lo, double hi, int parts, long long *count) {
  long long most = 0;
  memset(count, 0, (size_t)parts * sizeof *count);
  for (size_t i = 0; i < t->nrows; i++) {
    double x = lag_table_cell(t, i, col);
    if (!isfinite(x)) continue;
    int k = (int)fmin(floor((x - lo) / (hi - lo) * parts), parts - 1);
    if (++count[k] > most) most = count[k];
  }
  return most;
}

static size_t without_value(const Table *t, int col) {
  size_t n = 0;
  for (size_t i = 0; i < t->nrows; i++)
    if (!isfinite(lag_table_cell(t, i, col))) n++;
  return n;
}

static void draw_bars(FILE *f, const Panel *p, double lo, double hi, int parts, const long long *count) {
  for (int k = 0; k < parts; k++) {
    double a = lag_panel_x(p, lo + (hi - lo) * k / parts), b = lag_panel_x(p, lo + (hi - lo) * (k + 1) / parts),
           top = lag_panel_y(p, (double)count[k]);
    if (count[k])
      fprintf(f,
              "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"%s\" fill-opacity=\"0.75\" "
              "stroke=\"#fff\" stroke-width=\"0.5\"/>\n",
              a, top, b - a, p->y + p->h - top, lag_colour[0]);
  }
}

/* The panel of one column, from y on. */
static void draw_panel(FILE *f, const Table *t, int col, int parts, double y, long long *count) {
  double lo = HUGE_VAL, hi = -HUGE_VAL;
  char label[sizeof(Column) + 4], note[80];
  size_t left_out = without_value(t, col);
  lag_table_range(t, col, &lo, &hi);
  lag_widen_range(&lo, &hi, 1e-12, 0);
  Panel p = {.x = LEFT,
             .y = y, .w = BARS_WIDTH, .h = BARS_HEIGHT, .x0 = lo, .x1 = hi,
             .xlabel = lag_column_label(&t->cols[col], label, sizeof label)};
  p.y1 = 1.05 * (double)count_values(t, col, lo, hi, parts, count);
  if (!(p.y1 > 0)) p.y1 = 1;
  lag_svg_axes(f, &p, "runs", 1);
  draw_bars(f, &p, lo, hi, parts, count);
  if (!left_out) return;
  snprintf(note, sizeof note, "%zu of %zu runs have no value", left_out, t->nrows);
  lag_svg_text(f, LEFT + BARS_WIDTH, y - 6, "text-anchor=\"end\" fill=\"#666\"", note);
}

int lag_histograms_write(const Picture *p, const Table *t, int first, int parts) {
  int n = t->ncols - first;
  long long *count = malloc((size_t)parts * sizeof *count);
  if (!count) return -1;
  lag_svg_head(p, LEFT + BARS_WIDTH + 40, TOP + n * (BARS_HEIGHT + APART) + 10);
  for (int k = 0; k < n; k++) draw_panel(p->f, t, first + k, parts, TOP + k * (BARS_HEIGHT + APART), count);
  free(count);
  return 0;
}
