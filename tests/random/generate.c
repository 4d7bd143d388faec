/* generate SEED FROM [TO [FOLDER]]: models FROM .. TO of a seed, on standard output, or each in FOLDER/rNUMBER.lag. */
#include <stdio.h>
#include <stdlib.h>

#include "model.h"

static int write_model(const char *folder, uint64_t number, const char *text) {
  char path[4096];
  snprintf(path, sizeof path, "%s/r%llu.lag", folder, (unsigned long long)number);
  FILE *f = fopen(path, "w");
  if (!f) return 0;
  int ok = fputs(text, f) >= 0;
  return fclose(f) == 0 && ok;
}

int main(int argc, char **argv) {
  if (argc < 3) return fprintf(stderr, "usage: generate SEED FROM [TO [FOLDER]]\n"), 2;
  uint64_t seed = strtoull(argv[1], NULL, 10), from = strtoull(argv[2], NULL, 10),
           to = argc > 3 ? strtoull(argv[3], NULL, 10) : from;
  for (uint64_t number = from; number <= to; number++) {
    char *text = random_model(seed, number);
    int ok = text && (argc > 4 ? write_model(argv[4], number, text) : fputs(text, stdout) >= 0);
    free(text);
    if (!ok) return perror("generate"), 1;
  }
  return 0;
}
