/* CSV files (csv_file.h). Enters: a path; leaves: names, and fields row by row. Holds: every field is read, or the file
 * is refused with its line. */
#include "io/csv_file.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/posix.h"

enum { MOST_BYTES = 256000000 };

int lag_csv_refuse(const CsvFile *f, const char *format, ...) {
  va_list args;
  int n =
      f->line ? snprintf(f->why, f->size, "%s:%lld: ", f->path, f->line) : snprintf(f->why, f->size, "%s: ", f->path);
  va_start(args, format);
  if (n >= 0 && (size_t)n < f->size) vsnprintf(f->why + n, f->size - (size_t)n, format, args);
  va_end(args);
  return -1;
}

static int read_text(CsvFile *f) {
  FILE *in = lag_open_to_read(f->path);
  size_t n = 0, room = 0, got = 0;
  int binary = 0;
  if (!in) return lag_csv_refuse(f, "cannot be read: %s", lag_read_error());
  do {
    if (n + 1 >= room) {
      char *more = realloc(f->text, room = 2 * room + 65536);
      if (!more) break;
      f->text = more;
    }
    got = fread(f->text + n, 1, room - n - 1, in);
    binary = memchr(f->text + n, '\0', got) != NULL;
    n += got;
  } while (got && !binary && n <= MOST_BYTES);
  int failed = ferror(in) ? errno : !f->text || got ? ENOMEM : 0;
  fclose(in);
  if (binary) return lag_csv_refuse(f, "this is no text: it has a byte 0; save it as CSV");
  if (n > MOST_BYTES) return lag_csv_refuse(f, "the file has more than %d MB; split it", MOST_BYTES / 1000000);
  if (failed) return lag_csv_refuse(f, "cannot be read: %s", strerror(failed));
  f->text[n] = '\0';
  /* the mark that spreadsheets put before UTF-8 */
  f->at = f->text + (strncmp(f->text, "\xEF\xBB\xBF", 3) == 0 ? 3 : 0);
  return 0;
}

/* The next line that is not blank and no comment, `# ...`, without its end: LF, CR or both. NULL: none. */
static char *next_line(CsvFile *f) {
  while (*f->at) {
    char *line = f->at, *end = line + strcspn(line, "\r\n");
    f->at = end + (*end != '\0') + (end[0] == '\r' && end[1] == '\n');
    *end = '\0';
    f->line++;
    const char first = line[strspn(line, " \t")];
    if (first && first != '#') return line;
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
static int split(const CsvFile *f, char *line, char **field, int most) {
  int n = 0;
  for (char *at = line; at; n++) {
    if (n == most) return most + 1;
    if (!(field[n] = take_field(&at)))
      return lag_csv_refuse(f, "a quote has no end before the comma or the end of the line");
  }
  return n;
}

int lag_csv_open(CsvFile *f, const char *path, char *why, size_t size) {
  *f = (CsvFile){.path = path, .why = why, .size = size};
  if (read_text(f)) return -1;
  char *line = next_line(f);
  int most = 1;
  if (!line) return lag_csv_refuse(f, "the file is empty: its first line has names, each other line numbers");
  if (!strchr(line, ',') && strpbrk(line, ";\t")) return lag_csv_refuse(f, "columns are separated by commas");
  for (const char *s = line; *s; s++) most += *s == ',';
  f->names = calloc(2 * (size_t)most, sizeof *f->names);
  if (!f->names) return lag_csv_refuse(f, "out of memory");
  f->field = f->names + most;
  f->ncols = split(f, line, f->names, most);
  return f->ncols < 0 ? -1 : 0;
}

int lag_csv_row(CsvFile *f) {
  char *line = next_line(f);
  int n = line ? split(f, line, f->field, f->ncols) : 0;
  if (!line || n < 0) return n;
  if (n == f->ncols) return 1;
  return lag_csv_refuse(f,
                        n > f->ncols ? "there are more fields than the %d names in the first line"
                                     : "there are fewer fields than the %d names in the first line",
                        f->ncols);
}

int lag_csv_number(const CsvFile *f, int i, const char *name, double *x) {
  char *end;
  *x = strtod(f->field[i], &end);
  return *f->field[i] && !*end ? 0 : lag_csv_refuse(f, "%s: `%s` is no number", name, f->field[i]);
}

void lag_csv_close(CsvFile *f) {
  free(f->names);
  free(f->text);
  *f = (CsvFile){0};
}
