/* Claims of canonical transformations: {Q_i, P_j} = delta_ij, {Q_i, Q_j} = {P_i, P_j} = 0, each judged as an
 * expectation is. A generating function is proved by its mixed Hessian, which is not 0 everywhere; what else is
 * given must agree with it. */
#include "claims/expect.h"

#include "phase_space/canonical_map.h"
#include "sym/diff.h"
#include "sym/jump.h"
#include "sym/print.h"
#include "sym/prove.h"
#include "sym/simplify.h"
#include "symmetry/charges.h"

typedef struct {
  Eqns *e;
  ExprGraph *g;
  Arena *arena;
  const Canonical *c;
  const CaseSymbols *symbols;
  PhaseSpace old;
  SymId *z;            /* [2n] */
  const Expr *forward; /* [2n] Z(z, t), or NULL */
  Expr smooth;         /* where all that is given has derivatives; 0: everywhere */
  int jumps;           /* some of it jumps, or has corners */
  uint32_t proofs;
  const char *fault;   /* "is not canonical" */
} Claims;

static const char *text_of(const Claims *k, Expr x) {
  enum { LONGEST = 200 };
  uint32_t distinct;
  return expr_tree_size(k->g, x, &distinct) > LONGEST ? NULL : expr_text(k->g, x);
}

/* Left = right at all states; otherwise reported. label: "{Q, P}"; shown: its value, or 0. */
static int claim(Claims *k, Span span, const char *label, Expr left, Expr right, Expr shown) {
  Diags *d = k->e->m->diags;
  Expr domain = k->c->domain ? charges_substitute(k->e, k->c->domain) : 0;
  if (k->smooth) domain = domain ? expr_fn2(k->g, EX_AND, domain, k->smooth) : k->smooth;
  Expect x = {.name = label,
              .span = span,
              .lhs = without_inverse_functions(k->g, left),
              .rhs = without_inverse_functions(k->g, right),
              .domain = domain};
  ExpectResult r = expect_judge(k->e, k->symbols, &x);
  const char *value = shown ? text_of(k, shown) : NULL, *want = text_of(k, right);
  k->proofs++;
  if (r.verdict == EXPECT_PROVED) return 1;
  if (r.verdict == EXPECT_REFUTED) {
    if (value) diag_error(d, span, "`%s` %s: %s is %s, and must be %s", k->c->name, k->fault, label, value, want);
    else
      diag_error(d, span, "`%s` %s: %s is false", k->c->name, k->fault,
                 shown ? arena_printf(k->arena, "%s = %s", label, want) : label);
    diag_help(d, "%s", r.difference);
    return 0;
  }
  diag_error(d, span, "`%s` is not decided: no proof that %s", k->c->name,
             shown ? arena_printf(k->arena, "%s is %s", label, want) : label);
  if (r.verdict == EXPECT_AGREES)
    diag_help(d, "at all states tried the sides agree to %d digits; write it in another form", r.digits);
  else diag_help(d, "no state tried gives it a meaningful value; write it in another form");
  return 0;
}

/* The brackets of 2n functions of the 2n variables x. */
static int claim_brackets(Claims *k, const Expr *map, const SymId *names, const SymId *x, const Span *spans) {
  uint32_t n = k->c->n;
  for (uint32_t i = 0; i < 2 * n; i++)
    for (uint32_t j = i + 1; j < 2 * n; j++) {
      Expr value = poisson_bracket(k->g, map[i], map[j], x, x + n, n), want = expr_int(k->g, j == i + n), left = value;
      if (k->old.rate && x == k->z) left = expr_replace(k->g, value, k->old.p, k->e->p, n); /* p = dL/dq' */
      const char *label =
          arena_printf(k->arena, "{%s, %s}", expr_symbol(k->g, names[i])->name, expr_symbol(k->g, names[j])->name);
      if (!claim(k, spans ? spans[j] : k->c->span, label, left, want, value)) return 0;
    }
  return 1;
}

/* det of a generating function, or of a point transformation. *how: where it is not 0, if it can be. */
static int claim_regular(Claims *k, const char **how) {
  static const char *const hessians[] = {"dq/dQ", "d2F1/dq dQ", "d2F2/dq dP", "d2F3/dp dQ", "d2F4/dp dP"};
  const char *name = arena_printf(k->arena, "%s%s", k->c->n > 1 ? "det " : "", hessians[k->c->kind]);
  Expr det = canonical_determinant(k->g, k->c);
  Verdict v = prove_zero(k->g, det, NULL);
  if (v == PROVED_ZERO) {
    diag_error(k->e->m->diags, k->c->span, "`%s` is %s: %s is 0 in every state", k->c->name,
               k->c->is_point ? "no change of coordinates" : "not canonical", name);
    diag_help(k->e->m->diags, k->c->is_point ? "the old coordinates must determine the new ones"
                                             : "old and new arguments must be coupled, as in F2(q, P) = q*P");
    return 0;
  }
  if (v == NOT_DECIDED)
    return diag_error(k->e->m->diags, k->c->span, "`%s` is not decided: no proof that %s is not 0", k->c->name, name);
  const char *text = text_of(k, det);
  if (expr_is_nonzero(k->g, det)) *how = arena_printf(k->arena, "%s is never 0", name);
  else *how = arena_printf(k->arena, "where %s%s%s is not 0", name, text ? " = " : "", text ? text : "");
  return 1;
}

/* The equations of F at the map that is given: new variables as functions of old ones, or old as functions of new. */
static int claim_generator(Claims *k) {
  uint32_t N = 2 * k->c->n;
  GeneratorEquations F = generator_equations(&k->old, k->c);
  const SymId *of = k->forward ? k->c->fresh : k->z;
  const Expr *with = k->forward ? k->forward : k->c->inverse;
  for (uint32_t i = 0; i < N && with; i++) {
    int has_old = i < k->c->n, minus = has_old ? k->c->kind > 2 : k->c->kind % 2;
    uint32_t half = i % k->c->n;
    SymId by = has_old ? k->z[half + (minus ? k->c->n : 0)] : k->c->fresh[half + (minus ? 0 : k->c->n)];
    const char *label = arena_printf(k->arena, "%s = %sdF%d/d%s", expr_symbol(k->g, expr_sym_id(k->g, F.left[i]))->name,
                                     minus ? "-" : "", k->c->kind, expr_symbol(k->g, by)->name);
    Expr left = expr_replace(k->g, F.left[i], of, with, N),
         right = expr_replace(k->g, expr_expand_defs(k->g, F.right[i]), of, with, N);
    if (!claim(k, k->c->span, label, left, right, 0)) return 0;
  }
  return 1;
}

/* z(Z(z)) = z. */
static int claim_inverse(Claims *k) {
  uint32_t N = 2 * k->c->n;
  for (uint32_t i = 0; i < N; i++) {
    Expr back = expr_replace(k->g, k->c->inverse[i], k->c->fresh, k->forward, N),
         own = expr_symbol(k->g, k->z[i])->node;
    const char *label = arena_printf(k->arena, "%s = %s, as the inverse gives it,", expr_symbol(k->g, k->z[i])->name,
                                     expr_symbol(k->g, k->z[i])->name);
    if (!claim(k, k->c->span, label, back, own, 0)) return 0;
  }
  return 1;
}

/* The new Hamiltonian by a generating function, in its arguments: H + dF/dt, the conjugates replaced. */
static int claim_by_generator(Claims *k) {
  uint32_t n = k->c->n;
  GeneratorEquations F = generator_equations(&k->old, k->c);
  SymId *conjugate = ARENA_ARRAY(k->arena, SymId, 2 * (size_t)n + 1);
  for (uint32_t i = 0; i < 2 * n; i++) conjugate[i] = expr_sym_id(k->g, F.left[i]);
  Expr H = expr_replace(k->g, k->old.H, conjugate, F.right, 2 * n),
       rate = expr_diff(k->g, k->c->generator, k->e->m->time),
       K = simplify(k->g, expr_expand_defs(k->g, expr_add(k->g, H, rate)));
  Expr right = expr_expand_defs(k->g, expr_replace(k->g, k->c->K, conjugate, F.right, 2 * n));
  return claim(k, k->c->K_span, "H + dF/dt", K, right, K);
}

/* By the inverse map: up to a function of t where the map depends on t, and then by its derivatives. */
static int claim_by_inverse(Claims *k) {
  const Expr *z = canonical_inverse(&k->old, k->c);
  if (!z) {
    diag_error(k->e->m->diags, k->c->K_span, "the new Hamiltonian of `%s` is not decided: no inverse is found",
               k->c->name);
    return diag_help(k->e->m->diags, "give the old variables as functions of the new, too: `%s = ..., ...`",
                     expr_symbol(k->g, k->old.q[0])->name),
           0;
  }
  NewHamiltonian new = canonical_hamiltonian(&k->old, k->c, z);
  if (!new.has_R)
    return claim(k, k->c->K_span, "H in the new variables", new.K, expr_expand_defs(k->g, k->c->K), new.K);
  for (uint32_t i = 0; i < 2 * k->c->n; i++) {
    uint32_t by = (i + k->c->n) % (2 * k->c->n);
    Expr slope = expr_diff(k->g, expr_expand_defs(k->g, k->c->K), k->c->fresh[by]),
         want = i < k->c->n ? slope : expr_neg(k->g, slope);
    if (!claim(k, k->c->K_span, arena_printf(k->arena, "%s'", expr_symbol(k->g, k->c->fresh[i])->name), new.motion[i],
               want, new.motion[i]))
      return 0;
  }
  return 1;
}

static int phase_space(Claims *k) {
  uint32_t n = k->c->n;
  if (!phase_space_of(k->e, k->c->span, &k->old)) return 0;
  k->z = ARENA_ARRAY(k->arena, SymId, 2 * (size_t)n + 1);
  for (uint32_t i = 0; i < n; i++) k->z[i] = k->old.q[i], k->z[n + i] = k->old.p[i];
  if (!k->c->forward) return 1;
  Expr *forward = ARENA_ARRAY(k->arena, Expr, 2 * (size_t)n + 1);
  for (uint32_t i = 0; i < 2 * n; i++)
    forward[i] = phase_space_expression(&k->old, charges_substitute(k->e, k->c->forward[i]));
  k->forward = forward;
  return 1;
}

static void find_smooth(Claims *k) {
  uint32_t n = k->c->n, count = 0;
  Expr *roots = ARENA_ARRAY(k->arena, Expr, 4 * (size_t)n + 2);
  for (uint32_t i = 0; i < 2 * n; i++) {
    if (k->forward) roots[count++] = k->forward[i];
    if (k->c->inverse && (i < n || !k->c->is_point)) roots[count++] = expr_expand_defs(k->g, k->c->inverse[i]);
  }
  if (k->c->generator) roots[count++] = expr_expand_defs(k->g, k->c->generator);
  k->smooth = expr_smooth_domain(k->g, roots, count, &k->jumps);
  if (k->smooth && k->old.rate) k->smooth = expr_replace(k->g, k->smooth, k->old.p, k->e->p, n);
}

int canonical_holds(Eqns *e, const Canonical *c, const CaseSymbols *symbols, const char **how) {
  Claims k = {.e = e, .g = e->g, .arena = e->m->arena, .c = c, .symbols = symbols, .fault = "is not canonical"};
  const char *where = NULL;
  uint32_t brackets = 0;
  int ok = c->is_point || phase_space(&k);
  if (ok) find_smooth(&k);
  if (ok && (c->kind || c->is_point)) ok = claim_regular(&k, &where);
  if (ok && k.forward) ok = claim_brackets(&k, k.forward, c->fresh, k.z, c->spans);
  else if (ok && !c->kind && !c->is_point) ok = claim_brackets(&k, c->inverse, k.z, c->fresh, NULL);
  brackets = k.proofs;
  if (ok && c->kind) ok = claim_generator(&k);
  if (ok && !c->kind && k.forward && c->inverse) ok = claim_inverse(&k);
  k.fault = "has another Hamiltonian";
  if (ok && c->K) ok = c->kind ? claim_by_generator(&k) : claim_by_inverse(&k);
  *how = where ? where
         : c->n == 1
             ? k.forward ? arena_printf(k.arena, "{%s, %s} = 1", expr_symbol(k.g, c->fresh[0])->name,
                                        expr_symbol(k.g, c->fresh[1])->name)
                         : "{q, p} = 1 in the new variables"
             : arena_printf(k.arena, "by its %u brackets%s", brackets, k.forward ? "" : " in the new variables");
  *how = arena_printf(k.arena, "%s, %s", k.jumps ? " between jumps" : "", *how);
  return ok;
}

void canonicals_check(Eqns *e, StrBuf *out) {
  const Model *m = e->m;
  const CaseSymbols symbols = cases_symbols(m);
  vec_each(const Canonical, c, m->canonicals) {
    const char *how;
    if (!canonical_holds(e, c, &symbols, &how)) continue;
    Place p = source_place(m->ast->sources, c->span.begin);
    sb_printf(out, "%s:%u: %s %s: proved%s%s\n", p.file ? p.file->path : "", p.line,
              c->is_point ? "change of coordinates" : "canonical", c->name, how,
              c->K ? "; its Hamiltonian is as given" : "");
  }
}
