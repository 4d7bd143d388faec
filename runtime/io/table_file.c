/* Tables and files of rows. Enters: the columns of a simulation, then one row at a time; leaves: a CSV file (RFC 4180;
 * a header with names and units, numbers with the digits to read back exactly), or a NumPy .npy file.
 *
 * The .npy file is a one-dimensional array of records with one 8-byte field a column; the field's title is "name
 * [unit]": a = numpy.load("f.npy"); a["th"], a["th [deg]"], a.dtype.fields. Format: NumPy Enhancement Proposal 1,
 * version 3.0. */
#include <errno.h>
#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include "io/io.h"
#include "numeric/fnv1a.h"

const char *lag_column_label(const Column *c, char *s, size_t n) {
  snprintf(s, n, c->unit[0] ? "%s [%s]" : "%s", c->name, c->unit);
  return s;
}

Column lag_state_column(const lag_sim *sim, int i) {
  Column c = {0};
  lag_sim_state_info(sim, i, c.name, sizeof c.name, c.unit, sizeof c.unit);
  return c;
}

int lag_table_init(Table *t, const lag_sim *sim, int keep) {
  *t = (Table){.ncols = lag_sim_noutputs(sim) + 1, .keep = keep};
  t->cols = calloc((size_t)t->ncols, sizeof *t->cols);
  if (!t->cols) return -1;
  strcpy(t->cols[0].name, "t");
  strcpy(t->cols[0].unit, "s");
  for (int i = 1; i < t->ncols; i++) {
    Column *c = &t->cols[i];
    lag_sim_output_info(sim, i - 1, c->name, sizeof c->name, c->unit, sizeof c->unit);
  }
  return 0;
}

void lag_table_free(Table *t) {
  free(t->cols);
  free(t->data);
  *t = (Table){0};
}

int lag_table_add(Table *t, const double *row) {
  if (!t->keep) return 0;
  if (t->nrows == t->capacity) {
    size_t capacity = t->capacity ? 2 * t->capacity : 1024;
    double *data = realloc(t->data, capacity * (size_t)t->ncols * sizeof *data);
    if (!data) return -1;
    t->data = data;
    t->capacity = capacity;
  }
  memcpy(t->data + t->nrows * (size_t)t->ncols, row, (size_t)t->ncols * sizeof *row);
  t->nrows++;
  return 0;
}

void lag_table_range(const Table *t, int col, double *lo, double *hi) {
  for (size_t i = 0; i < t->nrows; i++) {
    double x = lag_table_cell(t, i, col);
    if (isfinite(x)) {
      *lo = fmin(*lo, x);
      *hi = fmax(*hi, x);
    }
  }
}

double lag_long_time_unit(double span, const char **name) {
  static const struct {
    double seconds;
    const char *name;
  } units[] = {{31557600, "yr"}, {86400, "d"}, {3600, "h"}};

  for (size_t k = 0; k < sizeof units / sizeof *units; k++)
    if (span >= 2 * units[k].seconds) {
      *name = units[k].name;
      return units[k].seconds;
    }
  return 0;
}

void lag_table_scale_time(Table *t) {
  const char *name = NULL;
  double unit = lag_long_time_unit(t->nrows ? fabs(lag_table_cell(t, t->nrows - 1, 0) - t->data[0]) : 0, &name);
  int has_units = 0;
  for (int i = 1; i < t->ncols; i++) has_units |= t->cols[i].unit[0] && strcmp(t->cols[i].unit, "rad") != 0;
  if (!has_units || !name) return;
  for (size_t i = 0; i < t->nrows; i++) t->data[i * (size_t)t->ncols] /= unit;
  t->horizon /= unit;
  strcpy(t->cols[0].unit, name);
}

/* Writes a CSV field (RFC 4180): in quotes if it holds a comma, a quote or a line break; quotes are doubled. */
static void csv_text(FILE *f, const char *s) {
  const char *quote = strpbrk(s, ",\"\r\n") ? "\"" : "";
  fputs(quote, f);
  for (; *s; s++) fprintf(f, *s == '"' ? "\"\"" : "%c", *s);
  fputs(quote, f);
}

static void csv_head(Rows *r) {
  for (int i = 0; i < r->ncols; i++) {
    char text[sizeof(Column) + 4];
    if (i) putc(',', r->out.f);
    csv_text(r->out.f, lag_column_label(&r->cols[i], text, sizeof text));
  }
  putc('\n', r->out.f);
}

/* Writes the dictionary of the .npy header up to the shape, whose number of rows is not known yet. */
static void npy_dict(Rows *r, FILE *f) {
  const uint16_t probe = 1;
  char order = *(const unsigned char *)&probe ? '<' : '>';
  fputs("{'descr': [", f);
  for (int i = 0; i < r->ncols; i++) {
    const Column *c = &r->cols[i];
    char title[sizeof *c + 4];
    fputs(i ? ", (" : "(", f);
    if (c->unit[0]) {
      putc('(', f);
      lag_json_quote(f, lag_column_label(c, title, sizeof title));
      fputs(", ", f);
    }
    lag_json_quote(f, c->name);
    fprintf(f, "%s'%cf8')", c->unit[0] ? "), " : ", ", order);
  }
  fputs("], 'fortran_order': False, 'shape': (", f);
}

/* Writes the .npy header; its length does not depend on the number of rows, so it can be rewritten at the end. */
static int npy_head(Rows *r) {
  enum { MAGIC = 8, FIXED = 12 };
  FILE *f = r->out.f;
  fwrite("\x93NUMPY\3\0\0\0\0", 1, FIXED, f); /* the length follows below */
  npy_dict(r, f);
  long end = ftell(f);
  if (end < 0) return -1;
  long total = (end + 32 + 63) / 64 * 64, length = total - FIXED;
  for (long i = end + fprintf(f, "%zu,), }", r->nrows); i + 1 < total; i++) putc(' ', f);
  putc('\n', f);
  if (ferror(f) || fseek(f, MAGIC, SEEK_SET) != 0) return -1;
  for (int i = 0; i < 4; i++) putc((int)(length >> 8 * i & 255), f);
  return fseek(f, total, SEEK_SET);
}

int lag_rows_open(Rows *r, const char *path, const Table *t) {
  *r = (Rows){.ncols = t->ncols, .cols = t->cols};
  r->npy = lag_outfile_has_suffix(path, "npy");
  if (lag_outfile_open(&r->out, path)) return -1;
  r->open = 1;
  return r->npy ? npy_head(r) : 0;
}

static const char *text_of(Rows *r, double x) {
  uint64_t h = lag_fnv1a(LAG_FNV1A_START, (const char *)&x, sizeof x);
  size_t k = (size_t)(h ^ h >> 32) % (sizeof r->known / sizeof *r->known);
  if (r->known[k].text[0] && memcmp(&r->known[k].x, &x, sizeof x) == 0) return r->known[k].text;
  r->known[k].x = x;
  return lag_number_text(x, r->known[k].text);
}

int lag_rows_write(Rows *r, const double *row) {
  FILE *f = r->out.f;
  if (!r->npy && r->nrows == 0) csv_head(r);
  r->nrows++;
  if (r->npy) {
    fwrite(row, sizeof *row, (size_t)r->ncols, f);
    return ferror(f) ? -1 : 0;
  }
  for (int i = 0; i < r->ncols; i++) {
    const Column *c = &r->cols[i];
    fputs(i ? "," : "", f);
    if (c->words) csv_text(f, c->words[(int)row[i]]);
    else fputs(text_of(r, row[i]), f);
  }
  putc('\n', f);
  return ferror(f) ? -1 : 0;
}

int lag_rows_close(Rows *r, int keep) {
  if (!r->open) return 0;
  r->open = 0;
  if (!r->npy && keep && r->nrows == 0) csv_head(r);
  if (r->npy && keep && (fseek(r->out.f, 0, SEEK_SET) != 0 || npy_head(r))) {
    int error = errno;
    lag_outfile_close(&r->out, 0);
    errno = error;
    return -1;
  }
  return lag_outfile_close(&r->out, keep ? OUTFILE_SYNC : OUTFILE_DROP);
}
