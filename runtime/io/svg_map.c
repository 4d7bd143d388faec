/* Maps: a value over two others, as coloured cells with a bar; values that are few whole numbers are categories,
 * with a legend. Colours: the cube helix, whose lightness grows with the value, so that it also works in grey: D. A.
 * Green, Bull. Astron. Soc. India 39 (2011) 289. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg_panel.h"

enum { LEVELS = 64, SIDE = 512, BAR = 18, MOST_CATEGORIES = 8 };

typedef struct Scale {
  double least, most;
  int categories; /* 0: colours of LEVELS; else least, least + 1, ... */
  int sides;      /* 1: values of both signs: blue below 0, red above, white at 0, which is in the middle */
} Scale;

/* 1: all values are whole, and few. */
static Scale scale_of(const ValueMap *m) {
  const double least_side = 0.05; /* of the other: values a little beyond 0 are not of both signs */
  Scale s = {HUGE_VAL, -HUGE_VAL, 1, 0};
  for (size_t i = 0, n = (size_t)m->nx * (size_t)m->ny; i < n; i++) {
    if (!isfinite(m->value[i])) continue;
    s.least = fmin(s.least, m->value[i]);
    s.most = fmax(s.most, m->value[i]);
    if (m->value[i] != floor(m->value[i])) s.categories = 0;
  }
  s.categories = s.categories && s.most - s.least < MOST_CATEGORIES ? (int)(s.most - s.least) + 1 : 0;
  s.sides = !s.categories && fmin(-s.least, s.most) > least_side * fmax(-s.least, s.most);
  if (s.sides) s.least = -(s.most = fmax(-s.least, s.most));
  return s;
}

static void put_colour(FILE *f, const Scale *s, int level) {
  const double start = 0.5, turns = -1.5, dark = 0.08, light = 0.92, pi = 3.14159265358979323846;
  if (s->categories) {
    fputs(lag_colour[level], f);
    return;
  }
  if (s->sides) {
    static const int end[2][3] = {{33, 90, 172}, {178, 24, 43}};
    double part = 2 * (level + 0.5) / LEVELS - 1;
    putc('#', f);
    for (int k = 0; k < 3; k++) fprintf(f, "%02x", (int)(248 + (end[part > 0][k] - 248) * fabs(part)));
    return;
  }
  double lightness = dark + (light - dark) * level / (LEVELS - 1), angle = 2 * pi * (start / 3 + turns * lightness),
         amplitude = lightness * (1 - lightness) / 2;
  const double mix[3][2] = {{-0.14861, 1.78277}, {-0.29227, -0.90649}, {1.97294, 0}};
  putc('#', f);
  for (int k = 0; k < 3; k++)
    fprintf(
        f, "%02x",
        (int)(255 * fmin(fmax(lightness + amplitude * (mix[k][0] * cos(angle) + mix[k][1] * sin(angle)), 0), 1) + 0.5));
}

/* The level of a value; -1: it has none. */
static int level_of(const Scale *s, double value) {
  if (!isfinite(value)) return -1;
  if (s->categories) return (int)(value - s->least);
  double part = s->most > s->least ? (value - s->least) / (s->most - s->least) : 0.5;
  return (int)fmin(part * LEVELS, LEVELS - 1);
}

/* One path for all cells of a level: in units of a cell, from the upper left. */
static void put_cells(FILE *f, const ValueMap *m, const Scale *s, int level) {
  int any = 0;
  for (int row = 0; row < m->ny; row++)
    for (int col = 0, end; col < m->nx; col = end) {
      const double *line = m->value + (size_t)(m->ny - 1 - row) * (size_t)m->nx;
      for (end = col; end < m->nx && level_of(s, line[end]) == level; end++) continue;
      if (end == col) {
        end++;
        continue;
      }
      if (!any++) {
        fputs("<path fill=\"", f);
        put_colour(f, s, level);
        fputs("\" d=\"", f);
      }
      fprintf(f, "M%d %dh%dv1h%dz", col, row, end - col, col - end);
    }
  if (any) fputs("\"/>\n", f);
}

/* Edges of the cells at both ends. */
static void edges(int n, const double *centre, double *from, double *to) {
  double half = n > 1 ? 0.5 * (centre[n - 1] - centre[0]) / (n - 1) : 0.5;
  *from = centre[0] - half;
  *to = centre[n - 1] + half;
}

static void put_bar(FILE *f, const Panel *p, const Scale *s, const char *label) {
  double x = p->x + p->w + 24, step = lag_tick_step(s->least, s->most, 6);
  char number[32];
  Panel bar = {.x = x, .y = p->y, .w = BAR, .h = p->h, .y0 = s->least, .y1 = s->most};
  for (int k = 0; k < LEVELS; k++) {
    fprintf(f, "<rect x=\"%.1f\" y=\"%.2f\" width=\"%d\" height=\"%.2f\" fill=\"", x,
            p->y + p->h * (LEVELS - 1 - k) / LEVELS, BAR, p->h / LEVELS + 0.5);
    put_colour(f, s, k);
    fputs("\"/>\n", f);
  }
  for (double k = ceil(s->least / step - 1e-9); k * step <= s->most + 1e-9 * step && s->most > s->least; k++) {
    snprintf(number, sizeof number, "%.6g", fabs(k * step) < 1e-9 * step ? 0. : k * step);
    lag_svg_text(f, x + BAR + 6, lag_panel_y(&bar, k * step) + 4, "", number);
  }
  if (s->sides) fprintf(f, "<path d=\"M%.1f %.1fh%d\" stroke=\"#333\"/>\n", x - 3, lag_panel_y(&bar, 0), BAR + 6);
  lag_svg_text(f, x, p->y - 8, "class=\"l\"", label);
}

static void put_legend(FILE *f, const Panel *p, const Scale *s, const char *label) {
  double x = p->x + p->w + 24;
  char number[32];
  for (int k = 0; k < s->categories; k++) {
    fprintf(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"14\" height=\"14\" fill=\"%s\"/>\n", x, p->y + 22 * k,
            lag_colour[k]);
    snprintf(number, sizeof number, "%g", s->least + k);
    lag_svg_text(f, x + 22, p->y + 22 * k + 12, "", number);
  }
  lag_svg_text(f, x, p->y - 8, "class=\"l\"", label);
}

void lag_map_write(const Picture *picture, const ValueMap *m) {
  FILE *f = picture->f;
  Scale s = scale_of(m);
  Panel p = {.x = LEFT, .y = TOP + 20, .w = SIDE, .h = SIDE, .xlog = m->xlog, .ylog = m->ylog, .xlabel = m->xlabel};
  edges(m->nx, m->x, &p.x0, &p.x1);
  edges(m->ny, m->y, &p.y0, &p.y1);
  lag_svg_head(picture, LEFT + SIDE + RIGHT, TOP + 20 + SIDE + BOTTOM);
  lag_svg_axes(f, &p, m->ylabel, 1);
  /* where there is no value */
  fprintf(f, "<rect x=\"%.1f\" y=\"%.1f\" width=\"%.1f\" height=\"%.1f\" fill=\"#ddd\"/>\n", p.x, p.y, p.w, p.h);
  fprintf(f, "<g transform=\"translate(%.1f %.1f) scale(%.9g %.9g)\" shape-rendering=\"crispEdges\">\n", p.x, p.y,
          p.w / m->nx, p.h / m->ny);
  for (int k = 0, n = s.categories ? s.categories : LEVELS; k < n; k++) put_cells(f, m, &s, k);
  fputs("</g>\n", f);
  if (s.categories) put_legend(f, &p, &s, m->label);
  else if (s.least <= s.most) put_bar(f, &p, &s, m->label);
}
