/* Functions that the stages call, but no answer of a playground needs: files, terminals, a command line; and what
 * the runtime of Debian's compiler for WebAssembly expects of a system. */
#include <stdint.h>
#include <stdlib.h>

#include "commands/compiler.h"
#include "fmu/fmu_archive.h"
#include "toolchain/files.h"
#include "toolchain/process.h"

int file_write(const char *path, const char *text, size_t n, const char **error) {
  (void)path, (void)text, (void)n;
  return fail_with(error, "a page has no files");
}
int file_same(const char *a, const char *b) { return (void)a, (void)b, 0; }
int stderr_is_terminal(void) { return 0; }
const char *options_passed(const Options *o, const char *name) { return (void)o, (void)name, NULL; }
int options_pass_flag(const Options *o, const char *name) { return (void)o, (void)name, 0; }
unsigned fmu_wants(void) { return 0; }

uintptr_t __stack_chk_guard = 0x595e9fbd;
_Noreturn void __stack_chk_fail(void) { abort(); }
