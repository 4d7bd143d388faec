/* Setup of a simulation: memory, parameters, start, method. Enters: a scene and the caller's settings by name;
 * leaves: the state at the start of the span. Holds: a setting that is refused changes nothing. */
#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "core/core.h"
#include "core/rhs.h"
#include "numeric/release.h"
#include "numeric/workspace.h"

enum { RUN_DOUBLES = sizeof(Run) / sizeof(double), LINE = LAG_WORK_ALIGN, LINE_DOUBLES = LINE / sizeof(double) };

/* Cuts x into the arrays that are saved behind Run; returns their length. x NULL: only that. */
static size_t saved_arrays(lag_sim *s, const lag_method *method, double *x) {
  const lag_model *m = s->scene->model;
  size_t nm = (size_t)m->nmodes, nu = (size_t)m->nu + nm, n = (size_t)s->pb.n, nev = (size_t)m->nev + nm;
  size_t nmon = (size_t)s->scene->nmonitors, nc = (size_t)(m->constraints ? m->constraints->n : 0);
  size_t keys = method->flags & LAG_METHOD_IMPULSES ? (size_t)lag_family_rows_of(m) : 0,
         pushed = method->flags & LAG_METHOD_IMPULSES ? (size_t)m->ncontacts + keys : 0;
  double *contacts;
  const lag_part parts[] = {{&s->p, (size_t)m->np}, {&s->derived, (size_t)m->nderived}, {&s->hold, nu},
      {&s->begin, n}, {&s->asked, n}, {&s->elsewhere, (size_t)m->nq}, {&s->redundant, nc},
      {&s->loose, (size_t)m->nq}, {&s->kept, nc}, {&s->y, n}, {&s->y0, n}, {&s->now, n}, {&s->sign, nev},
      {&s->noise, nev}, {&s->root, nev}, {&s->sign_end, nev},
      {&s->count, nev}, {&s->first, nev}, {&s->last, nev}, {&s->interval, nev}, {&s->shorter, nev},
      {&s->flight, nev}, {&s->skipped, nev}, {&s->crossed, nm}, {&s->slips, nm}, {&s->slid, nm},
      {&s->slid_since, nm}, {&s->mon_first, nmon}, {&s->mon_peak, nmon}, {&s->exact_peak, (size_t)s->scene->nexact},
      {&contacts, pushed ? sizeof(lag_contact_stats) / sizeof(double) : 0}, {&s->pb.contact_impulse, pushed},
      {&s->pb.contact_key, keys},
      {&s->pb.contact_change, pushed ? (size_t)m->nq : 0}, {&s->pb.guide_load, 3 * (size_t)m->nguides},
      {&s->charge_block, (size_t)lag_sim_ncharges(s) * sizeof(Charge) / sizeof(double)}, {&s->rate_history, 3 * n},
      {&s->pb.size, n + 2}};
  size_t length = lag_workspace_slice(x, sizeof parts / sizeof *parts, parts);
  if (x) s->pb.contacts = pushed ? (lag_contact_stats *)(void *)contacts : NULL;
  return length;
}

static void set_problem(lag_sim *s, const lag_method *method, const double *opt) {
  lag_problem *pb = &s->pb;
  pb->p = s->p;
  pb->hold = s->hold;
  pb->kept = s->kept;
  pb->begin = s->begin;
  pb->kick = HUGE_VAL;
  pb->opt = opt;
  pb->variant = method->variant;
}

/* First values of the saved arrays that do not begin as zeros. */
static void begin_blocks(lag_sim *s) {
  for (int i = 0; i < s->pb.n + 2; i++) s->pb.size[i] = 1;
  lag_reset_rate_history(s);
  lag_charges_method(s, s->method);
}

/* Allocates and lays out the blocks for this method, keeping only the settings of the caller (p, hold). opt: option
 * values, which must live on. */
static int set_blocks(lag_sim *s, const lag_method *method, const double *opt) {
  const lag_model *m = s->scene->model;
  size_t np = (size_t)(m->np + m->nderived), nu = (size_t)(m->nu + m->nmodes);
  size_t pushes = method->flags & LAG_METHOD_IMPULSES ? lag_moreau_contacts_size(m) : 0;
  size_t fixed = RUN_DOUBLES + saved_arrays(s, method, NULL);
  double *contact_room = calloc(pushes + 1, sizeof *contact_room);
  lag_problem sized = s->pb;

  sized.opt = opt;
  sized.variant = method->variant;
  size_t before = (fixed + LINE_DOUBLES - 1) / LINE_DOUBLES * LINE_DOUBLES, work = method->work_size(&sized),
         total = before + work;
  char *room = calloc(total * sizeof(double) + LINE - 1, 1);

  if (!room || !contact_room) {
    lag_free_all(room, contact_room);
    return LAG_ENOMEM;
  }
  double *b = (double *)(void *)(room + (LINE - (uintptr_t)room % LINE) % LINE), *x = b + RUN_DOUBLES;
  if (s->saved) {
    memcpy(x, s->p, np * sizeof *x);
    memcpy(x + np, s->hold, nu * sizeof *x);
  }
  free(s->fresh);
  s->fresh = NULL;
  free(s->room);
  s->room = room;
  s->saved = b;
  s->nsaved = total;
  s->run = (Run *)(void *)b;
  saved_arrays(s, method, x);
  s->method_work = b + before;
  s->nwork = work;
  free(s->pb.contact_room);
  s->pb.contact_room = contact_room;
  s->pb.family = NULL;
  set_problem(s, method, opt);
  s->charges = (Charge *)(void *)s->charge_block;
  s->method = method;
  begin_blocks(s);
  return LAG_OK;
}

/* Allocates the scratch arrays, or where they are there sets them to 0. LAG_ENOMEM: no memory. */
static int clear_scratch(lag_sim *s) {
  const lag_model *m = s->scene->model;
  size_t n = (size_t)s->pb.n, nm = (size_t)m->nmodes, nev = (size_t)m->nev + nm, nout = (size_t)s->scene->nout;
  size_t nu = (size_t)m->nu, nw = (size_t)(m->taylor && m->taylor->nw > m->nw ? m->taylor->nw : m->nw),
         nuu = nu + nm + (size_t)s->scene->nexact;
  size_t held = lag_constraint_scratch_size(m), ranks = lag_rank_scratch_size(m),
         sized = m->ncontacts ? 2 * (size_t)m->constraints->n : 0,
         rows = m->ncontacts ? (size_t)(m->constraints->njacobian + m->constraints->nmass + m->nq) : 0;
  size_t nc = (size_t)lag_sim_ncharges(s) + 1;
  const lag_part parts[] = {{&s->u, nuu}, {&s->work, nw}, {&s->ya, n}, {&s->yb, n}, {&s->yc, n}, {&s->g0, nev},
      {&s->g1, nev}, {&s->out, nout}, {&s->e, 2 + nev}, {&s->spare, 11 * nev},
      {&s->beside, n + (size_t)(m->np + m->nderived)}, {&s->beside_noise, 3 * n},
      {&s->beside_open, 3 * n}, {&s->pb.held, held}, {&s->pb.ranks, ranks}, {&s->contact_scratch, sized},
      {&s->contact_was, (size_t)m->ncontacts}, {&s->contact_pair, (size_t)m->ncontacts}, {&s->contact_rows, rows},
      {&s->charge_now, 2 * nc}, {&s->charge_power, nc}, {&s->charge_gain, nc}, {&s->sides, 3 * (size_t)m->nswitch},
      {&s->grip, nm}, {&s->side_noise, nm}, {&s->slid_off, nm}, {&s->meets, nm}, {&s->left, nm},
      {&s->meeting, nm * (9 + 2 * nm)}, {&s->pb.slide, nm * (3 + 2 * nm)},
      {&s->pb.rub, lag_contact_law_size(m)},
      {&s->sizes, (size_t)(m->nsizes + m->nmoving)}};
  const size_t nparts = sizeof parts / sizeof *parts;
  if (s->scratch) lag_workspace_clear(nparts, parts);
  else s->scratch = lag_workspace(nparts, parts);
  return s->scratch ? LAG_OK : LAG_ENOMEM;
}

static int alloc_scratch(lag_sim *s) {
  const lag_model *m = s->scene->model;
  size_t n = (size_t)s->pb.n, nm = (size_t)m->nmodes, nu = (size_t)m->nu;
  int rc = clear_scratch(s);
  s->fixed = calloc((size_t)m->np + 1, 1);
  s->start = malloc((n + 1) * sizeof(double));
  s->signal = calloc(nu + 1, sizeof *s->signal);
  s->meeting_of = calloc(3 * nm + 1, sizeof *s->meeting_of);
  s->alike = malloc((n + 1) * sizeof *s->alike);
  if (rc || !s->alike || !s->meeting_of || !s->fixed || !s->start || !s->signal) return LAG_ENOMEM;
  for (size_t i = 0; i < n; i++) s->start[i] = NAN;
  lag_find_alike(m, s->alike);
  s->pb.sliding = s->meeting_of + nm;
  s->pb.u = s->u;
  s->pb.signal = s->signal;
  s->pb.work = s->work;
  return LAG_OK;
}

/* Default values of the options; NULL: no memory. */
static double *default_options(const lag_method *method) {
  double *values = malloc(((size_t)method->noptions + 1) * sizeof *values);
  for (int i = 0; values && i < method->noptions; i++) values[i] = method->options[i].value;
  return values;
}

/* Sets the state to the start as it is set now, so that a simulation can be inspected before it runs. */
void lag_asked_start(lag_sim *s) {
  int nq = s->pb.nq, n = s->pb.n;
  if (s->scene->start) s->scene->start(s->scene, s->p, s->now, s->now + nq, s->now + 2 * nq);
  for (int i = 0; i < n; i++) s->now[i] = isnan(s->start[i]) ? s->now[i] : s->start[i];
  memcpy(s->begin, s->now, (size_t)n * sizeof(double));
  s->run->t = s->scene->t0;
}

/* No input is held, no surface is slid on. */
static void free_modes(lag_sim *s) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->nu + m->nmodes; i++) s->hold[i] = i < m->nu ? NAN : LAG_FREE;
}

/* A simulation with its memory, for a method with these options (NULL: its own); no values are set. */
static lag_sim *allocate(const lag_scene *scene, double tol, const lag_method *method, const double *options) {
  const lag_model *m = scene->model;
  lag_sim *s = m->abi == LAG_ABI && m->real_size == sizeof(double) ? calloc(1, sizeof *s) : NULL;
  if (!s) return NULL;
  s->scene = scene;
  s->pb = (lag_problem){.model = m, .nq = m->nq, .nz = m->nz, .n = 2 * m->nq + m->nz, .dir = 1, .bad_index = -1};
  s->pb.span = scene->has_span ? fabs(scene->t1 - scene->t0) : 0;
  s->tol = s->pb.tol = tol;
  double *opt = default_options(method);
  if (opt && options) memcpy(opt, options, (size_t)method->noptions * sizeof *opt);
  int bad = !opt || alloc_scratch(s) || set_blocks(s, method, opt);
  s->options = options ? opt : NULL;
  if (!options) {
    free(opt);
    s->pb.opt = NULL;
  }
  if (bad) {
    lag_sim_free(s);
    return NULL;
  }
  free_modes(s);
  return s;
}

lag_sim *lag_sim_new(const lag_scene *scene) {
  if (!scene || !scene->model) return NULL;
  const lag_method *method = lag_find_method(scene->method), *chosen = method ? method : lag_methods[0];
  lag_sim *s = allocate(scene, scene->tolerance > 0 ? scene->tolerance : 1e-9, chosen, NULL);
  if (!s) return NULL;
  if ((method || !scene->method) &&
      lag_sim_set_method(s, chosen, scene->options, method ? scene->noptions : 0) == LAG_ENOMEM) {
    lag_sim_free(s);
    return NULL;
  }
  if (scene->params) scene->params(scene, s->p, s->fixed);
  lag_asked_start(s);
  return s;
}

/* The values of `from`: parameters, inputs, start. Its contacts are those of its present state: all are open here. */
static void copy_values(const lag_sim *from, lag_sim *s) {
  const lag_model *m = s->scene->model;
  memcpy(s->p, from->p, (size_t)m->np * sizeof *s->p);
  memcpy(s->derived, from->derived, (size_t)m->nderived * sizeof *s->p);
  memcpy(s->fixed, from->fixed, (size_t)m->np);
  memcpy(s->start, from->start, (size_t)s->pb.n * sizeof *s->start);
  memcpy(s->hold, from->hold, (size_t)m->nu * sizeof *s->hold);
  memcpy(s->signal, from->signal, (size_t)m->nu * sizeof *s->signal);
  for (const lag_contact *c = m->contacts; c < m->contacts + m->ncontacts; c++) {
    s->hold[c->input] = NAN;
    if (c->is_tangent) s->hold[c->force] = NAN;
  }
}

lag_sim *lag_sim_like(const lag_sim *from) {
  lag_sim *s = from ? allocate(from->scene, from->tol, from->method, from->options) : NULL;
  if (!s) return NULL;
  copy_values(from, s);
  s->steps_equal = s->options && lag_equal_step(s) > 0;
  lag_asked_start(s);
  return s;
}

/* Ends the run: what it allocated beside the blocks of the simulation. */
static void end_run(lag_sim *s) {
  if (s->run && s->run->begun != 0.0 && s->method->fini) s->method->fini(s->method_work);
  lag_tangent_free(s);
}

lag_sim *lag_sim_renew(lag_sim *s, const lag_sim *from) {
  if (!s || !s->fresh || s->like != from) {
    lag_sim_free(s);
    s = lag_sim_like(from);
    if (!s || s->method->flags & LAG_METHOD_IMPULSES || !(s->fresh = malloc(sizeof *s))) return s;
    s->like = from;
    *s->fresh = *s;
    return s;
  }
  end_run(s);
  clear_scratch(s);
  *s = *s->fresh;
  memset(s->saved, 0, (s->nsaved - (s->method->head ? s->nwork - s->method->head : 0)) * sizeof *s->saved);
  memset(s->meeting_of, 0, (3 * (size_t)s->scene->model->nmodes + 1) * sizeof *s->meeting_of);
  begin_blocks(s);
  free_modes(s);
  copy_values(from, s);
  lag_asked_start(s);
  return s;
}

void lag_sim_free(lag_sim *s) {
  if (!s) return;
  end_run(s);
  lag_free_all(s->fresh, s->options, s->fixed, s->start, s->signal, s->meeting_of, s->alike, s->pb.contact_room,
               s->scratch, s->room, s);
}

static int begun(lag_sim *s) {
  return s->run->begun != 0.0 ? lag_fail(s, LAG_EINVAL, "the run has begun: set this before the first step") : 0;
}

int lag_sim_set_method(lag_sim *s, const lag_method *method, const lag_option *opt, int nopt) {
  if (!s) return LAG_EINVAL;
  if (!method || nopt < 0 || (nopt > 0 && !opt)) return lag_fail(s, LAG_EINVAL, "no method, or no array of options");
  int rc = begun(s);
  double *values;

  if (rc) return rc;
  if ((rc = lag_method_check(s, method)) != 0) return rc;
  values = default_options(method);
  rc = values ? lag_method_read_options(s, method, opt, nopt, values) : LAG_ENOMEM;
  rc = rc ? rc : set_blocks(s, method, values);
  if (rc) {
    free(values);
    return rc == LAG_ENOMEM ? lag_fail(s, rc, "out of memory") : rc;
  }
  lag_tangent_free(s);
  free(s->options);
  s->options = values;
  s->steps_equal = lag_equal_step(s) > 0;
  lag_asked_start(s);
  return LAG_OK;
}

int lag_sim_set_tolerance(lag_sim *s, double tol) {
  if (!s) return LAG_EINVAL;
  int rc = begun(s);

  if (rc) return rc;
  if (!(tol > 0 && isfinite(tol)))
    return lag_fail(s, LAG_EINVAL, "a tolerance of %g: it must be positive, for example 1e-9", tol);
  if (tol >= 1)
    return lag_fail(s, LAG_EINVAL,
                    "a tolerance of %g leaves no digit: it is the relative error of a step, for example 1e-9", tol);
  if (tol < 4.5 * DBL_EPSILON) {
    return lag_fail(s, LAG_EINVAL,
                    "a tolerance of %g is below what " LAG_PRECISION
                    " precision can give: write %.0e or more" LAG_MORE_PRECISION,
                    tol, 4.51 * DBL_EPSILON);
  }
  s->tol = s->pb.tol = tol;
  return LAG_OK;
}

static int sign_ok(int sign, double x) {
  return sign == 1 ? x > 0 : sign == 2 ? x >= 0 : sign == -1 ? x < 0 : sign == -2 ? x <= 0 : 1;
}

static const char *sign_text(int sign) { return sign == 1 ? "> 0" : sign == 2 ? ">= 0" : sign == -1 ? "< 0" : "<= 0"; }

/* The quantity of first order whose rate `name` would be, as x of x'; NULL: none. */
static const char *rate_of(const lag_model *m, const char *name) {
  size_t n = strlen(name) - 1;
  for (int i = 0; i < m->nz; i++)
    if (name[n] == '\'' && strncmp(m->z[i].name, name, n) == 0 && !m->z[i].name[n]) return m->z[i].name;
  return NULL;
}

static int unknown_name(lag_sim *s, const char *name) {
  const lag_model *m = s->scene->model;
  const char *of = name[0] ? rate_of(m, name) : NULL;
  if (of)
    return lag_fail(
        s, LAG_EINVAL,
        "%s: the rate of %s follows from the equations of model %s: set %s, or where H is given its momentum", name, of,
        m->name, of);
  return lag_no_such_name(s, name, "set", "parameter, coordinate or input");
}

/* A value in the declared unit of var, converted to SI; the offset of a unit does not apply to rates. */
static double in_si(int kind, const lag_var *var, double value) {
  return value * var->factor + (kind == LAG_IS_V ? 0 : var->offset);
}

/* Whether var may have `value`, in its declared unit. */
static int check_value(lag_sim *s, int kind, const lag_var *var, const char *name, double value) {
  if (!isfinite(value)) return lag_fail(s, LAG_EINVAL, "%s = %g: not a finite number", name, value);
  if (kind == LAG_IS_U && strchr(var->name, '\''))
    return lag_fail(
        s, LAG_EINVAL,
        "%s is the rate of an input, and follows from it; hold the input, or give both a function (lag_sim_set_input)",
        name);
  if (kind == LAG_IS_P && !sign_ok(var->sign, in_si(kind, var, value)))
    return lag_fail(s, LAG_EINVAL, "%s = %g: the model declares %s %s", name, value, var->name, sign_text(var->sign));
  return LAG_OK;
}

/* Sets parameter, input constant or start i to a value in SI. */
static void give(lag_sim *s, int kind, int i, double value) {
  int nq = s->pb.nq;
  switch (kind) {
  case LAG_IS_P:
    s->p[i] = value;
    s->fixed[i] = 1;
    break;
  case LAG_IS_U: /* what is held has no rate */
    for (; i >= 0; i = lag_input_rate(s->scene->model, i), value = 0) {
      s->hold[i] = value;
      s->signal[i] = (lag_signal){0};
    }
    break;
  default:
    s->start[kind == LAG_IS_Q ? i : kind == LAG_IS_V ? nq + i : 2 * nq + i] = value;
  }
}

/* Sets all members of the family `name`. 0: no such family; < 0: the value is not allowed. */
static int set_family(lag_sim *s, const char *name, double value) {
  const lag_model *m = s->scene->model;
  size_t n = strlen(name);
  int velocity = n > 1 && name[n - 1] == '\'', found = 0;
  const struct {
    int kind, n;
    const lag_var *vars;
  } tables[] = {{LAG_IS_P, m->np, m->p}, {velocity ? LAG_IS_V : LAG_IS_Q, m->nq, m->q}, {LAG_IS_Z, m->nz, m->z}};

  for (size_t k = 0; k < sizeof tables / sizeof *tables; k++)
    for (int i = 0; i < tables[k].n; i++) {
      const lag_var *var = &tables[k].vars[i];
      if (!lag_is_member(var->name, name, n - (tables[k].kind == LAG_IS_V))) continue;
      int rc = found ? LAG_OK : check_value(s, tables[k].kind, var, name, value); /* all members share unit and sign */
      if (rc) return rc;
      give(s, tables[k].kind, i, in_si(tables[k].kind, var, value));
      found = 1;
    }
  return found;
}

/* full := the full name of the family `name` of one effect. 0: no effect, or more than one, has it. */
static int effects_family(const lag_model *m, const char *name, char *full, size_t nfull) {
  int known = 0;
  for (int i = 0; i < m->np; i++) {
    const char *var = m->p[i].name, *own = lag_name_in_effect(var);
    if (!own || !lag_is_member(own, name, strlen(name))) continue;
    size_t effect = (size_t)(own - var);
    if (known && strncmp(full, var, effect) != 0) return 0;
    snprintf(full, nfull, "%.*s%s", (int)effect, var, name);
    known = 1;
  }
  return known;
}

int lag_sim_set(lag_sim *s, const char *name, double value) {
  if (!s) return LAG_EINVAL;
  if (!name) return lag_fail(s, LAG_EINVAL, "a value without a name");
  const lag_model *m = s->scene->model;
  const lag_var *var = NULL;
  int i, rc = begun(s), kind = lag_find_name(m, name, &i, &var);

  if (rc == 0 && kind == LAG_IS_NOTHING) {
    char full[128];
    rc = set_family(s, name, value);
    if (rc == 0 && effects_family(m, name, full, sizeof full)) rc = set_family(s, full, value);
    rc = rc == 0 ? unknown_name(s, name) : rc > 0 ? LAG_OK : rc;
  } else if (rc == 0 && (rc = check_value(s, kind, var, name, value)) == 0) {
    give(s, kind, i, in_si(kind, var, value));
  }
  if (rc) return rc;
  if (s->scene->params) {
    s->scene->params(s->scene, s->p, s->fixed); /* parameters may depend on this one */
  }
  lag_asked_start(s);
  return LAG_OK;
}

int lag_sim_set_input(lag_sim *s, const char *name, lag_input_fn *fn, void *context) {
  if (!s) return LAG_EINVAL;
  if (!name) return lag_fail(s, LAG_EINVAL, "an input without a name");
  const lag_var *var = NULL;
  int i, rc = begun(s), kind = lag_find_name(s->scene->model, name, &i, &var);

  if (rc) return rc;
  if (kind != LAG_IS_U)
    return kind == LAG_IS_NOTHING ? unknown_name(s, name)
                                  : lag_fail(s, LAG_EINVAL, "%s is not an input; set it by lag_sim_set", name);
  lag_signal before = s->signal[i];
  s->signal[i] = (lag_signal){fn, context};
  /* the method may need a fact that an input function takes away */
  if (s->options && (rc = lag_method_check(s, s->method)) != 0) {
    s->signal[i] = before;
    return rc;
  }
  s->hold[i] = NAN;
  for (int k = lag_input_rate(s->scene->model, i); k >= 0; k = lag_input_rate(s->scene->model, k)) s->hold[k] = NAN;
  return LAG_OK;
}

/* Refuses an input that has a function where its rate has none, or the reverse. */
static int check_rates(lag_sim *s) {
  const lag_model *m = s->scene->model;
  for (int i = 0; i < m->nu; i++) {
    int rate = lag_input_rate(m, i);
    if (rate < 0 || !s->signal[i].fn == !s->signal[rate].fn) continue;
    return lag_fail(s, LAG_EINVAL, "the motion depends on %s, too: give it a function as %s has (lag_sim_set_input)",
                    m->u[s->signal[i].fn ? rate : i].name, m->u[s->signal[i].fn ? i : rate].name);
  }
  return LAG_OK;
}

/* Refuses sizes of friction, inertia or coefficients that are negative, or too large; at time t, NaN: at all times. */
static int judge_sizes(lag_sim *s, int n, const lag_size *of, const double *size, double t) {
  char when[64] = "";
  if (!isnan(t)) snprintf(when, sizeof when, "at t = %s s ", LAG_TEXT(t));
  for (int i = 0; i < n; i++) {
    if (!(of[i].part && size[i] > 1) && (of[i].open ? size[i] > 0 : size[i] >= 0)) continue;
    return lag_fail(s, s->run->begun == 0.0 ? LAG_EINVAL : LAG_EDOMAIN, "%s%s of %.6g, which must be %s: it is %s",
                    when, of[i].what, size[i],
                    of[i].part   ? "between 0 and 1"
                    : of[i].open ? "more than 0"
                                 : "at least 0",
                    of[i].text);
  }
  return LAG_OK;
}

int lag_check_parameters(lag_sim *s) {
  const lag_model *m = s->scene->model;
  const double *y = s->begin;
  for (int i = 0; i < m->np; i++)
    if (!sign_ok(m->p[i].sign, s->p[i])) {
      return lag_fail(s, LAG_EINVAL, "%s = %g: the model declares %s %s", m->p[i].name, lag_declared(&m->p[i], s->p[i]),
                      m->p[i].name, sign_text(m->p[i].sign));
    }
  int rc =
      m->nsizes ? m->size_values(m, s->scene->t0, y, y + m->nq, y + 2 * m->nq, s->p, s->pb.u, s->sizes, s->pb.work) : 0;
  return rc ? rc : judge_sizes(s, m->nsizes, m->sizes, s->sizes, NAN);
}

int lag_check_moving_sizes(lag_sim *s, double t, const double *y) {
  const lag_model *m = s->scene->model;
  if (!m->nmoving) return LAG_OK;
  double *size = s->sizes;
  int rc = lag_inputs_at(&s->pb, t, y);
  rc = rc ? rc : m->moving_sizes(m, t, y, y + m->nq, y + 2 * m->nq, s->p, s->pb.u, size, s->pb.work);
  return rc ? LAG_OK : judge_sizes(s, m->nmoving, m->sizes + m->nsizes, size, t);
}

int lag_setup_start(lag_sim *s) {
  int rc = lag_method_check_digits(s, s->method);
  rc = rc ? rc : lag_check_parameters(s);
  rc = rc ? rc : check_rates(s);
  return rc ? rc : lag_start_state(s);
}

int lag_start_state(lag_sim *s) {
  const lag_scene *c = s->scene;
  int n = s->pb.n, rc;
  lag_asked_start(s);
  const int bad = lag_not_finite(n, s->now);
  if (bad >= 0) {
    char name[160] = "";
    lag_sim_state_info(s, bad, name, sizeof name, NULL, 0);
    return lag_fail(s, LAG_ENAN, "the start of `%s` is not finite", name);
  }
  memcpy(s->begin, s->now, (size_t)n * sizeof(double)); /* the requested start gives the scales of quantities */
  if ((rc = lag_conditional_place(s, c->t0, s->now)) != 0 || (rc = lag_consistent_start(s)) != 0) return rc;
  memcpy(s->begin, s->now, (size_t)n * sizeof(double));
  memcpy(s->y, s->now, (size_t)n * sizeof(double));
  s->run->t = s->run->from = c->t0;
  return LAG_OK;
}
