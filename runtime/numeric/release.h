/* Memory of several blocks, given back at once. */
#pragma once

#include <stdlib.h>

static inline void lag_free_list(size_t n, void *const *block) {
  for (size_t i = 0; i < n; i++) free(block[i]);
}

/* lag_free_all(a, b, c): blocks of malloc, or NULL. */
#define lag_free_all(...) lag_free_list(sizeof((void *[]){__VA_ARGS__}) / sizeof(void *), (void *[]){__VA_ARGS__})
