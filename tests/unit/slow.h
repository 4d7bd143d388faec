/* Which sizes and counts a unit test takes. */
#ifndef TESTS_UNIT_SLOW_H
#define TESTS_UNIT_SLOW_H
#include <stdlib.h>
#include <string.h>

/* In `make test-long` and `make test-all` the first, in `make test` the second. */
static inline int slow(int in_test_long, int in_test) { return getenv("SLOW") ? in_test_long : in_test; }

/* Whether this is `make test-all`, which leaves out no row. */
static inline int all_rows(void) {
  const char *rows = getenv("ROWS");
  return getenv("SLOW") && (!rows || rows[0] == 'a');
}

/* A count, or the step through a table, in `make test`, `make test-long`, `make test-all`. */
static inline int depth(int few, int some, int all) { return all_rows() ? all : slow(some, few); }

/* The first of the rows that are taken in steps, another one each DAY (tests/run.sh). */
static inline size_t first_row(size_t step) {
  const char *day = getenv("DAY");
  return day ? strtoul(day, NULL, 10) % step : 0;
}

/* `light` of tests/tap.sh: all but the bicycle, which takes as long as twenty other models; in `make test-long` on one
 * day in four all. */
static inline int light(const char *path) {
  return !strstr(path, "bicycle") || slow(all_rows() || first_row(4) == 0, 0);
}

#endif
