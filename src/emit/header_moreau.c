/* Steps of an emitted header by Moreau's method. Enters: the unit's contacts, their laws and matrices. Leaves: what
 * the state says of contacts, prototypes and functions of the steps. Holds: each step has the digits of the
 * runtime's, whose laws and sweeps it carries (kernels/impulses.h, band_matrix.h); the frame around them is that of
 * methods/moreau.c and moreau_contacts.c, which give the reasons. */
#include "emit/header_impl.h"

/* --- declarations --- */

static const char *name_of(const Header *h, uint32_t i) {
  return h->u->constraints.of.at[h->u->contacts.at[i].constraint].name;
}

static void contact_indices(const Header *h) {
  uint32_t n = h->u->contacts.n;
  sb_puts(h->out, "\n/* Contacts, for touch, struck and impulse of the state; behind each with friction the velocities "
                  "of slipping along its surface. */\nenum {\n");
  for (uint32_t i = 0; i < n; i++)
    sb_printf(h->out, "  %s = %u, /* %s */\n", h->contacts[i], i, comment_text(h->a, name_of(h, i)));
  sb_printf(h->out, "  %s_NCONTACTS = %u\n};\n", h->upper, n);
}

static void contact_members(const Header *h) {
  csupport_expand(
      "  LAG_REAL touch[LAG_NCONTACTS];   /* in the last _moreau_step: LAG_OPEN, LAG_SLIPS, LAG_STICKS */\n"
      "  LAG_REAL struck[LAG_NCONTACTS];  /* velocity with which a gap closed, of an impact in that step; else 0 */\n"
      "  LAG_REAL impulse[LAG_NCONTACTS]; /* of a gap, and of friction along its velocity of slipping; the next step "
      "begins with them */\n",
      h->upper, h->lower, h->out);
}

static const char *const prototypes =
    " |\n"
    "c|/* The impulses of contacts do not agree, nothing can keep a gap from closing, or a value is not finite. */\n"
    "d|/* Forces of dry friction do not agree, or a value is not finite. */\n"
    " |enum { LAG_ECONTACT = -6 };\n"
    " |\n"
    "c|/* A step h by Moreau's time-stepping: all contacts act by impulses at its middle, with friction, however many "
    "they are; no impact is located. Order 2\n"
    "c| * where none occurs. touch, struck and impulse of the state tell what each contact did; a copy of the state "
    "goes on with the same digits.\n"
    "c| * LAG_ENEWTON: forces change too much in the step. A shorter step may help then, as where LAG_ECONTACT says "
    "that impulses do not agree. On failure\n"
    "c| * *s is as it was. u: the inputs, constant during the step; 0 for the model's formulas. Inputs that close "
    "contacts are not read. */\n"
    "d|/* A step h by Moreau's time-stepping: a body that would turn within the step sticks at its end, as long as "
    "static friction holds it; else it slips. Order 2\n"
    "d| * but for steps in which a body begins or ends to stick. touch and mode of the state tell which; a copy of the "
    "state goes on with the same digits.\n"
    "d| * LAG_ENEWTON: forces change too much in the step; a shorter one may help. On failure *s is as it "
    "was.OF_INPUTS */\n"
    " |LAG_API int lag_moreau_step(const lag_params *p, lag_state *s, LAG_REAL hINPUT);\n"
    "u|\n"
    "u|/* The same with inputs that change from step to step; they are taken at the middle of each. */\n"
    "u|LAG_API int lag_moreau_step_with(const lag_params *p, lag_state *s, LAG_REAL h, lag_input_fn *input, void "
    "*context);\n";

/* --- definitions --- */

static const char *const tables =
    " |\n"
    " |/* Of a contact: the input that closes it, its constraint, the input of its force, its velocities of slipping; "
    "these have -1 there. */\n"
    " |static const short lag_contact_at[][4] = {AT_CONTACTS};\n"
    " |\n"
    " |/* Positions of the entries of the constraints' Jacobian and of the mass matrix. */\n"
    " |static const unsigned short lag_contact_jacobian[][2] = {JACOBIAN}, lag_contact_mass[][2] = {ENTRIES};\n"
    " |\n"
    " |/* Room of a step. Rows are those of the contacts that take part, of[n]. */\n"
    " |typedef struct lag_moreau_room {\n"
    " |  LAG_REAL n, rows, impacts, epsilon;\n"
    " |  lag_pressing of[LAG_NCONTACTS];\n"
    " |  LAG_REAL afirst[LAG_NCONTACTS + 1], acol[NJACOBIAN], avalue[NJACOBIAN], dfirst[LAG_NCONTACTS + 1], "
    "dcol[NRESPONSES], dvalue[NRESPONSES];\n"
    " |  LAG_REAL response[LAG_NCONTACTS], b[LAG_NCONTACTS], P[LAG_NCONTACTS], before[LAG_NCONTACTS + 1]; /* before: "
    "rates at the begin */\n"
    " |  LAG_REAL c[LAG_NC], r0[LAG_NC], r1[LAG_NC], pace[LAG_NC], bend[LAG_NC]; /* gaps, rates at the begin, at the "
    "end without contacts, what forces and curvature change them by, curvature in half a step */\n"
    " |  LAG_REAL d[LAG_NQ], jacobian[NJACOBIAN], mass[NMASS], now[LAG_NU];\n"
    "b|  LAG_REAL band[NBAND], pivot[LAG_NQ], scale[LAG_NQ];\n"
    " |} lag_moreau_room;\n";

static const char *const inputs =
  " |\n"
  " |/* now := the inputs at time t, with contact `only` closed, or -1: all of them, -2: none. */\n"
  " |static void lag_contact_inputs(const lag_params *p, LAG_REAL tHELD, int only, LAG_REAL *now) {\n"
  " |  const LAG_REAL *const x = lag_held(p, t, u, input, context, now);\n"
  " |  for (int i = 0; i < LAG_NU && x != now; i++) now[i] = x[i];\n"
  " |  for (int i = 0; i < LAG_NCONTACTS; i++) {\n"
  " |    now[lag_contact_at[i][0]] = only == -1 || only == i ? LAG_C(1.0) : LAG_C(0.0);\n"
  " |    if (lag_contact_at[i][3] < 0) now[lag_contact_at[i][2]] = LAG_C(0.0);\n"
  " |  }\n"
  " |}\n";

static const char *const respond_alone =
    " |\n"
    "b|static lag_band_matrix lag_contact_band(lag_moreau_room *w) {\n"
    "b|  const lag_band_matrix M = {LAG_NQ, BANDWIDTH, w->band, w->pivot};\n"
    "b|  return M;\n"
    "b|}\n"
    "b|\n"
    "b|static int lag_contact_factor(lag_moreau_room *w) {\n"
    "b|  lag_band_matrix M = lag_contact_band(w);\n"
    "b|  for (int i = 0; i < NBAND; i++) w->band[i] = LAG_C(0.0);\n"
    "b|  for (int e = 0; e < NMASS; e++) {\n"
    "b|    *lag_band_matrix_at(&M, lag_contact_mass[e][0], lag_contact_mass[e][1]) = w->mass[e];\n"
    "b|    *lag_band_matrix_at(&M, lag_contact_mass[e][1], lag_contact_mass[e][0]) = w->mass[e];\n"
    "b|  }\n"
    "b|  return lag_band_matrix_factor(&M, w->scale) ? LAG_ESINGULAR : LAG_OK;\n"
    "b|}\n"
    "b|\n"
    " |/* d := change of velocities by a unit impulse of contact i, whose row of A is `row`. */\n"
    "b|static int lag_contact_respond(lag_moreau_room *w, int row) {\n"
    "b|  lag_band_matrix M = lag_contact_band(w);\n"
    "b|  for (int j = 0; j < LAG_NQ; j++) w->d[j] = LAG_C(0.0);\n"
    "b|  for (int e = (int)w->afirst[row]; e < (int)w->afirst[row + 1]; e++) w->d[(int)w->acol[e]] = w->avalue[e];\n"
    "b|  lag_band_matrix_solve(&M, w->d);\n"
    "b|  return LAG_OK;\n"
    "b|}\n"
    "k|static int lag_contact_respond(const lag_params *p, LAG_REAL tHELD, const LAG_REAL *y, lag_moreau_room *w, int "
    "i, int row) {\n"
    "k|  const lag_sparse_rows A = {w->afirst, w->acol, w->avalue};\n"
    "k|  LAG_REAL g[LAG_NC], effort[LAG_NQ], work = LAG_C(0.0), *const now = w->now;\n"
    "k|  for (int k = 0; k < LAG_NC; k++) g[k] = k == lag_contact_at[i][1] ? LAG_C(1.0) : LAG_C(0.0);\n"
    "k|  lag_contact_inputs(p, tPASS, i, now);\n"
    "k|  const int status = lag_VELOCITY(MID, g, w->d, effort);\n"
    "k|  if (status != LAG_OK) return status;\n"
    "k|  for (int j = 0; j < LAG_NQ; j++) work += w->d[j]*effort[j];\n"
    "k|  const int moves = work > LAG_C(0.0) && LAG_FN(fabs)(lag_row_product(&A, row, w->d) - LAG_C(1.0)) < "
    "LAG_C(0.5);\n"
    "k|  for (int j = 0; j < LAG_NQ; j++) w->d[j] = moves ? w->d[j]/work : LAG_C(0.0);\n"
    "k|  return LAG_OK;\n"
    "k|}\n";

static const char *const rows = " |\n"
                                " |/* The next row of A and D, for contact i. */\n"
                                " |static int lag_contact_row(const lag_params *p, LAG_REAL tHELD, const LAG_REAL *y, "
                                "const LAG_REAL *impulse, lag_moreau_room *w, int i) {\n"
                                " |  const int r = (int)w->rows, k = lag_contact_at[i][1];\n"
                                " |  const lag_sparse_rows A = {w->afirst, w->acol, w->avalue};\n"
                                " |  int e = (int)w->afirst[r], f = (int)w->dfirst[r];\n"
                                " |  w->rows += LAG_C(1.0);\n"
                                " |  for (int j = 0; j < NJACOBIAN; j++) {\n"
                                " |    if (lag_contact_jacobian[j][0] != k) continue;\n"
                                " |    w->acol[e] = lag_contact_jacobian[j][1];\n"
                                " |    w->avalue[e++] = w->jacobian[j];\n"
                                " |  }\n"
                                " |  w->afirst[r + 1] = (LAG_REAL)e;\n"
                                "b|  (void)p; (void)t; (void)u; (void)input; (void)context;\n"
                                " |  const int status = lag_contact_respond(RESPOND);\n"
                                " |  if (status != LAG_OK) return status;\n"
                                " |  for (int j = 0; j < LAG_NQ; j++) {\n"
                                " |    if (!(w->d[j] < LAG_C(0.0) || w->d[j] > LAG_C(0.0))) continue;\n"
                                " |    w->dcol[f] = (LAG_REAL)j;\n"
                                " |    w->dvalue[f++] = w->d[j];\n"
                                " |  }\n"
                                " |  w->dfirst[r + 1] = (LAG_REAL)f;\n"
                                " |  w->response[r] = lag_row_product(&A, r, w->d);\n"
                                " |  w->before[r] = w->r0[k];\n"
                                " |  w->b[r] = w->r0[k] - lag_row_product(&A, r, y + LAG_NQ);\n"
                                " |  w->P[r] = impulse[i];\n"
                                " |  return LAG_OK;\n"
                                " |}\n";

static const char *const laws =
    " |\n"
    " |/* *e := restitution of contact i, from its law of impact. */\n"
    " |static int lag_contact_restitution(const lag_params *p, LAG_REAL tHELD, const LAG_REAL *y, lag_moreau_room *w, "
    "int i, LAG_REAL *e) {\n"
    " |  LAG_REAL v1[LAG_NQ], change = LAG_C(0.0), *const now = w->now;\n"
    " |  lag_contact_inputs(p, tPASS, i, now);\n"
    " |  for (int j = 0; j < LAG_NQ; j++) v1[j] = y[LAG_NQ + j];\n"
    " |  const int status = lag_strike(lag_contact_at[i][1], lag_contact_at[i][0], MID, v1);\n"
    " |  for (int j = 0; j < NJACOBIAN; j++)\n"
    " |    if (lag_contact_jacobian[j][0] == lag_contact_at[i][1]) change += "
    "w->jacobian[j]*(v1[lag_contact_jacobian[j][1]] - y[LAG_NQ + lag_contact_jacobian[j][1]]);\n"
    " |  *e = change/-w->r0[lag_contact_at[i][1]] - LAG_C(1.0);\n"
    " |  return status != LAG_OK || lag_is_number(*e) ? status : LAG_ECONTACT;\n"
    " |}\n"
    " |\n"
    " |/* Gaps, their rates at both ends without contacts, what forces and curvature change them by, and matrices. */\n"
    " |static int lag_contact_evaluate(const lag_params *p, LAG_REAL t, LAG_REAL hHELD, const LAG_REAL *y, const "
    "LAG_REAL *free, lag_moreau_room *w) {\n"
    " |  LAG_REAL *const now = w->now;\n"
    " |  lag_contact_inputs(p, t - h/LAG_C(2.0)PASS, -1, now);\n"
    " |  LAG_REAL begin[LAG_NQ];\n"
    " |  for (int i = 0; i < LAG_NQ; i++) begin[i] = y[i] - h/LAG_C(2.0)*y[LAG_NQ + i];\n"
    " |  int status = lag_residuals(BEGIN, w->c, w->bend);\n"
    " |  lag_contact_inputs(p, tPASS, -1, now);\n"
    " |  if (status == LAG_OK) status = lag_residuals(FREE, w->c, w->r1);\n"
    " |  if (status == LAG_OK) status = lag_residuals(MID, w->c, w->r0);\n"
    " |  if (status == LAG_OK) status = lag_contact_matrices(MID, w->jacobian, w->mass);\n"
    " |  if (status != LAG_OK) return status;\n"
    " |  for (int k = 0; k < LAG_NC; k++) {\n"
    " |    w->bend[k] = w->r0[k] - w->bend[k];\n"
    " |    w->pace[k] = LAG_C(2.0)*LAG_FN(fabs)(w->bend[k]);\n"
    " |  }\n"
    " |  for (int e = 0; e < NJACOBIAN; e++) {\n"
    " |    const int j = lag_contact_jacobian[e][1];\n"
    " |    w->pace[lag_contact_jacobian[e][0]] += LAG_FN(fabs)(w->jacobian[e]*(free[j] - y[LAG_NQ + j]));\n"
    " |  }\n"
    " |  for (int i = 0; i < LAG_NCONTACTS; i++) {\n"
    " |    const int k = lag_contact_at[i][1];\n"
    " |    if (!lag_is_number(w->r0[k]) || !lag_is_number(w->r1[k]) || (lag_contact_at[i][3] >= 0 && "
    "!lag_is_number(w->c[k]))) return LAG_ECONTACT;\n"
    " |  }\n"
    " |  return LAG_OK;\n"
    " |}\n";

static const char *const find =
    " |\n"
    " |/* The law of contact i, whose rows are there. */\n"
    " |static int lag_contact_set_law(const lag_params *p, LAG_REAL t, LAG_REAL hHELD, const LAG_REAL *y, const "
    "LAG_REAL *law, lag_moreau_room *w, int i, lag_pressing *c) {\n"
    " |  const int row = (int)c->row, k = lag_contact_at[i][1], strikes = lag_contact_strikes(w->r0[k], w->pace[k]) && "
    "w->response[row] > LAG_C(0.0);\n"
    " |  LAG_REAL e = LAG_C(0.0);\n"
    " |  if (strikes) {\n"
    " |    const int status = lag_contact_restitution(p, tPASS, y, w, i, &e);\n"
    " |    if (status != LAG_OK) return status;\n"
    " |    w->impacts += LAG_C(1.0);\n"
    " |  }\n"
    " |  c->mu = c->tangents > LAG_C(0.0) ? law[2*(i + 1)] : LAG_C(0.0);\n"
    " |  lag_contact_law(c, w->c[k], w->r0[k], w->bend[k], h, e, strikes && c->tangents > LAG_C(0.0) ? law[2*(i + 1) + "
    "1] : LAG_C(0.0), strikes, w->before + row + 1);\n"
    " |  if (!(w->response[row] > LAG_C(0.0)) && w->r1[k] < LAG_C(0.0)) return LAG_ECONTACT;\n"
    " |  return LAG_OK;\n"
    " |}\n"
    " |\n"
    " |/* Chooses the contacts that take part. y: coordinates at the middle of the step, velocities and states at its "
    "begin; free: velocities at its end without contacts. */\n"
    " |static int lag_contact_find(const lag_params *p, LAG_REAL t, LAG_REAL hHELD, const LAG_REAL *y, const LAG_REAL "
    "*free, const LAG_REAL *impulse, lag_moreau_room *w) {\n"
    " |  LAG_REAL law[2*LAG_NCONTACTS + 2] = {0};\n"
    "f|  LAG_REAL *const now = w->now;\n"
    " |  int status = lag_contact_evaluate(p, t, hPASS, y, free, w);\n"
    "f|  if (status == LAG_OK) status = lag_contact_coefficients(MID, law);\n"
    " |  w->n = w->rows = w->afirst[0] = w->dfirst[0] = LAG_C(0.0);\n"
    " |  for (int i = 0; i < LAG_NCONTACTS && status == LAG_OK; i++) {\n"
    " |    const int k = lag_contact_at[i][1], tangents = lag_contact_at[i][3];\n"
    " |    if (tangents < 0 || !lag_contact_takes_part(w->c[k], w->r0[k], w->r1[k], w->pace[k], h)) continue;\n"
    "b|    if (!(w->n > LAG_C(0.0))) status = lag_contact_factor(w);\n"
    " |    lag_pressing *const c = &w->of[(int)w->n];\n"
    " |    w->n += LAG_C(1.0);\n"
    " |    c->contact = (LAG_REAL)i;\n"
    " |    c->row = w->rows;\n"
    " |    c->tangents = (LAG_REAL)tangents;\n"
    " |    for (int j = 0; j <= tangents && status == LAG_OK; j++) status = lag_contact_row(p, tPASS, y, impulse, w, i "
    "+ j);\n"
    " |    if (status == LAG_OK) status = lag_contact_set_law(p, t, hPASS, y, law, w, i, c);\n"
    " |  }\n"
    " |  return status;\n"
    " |}\n"
    " |\n"
    " |/* v: velocities without contacts, then with them. */\n"
    " |static int lag_contact_solve(lag_moreau_room *w, LAG_REAL *v) {\n"
    " |  enum { MOST = 200000 };\n"
    " |  LAG_REAL size = LAG_C(0.0);\n"
    " |  for (int e = 0; e < (int)w->afirst[(int)w->rows]; e++) size = lag_larger(size, "
    "LAG_FN(fabs)(w->avalue[e]*v[(int)w->acol[e]]));\n"
    " |  if (!(w->n > LAG_C(0.0))) return LAG_OK;\n"
    " |  const LAG_REAL enough = LAG_C(64.0)*w->epsilon*size;\n"
    " |  const lag_impulses s = {(int)w->n, w->of, {w->afirst, w->acol, w->avalue}, {w->dfirst, w->dcol, w->dvalue}, "
    "w->response, w->b, w->P, v};\n"
    " |  return lag_contact_impulses(&s, enough, MOST) > MOST ? (int)LAG_ECONTACT : (int)LAG_OK;\n"
    " |}\n";

static const char *const kick =
    " |\n"
    " |/* y1: velocities and states at the end of a step from y; mid: its middle, at t. */\n"
    " |static int lag_moreau_kick(const lag_params *p, const lag_state *s, LAG_REAL t, LAG_REAL hHELD, const LAG_REAL "
    "*y, LAG_REAL *mid, LAG_REAL *y1, lag_moreau_room *w) {\n"
    " |  LAG_REAL rate[LAG_NY], rate0[LAG_NY], now[LAG_NU];\n"
    "i|  LAG_REAL before = -LAG_C(1.0);\n"
    "i|  for (int turn = 0; turn < 100; turn++) {\n"
    "e|  const int turn = 0;\n"
    "e|  {\n"
    " |    lag_contact_inputs(p, tPASS, -2, now);\n"
    " |    int status = lag_rates(p, t, mid, now, 0, 0, rate);\n"
    " |    if (status != LAG_OK) return status;\n"
    " |    for (int i = 0; i < LAG_NY; i++) {\n"
    " |      if (!lag_is_number(rate[i])) return LAG_ECONTACT;\n"
    " |      if (turn == 0) rate0[i] = rate[i];\n"
    " |      if (i >= LAG_NQ && w->impacts > LAG_C(0.0)) rate[i] = (rate0[i] + rate[i])/LAG_C(2.0);\n"
    " |      if (i >= LAG_NQ) y1[i] = y[i] + h*rate[i];\n"
    " |    }\n"
    " |    if (turn == 0) status = lag_contact_find(p, t, hPASS, mid, y1 + LAG_NQ, s->impulse, w);\n"
    " |    if (status == LAG_OK) status = lag_contact_solve(w, y1 + LAG_NQ);\n"
    "e|    return status;\n"
    "i|    if (status != LAG_OK) return status;\n"
    "i|    const lag_moreau_ends ends = {h, y, y1, rate};\n"
    "i|    const LAG_REAL most = lag_moreau_mean(&ends, w->impacts > LAG_C(0.0) ? LAG_C(1.0) : LAG_C(0.5), w->epsilon, "
    "LAG_NQ, LAG_NZ, mid);\n"
    "i|    if (most <= LAG_C(8.0) || (turn > 0 && most <= LAG_C(1e4) && most >= before/LAG_C(2.0))) return LAG_OK;\n"
    "i|    before = most;\n"
    " |  }\n"
    "i|  return LAG_ENEWTON;\n"
    " |}\n";

static const char *const step =
    " |\n"
    " |/* Contacts at the end of a step: open, slipping or sticking, with impulses. */\n"
    " |static void lag_moreau_note(const lag_moreau_room *w, lag_state *s) {\n"
    " |  for (int i = 0; i < LAG_NCONTACTS; i++) s->touch[i] = s->struck[i] = s->impulse[i] = LAG_C(0.0);\n"
    " |  for (int j = 0; j < (int)w->n; j++) {\n"
    " |    const lag_pressing *const c = &w->of[j];\n"
    " |    const int i = (int)c->contact, r = (int)c->row, k = lag_contact_at[i][1], slips = (int)c->tangents;\n"
    " |    LAG_REAL rub = LAG_C(0.0);\n"
    " |    for (int a = 0; a <= slips; a++) {\n"
    " |      s->impulse[i + a] = w->P[r + a];\n"
    " |      if (a > 0) rub = LAG_FN(hypot)(rub, w->P[r + a]);\n"
    " |    }\n"
    " |    if (!(w->P[r] > LAG_C(0.0))) continue;\n"
    " |    s->touch[i] = rub < c->mu*w->P[r]*(LAG_C(1.0) - LAG_C(64.0)*w->epsilon) ? (LAG_REAL)LAG_STICKS : "
    "(LAG_REAL)LAG_SLIPS;\n"
    " |    if (lag_contact_strikes(w->r0[k], w->pace[k])) s->struck[i] = -w->r0[k];\n"
    " |  }\n"
    " |}\n";

/* Contacts, or dry friction: room, kick and note above. */
static const char *const whole_step =
    " |\n"
    " |static int lag_moreau(const lag_params *p, lag_state *s, LAG_REAL hHELD) {\n"
    " |  LAG_REAL y[LAG_NY], mid[LAG_NY], y1[LAG_NY];\n"
    "w|  LAG_REAL now[LAG_NU];\n"
    " |  lag_moreau_room w;\n"
    " |  lag_state end = *s;\n"
    " |  int status = LAG_OK;\n"
    " |  w.epsilon = lag_epsilon();\n"
    "c|  w.n = w.rows = w.impacts = LAG_C(0.0);\n"
    " |  lag_gather(s, y);\n"
    "d|  status = lag_friction_begin(p, s, yPASS, &w);\n"
    " |  for (int i = 0; i < LAG_NY; i++) mid[i] = y1[i] = y[i];\n"
    "q|  for (int i = 0; i < LAG_NQ; i++) mid[i] = y[i] + (s->lost[1 + i] + h/LAG_C(2.0)*y[LAG_NQ + i]);\n"
    " |  if (status == LAG_OK) status = lag_moreau_kick(p, s, s->t + h/LAG_C(2.0), hPASS, y, mid, y1, &w);\n"
    " |  if (status != LAG_OK) return status;\n"
    " |  end.t = lag_compensated_sum(s->t, h, &end.lost[0]);\n"
    " |  for (int i = 0; i < LAG_NY; i++) {\n"
    " |    const LAG_REAL d = i < LAG_NQ ? h/LAG_C(2.0)*(y[LAG_NQ + i] + y1[LAG_NQ + i]) : y1[i] - y[i];\n"
    " |    mid[i] = lag_compensated_sum(y[i], d, &end.lost[1 + i]);\n"
    "c|    if (!lag_is_number(mid[i])) return LAG_ECONTACT;\n"
    " |  }\n"
    " |  lag_scatter(mid, &end);\n"
    " |  lag_moreau_note(&w, &end);\n"
    "k|  lag_contact_inputs(p, end.tPASS, -2, now);\n"
    "h|  status = lag_onto(p, &endAT_END, end.lost + 1);\n"
    " |  if (status == LAG_OK) status = lag_check(&end);\n"
    " |  if (status == LAG_OK) *s = end;\n"
    " |  return status;\n"
    " |}\n"
    " |\n"
    " |LAG_API int lag_moreau_step(const lag_params *p, lag_state *s, LAG_REAL hINPUT) {\n"
    " |  return lag_moreau(p, s, hNOW);\n"
    " |}\n"
    "u|\n"
    "u|LAG_API int lag_moreau_step_with(const lag_params *p, lag_state *s, LAG_REAL h, lag_input_fn *input, void "
    "*context) {\n"
    "u|  return lag_moreau(p, s, h, 0, input, context);\n"
    "u|}\n";

/* Tangents of contact i, which follow it; -1: it is one. */
static int tangents_of(const ProgramSet *u, uint32_t i) {
  int n = 0;
  if (u->contacts.at[i].is_tangent) return -1;
  while (i + 1 < u->contacts.n && u->contacts.at[++i].is_tangent) n++;
  return n;
}

static uint32_t bandwidth(const ProgramSet *u) {
  uint32_t band = 0;
  for (uint32_t e = 0; e < u->constraints.mass.n; e++) {
    uint32_t d = u->constraints.mass.at[e].row - u->constraints.mass.at[e].col;
    band = d > band ? d : band;
  }
  return band;
}

static const char *contact_table(const Header *h) {
  StrBuf b = strbuf(h->a);
  for (uint32_t i = 0; i < h->u->contacts.n; i++) {
    const IrContact *c = &h->u->contacts.at[i];
    sb_printf(&b, "%s{%u, %u, %u, %d}",
              i == 0  ? ""
              : i % 8 ? ", "
                      : ",\n  ",
              c->input, c->constraint, c->force, tangents_of(h->u, i));
  }
  return sb_text(&b);
}

static void define_contacts(const Header *h) {
  const ProgramSet *u = h->u;
  const IrConstraints *k = &u->constraints;
  int others = k->of.n > u->contacts.n, is_explicit = u->flags & 1u << UNIT_SEPARABLE && !others;
  /* contacts alone, other constraints beside them, friction, forces that do not depend on velocities, or do */
  const LineChoice choices[] = {{'b', !others},     {'k', others},       {'f', u->contact_coefficients != NULL},
                                {'e', is_explicit}, {'i', !is_explicit}, {0, 0}};
  uint32_t band = bandwidth(u), nq = u->q.n, width = 3 * band + 1 < nq ? 3 * band + 1 : nq;
  const char *z = u->z.n ? ", y + 2*LAG_NQ" : "", *mid = arena_printf(h->a, "t, y, y + LAG_NQ%s, p, now", z);
  const HeaderWord words[] = {
      {"AT_CONTACTS", contact_table(h)},
      {"JACOBIAN", header_positions(h, k->jacobian.at, k->jacobian.n)},
      {"ENTRIES", header_positions(h, k->mass.at, k->mass.n)},
      {"NJACOBIAN", arena_printf(h->a, "%u", k->jacobian.n)},
      {"NMASS", arena_printf(h->a, "%u", k->mass.n)},
      {"NBAND", arena_printf(h->a, "%u", nq * width)},
      {"NRESPONSES", arena_printf(h->a, "%u", band || others ? u->contacts.n * nq : k->jacobian.n)},
      {"BANDWIDTH", arena_printf(h->a, "%u", band)},
      {"MID", mid},
      {"BEGIN", arena_printf(h->a, "t - h/LAG_C(2.0), begin, y + LAG_NQ%s, p, now", z)},
      {"FREE", arena_printf(h->a, "t, y, free%s, p, now", z)},
      {"RESPOND", others ? "p, t, u, input, context, y, w, i, r" : "w, r"},
      {"VELOCITY", k->position == k->velocity ? "correct" : "correct_velocities"},
      {NULL, NULL}};
  static const char *const matrices[] = {"A", "M", NULL}, *const law[] = {"law", NULL};
  const char *const parts[] = {tables, inputs, respond_alone, rows, laws, find, kick, step};
  embedded_section("friction", h->upper, h->lower, h->out);
  embedded_section("impulses", h->upper, h->lower, h->out);
  if (!others) embedded_section("band_matrix", h->upper, h->lower, h->out);
  if (!is_explicit) embedded_section("mean", h->upper, h->lower, h->out);
  header_internal_function(h, k->matrices, "contact_matrices",
                           arena_printf(h->a, "%s_REAL *A, %s_REAL *M", h->upper, h->upper), matrices, matrices);
  if (u->contact_coefficients)
    header_internal_function(h, u->contact_coefficients, "contact_coefficients",
                             arena_printf(h->a, "%s_REAL *law", h->upper), law, law);
  for (size_t i = 0; i < sizeof parts / sizeof *parts; i++) {
    const char *text = header_chosen(h, parts[i], choices);
    header_template(h, text, words);
  }
}

/* --- contacts, or dry friction --- */

const char *header_moreau_lacks(const ProgramSet *u) {
  if (!u->contacts.n || header_surfaces(u)) return header_friction_lacks(u);
  if (program_set_guides(u))
    return "no friction of guides: write a guide as two contacts, `y >= 0` and `-y >= 0`, with `friction` and `slip`";
  for (uint32_t i = 0; i < u->contacts.n; i++)
    if (u->contacts.at[i].law || u->contacts.at[i].holds)
      return "contacts of one friction, at rest and slipping, and of one law of impact, `stronge`";
  return u->flags & 1u << UNIT_MASSLESS ? "inertia in all coordinates: impulses would move the others by any amount"
                                        : NULL;
}

void header_moreau_indices(const Header *h) {
  if (h->u->contacts.n) contact_indices(h);
  else header_friction_indices(h);
  csupport_expand("\n/* A contact, or a surface of friction, in the last step by Moreau's method: nothing presses; it "
                  "slips, or has no friction; friction holds it. */\nenum { LAG_OPEN, LAG_SLIPS, LAG_STICKS };\n",
                  h->upper, h->lower, h->out);
}

void header_moreau_members(const Header *h) {
  if (h->u->contacts.n) contact_members(h);
  else header_friction_members(h);
}

void header_moreau_start(const Header *h) {
  const char *text =
      h->u->contacts.n
          ? "  for (int i = 0; i < LAG_NCONTACTS; i++) s->touch[i] = s->struck[i] = s->impulse[i] = LAG_C(0.0);\n"
          : "  for (int i = 0; i < LAG_NSURFACES; i++) s->touch[i] = s->mode[i] = LAG_C(0.0);\n";
  csupport_expand(text, h->upper, h->lower, h->out);
}

/* contacts, dry friction, contacts and steps that hold constraints beside them, steps that hold constraints, with
 * inputs */
static void write_step(const Header *h, const char *text) {
  const ProgramSet *u = h->u;
  int meets = u->contacts.n > 0, holds = u->constraints.of.n > u->contacts.n;
  const char *at_end = meets ? ", now" : u->u.n ? ", lag_held(p, end.t, u, input, context, now)" : "";
  const HeaderWord words[] = {
      {"INPUT", u->u.n ? ", const LAG_REAL *u" : ""},
      {"NOW", u->u.n ? ", u, 0, 0" : ""},
      {"AT_END", at_end},
      {"OF_INPUTS", u->u.n ? "\n * u: the inputs, constant during the step; 0 for the model's formulas." : ""},
      {NULL, NULL}};
  const LineChoice choices[] = {{'c', meets}, {'d', !meets},          {'k', meets && holds},
                                {'h', holds}, {'w', holds && u->u.n}, {0, 0}};
  header_template(h, header_chosen(h, text, choices), words);
}

void header_moreau_declare(const Header *h) { write_step(h, prototypes); }

void header_moreau_define(const Header *h) {
  if (h->u->contacts.n) define_contacts(h);
  else header_friction_define(h);
  write_step(h, whole_step);
}
