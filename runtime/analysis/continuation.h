/* Branches of solutions over a parameter, by pseudo-arclength continuation: predictor along the tangent, Newton's
 * steps across it (H. B. Keller, in: Applications of Bifurcation Theory (1977) 359; E. Doedel, H. B. Keller, J. P.
 * Kernevez, Int. J. Bifurcation Chaos 1 (1991) 493, DOI 10.1142/S0218127491000397). Enters: a solution and the
 * equations about it; leaves: points along its branch, with folds and bifurcations located. */
#pragma once

#include "analysis/branch.h"

typedef struct BranchLimits {
  double low, high;     /* range of the parameter, in units */
  double step, longest; /* the first step, and the longest */
  int most;             /* points */
} BranchLimits;

/* Follows the branch from u0[cols], a solution up to Newton's steps, in direction d[cols], or with sign 1 in that of
 * the branch that is nearest to it (NULL: with the last unknown growing, sign 1, or falling, -1), until it leaves the
 * range. Free in any case. LAG_OK, or a status: u0 is no solution (LAG_EDOMAIN), or solutions beside it form a family
 * (LAG_ESINGULAR). */
int lag_branch_follow(Branch *b, const BranchProblem *p, const double *u0, const double *d, int sign,
                      const BranchLimits *limits);
void lag_branch_free(Branch *b);
/* d[cols] := the direction of another branch that crosses this one at a branch point. LAG_OK, or a status. */
int lag_branch_other(const BranchProblem *p, const BranchPoint *at, double *d);
