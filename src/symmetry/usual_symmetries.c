/* Builds usual generators, proves each by noether_prove, and lists the proved ones. */
#include "symmetry/find_symmetries_impl.h"

#include <ctype.h>

#include "symmetry/symmetry_names.h"

enum { SEARCH_MOST = 100, KINDS_MOST = 6 };

typedef struct {
  Eqns *e;
  ExprGraph *g;
  uint32_t n;
  Expr t;
  CoordinateNames names;
  FoundSymmetries *out;
  SearchLimit *limit;
} TrialWork;

static Name name_of(const TrialWork *w, uint32_t i) { return expr_symbol(w->g, eqns_coordinate(w->e, i))->name; }
static Expr node(const TrialWork *w, uint32_t i) { return expr_symbol(w->g, eqns_coordinate(w->e, i))->node; }

static Expr *zero_components(const TrialWork *w) {
  Expr *xi = ARENA_ARRAY(w->e->m->arena, Expr, w->n + 1);
  for (uint32_t i = 0; i < w->n; i++) xi[i] = expr_int(w->g, 0);
  return xi;
}

/* Lists the generator if it is proved. */
static int try_one(TrialWork *w, const Expr *xi, Expr tau, FoundSymmetry as) {
  if (!search_goes_on(w->limit, 0)) return 0;
  as.by = (Generator){.xi = xi, .tau = tau};
  as.is = noether_prove(w->e, &as.by);
  if ((as.is.is != INVARIANT && as.is.is != INVARIANT_UP_TO_F) || as.is.by_value || as.is.broken) return 0;
  if (as.kind == SYMMETRY_MOMENTUM && as.of_all && as.is.is == INVARIANT_UP_TO_F &&
      (expr_kinds(w->g, as.is.F) & 1u << SYM_COORD))
    as.name = arena_printf(w->e->m->arena, "magnetic translation of all bodies along %s", axis_text(as.axis));
  vec_push(w->e->m->arena, &w->out->all, as);
  return 1;
}

/* A translation of all coordinates of i's kind, and a boost. */
static void try_kind(TrialWork *w, uint32_t i) {
  Arena *a = w->e->m->arena;
  Expr *shift = zero_components(w), *boost = zero_components(w);
  uint32_t axis = name_axis(&w->names, i);
  int of_all = axis != AXIS_NONE;
  for (uint32_t k = i; k < w->n; k++)
    if (name_same_kind(&w->names, i, k)) shift[k] = expr_int(w->g, 1), boost[k] = w->t;
  Name what = of_all ? axis_text(axis) : arena_strndup(a, name_of(w, i), strcspn(name_of(w, i), "["));
  try_one(w, shift, expr_int(w->g, 0),
          (FoundSymmetry){.kind = SYMMETRY_MOMENTUM,
                          .name = arena_printf(a, "total momentum along %s", what),
                          .of_all = of_all,
                          .axis = axis});
  try_one(w, boost, expr_int(w->g, 0),
          (FoundSymmetry){.kind = SYMMETRY_BOOST,
                          .name = arena_printf(a, "boost along %s: the centre of mass moves uniformly", what),
                          .of_all = of_all,
                          .axis = axis});
}

static void try_kinds(TrialWork *w) {
  uint32_t kinds = 0, first[KINDS_MOST];
  for (uint32_t i = 0; i < w->n && kinds < KINDS_MOST; i++) {
    uint32_t k = 0;
    while (k < kinds && !name_same_kind(&w->names, first[k], i)) k++;
    if (k < kinds) continue;
    try_kind(w, i);
    first[kinds++] = i;
  }
}

/* A rotation of all bodies about an axis. */
static void try_turn(TrialWork *w, uint32_t axis) {
  Expr *xi = zero_components(w);
  uint32_t bodies = 0;
  for (uint32_t i = 0; i < w->n; i++) {
    if (name_axis(&w->names, i) != (axis + 1) % 3) continue;
    char letter = *axis_text((axis + 2) % 3);
    uint32_t k = name_component(&w->names, i, letter);
    if (k == UINT32_MAX) k = name_component(&w->names, i, (char)toupper((unsigned char)letter));
    if (k == UINT32_MAX || name_axis(&w->names, k) == AXIS_NONE) continue;
    xi[i] = expr_neg(w->g, node(w, k));
    xi[k] = node(w, i);
    bodies++;
  }
  const char *name = arena_printf(w->e->m->arena, "total angular momentum about %s", axis_text(axis));
  if (bodies)
    try_one(w, xi, expr_int(w->g, 0),
            (FoundSymmetry){.kind = SYMMETRY_ROTATION, .name = name, .of_all = 1, .axis = axis});
}

/* The momentum of each cyclic coordinate; 0: they are too many to be listed one by one. */
static int try_cyclic(TrialWork *w) {
  enum { LISTED_MOST = 200 };
  uint32_t cyclic = 0;
  for (uint32_t i = 0; i < w->n && w->e->n; i++) cyclic += (uint32_t)expr_is_zero(w->g, w->e->dLdq[i]);
  for (uint32_t i = 0; i < w->n && w->e->n && cyclic <= LISTED_MOST; i++) {
    if (!expr_is_zero(w->g, w->e->dLdq[i])) continue;
    Expr *xi = zero_components(w);
    xi[i] = expr_int(w->g, 1);
    try_one(w, xi, expr_int(w->g, 0),
            (FoundSymmetry){.kind = SYMMETRY_MOMENTUM,
                            .name = arena_printf(w->e->m->arena, "momentum of %s", name_of(w, i)),
                            .axis = AXIS_NONE});
  }
  return cyclic <= LISTED_MOST;
}

/* A scaling that keeps the action, and the expansion beside it where coordinates scale by the root of time. */
static void try_scaling(TrialWork *w) {
  Scaling s;
  if (!scaling_of_kinds(w->e, &s, w->limit)) return;
  Expr *scale = zero_components(w), *expand = zero_components(w);
  Expr two = expr_int(w->g, 2), ratio = expr_div(w->g, two, expr_num(w->g, s.beta));
  for (uint32_t i = 0; i < w->n; i++) {
    scale[i] = expr_scale(w->g, s.alpha[i], node(w, i));
    expand[i] = expr_mul(w->g, expr_mul(w->g, ratio, w->t), scale[i]);
  }
  Expr tau = expr_scale(w->g, s.beta, w->t), square = expr_pow_num(w->g, w->t, num_int(2));
  if (try_one(w, scale, tau, (FoundSymmetry){.kind = SYMMETRY_SCALING, .name = "scaling", .axis = AXIS_NONE}))
    try_one(w, expand, square, (FoundSymmetry){.name = "expansion", .axis = AXIS_NONE});
}

/* --- dispatch --- */

int too_large_to_search(const Eqns *e) { return eqns_coordinates(e) > SEARCH_MOST; }

void try_usual_symmetries(Eqns *e, FoundSymmetries *out, SearchLimit *limit) {
  TrialWork w = {.e = e,
                 .g = e->g, .n = eqns_coordinates(e), .t = expr_symbol(e->g, e->m->time)->node,
                 .names = coordinate_names(e), .out = out,
                 .limit = limit};
  search_stage(limit, 0.8, "the usual symmetries");
  out->searched = 1;
  try_one(&w, zero_components(&w), expr_int(e->g, -1),
          (FoundSymmetry){.kind = SYMMETRY_ENERGY, .name = "energy", .axis = AXIS_NONE});
  out->ansatz = try_cyclic(&w) ? "for more than a hundred coordinates members of a family move alike: the energy, "
                                 "momenta of cyclic coordinates, and translations, boosts, rotations, scalings and "
                                 "expansions of all coordinates of a kind together"
                               : "for more than a hundred coordinates members of a family move alike: the energy, "
                                 "and translations, boosts, rotations, scalings and expansions of all coordinates of "
                                 "a kind together; the momenta of cyclic coordinates are those above";
  try_kinds(&w);
  for (uint32_t axis = 0; axis < 3; axis++) try_turn(&w, axis);
  try_scaling(&w);
}
