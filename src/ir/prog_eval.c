/* prog_eval: an interpreter of Prog in extended precision, independent of the emitted C. Adds in the same order as
 * emitted code. */
#include <float.h>
#include <math.h>
#include <string.h>

#include "base/sparse_solve.h"
#include "ir/prog.h"
#include "numeric/functions.def"

typedef long double Real;

static const struct {
  const char *name;
  Real (*f)(Real);
} functions[] = {
#define ROW(OP, name, ...) {#name, name##l},
  FUNCTIONS(ROW)
  {"fabs", fabsl}, {"floor", floorl},
};

long double prog_call1(const char *name, long double x) {
  for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
    if (strcmp(functions[i].name, name) == 0) return functions[i].f(x);
  return NAN;
}

static Real call2(const char *name, Real x, Real y) {
  if (strcmp(name, "pow") == 0) return powl(x, y);
  if (strcmp(name, "atan2") == 0) return atan2l(x, y);
  if (strcmp(name, "hypot") == 0) return hypotl(x, y);
  return NAN;
}

/* Solves M x = f, or [M -A^T; A 0] [x; l] = [f; g], as one system of n + m equations. Redundant constraints get
 * multipliers 0. */
static const Real *solved(const Prog *p, const Solve *s, const Real *v, int *status) {
  uint32_t n = s->n, total = solve_unknowns(s);
  Real *b = ARENA_ARRAY(p->arena, Real, total);
  ArenaMark before = arena_mark(p->arena);
  SparseElements system = {0};
  for (uint32_t i = 0; i < total; i++) b[i] = v[s->rhs[i]];
  for (uint32_t k = 0; k < s->list.n; k++) {
    uint32_t i = s->list.at[k].at / n, j = s->list.at[k].at % n;
    Real x = v[s->list.at[k].x];
    sparse_put(p->arena, &system, i, j, x);
    if (i >= n) sparse_put(p->arena, &system, j, i, -x);
  }
  uint32_t rank = sparse_solve(p->arena, total, &system, b, s->m ? 1e-13L : 0, NULL);
  arena_forget(p->arena, before);
  *status = isfinite(b[0]) && (s->m || rank == n) ? 0 : -1;
  return b;
}

typedef struct {
  const Prog *p;
  const Real *const *in;
  Real *const *out;
  Real *v, *cells;
  const Real **solution;
  int samples; /* quantified sums by a sample of their turns */
} Run;

static int run_nest(Run *r, const Nest *n);

/* Computes v[s]; -1 when a pivot failed. */
static int run_ins(Run *r, Slot s, const Ins *i) {
  Real *v = r->v, x = v[i->a], y = v[i->b];
  int status = 0;
  switch (i->op) {
    case IR_CONST: v[s] = num_is_exact(i->number) ? (Real)i->number.num / (Real)i->number.den : i->number.approx; break;
    case IR_PI: v[s] = 3.14159265358979323846264338327950288L; break;
    case IR_LOAD: v[s] = i->array == ARR_CELL ? r->cells[i->index] : r->in[i->array][i->index]; break;
    case IR_ADD: v[s] = x + y; break;
    case IR_SUB: v[s] = x - y; break;
    case IR_MUL: v[s] = x * y; break;
    case IR_DIV: v[s] = x / y; break;
    case IR_NEG: v[s] = -x; break;
    case IR_SQRT: v[s] = sqrtl(x); break;
    case IR_FN1: v[s] = prog_call1(i->text, x); break;
    case IR_FN2: v[s] = call2(i->text, x, y); break;
    case IR_MIN: v[s] = x < y ? x : y; break;
    case IR_MAX: v[s] = x > y ? x : y; break;
    case IR_SIGN: v[s] = (Real)((x > 0) - (x < 0)); break;
    case IR_LT: v[s] = x < y; break;
    case IR_LE: v[s] = x <= y; break;
    case IR_EQ: v[s] = x == y; break;
    case IR_NOT: v[s] = x == 0; break;
    case IR_AND: v[s] = x != 0 && y != 0; break;
    case IR_OR: v[s] = x != 0 || y != 0; break;
    case IR_SELECT: v[s] = x != 0 ? y : v[i->c]; break;
    case IR_PIVOT: return (i->index ? x > 0 : x != 0) ? 0 : -1;
    case IR_SOLVE: r->solution[s] = solved(r->p, &r->p->solves.at[i->index], v, &status); return status;
    case IR_SOLVED: v[s] = r->solution[i->a][i->index]; break;
    case IR_NEST: return run_nest(r, &r->p->nests.at[i->index]);
    case IR_TABLE: v[s] = spline_at(r->p->tables.at[i->index].curve, r->p->tables.at[i->index].order, x); break;
    case IR_TITLE: break;
  }
  if (fabsl(v[s]) > DBL_MAX) v[s] = copysignl(INFINITY, v[s]); /* doubles overflow here */
  return 0;
}

/* Computes the body in turn j of row i. The nest gives its loads their indices; run_ins would take those of a
 * program. */
static int run_turn(Run *body, const Run *r, const Nest *n, int64_t i, int64_t j) {
  const Prog *p = n->body;
  for (Slot s = 1; s < p->ins.n; s++) {
    const Ins *x = &p->ins.at[s];
    if (x->op != IR_LOAD || ir_is_scalar(x->array)) {
      if (run_ins(body, s, x) != 0) return -1;
    } else if (x->array == ARR_OUTER) {
      body->v[s] = r->v[n->outer[x->index]];
    } else {
      int64_t at = nest_index(n, x->index, i, j);
      body->v[s] = x->array == ARR_INDEX ? (Real)at : (x->array == ARR_CELL ? r->cells : r->in[x->array])[at];
    }
  }
  return 0;
}

/* Adds the stores of a turn to their sums or, where the sum stays the same in all turns, to the loop's partial sums. */
static void add_stores(const Run *r, const Run *body, const Nest *n, Real *part, int64_t i, int64_t j) {
  uint32_t n_stores = body->p->stores.n - (n->near.n > 0);
  if (n->near.n && body->v[body->p->stores.at[n_stores].slot] == 0) return;
  for (uint32_t k = 0; k < n_stores; k++) {
    const Store *st = &body->p->stores.at[k];
    if (st->array >= NEST_SETS) {
      r->out[st->array - NEST_SETS][nest_index(n, st->index, i, j)] = body->v[st->slot];
      continue;
    }
    Real *to = nest_moves(n, st->index) ? &r->cells[nest_index(n, st->index, i, j)] : &part[k];
    *to += st->array ? -body->v[st->slot] : body->v[st->slot];
  }
}

static void add_parts(const Run *r, const Nest *n, Real *part, int64_t i) {
  for (uint32_t k = 0; k < n->body->stores.n; k++) {
    const Store *st = &n->body->stores.at[k];
    if (st->array >= NEST_TEST) continue;
    if (!nest_moves(n, st->index)) r->cells[nest_index(n, st->index, i, nest_from(n, i))] += part[k];
    part[k] = 0;
  }
}

static int run_nest(Run *r, const Nest *n) {
  const Prog *p = n->body;
  Run body = {.p = p, .in = r->in, .v = ARENA_ARRAY(p->arena, Real, p->ins.n), .cells = r->cells};
  Real *part = ARENA_ARRAY(p->arena, Real, p->stores.n + 1);
  for (int64_t i = 0; i < n->rows; i++) {
    int64_t from = nest_from(n, i), turns = nest_to(n, i) - from;
    int samples = r->samples && n->text_rows;
    if (samples && !loop_samples(i + n->first_row, n->text_rows)) continue;
    for (int64_t j = from; j < from + turns; j++) {
      if (samples && !loop_samples(j - from, n->text_turns ? n->text_turns : turns)) continue;
      if (run_turn(&body, r, n, i, j) != 0) return -1;
      add_stores(r, &body, n, part, i, j);
    }
    if (nest_has_turns(n) || i + 1 == n->rows) add_parts(r, n, part, i);
  }
  return 0;
}

static int run_all(Run *r) {
  for (Slot s = 1; s < r->p->ins.n; s++)
    if (run_ins(r, s, &r->p->ins.at[s]) != 0) return -1;
  return 0;
}

static int evaluate(const Prog *p, const Real *const in[ARR_COUNT], Real *const *out, int samples) {
  ArenaMark before = arena_mark(p->arena);
  Run r = {.p = p,
           .in = in,
           .out = out,
           .samples = samples,
           .v = ARENA_ARRAY(p->arena, Real, p->ins.n),
           .cells = ARENA_ARRAY(p->arena, Real, p->cells + 1),
           .solution = ARENA_ARRAY(p->arena, const Real *, p->ins.n)};
  int status = run_all(&r);
  for (uint32_t k = 0; k < p->stores.n && status == 0; k++)
    out[p->stores.at[k].array][p->stores.at[k].index] = r.v[p->stores.at[k].slot];
  arena_forget(p->arena, before);
  return status;
}

int prog_eval(const Prog *p, const Real *const in[ARR_COUNT], Real *const *out) { return evaluate(p, in, out, 0); }

int prog_eval_sample(const Prog *p, const Real *const in[ARR_COUNT], Real *const *out) {
  return evaluate(p, in, out, 1);
}
