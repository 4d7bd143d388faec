/* Least squares of a straight line through n points. */
#pragma once

/* The means, and sums about them: the slope is xy / xx, and yy - xy^2 / xx is left of the squares. */
typedef struct LineFit {
  double mx, my, xx, xy, yy;
} LineFit;

static inline LineFit lag_line_fit(int n, const double *x, const double *y) {
  LineFit f = {0};
  for (int i = 0; i < n; i++) {
    f.mx += x[i] / n;
    f.my += y[i] / n;
  }
  for (int i = 0; i < n; i++) {
    f.xx += (x[i] - f.mx) * (x[i] - f.mx);
    f.xy += (x[i] - f.mx) * (y[i] - f.my);
    f.yy += (y[i] - f.my) * (y[i] - f.my);
  }
  return f;
}
