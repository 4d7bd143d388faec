/* Least squares of a straight line through n points. */
#pragma once

/* Sums about the means: the slope is xy / xx, and yy - xy^2 / xx is left of the squares. */
typedef struct LineFit {
  double xx, xy, yy;
} LineFit;

static inline LineFit lag_line_fit(int n, const double *x, const double *y) {
  LineFit f = {0};
  double mx = 0, my = 0;
  for (int i = 0; i < n; i++) {
    mx += x[i] / n;
    my += y[i] / n;
  }
  for (int i = 0; i < n; i++) {
    f.xx += (x[i] - mx) * (x[i] - mx);
    f.xy += (x[i] - mx) * (y[i] - my);
    f.yy += (y[i] - my) * (y[i] - my);
  }
  return f;
}
