/* Steps of an emitted header by Moreau's method. Enters: the unit's contacts, their laws and matrices. Leaves: what
 * the state says of contacts, prototypes and functions of the steps. Holds: each step has the digits of the
 * runtime's, whose text it carries (kernels/moreau_step.h, contact_step.h, joint_friction.h). */
#include "emit/header_impl.h"
#include "emit/header_moreau_text.h"

int header_rubs(const ProgramSet *u) { return header_surfaces(u) + header_guides(u) > 0; }

/* --- declarations --- */

static void contact_indices(const Header *h) {
  uint32_t n = program_set_contacts(h->u);
  sb_puts(h->out, "\n/* Contacts, for touch, struck and impulse of the state; behind each with friction the velocities "
                  "of slipping along its surface. */\nenum {\n");
  for (uint32_t i = 0; i < n; i++)
    sb_printf(h->out, "  %s = %u, /* %s */\n", h->contacts[i], i, comment_text(h->a, header_contact_name(h, i)));
  header_printf(h, "  LAG_NCONTACTS = %u\n};\n", n);
}

static void contact_members(const Header *h) {
  header_printf(
      h,
      "  LAG_REAL touch[LAG_NCONTACTS];   /* in the last _moreau_step: LAG_OPEN, LAG_SLIPS, LAG_STICKS */\n"
      "  LAG_REAL struck[LAG_NCONTACTS];  /* velocity with which a gap closed, of an impact in that step; else 0 */\n"
      "  LAG_REAL impulse[LAG_NCONTACTS]; /* of a gap, and of friction along its velocity of slipping; the next step "
      "begins with them */\n");
}

/* --- definitions --- */

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
                              {"NALL", arena_printf(h->a, "%u", u->contacts.n)},
                              {"NOTED", header_rubs(u) ? "contact_note" : "moreau_note"},
                              {"VELOCITY", u->guide_loads                ? "guide_loads"
                                           : k->position == k->velocity ? "correct"
                                                                        : "correct_velocities"},
                              {"LOAD", u->guide_loads ? ", (effort) + LAG_NQ" : ""},
                              {NULL, NULL}};
  header_template(h, header_chosen(h, text, choices), words);
}

static void define_contacts(const Header *h) {
  const ProgramSet *u = h->u;
  header_sections(h, "friction, mean, band_matrix, contact_turns, impulses");
  header_internal_function(h, u->constraints.matrices, "contact_matrices", NULL, "LAG_REAL *A, LAG_REAL *M", NULL);
  if (u->contact_coefficients)
    header_internal_function(h, u->contact_coefficients, "contact_coefficients", NULL, "LAG_REAL *law", NULL);
  if (u->guide_loads)
    header_internal_function(h, u->guide_loads, "guide_loads", NULL,
                             "const LAG_REAL *g, LAG_REAL *d, LAG_REAL *force, LAG_REAL *load", NULL);
  write_contacts(h, tables);
  header_section(h, "contacts");
  write_contacts(h, note);
  if (header_rubs(u)) {
    header_printf(h, "\n#undef LAG_MODEL\n#undef LAG_THE_MODEL\n");
    header_friction_define(h);
    write_contacts(h, coupling);
    header_section(h, "coupled");
    write_contacts(h, coupled_kick);
  } else write_contacts(h, kick);
  header_section(h, "kick");
}

/* --- contacts, or dry friction --- */

const char *header_moreau_lacks(const ProgramSet *u) {
  const char *lacks = program_set_contacts(u) && !header_rubs(u) ? NULL : header_friction_lacks(u);
  if (lacks || !program_set_contacts(u)) return lacks;
  for (uint32_t i = 0; i < program_set_contacts(u); i++)
    if (u->contacts.at[i].law) return "contacts of one law of impact, `stronge`";
  int undetermined = u->flags & 1u << UNIT_MASSLESS && u->constraints.of.n == u->contacts.n;
  return undetermined ? "inertia in all coordinates: impulses would move the others by any amount"
                                        : NULL;
}

void header_moreau_indices(const Header *h) {
  if (program_set_contacts(h->u)) contact_indices(h);
  if (header_rubs(h->u)) header_friction_indices(h);
  header_printf(h, "\n/* A contact, or a surface of friction, in the last step by Moreau's method: nothing presses; it "
                   "slips, or has no friction; friction holds it. */\nenum { LAG_OPEN, LAG_SLIPS, LAG_STICKS };\n");
}

void header_moreau_members(const Header *h) {
  if (program_set_contacts(h->u)) contact_members(h);
  if (header_rubs(h->u)) header_friction_members(h);
}

void header_moreau_start(const Header *h) {
  int meets = program_set_contacts(h->u) > 0;
  const char *holds = meets ? "holds" : "touch", *start = arena_printf(h->a,
      "  for (int i = 0; i < LAG_NSURFACES; i++) s->%s[i] = s->mode[i] = LAG_C(0.0);\n", holds);
  if (meets)
    header_printf(
        h, "  for (int i = 0; i < LAG_NCONTACTS; i++) s->touch[i] = s->struck[i] = s->impulse[i] = LAG_C(0.0);\n");
  if (header_rubs(h->u)) header_printf(h, "%s", start);
  if (header_guides(h->u)) header_printf(h, "  s->rubs = LAG_C(0.0);\n");
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
  int meets = program_set_contacts(u) > 0, holds = c->of.n > u->contacts.n, guides = header_guides(u) > 0,
      joints = header_rubs(u);
  uint32_t band = bandwidth(u), nq = u->q.n, width = 3 * band + 1 < nq ? 3 * band + 1 : nq;
  const char *at_end = meets || guides ? ", now" : u->u.n ? ", lag_held(p, end.t, u, input, context, now)" : "";
  const HeaderWord words[] = {
      {"INPUT", u->u.n ? ", const LAG_REAL *u" : ""},
      {"NOW", u->u.n ? ", u, 0, 0" : ""},
      {"AT_END", at_end},
      {"OF_INPUTS", !u->u.n ? "" : guides ? of_guides : of_inputs},
      {"EXPLICIT", meets && u->flags & 1u << UNIT_SEPARABLE && !holds && !joints ? "1" : "0"},
      {"NJACOBIAN", arena_printf(h->a, "%u", c->jacobian.n)},
      {"NMASS", arena_printf(h->a, "%u", c->mass.n)},
      {"NBAND", arena_printf(h->a, "%u", nq * width)},
      {"NRESPONSES", arena_printf(h->a, "%u", band || holds ? program_set_contacts(u) * nq : c->jacobian.n)},
      {"NLOADS", arena_printf(h->a, "%u", u->guide_loads ? 3 * header_guides(u) : 0)},
      {"NMOVING", arena_printf(h->a, "%u", u->nmoving)},
      {"OF_NOW", u->u.n ? ", now[LAG_NU]" : ""},
      {"AT_STATE", arena_printf(h->a, "s->t%s%s, p%s", u->q.n ? ", s->q, s->v" : "", u->z.n ? ", s->z" : "",
                                u->u.n ? ", lag_held(p, s->t, u, input, context, now)" : "")},
      {"LOADS", u->guide_loads ? "rubs + LAG_NSLOPES" : "0"},
      {"OTHERS", c->of.n > program_set_contacts(u) ? "1" : "0"},
      {"BANDWIDTH", arena_printf(h->a, "%u", band)},
      {"NMODES", arena_printf(h->a, "%u", meets ? 0 : u->nmodes)},
      {"FRICTION_NOTED", meets ? "friction_note" : "moreau_note"},
      {"NOTED", joints ? "contact_note" : "moreau_note"},
      {"HOLDS", meets ? "holds" : "touch"},
      {NULL, NULL}};
  const LineChoice choices[] = {{'c', meets},
                                {'d', joints},
                                {'a', meets && !joints},
                                {'b', meets && joints},
                                {'e', !meets},
                                {'k', meets && holds},
                                {'h', holds},
                                {'g', guides},
                                {'r', guides && !meets},
                                {'w', !meets && holds && u->u.n},
                                {'s', u->moving_sizes != NULL},
                                {0, 0}};
  header_template(h, header_chosen(h, text, choices), words);
}

void header_moreau_declare(const Header *h) { write_step(h, prototypes); }

void header_moreau_define(const Header *h) {
  if (program_set_contacts(h->u)) define_contacts(h);
  else header_friction_define(h);
  if (h->u->moving_sizes) header_internal_function(h, h->u->moving_sizes, "moving_sizes", NULL, "LAG_REAL *out", NULL);
  write_step(h, whole_step);
}
