/* lag_planar_impact against Routh's equations integrated by small steps of the impulse, and against closed forms;
 * lag_contact_modes and lag_cone_forces against problems whose motions are known. */
#include "test_rt_models.h"

#include "contacts/contact_modes.h"
#include "contacts/planar_impact.h"

static double chance(uint64_t *state) { /* a number in [0, 1): D. Knuth's generator (MMIX) */
  *state = *state * 6364136223846793005u + 1442695040888963407u;
  return (double)(*state >> 11) * 0x1p-53;
}

static double sign(double x) { return (x > 0) - (x < 0); }

/* The impulses of a law by steps h of the normal impulse: another algorithm, of error O(h). */
static void by_steps(const double *W, const double *v, int law, double mu, double e, double h, double *P) {
  double vn = v[0], vt = v[1], work = 0, least = 0, squeezed = 0;
  P[0] = P[1] = 0;
  for (long i = 0; i < 100000000; i++) {
    if (vn < 0) squeezed = P[0];
    if (vn >= 0 && (law == LAG_IMPACT_STRONGE   ? work >= (1 - e * e) * least
                    : law == LAG_IMPACT_POISSON ? P[0] >= (1 + e) * squeezed
                                                : vn >= -e * v[0]))
      break;
    double f = -mu * sign(vt), hold = -(W[2] + vt / h) / W[3]; /* the friction that stops the slip in this step */
    f = fabs(hold) <= mu ? hold : vt != 0 ? f : mu * sign(hold);
    work += h * vn;
    least = fmin(least, work);
    vn += h * (W[0] + W[1] * f);
    vt += h * (W[2] + W[3] * f);
    P[0] += h;
    P[1] += h * f;
  }
}

static double energy_gain(const double *W, const double *v, const double *P) {
  double vn = v[0] + W[0] * P[0] + W[1] * P[1], vt = v[1] + W[2] * P[0] + W[3] * P[1];
  return (P[0] * (v[0] + vn) + P[1] * (v[1] + vt)) / 2;
}

static void random_impact(uint64_t *seed, double *W, double *v) {
  double a = 0.5 + chance(seed), b = 2 * chance(seed) - 1, c = 0.5 + chance(seed); /* W = R R^T */
  W[0] = a * a + b * b;
  W[1] = W[2] = b * c;
  W[3] = c * c;
  v[0] = -0.2 - chance(seed);
  v[1] = 4 * chance(seed) - 2;
}

static void test_laws(void **state) {
  (void)state;
  uint64_t seed = 1;
  for (int i = 0; i < 90; i++) {
    double W[4], v[2], P[2], S[2], mu = 2 * chance(&seed), e = i % 3 ? chance(&seed) : (i / 3) % 2, h = 1e-5;
    random_impact(&seed, W, v);
    lag_planar_impact(W, v, i / 30, mu, e, 0, P);
    by_steps(W, v, i / 30, mu, e, h, S);
    /* first order in h; e = 0 and slips that turn cost some steps */
    assert_true(fabs(P[0] - S[0]) < 3e-3 && fabs(P[1] - S[1]) < 3e-3);
  }
}

static void test_energy_never_grows(void **state) {
  (void)state;
  uint64_t seed = 7;
  int gains = 0;
  for (int i = 0; i < 20000; i++) {
    double W[4], v[2], P[2], back = i % 2 ? chance(&seed) : 0, mu = 3 * chance(&seed), e = i % 5 ? chance(&seed) : 1;
    int law = i / 2 % 3;
    random_impact(&seed, W, v);
    double gain = lag_planar_impact(W, v, law, mu, e, back, P);
    if (!(gain == 0)) { /* told by Newton's law and by that of a superball alone */
      assert_true(back > 0 || law == LAG_IMPACT_NEWTON);
      if (gain > 0)
        assert_true(fabs(gain - energy_gain(W, v, P)) <= 1e-12 * (gain + fabs(P[0] * v[0]) + fabs(P[1] * v[1])));
      gains += back == 0;
      continue;
    }
    double size = fabs(P[0] * v[0]) + fabs(P[1] * v[1]);
    assert_true(energy_gain(W, v, P) <= 1e-13 * size);
    assert_true(P[0] > 0 && fabs(P[1]) <= mu * P[0] * (1 + 1e-12));
    assert_true(v[0] + W[0] * P[0] + W[1] * P[1] >= -1e-12 * fabs(v[0]));
  }
  assert_true(gains > 20); /* Newton's law adds energy in some impacts whose slip turns */
}

/* A ball of I = 2/5 m r^2, m = 1: W = [1 0; 0 7/2]. Garwin, Am. J. Phys. 37 (1969) 88: both velocities of the
 * contact are reversed. */
static void test_superball(void **state) {
  (void)state;
  double W[4] = {1, 0, 0, 3.5}, v[2] = {-2, 1.3}, P[2];
  assert_true(lag_planar_impact(W, v, LAG_IMPACT_STRONGE, 10, 1, 1, P) == 0);
  assert_true(fabs(P[0] - 4) < 1e-15 && fabs(P[1] + 2 * 1.3 / 3.5) < 1e-15 && fabs(energy_gain(W, v, P)) < 1e-15);
}

/* Stronge's law in space by steps h of the normal impulse, where no friction can hold the slip. */
static void by_steps_in_space(const double *W, const double *v, double mu, double e, double h, double *P) {
  double u[3] = {v[0], v[1], v[2]}, work = 0, least = 0;
  P[0] = P[1] = P[2] = 0;
  while (u[0] < 0 || work < (1 - e * e) * least) {
    double slip = hypot(u[1], u[2]), f[3] = {1, -mu * u[1] / slip, -mu * u[2] / slip};
    work += h * u[0];
    least = fmin(least, work);
    for (int i = 0; i < 9; i++) u[i / 3] += h * W[i] * f[i % 3];
    for (int i = 0; i < 3; i++) P[i] += h * f[i];
  }
}

/* A slip that turns, by another algorithm; and one that stays in a plane, next to that of the plane, where it stops,
 * sticks and turns back. */
static void test_impact_in_space(void **state) {
  (void)state;
  uint64_t seed = 3;
  for (int i = 0; i < 6; i++) {
    double W[9] = {1.2, 0.3, -0.2, 0.3, 1.5, 0.1, -0.2, 0.1, 0.8}, v[3] = {-1, 2, 1 - 0.4 * i}, P[3], S[3];
    double mu = 0.1 + 0.2 * chance(&seed), e = chance(&seed);
    assert_true(lag_space_impact(W, v, LAG_IMPACT_STRONGE, mu, e, 0, P) == 0);
    by_steps_in_space(W, v, mu, e, 1e-5, S);
    for (int k = 0; k < 3; k++) assert_true(fabs(P[k] - S[k]) < 5e-5); /* first order in h */
  }
  for (int i = 0; i < 60; i++) {
    double U[4], u[2], Q[2], P[3], a = 2 * chance(&seed), c = cos(a), d = sin(a);
    double mu = 2 * chance(&seed), e = chance(&seed);
    random_impact(&seed, U, u);
    /* out of the plane little turns the slip: 1e-9 */
    double W[9] = {U[0], c * U[1], d * U[1] + 1e-9, c * U[1], c * c * U[3] + d * d, c * d * (U[3] - 1),
                   d * U[1] + 1e-9, c * d * (U[3] - 1), d * d * U[3] + c * c};
    lag_planar_impact(U, u, LAG_IMPACT_STRONGE, mu, e, 0, Q);
    assert_true(lag_space_impact(W, (double[]){u[0], c * u[1], d * u[1]}, LAG_IMPACT_STRONGE, mu, e, 0, P) == 0);
    assert_true(fabs(P[0] - Q[0]) < 1e-6 && fabs(P[1] - c * Q[1]) < 1e-6 && fabs(P[2] - d * Q[1]) < 1e-6);
  }
}

/* A block on a plane: m = 1, W diagonal; pull = (-g, F). */
static void test_block(void **state) {
  (void)state;
  double W[4] = {1, 0, 0, 1}, x[2], room[2 * 7];
  lag_touch c = {.mu = 0.5, .tangent = 1};
  double held[2] = {-10, 4}, pulled[2] = {-10, 6}, lifted[2] = {3, 6};
  assert_int_equal(lag_contact_modes(1, &c, 2, W, held, x, room), 1);
  assert_true(c.mode == LAG_CONTACT_STICKS && fabs(x[0] - 10) < 1e-10 && fabs(x[1] + 4) < 1e-10);
  assert_int_equal(lag_contact_modes(1, &c, 2, W, pulled, x, room), 1);
  assert_true(c.mode == LAG_CONTACT_SLIPS && c.to == 1 && fabs(x[1] + 5) < 1e-10);
  assert_int_equal(lag_contact_modes(1, &c, 2, W, lifted, x, room), 1);
  assert_true(c.mode == LAG_CONTACT_OPEN);
}

/* The same with a static friction of 0.8, and beside a block with the same pull that has begun to slip: at rest a
 * pull of 6 is held, of 9 is not, and one that moves slips under 5. */
static void test_static(void **state) {
  (void)state;
  double W[4] = {1, 0, 0, 1}, x[4], room[4 * 9], held[2] = {-10, 6}, pulled[2] = {-10, 9};
  lag_touch c = {.mu = 0.5, .hold = 0.8, .tangent = 1};
  assert_int_equal(lag_contact_modes(1, &c, 2, W, held, x, room), 1);
  assert_true(c.mode == LAG_CONTACT_STICKS && fabs(x[1] + 6) < 1e-10);
  assert_int_equal(lag_contact_modes(1, &c, 2, W, pulled, x, room), 1);
  assert_true(c.mode == LAG_CONTACT_SLIPS && c.to == 1 && fabs(x[1] + 5) < 1e-10);
  c.slip = -1;
  assert_int_equal(lag_contact_modes(1, &c, 2, W, held, x, room), 1);
  assert_true(c.mode == LAG_CONTACT_SLIPS && c.to == -1 && fabs(x[1] - 5) < 1e-10);
  double two[16] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, both[4] = {-10, -10, 6, 6};
  lag_touch pair[2] = {{.mu = 0.5, .hold = 0.8, .tangent = 2, .cannot_stick = 1},
                       {.mu = 0.5, .hold = 0.8, .tangent = 3}};
  assert_int_equal(lag_contact_modes(2, pair, 4, two, both, x, room), 1);
  assert_true(pair[0].mode == LAG_CONTACT_SLIPS && pair[1].mode == LAG_CONTACT_STICKS && fabs(x[2] + 5) < 1e-10 &&
              fabs(x[3] + 6) < 1e-10);
}

/* Painleve: while it slips the gap's acceleration falls as the force grows, from mu = W_nn/W_nt = 1.25 on. */
static void test_painleve(void **state) {
  (void)state;
  double W[4] = {1, 0.8, 0.8, 1}, x[2], room[2 * 7], down[2] = {-1, 0}, up[2] = {1, 0};
  lag_touch c = {.mu = 1.2, .tangent = 1, .slip = 1};
  assert_int_equal(lag_contact_modes(1, &c, 2, W, down, x, room), 1);
  assert_true(c.mode == LAG_CONTACT_SLIPS && fabs(x[0] - 1 / (1 - 1.2 * 0.8)) < 1e-9);
  c.mu = 1.3;
  assert_int_equal(lag_contact_modes(1, &c, 2, W, down, x, room), 0);
  assert_int_equal(lag_contact_modes(1, &c, 2, W, up, x, room), 2);
}

/* A block on two feet, N = 5 each: of the friction 2 that holds it each foot may take any part, and half is farthest
 * from the edges, 0.3*5 - 1 = 0.5. Between two walls that nothing drives apart any pressure would do. */
static void test_cone_forces(void **state) {
  (void)state;
  lag_touch feet[2] = {{.mu = 0.3, .tangent = 2, .mode = LAG_CONTACT_STICKS},
                       {.mu = 0.3, .tangent = 3, .mode = LAG_CONTACT_STICKS}};
  double x[4] = {5, 5, -2, 0}, shift[8] = {0, 0, 7, -7, 0, 0, -1, 1}, c[3];
  assert_true(!lag_cone_forces(2, feet, 4, x, 2, shift, c) && fabs(c[2] - 0.5) < 1e-14);
  assert_true(fabs(x[2] + 1) < 1e-14 && fabs(x[3] + 1) < 1e-14 && x[0] == 5 && x[1] == 5);
  double walls[4] = {1, 1, 0, 0}, press[4] = {1, 1, 0, 0};
  assert_true(lag_cone_forces(2, feet, 4, walls, 1, press, c) && walls[0] >= 1);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_laws),       cmocka_unit_test(test_energy_never_grows),
                                     cmocka_unit_test(test_superball), cmocka_unit_test(test_impact_in_space),
                                     cmocka_unit_test(test_block),
                                     cmocka_unit_test(test_static),     cmocka_unit_test(test_painleve),
                                     cmocka_unit_test(test_cone_forces)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
