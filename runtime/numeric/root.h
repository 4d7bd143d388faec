/* Root of a function of one variable in a bracket. */
#pragma once

/* The root of f in [a, b] (a > b allowed), where f(a) and f(b) differ in sign. Returns the end of the last bracket on b's side, so the sign has
 * changed there. ITP method: I.F.D. Oliveira, R.H.C. Takahashi, ACM Trans. Math. Softw. 47 (2020) 5, DOI 10.1145/3423597. */
double lag_root(double (*f)(void *context, double x), void *context, double a, double fa, double b, double fb);
