/* SVG: the shapes of a drawing at several instants, the last one full, those before fainter, and whole paths. In the
 * plane one scale for both axes; in space as page.html looks at first, nearer shapes over farther ones. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/svg_panel.h"

enum { HIGH = 640, ROUND = 48 };
static const double pi = 3.14159265358979323846, turn = -1.1, rise = 0.35; /* of the eye, as in page.html */

typedef struct View {
  const Table *t;
  const Animation *a;
  Panel panel;
  size_t row;
  int deep;
  double middle[3], scale, size; /* pixels of a metre; largest extent */
  FILE *f;
} View;

typedef struct Spot {
  double x, y, near;
} Spot;

static double value(const View *v, int col, double other) {
  return col < 0 ? other : lag_table_cell(v->t, v->row, col);
}

static void place(const View *v, const int *of, double *p) {
  for (int k = 0; k < 3; k++) p[k] = value(v, of[k], 0);
}

static Spot spot(const View *v, const double *p) {
  if (!v->deep) return (Spot){lag_panel_x(&v->panel, p[0]), lag_panel_y(&v->panel, p[1]), 0};
  double x = p[0] - v->middle[0], y = p[1] - v->middle[1], z = p[2] - v->middle[2], c = cos(turn), s = sin(turn),
         out = x * c + y * s;
  return (Spot){WIDTH / 2. + v->scale * (y * c - x * s), HIGH / 2. - v->scale * (z * cos(rise) - out * sin(rise)),
                out * cos(rise) + z * sin(rise)};
}

static Spot spot_of(const View *v, const int *of) {
  double p[3];
  place(v, of, p);
  return spot(v, p);
}

static const char *colour_of(const View *v, const lag_shape *s) {
  static const char *const tone[][2] = {
      {"link", "#777"},        {"spring", "#5a6b7b"}, {"support", "#8a8178"}, {"force", "#c1121f"},
      {"velocity", "#00755c"}, {"path", "#d98200"},   {"text", "#666"},       {"second", "#7a5195"},
      {"star", "#e0a100"},     {"ghost", "#c4c4c4"}};
  int n = 0;
  for (size_t i = 0; i < sizeof tone / sizeof *tone; i++)
    if (strcmp(tone[i][0], s->role) == 0) return tone[i][1];
  for (const lag_shape *x = v->a->shapes; x < s; x++) n += strcmp(x->role, "body") == 0;
  return lag_colour[n % 8];
}

static int is(const lag_shape *s, const char *kind) { return strcmp(s->kind, kind) == 0; }

/* ---- lines */

static void trail(const View *v, const Spot *at, int n, const char *end) {
  for (int k = 0; k < n; k++) fprintf(v->f, "%c%.1f %.1f", k ? 'L' : 'M', at[k].x, at[k].y);
  fputs(end, v->f);
}

static void stroke(const View *v, const Spot *at, int n, const char *colour, double width) {
  fprintf(v->f, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"%.1f\" stroke-linecap=\"round\" d=\"", colour, width);
  trail(v, at, n, "\"/>\n");
}

static void fill(const View *v, const Spot *at, int n, const char *colour, double opacity) {
  fprintf(v->f, "<path fill=\"%s\" fill-opacity=\"%.2g\" stroke=\"%s\" stroke-width=\"1.5\" d=\"", colour, opacity,
          colour);
  trail(v, at, n, "Z\"/>\n");
}

/* Point d pixels along the line from a to b, and e across it. */
static Spot beside(Spot a, Spot b, double d, double e) {
  double l = hypot(b.x - a.x, b.y - a.y), u = l > 0 ? (b.x - a.x) / l : 1, w = l > 0 ? (b.y - a.y) / l : 0;
  return (Spot){a.x + u * d - w * e, a.y + w * d + u * e, a.near};
}

static double pixels(const View *v, const lag_shape *s, double other) {
  return s->size[0] < 0 ? other : value(v, s->size[0], 0) * v->scale;
}

static void put_spring(const View *v, const lag_shape *s, Spot a, Spot b) {
  enum { MOST = 60 };
  int turns = s->count ? s->count < MOST ? s->count : MOST : 8, n = 0;
  double l = hypot(b.x - a.x, b.y - a.y), lead = fmin(10, l / 8), r = pixels(v, s, fmin(7, l / 8));
  Spot at[2 * MOST + 3];
  at[n++] = a;
  for (int k = 0; k <= 2 * turns; k++)
    at[n++] = beside(a, b, lead + (l - 2 * lead) * (k + 0.5) / (2 * turns + 1), k % 2 ? r : -r);
  at[n++] = b;
  stroke(v, at, n, colour_of(v, s), 1.6);
}

static void put_damper(const View *v, const lag_shape *s, Spot a, Spot b) {
  double l = hypot(b.x - a.x, b.y - a.y), r = pixels(v, s, 7);
  const char *colour = colour_of(v, s);
  stroke(v, (Spot[]){a, beside(a, b, 0.35 * l, 0)}, 2, colour, 1.6);
  stroke(v, (Spot[]){beside(a, b, 0.7 * l, -r), beside(a, b, 0.35 * l, -r), beside(a, b, 0.35 * l, r),
                     beside(a, b, 0.7 * l, r)}, 4, colour, 1.6);
  stroke(v, (Spot[]){beside(a, b, 0.55 * l, -0.7 * r), beside(a, b, 0.55 * l, 0.7 * r)}, 2, colour, 1.6);
  stroke(v, (Spot[]){beside(a, b, 0.55 * l, 0), b}, 2, colour, 1.6);
}

static void put_wall(const View *v, const lag_shape *s, Spot a, Spot b) {
  const char *colour = colour_of(v, s);
  double l = hypot(b.x - a.x, b.y - a.y);
  stroke(v, (Spot[]){a, b}, 2, colour, 2);
  for (double d = 0; d <= fmin(l, 4000); d += 9)
    stroke(v, (Spot[]){beside(a, b, d, 0), beside(a, b, d - 6, 7)}, 2, colour, 0.5);
}

static void put_arrow(const View *v, const lag_shape *s, Spot a, Spot b) {
  double l = hypot(b.x - a.x, b.y - a.y), head = fmin(11, l / 2);
  const char *colour = colour_of(v, s);
  if (!(l > 1)) return;
  stroke(v, (Spot[]){a, beside(a, b, l - 0.8 * head, 0)}, 2, colour, 2.5);
  fill(v, (Spot[]){b, beside(a, b, l - head, 0.45 * head), beside(a, b, l - head, -0.45 * head)}, 3, colour, 1);
}

/* ---- bodies */

/* out := the place of the shape plus p turned as the shape is. */
static void from_body(const View *v, const lag_shape *s, const double *p, double *out) {
  double at[3], r[3] = {p[0], p[1], p[2]}, w = value(v, s->turn[0], 0);
  place(v, s->a, at);
  if (s->turn[0] >= 0 && s->turn[3] < 0) {
    r[0] = cos(w) * p[0] - sin(w) * p[1];
    r[1] = sin(w) * p[0] + cos(w) * p[1];
  } else if (s->turn[0] >= 0) {
    double u[3] = {value(v, s->turn[1], 0), value(v, s->turn[2], 0), value(v, s->turn[3], 0)}, q[3];
    for (int k = 0; k < 3; k++) q[k] = u[(k + 1) % 3] * p[(k + 2) % 3] - u[(k + 2) % 3] * p[(k + 1) % 3] + w * p[k];
    for (int k = 0; k < 3; k++) r[k] = p[k] + 2 * (u[(k + 1) % 3] * q[(k + 2) % 3] - u[(k + 2) % 3] * q[(k + 1) % 3]);
  }
  for (int k = 0; k < 3; k++) out[k] = at[k] + r[k];
}

static Spot body_spot(const View *v, const lag_shape *s, double x, double y, double z) {
  double p[3];
  from_body(v, s, (double[]){x, y, z}, p);
  return spot(v, p);
}

static void put_disc(const View *v, const lag_shape *s) {
  Spot rim[ROUND], centre = spot_of(v, s->a);
  double r = value(v, s->size[0], 0);
  const char *colour = colour_of(v, s);
  int n = s->count ? s->count : s->turn[0] >= 0;
  for (int k = 0; k < ROUND; k++) rim[k] = body_spot(v, s, r * cos(2 * pi * k / ROUND), r * sin(2 * pi * k / ROUND), 0);
  fill(v, rim, ROUND, colour, 0.25);
  for (int k = 0; k < n; k++)
    stroke(v, (Spot[]){centre, body_spot(v, s, r * cos(2 * pi * k / n), r * sin(2 * pi * k / n), 0)}, 2, colour, 1.5);
}

/* The faces of a box whose outer side is seen. */
static void put_cuboid(const View *v, const lag_shape *s) {
  static const int face[6][4] = {{0, 2, 6, 4}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 1, 3, 2}, {4, 5, 7, 6}};
  double usual = 0.18 * v->size, h[3];
  Spot at[8], centre = body_spot(v, s, 0, 0, 0);
  for (int k = 0; k < 3; k++) h[k] = value(v, s->size[k], s->size[0] < 0 ? usual * (1 - 0.3 * k) : usual / 12) / 2;
  for (int k = 0; k < 8; k++) at[k] = body_spot(v, s, k & 1 ? h[0] : -h[0], k & 2 ? h[1] : -h[1], k & 4 ? h[2] : -h[2]);
  for (int i = 0; i < 6; i++) {
    Spot corner[4];
    double near = 0;
    for (int k = 0; k < 4; k++) near += (corner[k] = at[face[i][k]]).near / 4;
    if (near <= centre.near) continue;
    fill(v, corner, 4, "#fff", 1);
    fill(v, corner, 4, colour_of(v, s), 0.85 - 0.1 * (i / 2));
  }
}

static void put_box(const View *v, const lag_shape *s) {
  double a = value(v, s->size[0], 0) / 2, b = value(v, s->size[1], 0) / 2;
  Spot at[4];
  for (int k = 0; k < 4; k++) at[k] = body_spot(v, s, k % 3 ? a : -a, k / 2 ? b : -b, 0);
  fill(v, at, 4, colour_of(v, s), 0.35);
}

static void put_ground(const View *v, const lag_shape *s) {
  double p[3], f = value(v, s->turn[0], 0), far = v->deep ? 0.8 * v->size : (v->panel.x1 - v->panel.x0) * 2;
  place(v, s->a, p);
  if (v->deep) {
    Spot at[4];
    for (int k = 0; k < 4; k++)
      at[k] = spot(v, (double[]){v->middle[0] + (k % 3 ? far : -far), v->middle[1] + (k / 2 ? far : -far), p[2]});
    fill(v, at, 4, colour_of(v, s), 0.12);
    return;
  }
  put_wall(v, s, spot(v, (double[]){p[0] - far * cos(f), p[1] - far * sin(f), 0}),
           spot(v, (double[]){p[0] + far * cos(f), p[1] + far * sin(f), 0}));
}

/* ---- the picture */

static void put_curve(const View *v, const lag_shape *s) {
  fprintf(v->f, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"2\" d=\"", colour_of(v, s));
  for (int k = 0; k < s->count && s + k < v->a->shapes + v->a->nshapes; k++) {
    Spot at = spot_of(v, s[k].a);
    if (isfinite(at.x) && isfinite(at.y)) fprintf(v->f, "%c%.1f %.1f", k ? 'L' : 'M', at.x, at.y);
  }
  fputs("\"/>\n", v->f);
}

static void put_path(View *v, const lag_shape *s) {
  size_t now = v->row;
  int begun = 0;
  fprintf(v->f, "<path fill=\"none\" stroke=\"%s\" stroke-width=\"1.5\" d=\"", colour_of(v, s));
  for (v->row = 0; v->row < v->t->nrows; v->row++) {
    Spot at = spot_of(v, s->a);
    if (isfinite(at.x) && isfinite(at.y)) fprintf(v->f, "%c%.1f %.1f", begun++ ? 'L' : 'M', at.x, at.y);
  }
  fputs("\"/>\n", v->f);
  v->row = now;
}

/* Tip of an arrow; of one that is scaled to the picture a sixth of it for the longest at this instant. */
static Spot tip(const View *v, const lag_shape *s) {
  double p[3], b[3], longest = 0;
  place(v, s->a, p);
  place(v, s->b, b);
  for (const lag_shape *x = v->a->shapes; s->count && x < v->a->shapes + v->a->nshapes; x++) {
    double c[3];
    place(v, x->b, c);
    if (is(x, "arrow") && x->count && strcmp(x->role, s->role) == 0)
      longest = fmax(longest, sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]));
  }
  for (int k = 0; k < 3; k++) p[k] += b[k] * (s->count && longest > 0 ? v->size / 6 / longest : 1);
  return spot(v, p);
}

static void put_shape(View *v, const lag_shape *s) {
  Spot a = spot_of(v, s->a), b = spot_of(v, s->b);
  const char *colour = colour_of(v, s);
  if (is(s, "spring") && s->a[0] < 0 && s->a[1] < 0) a = (Spot){v->panel.x, b.y, 0};
  if (is(s, "spring") && s->b[0] < 0 && s->b[1] < 0) b = (Spot){v->panel.x + v->panel.w, a.y, 0};
  if (!isfinite(a.x) || !isfinite(a.y)) return;
  if (is(s, "rod")) stroke(v, (Spot[]){a, b}, 2, colour, fmax(3, pixels(v, s, 0)));
  else if (is(s, "spring")) put_spring(v, s, a, b);
  else if (is(s, "damper")) put_damper(v, s, a, b);
  else if (is(s, "disc")) put_disc(v, s);
  else if (is(s, "body") || (is(s, "box") && v->deep)) put_cuboid(v, s);
  else if (is(s, "box")) put_box(v, s);
  else if (is(s, "wall")) put_wall(v, s, a, b);
  else if (is(s, "ground")) put_ground(v, s);
  else if (is(s, "curve")) put_curve(v, s);
  else if (is(s, "path")) put_path(v, s);
  else if (is(s, "arrow")) put_arrow(v, s, a, tip(v, s));
  else if (is(s, "text")) lag_svg_text(v->f, a.x, a.y - 8, "text-anchor=\"middle\"", s->text);
  else
    fprintf(v->f, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\" fill=\"%s\"/>\n", a.x, a.y, fmax(2, pixels(v, s, 7)),
            colour);
}

/* Place of a kind from the back to the front; what does not move, and whole paths, are below TIMED. */
enum { TIMED = 4, NEAREST = 11 };
static int layer(const lag_shape *s) {
  static const char *const kinds[] = {"ground", "wall", "curve", "path", "rod",   "spring", "damper",
                                      "disc",   "box",  "body",  "ball", "arrow", "text"};
  int k = 0;
  while (strcmp(kinds[k], s->kind) != 0 && k + 1 < (int)(sizeof kinds / sizeof *kinds)) k++;
  return k;
}

typedef struct Ordered {
  const lag_shape *shape;
  double at;
} Ordered;

static int compare(const void *x, const void *y) {
  const Ordered *a = x, *b = y;
  return a->at != b->at ? (a->at > b->at) - (a->at < b->at) : (a->shape > b->shape) - (a->shape < b->shape);
}

/* Shapes of one instant, in their order: those that are timed, or grounds, walls, curves and paths. */
static void put_instant(View *v, Ordered *of, int timed, double opacity) {
  int n = 0;
  for (int i = 0; i < v->a->nshapes; i++) {
    const lag_shape *s = &v->a->shapes[i];
    int l = layer(s);
    if ((l >= TIMED) != timed || (is(s, "curve") && i && is(s - 1, "curve") && s[-1].count > 1)) continue;
    double near = (spot_of(v, s->a).near + (s->b[0] >= 0 ? spot_of(v, s->b).near : spot_of(v, s->a).near)) / 2;
    of[n++] = (Ordered){s, v->deep && timed && l < NEAREST ? atan(near / v->size) : l};
  }
  qsort(of, (size_t)n, sizeof *of, compare);
  fprintf(v->f, "<g opacity=\"%.2g\">\n", opacity);
  for (int i = 0; i < n; i++) put_shape(v, of[i].shape);
  fputs("</g>\n", v->f);
}

/* Widens [lo, hi] by a place of a shape and what reaches beyond. */
static void extend(const View *v, const lag_shape *s, const int *of, double *lo, double *hi) {
  double p[3], r = is(s, "ball") || is(s, "disc") ? value(v, s->size[0], 0) : 0;
  place(v, of, p);
  if (is(s, "box") || is(s, "body"))
    r = sqrt(pow(value(v, s->size[0], 0), 2) + pow(value(v, s->size[1], 0), 2) + pow(value(v, s->size[2], 0), 2)) / 2;
  for (int k = 0; k < 3; k++) {
    if (!isfinite(p[k])) continue;
    lo[k] = fmin(lo[k], p[k] - r);
    hi[k] = fmax(hi[k], p[k] + r);
  }
}

/* Chooses the ranges of the axes, or the eye's scale. */
static void look(View *v) {
  double lo[3] = {HUGE_VAL, HUGE_VAL, HUGE_VAL}, hi[3] = {-HUGE_VAL, -HUGE_VAL, -HUGE_VAL}, ball = 0;
  for (v->row = 0; v->row < v->t->nrows; v->row++)
    for (const lag_shape *s = v->a->shapes; s < v->a->shapes + v->a->nshapes; s++) {
      if (is(s, "ground")) continue;
      extend(v, s, s->a, lo, hi);
      if (!is(s, "arrow") && (s->b[0] >= 0 || s->b[1] >= 0)) extend(v, s, s->b, lo, hi);
    }
  for (int k = 0; k < 3; k++) {
    if (!(lo[k] <= hi[k])) lo[k] = -1, hi[k] = 1;
    v->middle[k] = (lo[k] + hi[k]) / 2;
    v->size = fmax(v->size, hi[k] - lo[k]);
    ball += pow(hi[k] - lo[k], 2) / 4;
  }
  if (v->size == 0) v->size = 1;
  if (ball == 0) ball = 0.09;
  double w = WIDTH - LEFT - 20, h = HIGH - TOP - BOTTOM,
         metre = fmax((hi[0] - lo[0]) / w, fmax((hi[1] - lo[1]) / h, v->size / 50 / w)) * 1.08;
  v->scale = v->deep ? (HIGH - 2 * TOP) / (2 * sqrt(ball)) : 1 / metre;
  v->panel = (Panel){.x = LEFT, .y = TOP, .w = w, .h = h,
                     .x0 = v->middle[0] - w * metre / 2, .x1 = v->middle[0] + w * metre / 2,
                     .y0 = v->middle[1] - h * metre / 2, .y1 = v->middle[1] + h * metre / 2};
}

static size_t row_at(const Table *t, double part) {
  double t0 = lag_table_cell(t, 0, 0), t1 = lag_table_cell(t, t->nrows - 1, 0), at = t0 + part * (t1 - t0);
  size_t i = 0;
  while (i + 1 < t->nrows && (lag_table_cell(t, i, 0) - at) * (t1 - t0) < 0) i++;
  return i;
}

int lag_drawing_write(const Picture *p, const Table *t, const Animation *a) {
  int instants = atoi(p->options->drawing);
  FILE *f = p->f;
  View v = {.t = t, .a = a, .f = f};
  char label[80];
  Ordered *order = malloc(((size_t)a->nshapes + 1) * sizeof *order);
  if (!order || !t->nrows) return free(order), -1;
  for (int i = 0; i < a->nshapes; i++)
    v.deep |= a->shapes[i].a[2] >= 0 || a->shapes[i].b[2] >= 0 || a->shapes[i].turn[3] >= 0;
  look(&v);
  lag_svg_head(p, WIDTH, HIGH);
  snprintf(label, sizeof label, a->unit[0] ? "[%s]" : "%s", a->unit);
  v.panel.xlabel = label;
  if (!v.deep) lag_svg_axes(f, &v.panel, label, 1);
  fprintf(f, "<clipPath id=\"c\"><rect x=\"%.0f\" y=\"%.0f\" width=\"%.0f\" height=\"%.0f\"/></clipPath>\n"
               "<g clip-path=\"url(#c)\">\n", v.panel.x, v.panel.y, v.panel.w, v.panel.h);
  v.row = t->nrows - 1;
  put_instant(&v, order, 0, 1);
  for (int k = 0; k < instants; k++) {
    v.row = row_at(t, instants > 1 ? (double)k / (instants - 1) : 1);
    put_instant(&v, order, 1, instants == 1 ? 1 : 0.25 + 0.75 * k / (instants - 1));
  }
  fputs("</g>\n", f);
  free(order);
  return 0;
}
