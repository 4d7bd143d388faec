/* Pictures of --cost: what accuracy costs in time, on logarithmic axes. Enters: methods with their runs; leaves: an
 * SVG file, or lines for a terminal. Holds: at most one curve a family, told apart by marks and dashes as well as
 * colours; legible at 8 cm. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "app/cost.h"
#include "io/svg_panel.h"

/* ---- Curves */

typedef struct Curve {
  const CostMethod *m;
  int family, n;
  double x[LAG_COST_MOST_RUNS], y[LAG_COST_MOST_RUNS]; /* log10 of error and time, errors decreasing */
} Curve;

/* Runs of a method as long as their errors fall. */
static void take_curve(Curve *c, const CostMethod *m) {
  double least = HUGE_VAL;
  c->m = m;
  c->n = 0;
  for (int k = 0; k < m->nruns; k++) {
    const CostRun *r = &m->run[k];
    if (!(r->error < least) || !(r->time > 0)) continue;
    least = r->error;
    c->x[c->n] = log10(fmax(r->error, 1e-17));
    c->y[c->n++] = log10(r->time);
  }
}

/* all[LAG_COST_FAMILIES] := a curve for each family that has one. Returns their number. */
static int take_curves(const Cost *c, Curve *all) {
  int n = 0;
  for (int family = 0; family < LAG_COST_FAMILIES; family++) {
    const CostMethod *m = lag_cost_best_of_family(c, family);
    if (!m) continue;
    take_curve(&all[n], m);
    all[n].family = family;
    n += all[n].n > 0;
  }
  return n;
}

enum { PICTURE_WIDTH = 800, PICTURE_HEIGHT = 560, MARGIN = 92, NAMES = 240, HEAD = 52, FOOT = 70, SIZE = 20,
      LINE = 24 };

/* Whole powers of ten, as decimal logarithms; x0 is the largest error. */
static Panel panel_of(const Curve *all, int n) {
  Panel r = {.x = MARGIN, .y = HEAD, .w = PICTURE_WIDTH - MARGIN - NAMES, .h = PICTURE_HEIGHT - HEAD - FOOT,
             .xlog = 1, .ylog = 1, .xlabel = "error", .size = SIZE};
  if (n == 0) {
    r.x1 = -15;
    r.y0 = -6;
    return r;
  }
  r.x0 = r.y1 = -HUGE_VAL;
  r.x1 = r.y0 = HUGE_VAL;
  for (int i = 0; i < n; i++)
    for (int k = 0; k < all[i].n; k++) {
      r.x0 = fmax(r.x0, all[i].x[k]);
      r.x1 = fmin(r.x1, all[i].x[k]);
      r.y0 = fmin(r.y0, all[i].y[k]);
      r.y1 = fmax(r.y1, all[i].y[k]);
    }
  if (r.x1 < -12) r.x1 = -16; /* down to rounding */
  r.x0 = ceil(r.x0) + 0.0; /* no -0 */
  r.x1 = fmin(floor(r.x1), r.x0 - 1);
  r.y0 = floor(r.y0);
  r.y1 = fmax(ceil(r.y1), r.y0 + 1);
  return r;
}

/* ---- SVG */

/* Colours of Okabe and Ito, of different lightness; dashes tell them apart without colour. */
static const struct {
  const char *colour, *dash;
} styles[LAG_COST_FAMILIES] = {{"#d55e00", ""},        {"#0072b2", ""}, {"#009e73", "9 4"}, {"#cc79a7", "2 3"},
                               {"#8a7f00", "9 4 2 4"}, {"#444444", ""}, {"#56b4e9", "9 4"}, {"#000000", "2 3"}};

/* A vertical line at an error below which no curve means anything, with its name above it, on the side of `anchor`. */
static void put_floor(FILE *f, const Panel *r, double error, const char *name, const char *anchor) {
  double x = log10(error);
  if (!(x > r->x1 && x < r->x0)) return;
  fprintf(f, "<path d=\"M%.1f %dV%d\" stroke=\"#777\" stroke-width=\"2\" stroke-dasharray=\"3 5\"/>\n",
          lag_panel_x(r, x), HEAD - 16, PICTURE_HEIGHT - FOOT);
  fprintf(f, "<text x=\"%.1f\" y=\"%d\" text-anchor=\"%s\" font-size=\"15\" fill=\"#555\">%s</text>\n",
          lag_panel_x(r, x) + (anchor[0] == 'e' ? -5 : 5), HEAD - 6, anchor, name);
}

static int by_error(const void *a, const void *b) {
  const CostRun *x = *(const CostRun *const *)a, *y = *(const CostRun *const *)b;
  return (x->error < y->error) - (x->error > y->error);
}

/* A band from the front to twice its time, within the frame. */
static void put_front(FILE *f, const Panel *r, const Cost *c) {
  const CostRun *front[LAG_COST_MOST_RUNS * LAG_COST_FAMILIES];
  int n = 0;
  for (int i = 0; i < c->nmethods; i++)
    for (int k = 0; k < c->method[i].nruns; k++)
      if (c->method[i].run[k].best && n < LAG_COST_MOST_RUNS * LAG_COST_FAMILIES) front[n++] = &c->method[i].run[k];
  if (n < 2) return;
  qsort(front, (size_t)n, sizeof *front, by_error);
  fputs("<path fill=\"#f0c808\" fill-opacity=\"0.35\" stroke=\"none\" d=\"", f);
  for (int k = 0; k < 2 * n; k++) {
    const CostRun *run = front[k < n ? k : 2 * n - 1 - k];
    double x = log10(fmax(run->error, 1e-17)), y = log10(run->time) + (k < n ? 0 : log10(2));
    fprintf(f, "%s%.1f %.1f", k ? "L" : "M", lag_panel_x(r, fmax(r->x1, fmin(x, r->x0))),
            lag_panel_y(r, fmax(r->y0, fmin(y, r->y1))));
  }
  fputs("Z\"/>\n", f);
}

static void put_mark(FILE *f, int kind, double x, double y) {
  static const char *const shapes[LAG_COST_FAMILIES] = {"m-5 0a5 5 0 1 0 10 0a5 5 0 1 0 -10 0",
                                                        "m-5 -5h10v10h-10z", "m0 -6l6 10h-12z", "m0 -7l6 7l-6 7l-6 -7z",
                                                        "m0 6l6 -10h-12z", "m-5 -5l10 10m0 -10l-10 10",
                                                        "m-6 0h12m-6 -6v12",
                                                        "m-6 -3h12v6h-12z"};
  fprintf(f, "M%.1f %.1f%s", x, y, shapes[kind]);
}

static void put_curve(FILE *f, const Panel *r, const Curve *c) {
  const char *colour = styles[c->family].colour;
  fprintf(f, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"2.5\" stroke-linejoin=\"round\"", colour);
  if (styles[c->family].dash[0]) fprintf(f, " stroke-dasharray=\"%s\"", styles[c->family].dash);
  fputs(" d=\"", f);
  for (int k = 0; k < c->n; k++) fprintf(f, "%s%.1f %.1f", k ? "L" : "M", lag_panel_x(r, c->x[k]),
                                         lag_panel_y(r, c->y[k]));
  fprintf(f, "\"/>\n<path fill=\"%s\" stroke=\"%s\" stroke-width=\"2\" d=\"", colour, colour);
  for (int k = 0; k < c->n; k++) put_mark(f, c->family, lag_panel_x(r, c->x[k]), lag_panel_y(r, c->y[k]));
  fputs("\"/>\n", f);
}

/* A triangle under the middle of the curve whose slope is that of the observed order: time grows as
 * error^(-1/order). */
static void put_slope(FILE *f, const Panel *r, const Curve *c) {
  char order[16];
  int k = c->n / 2;
  if (isnan(c->m->order) || c->m->method->flags & LAG_METHOD_ADAPTIVE || c->n < 4) return;
  double x = c->x[k], y = c->y[k] - 0.12 * (r->y1 - r->y0) / 4, wide = 1.5;
  fprintf(f, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" d=\"M%.1f %.1fL%.1f %.1fV%.1fZ\"/>\n",
          styles[c->family].colour, lag_panel_x(r, x), lag_panel_y(r, y),
          lag_panel_x(r, x - wide), lag_panel_y(r, y + wide / c->m->order), lag_panel_y(r, y));
  snprintf(order, sizeof order, "%.1f", c->m->order);
  lag_svg_text(f, lag_panel_x(r, x - wide) + 4, lag_panel_y(r, y + wide / c->m->order / 2) + 5,
               "font-size=\"15\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\"", order);
}

static int by_height(const void *a, const void *b) {
  const Curve *x = *(const Curve *const *)a, *y = *(const Curve *const *)b;
  return (x->y[x->n - 1] < y->y[y->n - 1]) - (x->y[x->n - 1] > y->y[y->n - 1]);
}

/* Names right of the panel, each joined with the end of its curve, none over another. */
static void put_names(FILE *f, const Panel *r, const Curve *all, int n) {
  const Curve *sorted[LAG_COST_FAMILIES];
  double y[LAG_COST_FAMILIES];
  for (int i = 0; i < n; i++) sorted[i] = &all[i];
  qsort(sorted, (size_t)n, sizeof *sorted, by_height);
  for (int i = 0; i < n; i++) y[i] = fmax(lag_panel_y(r, sorted[i]->y[sorted[i]->n - 1]),
                                          i ? y[i - 1] + LINE : HEAD + 10);
  for (int i = n - 1, low = PICTURE_HEIGHT - FOOT - 4; i >= 0 && y[i] > low; i--, low -= LINE) y[i] = low;
  for (int i = 0; i < n; i++) {
    const Curve *c = sorted[i];
    char attributes[64];
    double right = r->x + r->w;
    fprintf(f, "<path fill=\"none\" stroke=\"%s\" stroke-opacity=\"0.5\" d=\"M%.1f %.1fL%.1f %.1fh8\"/>\n",
            styles[c->family].colour, lag_panel_x(r, c->x[c->n - 1]),
            lag_panel_y(r, c->y[c->n - 1]), right + 6, y[i]);
    snprintf(attributes, sizeof attributes, "fill=\"%s\"", styles[c->family].colour);
    lag_svg_text(f, right + 18, y[i] + 7, attributes, c->m->name);
  }
}

int lag_cost_put_picture(const Picture *picture, void *cost) {
  const Cost *c = cost;
  Curve *all = calloc(LAG_COST_FAMILIES, sizeof *all);
  FILE *f = picture->f;
  if (!all) return -1;
  int n = take_curves(c, all);
  Panel r = panel_of(all, n);
  lag_svg_large_head(picture, PICTURE_WIDTH, PICTURE_HEIGHT, SIZE);
  lag_svg_axes(f, &r, "processor time [s]", 1);
  put_floor(f, &r, DBL_EPSILON, "rounding", c->reference.uncertainty < DBL_EPSILON ? "end" : "start");
  put_floor(f, &r, c->reference.uncertainty, "reference", c->reference.uncertainty < DBL_EPSILON ? "start" : "end");
  put_front(f, &r, c);
  for (int i = 0; i < n; i++) put_curve(f, &r, &all[i]);
  for (int i = 0; i < n; i++) {
    int known = 0; /* one triangle for curves with the same slope */
    for (int k = 0; k < i; k++) known |= fabs(all[k].m->order - all[i].m->order) < 0.2;
    if (!known) put_slope(f, &r, &all[i]);
  }
  put_names(f, &r, all, n);
  fputs("<path fill=\"#f0c808\" fill-opacity=\"0.35\" d=\"M572 532h20v14h-20z\"/>\n<text x=\"598\" y=\"545\" "
        "font-size=\"15\">up to twice the least time</text>\n",
        f);
  free(all);
  return 0;
}

/* ---- In a terminal */

void lag_cost_sketch(FILE *f, const Cost *c) {
  enum { COLUMNS = 64, ROWS = 18 };
  char cell[ROWS][COLUMNS + 1];
  Curve *all = calloc(LAG_COST_FAMILIES, sizeof *all);
  int n = all ? take_curves(c, all) : 0;
  if (n) {
    Panel r = panel_of(all, n);
    for (int y = 0; y < ROWS; y++) snprintf(cell[y], sizeof cell[y], "%*s", COLUMNS, "");
    for (int i = n - 1; i >= 0; i--)
      for (int k = 0; k + 1 < all[i].n; k++)
        for (int part = 0; part <= COLUMNS; part++) {
          double s = (double)part / COLUMNS, x = all[i].x[k] + s * (all[i].x[k + 1] - all[i].x[k]),
                 y = all[i].y[k] + s * (all[i].y[k + 1] - all[i].y[k]);
          cell[lrint((r.y1 - y) / (r.y1 - r.y0) * (ROWS - 1))][lrint((r.x0 - x) / (r.x0 - r.x1) * (COLUMNS - 1))] =
              (char)('a' + i);
        }
    fputs("\nprocessor time [s] against error\n", f);
    for (int y = 0; y < ROWS; y++) {
      double power = r.y1 - y * (r.y1 - r.y0) / (ROWS - 1);
      int tick = fabs(power - nearbyint(power)) < 0.5 * (r.y1 - r.y0) / (ROWS - 1);
      if (tick) fprintf(f, "%8s%-4.0f|%s\n", "1e", nearbyint(power), cell[y]);
      else fprintf(f, "%12s|%s\n", "", cell[y]);
    }
    fprintf(f, "%12s+%.*s\n%13s1e%-*.0f1e%.0f\n%13s", "", COLUMNS,
            "----------------------------------------------------------------", "", COLUMNS - 6, r.x0, r.x1, "");
    for (int i = 0; i < n; i++) fprintf(f, "%s%c %s", i ? ", " : "", 'a' + i, all[i].m->name);
    putc('\n', f);
  }
  free(all);
}
