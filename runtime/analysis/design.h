/* Designs of experiments: which measurements determine values best. */
#pragma once

/* chosen[n] := the n of rows of G[rows p] (derivatives of candidates by values, in units of their errors) whose
 * information, G^T G over them and prior[p] on its diagonal, has the largest determinant, each at most once, in order.
 * LAG_OK; LAG_EDOMAIN: no n of them determine all values; LAG_ENOMEM. */
int lag_design_choose(int rows, int p, const double *G, const double *prior, int n, int *chosen);

/* error[p] := standard errors by n of the rows, all where chosen is NULL. LAG_OK, LAG_EDOMAIN or LAG_ENOMEM. */
int lag_design_errors(int rows, int p, const double *G, const double *prior, int n, const int *chosen, double *error);
