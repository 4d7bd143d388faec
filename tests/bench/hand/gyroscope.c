/* The gyroscope in Euler angles by hand; p: I1, I3, mgl. */
#include <math.h>

#include "accel.h"

ACCEL(by_hand) {
  double I1 = p[0], I3 = p[1], s = sin(q[1]), c = cos(q[1]), spin = I3*(v[2] + v[0]*c);
  double f = v[1]*(spin - 2*I1*v[0]*c)/(I1*s);
  a[0] = f;
  a[1] = s*(v[0]*v[0]*c - (spin*v[0] - p[2])/I1);
  a[2] = v[0]*v[1]*s - f*c;
  ONLY_QVP;
  return I1*s*s > 0 ? 0 : -1;
}
