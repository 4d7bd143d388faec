/* Required derivatives: maps the methods of a scene and of the command line to flags WANT_... */
#include "commands/compiler.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "base/method_table.h"
#include "base/source.h"
#include "emit/emit_model.h"
#include "fmu/fmu_archive.h"
#include "ir/program_set.h"

/* Flags of a method; one that splits T and V of separable models is implicit for others, and then needs derivatives
 * of L. */
static unsigned required_by_info(const Eqns *e, const MethodInfo *m) {
  int splits = (m->flags & METHOD_SPLITS) && e->separable;
  if ((m->flags & METHOD_FLOWS) && !e->n) return WANT_LINEAR;
  return ((m->flags & METHOD_VARIATION) && !splits ? WANT_VARIATION : 0u) |
         (m->flags & METHOD_JACOBIAN ? WANT_LINEAR : 0u) | (m->flags & METHOD_TAYLOR ? WANT_TAYLOR : 0u);
}

/* Flags of methods written NAME or NAME(option=value, ...), with commas between several. */
static unsigned required_by_method(const Eqns *e, const char *text) {
  unsigned wants = 0;
  while (text && *text) {
    text += strspn(text, ", ");
    const MethodInfo *m = method_find(text, strcspn(text, " (,"));
    wants |= m ? required_by_info(e, m) : 0;
    text += strcspn(text, "(,");
    if (*text == '(') text += strcspn(text, ")");
    text += strcspn(text, ",");
  }
  return wants;
}

/* The method of a saved state, from the line `method NAME` near its head; NULL: none, and the simulator refuses the
 * file. */
const char *method_of_state(Arena *a, const char *path) {
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

/* Whether series and Jacobians take long to compile. */
static int is_long(const Eqns *e) {
  enum { LONG = 40 };
  return e->n + e->m->states.n > LONG;
}

/* Flags of the methods that the simulator may choose when none is named: taylor for small tolerances, radau where
 * friction or flows may be stiff. None for long models. */
static unsigned required_by_choice(const Eqns *e, const Options *o) {
  const double below_taylor = 1e-9; /* as in runtime/analysis/automatic_method.c */
  /* --accuracy tries several tolerances */
  double tol = o->accurate ? 0.1 * below_taylor : o->tol ? strtod(o->tol, NULL) : e->m->scene.tolerance;
  int runs = command_simulates(o->command) || o->command == CMD_BUILD;
  if (!runs || (e->m->scene.method && !o->accurate) || o->method || is_long(e)) return 0;
  return (tol > 0 && tol < below_taylor ? WANT_TAYLOR : 0u) |
         (e->conserves_energy && !e->m->states.n ? 0u : WANT_LINEAR);
}

/* Flags of measures of the scene or of --measure: the Lyapunov exponent and MEGNO, for which runs have tangents. */
static unsigned required_by_measures(const Eqns *e) {
  int found = 0;
  const Measures *lists[] = {&e->m->scene.measures, &e->m->asked_measures};
  for (int k = 0; k < 2; k++)
    for (uint32_t i = 0; i < lists[k]->n; i++)
      found |= strstr(lists[k]->at[i].text, "lyapunov()") || strstr(lists[k]->at[i].text, "megno()");
  return found ? WANT_LINEAR : 0u;
}

/* Whether --fit names a network of the model: parameters V_w1[1,1], ... */
static int trains_network(const Eqns *e, const Options *o) {
  const char *names = o->command == CMD_FIT ? options_passed(o, "--fit") : NULL;
  int found = 0;
  for (size_t n; names && *names && !found; names += n + (names[n] == ',')) {
    n = strcspn(names, ",");
    const char *weight = arena_printf(e->m->arena, "%.*s_w1[1,1]", (int)n, names);
    for (uint32_t i = 0; i < e->m->params.n; i++) found |= strcmp(e->m->params.at[i].name, weight) == 0;
  }
  return found;
}

/* Flags of --with, and of commands that differentiate. */
static unsigned required_by_words(const Eqns *e, const Options *o) {
  int all = o->command == CMD_LINEARIZE || (o->with && strcmp(o->with, "derivatives") == 0);
  if (all) return WANT_SENSITIVITY | WANT_INVERSE | WANT_ADJOINT;
  if (o->gradient.n || trains_network(e, o)) return WANT_SENSITIVITY | WANT_ADJOINT;
  if (o->command == CMD_FIT || o->command == CMD_DESIGN || options_passed(o, "--sensitivity")) return WANT_SENSITIVITY;
  if (options_pass_flag(o, "--amplitude")) return WANT_LINEAR | WANT_TAYLOR;
  return !o->with ? 0u : strcmp(o->with, "sensitivities") == 0 ? WANT_SENSITIVITY : WANT_LINEAR;
}

unsigned derivatives_afforded(unsigned wants, const Eqns *e, const ProgramSet *u, const Options *o) {
  /* instructions of accelerations with second derivatives of L: gcc 12 -O2, 400 to 880 (bicycle) */
  const double a_second = 400;
  enum { PAGE = 2000 }; /* a third of a page's programs from there on */
  double seconds = o->seconds ? strtod(o->seconds, NULL) : 10, most = seconds / 2 * a_second;
  int cost = o->command == CMD_COST && !options_passed(o, "--methods");
  int page = o->command == CMD_PAGE && !(required_by_method(e, e->m->scene.method) & WANT_VARIATION);
  int is_large = u->accel && u->accel->ins.n > (page ? PAGE : most);
  return (cost || page) && is_large ? wants & ~(unsigned)WANT_VARIATION : wants;
}

unsigned derivatives_required(const Eqns *e, const Options *o) {
  if (o->command == CMD_COST) {
    const char *methods = options_passed(o, "--methods");
    return methods ? required_by_method(e, methods) | WANT_TAYLOR : required_by_all(e); /* taylor: for the reference */
  }
  if (o->command == CMD_PAGE && !is_long(e)) return required_by_all(e);
  unsigned wants = required_by_method(e, e->m->scene.method) | required_by_method(e, o->method) |
                   required_by_choice(e, o) |
                   (o->command == CMD_FMU             ? fmu_wants()
                    : o->command == CMD_HEADER        ? WANT_HELD | header_wants(o->with) | header_wants(o->target)
                                                      : required_by_words(e, o) | required_by_measures(e));
  return o->resume ? wants | required_by_method(e, method_of_state(e->m->arena, o->resume)) : wants;
}
