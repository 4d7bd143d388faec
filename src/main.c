/* lagc: reads the command line, compiles, and exits.
 *
 *   text --parse--> Ast --model_build--> Model --equations_of--> Eqns --unit_new--> ProgramSet --emit--> C
 *        compiler_parse    compiler_derive                       compiler_lower_scene
 *
 * These stages stand in commands/compiler.c; what a command does with them, in commands/NAME.c.
 * Exit status: 0 ok, 1 bad model, 2 usage or files, 3 the run failed (a simulator's status). */
#include <stdio.h>

#include "base/posix.h" /* generated: a copy of runtime/io/posix.h */
#include "commands/check_json.h"
#include "commands/commands.h"
#include "commands/known_run.h"
#include "commands/small_sizes.h"
#include "toolchain/gallery.h"

enum { MEMORY_LIMIT_MIB = 2048 };

static int print_version(void) {
  puts("lagc " LAGC_VERSION);
  return fflush(stdout) == 0 ? STATUS_OK : usage_error("cannot write standard output");
}

static int do_command(Compiler *c) {
  switch (c->o.command) {
    case CMD_CHECK: return command_check(c);
    case CMD_VERIFY: return command_verify(c);
    case CMD_DERIVE: return command_derive(c);
    case CMD_NOETHER: return command_noether(c);
    case CMD_ACTION: return command_action(c);
    case CMD_EMIT: return command_emit(c);
    case CMD_HEADER: return command_header(c);
    case CMD_FMU: return command_fmu(c);
    case CMD_PAGE: return command_page(c);
    case CMD_PLAYGROUND: return command_playground(c);
    case CMD_BUILD: return command_build(c);
    case CMD_RUN:
    case CMD_PLOT:
    case CMD_ANIMATE:
    case CMD_MODES:
    case CMD_LINEARIZE:
    case CMD_ORBIT:
    case CMD_CONTINUE:
    case CMD_LYAPUNOV:
    case CMD_FIT:
    case CMD_DESIGN:
    case CMD_COST:
    case CMD_SWEEP: return command_run(c);
    case CMD_EFFECTS: return command_effects(c);
    case CMD_HELP: return command_help(c);
    case CMD_COMPLETION: case CMD_COMPLETE: return command_completion(c);
    case CMD_MANPAGE: return command_manpage(c);
    case CMD_METHODS: return command_methods(c);
    case CMD_CACHE: return command_cache(c);
    case CMD_MODELS: return command_models(c);
    case CMD_NEW: return command_new(c);
    case CMD_VERSION: return print_version();
    case CMD_NONE: case CMD_COUNT: break;
  }
  return STATUS_USAGE;
}

/* Refuses --fix with more digits than a double has: fixed parameters are folded as doubles. */
static int folds_digits(const Compiler *c) {
  if (!c->o.fix || !options_more_digits(&c->o)) return 1;
  usage_error("--fix makes doubles of parameters: leave it out where --precision has more digits");
  return 0;
}

static int compile(Compiler *c) {
  compiler_begin(c);
  c->sources->library = gallery_library(c->arena, c->argv0);
  int known = 0, status = compiler_open(c);
  if (status == STATUS_OK) status = known_run_start(c, &known);
  if (known) return status;
  if (status == STATUS_OK) status = compiler_parse(c);
  if (status == STATUS_OK && small_sizes_run(c, do_command, &status)) return status;
  if (status == STATUS_OK) status = folds_digits(c) ? do_command(c) : STATUS_USAGE;
  compiler_print_messages(c);
  if (c->o.command == CMD_CHECK && c->o.json && status != STATUS_USAGE && check_json_print(c) != STATUS_OK)
    status = STATUS_USAGE;
  return c->diags->errors && status == STATUS_OK ? STATUS_MODEL : status;
}

/* The messages of a compilation that memory does not suffice for: notes of sums that are written out say why. The
 * model's text may lie in an arena that is freed by now, so names that nothing uses are not looked for. */
static void print_last_messages(Compiler *c) {
  enum { ROOM = 16 << 20 };
  jmp_buf again;
  if (!c->diags || (c->o.command == CMD_CHECK && c->o.json)) return;
  arena_raise_limit(c->arena, ROOM);
  arena_guard(c->arena, &again);
  if (setjmp(again)) return;
  StrBuf messages = strbuf(c->arena);
  diags_print(c->diags, &messages);
  fputs(sb_text(&messages), stderr);
}

static int run_lagc(Compiler *c, int argc, char **argv) {
  const char *error;
  c->argv0 = argv[0];
  c->words = argv;
  if (!options_read(c->arena, argc, argv, &c->o, &error)) return usage_error(error);
  return command_reads_model(c->o.command) ? compile(c) : do_command(c);
}

int main(int argc, char **argv) {
  ArenaConfig config = {.max_bytes = (size_t)MEMORY_LIMIT_MIB << 20};
  Compiler c = {.arena = arena_new(&config)};
  jmp_buf out_of_memory;
  int status;
  lag_prepare_streams();
  lag_keep_memory(); /* of scratch arenas */
  if (!c.arena) return usage_error("out of memory");
  if (setjmp(out_of_memory)) {
    print_last_messages(&c);
    if (arena_hit_limit(c.arena))
      fprintf(stderr, "lagc: the model needs more than the limit of %d MiB of memory\n", MEMORY_LIMIT_MIB);
    else fprintf(stderr, "lagc: out of memory\n");
    status = STATUS_USAGE;
  } else {
    arena_guard(c.arena, &out_of_memory);
    status = run_lagc(&c, argc, argv);
  }
  arena_free(c.arena);
  return status;
}
