/* Generators of declared symmetries, their charges, and messages about symmetries that do not hold. */
#include "model/printed_text.h"
#include "symmetry/charges.h"

#include "mech/constrain.h"
#include "mech/derive_equations.h"
#include "mech/lagrange.h"
#include "mech/switches.h"
#include "phase_space/action_outputs.h"
#include "phase_space/expression_brackets.h"
#include "sym/family_rows.h"
#include "sym/simplify.h"

/* --- generators and charges --- */

static Generator generator_of(const Eqns *e, const Symmetry *y) {
  uint32_t n = eqns_coordinates(e);
  Expr *xi = ARENA_ARRAY(e->m->arena, Expr, n + 1);
  uint32_t *place = ARENA_ARRAY(e->m->arena, uint32_t, expr_symbol_count(e->g) + 1); /* 1 + index */
  Generator by = {.xi = xi};
  for (uint32_t i = 0; i < n; i++) place[eqns_coordinate(e, i)] = i + 1;
  vec_each(const Move, move, y->moves) {
    if (move->target == e->m->time) by.tau = move->rate;
    if (place[move->target]) xi[place[move->target] - 1] = move->rate;
  }
  return by;
}

static Charge charge_of(const Eqns *e, const Symmetry *y) {
  ExprGraph *g = e->g;
  Generator by = generator_of(e, y);
  Charge c = {.of = y, .name = y->name, .unit = y->unit, .proof = noether_prove(e, &by)};
  c.value = c.proof.charge == e->energy ? e->energy_stable : simplify_stable(g, c.proof.charge);
  c.scale = simplify_stable(g, c.proof.scale);
  return c;
}

/* The one judgement of the energy, which all commands quote; a potential that completes it becomes a part of
 * e->energy. */
static Charge energy_of(Eqns *e) {
  Charge c = {.name = "energy", .unit = e->m->energy_unit, .proof = noether_energy(e)};
  Expr V = c.proof.potential;
  if (V) {
    e->potential = V;
    e->energy = c.proof.charge = expr_add(e->g, e->energy, V);
    e->energy_stable = simplify_stable(e->g, expr_add(e->g, e->energy_stable, V));
    e->energy_scale = expr_add(e->g, e->energy_scale, expr_fn(e->g, EX_ABS, V));
  }
  e->conserves_energy = c.proof.drift == PROVED_ZERO && !c.proof.by_formulas && !c.proof.jumps;
  e->loses_energy = e->loses_energy && !e->conserves_energy && noether_forces_are_potential(e);
  c.value = e->energy_stable;
  c.scale = e->energy_scale;
  return c;
}

/* Fills e->charges: the energy first, then those of declared symmetries in order. None without a Lagrangian. */
static void charges_derive(Eqns *e) {
  const Model *m = e->m;
  Charge *all = ARENA_ARRAY(m->arena, Charge, m->symmetries.n + 1);
  if (!e->energy) return;
  all[0] = energy_of(e);
  for (uint32_t i = 0; i < m->symmetries.n; i++) all[i + 1] = charge_of(e, &m->symmetries.at[i]);
  e->charges = all;
  e->ncharges = m->symmetries.n + 1;
}

static ChargeNames charge_names(const Eqns *e) {
  const Model *m = e->m;
  SymId *syms = ARENA_ARRAY(m->arena, SymId, m->symmetries.n + 1);
  Expr *with = ARENA_ARRAY(m->arena, Expr, m->symmetries.n + 1);
  for (uint32_t i = 0; i < m->symmetries.n; i++) {
    syms[i] = m->symmetries.at[i].charge;
    with[i] = e->charges[i + 1].value;
  }
  return (ChargeNames){syms, with, m->symmetries.n};
}

Expr charges_substitute(const Eqns *e, Expr x) {
  if (!(expr_kinds(e->g, x) & 1u << SYM_LOCAL)) return x;
  ChargeNames names = charge_names(e);
  if (names.n) x = expr_replace(e->g, x, names.sym, names.value, names.n);
  return expression_brackets_substitute(e, x, 0);
}

/* The scene's outputs, with the energy, charges and actions that they name filled in, and velocities of a
 * Hamiltonian as in its forces, so that both stick together. */
static int fill_outputs(Eqns *e) {
  const Model *m = e->m;
  ExprGraph *g = e->g;
  Expr *out = ARENA_ARRAY(m->arena, Expr, m->scene.outputs.n + 1);
  Expr *action = ARENA_ARRAY(m->arena, Expr, m->actions.n + 1);
  if (!action_outputs(e, action)) return 0;
  uint32_t nsymbols = expr_symbol_count(g) + 1;
  Expr *with = ARENA_ARRAY(m->arena, Expr, nsymbols);
  with[m->energy_sym] = e->energy_stable;
  for (uint32_t k = 0; k < m->actions.n; k++) with[m->actions.at[k].sym] = action[k];
  for (uint32_t k = 0; k < m->pairs.n && m->hamiltonian; k++)
    with[m->states.at[m->pairs.at[k].q].rate] = e->first.velocity[k];
  for (uint32_t i = 0; i < m->scene.outputs.n; i++) {
    out[i] = charges_substitute(e, m->scene.outputs.at[i].value);
    if (e->energy) out[i] = expr_substitute(g, out[i], with, nsymbols, "");
    out[i] = switches_keep(e, out[i], simplify_stable);
  }
  arena_release(m->arena, with, nsymbols * sizeof *with);
  e->outputs = out;
  e->noutputs = m->scene.outputs.n;
  return 1;
}

/* --- verdicts --- */

/* x with definitions expanded that are not the user's: derivatives of lets, whose names mean something only where
 * all definitions are printed. */
static Expr in_own_names(const Eqns *e, Expr x) {
  enum { DEEPEST = 64 };
  Arena *a = e->m->arena;
  ExprMap own = expr_map(a);
  VEC(Expr) said = {0};
  vec_push(a, &said, e->m->lagrangian);
  for (uint32_t i = 0; e->Q && i < eqns_coordinates(e); i++) vec_push(a, &said, e->Q[i]);
  for (uint32_t i = 0; i < e->constraints.n; i++) vec_push(a, &said, e->constraints.r[i]);
  ExprList known = expr_topo(e->g, said.at, said.n);
  for (uint32_t i = 0; i < known.n; i++) expr_map_set(&own, known.at[i], 1);
  for (uint32_t turn = 0; turn < DEEPEST; turn++) {
    VEC(Expr) defs = {0}, bodies = {0};
    ExprList nodes = expr_topo_shallow(e->g, &x, 1);
    for (uint32_t i = 0; i < nodes.n; i++) {
      if (expr_op(e->g, nodes.at[i]) != EX_DEF || expr_map_get(&own, nodes.at[i])) continue;
      vec_push(a, &defs, nodes.at[i]);
      vec_push(a, &bodies, expr_arg(e->g, nodes.at[i], 0));
    }
    if (!defs.n) break;
    expr_replace_nodes(e->g, &x, 1, defs.at, bodies.at, defs.n, &x);
  }
  return x;
}

static const char too_long[] = "(too long to print)";
static const char *text_of(const Eqns *e, Expr x) {
  const double longest = 1e5;
  uint32_t distinct;
  StrBuf b = strbuf(e->m->arena);
  x = in_own_names(e, x);
  if (expr_tree_size(e->g, x, &distinct) > longest) return too_long;
  expr_print_checked(e->m, x, PRINT_TEXT, &b);
  return family_sum(e->m->arena, sb_text(&b), PRINT_TEXT);
}

static int holds(const Charge *c) {
  return (c->proof.is == INVARIANT || c->proof.is == INVARIANT_UP_TO_F) && !c->proof.broken;
}

/* "`x` or `y`": maps of which one with the opposite sign would make the symmetry hold; *one: one of them, or NULL;
 * *n: their number. */
static const char *wrong_signs(const Eqns *e, const Symmetry *y, const Move **one, uint32_t *n) {
  enum { MOST = 12 };
  Symmetry other = *y;
  StrBuf names = strbuf(e->m->arena);
  *n = 0;
  for (uint32_t i = 0; i < y->moves.n && y->moves.n > 1 && y->moves.n <= MOST; i++) {
    Move *moves = ARENA_ARRAY(e->m->arena, Move, y->moves.n);
    memcpy(moves, y->moves.at, y->moves.n * sizeof *moves);
    moves[i].rate = expr_neg(e->g, moves[i].rate);
    other.moves.at = moves;
    Generator by = generator_of(e, &other);
    Charge c = {.proof = noether_prove(e, &by)};
    if (!holds(&c)) continue;
    sb_printf(&names, "%s`%s`", (*n)++ ? " or " : "", expr_symbol(e->g, moves[i].target)->name);
    *one = &y->moves.at[i];
  }
  return sb_text(&names);
}

static void report_broken(const Eqns *e, const Charge *c) {
  const Constraint *k = e->constraints.of[c->proof.broken - 1];
  Diags *d = e->m->diags;
  diag_error(d, c->of->span, "the symmetry `%s` does not keep to the constraint `%s`", c->name, k->name);
  diag_also(d, k->span,
            "to first order in its parameter, it changes the left minus the right side of this constraint by %s",
            text_of(e, c->proof.breaks));
}

static void report_false(const Eqns *e, const Charge *c) {
  Diags *d = e->m->diags;
  const Noether *n = &c->proof;
  const Move *wrong = NULL;
  uint32_t signs;
  const char *names = wrong_signs(e, c->of, &wrong, &signs), *left = text_of(e, n->remainder);
  const char *what = expr_is_zero(e->g, n->F)
                         ? "delta L"
                         : arena_printf(e->m->arena, "delta L - dF/dt, with F = %s,", text_of(e, n->F));
  diag_error(d, signs == 1 ? wrong->span : c->of->span,
             "the symmetry `%s` is false: it changes L by more than a total derivative", c->name);
  if (signs)
    diag_help(d, "the remainder of %s is %s; it would be 0 if the change of %s had the opposite sign", what, left,
              names);
  else diag_help(d, "the remainder of %s is %s", what, left);
}

static void report_undecided(const Eqns *e, const Charge *c) {
  Diags *d = e->m->diags;
  diag_error(d, c->of->span, "the symmetry `%s` is not decided", c->name);
  if (c->proof.product) {
    diag_also(d, c->proof.product->span,
              "it holds at all states found, which may leave out one factor of this constraint; write the factor that "
              "is meant as the constraint");
    return;
  }
  diag_help(d, "no F(q, t) with dF/dt = %s was found, and no proof that there is none", text_of(e, c->proof.remainder));
}

int charges_judge(const Eqns *e, Name effect) {
  int good = 1;
  for (uint32_t i = 1; i < e->ncharges; i++) {
    const Charge *c = &e->charges[i];
    if (c->of->effect != effect || holds(c)) continue;
    if (c->proof.is == NOT_INVARIANT) report_false(e, c);
    else if (c->proof.is == INVARIANCE_NOT_DECIDED) report_undecided(e, c);
    else report_broken(e, c);
    good = 0;
  }
  return good;
}

#define NO_RATE "L depends on an input whose rate of change is not known"

/* "d(spin)/dt = ...". */
static const char *power_text(const Eqns *e, const Charge *c) {
  if (c->proof.power_unknown) return arena_printf(e->m->arena, "d(%s)/dt: " NO_RATE, c->name);
  return arena_printf(e->m->arena, "d(%s)/dt = %s", c->name, text_of(e, c->proof.power));
}

/* Appends "; changes: d(spin)/dt = ...", unless the charge is conserved. */
static void put_balance(const Eqns *e, const Charge *c, StrBuf *out) {
  if (c->proof.drift == PROVED_ZERO) return;
  const char *how = c->proof.over_time              ? "without that integral"
                    : c->proof.drift == NOT_DECIDED ? "not decided whether it changes"
                                                    : "changes";
  sb_printf(out, "; %s: %s", how, c->proof.power_unknown ? NO_RATE : power_text(e, c));
}

/* Whether events, kicks or impacts change the motion, and so the energy. */
static int motion_jumps(const Model *m) {
  for (uint32_t i = 0; i < m->events.n; i++)
    if (m->events.at[i].actions.n) return 1;
  return m->contacts.n > 0;
}

/* Reason of a conserved energy beside which forces, or constraints that move, act. */
static const char *reason_of(const Eqns *e) {
  const char *of = eqns_has_forces(e) ? "the potential %s of the forces" : "%s, as L has a total time derivative";
  if (e->potential)
    return arena_printf(e->m->arena, arena_printf(e->m->arena, ", with %s", of), text_of(e, e->potential));
  if (eqns_has_forces(e)) return ": the forces do no work";
  return constraints_do_no_work(e) ? "" : ": the constraints do no work";
}

const char *charges_drift_word(Verdict drift) {
  static const char *const words[] = {
      [PROVED_ZERO] = "conserved", [PROVED_NONZERO] = "changes", [NOT_DECIDED] = "not decided"};
  return words[drift];
}

const char *charges_energy_word(const Eqns *e) {
  if (!e->ncharges) return "";
  return charges_drift_word(e->charges[0].proof.jumps ? PROVED_NONZERO : e->charges[0].proof.drift);
}

/* ", which is 0 in this scene, where c = 0" where a power is 0 with the parameters and inputs that are 0 in the scene;
 * else "". */
static const char *zero_here(const Eqns *e, Expr power) {
  const Model *m = e->m;
  StrBuf names = {.arena = m->arena};
  Expr zero = expr_int(e->g, 0), at = power;
  uint32_t all = m->params.n + m->inputs.n, n = 0;
  SymId *sym = ARENA_ARRAY(m->arena, SymId, all + 1);
  Expr *zeros = ARENA_ARRAY(m->arena, Expr, all + 1);
  for (uint32_t i = 0; i < all; i++) {
    const Param *p = i < m->params.n ? &m->params.at[i] : NULL;
    const Input *u = p ? NULL : &m->inputs.at[i - m->params.n];
    Expr value = p ? p->value : u->text || u->order ? u->value : 0; /* that of a table is not known */
    if (!value || !expr_is_zero(e->g, expr_replace(e->g, value, sym, zeros, n))) continue;
    sym[n] = p ? p->sym : u->sym;
    zeros[n++] = zero;
    if (!expr_contains_sym(e->g, power, sym[n - 1])) continue;
    Name name = p ? p->name : u->name;
    int alone = expr_is_zero(e->g, expr_replace(e->g, power, &sym[n - 1], &zero, 1));
    if (alone) return arena_printf(m->arena, ", which is 0 in this scene, where %s = 0", name);
    at = expr_replace(e->g, at, &sym[n - 1], &zero, 1);
    sb_printf(&names, "%s%s = 0", names.n ? ", " : "", name);
  }
  int is = names.n && expr_is_zero(e->g, simplify(e->g, at));
  return is ? arena_printf(m->arena, ", which is 0 in this scene, where %s", names.at) : "";
}

const char *charges_energy_text(const Eqns *e) {
  enum { LINE = 100 };
  const Noether *is = &e->charges[0].proof;
  if (is->jumps) return "energy changes (L jumps, and the energy with it)";
  const char *events = e->m->families.n     ? " while contacts of families are open"
                       : motion_jumps(e->m) ? " between events"
                                            : "";
  const char *name = e->m->hamiltonian ? "H" : "E";
  const char *inputs = is->by_formulas ? " while inputs follow their formulas" : "";
  if (is->drift == PROVED_ZERO)
    return arena_printf(e->m->arena, "energy is conserved%s%s%s", events, inputs, reason_of(e));
  const char *verdict =
      is->drift == PROVED_NONZERO ? "energy changes"
      : is->open_integral == 2    ? "not decided whether the energy is conserved; with a potential of the forces, "
                                    "an integral that is not found, it is"
      : is->open_integral == 3    ? "not decided whether the energy is conserved; forces couple many coordinates, and "
                                    "no potential of theirs is looked for: if they have one, give it as `potential`"
      : is->open_integral         ? "not decided whether the energy is conserved; it is if one potential of the forces "
                                    "holds everywhere, as it does near each position"
                                  : "not decided whether the energy is conserved";
  if (is->power_unknown) return arena_printf(e->m->arena, "%s: " NO_RATE, verdict);
  const char *power = text_of(e, is->power);
  const char *here = zero_here(e, is->power);
  return strlen(power) <= LINE && power != too_long
             ? arena_printf(e->m->arena, "%s: d%s/dt = %s%s", verdict, name, power, here)
             : arena_printf(e->m->arena, "%s; `lagc derive` prints d%s/dt%s", verdict, name, here);
}

/* F, with the integral that the printed charge omits. */
static const char *gauge_text(const Eqns *e, const Noether *is) {
  const char *F = text_of(e, is->F);
  if (!is->over_time) return F;
  return arena_printf(e->m->arena, "%s%sintegral of %s over t", expr_is_zero(e->g, is->F) ? "" : F,
                      expr_is_zero(e->g, is->F) ? "" : " + the ", text_of(e, is->over_time));
}

static const char *place_text(const Eqns *e, const Symmetry *y) {
  Place p = source_place(e->m->ast->sources, y->span.begin);
  return arena_printf(e->m->arena, "%s:%u", p.file ? p.file->path : "", p.line);
}

void charges_print(const Eqns *e, Name effect, StrBuf *out) {
  for (uint32_t i = 1; i < e->ncharges; i++) {
    const Charge *c = &e->charges[i];
    const char *how = c->proof.by_value ? "holds on the constraints, in numbers" : "proved";
    const char *proved =
        c->proof.jumps ? arena_printf(e->m->arena, "%s%s between jumps", how, c->proof.by_value ? "," : "") : how;
    if (c->of->effect != effect) continue;
    sb_printf(out, "%s: symmetry %s: ", place_text(e, c->of), c->name);
    if (!holds(c)) sb_puts(out, c->proof.is == INVARIANCE_NOT_DECIDED ? "not decided" : "false");
    else if (c->proof.is == INVARIANT) sb_printf(out, "%s; charge %s", proved, text_of(e, c->proof.charge));
    else
      sb_printf(out, "%s up to dF/dt, F = %s; charge %s", proved, gauge_text(e, &c->proof),
                text_of(e, c->proof.charge));
    if (holds(c)) put_balance(e, c, out);
    sb_putc(out, '\n');
  }
}

void charges_show_broken(const Eqns *e, StrBuf *out) {
  for (uint32_t i = 0; i < e->ncharges; i++) {
    const Charge *c = &e->charges[i];
    if ((c->proof.drift == PROVED_ZERO && !c->proof.jumps) || (!c->of && e->m->symmetries.n == 0)) continue;
    sb_printf(out, "  %s%s\n", power_text(e, c),
              c->proof.jumps && !c->proof.power_unknown ? " between jumps of L" : "");
  }
}

static Eqns *complete(Eqns *e) {
  if (!e) return NULL;
  charges_derive(e);
  ChargeNames names = charge_names(e);
  if (!expression_brackets_derive(e, &names)) return NULL;
  if (!fill_outputs(e)) return NULL;
  if (!e->m->effects.n && !charges_judge(e, NULL)) return NULL; /* with effects it may be broken on purpose */
  lagrange_squares(e);
  return eqns_check_numbers(e) ? e : NULL;
}

Eqns *equations_of(const Model *m) { return complete(eqns_derive(m)); }

Eqns *equations_regularised(const Eqns *singular) { return complete(eqns_derive_regularised(singular)); }
