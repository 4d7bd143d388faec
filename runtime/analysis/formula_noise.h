/* Digits that the formulas of a model have left along a motion: cancellation, as of 1 - cos(x) near 0, is the same
 * in each run. */
#pragma once

#include "analysis/work_precision.h"

typedef struct FormulaNoise {
  int of;      /* component of the state whose rate has lost most; -1: none is known */
  double part; /* mean rounding of the rate, relative to the largest rate of its kind */
} FormulaNoise;

/* LAG_OK or LAG_ENOMEM. sim: of the scene; its state stays. Models with switches or contacts are not looked at. */
int lag_formula_noise(lag_sim *sim, const Samples *motion, FormulaNoise *worst);
