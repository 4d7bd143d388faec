/* Required derivatives: maps the methods of a scene and of the command line to flags WANT_... */
#include "commands/compiler.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/method_table.h"
#include "base/source.h"
#include "ir/unit.h"

/* Flags of a method; one that splits T and V of separable models is implicit for others, and then needs derivatives of L. */
static unsigned required_by_info(const Eqns *e, const MethodInfo *m) {
  int splits = (m->flags & METHOD_SPLITS) && e->separable;
  if ((m->flags & METHOD_FLOWS) && !e->n) return WANT_LINEAR;
  return ((m->flags & METHOD_VARIATION) && !splits ? WANT_VARIATION : 0u) | (m->flags & METHOD_JACOBIAN ? WANT_LINEAR : 0u) |
         (m->flags & METHOD_TAYLOR ? WANT_TAYLOR : 0u);
}

/* Flags of a method written NAME or NAME(option=value, ...). */
static unsigned required_by_method(const Eqns *e, const char *text) {
  const MethodInfo *m = text ? method_find(text, strcspn(text, " (")) : NULL;
  return m ? required_by_info(e, m) : 0;
}

/* The method of a saved state, from the line `method NAME` near its head; NULL: none, and the simulator refuses the file. */
static const char *method_of_state(Arena *a, const char *path) {
  char line[256];
  const char *name = NULL, *error;
  FILE *f = source_open(path, &error);
  for (int i = 0; f && i < 8 && !name && fgets(line, sizeof line, f); i++)
    if (strncmp(line, "method ", 7) == 0) name = arena_strndup(a, line + 7, strcspn(line + 7, "\n"));
  if (f) fclose(f);
  return name;
}

/* Flags that all methods together need. */
static unsigned required_by_all(const Eqns *e) {
  unsigned wants = 0;
  for (size_t i = 0; method_at(i); i++) wants |= required_by_info(e, method_at(i));
  return wants;
}

/* Flags of the methods that the simulator may choose when none is named: taylor for small tolerances, radau where friction or flows may be
 * stiff. None for long models, whose series and Jacobians take long to compile. */
static unsigned required_by_choice(const Eqns *e, const Options *o) {
  enum { LONG = 40 };
  const double below_taylor = 1e-9; /* as in runtime/app/automatic_method.c */
  double tol = o->accurate ? 0.1 * below_taylor : o->tol ? strtod(o->tol, NULL) : e->m->scene.tolerance; /* --accuracy tries several tolerances */
  int runs = command_simulates(o->command) || o->command == CMD_BUILD;
  if (!runs || (e->m->scene.method && !o->accurate) || o->method || e->n + e->m->states.n > LONG) return 0;
  return (tol > 0 && tol < below_taylor ? WANT_TAYLOR : 0u) | (e->conserves_energy && !e->m->states.n ? 0u : WANT_LINEAR);
}

unsigned derivatives_required(const Eqns *e, const Options *o) {
  if (o->command == CMD_COST) return required_by_all(e);
  unsigned wants = required_by_method(e, e->m->scene.method) | required_by_method(e, o->method) | required_by_choice(e, o) | (o->with ? WANT_LINEAR : 0u);
  return o->resume ? wants | required_by_method(e, method_of_state(e->m->arena, o->resume)) : wants;
}
