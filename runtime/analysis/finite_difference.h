/* Derivatives by finite differences at the border of a domain: central ones, or one-sided ones where values on one side
 * do not exist, as of a parameter declared >= 0 at 0 (B. Fornberg, Math. Comp. 51 (1988) 699). */
#pragma once

/* out[n] := values at x. LAG_OK, or a status: there are none. */
typedef int ValuesAt(void *of, double x, double *out);

/* d[n *stride], every stride-th element, := derivatives at x in the unit h / part, by steps h; order 2 or 4;
 * out[n]: scratch. LAG_OK, or the status of the last attempt. */
typedef struct FiniteDifference {
  int order, n, stride;
  double h, part;
  double *out;
} FiniteDifference;
int lag_finite_difference(const FiniteDifference *f, ValuesAt *values, void *of, double x, double *d);
