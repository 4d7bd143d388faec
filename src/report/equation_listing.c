/* The listing of the equations of motion, the one-line facts, and --dump=eqns. */
#include "report/equation_listing.h"

#include "base/words.h"
#include "symmetry/charges.h"
#include "report/listing_text.h"
#include "mech/kinetic_squares.h"
#include "sym/simplify.h"

/* Short form of an entry of M or f, as a person writes it, even where the shared form costs less to compute. Long
 * chains keep their lets. */
static Expr shown(const Text *t, Expr x) {
  enum { SHORT_MAX_COORDS = 16 };
  return t->e->n + t->e->first.n <= SHORT_MAX_COORDS ? simplify(t->g, x) : x;
}

/* The rows of M q'' as expressions, in time and memory in proportion to the entries that are not zero. */
static const Expr *mass_rows(Text *t) {
  const Eqns *e = t->e;
  uint32_t n = e->n, *next = ARENA_ARRAY(e->m->arena, uint32_t, n + 1), begin = 0;
  Expr *rows = ARENA_ARRAY(e->m->arena, Expr, n + 1),
       *terms = ARENA_ARRAY(e->m->arena, Expr, 2 * (size_t)e->mass.n + 1);
  vec_each(const MassEntry, x, e->mass) {
    next[x->row]++;
    next[x->col] += x->row != x->col;
  }
  for (uint32_t i = 0; i < n; i++) { /* counts become offsets */
    uint32_t count = next[i];
    next[i] = begin;
    begin += count;
  }
  vec_each(const MassEntry, x, e->mass) {
    Expr m = shown(t, x->e), a = expr_symbol(t->g, e->m->coords.at[x->col].a)->node;
    Expr b = expr_symbol(t->g, e->m->coords.at[x->row].a)->node;
    terms[next[x->row]++] = expr_mul(t->g, m, a);
    if (x->row != x->col) terms[next[x->col]++] = expr_mul(t->g, m, b);
  }
  for (uint32_t i = 0, from = 0; i < n; from = next[i++]) rows[i] = expr_add_n(t->g, terms + from, next[i] - from);
  return rows;
}

/* Unknowns of the augmented system: accelerations; for each definition w the part of dw/dt that contains them, and
 * the force that w transmits to its arguments. */
typedef struct {
  const Expr *rate, *force;
} Unknowns;

static Unknowns unknowns(Text *t) {
  const Eqns *e = t->e;
  const LinearSystem *s = &e->system;
  Arena *a = e->m->arena;
  Expr *rate = ARENA_ARRAY(a, Expr, s->n + s->ndefs), *force = ARENA_ARRAY(a, Expr, s->n + s->ndefs);
  for (uint32_t i = 0; i < s->n; i++) rate[i] = expr_symbol(t->g, e->m->coords.at[i].a)->node;
  for (uint32_t k = 0; k < s->ndefs; k++) {
    Name name = expr_def_name(t->g, s->defs[k]);
    SymId w = expr_declare(t->g, SYM_LOCAL, 0, arena_printf(a, "%s'", name), SIGN_UNKNOWN);
    SymId f = expr_declare(t->g, SYM_LOCAL, 0, arena_printf(a, "F_%s", name), SIGN_UNKNOWN);
    rate[s->n + k] = expr_symbol(t->g, w)->node;
    force[s->n + k] = expr_symbol(t->g, f)->node;
  }
  return (Unknowns){rate, force};
}

static void add_product(Text *t, Expr *sum, Expr a, Expr b) {
  Expr ab = expr_mul(t->g, a, b);
  *sum = expr_add(t->g, *sum, ab);
}

/* Rows of the augmented system: H and C^T for coordinates; H, C^T and -1 for definitions; and C: see
 * mech/augmented_system.h. */
static void lifted_motion(Text *t) {
  const Eqns *e = t->e;
  const LinearSystem *s = &e->system;
  uint32_t total = s->n + s->ndefs;
  Unknowns u = unknowns(t);
  Expr *row = ARENA_ARRAY(e->m->arena, Expr, total), *rate = ARENA_ARRAY(e->m->arena, Expr, total);
  for (uint32_t i = 0; i < total; i++) row[i] = rate[i] = expr_int(t->g, 0);
  vec_each(const MassEntry, x, s->H) {
    add_product(t, &row[x->row], x->e, u.rate[x->col]);
    if (x->row != x->col) add_product(t, &row[x->col], x->e, u.rate[x->row]);
  }
  vec_each(const MassEntry, x, s->C) {
    add_product(t, &row[x->col], x->e, u.force[x->row]);
    add_product(t, &rate[x->row], x->e, u.rate[x->col]);
  }
  text_heading(t,
               "equations of motion: w' of a let w without terms in velocities alone, F_w the force that w transmits");
  for (uint32_t k = s->n; k < total; k++) text_equation(t, u.rate[k], rate[k], 0);
  for (uint32_t k = total; k-- > s->n;) text_equation(t, u.force[k], row[k], 0);
  for (uint32_t i = 0; i < s->n; i++) text_equation(t, row[i], s->f[i], i + 1 == s->n && !e->m->states.n);
}

/* Whether the coordinate is coupled to at most one other. If so, its rate is printed instead of its row of the
 * two-form. */
static int is_in_pair(const FirstOrder *x, uint32_t i) {
  uint32_t n = 0;
  for (uint32_t k = 0; k < x->n; k++) n += x->block[k] == x->block[i];
  return n <= 2;
}

/* sum_j omega_ij q_j' = dH/dq_i + ..., with the first sign positive; the rate itself where the coordinate is one of
 * a pair. */
static void first_order_motion(Text *t) {
  const Eqns *e = t->e;
  const FirstOrder *x = &e->first;
  uint32_t k = 0;
  for (uint32_t i = 0; i < x->n; i++) {
    int alone = is_in_pair(x, i);
    Expr left = expr_int(t->g, 0), right = shown(t, x->rhs[i]);
    for (; k < x->form.n && x->form.at[k].row == i; k++)
      add_product(t, &left, x->form.at[k].e, expr_symbol(t->g, e->m->states.at[x->at[x->form.at[k].col]].rate)->node);
    Num sign = num_int(1);
    expr_pair(t->g, left, EX_SUM, 0, &sign);
    if (num_sign(sign) < 0) {
      left = expr_neg(t->g, left);
      right = expr_neg(t->g, right);
    }
    if (alone) left = expr_symbol(t->g, e->m->states.at[x->at[i]].rate)->node;
    text_equation(t, left, alone ? shown(t, x->rates[i]) : right, i + 1 == x->n && x->n == e->m->states.n);
  }
}

static void motion(Text *t) {
  const Eqns *e = t->e;
  const Model *m = e->m;
  if (e->n && !e->mass_known) lifted_motion(t);
  else if (m->families.n) text_heading(t, "equations of motion while contacts of families are open");
  else text_heading(t, m->hamiltonian ? "Hamilton's equations" : "equations of motion");
  const Expr *rows = e->mass_known ? mass_rows(t) : NULL;
  for (uint32_t i = 0; rows && i < e->n; i++)
    text_equation(t, rows[i], shown(t, e->f[i]), i + 1 == e->n && !m->states.n);
  if (e->first.n) first_order_motion(t);
  for (uint32_t i = 0; i < m->states.n; i++)
    if (!m->states.at[i].coordinate)
      text_equation(t, expr_symbol(t->g, m->states.at[i].rate)->node, m->states.at[i].flow, i + 1 == m->states.n);
  text_end(t);
}

/* When constraints with `while` hold. */
static void while_conditions(Text *t) {
  const Model *m = t->e->m;
  if (!model_conditional(m)) return;
  text_heading(t, "constraints with a condition");
  Expr zero = expr_int(t->g, 0), one = expr_int(t->g, 1);
  for (uint32_t i = 0; i < m->contacts.n; i++) {
    if (!m->contacts.at[i].margin) continue;
    Expr holds = expr_fn2(t->g, EX_LT, zero, m->contacts.at[i].margin), closed = expr_select(t->g, holds, one, zero);
    text_equation(t, expr_symbol(t->g, m->contacts.at[i].closed)->node, shown(t, closed), i + 1 == m->contacts.n);
  }
  text_end(t);
}

/* The constraints, and the conditions that they put on accelerations. */
static void constraints(Text *t) {
  const Eqns *e = t->e;
  const Constraints *k = &e->constraints;
  Expr zero = expr_int(t->g, 0);
  if (!k->n) return;
  text_constraints(t);
  while_conditions(t);
  Expr *rows = ARENA_ARRAY(e->m->arena, Expr, k->n);
  for (uint32_t i = 0; i < k->n; i++) rows[i] = zero;
  for (uint32_t i = 0; i < k->A.n; i++)
    add_product(t, &rows[k->A.at[i].row], shown(t, k->A.at[i].e),
                expr_symbol(t->g, e->m->coords.at[k->A.at[i].col].a)->node);
  text_heading(t, "conditions of the constraints on accelerations");
  for (uint32_t i = 0; i < k->n; i++) text_equation(t, rows[i], shown(t, k->demand[i]), i + 1 == k->n);
  text_end(t);
}

/* E and its balance. */
static void energy(Text *t, const Charge *c) {
  const char *title = t->e->m->hamiltonian ? "Hamiltonian" : "energy";
  text_heading(t, t->e->energy_jumps ? arena_printf(t->e->m->arena, "%s; its balance holds between jumps of L", title)
                                     : title);
  int moves = c->proof.drift != PROVED_ZERO && !c->proof.power_unknown;
  const char *name = t->e->m->hamiltonian ? "H" : "E";
  text_named(t, name, name, t->e->energy, !moves);
  if (moves)
    text_named(t, arena_printf(t->e->m->arena, "d%s/dt", name), arena_printf(t->e->m->arena, "\\dot{%s}", name),
               c->proof.power, 1);
  text_end(t);
}

/* Degrees of freedom of n first-order coordinates: n/2, with a half left over if drag couples an odd number. */
static const char *half(const Eqns *e, uint32_t n) {
  return arena_printf(e->m->arena, "%u%s", n / 2, n % 2 ? " 1/2" : "");
}

/* ", singular at theta = 0", or nothing. */
static const char *pole_text(const Eqns *e) {
  static const char *const at[] = {"-pi/2", "0", "pi/2", "pi"};
  MassPole pole;
  if (e->singular_mass || !mass_pole(e, &pole)) return "";
  return arena_printf(e->m->arena, "%s singular at %s = %s", e->definite_by_values ? ", but" : ",",
                      e->m->coords.at[pole.coordinate].name, at[pole.quarters + 1]);
}

void show_facts(const Eqns *e, StrBuf *out) {
  const char *energy = e->ncharges ? charges_energy_text(e) : "";
  if (e->m->hamiltonian)
    sb_printf(out, "Hamiltonian, %u coordinate%s and as many momenta; %s\n", e->first.n / 2, plural(e->first.n / 2),
              energy);
  else if (e->first.n)
    sb_printf(out, "first-order Lagrangian, %u coordinates, %s degree%s of freedom; two-form %s; %s\n", e->first.n,
              half(e, e->first.n), e->first.n == 2 ? "" : "s", e->first.constant ? "constant" : "variable", energy);
  if (!e->n) return;
  sb_printf(out, "%u coordinate%s; mass matrix %s%s%s; %s\n", e->n, plural(e->n),
            e->constant_mass ? "constant" : "variable",
            e->singular_mass        ? ", singular where no constraint holds"
            : e->definite_mass      ? ", positive definite"
            : e->definite_by_values ? ", positive definite by the signs of its parameters' values"
                                    : "",
            pole_text(e), energy);
}

static void facts(Text *t, const char *cost) {
  const char *c = text_latex(t) ? "% " : "";
  sb_puts(t->out, text_latex(t) ? "" : "\n");
  if (t->e->m->lagrangian) sb_puts(t->out, c);
  show_facts(t->e, t->out);
  if (cost) sb_printf(t->out, "%s%s: %s\n", c, t->e->first.n ? "rates" : "accelerations", cost);
}

void show_equations(const Eqns *e, const char *cost, PrintStyle style, StrBuf *out) {
  Text t = {.e = e, .g = e->g, .style = style, .out = out};
  const Model *m = e->m;
  text_title(&t);
  if (m->hamiltonian) {
    energy(&t, &e->charges[0]);
  } else if (m->lagrangian) {
    text_heading(&t, "Lagrangian");
    text_named(&t, "L", "L", m->lagrangian, 1);
    text_end(&t);
    text_momenta(&t);
  }
  motion(&t);
  constraints(&t);
  VEC(Expr) roots = {0};
  if (m->lagrangian) vec_push(m->arena, &roots, m->lagrangian);
  for (uint32_t i = 0; i < e->n; i++) vec_push(m->arena, &roots, e->momenta[i]);
  for (uint32_t i = 0; i < e->n; i++) vec_push(m->arena, &roots, shown(&t, e->f[i]));
  for (uint32_t i = 0; i < e->mass.n; i++) vec_push(m->arena, &roots, shown(&t, e->mass.at[i].e));
  for (uint32_t i = 0; i < m->states.n; i++)
    if (!m->states.at[i].coordinate) vec_push(m->arena, &roots, m->states.at[i].flow);
  for (uint32_t i = 0; i < e->first.n; i++) {
    vec_push(m->arena, &roots, e->first.theta[i]);
    vec_push(m->arena, &roots, shown(&t, e->first.rates[i]));
  }
  for (uint32_t i = 0; i < e->constraints.n; i++) vec_push(m->arena, &roots, m->constraints.at[i].c);
  for (uint32_t i = 0; i < e->constraints.n; i++) vec_push(m->arena, &roots, shown(&t, e->constraints.demand[i]));
  if (e->energy) {
    vec_push(m->arena, &roots, e->energy);
    if (!m->hamiltonian) energy(&t, &e->charges[0]);
  }
  text_charges(&t);
  for (uint32_t i = 0; i < e->ncharges; i++) {
    vec_push(m->arena, &roots, e->charges[i].proof.charge);
    vec_push(m->arena, &roots, e->charges[i].proof.power);
  }
  text_definitions(&t, roots.at, roots.n);
  facts(&t, cost);
}

static void entry(const Eqns *e, const char *what, Expr x, StrBuf *out) {
  sb_printf(out, "%s = ", what);
  expr_print(e->g, x, PRINT_TEXT, out);
  sb_putc(out, '\n');
}

void dump_equations(const Eqns *e, StrBuf *out) {
  const Model *m = e->m;
  Arena *a = m->arena;
  for (uint32_t k = 0; k < e->mass.n; k++)
    entry(e, arena_printf(a, "M[%s,%s]", m->coords.at[e->mass.at[k].row].name, m->coords.at[e->mass.at[k].col].name),
          e->mass.at[k].e, out);
  for (uint32_t i = 0; i < e->n; i++) entry(e, arena_printf(a, "f[%s]", m->coords.at[i].name), e->f[i], out);
  for (uint32_t i = 0; i < e->n; i++) entry(e, arena_printf(a, "Q[%s]", m->coords.at[i].name), e->Q[i], out);
  for (uint32_t i = 0; i < m->states.n; i++)
    entry(e, arena_printf(a, "flow[%s]", m->states.at[i].name), e->flow[i], out);
  const Constraints *k = &e->constraints;
  for (uint32_t i = 0; i < k->n; i++)
    entry(e, arena_printf(a, i < k->nholonomic ? "c[%s]" : "r[%s]", k->of[i]->name),
          i < k->nholonomic ? k->c[i] : k->r[i], out);
  for (uint32_t i = 0; i < k->A.n; i++)
    entry(e, arena_printf(a, "A[%s,%s]", k->of[k->A.at[i].row]->name, m->coords.at[k->A.at[i].col].name), k->A.at[i].e,
          out);
  for (uint32_t i = 0; i < k->n; i++) entry(e, arena_printf(a, "g[%s]", k->of[i]->name), k->demand[i], out);
  if (e->energy_stable) entry(e, "E", e->energy_stable, out);
  sb_printf(out, "facts:%s%s%s%s%s\n", e->constant_mass ? " constant-mass" : "",
            e->definite_mass ? " definite-mass" : "", e->conserves_energy ? " conserves-energy" : "",
            e->autonomous ? " autonomous" : "", e->smooth ? " smooth" : "");
}
