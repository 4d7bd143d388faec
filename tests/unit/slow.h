/* Which sizes and counts a unit test takes. */
#ifndef TESTS_UNIT_SLOW_H
#define TESTS_UNIT_SLOW_H
#include <stdlib.h>

/* In `make test-long`, which runs suites with this call once more, the first; in `make test` the second. */
static inline int slow(int in_test_long, int in_test) { return getenv("SLOW") ? in_test_long : in_test; }

#endif
