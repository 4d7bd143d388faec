/* The parser's own stack is the only memory outside the arena: every allocation of it fails once,
 * and nothing may leak. The generated parser is compiled into this test with an allocator that
 * counts; the linker then leaves the library's copy out. */
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

static long left, alive; /* allocations until one fails; blocks not freed yet */

static void *counting_malloc(size_t n) {
  if (left-- == 0) return NULL;
  void *p = malloc(n);
  alive += p != NULL;
  return p;
}

static void counting_free(void *p) {
  alive -= p != NULL;
  free(p);
}

#define YYMALLOC counting_malloc
#define YYFREE counting_free
#pragma GCC diagnostic push
#pragma GCC diagnostic ignored "-Wconversion"
#pragma GCC diagnostic ignored "-Wsign-conversion"
#pragma GCC diagnostic ignored "-Wshadow"
#include "lag.tab.c"
#include "syntax/parse.h"
#pragma GCC diagnostic pop

/* 1 when the text was read to its end, 0 when memory ran out. */
static int parse_with(const char *lag, size_t len, long budget) {
  left = budget;
  Arena *volatile a = arena_new(NULL);
  volatile int done = 0;
  jmp_buf failed;
  if (!setjmp(failed)) {
    arena_guard(a, &failed);
    Sources *sources = sources_new(a);
    Ast *ast = ast_new(a, interner_new(a), sources, diags_new(a, sources));
    assert_true(parse(ast, source_add(sources, "test.lag", lag, len)));
    done = 1;
  }
  arena_free(a);
  assert_int_equal(alive, 0);
  return done;
}

static void test_stack_memory(void **state) {
  (void)state;
  enum { DEEP = 20000 };
  static char lag[2 * DEEP + 16];
  memcpy(lag, "let a = ", 8);
  memset(lag + 8, '(', DEEP);
  lag[8 + DEEP] = 'x';
  memset(lag + 9 + DEEP, ')', DEEP);
  long n = 0;
  while (!parse_with(lag, 2 * DEEP + 9, n)) n++;
  assert_true(n > 5);
}

int main(void) {
  const struct CMUnitTest tests[] = {cmocka_unit_test(test_stack_memory)};
  return cmocka_run_group_tests(tests, NULL, NULL);
}
