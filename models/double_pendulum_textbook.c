/* The double pendulum as in textbooks and on many pages of the web, for `lagc verify`: y = th1, th2, th1', th2'; p = m1, m2, l1, l2, g. */
#include <math.h>

void rhs(double t, const double *y, double *dydt, const double *p) {
  double m1 = p[0], m2 = p[1], l1 = p[2], l2 = p[3], g = p[4], th1 = y[0], th2 = y[1], w1 = y[2], w2 = y[3];
  double den = 2*m1 + m2 - m2*cos(2*th1 - 2*th2);
  dydt[0] = w1;
  dydt[1] = w2;
  dydt[2] = (-g*(2*m1 + m2)*sin(th1) - m2*g*sin(th1 - 2*th2) - 2*sin(th1 - th2)*m2*(w2*w2*l2 + w1*w1*l1*cos(th1 - th2)))/(l1*den);
  dydt[3] = 2*sin(th1 - th2)*(w1*w1*l1*(m1 + m2) + g*(m1 + m2)*cos(th1) + w2*w2*l2*m2*cos(th1 - th2))/(l2*den);
  (void)t;
}
