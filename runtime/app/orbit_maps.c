/* Discrete symmetries of --relative and --reverse. Enters: terms such as x=-x, r[i]=r[i+1]; leaves: a map of the
 * state (analysis/state_map.h). */
#include <ctype.h>
#include <stdlib.h>
#include <string.h>

#include "analysis/flow_map.h"
#include "app/app.h"

enum { LONGEST = 96 };

static const char *const parts[] = {"", ".x", ".y", ".z"}; /* of vectors; a number has one without a name */

/* One side of a term: NAME, or before[i+shift]after of a family. */
typedef struct Side {
  char before[LONGEST], after[LONGEST];
  int indexed, shift;
} Side;

static int refuse(const App *app, const char *option, const char *term, size_t n) {
  return lag_app_error(&app->args,
                       "%s %.*s: write which coordinate takes the place of another, or of its negative: x=-x, "
                       "x[1]=x[2], or of all members of a family r[i]=r[i+1]%s",
                       option, (int)n, term, strcmp(option, "--reverse") == 0 ? "; or `rest`" : "");
}

/* s[n] without blanks. 0: not of this form. */
static int read_side(const char *s, size_t n, Side *side) {
  char text[LONGEST];
  size_t length = 0;
  for (size_t i = 0; i < n && length < LONGEST - 1; i++)
    if (!isspace((unsigned char)s[i])) text[length++] = s[i];
  text[length] = '\0';
  *side = (Side){.indexed = 0};
  char *index = strstr(text, "[i"), *close = index ? strchr(index, ']') : NULL, *end = NULL;
  if (index && !close) return 0;
  if (close) {
    side->indexed = 1;
    side->shift = (int)strtol(index + 2, &end, 10);
    if (end != close) return 0;
    snprintf(side->after, sizeof side->after, "%s", close + 1);
    *index = '\0';
  }
  snprintf(side->before, sizeof side->before, "%s", text);
  return length > 0 && length < LONGEST - 1;
}

/* Coordinate or state of this name with member `index` and part; -1: none. */
static int component(const App *app, const Side *side, int index, const char *part) {
  char name[2 * LONGEST + 20];
  if (side->indexed) snprintf(name, sizeof name, "%s[%d]%s%s", side->before, index, side->after, part);
  else snprintf(name, sizeof name, "%s%s", side->before, part);
  int i = lag_state_named(app, name, strlen(name)), nq = app->sim->pb.nq;
  return i >= nq && i < 2 * nq ? -1 : i;
}

/* First member of the family, and their number. */
static int members(const App *app, const Side *side, const char *part, int *first) {
  int count = 0;
  *first = component(app, side, 0, part) >= 0 ? 0 : 1;
  while (component(app, side, *first + count, part) >= 0) count++;
  return count;
}

/* Takes the term for one part of vectors. Returns how many components it names; -1: one of them has no partner. */
static int take_part(const App *app, const Side *to, const Side *from, double sign, const char *part, StateMap *map) {
  int first = 0, count = to->indexed ? members(app, to, part, &first) : component(app, to, 0, part) >= 0;
  for (int k = 0; k < count; k++) {
    int moved = (k + from->shift) % count, place = first + (moved < 0 ? moved + count : moved);
    int i = component(app, to, first + k, part), j = component(app, from, place, part);
    if (j < 0 || (i < map->nq) != (j < map->nq)) return -1;
    lag_map_set(map, i, j, sign);
  }
  return count;
}

static int take_term(App *app, const char *option, const char *term, size_t n, StateMap *map) {
  const char *eq = memchr(term, '=', n);
  Side to, from;
  if (!eq || !read_side(term, (size_t)(eq - term), &to)) return refuse(app, option, term, n);
  const char *right = eq + 1 + strspn(eq + 1, " ");
  double sign = *right == '-' ? -1 : 1;
  right += *right == '-' || *right == '+';
  if (right >= term + n || !read_side(right, (size_t)(term + n - right), &from) || to.shift ||
      (from.indexed && !to.indexed))
    return refuse(app, option, term, n);
  int found = 0;
  for (size_t p = 0; p < sizeof parts / sizeof *parts; p++) {
    int count = take_part(app, &to, &from, sign, parts[p], map);
    if (count < 0) return refuse(app, option, term, n);
    found += count;
  }
  return found ? 0 : refuse(app, option, term, n);
}

int lag_app_map_terms(App *app, const char *option, const char *terms, StateMap *map) {
  int rc = 0;
  for (const char *s = terms; *s && rc == 0; s += strspn(s, ", ")) {
    size_t n = strcspn(s, ",");
    if (map->reverses || memchr(s, '=', n)) rc = take_term(app, option, s, n, map);
    s += n;
  }
  if (rc) return rc;
  if (!lag_map_is_one_to_one(map))
    return lag_app_error(&app->args,
                         "%s %s: one coordinate would take the place of two; write x=y,y=x to exchange them", option,
                         terms);
  if (map->reverses && lag_map_order(map) != 2 && lag_map_order(map) != 1)
    return lag_app_error(&app->args, "%s %s: the map, applied twice, has to leave all as it was", option, terms);
  return 0;
}
