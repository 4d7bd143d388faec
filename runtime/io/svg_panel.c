/* Parts that all SVG pictures share (svg_panel.h): the head, panels with axes and ticks, text. */
#include "io/svg_panel.h"

#include <math.h>
#include <string.h>

#include "io/visible.h"

const char *const lag_colour[8] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                   "#e69f00", "#56b4e9", "#8a7f00", "#444444"};

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

void lag_svg_text(FILE *f, double x, double y, const char *attributes, const char *s) {
  fprintf(f, "<text x=\"%.1f\" y=\"%.1f\" %s>", x, y, attributes);
  lag_write_markup(f, s);
  fputs("</text>\n", f);
}

void lag_widen_log_range(double *lo, double *hi) {
  const double least = 0.35;
  double more = fmax(least - (*hi - *lo), 0) / 2;
  *lo -= more;
  *hi += more;
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

double lag_panel_x(const Panel *p, double x) { return p->x + (x - p->x0) / (p->x1 - p->x0) * p->w; }

double lag_panel_y(const Panel *p, double y) { return p->y + p->h - (y - p->y0) / (p->y1 - p->y0) * p->h; }

/* Pixels of a text of the panel's size, from those at size 14. */
static double sized(const Panel *p, double pixels) { return p->size ? pixels * p->size / 14 : pixels; }

static void tick_label(char *s, size_t n, double value, double step) {
  snprintf(s, n, "%.6g", fabs(value) < 1e-9 * step ? 0.0 : value);
}

/* Number of x ticks per label, so that long labels (-3.086e+07) do not overlap. */
static double label_stride(const Panel *p, double dx, double base) {
  enum { WIDTH_OF_CHARACTER = 9, ROOM = 10 };
  size_t longest = 0;
  char s[32];
  for (double k = ceil((p->x0 - base) / dx - 1e-9); k * dx <= p->x1 - base + 1e-9 * dx; k++) {
    tick_label(s, sizeof s, k * dx, dx);
    if (strlen(s) > longest) longest = strlen(s);
  }
  return ceil(((double)longest * WIDTH_OF_CHARACTER + ROOM) / (lag_panel_x(p, dx) - lag_panel_x(p, 0)));
}

/* Writes a label; 2*10^-3 with its exponent above the line. */
static void put_label(FILE *f, double x, double y, const char *attributes, const char *s) {
  const char *power = strstr(s, "10^");
  if (!power) lag_svg_text(f, x, y, attributes, s);
  else
    fprintf(f, "<text x=\"%.1f\" y=\"%.1f\" %s>%.*s%s10<tspan dy=\"-0.55em\" font-size=\"79%%\">%s</tspan></text>\n",
            x, y, attributes, (int)strcspn(s, "*1"), s, power > s ? "\302\267" : "", power + 3);
}

/* A line of the grid at x, and its label, if it has one. */
static void x_tick(FILE *f, const Panel *p, double x, const char *label) {
  fprintf(f, "<path d=\"M%.2f %.1fv%.1f\" class=\"g\"/>\n", lag_panel_x(p, x), p->y, p->h);
  if (*label) put_label(f, lag_panel_x(p, x), p->y + p->h + sized(p, 18), "text-anchor=\"middle\"", label);
}

static void y_tick(FILE *f, const Panel *p, double at, const char *label) {
  double y = lag_panel_y(p, at);
  fprintf(f, "<path d=\"M%.1f %.2fh%.1f\" class=\"g\"/>\n", p->x, y, p->w);
  if (*label) put_label(f, p->x - 6, y + sized(p, 5), "text-anchor=\"end\"", label);
}

double lag_dot_width(double rows) { return fmin(8, fmax(2, 40 / pow(rows, 0.4))); }

/* Left out of labels that would be equal otherwise. */
static double label_base(double lo, double hi, double step) {
  return fmax(fabs(lo), fabs(hi)) > 1e5 * step ? nearbyint((lo + hi) / 2 / step) * step : 0;
}

static void put_base(FILE *f, double x, double y, const char *anchor, double base) {
  char s[32], attributes[64];
  snprintf(s, sizeof s, "%.14g +", base);
  snprintf(attributes, sizeof attributes, "font-size=\"13\" text-anchor=\"%s\"", anchor);
  if (base != 0.0) lag_svg_text(f, x, y, attributes, s);
}

static void linear_x(FILE *f, const Panel *p, int labelled) {
  double dx = lag_tick_step(p->x0, p->x1, p->w < 400 ? 4 : 8), base = label_base(p->x0, p->x1, dx);
  double stride = label_stride(p, dx, base);
  for (double k = ceil((p->x0 - base) / dx - 1e-9); k * dx <= p->x1 - base + 1e-9 * dx; k++) {
    char s[32] = "";
    if (labelled && fmod(k, stride) == 0.0) tick_label(s, sizeof s, k * dx, dx);
    x_tick(f, p, base + k * dx, s);
  }
  if (labelled) put_base(f, p->x + p->w, p->y + p->h + 38, "end", base);
}

static void linear_y(FILE *f, const Panel *p, int labelled) {
  double dy = lag_tick_step(p->y0, p->y1, p->h > 220 ? 7 : 4), base = label_base(p->y0, p->y1, dy);
  char s[32] = "";
  for (double k = ceil((p->y0 - base) / dy - 1e-9); k * dy <= p->y1 - base + 1e-9 * dy; k++) {
    if (labelled) tick_label(s, sizeof s, k * dy, dy);
    y_tick(f, p, base + k * dy, s);
  }
  if (labelled) put_base(f, p->x, p->y - 6, "start", base);
}

/* Lines at powers of ten, and between where these are few; those from lo to hi, decimal logarithms. */
static void log_ticks(FILE *f, const Panel *p, double lo, double hi, int labelled,
                      void (*tick)(FILE *f, const Panel *p, double at, const char *label)) {
  static const int between[] = {1, 2, 5, 3, 4, 6, 7, 8, 9};
  double span = hi - lo, crowded = p->w < 400 ? 2 * span : span;
  int every = (int)(crowded / 8) + 1, parts = crowded > 4 ? 1 : 9, told = crowded > 2.5 ? 1 : crowded > 0.7 ? 3 : 9;
  for (int k = (int)floor(lo); k <= (int)floor(hi); k++)
    for (int i = 0; i < parts; i++) {
      double at = k + log10(between[i]);
      char s[32] = "";
      if (labelled && i == 0 && k % every == 0) snprintf(s, sizeof s, "10^%d", k);
      else if (labelled && i < told && k % every == 0) snprintf(s, sizeof s, "%d*10^%d", between[i], k);
      if (at >= lo - 1e-9 && at <= hi + 1e-9) tick(f, p, at, s);
    }
}

void lag_svg_axes(FILE *f, const Panel *p, const char *ylabel, int last) {
  char s[220];
  fprintf(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#fff\" stroke=\"#999\"/>\n", p->x, p->y,
          p->w, p->h);
  if (p->xlog) log_ticks(f, p, fmin(p->x0, p->x1), fmax(p->x0, p->x1), last, x_tick);
  else linear_x(f, p, last);
  if (p->ylog) log_ticks(f, p, p->y0, p->y1, ylabel != NULL, y_tick);
  else linear_y(f, p, ylabel != NULL);
  snprintf(s, sizeof s, "%s%s", last ? p->xlabel : "", p->xlog ? ", logarithmic" : "");
  if (last) lag_svg_text(f, p->x + p->w / 2, p->y + p->h + sized(p, 40), "text-anchor=\"middle\" class=\"l\"", s);
  if (!ylabel) return;
  fprintf(f, "<text transform=\"translate(%.1f %.1f) rotate(-90)\" text-anchor=\"middle\" class=\"l\">", sized(p, 18),
          p->y + p->h / 2);
  lag_write_markup(f, ylabel);
  fputs(p->ylog ? ", logarithmic</text>\n" : "</text>\n", f);
}

void lag_svg_large_head(const Picture *p, int width, int height, int size) {
  char attributes[64];
  FILE *f = p->f;
  fprintf(f,
          "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"%d\" height=\"%d\" viewBox=\"0 0 %d %d\" role=\"img\" "
          "font-family=\"DejaVu Sans, Helvetica, sans-serif\" font-size=\"%d\" fill=\"#333\">\n<title>",
          width, height, width, height, size);
  lag_write_markup(f, p->title);
  fprintf(f,
          "</title>\n<style>.g{stroke:#e4e4e4;stroke-width:1;fill:none}.l{font-size:%dpx}</style>\n"
          "<rect width=\"%d\" height=\"%d\" fill=\"#fff\"/>\n",
          size + 1, width, height);
  snprintf(attributes, sizeof attributes, "font-size=\"%d\" font-weight=\"bold\"", size < 17 ? 17 : size);
  lag_svg_text(f, LEFT, 26, attributes, p->title);
}

void lag_svg_head(const Picture *p, int width, int height) { lag_svg_large_head(p, width, height, 14); }
