/* The pendulum in floats on a Cortex-M4, without a library's start-up code, as a process of Linux that qemu-arm
 * runs: accelerations and energy against closed forms, and a swing of small amplitude against a cosine. Exit status:
 * number of the check that failed, or 0. */
#define PENDULUM_REAL float
#define PENDULUM_STATIC
#include "pendulum.h"

static void leave(int status) {
  register int call __asm__("r7") = 1, first __asm__("r0") = status;
  __asm__ volatile("svc 0" : : "r"(call), "r"(first));
}

static int differs(float a, float b, float tolerance) { return !(a - b <= tolerance && b - a <= tolerance); }

void _start(void) {
  pendulum_params p;
  pendulum_state s;
  float a[1], e[2];
  pendulum_defaults(&p);
  pendulum_start(&p, &s);
  s.q[0] = 0.7f, s.v[0] = 0.4f;
  /* -9.81 sin(0.7) */
  if (pendulum_accel(s.t, s.q, s.v, &p, a) != PENDULUM_OK || differs(a[0], -6.31977551f, 2e-6f)) leave(1);
  pendulum_energy(s.t, s.q, s.v, &p, e);
  if (differs(e[0], 2.38689814f, 4e-6f)) leave(2); /* 9.81 (1 - cos(0.7)) + 0.4^2/2 */
  s.q[0] = 0.01f, s.v[0] = 0.0f, s.t = 0.0f;
  for (int i = 0; i < 100; i++)
    if (pendulum_rk4_step(&p, &s, 0.01f) != PENDULUM_OK) leave(3);
  if (differs(s.q[0], -0.00999954683f, 2e-7f)) leave(4); /* 0.01 cos(sqrt(9.81) t (1 - 0.01^2/16)) at t = 1 */
  leave(0);
}
