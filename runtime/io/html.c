/* Animation page. Enters: a table and shapes of its columns; leaves: one self-contained HTML file (template
 * page.html, turned into C by the Makefile). Holds: a row is a frame; values are integers in units of 1/100000 of
 * the extent, finer than any screen; those that never change stand there once, exactly. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "io/io.h"
#include "io/page.h"

enum { RESOLUTION = 100000, TICKS = 1000000000 };

/* A column of the page: its value is zero + scale*integer; of scale 0 the constant `zero`. */
typedef struct PageColumn {
  int of, place; /* column of the table; 1: a coordinate of a place, on the scale that all of these share */
  double zero, scale, lo, hi;
} PageColumn;

typedef struct PageColumns {
  int n;
  PageColumn *at;
  int *index; /* [columns of the table] index in at + 1; 0: not drawn */
} PageColumns;

static void add_columns(PageColumns *c, const int *of, int n, int place) {
  for (int k = 0; k < n; k++) {
    if (of[k] < 0) continue;
    int *there = &c->index[of[k]];
    if (!*there) {
      c->at[c->n] = (PageColumn){.of = of[k], .lo = HUGE_VAL, .hi = -HUGE_VAL};
      *there = ++c->n;
    }
    c->at[*there - 1].place |= place;
  }
}

static void choose_scale(PageColumn *c, double extent) {
  double grain = extent > 0 && isfinite(extent) ? extent / RESOLUTION : fmax(fabs(c->lo), 1) / RESOLUTION;
  if (c->lo == c->hi) {
    c->zero = c->lo;
    c->scale = 0;
    return;
  }
  c->zero = c->lo <= c->hi ? nearbyint((c->lo / 2 + c->hi / 2) / grain) * grain : 0; /* 0 stays exact */
  c->scale = grain;
}

/* Columns that shapes use. -1: no memory. */
static int choose_columns(PageColumns *c, const Table *t, const Animation *a) {
  double extent = 0;
  c->n = 0;
  c->at = malloc((size_t)t->ncols * sizeof *c->at);
  c->index = calloc((size_t)t->ncols, sizeof *c->index);
  if (!c->at || !c->index) return -1;
  for (int i = 0; i < a->nshapes; i++) {
    const lag_shape *s = &a->shapes[i];
    add_columns(c, s->a, 3, 1);
    add_columns(c, s->b, 3, lag_shape_has_length(s));
    add_columns(c, s->size, 3, 0);
    add_columns(c, s->turn, 4, 0);
  }
  for (PageColumn *p = c->at; p < c->at + c->n; p++) {
    lag_table_range(t, p->of, &p->lo, &p->hi);
    if (p->place) extent = fmax(extent, p->hi - p->lo);
  }
  for (PageColumn *p = c->at; p < c->at + c->n; p++) choose_scale(p, p->place ? extent : p->hi - p->lo);
  return 0;
}

/* Playback speed, in seconds of the model per second of watching: 1 for runs of 1 to 90 s; else a round number, in
 * years, days, hours or seconds, that makes the run last about twenty seconds; but at most 280 frames per second: a
 * swing has about seventy frames, and the eye follows about four swings per second. */
static double choose_speed(const Table *t, double span) {
  enum { FRAMES_A_SECOND = 280, LASTS = 20 };
  const char *name;
  double unit = lag_long_time_unit(span, &name), most = t->nrows ? FRAMES_A_SECOND * span / (double)t->nrows : 0;
  if (unit <= 0) unit = 1;
  double speed = span == 0.0 || (span >= 1 && span <= 90) ? 1 : unit * lag_tick_step(0, span / unit, LASTS);
  return most > 0 && speed > most ? lag_tick_step(0, most / 1.6, 1) : speed;
}

/* Whether x is an index, not a length: numbers without a unit, constant and not all equal, as of the masses of a
 * string. */
static int x_is_index(const Table *t, const Animation *a) {
  int differ = 0, first = 0;
  for (int i = 0; i < a->nshapes; i++) {
    int x = a->shapes[i].a[0], up = a->shapes[i].a[1];
    if (x < 0 || up < 0 || t->cols[x].unit[0] || x == 0) return 0;
    if (!first) first = x;
    for (size_t k = 1; k < t->nrows; k++)
      if (lag_table_cell(t, k, x) != lag_table_cell(t, 0, x)) return 0;
    differ |= t->nrows && lag_table_cell(t, 0, x) != lag_table_cell(t, 0, first);
  }
  return differ;
}

/* Names of tracks, and of each mark its time in ticks, track and word. */
static void put_marks(Json *j, const Marks *marks, double t0, double tick) {
  if (!marks->n) return;
  lag_json_begin(j, "marks", '{');
  JSON_EACH(j, "names", '[', i, marks->ntracks) lag_json_string(j, NULL, marks->names[i]);
  lag_json_begin(j, "at", '[');
  for (size_t i = 0; i < marks->n; i++) {
    lag_json_count(j, NULL, (long long)nearbyint((marks->at[i].t - t0) / tick));
    lag_json_count(j, NULL, marks->at[i].track);
    lag_json_count(j, NULL, marks->at[i].word);
  }
  lag_json_end(j, ']');
  lag_json_end(j, '}');
}

static void put_indices(Json *j, const PageColumns *c, const int *of, int n) {
  JSON_EACH(j, NULL, '[', k, n) lag_json_count(j, NULL, of[k] < 0 ? -1 : c->index[of[k]] - 1);
}

/* Kind, role, text, count, and indices of page columns. */
static void put_shapes(Json *j, const Animation *a, const PageColumns *c) {
  JSON_EACH(j, "shapes", '[', i, a->nshapes) {
    const lag_shape *s = &a->shapes[i];
    lag_json_begin(j, NULL, '[');
    lag_json_string(j, NULL, s->kind);
    lag_json_string(j, NULL, s->role);
    lag_json_string(j, NULL, s->text);
    lag_json_count(j, NULL, s->count);
    put_indices(j, c, s->a, 3);
    put_indices(j, c, s->b, 3);
    put_indices(j, c, s->size, 3);
    put_indices(j, c, s->turn, 4);
    lag_json_end(j, ']');
  }
  JSON_EACH(j, "cols", '[', k, c->n) {
    lag_json_number(j, NULL, c->at[k].zero);
    lag_json_number(j, NULL, c->at[k].scale);
  }
}

/* Times between rows in ticks, then a line a frame: the columns that change. */
static void put_frames(Json *j, const Table *t, const PageColumns *c, double tick) {
  double t0 = t->nrows ? lag_table_cell(t, 0, 0) : 0;
  long long before = 0;
  lag_json_begin(j, "dt", '[');
  for (size_t i = 1; i < t->nrows; i++) {
    long long at = (long long)nearbyint((lag_table_cell(t, i, 0) - t0) / tick);
    lag_json_count(j, NULL, at - before);
    before = at;
  }
  lag_json_end(j, ']');
  putc('\n', j->f);
  lag_json_begin(j, "v", '[');
  for (size_t i = 0; i < t->nrows; i++) {
    int n = 0;
    if (i) fputs(",\n", j->f);
    for (const PageColumn *p = c->at; p < c->at + c->n; p++) {
      if (p->scale == 0) continue;
      double x = (lag_table_cell(t, i, p->of) - p->zero) / p->scale;
      if (n++) putc(',', j->f);
      if (isfinite(x)) fprintf(j->f, "%.0f", nearbyint(x) + 0.0);
      else fputs("null", j->f);
    }
    if (!n) fputs("0", j->f);
  }
}

/* Writes the JSON object that page.html describes. */
static void put_data(FILE *f, const Table *t, const Animation *a, const PageColumns *c) {
  size_t n = t->nrows;
  double t0 = n ? lag_table_cell(t, 0, 0) : 0, t1 = n ? lag_table_cell(t, n - 1, 0) : 0,
         tick = t1 != t0 ? (t1 - t0) / TICKS : 1;
  Json j = lag_json_open(f);

  lag_json_numbers(&j, {"t0", t0}, {"tick", tick}, {"t1", t1}, {"horizon", t->certain ? t->horizon : NAN},
                       {"speed", choose_speed(t, fabs(t1 - t0))});
  lag_json_count(&j, "frames", (long long)n);
  lag_json_truth(&j, "trace", a->trace);
  lag_json_string(&j, "unit", a->unit);
  lag_json_truth(&j, "free", x_is_index(t, a));
  lag_json_string(&j, "note", a->note ? a->note : "");
  put_shapes(&j, a, c);
  put_marks(&j, &a->marks, t0, tick);
  put_frames(&j, t, c, tick);
  fputs("]}\n", f);
}

static void put_page(FILE *f, const char *title, const Table *t, const Animation *a, const PageColumns *c) {
  for (size_t i = 0; i < sizeof page / sizeof *page; i++) {
    const char *mark = strstr(page[i], "@TITLE@");
    if (strcmp(page[i], "@DATA@\n") == 0) {
      put_data(f, t, a, c);
    } else if (mark) {
      fwrite(page[i], 1, (size_t)(mark - page[i]), f);
      lag_write_markup(f, title);
      fputs(mark + strlen("@TITLE@"), f);
    } else {
      fputs(page[i], f);
    }
  }
}

int lag_html_write(const char *path, const Table *t, const char *title, const Animation *a) {
  Outfile o;
  PageColumns c;
  int bad = choose_columns(&c, t, a) ? -1 : lag_outfile_open(&o, path);
  if (!bad) {
    put_page(o.f, title, t, a, &c);
    bad = lag_outfile_close(&o, OUTFILE_KEEP);
  }
  free(c.at);
  free(c.index);
  return bad;
}
