/* Animation page. Enters: a table and the columns of its points; leaves: one self-contained HTML file (template
 * page.html, turned into C by the Makefile). Holds: a row is a frame; coordinates are integers in units of 1/100000
 * of the largest extent, finer than any screen. */
#include <errno.h>
#include <math.h>
#include <string.h>

#include "io/io.h"
#include "io/page.h"

enum { RESOLUTION = 100000, TICKS = 1000000000 };

/* Coordinates are written as integers: (x - *zero)/(*scale). *zero: the middle of all; *scale: extent/RESOLUTION. */
static void choose_resolution(const Table *t, const Animation *a, double *zero, double *scale) {
  double lo[2] = {HUGE_VAL, HUGE_VAL}, hi[2] = {-HUGE_VAL, -HUGE_VAL};
  for (int k = 0; k < 2 * a->npoints; k++) lag_table_range(t, a->cols[k], &lo[k % 2], &hi[k % 2]);
  double least = fmin(lo[0], lo[1]), most = fmax(hi[0], hi[1]), extent = fmax(hi[0] - lo[0], hi[1] - lo[1]);
  *zero = least <= most ? least / 2 + most / 2 : 0;
  double grain = extent > 0 && isfinite(extent) ? extent / RESOLUTION : fmax(fabs(*zero), 1) / RESOLUTION;
  *zero = nearbyint(*zero / grain) * grain; /* coordinate 0 stays exact */
  *scale = grain;
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
  int differ = 0;
  for (int i = 0; i < a->npoints; i++) {
    int x = a->cols[2 * i];
    if (t->cols[x].unit[0] || x == 0) return 0;
    for (size_t k = 1; k < t->nrows; k++)
      if (lag_table_cell(t, k, x) != lag_table_cell(t, 0, x)) return 0;
    differ |= t->nrows && lag_table_cell(t, 0, x) != lag_table_cell(t, 0, a->cols[0]);
  }
  return differ;
}

/* Names of tracks, and of each mark its time in ticks, track and word. */
static void put_marks(Json *j, const Marks *marks, double t0, double tick) {
  if (!marks->n) return;
  lag_json_begin(j, "marks", '{');
  lag_json_begin(j, "names", '[');
  for (int i = 0; i < marks->ntracks; i++) lag_json_string(j, NULL, marks->names[i]);
  lag_json_end(j, ']');
  lag_json_begin(j, "at", '[');
  for (size_t i = 0; i < marks->n; i++) {
    lag_json_count(j, NULL, (long long)nearbyint((marks->at[i].t - t0) / tick));
    lag_json_count(j, NULL, marks->at[i].track);
    lag_json_count(j, NULL, marks->at[i].word);
  }
  lag_json_end(j, ']');
  lag_json_end(j, '}');
}

/* Names of the points, in pairs. */
static void put_names(Json *j, const Table *t, const Animation *a) {
  lag_json_begin(j, "names", '[');
  for (int i = 0; i < a->npoints; i++) {
    lag_json_begin(j, NULL, '[');
    lag_json_string(j, NULL, t->cols[a->cols[2 * i]].name);
    lag_json_string(j, NULL, t->cols[a->cols[2 * i + 1]].name);
    lag_json_end(j, ']');
  }
  lag_json_end(j, ']');
}

/* Times between rows in ticks, then a line a frame: places of the points. */
static void put_frames(Json *j, const Table *t, const Animation *a, double tick, double zero, double scale) {
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
  for (size_t i = 0; i < t->nrows; i++)
    for (int k = 0; k < 2 * a->npoints; k++) {
      double x = (lag_table_cell(t, i, a->cols[k]) - zero) / scale;
      fputs(k ? "," : i ? ",\n" : "", j->f);
      if (isfinite(x)) fprintf(j->f, "%.0f", nearbyint(x) + 0.0);
      else fputs("null", j->f);
    }
}

/* Writes the JSON object that page.html describes. */
static void put_data(FILE *f, const Table *t, const Animation *a) {
  size_t n = t->nrows;
  double t0 = n ? lag_table_cell(t, 0, 0) : 0, t1 = n ? lag_table_cell(t, n - 1, 0) : 0,
         tick = t1 != t0 ? (t1 - t0) / TICKS : 1, zero, scale;
  Json j = {.f = f};

  choose_resolution(t, a, &zero, &scale);
  lag_json_begin(&j, NULL, '{');
  lag_json_number(&j, "t0", t0);
  lag_json_number(&j, "tick", tick);
  lag_json_number(&j, "t1", t1);
  lag_json_number(&j, "horizon", t->certain ? t->horizon : NAN);
  lag_json_number(&j, "speed", choose_speed(t, fabs(t1 - t0)));
  lag_json_number(&j, "zero", zero);
  lag_json_number(&j, "scale", scale);
  lag_json_truth(&j, "rods", a->rods);
  lag_json_truth(&j, "trace", a->trace);
  lag_json_truth(&j, "from", a->from);
  lag_json_string(&j, "unit", a->unit);
  lag_json_truth(&j, "free", x_is_index(t, a));
  lag_json_string(&j, "note", a->note ? a->note : "");
  put_names(&j, t, a);
  put_marks(&j, &a->marks, t0, tick);
  put_frames(&j, t, a, tick, zero, scale);
  fputs("]}\n", f);
}

int lag_html_write(const char *path, const Table *t, const char *title, const Animation *a) {
  Outfile o;
  if (lag_outfile_open(&o, path)) return -1;
  for (size_t i = 0; i < sizeof page / sizeof *page; i++) {
    const char *mark = strstr(page[i], "@TITLE@");
    if (strcmp(page[i], "@DATA@\n") == 0) {
      put_data(o.f, t, a);
    } else if (mark) {
      fwrite(page[i], 1, (size_t)(mark - page[i]), o.f);
      lag_write_markup(o.f, title);
      fputs(mark + strlen("@TITLE@"), o.f);
    } else {
      fputs(page[i], o.f);
    }
  }
  return lag_outfile_close(&o, OUTFILE_KEEP);
}
