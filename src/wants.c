#include "wants.h"

#include <stdio.h>
#include <string.h>

#include "ir/unit.h"

/* The methods of the runtime that need more than accelerations; tests/exec/run_methods.sh compares this with what they say
 * themselves. An explicit method for separable models turns into an implicit one for the others. */
static const struct {
  const char *name;
  unsigned wants;
  int unless_separable;
} methods[] = {
  {"variational", WANT_VARIATION, 0}, {"gauss", WANT_VARIATION, 0},  {"symplectic_euler", WANT_VARIATION, 1},
  {"verlet", WANT_VARIATION, 1},      {"verlet4", WANT_VARIATION, 1}, {"verlet6", WANT_VARIATION, 1},
  {"verlet8", WANT_VARIATION, 1},     {"radau", WANT_LINEAR, 0},
  {"taylor", WANT_TAYLOR, 0},
};

/* Of NAME or NAME(option=value, ...). */
static unsigned wants_of_method(const Eqns *e, const char *text) {
  size_t n = text ? strcspn(text, " (") : 0;
  for (size_t i = 0; i < sizeof methods / sizeof *methods; i++)
    if (strlen(methods[i].name) == n && strncmp(methods[i].name, text, n) == 0 && !(methods[i].unless_separable && e->separable))
      return methods[i].wants;
  return 0;
}

/* The method that a saved state goes on with stands near its head, on a line of its own. A file that is none is the
 * simulator's to refuse. */
static const char *method_of_state(Arena *a, const char *path) {
  char line[256];
  FILE *f = fopen(path, "r");
  const char *name = NULL;
  for (int i = 0; f && i < 8 && !name && fgets(line, sizeof line, f); i++)
    if (strncmp(line, "method ", 7) == 0) name = arena_strndup(a, line + 7, strcspn(line + 7, "\n"));
  if (f) fclose(f);
  return name;
}

/* What all methods need. */
static unsigned wants_of_all(const Eqns *e) {
  unsigned wants = 0;
  for (size_t i = 0; i < sizeof methods / sizeof *methods; i++) wants |= wants_of_method(e, methods[i].name);
  return wants;
}

unsigned wants_of(const Eqns *e, const Options *o) {
  if (o->command == CMD_COST) return wants_of_all(e);
  unsigned wants = wants_of_method(e, e->m->scene.method) | wants_of_method(e, o->method) | (o->with ? WANT_LINEAR : 0u);
  return o->resume ? wants | wants_of_method(e, method_of_state(e->m->arena, o->resume)) : wants;
}
