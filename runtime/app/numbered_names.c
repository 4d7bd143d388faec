/* Names of the members of families, which emitted programs write when they begin. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "app/app.h"

void lag_app_names(lag_var *table, int first, int groups, const lag_var *pattern, int size) {
  enum { MOST_DIGITS = 10 };
  size_t room = 0;
  for (int k = 0; k < size; k++) room += strlen(pattern[k].name) + MOST_DIGITS;
  char *name = malloc(room * (size_t)groups), *end = name + room * (size_t)groups;
  if (!name) {
    fputs("out of memory for the names of variables\n", stderr);
    exit(EXIT_USAGE);
  }
  for (int g = 0; g < groups; g++)
    for (int k = 0; k < size; k++) {
      lag_var *v = &table[g * size + k];
      const char *text = pattern[k].name, *number = strchr(text, '\1');
      *v = pattern[k];
      v->name = name;
      name += 1 + snprintf(name, (size_t)(end - name), "%.*s%d%s", (int)(number - text), text, first + g, number + 1);
    }
}
