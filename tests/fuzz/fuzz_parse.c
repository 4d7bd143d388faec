/* Fuzzing the front end: any bytes are parsed as a file and as an expression, dumped, and the
 * messages printed. Nothing may crash, leak, or take more than its memory limit.
 *
 *   clang -g -O1 -fsanitize=fuzzer,address,undefined ... tests/fuzz/fuzz_parse.c LIBLAGC -o fuzz
 *   ./fuzz tests/fuzz/corpus/parse
 * With -DREPLAY it is a program that runs every file of the folders it is given. */
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "syntax/parse.h"

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { FUZZ_MEMORY = 256 * 1024 * 1024 };

/* What the parser promises to later passes. */
static void check_nodes(const Ast *ast) {
  for (AstId id = 1; id < ast->exprs.n; id++) {
    const AstExpr *e = ast_expr(ast, id);
    if (!e->first || e->first > id || e->a >= id || e->b >= id || e->c >= id || e->args >= id) abort();
    if (!e->span.begin || e->span.end < e->span.begin) abort();
    if (!source_place(ast->sources, e->span.begin).file) abort();
  }
}

static void run(Arena *a, const uint8_t *data, size_t size, int expression) {
  Sources *sources = sources_new(a);
  Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
  const Source *source = source_add(sources, "fuzz.lag", arena_strndup(a, (const char *)data, size), size);
  if (!source) return;
  int ok = expression ? parse_expression(ast, source) != 0 : parse(ast, source);
  if (ok != (ast->diags->errors == 0)) abort();
  StrBuf out = strbuf(a);
  if (size < 4096) check_nodes(ast);
  ast_dump(ast, &out);
  diags_print(ast->diags, &out);
}

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size) {
  static const char devices[] = "/dev"; /* including a terminal would wait for ever */
  for (size_t i = 0; i + 4 <= size; i++)
    if (memcmp(data + i, devices, 4) == 0) return 0;
  for (volatile int expression = 0; expression < 2; expression++) { /* volatile: setjmp below */
    ArenaConfig config = {.chunk = 4096, .max_bytes = FUZZ_MEMORY};
    Arena *a = arena_new(&config);
    jmp_buf failed;
    if (!a) return 0;
    if (!setjmp(failed)) {
      arena_guard(a, &failed);
      run(a, data, size, expression);
    }
    arena_free(a);
  }
  return 0;
}

#ifdef REPLAY
#include <dirent.h>

static int replay_file(const char *path) {
  FILE *f = fopen(path, "rb");
  if (!f) return 0;
  size_t cap = 1 << 22;
  uint8_t *data = malloc(cap);
  if (!data) abort();
  size_t n = fread(data, 1, cap, f);
  fclose(f);
  LLVMFuzzerTestOneInput(data, n);
  free(data);
  return 1;
}

int main(int argc, char **argv) {
  int files = 0;
  for (int i = 1; i < argc; i++) {
    DIR *dir = opendir(argv[i]);
    if (!dir) {
      fprintf(stderr, "fuzz_parse: cannot open the folder %s\n", argv[i]);
      return 2;
    }
    for (struct dirent *entry; (entry = readdir(dir));) {
      char path[4096];
      if (entry->d_name[0] == '.') continue;
      snprintf(path, sizeof path, "%s/%s", argv[i], entry->d_name);
      files += replay_file(path);
    }
    closedir(dir);
  }
  printf("fuzz_parse: %d files, no crash\n", files);
  return files == 0;
}
#endif
