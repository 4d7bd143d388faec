/* Inputs given by the program around a model, the two ways to embed one: an emitted header, where the caller steps, and
 * liblag, which chooses steps itself. The model: a mass m = 2 kg, x'' = u/m, from rest; u is 1 N unless said otherwise.
 *   cc -DHEADER embed_inputs.c -lm                      with cart.h, made by `lagc header cart.lag -o cart.h`
 *   cc -DLIBLAG embed_inputs.c cart.c liblag.a -lm      with cart.c, made by `lagc emit cart.lag -o cart.c`
 * Exit status 0 when all is as the closed forms say. */
#include <math.h>
#include <stdio.h>
#include <string.h>

static int bad;
static void near(const char *what, double got, double want, double tolerance)
{
  if (!(fabs(got - want) <= tolerance)) {
    printf("%s: got %.17g, want %.17g, tolerance %g\n", what, got, want, tolerance);
    bad = 1;
  }
}

/* A push that grows: u = rate t, so x = rate t^3/(6 m). */
typedef struct Ramp {
  double rate;
} Ramp;

#ifdef HEADER
#define CART_IMPLEMENTATION
#include "cart.h"

/* As of a digital controller: u is computed once a step and held, here to bring x to 1 m. */
static void controller(void)
{
  cart_params p;
  cart_state s;
  cart_defaults(&p);
  cart_start(&p, &s);
  double x = 0, v = 0; /* the same motion: under a constant force, each step is a parabola */
  for (int i = 0; i < 2000; i++) {
    double u[CART_NU] = {0};
    u[CART_IN_U] = 4 * (1 - s.q[CART_X]) - 4 * s.v[CART_X];
    double a = (4 * (1 - x) - 4 * v) / 2, h = 0.01;
    x += h * v + h * h / 2 * a;
    v += h * a;
    if (cart_rk4_step(&p, &s, h, u) != CART_OK) {
      bad = 1;
    }
  }
  near("the controlled cart", s.q[CART_X], x, 1e-12);
  near("is where it should be", s.q[CART_X], 1, 1e-8); /* it comes closer as exp(-t), t = 20 */
}

static void ramp(void *context, double t, double *u)
{
  u[CART_IN_U] = ((const Ramp *)context)->rate * t;
}

/* Methods of order 4 and more are exact for a cubic, too. */
static void other_methods(Ramp *grows)
{
  cart_params p;
  cart_state s;
  cart_variational w;
  cart_adaptive a;
  double u[CART_NU], rate[CART_NQ];
  cart_defaults(&p);
  cart_start(&p, &s);
  ramp(grows, 0, u);
  bad |= cart_accel(0, s.q, s.v, &p, u, rate) != CART_OK;
  for (int i = 0; i < 8; i++) {
    bad |= cart_verlet4_step_with(&p, &s, 0.25, ramp, grows, rate) != CART_OK;
  }
  near("verlet4", s.q[CART_X], 3 * 8.0 / 12, 1e-14);
  near("it leaves the acceleration", rate[0], 3 * 2.0 / 2, 1e-14);
  cart_start(&p, &s);
  bad |= cart_variational_begin(&w, 4) != CART_OK;
  for (int i = 0; i < 8; i++) {
    bad |= cart_variational_step_with(&p, &s, &w, 0.25, ramp, grows) != CART_OK;
  }
  near("variational", s.q[CART_X], 3 * 8.0 / 12, 1e-14);
  cart_start(&p, &s);
  cart_adaptive_begin(&a, 1e-9);
  while (s.t < 2 && !bad) {
    bad |= cart_dop853_step_with(&p, &s, &a, 2, ramp, grows) != CART_OK;
  }
  near("dop853", s.q[CART_X], 3 * 8.0 / 12, 1e-14);
}

int main(void)
{
  cart_params p;
  cart_state s;
  Ramp grows = {3};

  controller();
  cart_defaults(&p);
  cart_start(&p, &s);
  for (int i = 0; i < 8; i++) {
    if (cart_rk4_step_with(&p, &s, 0.25, ramp, &grows) != CART_OK) {
      bad = 1;
    }
  }
  near("a function, inside the steps too", s.q[CART_X], 3 * 8.0 / 12, 1e-14); /* RK4 is exact for a cubic */
  other_methods(&grows);
  cart_start(&p, &s);
  for (int i = 0; i < 8; i++) {
    cart_rk4_step_with(&p, &s, 0.25, 0, 0);
  }
  near("none: the model's formula", s.q[CART_X], 1 * 4.0 / 4, 1e-14);
  cart_start(&p, &s);
  for (int i = 0; i < 8; i++) {
    cart_rk4_step(&p, &s, 0.25, 0);
  }
  near("and here", s.q[CART_X], 1 * 4.0 / 4, 1e-14);
  return bad;
}
#endif

#ifdef LIBLAG
#include "lag.h"

extern const lag_scene cart_push;

static double ramp(void *context, double t)
{
  return ((const Ramp *)context)->rate * t;
}

static double broken(void *context, double t)
{
  (void)context;
  return t > 1 ? NAN : 0;
}

int main(void)
{
  Ramp grows = {3};
  lag_sim *sim = lag_sim_new(&cart_push);

  if (!sim || lag_sim_set_input(sim, "u", ramp, &grows) || lag_sim_advance(sim, 2)) {
    printf("%s\n", sim ? lag_sim_message(sim) : "no memory");
    return 1;
  }
  near("a function", lag_sim_q(sim)[0], 3 * 8.0 / 12, 1e-9); /* the scene's tolerance */
  lag_sim_free(sim);

  sim = lag_sim_new(&cart_push);
  if (!sim || lag_sim_set_input(sim, "u", ramp, &grows) || lag_sim_set_input(sim, "u", NULL, NULL) ||
      lag_sim_advance(sim, 2)) {
    return 1;
  }
  near("taken back: the model's formula", lag_sim_q(sim)[0], 1 * 4.0 / 4, 1e-9);
  if (lag_sim_set_input(sim, "u", ramp, &grows) != LAG_EINVAL) {
    bad = 1; /* the run has begun */
  }
  lag_sim_free(sim);

  sim = lag_sim_new(&cart_push);
  if (!sim || lag_sim_set_input(sim, "x", ramp, &grows) != LAG_EINVAL ||
      lag_sim_set_input(sim, "uu", ramp, &grows) != LAG_EINVAL || !strstr(lag_sim_message(sim), "did you mean u?")) {
    printf("wrong names: %s\n", sim ? lag_sim_message(sim) : "no memory");
    bad = 1;
  }
  lag_sim_set_input(sim, "u", broken, NULL);
  if (lag_sim_advance(sim, 2) != LAG_ENAN || !strstr(lag_sim_message(sim), "function of an input")) {
    printf("a broken function: %s\n", lag_sim_message(sim));
    bad = 1;
  }
  near("stops where it breaks", lag_sim_time(sim), 1, 1e-6);
  lag_sim_free(sim);
  return bad;
}
#endif
