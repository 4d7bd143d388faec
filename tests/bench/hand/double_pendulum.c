/* The double pendulum by hand; p: m1, m2, l1, l2, g. */
#include <math.h>

#include "accel.h"

/* As in textbooks and on many pages of the web: Cramer's rule on the two equations of motion, written out as one
 * fraction each. */
ACCEL(textbook) {
  double m1 = p[0], m2 = p[1], l1 = p[2], l2 = p[3], g = p[4], th1 = q[0], th2 = q[1], w1 = v[0], w2 = v[1];
  a[0] = (-g*(2*m1 + m2)*sin(th1) - m2*g*sin(th1 - 2*th2) - 2*sin(th1 - th2)*m2*(w2*w2*l2 + w1*w1*l1*cos(th1 - th2))) /
         (l1*(2*m1 + m2 - m2*cos(2*th1 - 2*th2)));
  a[1] = (2*sin(th1 - th2)*(w1*w1*l1*(m1 + m2) + g*(m1 + m2)*cos(th1) + w2*w2*l2*m2*cos(th1 - th2))) /
         (l2*(2*m1 + m2 - m2*cos(2*th1 - 2*th2)));
  ONLY_QVP;
  return 0;
}

/* The best that we know: one sine and cosine an angle, their differences from products, one division, and the
 * parameters combined as far as they go. */
ACCEL(best) {
  double m1 = p[0], m2 = p[1], l1 = p[2], l2 = p[3], g = p[4];
  double s1 = sin(q[0]), c1 = cos(q[0]), s2 = sin(q[1]), c2 = cos(q[1]);
  double c = c1*c2 + s1*s2, s = s1*c2 - c1*s2, mu = m1/m2, M = 1 + mu;
  double A = l1*M, F1 = -s*l2*v[1]*v[1] - M*g*s1, F2 = s*l1*v[0]*v[0] - g*s2;
  double D = A - l1*c*c, inv = 1/(D*l2);
  a[0] = (F1 - c*F2)*(l2*inv);
  a[1] = (A*F2 - l1*c*F1)*inv;
  ONLY_QVP;
  return D > 0 ? 0 : -1;
}
