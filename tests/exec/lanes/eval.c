/* What every function of emitted models computes at the same random states, as a double or in lanes: a line a state
 * and function, `model function status values...`, for long_lanes.sh to compare. Linked with scenes.c, which lists
 * the models' scenes.
 *
 * A lane's status is -1 when its bit in the negative of the function's is set. States differ in sign and size, so
 * that lanes take different branches; some have angles beyond what short reductions take. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "lag_model.h"

extern const lag_scene *const all_scenes[];

enum { STATES = 48, ROOM = 40000, ORDER = 8 };

#ifdef LAG_LANES
enum { LANES = LAG_LANES };
static void put(LAG_REAL *x, int lane, double value) { (*x)[lane] = value; }
static double get(const LAG_REAL *x, int lane) { return (*x)[lane]; }
#else
enum { LANES = 1 };
static void put(LAG_REAL *x, int lane, double value) { (void)lane, *x = value; }
static double get(const LAG_REAL *x, int lane) { return (void)lane, *x; }
#endif

static uint64_t seed;
static double next(void) { /* in (-3, 3) */
  seed = seed * 6364136223846793005u + 1442695040888963407u;
  return ((double)(seed >> 33) / 1073741824.0 - 1.0) * 3;
}

static LAG_REAL t, *q, *v, *z, *p, *u, *w, *out, *a;

static void fill(LAG_REAL *x, int n, int lane, double scale) {
  for (int i = 0; i < n; i++) put(&x[i], lane, next() * scale);
}

/* A number as all compilers print it. */
static void number(double x) {
  if (isnan(x)) printf(" nan");
  else printf(" %.17g", x);
}

static void print(const char *model, const char *function, int status, const LAG_REAL *x, int n) {
  for (int lane = 0; lane < LANES; lane++) {
    const int mine = status < 0 ? -(-status >> lane & 1) : status;
    printf("%s %s %d", model, function, mine);
    for (int i = 0; i < n && mine == 0; i++) number(get(&x[i], lane));
    putchar('\n');
  }
}

static void copy(LAG_REAL *to, const LAG_REAL *from, int n) { memcpy(to, from, (size_t)n * sizeof *to); }

static void actions(const lag_model *m) {
  for (int k = 0; k < m->nev; k++) {
    int stop = 0;
    copy(out, q, m->nq);
    copy(out + m->nq, v, m->nq);
    copy(out + 2*m->nq, z, m->nz);
    const int status = m->act(m, k, t, q, v, z, p, u, out, out + m->nq, out + 2*m->nq, &stop, w);
    char name[32];
    snprintf(name, sizeof name, "%s%d", stop ? "stops" : "acts", k);
    print(m->name, name, status, out, 2*m->nq + m->nz);
  }
}

static void derivatives(const lag_model *m) {
  if (m->variation) {
    int status = m->variation(m, t, q, v, z, p, u, out, out + m->nq, out + 2*m->nq, w);
    print(m->name, "variation", status, out, 3*m->nq);
    status = m->second(m, t, q, v, z, p, u, out, w);
    print(m->name, "second", status, out, m->nsecond);
  }
  if (m->linear) {
    const lag_linear *l = m->linear;
    const int status = l->eval(l, t, q, v, z, p, u, a, out, out + l->ndr, w);
    print(m->name, "linear", status, out, l->ndr + l->nmass);
  }
}

static void series(const lag_model *m) {
  const lag_taylor *s = m->taylor;
  LAG_REAL follows[64], unit = t - t, step = unit;
  if (!s || s->columns*(ORDER + 1) > ROOM/2 || s->nw > ROOM) return;
  for (int lane = 0; lane < LANES; lane++) put(&unit, lane, 0.03125), put(&step, lane, 0.25);
  for (int i = 0; i < m->nu; i++) follows[i] = unit*32;
  memset(out, 0, ROOM * sizeof *out); /* what pads rows is not written */
  int status = s->first(s, t, q, v, z, p, u, follows, out, w);
  if (status >= 0) s->rest(s, ORDER, unit, out, w);
  print(m->name, "taylor", status, out, s->columns*ORDER);
  LAG_REAL *const y = out + ROOM/2;
  s->at(s, ORDER, step, out, y, y + s->width);
  print(m->name, "taylor_at", status, y, 2*m->nq + m->nz);
}

static void evaluate(const lag_scene *s) {
  const lag_model *m = s->model;
  if (m->inputs) print(m->name, "inputs", m->inputs(m, t, p, u), u, m->nu);
  int status = m->accel(m, t, q, v, z, p, u, a, a + m->nq, w);
  print(m->name, "accel", status, a, m->nq + m->nz);
  if (m->energy) status = m->energy(m, t, q, v, z, p, u, out, w), print(m->name, "energy", status, out, 2);
  if (m->events) status = m->events(m, t, q, v, z, p, u, out, w), print(m->name, "events", status, out, m->nev);
  status = s->observe(s, t, q, v, z, p, u, out, w);
  print(m->name, "observe", status, out, s->nout);
  actions(m);
  for (int i = 0; i < m->nq; i++) a[i] = q[i] + v[i];
  derivatives(m);
  series(m);
}

static LAG_REAL *reals(size_t n) {
  LAG_REAL *x = aligned_alloc(64, (n * sizeof *x + 63) / 64 * 64);
  if (!x) exit(2);
  memset(x, 0, n * sizeof *x);
  return x;
}

int main(void) {
  LAG_REAL **const all[] = {&q, &v, &z, &p, &u, &w, &out, &a};
  for (size_t i = 0; i < sizeof all / sizeof *all; i++) *all[i] = reals(ROOM);
  for (int i = 0; all_scenes[i]; i++) {
    const lag_scene *s = all_scenes[i];
    const lag_model *m = s->model;
    static const unsigned char none[ROOM];
    seed = 1;
    if (2 * (2 * m->nq + m->nz) > ROOM || m->nw > ROOM || m->np + m->nderived > ROOM)
      return printf("%s is too large\n", m->name), 1;
    for (int state = 0; state < STATES; state += LANES) {
      s->params(s, p, none);
      for (int lane = 0; lane < LANES; lane++) {
        const double scale = (state + lane) % 7 == 6 ? 1e6 : (state + lane) % 5 == 4 ? 0.01 : 1;
        put(&t, lane, next());
        fill(q, m->nq, lane, scale);
        fill(v, m->nq, lane, 1);
        fill(z, m->nz, lane, 1);
        for (int k = 0; k < m->nmodes; k++) { /* free, or held */
          const double held = next();
          put(&u[m->nu + k], lane, held < 0 ? LAG_FREE : held - 1.5);
        }
        fill(u + m->nu + m->nmodes, s->nexact, lane, 1); /* closed forms, as observe has them */
        for (int k = 0; k < m->np; k++) put(&p[k], lane, get(&p[k], lane) * (1 + next() / 16));
      }
      if (m->derive) m->derive(m, p);
      evaluate(s);
    }
  }
  return 0;
}
