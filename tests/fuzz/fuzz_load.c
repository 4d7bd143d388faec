/* Fuzzing what comes back from a file: numbers for lag_sim_load, and the text of a saved state. Whatever they are, a
 * load either is refused, and the simulation is what it was, bit by bit, or gives a run that can go on. Nothing may
 * crash, leak, or upset a sanitizer. The first byte of an input says what the rest is:
 *   T: the text of a state without its checksum, which is added
 *   E CASE {FIELD FIELD KIND}: a real state of a case, with these numbers in place of its own
 *   R CASE FIELD FIELD BYTES: the same, with bytes over it from a number on
 *   S KIND: of all cases, after a few steps, this number in place of each in turn; not for libFuzzer, as it takes
 *   seconds
 * Cases are models (tests/fuzz/load, as lagc emits them) by methods, saved at the start, within a step and after a
 * few. */
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "io/io.h"
#include "lag.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

extern const lag_scene load_spring_s, load_pend_s, load_series_s, load_flow_s, load_rod_s, load_ball_s;
static const struct {
  const lag_scene *scene;
  const lag_method *method;
} cases[] = {{&load_spring_s, &lag_rk45},
             {&load_spring_s, &lag_rk4}, {&load_spring_s, &lag_dop853}, {&load_spring_s, &lag_radau},
             {&load_pend_s, &lag_variational}, {&load_pend_s, &lag_gauss}, {&load_pend_s, &lag_verlet4},
             {&load_pend_s, &lag_symplectic_euler}, {&load_series_s, &lag_taylor_method}, {&load_flow_s, &lag_gauss},
             {&load_flow_s, &lag_dop853}, {&load_rod_s, &lag_rk45}, {&load_rod_s, &lag_variational},
             {&load_rod_s, &lag_verlet8}, {&load_rod_s, &lag_radau}, {&load_ball_s, &lag_verlet},
             {&load_ball_s, &lag_dop853}};
static const double until[] = {0, 0.01, 1.234};
enum { NCASES = sizeof cases / sizeof *cases, NUNTIL = sizeof until / sizeof *until, STEPS = 3, MOST_EDITS = 64 };

/* Numbers that a crafted state would have; what is left of a kind's range are small whole numbers. */
static const double wild[] = {0,      -0.0,   1,      -1,       0.5,          -0.5,         2,      31,     32,
                              33,     1e3,    1e9,    -1e9,     2147483648.0, 4294967296.0, 0x1p53, 0x1p63, 1e300,
                              -1e300, 1e-300, 5e-324, HUGE_VAL, -HUGE_VAL,    NAN};
enum { NWILD = sizeof wild / sizeof *wild };

static double number_of(uint8_t kind)
{
  return kind < NWILD ? wild[kind] : kind - 128;
}

static int after_some(void *context, const lag_sim *sim)
{
  (void)sim;
  return ++*(int *)context > STEPS;
}

static lag_sim *new_sim(int k)
{
  lag_sim *sim = lag_sim_new(cases[k].scene);

  if (!sim || lag_sim_set_method(sim, cases[k].method, NULL, 0)) {
    abort();
  }
  return sim;
}

/* A real state, made once. */
static double *real_state(int which, int *k, size_t *n)
{
  static double *states[NCASES * NUNTIL];
  static size_t sizes[NCASES * NUNTIL];

  which %= NCASES * NUNTIL;
  *k = which % NCASES;
  if (!states[which]) {
    lag_sim *sim = new_sim(*k);
    sizes[which] = lag_sim_save_size(sim);
    states[which] = calloc(sizes[which], sizeof(double));
    double t = until[which / NCASES];
    if (!states[which] || (t > 0 && lag_sim_advance(sim, t)) || lag_sim_save(sim, states[which])) {
      abort();
    }
    lag_sim_free(sim);
    sim = new_sim(*k);
    if (lag_sim_load(sim, states[which])) { /* it must come back */
      abort();
    }
    lag_sim_free(sim);
  }
  *n = sizes[which];
  return states[which];
}

/* Whatever a caller may ask of a run. */
static void look(lag_sim *sim)
{
  const lag_scene *c = lag_sim_scene(sim);
  double *out = calloc((size_t)lag_sim_noutputs(sim) + 1, sizeof *out), first, last;
  lag_stats stats;
  lag_charge_stats charge;

  if (!out) {
    return;
  }
  lag_sim_outputs(sim, out);
  lag_sim_stats(sim, &stats);
  lag_sim_judge(sim);
  for (int i = 0; i < c->model->nev; i++) {
    lag_sim_event_times(sim, i, &first, &last);
  }
  for (int i = 0; i < lag_sim_ncharges(sim); i++) {
    lag_sim_charge(sim, i, &charge);
  }
  for (int i = 0; i < c->nmonitors; i++) {
    lag_sim_monitor_drift(sim, i);
  }
  free(out);
}

/* A simulation of each case that has begun, with what it saves: a refused load leaves it for the next one. */
static struct {
  lag_sim *sim;
  double *saved, *again;
} begun[NCASES];

static void begin(int k, size_t n)
{
  begun[k].sim = new_sim(k);
  begun[k].saved = begun[k].saved ? begun[k].saved : malloc(n * sizeof(double));
  begun[k].again = begun[k].again ? begun[k].again : malloc(n * sizeof(double));
  if (!begun[k].saved || !begun[k].again || lag_sim_advance(begun[k].sim, 0.005) ||
      lag_sim_save(begun[k].sim, begun[k].saved)) {
    abort();
  }
}

/* run: goes on from what was loaded, which takes most of the time. */
static void load(int k, const double *x, size_t n, int run)
{
  double reach;
  int steps = 0;

  if (!begun[k].sim) {
    begin(k, n);
  }
  lag_sim *sim = begun[k].sim;
  if (lag_sim_load(sim, x)) {
    if (lag_sim_save(sim, begun[k].again) || memcmp(begun[k].saved, begun[k].again, n * sizeof *x) != 0) {
      abort();
    }
    return;
  }
  look(sim);
  if (run) {
    double t = lag_sim_time(sim), dir = x[1] < 0 ? -1 : 1; /* dir: the second number of Run */
    lag_sim_on_step(sim, after_some, &steps);
    lag_sim_ensure_step(sim, t + dir, &reach);
    lag_sim_advance(sim, t + dir * 1e-3);
    look(sim);
    lag_sim_advance(sim, t + dir);
    look(sim);
    lag_sim_save(sim, begun[k].again);
  }
  if (lag_sim_load(sim, begun[k].saved)) { /* whatever was loaded before, what is real comes back */
    abort();
  }
}

static void load_text(const uint8_t *data, size_t size)
{
  char *text = malloc(size + 32);
  uint64_t h = UINT64_C(0xcbf29ce484222325);
  State state;

  if (!text) {
    return;
  }
  memcpy(text, data, size);
  for (size_t i = 0; i < size; i++) {
    text[i] = text[i] ? text[i] : ' ';
    h = (h ^ (unsigned char)text[i]) * UINT64_C(0x100000001b3);
  }
  snprintf(text + size, 32, "sum %016llx\n", (unsigned long long)h);
  const char *why = lag_state_parse(text, &state);
  if (!why != (state.data != NULL)) {
    abort();
  }
  if (!why) {
    volatile double sum = state.tol + state.t;
    for (size_t i = 0; i < state.n; i++) {
      sum += state.data[i];
    }
  }
  free(state.data);
  free(text);
}

static void load_numbers(const uint8_t *data, size_t size)
{
  int k, run = data[size - 1] % 16 == 7; /* one in 16 */
  size_t n;
  const double *real = real_state(data[1], &k, &n);
  double *x = malloc(n * sizeof *x);

  if (!x) {
    return;
  }
  memcpy(x, real, n * sizeof *x);
  if (data[0] == 'E') {
    for (size_t at = 2; at + 3 <= size && at < 3 * MOST_EDITS; at += 3) {
      x[((size_t)data[at] << 8 | data[at + 1]) % n] = number_of(data[at + 2]);
    }
    load(k, x, n, run);
  } else if (size > 4) {
    size_t from = ((size_t)data[2] << 8 | data[3]) % n * sizeof *x, most = n * sizeof *x - from;
    memcpy((char *)x + from, data + 4, size - 4 < most ? size - 4 : most);
    load(k, x, n, run);
  }
  free(x);
}

static void sweep(uint8_t kind)
{
  int k;
  size_t n;

  for (int which = NCASES * (NUNTIL - 1); which < NCASES * NUNTIL; which++) {
    const double *real = real_state(which, &k, &n);
    double *x = malloc(n * sizeof *x);
    for (size_t i = 0; x && i < n; i++) {
      memcpy(x, real, n * sizeof *x);
      x[i] = number_of(kind);
      load(k, x, n, 1);
    }
    free(x);
  }
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size)
{
  if (size > 1 && data[0] == 'T') {
    load_text(data + 1, size - 1);
  } else if (size > 2 && (data[0] == 'E' || data[0] == 'R')) {
    load_numbers(data, size);
  }
#ifndef FUZZING_BUILD_MODE_UNSAFE_FOR_PRODUCTION
  else if (size > 1 && data[0] == 'S') {
    sweep(data[1]);
  }
#endif
  return 0;
}
