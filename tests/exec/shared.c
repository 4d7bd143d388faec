/* A program around shared libraries of `lagc build --shared`: the spring (x = cos 2t from 1), linked; a second
 * library, opened beside it. */
#include <dlfcn.h>
#include <lag.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int bad;
static void near(const char *what, double got, double want, double within) {
  if (fabs(got - want) <= within) return;
  bad = 1;
  printf("%s: got %.17g, expected %.17g\n", what, got, want);
}

static void events(void *context, int k, double t, const double *before, const double *after) {
  double *first = context;
  if (k == 0 && isnan(*first)) *first = t;
  if (after[1] != -0.8 * before[1]) *first = -1;
}

typedef const lag_program *Library(void);
typedef lag_sim *New(const lag_scene *scene);
typedef int Rows(lag_sim *sim, int rows, const double *t, double *y, double *out, int *done);
typedef void Hook(lag_sim *sim, lag_event_fn *hook, void *context);
typedef void Free(lag_sim *sim);

/* The ball of the other library: it falls from 1 m, and bounces at sqrt(2/g). */
static void other_library(const char *path) {
  void *so = dlopen(path, RTLD_NOW | RTLD_LOCAL);
  Library *library = so ? (Library *)dlsym(so, "lag_library") : NULL;
  if (!library || library == lag_library) {
    bad = 1;
    printf("%s: %s\n", path, so ? "its names are those of the linked library" : dlerror());
    return;
  }
  double first = NAN, t = 1, y[2];
  int done;
  lag_sim *sim = ((New *)dlsym(so, "lag_sim_new"))(library()->scenes[0]);
  ((Hook *)dlsym(so, "lag_sim_on_event"))(sim, events, &first);
  if (((Rows *)dlsym(so, "lag_sim_rows"))(sim, 1, &t, y, NULL, &done) != LAG_OK) bad = 1;
  near("first bounce", first, sqrt(2 / 9.81), 1e-9);
  ((Free *)dlsym(so, "lag_sim_free"))(sim);
}

int main(int argc, char **argv) {
  enum { ROWS = 3, COUNT = 5 };
  const double t[ROWS] = {1, 2, 5};
  double y[COUNT * ROWS * 2], out[16 * ROWS], y0[COUNT * 2], p[COUNT * 2], dy[COUNT * 2], times[COUNT] = {0}, Y[4], t0,
                                                                                          t1, every;
  int status[COUNT], done;
  const lag_scene *scene = lag_library_scene(lag_library(), 0);
  const char *unit;
  double factor;
  if (argc < 2 || lag_library_abi() != LAG_ABI || lag_library_scene(lag_library(), 99) ||
      strcmp(lag_scene_span(scene, &t0, &t1, &every), "free") != 0)
    return 1;
  if (strcmp(lag_item(scene, 'q', 0, &unit, &factor, NULL), "x") != 0 || lag_item(scene, 'q', 1, NULL, NULL, NULL) ||
      lag_item(scene, '?', 0, NULL, NULL, NULL))
    return 1;
  lag_sim *sim = lag_sim_new(scene);
  if (lag_sim_set(sim, "x", 1 / factor) || lag_sim_set_method(sim, lag_find_method("dop853"), NULL, 0) ||
      lag_sim_set_tolerance(sim, 1e-12))
    return 1;
  if (lag_sim_set_tangent(sim, 2, NULL)) printf("%s\n", lag_sim_message(sim)), bad = 1;
  for (int k = 0; k < COUNT; k++) y0[2 * k] = k, y0[2 * k + 1] = 1, p[2 * k] = 1 + k, p[2 * k + 1] = 4; /* m, k */
  /* rates: x'' = -4x */
  if (lag_sim_rhs(sim, COUNT, times, y0, dy)) bad = 1;
  for (int k = 0; k < COUNT; k++) near("rate", dy[2 * k], 1, 0), near("rate", dy[2 * k + 1], -4 * k, 1e-14);
  /* many motions, before the first step of `sim`: x = x0 cos wt + v0/w sin wt, w = sqrt(4/m) */
  if (lag_sim_batch(sim, COUNT, y0, p, ROWS, t, y, status)) bad = 1;
  for (int k = 0; k < COUNT; k++)
    for (int i = 0; i < ROWS; i++) {
      double w = sqrt(4 / p[2 * k]);
      near("batch", y[(k * ROWS + i) * 2], k * cos(w * t[i]) + sin(w * t[i]) / w, 1e-9);
      near("status", status[k], 0, 0);
    }
  /* rows, the tangent of the flow, the energy 2 J */
  if (lag_sim_rows(sim, ROWS, t, y, out, &done) || done != ROWS) bad = 1;
  for (int i = 0; i < ROWS; i++) near("x", y[2 * i], cos(2 * t[i]), 1e-9);
  if (lag_sim_tangent(sim, Y)) bad = 1;
  near("dx/dv", Y[1], sin(10) / 2, 1e-9);
  lag_stats stats;
  lag_sim_stats(sim, &stats);
  near("energy", stats.energy, 2, 1e-9);
  lag_sim *like = lag_sim_like(sim);
  if (!like || lag_sim_method(like) != lag_find_method("dop853") || lag_sim_time(like) != 0 || lag_sim_q(like)[0] != 1)
    bad = 1;
  lag_sim_free(like);
  lag_sim_free(sim);
  sim = lag_sim_new(scene);
  if (lag_sim_set(sim, "m", 3) || !(like = lag_sim_like(sim)) || lag_sim_set(like, "k", 5)) return 1;
  near("a value that stays set", lag_sim_p(like)[0], 3, 0);
  lag_sim_free(like);
  lag_sim_free(sim);
  other_library(argv[1]);
  return bad;
}
