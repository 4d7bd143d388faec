/* Steps of an emitted header by Moreau's method. Enters: the unit's contacts, their laws and matrices. Leaves: what
 * the state says of contacts, prototypes and functions of the steps. Holds: each step has the digits of the
 * runtime's, whose text it carries (kernels/moreau_step.h, contact_step.h, joint_friction.h). */
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
    " |/* Inputs that close contacts and apply their forces, constraints; positions of entries of the constraints' "
    "Jacobian and of the mass matrix. */\n"
    " |typedef struct lag_contact { short input, constraint, is_tangent, force; } lag_contact;\n"
    " |typedef struct lag_entry { unsigned short row, col; } lag_entry;\n"
    " |static const lag_contact lag_contact_at[] = {AT_CONTACTS};\n"
    " |static const lag_entry lag_gap_jacobian_at[] = {JACOBIAN}, lag_gap_mass_at[] = {ENTRIES};\n"
    " |\n"
    " |/* now := the inputs at time t, with contact `only` closed, or -1: all of them, -2: none. */\n"
    " |static void lag_contact_inputs(const lag_params *p, LAG_REAL tHELD, int only, LAG_REAL *now) {\n"
    " |  const LAG_REAL *const x = lag_held(p, t, u, input, context, now);\n"
    " |  for (int i = 0; i < LAG_NU && x != now; i++) now[i] = x[i];\n"
    " |  for (int i = 0; i < LAG_NCONTACTS; i++) {\n"
    " |    now[lag_contact_at[i].input] = only == -1 || only == i ? LAG_C(1.0) : LAG_C(0.0);\n"
    " |    if (lag_contact_at[i].is_tangent) now[lag_contact_at[i].force] = LAG_C(0.0);\n"
    " |  }\n"
    " |}\n"
    " |\n"
    " |#define LAG_MODEL const lag_params *pHELD\n"
    " |#define LAG_THE_MODEL pPASS\n"
    " |#define LAG_CLOSE(t, only, now) (lag_contact_inputs(p, tPASS, only, now), 0)\n"
    " |#define LAG_GAPS(t, q, v, z, now, c, r) lag_residuals(t, q, vSTATES, p, now, c, r)\n"
    " |#define LAG_GAP_MATRICES(t, y, now, A, M) lag_contact_matrices(MID, A, M)\n"
    "k|#define LAG_UNIT_CHANGE(t, y, now, g, d, effort) lag_VELOCITY(MID, g, d, effort)\n"
    "b|#define LAG_UNIT_CHANGE(t, y, now, g, d, effort) ((void)(y), 0) /* there are no other constraints */\n"
    " |#define LAG_STRIKE(t, y, now, i, v) lag_strike(lag_contact_at[i].constraint, lag_contact_at[i].input, "
    "MID, v)\n"
    "f|#define LAG_FRICTIONS(t, y, now, law) lag_contact_coefficients(MID, law)\n"
    "o|#define LAG_FRICTIONS(t, y, now, law) 0\n"
    " |#define LAG_CONTACT_FAILS(t, i, words) ((int)LAG_ECONTACT)\n"
    " |#define LAG_SINGULAR(t) ((int)LAG_ESINGULAR)\n";

static const char *const kick =
    " |\n"
    " |static int lag_kick_rates(const lag_params *p, LAG_REAL tHELD, const LAG_REAL *y, LAG_REAL *now, LAG_REAL *k) "
    "{\n"
    " |  lag_contact_inputs(p, tPASS, -2, now);\n"
    " |  const int status = lag_rates(p, t, y, now, 0, 0, k);\n"
    " |  for (int i = 0; i < LAG_NY && status == LAG_OK; i++)\n"
    " |    if (!lag_is_number(k[i])) return LAG_ECONTACT;\n"
    " |  return status;\n"
    " |}\n"
    " |\n"
    " |#define LAG_LAWS lag_moreau_contacts\n"
    " |#define LAG_KICK_RATES(t, y, w, k) lag_kick_rates(p, tPASS, y, (w)->u, k)\n"
    " |#define LAG_RESPONSES(s, w) lag_contacts_find(LAG_THE_MODEL, w, (s)->t, (s)->h, (s)->mid, (s)->y1 + LAG_NQ)\n"
    " |#define LAG_OBEY(s, w) (lag_contacts_solve(w, (s)->y1 + LAG_NQ) ? (int)LAG_ECONTACT : 0)\n"
    " |#define LAG_STRUCK(w) ((w)->impacts > 0)\n"
    " |#define LAG_TERM_SIZE(w, i, rate) (rate)\n"
    " |#define LAG_KICK_FAILS(t) ((int)LAG_ENEWTON)\n";

static const char *const note =
    " |\n"
    " |/* Contacts at the end of a step: open, slipping or sticking, with impulses. */\n"
    " |static void lag_moreau_note(const lag_moreau_contacts *w, lag_state *s) {\n"
    " |  const LAG_REAL *const P = w->all.P;\n"
    " |  for (int i = 0; i < LAG_NCONTACTS; i++) s->touch[i] = s->struck[i] = s->impulse[i] = LAG_C(0.0);\n"
    " |  for (int j = 0; j < w->all.n; j++) {\n"
    " |    const lag_pressing *const c = &w->all.of[j];\n"
    " |    const int i = (int)c->contact, r = (int)c->row, k = lag_contact_at[i].constraint, slips = "
    "(int)c->tangents;\n"
    " |    LAG_REAL rub = LAG_C(0.0);\n"
    " |    for (int a = 0; a <= slips; a++) {\n"
    " |      s->impulse[i + a] = P[r + a];\n"
    " |      if (a > 0) rub = LAG_FN(hypot)(rub, P[r + a]);\n"
    " |    }\n"
    " |    if (!(P[r] > LAG_C(0.0))) continue;\n"
    " |    s->touch[i] = rub < c->mu*P[r]*(LAG_C(1.0) - LAG_C(64.0)*w->epsilon) ? (LAG_REAL)LAG_STICKS : "
    "(LAG_REAL)LAG_SLIPS;\n"
    " |    if (lag_contact_strikes(w->r0[k], w->pace[k])) s->struck[i] = -w->r0[k];\n"
    " |  }\n"
    " |}\n";

/* Contacts, or dry friction. */
static const char *const whole_step =
    " |\n"
    " |static int lag_moreau(const lag_params *p, lag_state *s, LAG_REAL hHELD) {\n"
    "c|  enum { ROOM = LAG_CONTACT_ROOM(LAG_NCONTACTS, LAG_NC, LAG_NQ, NJACOBIAN, NMASS, NRESPONSES, NBAND) };\n"
    "d|  enum { ROOM = LAG_JOINT_ROOM(LAG_NSURFACES, LAG_NY) };\n"
    " |  LAG_REAL y[LAG_NY], mid[LAG_NY], y1[LAG_NY], rate[LAG_NY], rate0[LAG_NY], room[ROOM];\n"
    "c|  LAG_REAL now[LAG_NU];\n"
    "w|  LAG_REAL now[LAG_NU + NMODES];\n"
    " |  const LAG_REAL t = s->t + h/LAG_C(2.0), epsilon = lag_epsilon();\n"
    " |  const lag_kick k = {LAG_NQ, LAG_NZ, EXPLICIT, t, s->t + h, h, epsilon, y, mid, y1, rate, rate0, rate};\n"
    " |  lag_state end = *s;\n"
    "g|  LAG_REAL *const rubs = &end.rubs;\n"
    " |  int status = LAG_OK;\n"
    " |  LAG_LAWS w;\n"
    " |  lag_gather(s, y);\n"
    " |  lag_kick_begin(&k, s->lost + 1);\n"
    "c|  w.contacts = LAG_NCONTACTS, w.constraints = LAG_NC, w.nq = LAG_NQ, w.entries = NJACOBIAN, w.nmass = NMASS, "
    "w.band = BANDWIDTH;\n"
    "c|  w.at = lag_contact_at, w.jacobian_at = lag_gap_jacobian_at, w.mass_at = lag_gap_mass_at;\n"
    "c|  w.epsilon = epsilon, w.guess = s->impulse, w.u = now;\n"
    "c|  lag_contacts_place(&w, NRESPONSES, room);\n"
    "d|  w.n = LAG_NSURFACES, w.states = LAG_NY, w.nq = LAG_NQ;\n"
    "d|  lag_joints_place(&w, room);\n"
    "d|  for (int j = 0; j < LAG_NSURFACES; j++) {\n"
    "d|    w.mode[j] = s->mode[j];\n"
    "d|    w.sticks[j] = s->touch[j] == (LAG_REAL)LAG_STICKS ? LAG_C(1.0) : LAG_C(0.0);\n"
    "d|  }\n"
    "d|  LAG_TRY(lag_joints_begin(LAG_THE_MODEL, &w, s->t, y));\n"
    " |  LAG_TRY(lag_moreau_kick(LAG_THE_MODEL, &k, &w));\n"
    " |  end.t = lag_compensated_sum(s->t, h, &end.lost[0]);\n"
    " |  lag_kick_end(&k, end.lost + 1, mid);\n"
    "c|  for (int i = 0; i < LAG_NY; i++)\n"
    "c|    if (!lag_is_number(mid[i])) return LAG_ECONTACT;\n"
    " |  lag_scatter(mid, &end);\n"
    " |  lag_moreau_note(&w, &end);\n"
    "k|  lag_contact_inputs(p, end.tPASS, -2, now);\n"
    "g|  lag_friction_inputs(p, end.tPASS, w.mode, now);\n"
    "h|  LAG_TRY(lag_onto(p, &endAT_END, end.lost + 1));\n"
    " |  LAG_TRY(lag_check(&end));\n"
    " |  *s = end;\n"
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
    sb_printf(&b, "%s{%u, %u, %d, %u}",
              i == 0  ? ""
              : i % 8 ? ", "
                      : ",\n  ",
              c->input, c->constraint, c->is_tangent != 0, c->force);
  }
  return sb_text(&b);
}

/* Sizes and words of contacts; nothing but contacts constrains the model, other constraints, friction, none. */
static void write_contacts(const Header *h, const char *text) {
  const ProgramSet *u = h->u;
  const IrConstraints *k = &u->constraints;
  int others = k->of.n > u->contacts.n, friction = u->contact_coefficients != NULL;
  const LineChoice choices[] = {{'b', !others}, {'k', others}, {'f', friction}, {'o', !friction}, {0, 0}};
  const char *z = u->z.n ? ", y + 2*LAG_NQ" : "";
  const HeaderWord words[] = {{"AT_CONTACTS", contact_table(h)},
                              {"JACOBIAN", header_positions(h, k->jacobian.at, k->jacobian.n)},
                              {"ENTRIES", header_positions(h, k->mass.at, k->mass.n)},
                              {"MID", arena_printf(h->a, "t, y, (y) + LAG_NQ%s, p, now", z)},
                              {"STATES", u->z.n ? ", z" : ""},
                              {"VELOCITY", k->position == k->velocity ? "correct" : "correct_velocities"},
                              {NULL, NULL}};
  header_template(h, header_chosen(h, text, choices), words);
}

static void define_contacts(const Header *h) {
  const ProgramSet *u = h->u;
  static const char *const matrices[] = {"A", "M", NULL}, *const law[] = {"law", NULL};
  header_section(h, "friction");
  header_section(h, "mean");
  header_section(h, "impulses");
  header_section(h, "band_matrix");
  header_internal_function(h, u->constraints.matrices, "contact_matrices",
                           arena_printf(h->a, "%s_REAL *A, %s_REAL *M", h->upper, h->upper), matrices, matrices);
  if (u->contact_coefficients)
    header_internal_function(h, u->contact_coefficients, "contact_coefficients",
                             arena_printf(h->a, "%s_REAL *law", h->upper), law, law);
  write_contacts(h, tables);
  header_section(h, "contacts");
  write_contacts(h, kick);
  header_section(h, "kick");
  write_contacts(h, note);
}

/* --- contacts, or dry friction --- */

const char *header_moreau_lacks(const ProgramSet *u) {
  if (!program_set_contacts(u) || header_surfaces(u) + program_set_guides(u)) return header_friction_lacks(u);
  for (uint32_t i = 0; i < u->contacts.n; i++)
    if (u->contacts.at[i].law || u->contacts.at[i].holds)
      return "contacts of one friction, at rest and slipping, and of one law of impact, `stronge`";
  return u->flags & 1u << UNIT_MASSLESS ? "inertia in all coordinates: impulses would move the others by any amount"
                                        : NULL;
}

void header_moreau_indices(const Header *h) {
  if (program_set_contacts(h->u)) contact_indices(h);
  else header_friction_indices(h);
  csupport_expand("\n/* A contact, or a surface of friction, in the last step by Moreau's method: nothing presses; it "
                  "slips, or has no friction; friction holds it. */\nenum { LAG_OPEN, LAG_SLIPS, LAG_STICKS };\n",
                  h->upper, h->lower, h->out);
}

void header_moreau_members(const Header *h) {
  if (program_set_contacts(h->u)) contact_members(h);
  else header_friction_members(h);
}

void header_moreau_start(const Header *h) {
  const char *text =
      program_set_contacts(h->u)
          ? "  for (int i = 0; i < LAG_NCONTACTS; i++) s->touch[i] = s->struck[i] = s->impulse[i] = LAG_C(0.0);\n"
          : "  for (int i = 0; i < LAG_NSURFACES; i++) s->touch[i] = s->mode[i] = LAG_C(0.0);\n";
  csupport_expand(text, h->upper, h->lower, h->out);
  if (header_guides(h->u)) csupport_expand("  s->rubs = LAG_C(0.0);\n", h->upper, h->lower, h->out);
}

static const char *const of_inputs = "\n * u: the inputs, constant during the step; 0 for the model's formulas.",
                  *const of_guides = "\n * LAG_ECONTACT also where friction presses a guide more than the force that "
                                     "it follows.\n * u: the inputs, constant during the step; 0 for the model's "
                                     "formulas. Those of guides are not read.";

/* contacts, dry friction, contacts and steps that hold constraints beside them, steps that hold constraints, without
 * contacts and with inputs */
static void write_step(const Header *h, const char *text) {
  const ProgramSet *u = h->u;
  const IrConstraints *c = &u->constraints;
  int meets = program_set_contacts(u) > 0, holds = c->of.n > u->contacts.n, guides = header_guides(u) > 0;
  uint32_t band = bandwidth(u), nq = u->q.n, width = 3 * band + 1 < nq ? 3 * band + 1 : nq;
  const char *at_end = meets || guides ? ", now" : u->u.n ? ", lag_held(p, end.t, u, input, context, now)" : "";
  const HeaderWord words[] = {
      {"INPUT", u->u.n ? ", const LAG_REAL *u" : ""},
      {"NOW", u->u.n ? ", u, 0, 0" : ""},
      {"AT_END", at_end},
      {"OF_INPUTS", !u->u.n ? "" : guides ? of_guides : of_inputs},
      {"EXPLICIT", meets && u->flags & 1u << UNIT_SEPARABLE && !holds ? "1" : "0"},
      {"NJACOBIAN", arena_printf(h->a, "%u", c->jacobian.n)},
      {"NMASS", arena_printf(h->a, "%u", c->mass.n)},
      {"NBAND", arena_printf(h->a, "%u", nq * width)},
      {"NRESPONSES", arena_printf(h->a, "%u", band || holds ? u->contacts.n * nq : c->jacobian.n)},
      {"BANDWIDTH", arena_printf(h->a, "%u", band)},
      {"NMODES", arena_printf(h->a, "%u", meets ? 0 : u->nmodes)},
      {NULL, NULL}};
  const LineChoice choices[] = {{'c', meets}, {'d', !meets},          {'k', meets && holds},
                                {'h', holds}, {'g', guides},
                                {'w', !meets && holds && u->u.n}, {0, 0}};
  header_template(h, header_chosen(h, text, choices), words);
}

void header_moreau_declare(const Header *h) { write_step(h, prototypes); }

void header_moreau_define(const Header *h) {
  if (program_set_contacts(h->u)) define_contacts(h);
  else header_friction_define(h);
  write_step(h, whole_step);
}
