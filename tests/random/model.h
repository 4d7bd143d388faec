/* Random models, for tests that compare two ways to compute the same. The text of a model depends on its seed and
 * number only: integer arithmetic, the same on every machine. */
#ifndef RANDOM_MODEL_H
#define RANDOM_MODEL_H

#include <stdint.h>

/* The text of model `number` of a seed; the caller frees it. NULL without memory. */
char *random_model(uint64_t seed, uint64_t number);

#endif
