/* In the place of a C compiler on Windows: copies the program named by WINDOWS_CC_MADE to the file behind -o; `-dM
 * -E` prints nothing. */
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int main(int argc, char **argv) {
  static char block[1 << 16];
  const char *to = NULL;
  for (int i = 1; i + 1 < argc; i++)
    if (strcmp(argv[i], "-o") == 0) to = argv[i + 1];
  if (!to) return 0;
  FILE *from = fopen(getenv("WINDOWS_CC_MADE"), "rb"), *f = fopen(to, "wb");
  if (!from || !f) return printf("no file to copy\n"), 1;
  for (size_t n; (n = fread(block, 1, sizeof block, from)) > 0;) fwrite(block, 1, n, f);
  return fclose(f) != 0;
}
