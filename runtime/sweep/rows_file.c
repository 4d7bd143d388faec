/* Rows of a CSV file (sweep_grid.h). Enters: names in the first line, "th [rad]" for th, numbers in each other one;
 * leaves: a list of values for each name. Holds: every field is read, or the file is refused with its line. */
#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/posix.h"
#include "sweep/sweep_grid.h"

enum { MOST_BYTES = 256000000 };

/* The file as it is read. */
typedef struct Rows {
  const char *path;
  char *text, *at;       /* the whole file; the next line */
  long long line;        /* number of the line before it */
  char **field;          /* [columns + 1] of one line */
  int columns, first;    /* names; number of the first factor */
  char *why;
  size_t size;
} Rows;

static int refuse(const Rows *r, const char *format, ...) {
  va_list args;
  int n =
      r->line ? snprintf(r->why, r->size, "%s:%lld: ", r->path, r->line) : snprintf(r->why, r->size, "%s: ", r->path);
  va_start(args, format);
  if (n >= 0 && (size_t)n < r->size) vsnprintf(r->why + n, r->size - (size_t)n, format, args);
  va_end(args);
  return -1;
}

static int read_text(Rows *r) {
  FILE *f = lag_open_to_read(r->path);
  size_t n = 0, room = 0, got = 0;
  int binary = 0;
  if (!f) return refuse(r, "cannot be read: %s", lag_read_error());
  do {
    if (n + 1 >= room) {
      char *more = realloc(r->text, room = 2 * room + 65536);
      if (!more) break;
      r->text = more;
    }
    got = fread(r->text + n, 1, room - n - 1, f);
    binary = memchr(r->text + n, '\0', got) != NULL;
    n += got;
  } while (got && !binary && n <= MOST_BYTES);
  int failed = ferror(f) ? errno : !r->text || got ? ENOMEM : 0;
  fclose(f);
  if (binary) return refuse(r, "this is no text: it has a byte 0; save it as CSV");
  if (n > MOST_BYTES)
    return refuse(r, "the file has more than %d MB; split it, and run a sweep for each part", MOST_BYTES / 1000000);
  if (failed) return refuse(r, "cannot be read: %s", strerror(failed));
  r->text[n] = '\0';
  /* the mark that spreadsheets put before UTF-8 */
  r->at = r->text + (strncmp(r->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0);
  return 0;
}

/* The next line that is not blank, without its end: LF, CR or both. NULL: none. */
static char *next_line(Rows *r) {
  while (*r->at) {
    char *line = r->at, *end = line + strcspn(line, "\r\n");
    r->at = end + (*end != '\0') + (end[0] == '\r' && end[1] == '\n');
    *end = '\0';
    r->line++;
    if (line[strspn(line, " \t")]) return line;
  }
  return NULL;
}

/* Takes a field, in quotes or not, with the spaces around it. *at := the next field, NULL: none. NULL: a quote has
 * no end. */
static char *take_field(char **at) {
  char *s = *at + strspn(*at, " \t"), *from = s, *to = s, *end;
  if (*s == '"') {
    for (from = to = ++s; *s && (*s != '"' || s[1] == '"'); s++) {
      *to++ = *s;
      s += *s == '"';
    }
    if (*s != '"') return NULL;
    end = s + 1 + strspn(s + 1, " \t");
    if (*end && *end != ',') return NULL;
  } else {
    end = s + strcspn(s, ",");
    for (to = end; to > from && isspace((unsigned char)to[-1]);) to--;
  }
  *at = *end ? end + 1 : NULL;
  *to = '\0';
  return from;
}

/* field[most] := fields of the line. Returns their number, most + 1: more; -1 after a message. */
static int split(Rows *r, char *line, int most) {
  int n = 0;
  for (char *at = line; at; n++) {
    if (n == most) return most + 1;
    if (!(r->field[n] = take_field(&at)))
      return refuse(r, "a quote has no end before the comma or the end of the line");
  }
  return n;
}

/* Names become factors; "m[2] [kg]" is m[2], in kg. */
static int read_names(Rows *r, SweepPlan *p) {
  char *line = next_line(r);
  int most = 1;
  if (!line) return refuse(r, "the file is empty: its first line has names, each other line numbers");
  if (!strchr(line, ',') && strpbrk(line, ";\t")) return refuse(r, "columns are separated by commas");
  for (const char *s = line; *s; s++) most += *s == ',';
  r->field = malloc((size_t)most * sizeof *r->field);
  if (!r->field) return refuse(r, "out of memory");
  if ((r->columns = split(r, line, most)) < 0) return -1;
  r->first = p->n;
  for (int k = 0; k < r->columns; k++) {
    char *name = r->field[k], *unit = strstr(name, " [");
    size_t n = strlen(name);
    if (unit && name[n - 1] == ']') *unit = name[n - 1] = '\0', unit += 2;
    else unit = NULL;
    if (!*name) return refuse(r, "column %d has no name", k + 1);
    if (isdigit((unsigned char)*name) || *name == '-')
      return refuse(r, "%.60s is no name: the first line has the names of the columns, as th,l", name);
    if (lag_plan_add_column(p, name, unit ? unit : "", r->why, r->size)) return -1;
  }
  return 0;
}

static int read_numbers(Rows *r, SweepPlan *p, char *line) {
  int n = split(r, line, r->columns);
  if (n < 0) return -1;
  if (n != r->columns)
    return refuse(r,
                  n > r->columns ? "there are more fields than the %d names in the first line"
                                 : "there are fewer fields than the %d names in the first line",
                  r->columns);
  for (int k = 0; k < n; k++) {
    const char *s = r->field[k];
    double x;
    if (!lag_plan_number(&s, &x) || *s)
      return refuse(r, "\"%.60s\" is not a number; rows have one for each name in the first line", r->field[k]);
    if (lag_factor_add(&p->factor[r->first + k], x)) return refuse(r, "out of memory");
  }
  return 0;
}

int lag_plan_add_rows(SweepPlan *p, const char *path, char *why, size_t size) {
  Rows r = {.path = path, .why = why, .size = size};
  int rc = p->n ? refuse(&r, "rows of a file, and ranges beside them: put the values into the file") : read_text(&r);
  rc = rc ? rc : read_names(&r, p);
  for (char *line; rc == 0 && (line = next_line(&r)) != NULL;) rc = read_numbers(&r, p, line);
  if (rc == 0 && p->factor[0].n == 0) rc = refuse(&r, "there are no rows below the names");
  p->zip = 1;
  free(r.field);
  free(r.text);
  return rc;
}
