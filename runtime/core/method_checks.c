/* Whether a method can integrate a model, and values of its options. Enters: a simulation, a method, options by name;
 * leaves: values, or a message with a method that can. */
#include <float.h>
#include <stdio.h>
#include <string.h>

#include "core/core.h"
#include "numeric/option_range.h"

/* *value := the value of one option; LAG_EINVAL when it is not allowed. */
static int option_value(lag_sim *s, const lag_method *m, const lag_method_option *o, const lag_option *given,
                        double *value) {
  *value = given->value;
  if (given->text) {
    for (int i = 0; o->choices && o->choices[i]; i++)
      if (strcmp(o->choices[i], given->text) == 0) {
        *value = i;
        return LAG_OK;
      }
  }
  lag_option_range range = {o->min, o->max, o->every, o->most, o->choices};
  char are[128];
  const char *step = lag_is_step_option(o->name) && *value > 0 ? lag_step_error(s, *value) : NULL;
  int bad = lag_option_refuses(&range, given->text ? NAN : *value, s->scene->model->constraints != NULL, are);
  if (bad && given->text)
    return lag_fail(s, LAG_EINVAL, "method %s: option %s cannot be \"%s\"; %s", m->name, o->name, given->text, are);
  if (bad || step) return lag_fail(s, LAG_EINVAL, "method %s: %s = %g: %s", m->name, o->name, *value, bad ? are : step);
  return LAG_OK;
}

static int is_tolerance(const char *name) {
  return strcmp(name, "tol") == 0 || strcmp(name, "rtol") == 0 || strcmp(name, "tolerance") == 0;
}

static int no_such_option(lag_sim *s, const lag_method *m, const char *name) {
  char has[256] = "";
  for (int i = 0; i < m->noptions; i++) {
    size_t at = strlen(has);
    snprintf(has + at, sizeof has - at, "%s%s", i ? ", " : "it has ", m->options[i].name);
  }
  const char *says = !is_tolerance(name) ? has : "the tolerance stands apart, --tol or lag_sim_set_tolerance";
  return lag_fail(s, LAG_EINVAL, "method %s has no option \"%s\"%s%s", m->name, name, says[0] ? ": " : "", says);
}

int lag_method_read_options(lag_sim *s, const lag_method *m, const lag_option *opt, int nopt, double *values) {
  for (int k = 0; k < nopt; k++) {
    int i = 0;
    while (i < m->noptions && opt[k].name && strcmp(m->options[i].name, opt[k].name) != 0) i++;
    if (i == m->noptions || !opt[k].name)
      return no_such_option(s, m, opt[k].name ? opt[k].name : "");
    int rc = option_value(s, m, &m->options[i], &opt[k], &values[i]);
    if (rc) return rc;
  }
  const char *wrong = m->refuses ? m->refuses(s->scene->model, values) : NULL;
  return wrong ? lag_fail(s, LAG_EINVAL, "method %s: %s", m->name, wrong) : LAG_OK;
}

/* Refuses a tolerance finer than the digits of the method's coefficients. */
int lag_method_check_digits(lag_sim *s, const lag_method *method) {
  if (method->finest < DBL_EPSILON || s->tol >= method->finest) return LAG_OK;
  return lag_fail(
      s, LAG_EMETHOD,
      "method %s: its published coefficients have digits for a tolerance of %.0e, not for %.3g; taylor computes "
      "its own",
      method->name, method->finest, s->tol);
}

/* Contacts whose friction in space is followed from event to event: forces of more are rarely unique. */
enum { LAG_MOST_IN_SPACE = 3 };

/* Switches that jump, friction in space, and many guides. */
static int check_jumps(lag_sim *s, const lag_method *method, unsigned needs) {
  const lag_model *m = s->scene->model;
  for (int k = 0; k < m->nmodes; k++) {
    if (!m->switches[k].jumps || !(needs & (LAG_METHOD_STEPS_TO | LAG_METHOD_SYMPLECTIC | LAG_METHOD_VARIATION |
                                            LAG_METHOD_SPLITS | LAG_METHOD_IMPULSES)))
      continue;
    if ((needs & LAG_METHOD_IMPULSES) && !m->switches[k].nonnegative) continue;
    return lag_fail(
        s, LAG_EMETHOD,
        "method %s cannot follow a motion that sticks or slides where `%s` jumps; rk45, dop853, radau and rk4 can",
        method->name, m->switches[k].text);
  }
  int in_space = 0;
  for (int i = 1; i < m->ncontacts; i++)
    in_space += m->contacts[i].is_tangent && m->contacts[i - 1].is_tangent && lag_guide_of(m, i) < 0;
  if (in_space > LAG_MOST_IN_SPACE && !(needs & LAG_METHOD_IMPULSES))
    return lag_fail(s, LAG_EMETHOD,
                    "method %s follows friction in space at up to %d contacts, and there are %d here; "
                    "--method moreau follows it", method->name, LAG_MOST_IN_SPACE, in_space);
  if (m->nguides > LAG_MOST_GUIDES && !(needs & LAG_METHOD_IMPULSES))
    return lag_fail(s, LAG_EMETHOD,
                    "method %s follows at most %d guides with friction, and the model has %d; --method "
                    "\"moreau(step=1e-3)\" follows any number",
                    method->name, LAG_MOST_GUIDES, m->nguides);
  return LAG_OK;
}

/* A refusal of a method; its text has the method's name, `what`, the name again. */
typedef struct Refusal {
  int holds;
  const char *text, *what;
} Refusal;

static int first_refusal(lag_sim *s, const lag_method *method, size_t n, const Refusal r[]) {
  for (size_t i = 0; i < n; i++)
    if (r[i].holds) return lag_fail(s, LAG_EMETHOD, r[i].text, method->name, r[i].what, method->name);
  return LAG_OK;
}

/* Flags of the method for this model: of one without coordinates some ask less. */
static unsigned needs_of(const lag_method *method, const lag_model *m, unsigned has) {
  const unsigned of_momenta = LAG_METHOD_NO_STATES | LAG_METHOD_VARIATION;
  unsigned needs = method->flags;
  if ((needs & LAG_METHOD_FLOWS) && m->nq == 0) needs = (needs & ~of_momenta) | LAG_METHOD_JACOBIAN;
  if ((needs & LAG_METHOD_SPLITS) && m->nq == 0 && (has & LAG_SEPARABLE)) needs &= ~of_momenta;
  return needs;
}

/* Methods whose steps take forces to be smooth. */
enum { SMOOTH = LAG_METHOD_STEPS_TO | LAG_METHOD_SYMPLECTIC | LAG_METHOD_VARIATION | LAG_METHOD_SPLITS };

int lag_method_check(lag_sim *s, const lag_method *method) {
  const lag_model *m = s->scene->model;
  const unsigned own = method->flags, has = lag_facts(&s->pb), needs = needs_of(method, m, has);
  const int held = m->constraints != NULL, linear = (needs & LAG_METHOD_NO_STATES) && (has & LAG_FIRST_ORDER);
  const int splits = (needs & LAG_METHOD_SPLITS) && (has & LAG_SEPARABLE) && !held;
  const Refusal first[] = {
      {m->families && !(own & LAG_METHOD_IMPULSES),
       "method %s does not follow the family of contacts %s; --method \"moreau(step=1e-3)\" does",
       m->families ? m->families->of[0].name : NULL},
      {m->contact_laws && (!(own & LAG_METHOD_CONSTRAINTS) || own & SMOOTH),
       "method %s cannot follow contacts with friction (%s); rk45, dop853, radau, rk4 and moreau can",
       m->contact_laws ? m->ev[m->contacts[0].impact].name : NULL},
      {held && !(own & LAG_METHOD_CONSTRAINTS),
       "method %s cannot hold constraints (%s); rk45, dop853 and variational can",
       held ? m->constraints->of[0].name : NULL},
      {held && (has & LAG_MASSLESS) && (own & LAG_METHOD_VARIATION),
       "method %s finds velocities from momenta, and not all coordinates have inertia in this program; `lagc build "
       "%s%s` builds a program where they have; rk45 and dop853 need none", "--method "},
      {linear && (needs & LAG_METHOD_SPLITS) && (has & LAG_SUM_HAMILTONIAN),
       "method %s takes forces of positions and t, and here forces depend on momenta or velocities; gauss, rk45 and "
       "dop853 can", NULL},
      {linear, "method %s needs momenta beside coordinates, and L is linear in the velocities%s; gauss is symplectic "
               "there, rk45 and dop853 can, too",
       needs & LAG_METHOD_SPLITS ? ", or H is not a sum T(p) + V(q, t)" : ""},
      {(needs & LAG_METHOD_NO_STATES) && m->nz > 0,
       "method %s cannot integrate a model with states; rk45 and dop853 can", NULL},
      {(needs & LAG_METHOD_STEPS_TO) && m->nev > 0,
       "method %s does not find events (%s), as its motion within a step is too rough; dop853 and radau do",
       m->nev > 0 ? m->ev[0].name : NULL}};
  const Refusal last[] = {
      {(needs & LAG_METHOD_TAYLOR) && !(has & LAG_SMOOTH),
       "method %s needs a model without if, abs, sign, min, max, atan2 and tables; dop853 does not", NULL},
      {(needs & LAG_METHOD_TAYLOR) && !m->taylor,
       "method %s needs series of the forces, which this program was built without: `lagc run MODEL --method %s` and "
       "`lagc build MODEL --method %s` build them in, but where sums over 20000 terms would be written out; dop853 "
       "has high order without", method->name},
      {((needs & LAG_METHOD_VARIATION) && !m->variation && !splits) ||
           ((needs & LAG_METHOD_JACOBIAN) && !m->linear && !held),
       "method %s needs derivatives of the model that this program was built without; `lagc run MODEL --method %s` and "
       "`lagc build MODEL --method %s` build them in; rk45 and dop853 do without", method->name}};
  int rc = first_refusal(s, method, sizeof first / sizeof *first, first);
  rc = rc ? rc : check_jumps(s, method, needs);
  rc = rc ? rc : first_refusal(s, method, sizeof last / sizeof *last, last);
  return rc ? rc : lag_method_check_digits(s, method);
}
