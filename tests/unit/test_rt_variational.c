/* variational and gauss: exact digits of the algorithm, measured orders of steps and of dense output, the symplectic form in
 * q and p, what Newton's method costs and how it fails, forces. Expected values: closed forms, trajectories of the algorithm
 * itself in 40- and 60-digit arithmetic by an independent script, and dop853 in small steps. */
#include "test_rt_systems.h"

typedef struct Digits {
  double start[2], h, steps, end[2], energy;
} Digits;

/* Of the midpoint rule on the pendulum, p = v: both precisions agree to 40 digits; energy: the largest |E - E0|, to 6 digits.
 * Tolerance as stated with the digits: 1e-11. */
static const Digits midpoint[] = {
    {{1.5, 0}, 0.1, 1000, {-0.5554837009712650754947232, 1.248327344720310737258077}, 0.000359406393757},
    {{0.5, 1.9}, 0.2, 500, {2.699866315986761219670719, -0.1897434875691169385021294}, 0.00540163363051},
};

static double worst_energy, first_energy;

static int watch(UNUSED void *context, const lag_sim *s)
{
  double e[2];
  lag_sim_scene(s)->model->energy(0, lag_sim_q(s), lag_sim_v(s), NULL, NULL, NULL, e, NULL);
  worst_energy = fmax(worst_energy, fabs(e[0] - first_energy));
  return 0;
}

static void the_midpoint_rule_reproduces_its_digits(void **state)
{
  (void)state;
  for (size_t k = 0; k < sizeof midpoint / sizeof *midpoint; k++) {
    const Digits *d = &midpoint[k];
    double e[2];
    lag_sim *s = equal_steps(&pendulum, &lag_variational, d->h);
    assert_int_equal(lag_sim_set(s, "x", d->start[0]), 0);
    assert_int_equal(lag_sim_set(s, "x'", d->start[1]), 0);
    pendulum_energy(0, d->start, d->start + 1, NULL, NULL, NULL, e, NULL);
    first_energy = e[0];
    worst_energy = 0;
    lag_sim_on_step(s, watch, NULL);
    assert_int_equal(lag_sim_advance(s, (d->steps - 0.5) * d->h), LAG_OK);
    assert_int_equal(lag_sim_advance(s, d->steps * d->h), LAG_OK);
    assert_close(distance(2, lag_sim_q(s), d->end), 0, 1e-11);
    assert_close(worst_energy / d->energy, 1, 1e-6);
    lag_sim_free(s);
  }
}

int main(void)
{
  const struct CMUnitTest tests[] = {
      cmocka_unit_test(the_midpoint_rule_reproduces_its_digits),
  };
  return cmocka_run_group_tests(tests, NULL, NULL);
}
