/* Mobility report of `lagc check`, by ranks of the scaled constraint matrix at the start; and the checks that a
 * motion is possible there. */
#include "claims/expect.h"

#include <math.h>

#include "base/sparse_solve.h"
#include "base/words.h"
#include "mech/frobenius.h"
#include "mech/constrain.h"
#include "mech/consistent_start.h"
#include "numeric/consistent_state.h"
#include "sym/print.h"

/* Whether the rank is the same without constraint k: its multiplier is then not unique. */
static int is_dispensable(StateSolver *s, const Eqns *e, uint32_t k, uint32_t rank) {
  unsigned char *without = ARENA_ARRAY(e->m->arena, unsigned char, e->constraints.n);
  return states_rank(s, k, without, NULL) == rank;
}

static const char *kind_of(const Eqns *e, uint32_t k) {
  const Constraints *all = &e->constraints;
  if (k >= all->nholonomic) return "on velocities";
  return expr_kinds(e->g, all->c[k]) & 1u << SYM_TIME ? "holonomic, with explicit time" : "holonomic";
}

static int has_slope(const Eqns *e, StateSolver *s, const long double *symbols, uint32_t k) {
  const Entries *A = &e->constraints.A;
  StateValues v = states_at(s, symbols);
  for (uint32_t i = 0; i < A->n; i++)
    if (A->at[i].row == k && fabsl(v.A[i]) > 0) return 1;
  return 0;
}

/* The last of the contacts that one statement makes, from constraint k on. */
static uint32_t last_of_family(const Eqns *e, uint32_t k) {
  const Constraints *all = &e->constraints;
  const Contact *first = contact_of_constraint(e->m, all->of[k]);
  for (uint32_t i = k + 1; i < all->n; i++) {
    const Contact *next = contact_of_constraint(e->m, all->of[i]);
    if (!next || next->is_tangent != first->is_tangent || all->of[i]->span.begin != all->of[k]->span.begin)
      return i - 1;
  }
  return all->n - 1;
}

/* A line for a contact, its friction, or a family of them. Returns the last constraint that it is about. */
static uint32_t show_contacts(const Eqns *e, const Contact *contact, uint32_t k, StrBuf *out) {
  uint32_t last = last_of_family(e, k), many = last > k;
  const char *name = e->constraints.of[k]->name, *to = many ? " to " : "",
             *end = many ? e->constraints.of[last]->name : "";
  const char *s = many ? "s" : "", *are = many ? "are" : "is", *they = many ? "they" : "it";
  if (contact->parts) {
    sb_printf(out, "  friction %s (line %u): a constraint, %s = 0, while it sticks\n", e->constraints.of[k]->name,
              source_place(e->m->ast->sources, e->constraints.of[k]->span.begin).line, e->constraints.of[k]->name);
    return k;
  }
  if (contact->is_tangent) {
    sb_printf(out, "  %s friction: %s, %s%s%s = 0, while %s stick%s\n", many ? "their" : "its",
              many ? "constraints" : "a constraint", name, to, end, they, many ? "" : "s");
    return last;
  }
  sb_printf(out, "  %s%s %s%s%s (line %u): ", contact->margin ? "constraint" : "contact", s, name, to, end,
            source_place(e->m->ast->sources, e->constraints.of[k]->span.begin).line);
  if (contact->margin)
    sb_printf(out, "%s, while %s condition%s %s true\n", kind_of(e, k), many ? "their" : "its", s, are);
  else sb_printf(out, "%s while %s %s closed\n", many ? "constraints" : "a constraint", they, are);
  return last;
}

static void show_one(const Eqns *e, StateSolver *s, const long double *symbols, const unsigned char *counts, uint32_t k,
                     uint32_t rank, StrBuf *out) {
  const Constraint *c = e->constraints.of[k];
  Place place = source_place(e->m->ast->sources, c->span.begin);
  sb_printf(out, "  constraint %s (line %u): %s%s", c->name, place.line, kind_of(e, k),
            c->inside ? ", the unit length of a rotation" : "");
  if (!counts[k])
    sb_puts(out, has_slope(e, s, symbols, k) ? "; follows from the constraints before it"
                                             : "; its derivatives vanish at the start");
  if (rank < e->constraints.n - e->m->contacts.n && is_dispensable(s, e, k, rank))
    sb_puts(out, "; its multiplier is not unique: the multipliers of least norm are taken");
  sb_putc(out, '\n');
}

/* --- singular starts: constraints dependent here but not a hundredth away, as for bars in one line --- */

/* The larger rank of the constraints: at a state that obeys them, or at one that is a hundredth away and obeys them,
 * too. loose[n]: the constraints determine this coordinate's velocity near the state but not at it, where the rank
 * is smaller. symbols: values by symbol. */
static uint32_t nearby_rank(const Eqns *e, StateSolver *s, const long double *symbols, long double *loose) {
  Arena *arena = e->m->arena;
  uint32_t n = e->n, all = expr_symbol_count(e->g) + 1;
  long double *held = ARENA_ARRAY(arena, long double, n + 1), *held_beside = ARENA_ARRAY(arena, long double, n + 1),
              *there = ARENA_ARRAY(arena, long double, all);
  unsigned char *counts = ARENA_ARRAY(arena, unsigned char, e->constraints.n);
  states_at(s, symbols);
  uint32_t here = states_rank(s, UINT32_MAX, counts, held), rank = here;
  for (uint32_t i = 0; i < all; i++) there[i] = symbols[i];
  if (n > 1 && start_beside(e, s, there)) rank = states_rank(s, UINT32_MAX, counts, held_beside);
  for (uint32_t i = 0; i < n; i++) loose[i] = 0;
  if (rank <= here) return here;
  lag_loose_directions((int)n, held, held_beside, loose);
  return rank;
}

/* A line if the start is singular: the rank is larger near it. */
static void show_singular(const Eqns *e, StateSolver *s, const long double *symbols, uint32_t rank, StrBuf *out) {
  long double *loose = ARENA_ARRAY(e->m->arena, long double, e->n + 1);
  uint32_t beside = nearby_rank(e, s, symbols, loose), shown = 0;
  if (beside <= rank) return;
  sb_printf(out, "  singular start: the rank is %u near it", beside);
  for (uint32_t i = 0; i < e->n; i++)
    if (loose[i] > 0)
      sb_printf(out, "%s%s'", shown++ ? ", " : "; the constraints do not determine ", e->m->coords.at[i].name);
  sb_printf(out, "%s\n", shown ? " here; their start values decide which way the motion goes" : "");
  states_at(s, symbols);
}

static void show_integrability(const Eqns *e, StateSolver *s, StrBuf *out) {
  static const char *const words[] = {[INTEGRABLE_NO] = "are not integrable: the system is nonholonomic",
                                      [INTEGRABLE_PROVED] = "are integrable: they could be stated for positions",
                                      [INTEGRABLE_UNDECIDED] = "are integrable at all states tried; not proved"};
  const Constraints *all = &e->constraints;
  uint32_t held = 0;
  for (uint32_t i = all->nholonomic; i < all->n; i++) held += !contact_of_constraint(e->m, all->of[i]);
  if (!held) return;
  sb_printf(out, "  constraints on velocities %s\n", words[frobenius(e, s)]);
  for (uint32_t i = all->nholonomic; i < all->nkept; i++) {
    sb_printf(out, "  constraint %s keeps ", all->of[i]->name);
    const Contact *switched = contact_of_constraint(e->m, all->of[i]);
    Expr one = expr_int(e->g, 1),
         kept = switched ? expr_replace(e->g, all->c[i], &switched->closed, &one, 1) : all->c[i];
    expr_print(e->g, kept, PRINT_TEXT, out);
    sb_puts(out, switched ? " as it is when it begins to hold\n" : " as it is at the start\n");
  }
}

/* --- starts from which no motion is possible --- */

/* The first constraint whose row depends on earlier rows but whose right-hand side contradicts theirs; UINT32_MAX:
 * none. symbols: a state on the constraints. Accelerations that move less than a billionth of the model's size
 * during the scene count as rounding. */
static uint32_t contradicting(const Eqns *e, StateSolver *s, const long double *symbols, const unsigned char *counts) {
  const Constraints *k = &e->constraints;
  const Scene *scene = &e->m->scene;
  Arena *arena = e->m->arena;
  uint32_t n = e->n, at = 0;
  StateValues v = states_at(s, symbols);
  long double *size = ARENA_ARRAY(arena, long double, k->n + 1), most = 0;
  long double span = scene->has_span && scene->t1 != scene->t0 ? fabsl((long double)scene->t1 - scene->t0) : 1;
  const int *scale = states_column_scale(s);
  for (uint32_t i = 0; i < k->A.n; i++) size[k->A.at[i].row] += ldexpl(v.A[i] * v.A[i], 2 * scale[k->A.at[i].col]);
  for (uint32_t i = 0; i < k->n; i++) {
    size[i] = sqrtl(size[i]);
    if (size[i] > 0) most = fmaxl(most, fabsl(v.demand[i]) / size[i]);
  }
  long double far = 0;
  for (uint32_t i = 0; i < n; i++) far = fmaxl(far, fabsl(ldexpl(symbols[e->m->coords.at[i].q], -scale[i])));
  if (!(most > 1e-9L * (far > 0 ? far : 1) / (span * span))) return UINT32_MAX;
  RowSpan demands = row_span(arena, n + 1); /* rows [A_k, demand_k] */
  for (uint32_t i = 0; i < k->n; i++) {
    SparseVector row = *states_row(s, i, &at);
    if (!(size[i] > 0)) continue;
    for (uint32_t j = 0; j < row.n; j++) row.at[j].value /= size[i];
    vec_push(arena, &row, ((RowElement){n, v.demand[i] / size[i] / most}));
    if (row_span_add(&demands, row.at, row.n, 1e-5L) > 1e-5L && !counts[i]) return i;
  }
  return UINT32_MAX;
}

static int report_contradiction(const Eqns *e, uint32_t k, const char *why) {
  const Model *m = e->m;
  return diag_error(m->diags, e->constraints.of[k]->span,
                    "scene %s: the constraint `%s` contradicts the constraints before it: %s" HELP
                    "leave one of them out, or make them agree",
                    m->scene.name, e->constraints.of[k]->name, why);
}

/* Whether redundant constraints agree: in their accelerations at the start, and in the states that they allow a
 * little later. */
static int check_agreement(const Eqns *e, StateSolver *s, const long double *symbols, const unsigned char *counts) {
  const Model *m = e->m;
  uint32_t n = expr_symbol_count(e->g) + 1, k = contradicting(e, s, symbols, counts);
  if (k != UINT32_MAX)
    return report_contradiction(e, k, "at the start it follows from them, but demands another acceleration");
  long double *later = ARENA_ARRAY(m->arena, long double, n);
  for (uint32_t i = 0; i < n; i++) later[i] = symbols[i];
  later[m->time] += (m->scene.has_span ? (long double)m->scene.t1 - m->scene.t0 : 1) / 1024;
  StartResult r = start_find(e, s, later);
  if (r.kind == LAG_START_NONE || r.kind == LAG_START_BROKEN)
    return report_contradiction(
        e, r.constraint,
        arena_printf(m->arena, "at t = %.3Lg s no state obeys them all%s", later[m->time], start_residual_text(e, &r)));
  return 1;
}

/* Index of the largest component, the first of several that are alike. */
static uint32_t largest_part(const long double *x, uint32_t n) {
  uint32_t most = 0;
  for (uint32_t j = 0; j < n; j++)
    if (fabsl(x[j]) > fabsl(x[most]) * (1 + 1e-9L)) most = j;
  return most;
}

/* Whether M is regular on the kernel of the constraints at the start. */
static int check_inertia(const Eqns *e, StateSolver *s, const long double *symbols) {
  const Model *m = e->m;
  /* definite_mass says that M has no negative direction; M may still be singular */
  if (!e->mass_known || (e->definite_mass && !e->singular_mass)) return 1;
  long double *null = ARENA_ARRAY(m->arena, long double, e->n + 1);
  states_at(s, symbols);
  if (sparse_is_regular_on_kernel(m->arena, e->n, e->constraints.n, states_system(s), null)) return 1;
  uint32_t most = largest_part(null, e->n);
  diag_error(m->diags, m->coords.at[most].span,
             "scene %s: the motion of `%s` is undetermined: it has no inertia at the start, and no constraint moves it",
             m->scene.name, m->coords.at[most].name);
  diag_help(m->diags, "give it a mass, or a constraint that depends on it");
  return 0;
}

/* The mistake in the values of a contact, or NULL. value: gap, restitution, friction, static friction; far: the
 * largest coordinate. */
static const char *contact_mistake(const Eqns *e, const Contact *c, const long double *value, long double far) {
  Arena *a = e->m->arena;
  const Contact *gap = c;
  while (gap->is_tangent && !gap->parts) gap--;
  const char *name = gap->name;
  if (c->is_tangent && !(value[3] >= value[2]))
    return arena_printf(
        a, "the %s `%s` has a static friction of %.3Lg, which must be at least its friction while it slips, %.3Lg",
        c->parts ? "friction" : "contact", name, value[3], value[2]);
  if (c->is_tangent && !(value[2] >= 0))
    return arena_printf(a, "the contact `%s` has a friction of %.3Lg, which must be at least 0", name, value[2]);
  if (!c->is_tangent && value[0] < -1e-12L * (far > 1 ? far : 1))
    return arena_printf(a, "the start is inside the contact `%s`: its gap is %.3Lg", name, value[0]);
  if (isnan(value[0])) return arena_printf(a, "the contact `%s` has no value at the start", name);
  if (value[1] >= 0 && value[1] <= 1) return NULL;
  return arena_printf(a, "the contact `%s` has a %srestitution of %.3Lg, which must be between 0 and 1", name,
                      c->is_tangent ? "tangential " : "", value[1]);
}

/* Whether all gaps of contacts are nonnegative at the start, restitutions between 0 and 1, and frictions
 * nonnegative. */
static int check_contacts(const Eqns *e, const long double *symbols) {
  const Model *m = e->m;
  uint32_t n = m->contacts.n;
  Expr *roots = ARENA_ARRAY(m->arena, Expr, 4 * (size_t)n + 1);
  long double *value = ARENA_ARRAY(m->arena, long double, 4 * (size_t)n + 1), far = 0;
  for (uint32_t i = 0; i < n; i++) {
    const Contact *c = &m->contacts.at[i];
    roots[4 * i] = c->margin ? expr_int(e->g, 1) : c->gap,
              roots[4 * i + 1] = c->margin ? expr_int(e->g, 1) : c->restitution;
    roots[4 * i + 2] = c->is_tangent ? c->friction : expr_int(e->g, 0);
    roots[4 * i + 3] = c->is_tangent ? c->hold : expr_int(e->g, 0);
  }
  expr_eval(e->g, roots, 4 * n, symbols, value);
  for (uint32_t i = 0; i < e->n; i++) far = fmaxl(far, fabsl(symbols[m->coords.at[i].q]));
  for (uint32_t i = 0; i < n; i++) {
    const char *wrong = contact_mistake(e, &m->contacts.at[i], value + 4 * i, far);
    if (!wrong) continue;
    diag_error(m->diags, m->constraints.at[m->contacts.at[i].constraint].span, "scene %s: %s", m->scene.name, wrong);
    return 0;
  }
  return 1;
}

static int says_start(const Model *m) {
  for (uint32_t i = 0; i < m->scene.starts.n; i++)
    if (!m->scene.starts.at[i].implied) return 1;
  return m->scene.family_starts.n != 0;
}

/* Without constraints: whether M is regular at the start, as it is not at the pole of angles. */
static int check_mass(const Eqns *e) {
  const Model *m = e->m;
  if (!e->n || !e->mass_known || e->constant_mass) return 1;
  long double *null = ARENA_ARRAY(m->arena, long double, e->n + 1);
  StateSolver *s = states_new(e);
  StateValues v = states_at(s, start_requested(e));
  for (uint32_t k = 0; k < e->mass.n; k++)
    if (!isfinite(v.mass[k])) return 1; /* the run says where */
  if (sparse_is_regular_on_kernel(m->arena, e->n, 0, states_system(s), null)) return 1;
  uint32_t most = largest_part(null, e->n);
  diag_error(m->diags, m->coords.at[most].span,
             "scene %s: the mass matrix is singular at the start: the acceleration of `%s` is undetermined there",
             m->scene.name, m->coords.at[most].name);
  diag_help(m->diags, "start elsewhere, or take coordinates without such a place: a body's `coord R: rotation` has no "
                      "pole (`lagc help rotations`)");
  return 0;
}

int mobility_show(const Eqns *e, StrBuf *out) {
  const Constraints *all = &e->constraints;
  if (!all->n) return !says_start(e->m) || check_mass(e);
  StateSolver *s = states_new(e);
  long double *symbols = start_requested(e);
  StartResult start = start_find(e, s, symbols);
  if (start.kind != LAG_START_FOUND) {
    if (says_start(e->m)) start_report(e, &start);
    else sb_printf(out, "scene %s: %u constraint%s; the scene gives no start, and from 0 no state is found "
                        "that obeys `%s`%s\n", e->m->scene.name, all->n,
                   plural(all->n), all->of[start.constraint]->name, start_residual_text(e, &start));
    return !says_start(e->m);
  }
  states_at(s, symbols);
  unsigned char *counts = ARENA_ARRAY(e->m->arena, unsigned char, all->n);
  uint32_t rank = states_rank(s, UINT32_MAX, counts, NULL), free = e->n - rank;
  uint32_t held = all->n - e->m->contacts.n;
  if (rank < held && !check_agreement(e, s, symbols, counts)) return 0;
  if (!check_inertia(e, s, symbols) || (e->m->scene.starts.n && !check_contacts(e, symbols))) return 0;
  states_at(s, symbols);
  sb_printf(out, "scene %s: %u degree%s of freedom", e->m->scene.name, free, plural(free));
  if (held) sb_printf(out, "; %u constraint%s, of rank %u at the start", held, plural(held), rank);
  sb_putc(out, '\n');
  if (rank < held) show_singular(e, s, symbols, rank, out);
  for (uint32_t k = 0; k < all->n; k++) {
    const Contact *contact = contact_of_constraint(e->m, all->of[k]);
    if (contact) k = show_contacts(e, contact, k, out);
    else show_one(e, s, symbols, counts, k, rank, out);
  }
  show_integrability(e, s, out);
  return 1;
}
