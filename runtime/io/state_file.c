/* Saved states, from which a run continues as if never stopped. Enters: the block of doubles of a simulation; leaves: a
 * text file, or the reverse. Holds: doubles are hexadecimal and read back bit by bit (NaN as some NaN); the last line is a
 * checksum of all lines before it.
 *
 *   lag-state 1
 *   program NAME / scene NAME / method NAME / tolerance X / options N X... / signature H / t X
 *   data N
 *   X            N times
 *   sum H        FNV-1a, 64 bits */
#include <errno.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

#include "io/io.h"
#include "numeric/fnv1a.h"

enum { MOST_BYTES = 256 * 1024 * 1024 };

static void print_state(FILE *f, const State *s) {
  fprintf(f, "lag-state 1\nprogram %s\nscene %s\nmethod %s\ntolerance %a\noptions %d", s->program, s->scene, s->method,
          s->tol, s->noptions);
  for (int i = 0; i < s->noptions; i++) fprintf(f, " %a", s->options[i]);
  fprintf(f, "\nsignature %016llx\nt %a\ndata %zu\n", s->signature, s->t, s->n);
  for (size_t i = 0; i < s->n; i++) fprintf(f, "%a\n", s->data[i]);
}

int lag_state_write(const char *path, const State *s) {
  Outfile o;
  char *text = NULL;
  size_t size = 0;
  FILE *m = open_memstream(&text, &size);
  if (!m) return -1;
  print_state(m, s);
  if (fclose(m) != 0 || lag_outfile_open(&o, path) != 0) {
    free(text);
    return -1;
  }
  fwrite(text, 1, size, o.f);
  fprintf(o.f, "sum %016" PRIx64 "\n", lag_fnv1a(LAG_FNV1A_START, text, size));
  free(text);
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

/* value := rest of the line at *p, which must begin with key; *p moves to the next line. 0: no such line. */
static int field(char **p, const char *key, char *value, size_t size) {
  size_t n = strlen(key);
  char *end = strchr(*p, '\n');
  if (strncmp(*p, key, n) != 0 || !end || (size_t)(end - *p) - n >= size) return 0;
  memcpy(value, *p + n, (size_t)(end - *p) - n);
  value[(size_t)(end - *p) - n] = '\0';
  *p = end + 1;
  return 1;
}

/* *x := number at the start of *text; *text moves past it and one blank. 0: no number. */
static int number(char **text, double *x) {
  char *end;
  *x = strtod(*text, &end);
  if (end == *text || (*end && *end != ' ' && *end != '\n')) return 0;
  *text = end + (*end != '\0');
  return 1;
}

static int read_options(State *s, char *text) {
  double n = -1;
  int i = 0;
  if (!number(&text, &n) || !(n >= 0 && n <= (double)(sizeof s->options / sizeof *s->options)) || n != (double)(int)n) return 0;
  s->noptions = (int)n;
  while (i < s->noptions && number(&text, &s->options[i])) i++;
  return i == s->noptions && !*text;
}

static int read_head(char **p, State *s) {
  char x[1024], *at = x;
  if (!field(p, "lag-state 1", x, sizeof x) || !field(p, "program ", s->program, sizeof s->program) ||
      !field(p, "scene ", s->scene, sizeof s->scene) || !field(p, "method ", s->method, sizeof s->method) ||
      !field(p, "tolerance ", x, sizeof x) || !number(&at, &s->tol) || !field(p, "options ", x, sizeof x) || !read_options(s, x) ||
      !field(p, "signature ", x, sizeof x)) {
    return 0;
  }
  s->signature = strtoull(x, NULL, 16);
  at = x;
  if (!field(p, "t ", x, sizeof x) || !number(&at, &s->t) || !field(p, "data ", x, sizeof x)) return 0;
  s->n = (size_t)strtoull(x, NULL, 10);
  return 1;
}

/* s->data[s->n] := the numbers at *p, which moves past them. 0: fewer numbers, or no memory. */
static int read_data(char **p, State *s) {
  size_t i = 0;
  if (s->n > strlen(*p) || (s->data = malloc((s->n + 1) * sizeof(double))) == NULL) return 0;
  while (i < s->n && number(p, &s->data[i])) i++;
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
