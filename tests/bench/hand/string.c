/* N masses on N + 1 springs k s + b s^3 between two walls, by hand; p: m, k, b. */
#include "accel.h"

#ifndef N
#define N 10000
#endif

/* One pass, each spring once. */
ACCEL(loop) {
  double k = p[1], b = p[2], inv = 1/p[0], before = k*q[0] + b*q[0]*q[0]*q[0];
  for (int i = 0; i < N; i++) {
    double s = (i + 1 < N ? q[i + 1] : 0) - q[i], force = k*s + b*s*s*s;
    a[i] = (force - before)*inv;
    before = force;
  }
  ONLY_QVP;
  return 0;
}

/* Each spring twice: nothing is carried from turn to turn, so compilers vectorise it. */
ACCEL(twice) {
  double k = p[1], b = p[2], inv = 1/p[0], s, r;
  for (int i = 1; i < N - 1; i++) {
    double right = q[i + 1] - q[i], left = q[i] - q[i - 1];
    a[i] = (k*right + b*right*right*right - k*left - b*left*left*left)*inv;
  }
  r = q[1] - q[0], s = q[0];
  a[0] = (k*r + b*r*r*r - k*s - b*s*s*s)*inv;
  r = -q[N - 1], s = q[N - 1] - q[N - 2];
  a[N - 1] = (k*r + b*r*r*r - k*s - b*s*s*s)*inv;
  ONLY_QVP;
  return 0;
}
