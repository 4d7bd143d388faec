/* Evaluated against compiled: every function of every scene of a program, at random states, bit for bit.
 * evaluator BYTES LIBRARY.so STATES: the same program as bytes and as a shared library. Prints what differs.
 * evaluator BYTES - COUNT: bytes are changed or cut off, COUNT times; what is not refused runs. */
#include <dlfcn.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "evaluator/evaluator.h"

enum { SIDES = 2, ROOM = 1 << 16, ORDERS = 12 };

static unsigned long long seed = 1;
static double uniform(void) {
  seed = seed * 6364136223846793005ULL + 1442695040888963407ULL;
  return (double)(seed >> 11) / 9007199254740992.0;
}

/* A state, and what a function wrote on each side. */
static double t, *q, *v, *z, *p, *u, *a, *g, *out[SIDES], *w[SIDES], *x[SIDES];
static void copy(double *to, const double *from, int n) { memcpy(to, from, (size_t)n * sizeof *to); }
static int status[SIDES], differences, calls;
static const char *where;

static double *room(size_t n) {
  double *r = calloc(n + 1, sizeof *r);
  if (!r) exit(2);
  return r;
}

/* NaNs are equal whatever their bits. */
static int same(double r, double s) { return memcmp(&r, &s, sizeof r) == 0 || (isnan(r) && isnan(s)); }

static void compare(const char *what, int n) {
  calls++;
  int bad = status[0] != status[1], at = -1;
  for (int i = 0; i < n && !bad && status[0] == 0; i++)
    if (!same(out[0][i], out[1][i])) bad = 1, at = i;
  if (bad && differences++ < 20)
    printf("%s: %s: status %d and %d, element %d: %.17g and %.17g\n", where, what, status[0], status[1], at,
           at < 0 ? 0 : out[0][at], at < 0 ? 0 : out[1][at]);
  for (int k = 0; k < SIDES; k++) memset(out[k], 0, (size_t)(n < 0 ? 0 : n) * sizeof(double));
}

/* Whether both sides have a part, or neither. */
static int both(const void *const *s, const char *what) {
  if (!s[0] != !s[1]) printf("%s: %s is missing\n", where, what), differences++;
  return s[0] && s[1];
}

#define STATE t, q, v, z, p, u
/* Calls a function of both sides, s[0] and s[1] being structures with the same functions. */
#define CALL(what, n, expression)                                                               \
  do {                                                                                          \
    for (int k = 0; k < SIDES; k++) status[k] = s[k]->what ? (expression) : 0;                  \
    if (!s[0]->what != !s[1]->what) printf("%s: %s is missing\n", where, #what), differences++; \
    if (s[0]->what) compare(#what, n);                                                          \
  } while (0)

static void of_constraints(const lag_constraints *const *s, int nq) {
  if (!both((const void *const *)s, "constraints")) return;
  int n = s[0]->n;
  CALL(residuals, 2 * n, s[k]->residuals(s[k], STATE, out[k], out[k] + n, w[k]));
  CALL(matrices, s[0]->njacobian + s[0]->nmass, s[k]->matrices(s[k], STATE, out[k], out[k] + s[0]->njacobian, w[k]));
  CALL(position, 2 * nq, s[k]->position(s[k], STATE, g, out[k], out[k] + nq, w[k]));
  CALL(velocity, 2 * nq, s[k]->velocity(s[k], STATE, g, out[k], out[k] + nq, w[k]));
}

static double *random_numbers(size_t n, double scale) {
  double *r = room(n);
  for (size_t i = 0; i < n; i++) r[i] = scale * (2 * uniform() - 1);
  return r;
}

/* Members of families of contacts have coordinates and parameters of their own. */
static void of_families(const lag_contact_families *const *s) {
  if (!both((const void *const *)s, "families of contacts")) return;
  CALL(inertia, s[0]->nmass, s[k]->inertia(s[k], STATE, out[k], w[k]));
  for (int i = 0; i < s[0]->n; i++) {
    const lag_contact_family *const f[] = {&s[0]->of[i], &s[1]->of[i]};
    const int n = f[0]->ncoords, rows = 1 + f[0]->tangents;
    double *x = random_numbers((size_t)n, 1), *y = random_numbers((size_t)n, 1),
           *own = random_numbers((size_t)f[0]->nparams, 1);
    CALL(of[i].values, 5 + f[0]->tangents + rows * n, f[k]->values(f[k], t, x, y, own, p, u, out[k], w[k]));
    if (f[0]->reach) CALL(of[i].reach, 4, f[k]->reach(f[k], t, x, y, own, p, u, out[k], w[k]));
    free(x), free(y), free(own);
  }
}

static void of_charges(const lag_charges *const *s) {
  if (!both((const void *const *)s, "charges")) return;
  CALL(values, 2 * (s[0]->n - 1), s[k]->values(s[k], STATE, out[k], w[k]));
  CALL(powers, s[0]->n + s[0]->dry_friction, s[k]->powers(s[k], STATE, out[k], w[k]));
}

static void of_partials(const lag_partials *const *s, int nmass) {
  if (!both((const void *const *)s, "derivatives by parameters or inputs")) return;
  CALL(eval, s[0]->n + nmass, s[k]->eval(s[k], STATE, a, out[k], out[k] + s[0]->n, w[k]));
}

static void of_adjoint(const lag_adjoint *const *s, const lag_model *m) {
  int ny = 2 * m->nq + m->nz, up = m->nu + m->np;
  if (!both((const void *const *)s, "reverse mode")) return;
  CALL(eval, ny + up + s[0]->n, s[k]->eval(s[k], STATE, a, g, out[k], out[k] + ny, out[k] + ny + up, w[k]));
}

static void of_linear(const lag_linear *const *s, const lag_model *m) {
  if (!both((const void *const *)s, "linear")) return;
  CALL(eval, s[0]->ndr + s[0]->nmass, s[k]->eval(s[k], STATE, a, out[k], out[k] + s[0]->ndr, w[k]));
  CALL(jumps, s[0]->njump, s[k]->jumps(s[k], STATE, out[k], w[k]));
  of_partials((const lag_partials *const[]){s[0]->by_params, s[1]->by_params}, s[0]->nmass);
  of_partials((const lag_partials *const[]){s[0]->by_inputs, s[1]->by_inputs}, s[0]->nmass);
  of_adjoint((const lag_adjoint *const[]){s[0]->adjoint, s[1]->adjoint}, m);
}

static void of_taylor(const lag_taylor *const *s, const lag_model *m) {
  if (!both((const void *const *)s, "taylor") || (s[0]->order + 1) * s[0]->columns > ROOM) return;
  double *follows = room((size_t)m->nu), T = uniform() < 0.5 ? 0.125 : uniform(), at = 2 * uniform() - 1;
  for (int i = 0; i < m->nu; i++) follows[i] = uniform() < 0.5;
  int n = 1 + (int)(uniform() * ORDERS), ny = 2 * m->nq + m->nz, columns = s[0]->columns, failed = 0;
  CALL(first, ny + m->nq + m->nz, s[k]->first(s[k], STATE, follows, out[k], w[k]));
  for (int k = 0; k < SIDES; k++) {
    memset(x[k], 0, ROOM * sizeof(double));
    status[k] = s[k]->first(s[k], STATE, follows, x[k], w[k]);
    failed |= status[k] != 0;
    if (!status[k]) s[k]->rest(s[k], n, T, x[k], w[k]);
    for (int order = 0; order <= n && !failed; order++)
      for (int i = 0; i < ny; i++) out[k][order * ny + i] = x[k][order * columns + i];
  }
  compare("rest", failed ? 0 : (n + 1) * ny);
  double *y = room((size_t)s[0]->width), *dy = room((size_t)s[0]->width);
  for (int k = 0; k < SIDES && !failed; k++) {
    s[k]->at(s[k], n, at, x[k], y, dy);
    memcpy(out[k], y, (size_t)ny * sizeof *y), memcpy(out[k] + ny, dy, (size_t)ny * sizeof *y);
  }
  compare("at", 2 * ny);
  free(follows), free(y), free(dy);
}

static void of_model(const lag_model *const *s) {
  const lag_model *m = s[0];
  int nq = m->nq, nz = m->nz;
  CALL(accel, nq + nz, s[k]->accel(s[k], STATE, out[k], out[k] + nq, w[k]));
  CALL(energy, 2, s[k]->energy(s[k], STATE, out[k], w[k]));
  CALL(events, m->nev, s[k]->events(s[k], STATE, out[k], w[k]));
  for (int e = 0; e < m->nev; e++) {
    int stop[SIDES] = {0};
    for (int k = 0; k < SIDES; k++) copy(out[k], q, nq), copy(out[k] + nq, v, nq), copy(out[k] + 2 * nq, z, nz);
    CALL(act, 2 * nq + nz, s[k]->act(s[k], e, STATE, out[k], out[k] + nq, out[k] + 2 * nq, &stop[k], w[k]));
    if (stop[0] != stop[1]) printf("%s: event %d stops one side\n", where, e), differences++;
  }
  CALL(size_values, m->nsizes, s[k]->size_values(s[k], STATE, out[k], w[k]));
  CALL(moving_sizes, m->nmoving, s[k]->moving_sizes(s[k], STATE, out[k], w[k]));
  CALL(variation, 3 * nq, s[k]->variation(s[k], STATE, out[k], out[k] + nq, out[k] + 2 * nq, w[k]));
  CALL(second, m->nsecond, s[k]->second(s[k], STATE, out[k], w[k]));
  CALL(switch_values, m->nswitch, s[k]->switch_values(s[k], STATE, out[k], w[k]));
  CALL(switch_rates, m->nmodes, s[k]->switch_rates(s[k], STATE, out[k], w[k]));
  CALL(switch_grips, m->nmodes, s[k]->switch_grips(s[k], STATE, out[k], w[k]));
  CALL(contact_laws, 3 * m->ncontacts, s[k]->contact_laws(s[k], STATE, out[k], w[k]));
  CALL(guide_loads, 2 * nq + 3 * m->nguides,
       s[k]->guide_loads(s[k], STATE, g, out[k], out[k] + nq, out[k] + 2 * nq, w[k]));
  of_constraints((const lag_constraints *const[]){s[0]->constraints, s[1]->constraints}, nq);
  of_families((const lag_contact_families *const[]){s[0]->families, s[1]->families});
  of_charges((const lag_charges *const[]){s[0]->charges, s[1]->charges});
  CALL(inverse, nq, s[k]->inverse(s[k], STATE, a, out[k], w[k]));
  of_linear((const lag_linear *const[]){s[0]->linear, s[1]->linear}, m);
  of_taylor((const lag_taylor *const[]){s[0]->taylor, s[1]->taylor}, m);
}

/* A state near the scene's start, or anywhere; parameters that are the scene's, or changed by up to a half. */
static void of_scene(const lag_scene *const *s, int turn) {
  const lag_model *m = s[0]->model;
  size_t nq = (size_t)m->nq, nz = (size_t)m->nz, np = (size_t)m->np + (size_t)m->nderived,
         nu = (size_t)(m->nu + m->nmodes + s[0]->nexact), n = (size_t)(m->constraints ? m->constraints->n : 0);
  unsigned char *fixed = calloc((size_t)m->np + 1, 1);
  double *own = room(np), scale = turn % 3 == 0 ? 0.1 : turn % 3 == 1 ? 1 : 10;
  where = s[0]->name;
  for (int i = 0; turn % 2 && i < m->np; i++) fixed[i] = uniform() < 0.3;
  for (int k = 0; k < SIDES; k++) {
    for (int i = 0; i < m->np; i++) out[k][i] = 1.25;
    s[k]->params(s[k], out[k], fixed);
    memcpy(own, out[k], np * sizeof *own);
  }
  compare("params", (int)np);
  p = own, t = turn ? 10 * uniform() : s[0]->t0;
  for (int k = 0; k < SIDES; k++) s[k]->start(s[k], p, out[k], out[k] + nq, out[k] + 2 * nq);
  q = random_numbers(nq, scale), v = random_numbers(nq, scale), z = random_numbers(nz, scale);
  for (size_t i = 0; turn % 4 < 2 && i < nq; i++) q[i] += out[0][i], v[i] += out[0][nq + i];
  for (size_t i = 0; turn % 4 < 2 && i < nz; i++) z[i] += out[0][2 * nq + i];
  compare("start", (int)(2 * nq + nz));
  u = random_numbers(nu, 1), a = random_numbers(nq, scale), g = random_numbers(n + nq + nz, scale);
  if (m->inputs)
    for (int k = 0; k < SIDES; k++) {
      memcpy(out[k], u, (size_t)m->nu * sizeof *u);
      status[k] = s[k]->model->inputs(s[k]->model, t, p, out[k]);
    }
  if (m->inputs) memcpy(u, out[0], (size_t)m->nu * sizeof *u), compare("inputs", m->nu);
  for (int i = 0; i < m->ncontacts; i++) u[m->contacts[i].input] = uniform() < 0.5;
  for (int i = 0; i < m->nmodes; i++) u[m->nu + i] = uniform() < 0.5 ? LAG_FREE : 2 * uniform() - 1;
  of_model((const lag_model *const[]){s[0]->model, s[1]->model});
  CALL(observe, s[0]->nout, s[k]->observe(s[k], STATE, out[k], w[k]));
  CALL(exact, s[0]->nexact, s[k]->exact(s[k], STATE, out[k]));
  free(q), free(v), free(z), free(u), free(a), free(g), free(own), free(fixed);
}

static void *bytes_of(const char *path, size_t *n) {
  FILE *f = fopen(path, "rb");
  if (!f || fseek(f, 0, SEEK_END) != 0) exit(2);
  *n = (size_t)ftell(f);
  void *bytes = malloc(*n + 1);
  rewind(f);
  if (!bytes || fread(bytes, 1, *n, f) != *n) exit(2);
  fclose(f);
  return bytes;
}

/* All functions of all scenes of two programs. */
static void of_programs(const lag_program *const *of, int states) {
  enum { MOST = 1 << 20 };
  for (int i = 0; i < of[0]->nscenes; i++) {
    const lag_scene *s[] = {of[0]->scenes[i], of[1]->scenes[i]};
    int too_large = 0;
    for (int k = 0; k < SIDES; k++) {
      const lag_model *m = s[k]->model;
      size_t need = (size_t)(m->taylor && m->taylor->nw > m->nw ? m->taylor->nw : m->nw);
      too_large |= need > MOST || m->nderived > ROOM || m->nmodes > ROOM;
      w[k] = too_large ? NULL : room(need);
    }
    if (strcmp(s[0]->model->digest, s[1]->model->digest) != 0)
      printf("%s: another digest\n", s[0]->name), differences++;
    for (int turn = 0; turn < states && !too_large; turn++) of_scene(s, turn);
    for (int k = 0; k < SIDES; k++) free(w[k]);
  }
}

/* Changes a bit, a byte or a word, or cuts the end off. */
static size_t damage(unsigned char *bytes, size_t n) {
  size_t at = (size_t)(uniform() * (double)n), word = at / 4 * 4;
  switch ((int)(uniform() * 5)) {
  case 0: bytes[at] ^= (unsigned char)(1 << (int)(uniform() * 8)); break;
  case 1: bytes[at] = (unsigned char)(uniform() * 256); break;
  case 2: memset(bytes + word, uniform() < 0.5 ? 255 : 0, n - word < 4 ? n - word : 4); break;
  case 3: bytes[word] = (unsigned char)(bytes[word] + (uniform() < 0.5 ? 1 : 255)); break;
  default: return at;
  }
  return n;
}

static int fuzz(const unsigned char *bytes, size_t n, int count) {
  const char *day = getenv("DAY"); /* others each day: tests/run.sh */
  int refused = 0;
  seed += day ? strtoull(day, NULL, 10) : 0;
  for (int i = 0; i < count; i++) {
    unsigned char *copy = malloc(n + 1);
    const char *why = NULL;
    memcpy(copy, bytes, n);
    size_t left = damage(copy, n);
    unsigned char *exact = malloc(left ? left : 1); /* a read past the end is seen */
    memcpy(exact, copy, left);
    const lag_program *p = lag_program_read(exact, left, &why);
    free(copy), free(exact);
    refused += !p;
    if (!p && !why) return printf("refused without a reason\n"), 1;
    if (p) of_programs((const lag_program *const[]){p, p}, 2);
    lag_program_free(p);
  }
  printf("%d refused, %d run\n", refused, count - refused);
  return 0;
}

static const lag_program *load(const char *path) {
  void *library = dlopen(path, RTLD_NOW | RTLD_LOCAL), *f = library ? dlsym(library, "lag_library") : NULL;
  const lag_program *(*get)(void);
  if (!f) printf("%s\n", dlerror()), exit(2);
  memcpy(&get, &f, sizeof get);
  return get();
}

int main(int argc, char **argv) {
  size_t n;
  const char *why;
  if (argc != 4) return 2;
  void *bytes = bytes_of(argv[1], &n);
  for (int k = 0; k < SIDES; k++) out[k] = room(ROOM), x[k] = room(ROOM);
  if (strcmp(argv[2], "-") == 0) return status[0] = fuzz(bytes, n, atoi(argv[3])), free(bytes), status[0];
  const lag_program *evaluated = lag_program_read(bytes, n, &why), *compiled = load(argv[2]);
  if (!evaluated) return printf("%s\n", why), 2;
  if (compiled->nscenes != evaluated->nscenes) return printf("other scenes\n"), 1;
  of_programs((const lag_program *const[]){compiled, evaluated}, atoi(argv[3]));
  printf("%d calls, %d differ\n", calls, differences);
  lag_program_free(evaluated);
  free(bytes);
  return differences > 0;
}
