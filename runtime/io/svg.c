/* SVG plots. Enters: a table; leaves: an SVG file with one panel for each unit over a common time axis, or one panel
 * with columns against others. Holds: a curve with more points than pixels is reduced to minimum and maximum of each
 * pixel column, so that no peak is lost; points of a path are at least a third of a pixel apart. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/io.h"
#include "io/svg_panel.h"

enum { GAP = 26, MOST_PANELS = 6, MOST_LEGEND = 24, MOST_NAME = 48, LINE = 18, MEMBER = 1024 };

/* text[n] := stroke attributes of series k: the second eight series are dashed, the third dotted; of a family's n
 * members, k = MEMBER*n + i, colours run from blue over violet to orange. */
static void stroke_of(int k, char *text, size_t n) {
  if (k < 0) { /* joined */
    snprintf(text, n, "stroke=\"#000\"%s", k < -1 ? " stroke-dasharray=\"5 3\"" : "");
    return;
  }
  static const char *const dashes[] = {"", " stroke-dasharray=\"5 3\"", " stroke-dasharray=\"1.5 2.5\""};
  static const int by_index[3][3] = {{0, 60, 160}, {170, 50, 150}, {235, 150, 20}};
  if (k < MEMBER) {
    snprintf(text, n, "stroke=\"%s\"%s", lag_colour[k % 8], dashes[k / 8 % 3]);
    return;
  }
  double at = 2.0 * (k % MEMBER) / (k / MEMBER - 1), part = at < 1 ? at : at - 1;
  const int *from = by_index[at < 1 ? 0 : 1], *to = by_index[at < 1 ? 1 : 2];
  snprintf(text, n, "stroke=\"#%02x%02x%02x\"", (int)(from[0] + part * (to[0] - from[0])),
           (int)(from[1] + part * (to[1] - from[1])), (int)(from[2] + part * (to[2] - from[2])));
}

static int same_family(const char *a, const char *b) {
  size_t n = strcspn(a, "[");
  return a[n] == '[' && strncmp(a, b, n + 1) == 0;
}

/* Whether a column is in the panel of another (NULL: the only panel): of its unit; without units members of families
 * lie apart, since sums over them may be larger by orders. */
static int in_panel(const Column *c, const Column *of) {
  if (!of) return 1;
  return strcmp(c->unit, of->unit) == 0 && (of->unit[0] || !strchr(c->name, '[') == !strchr(of->name, '['));
}

/* The colour of series i, the k-th of its panel's `total`: by its index in a range of runs, or among three or more
 * members of a family x[1], x[2], ...; else by its run, or its place. */
static int series_stroke(const Table *t, const PlottedCurves *d, const Column *panel, int i, int k, int total) {
  const char *name = t->cols[d->y[i]].name;
  int n = 0, index = 0, joined = t->ncols - t->joined;
  if (d->y[i] >= joined) return -1 - (d->y[i] - joined);
  total -= t->joined;
  if (d->ordered && total > 2 && total < MEMBER) return MEMBER * total + k;
  for (int j = 0; j < d->n && !d->runs; j++)
    if (in_panel(&t->cols[d->y[j]], panel) && same_family(name, t->cols[d->y[j]].name)) {
      index += j < i;
      n++;
    }
  if (n > 2 && n < MEMBER) return MEMBER * n + index;
  if (panel && !panel->unit[0] && !d->runs) return k;
  return d->runs ? i % d->runs + 8 * (k / d->runs) : i;
}

/* Adds a point to an SVG path: "M" at the start of a piece, "L" within; a value that is not finite ends the piece. */
static void point(FILE *f, const Panel *p, double x, double y, int *pen) {
  if (!isfinite(x) || !isfinite(y)) {
    *pen = 0;
    return;
  }
  fprintf(f, "%s%.2f %.2f", *pen ? "L" : "M", lag_panel_x(p, x), lag_panel_y(p, y));
  *pen = 1;
}

/* Dots, as zero-length strokes with round ends in one element. */
static void dots(FILE *f, const Panel *p, const Table *t, int xcol, int ycol, double period, const char *stroke) {
  double width = lag_dot_width((double)t->nrows);
  fprintf(f, "<path fill=\"none\" %s stroke-width=\"%.1f\" stroke-linecap=\"round\" d=\"", stroke, width);
  for (size_t i = 0; i < t->nrows; i++) {
    double x = lag_table_cell(t, i, xcol), y = lag_table_cell(t, i, ycol);
    x -= period > 0 ? period * floor(x / period + 0.5) : 0;
    if (isfinite(x) && isfinite(y)) fprintf(f, "M%.2f %.2fh0", lag_panel_x(p, x), lag_panel_y(p, y));
  }
  fputs("\"/>\n", f);
}

/* A curve against time: of each pixel column the first, the least, the greatest and the last value, which draw what
 * all values would (U. Jugel, Z. Jerzak, G. Hackenbroich, V. Markl, M4, PVLDB 7, 2014, 797, DOI
 * 10.14778/2732951.2732953). A value that is not finite is a column of its own. */
static void curve_by_columns(FILE *f, const Panel *p, const Table *t, int ycol) {
  int pen = 0;
  for (size_t first = 0, end; first < t->nrows; first = end) {
    size_t at[4] = {first, first, first, first}; /* first, least, greatest, last */
    double column = floor(lag_panel_x(p, lag_table_cell(t, first, 0))), y = lag_table_cell(t, first, ycol);
    for (end = first + 1; end < t->nrows && isfinite(y); end++) {
      double next = lag_table_cell(t, end, ycol);
      if (!isfinite(next) || floor(lag_panel_x(p, lag_table_cell(t, end, 0))) != column) break;
      at[1] = next < lag_table_cell(t, at[1], ycol) ? end : at[1];
      at[2] = next > lag_table_cell(t, at[2], ycol) ? end : at[2];
      at[3] = end;
    }
    if (at[1] > at[2]) {
      size_t least = at[1];
      at[1] = at[2];
      at[2] = least;
    }
    for (int k = 0; k < 4; k++)
      if (k == 0 || at[k] != at[k - 1]) point(f, p, lag_table_cell(t, at[k], 0), lag_table_cell(t, at[k], ycol), &pen);
  }
}

/* Takes the path over an end of the panel, where x is periodic: *turns, those of the point before at (from, y0),
 * become those of (x, y). */
static void cross_over(FILE *f, const Panel *p, const double before[2], const double here[2], double *turns, int *pen) {
  double from = before[0], y0 = before[1], x = here[0], y = here[1];
  double way = x > from ? 1 : -1, period = p->x1 - p->x0, last = floor((x - p->x0) / period);
  for (; *pen && *turns != last; *turns += way) {
    double end = (way > 0 ? p->x1 : p->x0) + *turns * period, crossed = y0 + (y - y0) * (end - from) / (x - from);
    point(f, p, end - *turns * period, crossed, pen);
    *pen = 0;
    point(f, p, end - (*turns + way) * period, crossed, pen);
  }
  *turns = last;
}

/* One column against another, or few rows: a path without the points that are nearer than a third of a pixel to the
 * one drawn last. period: of x, or 0. */
static void path(FILE *f, const Panel *p, const Table *t, int xcol, int ycol, double period) {
  const double near = 0.3;
  double drawn_x = 0, drawn_y = 0, turns = 0, before[2];
  int pen = 0;
  for (size_t i = 0; i < t->nrows; i++) {
    double x = lag_table_cell(t, i, xcol), y = lag_table_cell(t, i, ycol);
    if (period > 0 && isfinite(x) && isfinite(y)) {
      before[0] = lag_table_cell(t, i - (i > 0), xcol);
      before[1] = lag_table_cell(t, i - (i > 0), ycol);
      cross_over(f, p, before, (const double[2]){x, y}, &turns, &pen);
      x -= turns * period;
    }
    if (pen && hypot(lag_panel_x(p, x) - drawn_x, lag_panel_y(p, y) - drawn_y) < near) continue;
    point(f, p, x, y, &pen);
    drawn_x = lag_panel_x(p, x);
    drawn_y = lag_panel_y(p, y);
  }
}

/* Number of times that the column turns back, by more than a pixel. */
static double turns_of(const Panel *p, const Table *t, int ycol) {
  double turns = 0, way = 0, farthest = NAN, pixel = (p->y1 - p->y0) / p->h;
  for (size_t i = 0; i < t->nrows; i++) {
    double y = lag_table_cell(t, i, ycol), back = way * (farthest - y);
    if (!isfinite(y)) continue;
    if (isnan(farthest)) farthest = y;
    else if (way == 0 && fabs(y - farthest) > pixel) way = y > farthest ? 1 : -1, farthest = y;
    else if (way != 0 && back > pixel) way = -way, farthest = y, turns++;
    else if (way * (y - farthest) > 0) farthest = y;
  }
  return turns;
}

/* The area between the least and the largest value of each part, with its edges; a part has a pixel or more, and four
 * turns of the curve. */
static void envelope(FILE *f, const Panel *p, const Table *t, int ycol, double turns, const char *stroke) {
  size_t per = (size_t)((double)t->nrows / fmin(p->w, turns / 4)) + 1, n = (t->nrows + per - 1) / per;
  fprintf(f, "<path %s stroke-width=\"1\" fill-opacity=\"0.25\" fill=\"%.7s\" d=\"", stroke,
          strchr(stroke, '#') ? strchr(stroke, '#') : "#000000");
  for (size_t k = 0, pen = 0; k < 2 * n; k++) {
    size_t from = (k < n ? k : 2 * n - 1 - k) * per, end = from + per < t->nrows ? from + per : t->nrows;
    double most = NAN, sign = k < n ? 1 : -1;
    for (size_t j = from; j < end; j++) most = fmax(most, sign * lag_table_cell(t, j, ycol));
    if (!isfinite(most)) continue;
    fprintf(f, "%s%.2f %.2f", pen ? "L" : "M", lag_panel_x(p, lag_table_cell(t, from, 0)), lag_panel_y(p, sign * most));
    pen = 1;
  }
  fputs("z\"/>\n", f);
}

static void one_curve(FILE *f, const Panel *p, const Table *t, int xcol, int ycol, double period, const char *stroke) {
  double turns = xcol == 0 ? turns_of(p, t, ycol) : 0;
  if (turns > 0.7 * p->w) { /* one cannot follow such a curve */
    envelope(f, p, t, ycol, turns, stroke);
    return;
  }
  fprintf(f, "<path fill=\"none\" %s stroke-width=\"1.6\" stroke-linejoin=\"round\" d=\"", stroke);
  if (xcol == 0 && t->nrows > (size_t)(2 * p->w)) curve_by_columns(f, p, t, ycol);
  else path(f, p, t, xcol, ycol, period);
  fputs("\"/>\n", f);
}

/* In grey past the horizon; points of a section stay, since the whole of them may still hold. */
static void curve(FILE *f, const Panel *p, const Table *t, int xcol, int ycol, double period, int k) {
  char stroke[64];
  stroke_of(t->points && k < MEMBER && k >= 0 ? k % 8 : k, stroke, sizeof stroke);
  if (t->points && k >= 0) {
    dots(f, p, t, xcol, ycol, period, stroke);
    return;
  }
  Table part = *t;
  if (t->certain) {
    part.data += (t->certain - 1) * (size_t)t->ncols;
    part.nrows -= t->certain - 1;
    one_curve(f, p, &part, xcol, ycol, period, "stroke=\"#bbb\"");
    part = *t;
    part.nrows = t->certain;
  }
  one_curve(f, p, &part, xcol, ycol, period, stroke);
}

/* The horizon in a panel over time. */
static void put_horizon(FILE *f, const Panel *p, const Table *t, int named) {
  if (!t->certain || t->points) return;
  double x = lag_panel_x(p, t->horizon);
  fprintf(f, "<path d=\"M%.1f %.1fv%.1f\" stroke=\"#888\" stroke-dasharray=\"2 4\"/>\n", x, p->y, p->h);
  if (named) lag_svg_text(f, x, p->y - 6, "font-size=\"13\" text-anchor=\"middle\" fill=\"#666\"", "no digit is left");
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
  const double width_of_character = 9;
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
    lag_svg_text(f, x + 27, y + 4, "", s);
  } else if (i + 1 == room) {
    snprintf(s, sizeof s, "and %d more", total - i);
    lag_svg_text(f, x, y + 4, "", s);
  }
}

static void mark(FILE *f, double x, double y, const char *fill) {
  if (isfinite(x) && isfinite(y)) fprintf(f, "<circle cx=\"%.2f\" cy=\"%.2f\" r=\"4\" fill=\"%s\"/>\n", x, y, fill);
}

/* The series of a column's panel against time, or all against their columns where it is NULL, with their legend. */
static void draw_series(FILE *f, const Panel *p, const Table *t, const PlottedCurves *d, const Column *panel) {
  enum { LISTED = 12, SOME = 8 };
  int shown = 0, total = 0, line = 0;
  for (int i = 0; i < d->n; i++) total += in_panel(&t->cols[d->y[i]], panel);
  for (int i = 0; i < d->n; i++) {
    int x = panel ? 0 : d->x[i], y = d->y[i];
    if (!in_panel(&t->cols[y], panel)) continue;
    int stroke = series_stroke(t, d, panel, i, shown, total);
    curve(f, p, t, x, y, d->beneath.period, stroke);
    int some = d->ordered && total > LISTED,
        told = !some || shown * SOME % (total - 1) < SOME; /* of many runs about SOME, the first and the last */
    if (told && (panel || total > 1)) legend(f, p, line++, some ? SOME + 1 : total, stroke, t->cols[y].name);
    shown++;
  }
}

/* Width of the legend right of the panels, in pixels. */
static int legend_width(const Table *t, const PlottedCurves *d) {
  enum { KEY = 41, CHARACTER = 9 };
  int most = (RIGHT - KEY) / CHARACTER;
  char s[sizeof t->cols->name];

  for (int i = 0; i < d->n; i++) {
    truncate_text(t->cols[d->y[i]].name, MOST_NAME, s, sizeof s);
    most = (int)strlen(s) > most ? (int)strlen(s) : most;
  }
  return KEY + CHARACTER * most;
}

/* first := the first drawn column of each panel, at most MOST_PANELS. Returns their number. */
static int panels_of(const Table *t, const PlottedCurves *d, const Column *first[MOST_PANELS]) {
  int n = 0;
  for (int i = 0; i < d->n; i++) {
    const Column *c = &t->cols[d->y[i]];
    int k = 0;
    while (k < n && !in_panel(c, first[k])) k++;
    if (k == n && n < MOST_PANELS) first[n++] = c;
  }
  return n;
}

/* s[n] := the name of a column without its run's label, and without the index of a member. Returns whether it had an
 * index. */
static int family_of(const Column *c, char *s, size_t n) {
  int length = c->plain > 0 ? c->plain : (int)strlen(c->name), open = (int)strcspn(c->name, "["),
      shut = open + (int)strcspn(c->name + open, "]"), indexed = shut < length;
  if (indexed) snprintf(s, n, "%.*s%.*s", open, c->name, length - shut - 1, c->name + shut + 1);
  else snprintf(s, n, "%.*s", length, c->name);
  return indexed;
}

/* s[n] := "x, y" of the drawn columns of a panel, without the runs' labels, as far as there is room; members of one
 * family, as u[1], u[2], are "u". */
static const char *names_of(const Table *t, const PlottedCurves *d, const Column *panel, char *s, size_t n) {
  char family[sizeof t->cols->name], last[sizeof t->cols->name] = "";
  size_t at = 0, before = 0;
  for (int i = 0; i < d->n && at + sizeof family + 3 < n; i += d->runs > 0 ? d->runs : 1) {
    const Column *c = &t->cols[d->y[i]];
    if (!in_panel(c, panel)) continue;
    int indexed = family_of(c, family, sizeof family), again = indexed && strcmp(family, last) == 0;
    if (again) at = before;
    before = at;
    at += (size_t)snprintf(s + at, n - at, "%s%.*s", at ? ", " : "", c->plain > 0 ? c->plain : (int)strlen(c->name),
                           again ? family : c->name);
    snprintf(last, sizeof last, "%s", indexed ? family : "");
  }
  return s;
}

static void against_time(const Picture *picture, const Table *t, const PlottedCurves *d) {
  FILE *f = picture->f;
  const Column *first[MOST_PANELS];
  char xlabel[176], names[300];
  int n = panels_of(t, d, first);
  double h = n == 1 ? 380 : n == 2 ? 230 : 170;
  Panel p = {.x = LEFT,
             .y = TOP, .w = WIDTH - LEFT - RIGHT, .h = h, .x0 = HUGE_VAL, .x1 = -HUGE_VAL, .xlog = d->xlog,
             .ylog = d->ylog,
             .xlabel = xlabel};
  label_of(t->cols[0].name, t->cols[0].unit, p.w, xlabel, sizeof xlabel);
  lag_svg_head(picture, LEFT + (int)p.w + legend_width(t, d), TOP + (int)h * n + GAP * (n - 1) + BOTTOM);
  lag_table_range(t, 0, &p.x0, &p.x1);
  lag_widen_range(&p.x0, &p.x1, 1e-12, 0);
  for (int k = 0; k < n; k++) {
    char s[176];
    p.y0 = HUGE_VAL;
    p.y1 = -HUGE_VAL;
    for (int i = 0; i < d->n; i++)
      if (in_panel(&t->cols[d->y[i]], first[k])) lag_table_range(t, d->y[i], &p.y0, &p.y1);
    lag_widen_range(&p.y0, &p.y1, 1e-12, 0.06);
    if (p.ylog) lag_widen_log_range(&p.y0, &p.y1);
    if (d->yname) label_of(d->yname, first[k]->unit, h + 40, s, sizeof s);
    else label_of(names_of(t, d, first[k], names, sizeof names), first[k]->unit, h + 40, s, sizeof s);
    lag_svg_axes(f, &p, s, k == n - 1);
    draw_series(f, &p, t, d, first[k]);
    put_horizon(f, &p, t, k == 0);
    p.y += h + GAP;
  }
}

/* Equal scales for both axes: sets the height of the panel, within limits, and widens the ranges. */
static void same_scale(Panel *p) {
  double flat = (p->y1 - p->y0) / (p->x1 - p->x0) * p->w;
  p->h = flat < 200 ? 200 : flat < p->h ? flat : p->h;
  double scale = fmax((p->x1 - p->x0) / p->w, (p->y1 - p->y0) / p->h), mx = (p->x0 + p->x1) / 2,
         my = (p->y0 + p->y1) / 2;
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

/* Whether both axes get the same scale: columns of one unit, neither the rate of the other; without units only if
 * their ranges are of similar size. */
static int shares_scale(const Table *t, const PlottedCurves *d, const Panel *p) {
  const Column *a = &t->cols[d->x[d->n - 1]], *b = &t->cols[d->y[d->n - 1]];
  double ratio = (p->x1 - p->x0) / (p->y1 - p->y0);
  if (strcmp(a->unit, b->unit) != 0 || is_rate(d->xname, d->yname) || is_rate(d->yname, d->xname)) return 0;
  return a->unit[0] || (ratio > 1. / 4 && ratio < 4);
}

/* Marks start and end of a path; only for one column against another. */
static void mark_ends(FILE *f, const Panel *p, const Table *t, int x, int y, double period) {
  static const char *const name[] = {"start", "end"}, *const fill[] = {"#009e73", "#d55e00"};
  for (int k = 0; k < 2 && t->nrows; k++) {
    size_t row = k ? t->nrows - 1 : 0;
    double turns = period > 0 ? floor(lag_table_cell(t, row, x) / period + 0.5) : 0;
    mark(f, lag_panel_x(p, lag_table_cell(t, row, x) - turns * period), lag_panel_y(p, lag_table_cell(t, row, y)),
         fill[k]);
    mark(f, p->x + p->w + 20, p->y + 16 + 20 * k, fill[k]);
    lag_svg_text(f, p->x + p->w + 32, p->y + 20 + 20 * k, "", name[k]);
  }
}

/* Label of an axis: name of its column, or `name` for several, with the first unit among them. */
static void axis_label(const Table *t, int n, const int *cols, const char *name, double room, char *s, size_t size) {
  const char *unit = "";
  for (int i = n; i-- > 0;) unit = t->cols[cols[i]].unit[0] ? t->cols[cols[i]].unit : unit;
  label_of(n == 1 ? t->cols[cols[0]].name : name, unit, room, s, size);
}

static void paths(const Picture *picture, const Table *t, const PlottedCurves *drawn) {
  FILE *f = picture->f;
  PlottedCurves copy = *drawn, *d = &copy;
  char xlabel[176], ylabel[176];
  int x = d->x[0];
  Panel p = {.x = LEFT,
             .y = TOP, .w = x ? 600 : WIDTH - LEFT - 30, .h = x ? 520 : 380, .ylog = d->ylog, .xlabel = xlabel,
             .x0 = HUGE_VAL, .x1 = -HUGE_VAL, .y0 = HUGE_VAL,
             .y1 = -HUGE_VAL};
  for (int i = 0; i < d->n; i++) {
    lag_table_range(t, d->x[i], &p.x0, &p.x1);
    lag_table_range(t, d->y[i], &p.y0, &p.y1);
  }
  if (d->beneath.profile && p.x1 - p.x0 < d->beneath.period / 2) d->beneath.period = 0; /* a small part of the circle */
  if (!d->beneath.value && !t->points && p.x1 - p.x0 <= d->beneath.period) d->beneath.period = 0; /* less than a turn */
  if (d->beneath.period > 0) p.x0 = -(p.x1 = d->beneath.period / 2);
  else lag_widen_range(&p.x0, &p.x1, 1e-12, d->beneath.value ? 0.25 : x ? 0.05 : 0);
  if (d->beneath.profile) lag_svg_profile_range(&d->beneath, p.x0, p.x1, &p.y0, &p.y1);
  lag_widen_range(&p.y0, &p.y1, 1e-12, d->beneath.value && !d->beneath.profile ? 0.25 : 0.05);
  if (d->beneath.value && !d->beneath.profile && d->beneath.period > 0) lag_svg_levels_range(&d->beneath, &p);
  if (p.ylog) lag_widen_log_range(&p.y0, &p.y1);
  if (x && !d->beneath.value && shares_scale(t, d, &p)) same_scale(&p);
  axis_label(t, d->n, d->x, d->xname, p.w, xlabel, sizeof xlabel);
  axis_label(t, d->n, d->y, d->yname, p.h + 40, ylabel, sizeof ylabel);
  int wide = LEFT + (int)p.w + legend_width(t, d);
  lag_svg_head(picture, d->n > 1 && wide > WIDTH ? wide : WIDTH, TOP + (int)p.h + BOTTOM);
  lag_svg_axes(f, &p, ylabel, 1);
  if (d->beneath.profile) lag_svg_profile(f, &p, &d->beneath);
  else if (d->beneath.value) lag_svg_levels(f, &p, &d->beneath);
  draw_series(f, &p, t, d, NULL);
  for (const PictureNote *note = d->note; note && note < d->note + d->nnotes; note++)
    lag_svg_text(f, lag_panel_x(&p, note->x), lag_panel_y(&p, note->y) + 4,
                 "font-size=\"13\" text-anchor=\"middle\" stroke=\"#fff\" stroke-width=\"3\" paint-order=\"stroke\"",
                 note->text);
  if (!x) put_horizon(f, &p, t, 1);
  if (x && t->certain && !t->points) {
    double at = p.x + p.w + 14, below = p.y + p.h - 8;
    fprintf(f, "<path d=\"M%.1f %.1fh20\" stroke=\"#bbb\" stroke-width=\"2.5\"/>\n", at, below);
    lag_svg_text(f, at + 27, below + 4, "", "no digit is left");
  }
  if (x && !t->points && d->n == 1 && !d->runs) mark_ends(f, &p, t, x, d->y[0], d->beneath.period);
}

void lag_svg_write(const Picture *p, const Table *t, const PlottedCurves *d) {
  if (!d->yname || (d->n > 1 && d->x[0] == 0)) against_time(p, t, d);
  else paths(p, t, d);
}
