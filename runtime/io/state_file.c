/* Saved states, from which a run continues as if never stopped. Enters: the block of doubles of a simulation;
 * leaves: a text file, or the reverse. Holds: doubles are hexadecimal and read back bit by bit (NaN as some NaN);
 * the last line is a checksum of all lines before it.
 *
 *   lag-state 1
 *   program NAME / scene NAME / method NAME / tolerance X / options N X... / signature H / t X
 *   data N
 *   X            N times
 *   sum H        FNV-1a, 64 bits */
#include <inttypes.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>

#include "io/io.h"
#include "io/posix.h"
#include "numeric/fnv1a.h"

enum { MOST_BYTES = 256 * 1024 * 1024 };

/* A file and the hash of what was written. */
typedef struct Summed {
  FILE *f;
  uint64_t sum;
} Summed;

#if defined(__GNUC__)
__attribute__((format(printf, 2, 3)))
#endif
static void put(Summed *to, const char *format, ...) {
  char text[sizeof(State)];
  va_list more;
  va_start(more, format);
  int n = vsnprintf(text, sizeof text, format, more);
  va_end(more);
  to->sum = lag_fnv1a(to->sum, text, (size_t)n);
  fwrite(text, 1, (size_t)n, to->f);
}

int lag_state_write(const char *path, const State *s) {
  Outfile o;
  if (lag_outfile_open(&o, path) != 0) return -1;
  Summed to = {.f = o.f, .sum = LAG_FNV1A_START};
  put(&to, "lag-state 1\nprogram %s\nscene %s\nmethod %s\n", s->program, s->scene, s->method);
  put(&to, "tolerance %a\noptions %d", s->tol, s->noptions);
  for (int i = 0; i < s->noptions; i++) put(&to, " %a", s->options[i]);
  put(&to, "\nsignature %016llx\nt %a\ndata %zu\n", s->signature, s->t, s->n);
  for (size_t i = 0; i < s->n; i++) put(&to, "%a\n", s->data[i]);
  fprintf(o.f, "sum %016" PRIx64 "\n", to.sum);
  return lag_outfile_close(&o, OUTFILE_SYNC);
}

/* Contents of a file of `size` bytes, 0-terminated, malloced; NULL with errno set. */
static char *read_whole_file(const char *path, size_t size) {
  FILE *f = fopen(path, "rb");
  char *text = f ? malloc(size + 1) : NULL;
  if (text) text[fread(text, 1, size, f)] = '\0';
  if (text && ferror(f)) {
    free(text);
    text = NULL;
  }
  if (f) fclose(f);
  return text;
}

/* Whether the text at *p begins with key; *p then moves past it. */
static int skip(char **p, const char *key) {
  size_t n = strlen(key);
  int found = strncmp(*p, key, n) == 0;
  *p += found ? n : 0;
  return found;
}

/* value := the rest of the line at *p behind key; *p moves to the next line. 0: no such line. */
static int field(char **p, const char *key, char *value, size_t size) {
  size_t n = skip(p, key) ? strcspn(*p, "\n") : size;
  if (n >= size || (*p)[n] != '\n') return 0;
  snprintf(value, size, "%.*s", (int)n, *p);
  *p += n + 1;
  return 1;
}

/* *x := the number behind key at *p, which moves past it and one blank. 0: no number. */
static int number(char **p, const char *key, double *x) {
  char *end;
  if (!skip(p, key)) return 0;
  *x = strtod(*p, &end);
  if (end == *p || (*end && *end != ' ' && *end != '\n')) return 0;
  *p = end + (*end != '\0');
  return 1;
}

static int read_head(char **p, State *s) {
  const int most = (int)(sizeof s->options / sizeof *s->options);
  char x[32];
  double n;
  int i = 0;
  if (!skip(p, "lag-state 1\n") || !field(p, "program ", s->program, sizeof s->program) ||
      !field(p, "scene ", s->scene, sizeof s->scene) || !field(p, "method ", s->method, sizeof s->method) ||
      !number(p, "tolerance ", &s->tol) || !number(p, "options ", &n) || !(n >= 0 && n <= most))
    return 0;
  s->noptions = (int)n;
  while (i < s->noptions && number(p, "", &s->options[i])) i++;
  if (i < s->noptions || !field(p, "signature ", x, sizeof x)) return 0;
  s->signature = strtoull(x, NULL, 16);
  if (!number(p, "t ", &s->t) || !field(p, "data ", x, sizeof x)) return 0;
  s->n = (size_t)strtoull(x, NULL, 10);
  return 1;
}

/* s->data[s->n] := the numbers at *p, which moves past them. 0: fewer numbers, or no memory. */
static int read_data(char **p, State *s) {
  size_t i = 0;
  if (s->n > strlen(*p) || (s->data = malloc((s->n + 1) * sizeof(double))) == NULL) return 0;
  while (i < s->n && number(p, "", &s->data[i])) i++;
  return i == s->n;
}

const char *lag_state_parse(char *text, State *s) {
  char *p = text, *sum = strstr(text, "\nsum ");
  *s = (State){0};
  if (strncmp(text, "lag-state 1\n", 12) != 0) return "is not a state saved by --save-state";
  if (!sum || strtoull(sum + 5, NULL, 16) != lag_fnv1a(LAG_FNV1A_START, text, (size_t)(sum + 1 - text)))
    return "is damaged: its checksum does not match";
  if (read_head(&p, s) && read_data(&p, s) && p == sum + 1) return NULL;
  free(s->data);
  s->data = NULL;
  return "is damaged: its format is not that of a saved state";
}

int lag_state_read(const char *path, State *s, const char **why) {
  struct stat is;
  *s = (State){0};
  if (stat(path, &is) != 0) return -1;
  if (!S_ISREG(is.st_mode) || is.st_size > MOST_BYTES) { /* reading a pipe would block */
    *why = S_ISREG(is.st_mode) ? "is larger than any saved state" : "is not a regular file";
    return 1;
  }
  char *text = read_whole_file(path, (size_t)is.st_size);
  if (!text) return -1;
  *why = lag_state_parse(text, s);
  free(text);
  return *why ? 1 : 0;
}
