/* Eqns to Progs: one program for each function of an emitted model, other than charges (lower_charges.c) and
 * constraints (lower_constraints.c). */
#include "lower/lower.h"

#include "ir/roll.h"
#include "lower/lower_impl.h"
#include "mech/switches.h"

Lower lower_new(const Eqns *e) {
  Arena *a = e->m->arena;
  Prog *p = prog_new(a);
  p->folds_constants = e->m->nfixed > 0;
  return (Lower){.e = e, .g = e->g, .p = p, .slots = expr_map(a), .circular = expr_map(a)};
}

Lower lower_by_text(const Eqns *e) {
  Lower l = lower_new(e);
  l.by_text = 1;
  return l;
}

Prog *lower_finish(const Lower *l, const PassPlan *plan, StrBuf *trace) {
  PassPlan known = *plan;
  known.times = l->e->m->times;
  Prog *p = passes_run(l->p, &known, trace);
  arena_release(l->slots.arena, l->slots.at, l->slots.cap * sizeof *l->slots.at);
  return p;
}

/* With sums over pairs as nests when the program has `from` instructions. */
static Prog *finished(const Lower *l, uint32_t from) { return lower_finish(l, &(PassPlan){.nests_from = from}, NULL); }

static const char *text_of_symbol(const Lower *l, SymId s) { return expr_symbol(l->g, s)->name; }

/* Whether M is diagonal and there are neither definitions nor constraints: accelerations are not coupled. */
static int is_diagonal(const Eqns *e) {
  uint32_t off = e->system.ndefs + e->constraints.n;
  for (uint32_t k = 0; k < e->system.H.n; k++) off += e->system.H.at[k].row != e->system.H.at[k].col;
  return off == 0;
}

/* Output 0: the accelerations; 1: the rates of states, which are lowered. */
static void store_rates(Lower *l, const Slot *acc) {
  const Model *m = l->e->m;
  for (uint32_t i = 0; i < l->e->n; i++) prog_store(l->p, 0, i, acc[i], text_of_symbol(l, m->coords.at[i].a));
  for (uint32_t i = 0; i < m->states.n; i++)
    prog_store(l->p, 1, i, lower_slot(l, l->e->flow[i]), text_of_symbol(l, m->states.at[i].rate));
}

Prog *lower_accel_traced(const Eqns *e, int libm, StrBuf *trace) {
  Lower l = lower_new(e);
  const Model *m = e->m;
  Slot *acc = ARENA_ARRAY(m->arena, Slot, e->n + 1);
  lower_solution(&l, acc);
  if (m->states.n) lower_roots(&l, e->flow, m->states.n);
  if (e->first.ndivisors) lower_roots(&l, e->first.divisors, e->first.ndivisors);
  for (uint32_t i = 0; i < e->first.ndivisors; i++) lower_pivot(&l, lower_slot(&l, e->first.divisors[i]), 0);
  store_rates(&l, acc);
  return lower_finish(
      &l, &(PassPlan){.nests_from = ROLL_FROM, .every_step = 1, .uncoupled = is_diagonal(e), .libm = libm}, trace);
}

Prog *lower_accel(const Eqns *e, int libm) { return lower_accel_traced(e, libm, NULL); }

/* Selects, by the flag ARR_FREE of each input, its formula or the constant at which it is held. */
static void lower_inputs_along(Lower *l) {
  const Model *m = l->e->m;
  for (uint32_t i = 0; i < m->inputs.n; i++) {
    const Input *in = &m->inputs.at[i];
    Expr symbol = expr_symbol(l->g, in->sym)->node;
    lower_roots(l, &in->value, 1);
    lower_roots(l, &symbol, 1);
    Slot is_free = prog_ins(l->p, (Ins){.op = IR_LOAD, .array = ARR_FREE, .index = i, .name = in->name});
    Slot holds = prog_op(l->p, IR_LT, 0, is_free), formula = lower_slot(l, in->value), constant = lower_slot(l, symbol);
    Slot s = prog_ins(l->p, (Ins){.op = IR_SELECT, .a = holds, .b = formula, .c = constant});
    expr_map_set(&l->slots, symbol, s + 1);
  }
}

static void slot_entries(const Lower *l, const Entries *from, IrEntries *to) {
  for (uint32_t k = 0; k < from->n; k++)
    vec_push(l->p->arena, to, ((IrSlotEntry){from->at[k].row, from->at[k].col, lower_slot(l, from->at[k].e)}));
}

IrSystem lower_system(const Eqns *e) {
  Lower l = lower_new(e);
  const Model *m = e->m;
  Arena *a = m->arena;
  Slot *acc = ARENA_ARRAY(a, Slot, e->n + 1), *f = ARENA_ARRAY(a, Slot, e->n + 1),
       *flow = ARENA_ARRAY(a, Slot, m->states.n + 1);
  Name *rates = ARENA_ARRAY(a, Name, e->n + m->states.n + 1), *velocities = ARENA_ARRAY(a, Name, e->n + 1);
  FactorRecord *factored = ARENA_NEW(a, FactorRecord);
  IrSystem sys = {.p = l.p,
                  .nq = e->n, .ndefs = e->n ? e->system.ndefs : 0, .nz = m->states.n, .f = f, .flow = flow,
                  .rates = rates, .velocities = velocities,
                  .factored = factored};
  l.direct = 1;
  l.factored = factored;
  lower_inputs_along(&l);
  lower_solution(&l, acc);
  lower_roots(&l, e->flow, m->states.n);
  for (uint32_t i = 0; i < e->n; i++) {
    f[i] = lower_slot(&l, e->system.f[i]);
    rates[i] = text_of_symbol(&l, m->coords.at[i].a);
    velocities[i] = text_of_symbol(&l, m->coords.at[i].v);
  }
  for (uint32_t i = 0; i < m->states.n; i++) {
    flow[i] = lower_slot(&l, e->flow[i]);
    rates[e->n + i] = text_of_symbol(&l, m->states.at[i].rate);
  }
  if (e->n) {
    slot_entries(&l, &e->system.H, &sys.H);
    slot_entries(&l, &e->system.C, &sys.C);
  }
  sys.x = l.x;
  return sys;
}

void lower_with_accelerations(Lower *l, const Expr *roots, uint32_t n) {
  const Model *m = l->e->m;
  int needed = 0;
  for (uint32_t i = 0; i < n; i++)
    needed |= roots[i] && expr_kinds(l->g, roots[i]) & (1u << SYM_ACC | 1u << SYM_RATE | 1u << SYM_MULTIPLIER);
  if (needed) {
    Slot *acc = ARENA_ARRAY(m->arena, Slot, l->e->n + 1);
    l->coarse = 1;
    lower_solution(l, acc);
    for (uint32_t i = 0; i < l->e->n; i++)
      expr_map_set(&l->slots, expr_symbol(l->g, m->coords.at[i].a)->node, acc[i] + 1);
    for (uint32_t i = 0; i < l->e->constraints.n; i++)
      expr_map_set(&l->slots, expr_symbol(l->g, l->e->constraints.of[i]->multiplier)->node, l->multipliers[i] + 1);
    lower_roots(l, l->e->flow, m->states.n);
    for (uint32_t i = 0; i < m->states.n; i++)
      expr_map_set(&l->slots, expr_symbol(l->g, m->states.at[i].rate)->node, lower_slot(l, l->e->flow[i]) + 1);
  }
  lower_roots(l, roots, n);
}

Prog *lower_finish_seldom(const Lower *l) { return finished(l, ROLL_SELDOM_FROM); }

void lower_output(Lower *l, Expr value, Name name) {
  vec_push(l->p->arena, &l->values, value);
  vec_push(l->p->arena, &l->names, name);
}

void lower_store_outputs(Lower *l, uint32_t array) {
  for (uint32_t k = 0; k < l->values.n; k++)
    prog_store(l->p, array, k, lower_slot(l, l->values.at[k]), l->names.at[k]);
}

Prog *lower_outputs_seldom(Lower *l) {
  lower_with_accelerations(l, l->values.at, l->values.n);
  lower_store_outputs(l, 0);
  return lower_finish_seldom(l);
}

static Prog *outputs_each_step(Lower *l) {
  lower_roots(l, l->values.at, l->values.n);
  lower_store_outputs(l, 0);
  return finished(l, ROLL_FROM);
}

/* One by one, with few passes: called once a run, or at events. */
static Prog *outputs_once(Lower *l) {
  for (uint32_t k = 0; k < l->values.n; k++) lower_roots(l, &l->values.at[k], 1);
  lower_store_outputs(l, 0);
  return prog_tidy(l->p);
}

/* q'' is an argument of the function: its symbols become loads. */
static void load_accelerations(Lower *l) {
  const Model *m = l->e->m;
  for (uint32_t i = 0; i < l->e->n; i++) {
    const Symbol *s = expr_symbol(l->g, m->coords.at[i].a);
    Slot a = lower_load(l, ARR_A, s);
    expr_map_set(&l->slots, s->node, a + 1);
  }
}

/* Multipliers as inputs of the program: ARR_G from `first` on, in the order of the equations. */
static void load_multipliers(Lower *l, uint32_t first) {
  const Constraints *k = &l->e->constraints;
  for (uint32_t i = 0; i < k->n; i++) {
    const Symbol *of = expr_symbol(l->g, k->of[i]->multiplier);
    Slot lambda =
        prog_ins(l->p, (Ins){.op = IR_LOAD, .array = ARR_G, .index = first + i, .name = of->name});
    expr_map_set(&l->slots, of->node, lambda + 1);
  }
}

/* Name of component i of y = (q, q', z). */
static const char *component(const Lower *l, uint32_t i) {
  const Model *m = l->e->m;
  uint32_t n = l->e->n;
  return i < n       ? m->coords.at[i].name
         : i < 2 * n ? text_of_symbol(l, m->coords.at[i - n].v)
                     : m->states.at[i - 2 * n].name;
}

/* Name of the variable of column `col`. */
static const char *variable(const Lower *l, PartialsBy by, uint32_t col) {
  const Model *m = l->e->m;
  if (by == BY_STATE) return component(l, col);
  if (by == BY_INPUTS) return m->inputs.at[col].name;
  uint32_t i = 0;
  while (m->params.at[i].fixed || m->params.at[i].place != col) i++;
  return m->params.at[i].name;
}

Prog *lower_linear(const Eqns *e, Partials dr, PartialsBy by) {
  Lower l = lower_new(e);
  Arena *a = e->m->arena;
  const Entries *A = &e->constraints.A;
  uint32_t nz = e->m->states.n, n = 0;
  Expr *roots = ARENA_ARRAY(a, Expr, dr.n + e->mass.n + A->n + 1);
  for (uint32_t k = 0; k < dr.n; k++) roots[n++] = dr.at[k].e;
  for (uint32_t k = 0; k < e->mass.n; k++) roots[n++] = e->mass.at[k].e;
  for (uint32_t k = 0; k < A->n; k++) roots[n++] = A->at[k].e;
  load_accelerations(&l);
  load_multipliers(&l, 0);
  lower_roots(&l, roots, n);
  for (uint32_t k = 0; k < dr.n; k++) {
    uint32_t row = dr.at[k].row;
    const char *of = row < e->n        ? component(&l, row)
                     : row < e->n + nz ? text_of_symbol(&l, e->m->states.at[row - e->n].rate)
                                       : e->constraints.of[row - e->n - nz]->name;
    prog_store(l.p, 0, k, lower_slot(&l, roots[k]), arena_printf(a, "%s by %s", of, variable(&l, by, dr.at[k].col)));
  }
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *M = &e->mass.at[k];
    prog_store(l.p, 1, k, lower_slot(&l, M->e),
               arena_printf(a, "%s, %s", component(&l, M->row), component(&l, M->col)));
  }
  for (uint32_t k = 0; k < A->n; k++)
    prog_store(l.p, 2, k, lower_slot(&l, A->at[k].e),
               arena_printf(a, "%s, %s", e->constraints.of[A->at[k].row]->name, component(&l, A->at[k].col)));
  return finished(&l, ROLL_FROM);
}

static Slot load_weight(Lower *l, uint32_t i) {
  Name name = arena_printf(l->p->arena, "x%u", i + 1);
  return prog_ins(l->p, (Ins){.op = IR_LOAD, .array = ARR_G, .index = i, .name = name});
}

/* M w = x for the entries of M, which are lowered: by division where M is diagonal, by Cramer's rule for two
 * coordinates, else by one elimination. */
static void solve_weights(Lower *l, const Slot *x, Slot *w) {
  const Eqns *e = l->e;
  uint32_t n = e->n;
  SolveElements M = {0};
  int diagonal = 1;
  for (uint32_t k = 0; k < e->mass.n; k++) {
    uint32_t i = e->mass.at[k].row, j = e->mass.at[k].col;
    vec_push(l->p->arena, &M, ((SolveElement){i * n + j, lower_slot(l, e->mass.at[k].e)}));
    diagonal &= i == j;
  }
  for (uint32_t i = 0, k = 0; i < n && diagonal; i++)
    w[i] = op(l, IR_DIV, x[i], k < M.n && M.at[k].at == i * n + i ? M.at[k++].x : 0);
  if (!diagonal && n == 2) {
    Slot own[2] = {solve_element(&M, 0), solve_element(&M, 3)}, both = solve_element(&M, 2);
    Slot square = op(l, IR_MUL, own[0], own[1]), det = prog_sub_product(l->p, square, both, both);
    for (uint32_t i = 0; i < 2; i++) {
      Slot top = op(l, IR_MUL, x[i], own[1 - i]), less = prog_sub_product(l->p, top, both, x[1 - i]);
      w[i] = op(l, IR_DIV, less, det);
    }
  } else if (!diagonal) prog_solve(l->p, (Solve){.n = e->n, .rhs = x, .list = M}, w);
}

/* Sums of derivatives by (q, q', z), by inputs and parameters; 0: none. */
typedef struct {
  Slot *by_y, *by_up;
} Products;

static uint32_t free_params(const Model *m) {
  uint32_t np = 0;
  for (uint32_t i = 0; i < m->params.n; i++) np += !m->params.at[i].fixed;
  return np;
}

static void add_product(Lower *l, Slot *to, Expr e) {
  Slot x = lower_slot(l, e);
  *to = *to ? op(l, IR_ADD, *to, x) : x;
}

/* Adds the derivatives of a sum whose weights have slots. */
static void add_products(Lower *l, const SumPartials *d, Products *to) {
  const ExprPartials *const parts[] = {&d->by_state, &d->by_inputs, &d->by_params};
  VEC(Expr) roots = {0};
  for (int b = 0; b < 3; b++)
    for (uint32_t k = 0; k < parts[b]->n; k++) vec_push(l->p->arena, &roots, parts[b]->at[k].e);
  lower_roots(l, roots.at, roots.n);
  for (int b = 0; b < 3; b++) {
    Slot *first = b == 0 ? to->by_y : b == 1 ? to->by_up : to->by_up + l->e->m->inputs.n;
    for (uint32_t k = 0; k < parts[b]->n; k++) add_product(l, &first[parts[b]->at[k].index], parts[b]->at[k].e);
  }
}

static void set_weights(Lower *l, const SymId *of, const Slot *w, uint32_t n) {
  for (uint32_t i = 0; i < n; i++) expr_map_set(&l->slots, expr_symbol(l->g, of[i])->node, w[i] + 1);
}

static Products no_products(const Eqns *e) {
  Arena *a = e->m->arena;
  return (Products){ARENA_ARRAY(a, Slot, 2 * e->n + e->m->states.n + 1),
                    ARENA_ARRAY(a, Slot, e->m->inputs.n + e->m->params.n + 1)};
}

/* Stores them, and the derivatives of inputs' formulas. */
static Prog *store_products(Lower *l, const Products *x, const Partials *formulas) {
  const Model *m = l->e->m;
  uint32_t nu = m->inputs.n, np = free_params(m);
  for (uint32_t k = 0; k < formulas->n; k++) lower_roots(l, &formulas->at[k].e, 1);
  for (uint32_t i = 0; i < 2 * l->e->n + m->states.n; i++)
    prog_store(l->p, 0, i, x->by_y[i], x->by_y[i] ? variable(l, BY_STATE, i) : "none");
  for (uint32_t i = 0; i < nu + np; i++)
    prog_store(l->p, 1, i, x->by_up[i],
               !x->by_up[i] ? "none" : i < nu ? variable(l, BY_INPUTS, i) : variable(l, BY_PARAMS, i - nu));
  for (uint32_t k = 0; k < formulas->n; k++)
    prog_store(l->p, 2, k, lower_slot(l, formulas->at[k].e), m->inputs.at[formulas->at[k].row].name);
  return finished(l, ROLL_FROM);
}

Prog *lower_adjoint(const Eqns *e, const AdjointPartials *d) {
  Lower l = lower_new(e);
  uint32_t nz = e->m->states.n, nc = e->constraints.n;
  Products sums = no_products(e);
  Slot *x = ARENA_ARRAY(l.p->arena, Slot, e->n + nz + 1), *w = ARENA_ARRAY(l.p->arena, Slot, e->n + nz + 1),
       *held = ARENA_ARRAY(l.p->arena, Slot, nc + 1);
  load_accelerations(&l);
  load_multipliers(&l, e->n + nz);
  for (uint32_t k = 0; k < e->mass.n; k++) lower_roots(&l, &e->mass.at[k].e, 1);
  for (uint32_t i = 0; i < e->n + nz; i++) w[i] = x[i] = load_weight(&l, i);
  if (nc) lower_held_weights(&l, nc, 0, x, w, held);
  else if (e->n) solve_weights(&l, x, w);
  set_weights(&l, d->w, w, e->n + nz);
  set_weights(&l, d->l, held, nc);
  add_products(&l, &d->S, &sums);
  return store_products(&l, &sums, &d->formulas);
}

Prog *lower_adjoint_projection(const Eqns *e, const AdjointPartials *d) {
  Lower l = lower_new(e);
  const Constraints *of = &e->constraints;
  Products sums = no_products(e);
  Slot *w = ARENA_ARRAY(l.p->arena, Slot, e->n + 1), *held = ARENA_ARRAY(l.p->arena, Slot, of->n + 1);
  for (uint32_t i = 0; i < 2 * e->n + e->m->states.n; i++) sums.by_y[i] = load_weight(&l, i);
  lower_held_weights(&l, of->n, 1, sums.by_y + e->n, w, held);
  set_weights(&l, d->l, held, of->n);
  add_products(&l, &d->r, &sums);
  if (of->nholonomic) {
    lower_held_weights(&l, of->nkept, 1, sums.by_y, w, held);
    set_weights(&l, d->k, held, of->nholonomic);
    add_products(&l, &d->c, &sums);
  }
  return store_products(&l, &sums, &d->formulas);
}

Prog *lower_rates_and_multipliers(const Eqns *e) {
  Lower l = lower_new(e);
  Slot *acc = ARENA_ARRAY(e->m->arena, Slot, e->n + 1);
  lower_solution(&l, acc);
  lower_roots(&l, e->flow, e->m->states.n);
  store_rates(&l, acc);
  for (uint32_t k = 0; k < e->constraints.n; k++) prog_store(l.p, 2, k, l.multipliers[k], e->constraints.of[k]->name);
  return finished(&l, ROLL_FROM);
}

Prog *lower_mass(const Eqns *e) {
  Lower l = lower_new(e);
  for (uint32_t k = 0; k < e->mass.n; k++) lower_roots(&l, &e->mass.at[k].e, 1);
  for (uint32_t k = 0; k < e->mass.n; k++) {
    const MassEntry *M = &e->mass.at[k];
    const char *name = arena_printf(e->m->arena, "%s, %s", component(&l, M->row), component(&l, M->col));
    prog_store(l.p, 0, M->row * e->n + M->col, lower_slot(&l, M->e), name);
    if (M->row != M->col) prog_store(l.p, 0, M->col * e->n + M->row, lower_slot(&l, M->e), name);
  }
  return finished(&l, ROLL_FROM);
}

Prog *lower_forces(const Eqns *e, const Expr *x) {
  Lower l = lower_new(e);
  load_accelerations(&l);
  for (uint32_t i = 0; i < e->n; i++) lower_output(&l, x[i], component(&l, i));
  return outputs_each_step(&l);
}

Prog *lower_event_derivatives(const Eqns *e, EventPartials jumps) {
  Lower l = lower_by_text(e);
  Arena *a = e->m->arena;
  for (uint32_t k = 0; k < jumps.n; k++) {
    const EventPartial *j = &jumps.at[k];
    const char *event = e->m->events.at[j->event].name,
               *of = j->row < 0 ? "its function" : component(&l, (uint32_t)j->row);
    const char *by = j->col < 2 * e->n + e->m->states.n ? component(&l, j->col) : "t";
    lower_output(&l, j->e, arena_printf(a, "event %s: %s by %s", event, of, by));
  }
  return outputs_once(&l);
}

Prog *lower_energy(const Eqns *e) {
  Lower l = lower_new(e);
  if (!e->energy) return l.p;
  const char *what = !e->potential        ? "energy p q' - L"
                     : eqns_has_forces(e) ? "energy p q' - L and the potential of the forces"
                                          : "energy p q' - L of L less a total time derivative";
  lower_output(&l, e->energy_stable, what);
  lower_output(&l, e->energy_scale, "its scale |p q'| + |L|");
  return lower_outputs_seldom(&l); /* in first-order models velocities are rates */
}

Prog *lower_variation(const Eqns *e, const Variation *x) {
  Lower l = lower_new(e);
  const Expr *const parts[] = {x->dLdq, x->momenta, x->forces};
  static const char *const words[] = {"dL/d%s", "p_%s", "Q_%s"};
  for (uint32_t k = 0; k < 3; k++) lower_roots(&l, parts[k], e->n);
  for (uint32_t k = 0; k < 3; k++)
    for (uint32_t i = 0; i < e->n; i++)
      prog_store(l.p, k, i, lower_slot(&l, parts[k][i]), arena_printf(l.p->arena, words[k], e->m->coords.at[i].name));
  return finished(&l, ROLL_FROM);
}

/* Comment of an entry of the second derivatives: d2L/dx' dx, or dQ_x/dx'. */
static const char *second_text(const Lower *l, const SecondEntry *s) {
  const Model *m = l->e->m;
  int force = s->part == SECOND_FQ || s->part == SECOND_FV;
  int of_v = s->part == SECOND_VQ || s->part == SECOND_VV, by_v = s->part == SECOND_VV || s->part == SECOND_FV;
  const char *by = by_v ? text_of_symbol(l, m->coords.at[s->col].v) : m->coords.at[s->col].name;
  const char *of = of_v ? text_of_symbol(l, m->coords.at[s->row].v) : m->coords.at[s->row].name;
  return arena_printf(l->p->arena, force ? "dQ_%s/d%s" : "d2L/d%s d%s", of, by);
}

Prog *lower_second_derivatives(const Eqns *e, const Variation *x) {
  Lower l = lower_new(e);
  for (uint32_t k = 0; k < x->second.n; k++)
    lower_output(&l, x->second.at[k].e, second_text(&l, &x->second.at[k]));
  return outputs_each_step(&l);
}

/* Whether event i ends the touch or the rest of a contact, by its forces. */
static int is_release(const Model *m, uint32_t i) {
  for (uint32_t k = 0; k < m->contacts.n; k++)
    if (m->contacts.at[k].release == i) return 1;
  return 0;
}

Prog *lower_events(const Eqns *e) {
  Lower l = lower_by_text(e), forces = l;
  const Model *m = e->m;
  Expr *roots = ARENA_ARRAY(m->arena, Expr, 2 * m->events.n + 1), *of_forces = roots + m->events.n;
  forces.by_text = 0, forces.by_slips = 1; /* frictions of joints are those that the run holds */
  forces.slots = expr_map(m->arena);
  forces.circular = expr_map(m->arena);
  for (uint32_t i = 0; i < m->events.n; i++) {
    int held = e->switches.nmodes && is_release(m, i);
    roots[i] = held ? 0 : m->events.at[i].g;
    of_forces[i] = held ? m->events.at[i].g : 0;
  }
  lower_with_accelerations(&l, roots, m->events.n);
  lower_with_accelerations(&forces, of_forces, m->events.n);
  for (uint32_t i = 0; i < m->events.n; i++)
    prog_store(l.p, 0, i, lower_slot(roots[i] ? &l : &forces, m->events.at[i].g), m->events.at[i].name);
  return finished(&l, ROLL_FROM);
}

Prog *lower_switches(const Eqns *e) {
  Lower l = lower_new(e);
  const Switches *all = &e->switches;
  for (uint32_t i = 0; i < all->n; i++) lower_output(&l, all->at[i].side, all->at[i].text);
  return lower_outputs_seldom(&l);
}

Prog *lower_sizes(const Eqns *e, int moving) {
  Lower l = lower_new(e);
  for (uint32_t i = 0; i < e->sizes.n; i++)
    if (e->sizes.at[i].moves == moving) lower_output(&l, e->sizes.at[i].value, e->sizes.at[i].what);
  return l.values.n ? lower_outputs_seldom(&l) : NULL;
}

Prog *lower_switch_grips(const Eqns *e) {
  Lower l = lower_new(e);
  int some = 0;
  for (uint32_t i = 0; i < e->switches.nmodes; i++) {
    Expr grip = e->switches.at[i].grip;
    some |= grip != 0;
    lower_output(&l, grip ? grip : expr_int(e->g, 1), e->switches.at[i].surface);
  }
  return some ? lower_outputs_seldom(&l) : NULL;
}

Prog *lower_switch_rates(const Eqns *e) {
  Lower l = lower_new(e);
  const Expr *rates = switch_rates(e);
  for (uint32_t i = 0; i < e->switches.nmodes; i++)
    lower_output(&l, rates[i], arena_printf(e->m->arena, "rate of %s", e->switches.at[i].surface));
  return lower_outputs_seldom(&l);
}

uint32_t lower_array_of_target(SymKind k) { return k == SYM_COORD ? 0 : k == SYM_VEL ? 1 : 2; }

void lower_store_target(Lower *l, SymId target, Expr value) {
  const Symbol *s = expr_symbol(l->g, target);
  prog_store(l->p, lower_array_of_target(s->kind), s->index, lower_slot(l, value), s->name);
}

Prog *lower_action(const Eqns *e, uint32_t event) {
  Lower l = lower_by_text(e);
  const Event *ev = &e->m->events.at[event];
  for (uint32_t i = 0; i < ev->actions.n; i++) lower_roots(&l, &ev->actions.at[i].value, 1);
  for (uint32_t i = 0; i < ev->actions.n; i++)
    lower_store_target(&l, ev->actions.at[i].target, ev->actions.at[i].value);
  return prog_tidy(l.p);
}

static Slot lower_table(Lower *l, const Input *in) {
  Slot t = lower_load(l, ARR_T, expr_symbol(l->g, l->e->m->time));
  vec_push(l->p->arena, &l->p->tables, ((IrTable){in->name, in->file, in->table, in->order}));
  return prog_ins(l->p, (Ins){.op = IR_TABLE, .a = t, .index = l->p->tables.n - 1});
}

Prog *lower_inputs(const Eqns *e) {
  Lower l = lower_by_text(e);
  const Model *m = e->m;
  for (uint32_t i = 0; i < m->inputs.n; i++)
    if (m->inputs.at[i].value) lower_roots(&l, &m->inputs.at[i].value, 1);
  for (uint32_t i = 0; i < m->inputs.n; i++) {
    const Input *in = &m->inputs.at[i];
    Slot s = in->table ? lower_table(&l, in) : lower_slot(&l, in->value);
    prog_store(l.p, 0, i, s, in->name);
  }
  return prog_tidy(l.p);
}

/* Closed forms, and actions behind them, are input symbols numbered behind the model's inputs. */
static int is_of_runs(const Symbol *s, const void *data) {
  return s->kind == SYM_INPUT && s->index >= *(const uint32_t *)data;
}

int output_is_plain(const Eqns *e, uint32_t i) {
  return !(e->m->scene.exacts.n + e->nactions) ||
         !expr_contains(e->g, e->outputs[i], is_of_runs, &e->m->inputs.n);
}

static void name_outputs(Lower *l, int plain_only) {
  for (uint32_t i = 0; i < l->e->noutputs; i++)
    if (!plain_only || output_is_plain(l->e, i)) lower_output(l, l->e->outputs[i], l->e->m->scene.outputs.at[i].name);
}

Prog *lower_output_partials(const Eqns *e, Partials *d) {
  Lower l = lower_new(e), of = l;
  const Model *m = e->m;
  name_outputs(&of, 1);
  for (uint32_t i = 0; i < m->params.n; i++)
    if (!m->params.at[i].fixed) lower_output(&of, m->params.at[i].value, m->params.at[i].name);
  for (uint32_t i = 0; i < m->inputs.n; i++)
    lower_output(&of, m->inputs.at[i].value ? m->inputs.at[i].value : expr_int(e->g, 0), m->inputs.at[i].name);
  *d = eqns_output_partials(e, of.values.at, of.values.n);
  for (uint32_t k = 0; k < d->n; k++) lower_output(&l, d->at[k].e, of.names.at[d->at[k].row]);
  return lower_outputs_seldom(&l);
}

static Prog *outputs(const Eqns *e, int plain_only) {
  Lower l = lower_new(e);
  name_outputs(&l, plain_only);
  return lower_outputs_seldom(&l);
}

Prog *lower_outputs(const Eqns *e) { return outputs(e, 0); }
Prog *lower_plain_outputs(const Eqns *e) { return outputs(e, 1); }

Prog *lower_action_curve(const Eqns *e, uint32_t i) {
  static const char *const names[4] = {"H", "dH/dp", "d2H/dp2", "dH/dq"};
  Lower l = lower_by_text(e);
  for (uint32_t k = 0; k < 4; k++) lower_output(&l, e->actions[i].roots[k], names[k]);
  return lower_outputs_seldom(&l);
}

Prog *lower_momenta(const Eqns *e) {
  Lower l = lower_by_text(e);
  for (uint32_t i = 0; i < e->n; i++) lower_output(&l, e->p[i], e->m->coords.at[i].name);
  return lower_outputs_seldom(&l);
}

Prog *lower_closed_forms(const Eqns *e) {
  Lower l = lower_by_text(e);
  const Scene *sc = &e->m->scene;
  for (uint32_t i = 0; i < sc->exacts.n; i++) lower_output(&l, sc->exacts.at[i].value, sc->exacts.at[i].name);
  return outputs_once(&l);
}
