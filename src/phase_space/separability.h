/* Separation of the Hamilton-Jacobi equation in the given coordinates.
 *
 * Pairs (q, p) come off one after the other: first cyclic coordinates, then each pair on which H depends through a
 * function G(q, p) free of those that are left. Those that remain together separate where Levi-Civita's conditions
 * hold for every two of them,
 *   H_pi H_pj H_qiqj + H_qi H_qj H_pipj - H_pi H_qj H_qipj - H_qi H_pj H_piqj = 0;
 * a pair that came off fulfils them with all others. T. Levi-Civita, Math. Ann. 59 (1904) 383, DOI
 * 10.1007/BF01445149. */
#pragma once

#include "phase_space/expression_brackets.h"

typedef enum {
  PAIR_TIED,   /* the conditions do not hold */
  PAIR_CYCLIC, /* p is constant */
  PAIR_ALONE,  /* has a curve G(q, p) = constant of its own */
  PAIR_STAECKEL /* p(q) on a separated solution, whatever the others are: H(q, p) = E at fixed others */
} PairKind;

typedef struct {
  uint32_t n;
  const uint32_t *order;  /* [n] the pairs as they come off */
  const PairKind *kind;   /* [n] by pair */
  const uint8_t *tangled; /* [n] by pair: pairs that come off later depend on its constant */
  int separates;
  int refuted;            /* the condition for i, j is proved to fail; 0: it is not decided */
  uint32_t i, j;          /* pairs whose condition does not hold; i = j: H contains q of the pair, and not p */
  /* [n] separated equations left = right, in the pair, `energy`, constant momenta and constants alpha_q; left 0:
   * none in closed form */
  const Expr *left, *right;
} Separation;

/* Needs s->H without definitions. */
Separation separation_of(const PhaseSpace *s);
