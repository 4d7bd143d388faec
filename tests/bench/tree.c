/* Forces by a tree of the bodies of a Plummer sphere: seconds and errors by opening angle. With REBOUND defined by
 * REBOUND's tree, else by lag_tree.h as emitted C calls it; arguments: the number of bodies, then opening angles. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

static double *place, *force; /* [3n]; of masses 1/n, softened */
static int n;
static const double softening = 0.01;

static double seconds(void) {
  struct timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return (double)t.tv_sec + 1e-9 * (double)t.tv_nsec;
}

static double uniform(void) {
  static unsigned long long state = 1;
  state = state * 6364136223846793005u + 1442695040888963407u;
  return ((double)(state >> 11) + 0.5) / 9007199254740992.0;
}

/* S. J. Aarseth, M. Henon, R. Wielen, Astron. Astrophys. 37 (1974) 183; within 0.999 of the mass. */
static void make_bodies(void) {
  place = malloc(3 * (size_t)n * sizeof *place), force = malloc(3 * (size_t)n * sizeof *force);
  for (int k = 0; k < n; k++) {
    double r = 1 / sqrt(pow(0.999 * uniform(), -2.0 / 3) - 1), z = 2 * uniform() - 1, angle = 2 * acos(-1) * uniform();
    place[3 * k] = r * sqrt(1 - z * z) * cos(angle), place[3 * k + 1] = r * sqrt(1 - z * z) * sin(angle);
    place[3 * k + 2] = r * z;
  }
}

#ifdef REBOUND
#include "rebound.h"
static struct reb_simulation *sim;
static void prepare(void) {
  double most = 0;
  for (int k = 0; k < 3 * n; k++) most = fmax(most, fabs(place[k]));
  sim = reb_simulation_create();
  sim->softening = softening, sim->gravity = REB_GRAVITY_TREE, sim->root_size = 2.1 * most;
  for (int k = 0; k < n; k++)
    reb_simulation_add(sim, (struct reb_particle){
        .x = place[3 * k], .y = place[3 * k + 1], .z = place[3 * k + 2], .m = 1.0 / n});
}
static void forces(double angle) {
  sim->opening_angle2 = angle * angle;
  reb_simulation_update_acceleration(sim);
}
static void read_forces(void) {
  for (int k = 0; k < n; k++) {
    const struct reb_particle *x = &sim->particles[k];
    force[3 * k] = x->ax, force[3 * k + 1] = x->ay, force[3 * k + 2] = x->az;
  }
}
#else
#include "lag_tree.h"
static lag_tree tree = {.parts = 3, .step = 3, .first = {0, 1, 2}, .energy = -1, .slope = {0, 1, 2}, .by = 3};
static double *charge;
static void prepare(void) {
  charge = malloc((size_t)n * sizeof *charge);
  for (int k = 0; k < n; k++) charge[k] = 1;
  double *numbers = malloc(LAG_TREE_NUMBERS((size_t)n) * sizeof *numbers);
  lag_tree_open(&tree, n, numbers, malloc(LAG_TREE_INTS((size_t)n) * sizeof(int)));
}
static void forces(double angle) {
  for (int k = 0; k < 3 * n; k++) force[k] = 0;
  lag_tree_sum(&tree, place, charge, (const double[]){1.0 / n, softening * softening, angle}, force);
}
static void read_forces(void) {}
#endif

/* Root of the mean square of errors at 200 bodies, beside that of direct forces. */
static double force_error(void) {
  enum { SAMPLES = 200 };
  double gaps = 0, sizes = 0;
  for (int s = 0; s < SAMPLES; s++) {
    int i = (int)((long)s * n / SAMPLES);
    double direct[3] = {0};
    for (int j = 0; j < n; j++) {
      double d[3], r2 = softening * softening;
      for (int c = 0; c < 3; c++) d[c] = place[3 * i + c] - place[3 * j + c], r2 += d[c] * d[c];
      for (int c = 0; c < 3; c++) direct[c] -= d[c] / (r2 * sqrt(r2)) / n;
    }
    for (int c = 0; c < 3; c++) gaps += pow(force[3 * i + c] - direct[c], 2), sizes += direct[c] * direct[c];
  }
  return sqrt(gaps / sizes);
}

int main(int argc, char **argv) {
  n = atoi(argv[1]);
  make_bodies();
  prepare();
  for (int k = 2; k < argc; k++) {
    double best = INFINITY;
    for (int round = 0; round < 2; round++) {
      double start = seconds();
      forces(atof(argv[k]));
      best = fmin(best, seconds() - start);
    }
    read_forces();
    printf("%s %.4g %.4g\n", argv[k], best, force_error());
  }
}
