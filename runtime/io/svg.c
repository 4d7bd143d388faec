/* SVG plots. Enters: a table; leaves: an SVG file with one panel for each unit over a common time axis, or one panel with
 * columns against others. Holds: a curve with more points than pixels is reduced to minimum and maximum of each pixel column,
 * so that no peak is lost; points of a path are at least a third of a pixel apart. */
#include <errno.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/io.h"
#include "io/visible.h"

enum { WIDTH = 860, LEFT = 84, RIGHT = 150, TOP = 50, GAP = 26, BOTTOM = 52, MOST_PANELS = 6, MOST_LEGEND = 24, MOST_NAME = 48, LINE = 18 };

/* Eight colours distinct for all kinds of colour vision (Okabe and Ito), yellow darkened. */
static const char *const colour[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8a7f00", "#444444"};

/* text[n] := stroke attributes of series k: the second eight series are dashed, the third dotted. */
static void stroke_of(int k, char *text, size_t n) {
  static const char *const dashes[] = {"", " stroke-dasharray=\"5 3\"", " stroke-dasharray=\"1.5 2.5\""};
  snprintf(text, n, "stroke=\"%s\"%s", colour[k % 8], dashes[k / 8 % 3]);
}

typedef struct Panel {
  double x, y, w, h;         /* rectangle in pixels */
  double x0, x1, y0, y1;     /* ranges of the data */
  const char *xlabel;
} Panel;

double lag_tick_step(double lo, double hi, int n) {
  double raw = (hi - lo) / n, power = pow(10, floor(log10(raw))), f = raw / power;
  return power * (f < 1.5 ? 1 : f < 3.5 ? 2 : f < 7.5 ? 5 : 10);
}

void lag_write_markup(FILE *f, const char *s) {
  static const char special[] = "<>&\"", *const entity[] = {"&lt;", "&gt;", "&amp;", "&quot;"};
  char shown[VISIBLE_SIZE];
  for (size_t n = strlen(s), at = 0; at < n;) {
    at += show_visible(s + at, n - at, shown);
    for (const char *c = shown; *c; c++) {
      const char *which = strchr(special, *c);
      if (which) fputs(entity[which - special], f);
      else putc(*c, f);
    }
  }
}

static void text(FILE *f, double x, double y, const char *attributes, const char *s) {
  fprintf(f, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes);
  lag_write_markup(f, s);
  fputs("</text>\n", f);
}

void lag_widen_range(double *lo, double *hi, double least, double margin) {
  if (!(*lo <= *hi)) {
    *lo = 0;
    *hi = 1;
  }
  double d = *hi - *lo;
  if (d <= least * fmax(fabs(*lo), fabs(*hi)) || d == 0.0) {
    d = *lo == 0.0 ? 1 : fabs(*lo);
    margin = 0.5;
  }
  *lo -= margin * d;
  *hi += margin * d;
}

static double px(const Panel *p, double x) { return p->x + (x - p->x0) / (p->x1 - p->x0) * p->w; }

static double py(const Panel *p, double y) { return p->y + p->h - (y - p->y0) / (p->y1 - p->y0) * p->h; }

static void tick_label(char *s, size_t n, double value, double step) { snprintf(s, n, "%.6g", fabs(value) < 1e-9 * step ? 0.0 : value); }

/* Number of x ticks per label, so that long labels (-3.086e+07) do not overlap. */
static double label_stride(const Panel *p, double dx) {
  enum { WIDTH_OF_CHARACTER = 7, ROOM = 10 };
  size_t longest = 0;
  char s[32];
  for (double k = ceil(p->x0 / dx - 1e-9); k * dx <= p->x1 + 1e-9 * dx; k++) {
    tick_label(s, sizeof s, k * dx, dx);
    if (strlen(s) > longest) longest = strlen(s);
  }
  return ceil(((double)longest * WIDTH_OF_CHARACTER + ROOM) / (px(p, dx) - px(p, 0)));
}

static void axes(FILE *f, const Panel *p, const char *ylabel, int last) {
  char s[32];
  double dx = lag_tick_step(p->x0, p->x1, 8), dy = lag_tick_step(p->y0, p->y1, p->h > 220 ? 7 : 4), size = fmax(fabs(p->y0), fabs(p->y1));
  double base = size > 1e5 * dy ? nearbyint((p->y0 + p->y1) / 2 / dy) * dy : 0; /* left out of labels that would be equal otherwise */
  double stride = label_stride(p, dx);
  fprintf(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#fff\" stroke=\"#999\"/>\n", p->x, p->y, p->w, p->h);
  for (double k = ceil(p->x0 / dx - 1e-9); k * dx <= p->x1 + 1e-9 * dx; k++) {
    fprintf(f, "<path d=\"M%.2f %.1fv%.1f\" class=\"g\"/>\n", px(p, k * dx), p->y, p->h);
    tick_label(s, sizeof s, k * dx, dx);
    if (last && fmod(k, stride) == 0.0) text(f, px(p, k * dx), p->y + p->h + 17, "text-anchor=\"middle\"", s);
  }
  for (double k = ceil((p->y0 - base) / dy - 1e-9); k * dy <= p->y1 - base + 1e-9 * dy; k++) {
    double y = py(p, base + k * dy);
    fprintf(f, "<path d=\"M%.1f %.2fh%.1f\" class=\"g\"/>\n", p->x, y, p->w);
    tick_label(s, sizeof s, k * dy, dy);
    text(f, p->x - 7, y + 4, "text-anchor=\"end\"", s);
  }
  if (base != 0.0) {
    snprintf(s, sizeof s, "%.14g +", base);
    text(f, p->x, p->y - 6, "font-size=\"11\"", s);
  }
  if (last) text(f, p->x + p->w / 2, p->y + p->h + 40, "text-anchor=\"middle\" class=\"l\"", p->xlabel);
  fprintf(f, "<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\" class=\"l\">", 18.0, p->y + p->h / 2);
  lag_write_markup(f, ylabel);
  fputs("</text>\n", f);
}

/* Adds a point to an SVG path: "M" at the start of a piece, "L" within; a value that is not finite ends the piece. */
static void point(FILE *f, const Panel *p, double x, double y, int *pen) {
  if (!isfinite(x) || !isfinite(y)) {
    *pen = 0;
    return;
  }
  fprintf(f, "%s%.2f %.2f", *pen ? "L" : "M", px(p, x), py(p, y));
  *pen = 1;
}

/* Dots, as zero-length strokes with round ends in one element; smaller where there are many. */
static void dots(FILE *f, const Panel *p, const Table *t, int xcol, int ycol, const char *stroke) {
  double width = t->nrows > 2000 ? 2 : t->nrows > 300 ? 2.6 : 4;
  fprintf(f, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\" stroke-linecap=\"round\" d=\"", stroke, width);
  for (size_t i = 0; i < t->nrows; i++) {
    double x = lag_table_cell(t, i, xcol), y = lag_table_cell(t, i, ycol);
    if (isfinite(x) && isfinite(y)) fprintf(f, "M%.2f %.2fh0", px(p, x), py(p, y));
  }
  fputs("\"/>\n", f);
}

/* A curve against time: minimum and maximum of each pixel column. */
static void min_max_curve(FILE *f, const Panel *p, const Table *t, int ycol) {
  size_t per = t->nrows / (size_t)(2 * p->w);
  int pen = 0;
  for (size_t i = 0; i < t->nrows; i += per + 1) {
    size_t lo = i, hi = i, end = i + per + 1 < t->nrows ? i + per + 1 : t->nrows;
    for (size_t j = i + 1; j < end; j++) {
      lo = lag_table_cell(t, j, ycol) < lag_table_cell(t, lo, ycol) ? j : lo;
      hi = lag_table_cell(t, j, ycol) > lag_table_cell(t, hi, ycol) ? j : hi;
    }
    size_t first = lo < hi ? lo : hi, second = lo < hi ? hi : lo;
    point(f, p, lag_table_cell(t, first, 0), lag_table_cell(t, first, ycol), &pen);
    if (second != first) point(f, p, lag_table_cell(t, second, 0), lag_table_cell(t, second, ycol), &pen);
  }
}

/* One column against another, or few rows: a path without the points that are nearer than a third of a pixel to the one drawn last. */
static void path(FILE *f, const Panel *p, const Table *t, int xcol, int ycol) {
  const double near = 0.3;
  double drawn_x = 0, drawn_y = 0;
  int pen = 0;
  for (size_t i = 0; i < t->nrows; i++) {
    double x = lag_table_cell(t, i, xcol), y = lag_table_cell(t, i, ycol);
    if (pen && hypot(px(p, x) - drawn_x, py(p, y) - drawn_y) < near) continue;
    point(f, p, x, y, &pen);
    drawn_x = px(p, x);
    drawn_y = py(p, y);
  }
}

static void one_curve(FILE *f, const Panel *p, const Table *t, int xcol, int ycol, const char *stroke) {
  fprintf(f, "<path fill=\"none\" %s stroke-width=\"1.6\" stroke-linejoin=\"round\" d=\"", stroke);
  if (xcol == 0 && t->nrows > (size_t)(2 * p->w)) min_max_curve(f, p, t, ycol);
  else path(f, p, t, xcol, ycol);
  fputs("\"/>\n", f);
}

/* In grey past the horizon; points of a section stay, since the whole of them may still hold. */
static void curve(FILE *f, const Panel *p, const Table *t, int xcol, int ycol, int k) {
  char stroke[64];
  if (t->points) {
    dots(f, p, t, xcol, ycol, colour[k % 8]);
    return;
  }
  stroke_of(k, stroke, sizeof stroke);
  Table part = *t;
  if (t->certain) {
    part.data += (t->certain - 1) * (size_t)t->ncols;
    part.nrows -= t->certain - 1;
    one_curve(f, p, &part, xcol, ycol, "stroke=\"#bbb\"");
    part = *t;
    part.nrows = t->certain;
  }
  one_curve(f, p, &part, xcol, ycol, stroke);
}

/* The horizon in a panel over time. */
static void put_horizon(FILE *f, const Panel *p, const Table *t, int named) {
  if (!t->certain || t->points) return;
  double x = px(p, t->horizon);
  fprintf(f, "<path d=\"M%.1f %.1fv%.1f\" stroke=\"#888\" stroke-dasharray=\"2 4\"/>\n", x, p->y, p->h);
  if (named) text(f, x, p->y - 6, "font-size=\"11\" text-anchor=\"middle\" fill=\"#666\"", "no digit is left");
}

/* s[n] := `from`, shortened to at most `most` characters with "..." at the end. */
static void truncate_text(const char *from, int most, char *s, size_t n) {
  int chars = 0;
  size_t i = 0;
  for (; from[i] && i + 4 < n; i++) {
    int begins = ((unsigned char)from[i] & 0xC0) != 0x80;
    if (begins && chars == most - 3 && strlen(from + i) > 3) {
      memcpy(s + i, "...", 4);
      return;
    }
    chars += begins;
    s[i] = from[i];
  }
  s[i] = '\0';
}

/* s[n] := "name [unit]" for `room` pixels; a long name is shortened, the unit is not. */
static void label_of(const char *name, const char *unit, double room, char *s, size_t n) {
  const double width_of_character = 8;
  char short_name[96];
  truncate_text(name, (int)(room / width_of_character) - (int)strlen(unit) - 3, short_name, sizeof short_name);
  snprintf(s, n, unit[0] ? "%s [%s]" : "%s", short_name, unit);
}

/* Line i of a legend for `total` series; the last that fits beside the panel may say "and N more". */
static void legend(FILE *f, const Panel *p, int i, int total, int k, const char *name) {
  char s[160], stroke[64];
  int room = p->h < LINE * MOST_LEGEND ? (int)(p->h / LINE) : MOST_LEGEND;
  double y = p->y + 12 + LINE * i, x = p->x + p->w + 14;
  if (i + 1 < room || (i + 1 == room && total == room)) {
    truncate_text(name, MOST_NAME, s, sizeof s);
    stroke_of(k, stroke, sizeof stroke);
    fprintf(f, "<path d=\"M%.1f %.1fh20\" %s stroke-width=\"2.5\"/>\n", x, y, stroke);
    text(f, x + 27, y + 4, "", s);
  } else if (i + 1 == room) {
    snprintf(s, sizeof s, "and %d more", total - i);
    text(f, x, y + 4, "", s);
  }
}

static void mark(FILE *f, double x, double y, const char *fill) {
  if (isfinite(x) && isfinite(y)) fprintf(f, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"4\" fill=\"%s\"/>\n", x, y, fill);
}

/* The series of one unit against time, or all against their columns where it is NULL, with their legend. */
static void draw_series(FILE *f, const Panel *p, const Table *t, const PlottedCurves *d, const char *unit) {
  int shown = 0, total = 0;
  for (int i = 0; i < d->n; i++) total += !unit || strcmp(t->cols[d->y[i]].unit, unit) == 0;
  for (int i = 0; i < d->n; i++) {
    int x = unit ? 0 : d->x[i], y = d->y[i];
    if (unit && strcmp(t->cols[y].unit, unit) != 0) continue;
    curve(f, p, t, x, y, i);
    if (unit || total > 1) legend(f, p, shown++, total, i, t->cols[y].name);
  }
}

/* Width of the legend right of the panels, in pixels. */
static int legend_width(const Table *t, const PlottedCurves *d) {
  enum { KEY = 41, CHARACTER = 8 };
  int most = (RIGHT - KEY) / CHARACTER;
  char s[sizeof t->cols->name];

  for (int i = 0; i < d->n; i++) {
    truncate_text(t->cols[d->y[i]].name, MOST_NAME, s, sizeof s);
    most = (int)strlen(s) > most ? (int)strlen(s) : most;
  }
  return KEY + CHARACTER * most;
}

static void head(FILE *f, int width, int height, const char *title) {
  fprintf(f,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" role=\"img\" "
          "font-family=\"DejaVu Sans, Helvetica, sans-serif\" font-size=\"12\" fill=\"#333\">\n<title>",
          width, height, width, height);
  lag_write_markup(f, title);
  fprintf(f,
          "</title>\n<style>.g{stroke:#e4e4e4;stroke-width:1;fill:none}.l{font-size:13px}</style>\n"
          "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
          width, height);
  text(f, LEFT, 26, "font-size=\"15\" font-weight=\"bold\"", title);
}

/* units := distinct units of the drawn columns, in order of first use, at most MOST_PANELS. Returns their number. */
static int units_of(const Table *t, const PlottedCurves *d, const char *units[MOST_PANELS]) {
  int n = 0;
  for (int i = 0; i < d->n; i++) {
    const char *unit = t->cols[d->y[i]].unit;
    int k = 0;
    while (k < n && strcmp(units[k], unit) != 0) k++;
    if (k == n && n < MOST_PANELS) units[n++] = unit;
  }
  return n;
}

static void against_time(FILE *f, const Table *t, const char *title, const PlottedCurves *d) {
  const char *units[MOST_PANELS];
  char xlabel[176];
  int n = units_of(t, d, units);
  double h = n == 1 ? 380 : n == 2 ? 230 : 170;
  Panel p = {.x = LEFT, .y = TOP, .w = WIDTH - LEFT - RIGHT, .h = h, .x0 = HUGE_VAL, .x1 = -HUGE_VAL, .xlabel = xlabel};
  label_of(t->cols[0].name, t->cols[0].unit, p.w, xlabel, sizeof xlabel);
  head(f, LEFT + (int)p.w + legend_width(t, d), TOP + (int)h * n + GAP * (n - 1) + BOTTOM, title);
  lag_table_range(t, 0, &p.x0, &p.x1);
  lag_widen_range(&p.x0, &p.x1, 1e-12, 0);
  for (int k = 0; k < n; k++) {
    char s[sizeof t->cols->unit + 3];
    p.y0 = HUGE_VAL;
    p.y1 = -HUGE_VAL;
    for (int i = 0; i < d->n; i++)
      if (strcmp(t->cols[d->y[i]].unit, units[k]) == 0) lag_table_range(t, d->y[i], &p.y0, &p.y1);
    lag_widen_range(&p.y0, &p.y1, 1e-12, 0.06);
    snprintf(s, sizeof s, "[%s]", units[k]);
    axes(f, &p, units[k][0] ? s : "", k == n - 1);
    draw_series(f, &p, t, d, units[k]);
    put_horizon(f, &p, t, k == 0);
    p.y += h + GAP;
  }
}

/* Equal scales for both axes: sets the height of the panel, within limits, and widens the ranges. */
static void same_scale(Panel *p) {
  double flat = (p->y1 - p->y0) / (p->x1 - p->x0) * p->w;
  p->h = flat < 200 ? 200 : flat < p->h ? flat : p->h;
  double scale = fmax((p->x1 - p->x0) / p->w, (p->y1 - p->y0) / p->h), mx = (p->x0 + p->x1) / 2, my = (p->y0 + p->y1) / 2;
  p->x0 = mx - scale * p->w / 2;
  p->x1 = mx + scale * p->w / 2;
  p->y0 = my - scale * p->h / 2;
  p->y1 = my + scale * p->h / 2;
}

/* Whether a column is the rate of another: its name is x' or (x)' for x. */
static int is_rate(const char *rate, const char *of) {
  size_t n = strlen(of);
  rate += rate[0] == '(' && of[0] != '(';
  return strncmp(rate, of, n) == 0 && (strcmp(rate + n, "'") == 0 || strcmp(rate + n, ")'") == 0);
}

/* Whether both axes get the same scale: columns of one unit, neither the rate of the other; without units only if their ranges are of
 * similar size. */
static int shares_scale(const Table *t, int x, int y, const Panel *p) {
  const Column *a = &t->cols[x], *b = &t->cols[y];
  double ratio = (p->x1 - p->x0) / (p->y1 - p->y0);
  if (strcmp(a->unit, b->unit) != 0 || is_rate(a->name, b->name) || is_rate(b->name, a->name)) return 0;
  return a->unit[0] || (ratio > 1. / 4 && ratio < 4);
}

/* Marks start and end of a path; only for one column against another. */
static void mark_ends(FILE *f, const Panel *p, const Table *t, int x, int y) {
  static const char *const name[] = {"start", "end"}, *const fill[] = {"#009e73", "#d55e00"};
  for (int k = 0; k < 2 && t->nrows; k++) {
    size_t row = k ? t->nrows - 1 : 0;
    mark(f, px(p, lag_table_cell(t, row, x)), py(p, lag_table_cell(t, row, y)), fill[k]);
    mark(f, p->x + p->w + 20, p->y + 16 + 20 * k, fill[k]);
    text(f, p->x + p->w + 32, p->y + 20 + 20 * k, "", name[k]);
  }
}

/* Label of an axis: name of its column, or `name` for several, with the first unit among them. */
static void axis_label(const Table *t, int n, const int *cols, const char *name, double room, char *s, size_t size) {
  const char *unit = "";
  for (int i = n; i-- > 0;) unit = t->cols[cols[i]].unit[0] ? t->cols[cols[i]].unit : unit;
  label_of(n == 1 ? t->cols[cols[0]].name : name, unit, room, s, size);
}

static void paths(FILE *f, const Table *t, const char *title, const PlottedCurves *d) {
  char xlabel[176], ylabel[176];
  int x = d->x[0];
  Panel p = {.x = LEFT, .y = TOP, .w = x ? 600 : WIDTH - LEFT - 30, .h = x ? 520 : 380, .xlabel = xlabel,
             .x0 = HUGE_VAL, .x1 = -HUGE_VAL, .y0 = HUGE_VAL, .y1 = -HUGE_VAL};
  for (int i = 0; i < d->n; i++) {
    lag_table_range(t, d->x[i], &p.x0, &p.x1);
    lag_table_range(t, d->y[i], &p.y0, &p.y1);
  }
  lag_widen_range(&p.x0, &p.x1, 1e-12, x ? 0.05 : 0);
  lag_widen_range(&p.y0, &p.y1, 1e-12, 0.05);
  if (x && shares_scale(t, d->x[d->n - 1], d->y[d->n - 1], &p)) same_scale(&p);
  axis_label(t, d->n, d->x, d->xname, p.w, xlabel, sizeof xlabel);
  axis_label(t, d->n, d->y, d->yname, p.h + 40, ylabel, sizeof ylabel);
  head(f, d->n > 1 ? LEFT + (int)p.w + legend_width(t, d) : WIDTH, TOP + (int)p.h + BOTTOM, title);
  axes(f, &p, ylabel, 1);
  draw_series(f, &p, t, d, NULL);
  if (!x) put_horizon(f, &p, t, 1);
  if (x && !t->points && d->n == 1) mark_ends(f, &p, t, x, d->y[0]);
}

int lag_svg_write(const char *path, const Table *t, const char *title, const PlottedCurves *d) {
  Outfile o;
  if (lag_outfile_open(&o, path)) return -1;
  if (!d->yname || (d->n > 1 && d->x[0] == 0)) against_time(o.f, t, title, d);
  else paths(o.f, t, title, d);
  fputs("</svg>\n", o.f);
  return lag_outfile_close(&o, OUTFILE_KEEP);
}
