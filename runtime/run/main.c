/* lag-run: a simulator of any model, which it evaluates. Enters: the bytes that lagc wrote, at the path
 * $LAG_PROGRAM, and the command line of a simulator. */
#include <stdio.h>
#include <stdlib.h>

#include "evaluator/evaluator.h"
#include "lag.h"

enum { FAILED = 2 };

/* The bytes of a file, *n of them; NULL: it cannot be read. */
static void *read_file(const char *path, size_t *n) {
  FILE *f = fopen(path, "rb");
  size_t room = 1 << 16, part = 1;
  char *bytes = f ? malloc(room) : NULL;
  for (*n = 0; bytes && part > 0; *n += part) {
    char *bigger = *n == room ? realloc(bytes, room *= 2) : bytes;
    if (!bigger) free(bytes);
    bytes = bigger;
    part = bytes ? fread(bytes + *n, 1, room - *n, f) : 0;
  }
  if (f) fclose(f);
  return bytes;
}

int main(int argc, char **argv) {
  const char *path = getenv("LAG_PROGRAM"), *why = "LAG_PROGRAM names no program; `lagc run --compile never` runs this";
  size_t n = 0;
  void *bytes = path ? read_file(path, &n) : NULL;
  if (path) why = "it cannot be read";
  const lag_program *program = bytes ? lag_program_read(bytes, n, &why) : NULL;
  free(bytes);
  if (!program) {
    fprintf(stderr, "lag-run: %s%s%s\n", path ? path : "", path ? ": " : "", why);
    return FAILED;
  }
#ifdef LAG_WITH_GSL
  int status = lag_app_main(argc, argv, program, &lag_gsl);
#else
  int status = lag_app_main(argc, argv, program, NULL);
#endif
  lag_program_free(program);
  return status;
}
