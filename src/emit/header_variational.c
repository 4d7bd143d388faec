/* Steps of an emitted header by the variational integrator. Enters: the unit's derivatives of L. Leaves: the memory
 * of the method, its prototypes and functions. Holds: each step has the digits of the runtime's, whose text it carries
 * (kernels/galerkin_step.h, galerkin_rule.h, predictor.h); it has one rule and no constraints. */
#include "emit/header_impl.h"

static const char *const orders =
    " |\n"
    " |/* The highest order of _variational_step: 2, 4, 6 or 8. */\n"
    " |#ifndef LAG_VARIATIONAL_ORDER\n"
    " |#define LAG_VARIATIONAL_ORDER 8\n"
    " |#endif\n"
    " |enum {\n"
    " |  LAG_RULE_FREE = LAG_VARIATIONAL_ORDER/2, /* Gauss points a step */\n"
    " |  LAG_NNEWTON = LAG_RULE_FREE*LAG_NQ,      /* unknowns of Newton's method */\n"
    " |  LAG_NBAND = 3*LAG_RULE_FREE*BAND - 2 < LAG_NNEWTON ? 3*LAG_RULE_FREE*BAND - 2 : LAG_NNEWTON /* numbers in a "
    "row of its matrix */\n"
    " |};\n"
    " |\n"
    " |/* Points, weights and Lagrange polynomials of a discrete Lagrangian. */\n";

static const char *const memory =
    " |/* Memory of _variational_step: sizeof(lag_variational); a smaller LAG_VARIATIONAL_ORDER takes less. "
    "_variational_begin fills it. The momenta are\n"
    " | * carried from step to step; a state that is not the one of the last step begins anew. After a change of "
    "parameters call _variational_begin. */\n"
    " |typedef struct lag_variational {\n"
    " |  LAG_REAL ready;   /* 1: the momenta belong to q and v */\n"
    " |  LAG_REAL epsilon; /* rounding of the scalar */\n"
    " |  LAG_REAL t, q[LAG_NQ], v[LAG_NQ], p[LAG_NQ], lost[LAG_NQ]; /* the end of the last step; rounding that sums of "
    "p have lost */\n"
    " |  LAG_REAL dq[LAG_NQ], dp[LAG_NQ], ql[LAG_NQ], pl[LAG_NQ], next[LAG_NQ]; /* increments in a step; v at its end "
    "*/\n"
    " |  LAG_REAL x[LAG_NNEWTON], force[LAG_NNEWTON], room[5*LAG_NQ + (4 + LAG_NBAND)*LAG_NNEWTON + NSECOND];\n"
    " |  lag_rule rule, momentum; /* of a step; of v from p */\n"
    " |  LAG_REAL past[2 + 9*LAG_NNEWTON], past_v[2 + 9*LAG_NQ]; /* values of steps before, from which the next is "
    "guessed */\n"
    " |} lag_variational;\n"
    " |\n"
    " |/* Before the first step; order: 2, 4, 6 or 8. LAG_ENEWTON: another, or above LAG_VARIATIONAL_ORDER. */\n"
    " |LAG_API int lag_variational_begin(lag_variational *w, int order);\n"
    " |\n"
    " |/* A step h by a discrete Lagrangian and Newton's method: symplectic, also where the mass matrix or forces "
    "depend on q and q'. Steps of equal size\n"
    " | * take the fewest iterations. LAG_ENEWTON: Newton's method does not converge; take smaller steps. On failure "
    "*s is as it was.\n"
    "u| * u: the inputs, constant during the step; 0 for the model's formulas.\n"
    " | */\n"
    " |LAG_API int lag_variational_step(const lag_params *p, lag_state *s, lag_variational *w, LAG_REAL hINPUT);\n"
    "u|\n"
    "u|/* The same with inputs that change during the step. */\n"
    "u|LAG_API int lag_variational_step_with(const lag_params *p, lag_state *s, lag_variational *w, LAG_REAL h,\n"
    "u|    lag_input_fn *input, void *context);\n";

static const char *const begin =
    " |\n"
    " |LAG_API int lag_variational_begin(lag_variational *w, int order) {\n"
    " |  if (order < 2 || order > LAG_VARIATIONAL_ORDER || order%2) return LAG_ENEWTON;\n"
    " |  w->ready = LAG_C(0.0);\n"
    " |  w->epsilon = lag_epsilon();\n"
    " |  lag_rule_gauss(&w->rule, order/2);\n"
    " |  lag_rule_euler(&w->momentum, LAG_C(0.0));\n"
    " |  return LAG_OK;\n"
    " |}\n"
    " |\n"
    " |enum { LAG_QQ, LAG_VQ, LAG_VV, LAG_FQ, LAG_FV };\n"
    " |typedef struct lag_second { unsigned short part, row, col; } lag_second;\n"
    " |static const lag_second lag_second_at[] = {SECOND_AT};\n"
    " |#define LAG_MODEL const lag_params *pHELD\n"
    " |#define LAG_THE_MODEL pPASS\n"
    " |#define LAG_COORDINATES(w) LAG_NQ\n"
    " |#define LAG_VARIATION(t, w) lag_variation(t, (w)->Q, (w)->V, pAT_T, (w)->Lq, (w)->Lv, (w)->F)\n"
    " |#define LAG_SECOND(t, w) lag_second_derivatives(t, (w)->Q, (w)->V, pAT_T, (w)->second)\n"
    " |#define LAG_NEWTON_SOLVES(d) (void)d\n"
    " |#define LAG_NEWTON_CORRECTS(d) (void)d\n"
    " |#define LAG_NEWTON_INFINITE(d, w) ((int)LAG_ENEWTON)\n"
    " |#define LAG_NEWTON_LEAVES(d, w, status) (status)\n"
    " |#define LAG_NEWTON_SINGULAR(d, w) ((int)LAG_ENEWTON)\n"
    " |#define LAG_NEWTON_FAILS(d, w) ((int)LAG_ENEWTON)\n";

static const char *const steps =
    " |\n"
    " |/* The momenta of *s, where it is not the end of the last step. */\n"
    " |static int lag_variational_ready(const lag_params *p, const lag_state *s, lag_variational *wHELD) {\n"
    " |  LAG_REAL finite = LAG_C(0.0), Lq[LAG_NQ], Q[LAG_NQ];\n"
    "u|  LAG_REAL now[LAG_NU];\n"
    " |  for (int i = 0; i < LAG_NQ; i++)\n"
    " |    if (!(s->q[i] == w->q[i] && s->v[i] == w->v[i] && s->t == w->t)) w->ready = LAG_C(0.0);\n"
    " |  if (w->ready > LAG_C(0.0)) return LAG_OK;\n"
    " |  const int status = lag_variation(s->t, s->q, s->v, pAT_STATE, Lq, w->p, Q);\n"
    " |  if (status != LAG_OK) return status;\n"
    " |  for (int i = 0; i < LAG_NQ; i++) {\n"
    " |    w->lost[i] = LAG_C(0.0);\n"
    " |    finite += w->p[i]*LAG_C(0.0);\n"
    " |  }\n"
    " |  w->past[0] = w->past_v[0] = LAG_C(0.0); /* no values are known */\n"
    " |  if (!(finite == LAG_C(0.0))) return LAG_ENEWTON;\n"
    " |  return LAG_OK;\n"
    " |}\n"
    " |\n"
    " |static void lag_increments(const lag_state *s, lag_variational *w) {\n"
    " |  for (int i = 0; i < LAG_NQ; i++) {\n"
    " |    w->ql[i] = s->lost[1 + i] + w->dq[i];\n"
    " |    w->pl[i] = w->lost[i] + w->dp[i];\n"
    " |  }\n"
    " |}\n"
    " |\n"
    " |/* The velocities in the step from those of the steps before, or from the accelerations. */\n"
    " |static int lag_variational_solve(const lag_params *p, const lag_state *s, const LAG_REAL *past,\n"
    " |    const lag_discrete *d, lag_discrete_room *wHELD) {\n"
    " |  const int m = (int)d->rule->free*LAG_NQ;\n"
    " |  LAG_REAL a[LAG_NQ];\n"
    " |  if (lag_predictor_guess(past, m, d->u) && lag_discrete_newton(LAG_THE_MODEL, d, w) == LAG_OK) return LAG_OK;\n"
    " |  const int status = lag_accel(d->t, s->q, s->v, pAT_START, a);\n"
    " |  if (status != LAG_OK) return status;\n"
    " |  for (int k = 0; k < m; k++) d->u[k] = s->v[k%LAG_NQ] + d->h*d->rule->node[k/LAG_NQ]*a[k%LAG_NQ];\n"
    " |  return lag_discrete_newton(LAG_THE_MODEL, d, w);\n"
    " |}\n"
    " |\n"
    " |STEP(const lag_params *p, lag_state *s, lag_variational *w, LAG_REAL hHELD) {\n"
    " |  const int m = (int)w->rule.free*LAG_NQ;\n"
    " |  lag_state end = *s;\n"
    " |  lag_discrete d = {&w->rule, s->t, h, LAG_FN(fabs)(h), s->q, w->ql, w->p, w->pl, w->x, w->force, w->room, 0};\n"
    " |  lag_discrete_room r;\n"
    "u|  LAG_REAL now[LAG_NU];\n"
    " |  int status = lag_variational_ready(p, s, wPASS);\n"
    " |  w->ready = LAG_C(0.0); /* until the step is done */\n"
    " |  if (status != LAG_OK) return status;\n"
    " |  end.t = lag_compensated_sum(s->t, h, &end.lost[0]);\n"
    " |  r.n = LAG_NQ, r.half = BAND - 1, r.nsecond = NENTRIES, r.at = lag_second_at, r.epsilon = w->epsilon;\n"
    "u|  r.now = now;\n"
    " |  lag_discrete_place(&d, &r);\n"
    " |  for (int i = 0; i < LAG_NQ; i++) w->dq[i] = w->dp[i] = LAG_C(0.0);\n"
    " |  lag_increments(s, w);\n"
    " |  LAG_TRY(lag_variational_solve(p, s, w->past, &d, &rPASS));\n"
    " |  lag_discrete_move(&d, LAG_NQ, w->dq, w->dp);\n"
    " |  lag_predictor_add(w->past, m, w->x);\n"
    " |  lag_increments(s, w);\n"
    " |  d.rule = &w->momentum, d.t = end.t, d.h = LAG_C(0.0), d.u = w->next; /* the velocity at the end */\n"
    " |  lag_discrete_place(&d, &r);\n"
    " |  if (!lag_predictor_guess(w->past_v, LAG_NQ, w->next))\n"
    " |    for (int i = 0; i < LAG_NQ; i++) w->next[i] = w->x[i];\n"
    " |  LAG_TRY(lag_discrete_newton(LAG_THE_MODEL, &d, &r));\n"
    " |  lag_predictor_add(w->past_v, LAG_NQ, w->next);\n"
    " |  for (int i = 0; i < LAG_NQ; i++) {\n"
    " |    w->q[i] = end.q[i] = lag_compensated_sum(s->q[i], w->dq[i], &end.lost[1 + i]);\n"
    " |    w->p[i] = lag_compensated_sum(w->p[i], w->dp[i], &w->lost[i]);\n"
    " |    w->v[i] = end.v[i] = w->next[i];\n"
    " |    end.lost[1 + LAG_NQ + i] = LAG_C(0.0);\n"
    " |  }\n"
    " |  LAG_TRY(lag_check(&end));\n"
    " |  w->t = end.t;\n"
    " |  w->ready = LAG_C(1.0);\n"
    " |  *s = end;\n"
    " |  return LAG_OK;\n"
    " |}\n"
    "u|\n"
    "u|LAG_API int lag_variational_step(const lag_params *p, lag_state *s, lag_variational *w, LAG_REAL h, const "
    "LAG_REAL *u) {\n"
    "u|  return lag_variational_advance(p, s, w, h, u, 0, 0);\n"
    "u|}\n"
    "u|\n"
    "u|LAG_API int lag_variational_step_with(const lag_params *p, lag_state *s, lag_variational *w, LAG_REAL h,\n"
    "u|    lag_input_fn *input, void *context) {\n"
    "u|  return lag_variational_advance(p, s, w, h, 0, input, context);\n"
    "u|}\n";

/* One more than the half-bandwidth of the second derivatives, in the order in which coordinates are declared. */
static uint32_t band(const ProgramSet *u) {
  uint32_t most = 0;
  for (uint32_t k = 0; k < u->second_at.n; k++) {
    const IrSecond *s = &u->second_at.at[k];
    uint32_t d = s->row > s->col ? s->row - s->col : s->col - s->row;
    most = d > most ? d : most;
  }
  return most + 1;
}

static const char *positions(const Header *h) {
  const ProgramSet *u = h->u;
  StrBuf b = strbuf(h->a);
  for (uint32_t k = 0; k < u->second_at.n; k++) {
    const IrSecond *s = &u->second_at.at[k];
    sb_printf(&b, "%s{%d, %u, %u}", !k ? "" : k % 8 ? ", " : ",\n    ", s->part, s->row, s->col);
  }
  return u->second_at.n ? sb_text(&b) : "{0, 0, 0}";
}

static void write(const Header *h, const char *text) {
  const ProgramSet *u = h->u;
  uint32_t n = u->second_at.n;
  const HeaderWord words[] = {
      {"BAND", arena_printf(h->a, "%u", band(u))},
      {"NSECOND", arena_printf(h->a, "%u", n ? n : 1)},
      {"NENTRIES", arena_printf(h->a, "%u", n)},
      {"SECOND_AT", positions(h)},
      {"STEP", u->u.n ? "static int lag_variational_advance" : "LAG_API int lag_variational_step"},
      {"AT_STATE", u->u.n ? ", lag_held(p, s->t, u, input, context, now)" : ""},
      {"AT_START", u->u.n ? ", lag_held(p, d->t, u, input, context, w->now)" : ""},
      {"AT_T", u->u.n ? ", lag_held(p, t, u, input, context, (w)->now)" : ""},
      {"INPUT", u->u.n ? ", const LAG_REAL *u" : ""},
      {NULL, NULL}};
  header_template(h, text, words);
}

void header_variational_declare(const Header *h) {
  write(h, orders);
  header_section(h, "rule");
  write(h, memory);
}

void header_variational_define(const Header *h) {
  static const char *const first[] = {"Lq", "Lv", "Q", NULL}, *const second[] = {"h", NULL};
  const ProgramSet *u = h->u;
  const char *R = h->upper, *state = header_state_args(h, 1, "");
  const char *head =
      arena_printf(h->a, "static int %s_variation(%s, %s_REAL *Lq, %s_REAL *Lv, %s_REAL *Q)", h->lower, state, R, R, R);
  header_state_function(h, u->variation, "dL/dq, the momenta dL/dq', and the generalised forces outside of L.",
                        header_wrapped(h, head), first, first, 1);
  head = arena_printf(h->a, "static int %s_second_derivatives(%s, %s_REAL *h)", h->lower, state, R);
  header_state_function(h, u->second, "Their nonzero derivatives.", header_wrapped(h, head), second, second, 1);
  header_section(h, "rule: tables");
  write(h, begin);
  header_section(h, "predictor");
  header_section(h, "band_matrix");
  header_section(h, "newton");
  header_section(h, "discrete");
  write(h, steps);
}
