/* dump_syntax FILE: prints the Ast of a .lag file, or the messages when it has mistakes.
 * Exit status 0: parsed, 1: mistakes, 2: usage, or no memory. */
#include <stdio.h>

#include "syntax/parse.h"

static int dump(Arena *a, const char *path) {
  Sources *sources = sources_new(a);
  Diags *diags = diags_new(a, sources);
  Ast *ast = ast_new(a, interner_new(a), sources, diags);
  const char *error = NULL;
  const Source *source = source_read(sources, path, &error);
  if (!source) {
    fprintf(stderr, "dump_syntax: %s: %s\n", path, error);
    return 2;
  }
  StrBuf out = strbuf(a);
  int ok = parse(ast, source);
  if (ok) ast_dump(ast, &out);
  diags_print(diags, &out);
  fputs(sb_text(&out), stdout);
  return !ok;
}

int main(int argc, char **argv) {
  if (argc != 2) {
    fputs("usage: dump_syntax FILE\n", stderr);
    return 2;
  }
  Arena *a = arena_new(NULL);
  jmp_buf failed;
  if (!a || setjmp(failed)) {
    arena_free(a);
    fputs("dump_syntax: out of memory\n", stderr);
    return 2;
  }
  arena_guard(a, &failed);
  int status = dump(a, argv[1]);
  arena_free(a);
  return status;
}
