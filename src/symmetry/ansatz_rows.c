/* The ansatz of the search for symmetries, and its linear equations at random states: each state gives one row of B0
 * and B1, scaled to size 1. */
#include <math.h>

#include "base/tolerance.h"
#include "symmetry/determining_equations.h"
#include "mech/constrain.h"
#include "mech/states.h"
#include "sym/diff.h"

enum { CUBIC_MOST = 4 };

/* --- the ansatz --- */

/* Length of the vector's name in a component's: r[2] of r[2].x; 0: it is no component. */
static size_t vector_part(Name name) {
  const char *dot = strrchr(name, '.');
  return dot ? (size_t)(dot - name) : 0;
}

static int same_vector(Name a, Name b) {
  size_t n = vector_part(a);
  return n && n == vector_part(b) && memcmp(a, b, n) == 0;
}

static Name name_of(const Ansatz *s, uint32_t i) { return expr_symbol(s->e->g, s->q[i])->name; }

static void add_xi(Ansatz *s, Arena *a) {
  for (uint32_t i = 0; i < s->n; i++) vec_push(a, &s->xi, ((XiColumn){i, 0}));
  for (uint32_t i = 0; i < s->n; i++)
    for (uint32_t j = 0; j < s->n; j++)
      if (s->whole || i == j || same_vector(name_of(s, i), name_of(s, j)))
        vec_push(a, &s->xi, ((XiColumn){i, j + 1}));
}

static void add_gauge(Ansatz *s, Arena *a) {
  uint32_t quadratic = s->degree >= 2 ? s->n : 0, cubic = s->degree >= 3 ? s->n : 0;
  for (uint32_t i = 0; i <= s->n; i++)
    for (uint32_t j = 0; j <= i && j <= quadratic; j++)
      for (uint32_t k = 0; k <= j && k <= cubic; k++) vec_push(a, &s->gauge, ((GaugeColumn){{i, j, k}}));
}

static void add_held(Ansatz *s, Arena *a) {
  const Constraints *k = &s->e->constraints;
  for (uint32_t i = 0; i < k->n; i++)
    if (!contact_of_constraint(s->e->m, k->of[i])) vec_push(a, &s->held, i);
}

Ansatz *ansatz_new(Arena *a, const Eqns *e, int whole, SearchLimit *limit) {
  Ansatz *s = ARENA_NEW(a, Ansatz);
  unsigned kinds = expr_kinds(e->g, e->lagrangian);
  s->e = e;
  s->whole = whole;
  s->limit = limit;
  s->symbols = expr_symbol_count(e->g) + 1;
  s->n = eqns_coordinates(e);
  s->q = eqns_symbols(e, 0);
  s->v = eqns_symbols(e, 1);
  s->degree = !whole ? 1 : s->n <= CUBIC_MOST ? 3 : 2;
  s->has_tau = !(kinds & (1u << SYM_INPUT | (e->n ? 1u << SYM_STATE : 0)));
  s->has_time = (kinds & 1u << SYM_TIME) != 0;
  add_xi(s, a);
  add_gauge(s, a);
  add_held(s, a);
  s->shown = 1 + s->xi.n;
  s->columns = s->shown + s->gauge.n;
  return s;
}

/* --- states --- */

struct RowSource {
  const Ansatz *of;
  Arena *scratch;
  EvalTape *tape;        /* L, dL/dt, dL/dq, p; then A and r of the constraints */
  StateSolver *solver;   /* or NULL */
  long double *symbols, *kept, *out;
  long double *phi, *rate; /* [n + 1] 1, q and their derivatives */
  long double *part;     /* [2*columns] scratch */
  uint64_t random;
  uint32_t turn;         /* number of rows at times so far; constraints take turns in them */
  uint32_t filled;       /* rows so far; constraints take turns in them */
  uint32_t reach;        /* index into reaches */
};

/* Random number, 0.3 .. 1.7 with random sign. Steele, Lea, Flood: Fast splittable pseudorandom number generators,
 * OOPSLA 2014, DOI 10.1145/2660193.2660195. */
static long double next_value(RowSource *r) {
  uint64_t z = r->random += 0x9e3779b97f4a7c15u;
  z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
  z = (z ^ z >> 27) * 0x94d049bb133111ebu;
  z ^= z >> 31;
  long double size = 0.3L + 1.4L * (long double)(z >> 12) / 4503599627370496.0L;
  return z & 1 ? size : -size;
}

RowSource *rows_new(const Ansatz *s, Arena *scratch, const long double *parameters) {
  const Eqns *e = s->e;
  const Constraints *k = &e->constraints;
  RowSource *r = ARENA_NEW(scratch, RowSource);
  uint32_t count = 0, symbols = expr_symbol_count(e->g) + 1;
  Expr *roots = ARENA_ARRAY(scratch, Expr, 2 + 2 * (size_t)s->n + k->A.n + k->n), L = e->lagrangian;
  roots[count++] = L;
  roots[count++] = expr_diff(e->g, L, e->m->time);
  expr_gradient(e->g, L, s->q, s->n, roots + count);
  count += s->n;
  for (uint32_t i = 0; i < s->n; i++) roots[count++] = eqns_momenta(e)[i];
  for (uint32_t i = 0; i < k->A.n; i++) roots[count++] = k->A.at[i].e;
  for (uint32_t i = 0; i < k->n; i++) roots[count++] = k->r[i];
  *r = (RowSource){.of = s,
                   .scratch = scratch,
                   .tape = eval_tape(e->g, roots, count),
                   .solver = k->n ? states_new(e) : NULL,
                   .random = 7};
  r->symbols = ARENA_ARRAY(scratch, long double, symbols);
  r->kept = ARENA_ARRAY(scratch, long double, symbols);
  r->out = ARENA_ARRAY(scratch, long double, count);
  r->phi = ARENA_ARRAY(scratch, long double, s->n + 1);
  r->rate = ARENA_ARRAY(scratch, long double, s->n + 1);
  r->part = ARENA_ARRAY(scratch, long double, 2 * (size_t)s->columns);
  memcpy(r->symbols, parameters, s->symbols * sizeof *parameters);
  return r;
}

/* Sizes of coordinates and velocities, tried until L has a value: roots of 1 - v^2/c^2, logarithms of x - a. */
static const long double reaches[][2] = {{1, 1},     {1, 0.5L}, {1, 0.25L}, {1, 0.125L},    {0.5L, 1},
                                         {0.25L, 1}, {4, 1},    {16, 1},    {0.25L, 0.25L}, {0.0625L, 0.0625L}};
enum { REACHES = sizeof reaches / sizeof *reaches };

/* Draws new values of all symbols but parameters, coordinates `spread` times as large. Times are further apart, so
 * that functions of time are told from each other. */
static void draw(RowSource *r, long double spread) {
  const ExprGraph *g = r->of->e->g;
  const long double *reach = reaches[r->reach];
  for (SymId s = 1; s <= expr_symbol_count(g); s++) {
    const Symbol *x = expr_symbol(g, s);
    if (x->kind == SYM_PARAM || x->kind == SYM_CONST) continue;
    long double value = next_value(r) * (x->kind == SYM_TIME    ? 4
                                         : x->kind == SYM_COORD ? spread * reach[0]
                                         : x->kind == SYM_VEL   ? reach[1]
                                                                : 1);
    r->symbols[s] = sign_is_nonnegative(x->sign) ? fabsl(value) : value;
  }
}

/* Sum of |dL/dq_i| at the state; NaN where L, a force or a momentum has no value. */
static long double steepness(RowSource *r) {
  long double sum = 0, none = 0;
  eval_run(r->tape, r->symbols, r->out);
  for (uint32_t i = 0; i < r->of->n; i++) sum += fabsl(r->out[2 + i]);
  for (uint32_t i = 0; i < 2 + 2 * r->of->n; i++) none += 0 * r->out[i];
  return sum + none;
}

/* Draws some states and keeps that with the weakest forces: where two of several bodies nearly touch, their force
 * drowns all others, and with 1/(x - y)^2 rounding of the potential drowns the kinetic energy. With many bodies every
 * second state is wide; with more of them the draws, which take most of the search's time, are fewer. */
static int draw_some(RowSource *r) {
  enum { MANY = 6, MORE = 30, DRAWS = 24 };
  const int draws = r->of->n > MORE ? DRAWS / 4 : DRAWS;
  size_t size = (expr_symbol_count(r->of->e->g) + 1) * sizeof *r->symbols;
  long double least = INFINITY;
  for (int k = 0; k < draws; k++) {
    draw(r, k % 2 && r->of->n >= MANY ? 3 : 1);
    long double now = steepness(r);
    if (!(now < least)) continue;
    least = now;
    memcpy(r->kept, r->symbols, size);
  }
  if (least < INFINITY) memcpy(r->symbols, r->kept, size);
  return least < INFINITY;
}

static void draw_gentle(RowSource *r) {
  uint32_t first = r->reach;
  while (!draw_some(r) && r->reach + 1 < REACHES) r->reach++;
  if (r->reach + 1 == REACHES) r->reach = first;
}

static void set_velocities(RowSource *r, const long double *v, long double factor) {
  for (uint32_t i = 0; i < r->of->n; i++) r->symbols[r->of->v[i]] = factor * v[i];
}

/* Evaluates the tape at the state in symbols, and phi and rates. */
static void evaluate(RowSource *r) {
  const Ansatz *s = r->of;
  eval_run(r->tape, r->symbols, r->out);
  r->phi[0] = 1;
  r->rate[0] = 0;
  for (uint32_t i = 0; i < s->n; i++) {
    r->phi[i + 1] = r->symbols[s->q[i]];
    r->rate[i + 1] = r->symbols[s->v[i]];
  }
}

/* --- rows --- */

/* Adds `weight` times the row of delta L - dF/dt at the state. */
static void add_lagrangian_row(RowSource *r, long double weight, long double *b0, long double *b1) {
  const Ansatz *s = r->of;
  const long double *dLdq = r->out + 2, *p = dLdq + s->n;
  long double energy = -r->out[0];
  for (uint32_t i = 0; i < s->n; i++) energy += p[i] * r->rate[i + 1];
  if (s->has_tau) b1[0] -= weight * energy;
  if (s->has_tau) b0[0] += weight * r->out[1];
  for (uint32_t j = 0; j < s->xi.n; j++) {
    uint32_t i = s->xi.at[j].i, k = s->xi.at[j].k;
    b0[1 + j] += weight * (dLdq[i] * r->phi[k] + p[i] * r->rate[k]);
    b1[1 + j] += weight * p[i] * r->phi[k];
  }
  for (uint32_t l = 0; l < s->gauge.n; l++) {
    const uint32_t *of = s->gauge.at[l].of;
    long double a = r->phi[of[0]], b = r->phi[of[1]], c = r->phi[of[2]];
    b0[s->shown + l] -= weight * (r->rate[of[0]] * b * c + a * r->rate[of[1]] * c + a * b * r->rate[of[2]]);
    b1[s->shown + l] -= weight * a * b * c;
  }
}

/* The row of the state in symbols less that of another state at the same time. */
static void difference_row(RowSource *r, long double *b0, long double *b1) {
  SymId time = r->of->e->m->time;
  long double t = r->symbols[time] *= r->of->far_times && r->turn % 2 ? 4 : 1;
  evaluate(r);
  add_lagrangian_row(r, 1, b0, b1);
  draw_gentle(r);
  r->symbols[time] = t;
  evaluate(r);
  add_lagrangian_row(r, -1, b0, b1);
}

/* A row of the given kind from the state in symbols, with its velocities times 1, -1 and 0. */
static void lagrangian_rows(RowSource *r, RowKind kind, long double *b0, long double *b1) {
  static const long double factors[3] = {1, -1, 0};
  static const long double even[3] = {1, 1, -2}, rest[3] = {0, 0, 1}, all[3] = {1, 0, 0};
  const long double *weight = kind == ROWS_EVEN ? even : kind == ROWS_AT_REST ? rest : all;
  long double *v = r->part;
  for (uint32_t i = 0; i < r->of->n; i++) v[i] = r->symbols[r->of->v[i]];
  for (int k = 0; k < 3; k++) {
    if (weight[k] == 0) continue;
    set_velocities(r, v, factors[k]);
    evaluate(r);
    add_lagrangian_row(r, weight[k], b0, b1);
  }
}

/* The row A xi + b tau of a constraint r = A q' + b, at a state moved onto the constraints. 0: it cannot be moved
 * there. */
static int constraint_row(RowSource *r, uint32_t which, long double *b0) {
  const Ansatz *s = r->of;
  const Constraints *k = &s->e->constraints;
  if (!states_project(r->solver, r->symbols)) return 0;
  evaluate(r);
  const long double *A = r->out + 2 + 2 * (size_t)s->n;
  long double b = A[k->A.n + which], size = fabsl(b), *row = r->part;
  memset(row, 0, s->n * sizeof *row);
  for (uint32_t x = 0; x < k->A.n; x++)
    if (k->A.at[x].row == which) row[k->A.at[x].col] += A[x];
  for (uint32_t i = 0; i < s->n; i++) {
    b -= row[i] * r->rate[i + 1];
    size += fabsl(row[i] * r->rate[i + 1]);
  }
  for (uint32_t j = 0; j < s->xi.n; j++) b0[1 + j] += row[s->xi.at[j].i] * r->phi[s->xi.at[j].k];
  if (s->has_tau && fabsl(b) > LONG_TOLERANCE(1e-14L) * size) b0[0] = b; /* a state obeys to rounding */
  return 1;
}

/* Scales a row to largest element 1: states where bodies nearly touch would drown the others. 0: a value is not
 * finite. */
static int normalise(long double *b0, long double *b1, uint32_t n) {
  long double most = 0;
  for (uint32_t i = 0; i < n; i++) {
    if (!isfinite(b0[i]) || !isfinite(b1[i])) return 0;
    most = fmaxl(most, fmaxl(fabsl(b0[i]), fabsl(b1[i])));
  }
  for (uint32_t i = 0; i < n && most > 0; i++) b0[i] /= most, b1[i] /= most;
  return 1;
}

/* A row at a new state; 0: a value is not finite, or the constraints cannot be met. */
static int try_row(RowSource *r, RowKind kind, uint32_t which, long double *b0, long double *b1) {
  uint32_t w = r->of->columns;
  memset(b0, 0, w * sizeof *b0);
  memset(b1, 0, w * sizeof *b1);
  draw_gentle(r);
  if (kind == ROWS_DIFFERENCE) difference_row(r, b0, b1);
  else if (kind != ROWS_CONSTRAINTS) lagrangian_rows(r, kind, b0, b1);
  else if (!constraint_row(r, r->of->held.at[which % r->of->held.n], b0)) return 0;
  return normalise(b0, b1, w);
}

enum { TRIES = 20 };

int rows_exist(const Ansatz *s, Arena *scratch, const long double *parameters) {
  long double *b0 = ARENA_ARRAY(scratch, long double, 2 * (size_t)s->columns), *b1 = b0 + s->columns;
  return rows_fill(rows_new(s, scratch, parameters), ROWS_ALL, 1, b0, b1) > 0;
}

uint32_t rows_fill(RowSource *r, RowKind kind, uint32_t n, long double *b0, long double *b1) {
  size_t w = r->of->columns;
  uint32_t done = 0;
  for (uint32_t tries = 0; done < n && tries < TRIES * (done + 10) && search_goes_on(r->of->limit, 0); tries++)
    done += (uint32_t)try_row(r, kind, r->filled + done, b0 + done * w, b1 + done * w);
  r->filled += done;
  return done;
}

int rows_at_time(RowSource *r, RowKind kind, long double *b0, long double *b1, long double *t) {
  for (uint32_t tries = 0; tries < 10 * TRIES; tries++)
    if (try_row(r, kind, r->turn++, b0, b1)) {
      *t = r->symbols[r->of->e->m->time];
      return 1;
    }
  return 0;
}
