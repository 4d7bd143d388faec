/* Networks in --fit: their names stand for all their weights, and the weights found go to a file that models read.
 * Weights are the parameters V_w1[1,1], ..., V_b1[1], ... that lagc makes of `network V(...)`. */
#include <stdlib.h>
#include <string.h>

#include "app/fit_run.h"
#include "io/outfile.h"

/* The part "w1" or "b2" of a parameter that is a weight of the network of n letters; NULL: it is none. */
static const char *key_of(const char *parameter, const char *network, size_t n) {
  const char *key = parameter + n + 1;
  if (strncmp(parameter, network, n) != 0 || parameter[n] != '_' || (*key != 'w' && *key != 'b')) return NULL;
  size_t digits = strspn(key + 1, "0123456789");
  return digits && (key[1 + digits] == '[' || key[1 + digits] == '\0') ? key : NULL;
}

/* The next name of "V,th(0)", n letters without blanks; NULL behind the last. */
static const char *next_name(const char **list, size_t *n) {
  const char *s = *list + strspn(*list, ", ");
  *n = strcspn(s, ",");
  *list = s + *n;
  while (*n && s[*n - 1] == ' ') --*n;
  return *n ? s : NULL;
}

const char *lag_network_key(const char *names, const char *parameter) {
  size_t n;
  for (const char *s; (s = next_name(&names, &n)) != NULL;) {
    const char *key = key_of(parameter, s, n);
    if (key) return key;
  }
  return NULL;
}

char *lag_network_targets(const lag_model *m, const char *names) {
  size_t room = strlen(names) + 1, n, at = 0;
  for (int i = 0; i < m->np; i++) room += strlen(m->p[i].name) + 1;
  char *all = malloc(room * 2);
  for (const char *s; all && (s = next_name(&names, &n)) != NULL;) {
    size_t before = at;
    for (int i = 0; i < m->np && at < room; i++)
      if (key_of(m->p[i].name, s, n)) at += (size_t)sprintf(all + at, ",%s", m->p[i].name);
    if (at == before && at < room) at += (size_t)sprintf(all + at, ",%.*s", (int)n, s);
  }
  if (all) memmove(all, all + (at > 0), at + (at == 0));
  return all;
}

/* ---- The file */

/* How weight j goes on from the one before: 0 in its row, 1 in another row, 2 in another list. */
static int differs(const char *key, const char *before) {
  size_t name = strcspn(key, "[");
  if (!before || strncmp(key, before, name + 1) != 0) return 2;
  const char *comma = strchr(key, ',');
  return comma && strncmp(key, before, (size_t)(comma - key) + 1) != 0;
}

int lag_network_write(const FitRun *r, const char *path) {
  static const char *const begins[] = {"", "[", "[["}, *const ends[] = {"", "]", "]]"};
  static const char *const between[] = {", ", "],\n  ["};
  const char *before = NULL;
  int depth = 0;
  Outfile file;
  if (lag_outfile_open(&file, path)) return -1;
  putc('{', file.f);
  for (int j = 0; j < r->fit.n; j++) {
    const FitTarget *t = &r->fit.target[j];
    const char *key = t->weight ? lag_network_key(r->app->args.fit, t->name) : NULL;
    if (!key) continue;
    int way = differs(key, before), name = (int)strcspn(key, "[");
    if (way == 2 && before) fprintf(file.f, "%s,\n ", ends[depth]);
    if (way == 2) {
      depth = key[name] ? 1 + (strchr(key, ',') != NULL) : 0;
      fprintf(file.f, "\"%.*s\": %s", name, key, begins[depth]);
    } else fputs(between[way], file.f);
    fprintf(file.f, "%.17g", t->value);
    before = key;
  }
  fprintf(file.f, "%s}\n", ends[depth]);
  return lag_outfile_close(&file, OUTFILE_KEEP);
}
