/* The WebAssembly module of playgrounds: the stages of lagc on one text in memory. Enters: a command's name and a
 * text; leaves: one JSON text. An instance gives one answer, and is thrown away with its memory. */
#include <stdlib.h>
#include <string.h>

#include "commands/check_json.h"
#include "commands/commands.h"
#include "commands/page_model.h"
#include "commands/page_parts.h"
#include "model/model.h"
#include "report/equation_listing.h"

enum { MEMORY_LIMIT_MIB = 512 };

/* Ends the module's work by an exception of the script: memory ran out. */
__attribute__((import_module("playground"), import_name("fail"))) _Noreturn void playground_fail(void);
_Noreturn void longjmp(jmp_buf here, int value) {
  (void)here, (void)value;
  playground_fail();
}

/* The model of a page with its bytes as they are; `first`: of its first scene, and whether that is all. */
static void put_model(Compiler *c, int first, StrBuf *out) {
  PageModel d = page_model_begin(c->arena);
  if (!page_model_programs(c, &d, first)) return;
  page_model_end(c, &d, "null");
  sb_putn(out, d.json.at, d.json.n);
  sb_puts(out, ", \"raw\": \"");
  page_bytes(out, d.bytes.at, d.bytes.n);
  sb_printf(out, "\", \"whole\": %s}", d.whole ? "true" : "false");
}

/* The words of a command on the model, besides messages. */
static void put_answer(Compiler *c, int first, StrBuf *out) {
  Eqns *e;
  switch (c->o.command) {
    case CMD_CHECK: check_print(c, NULL, 0, out); break;
    case CMD_DERIVE: (e = compiler_derive_scene(c, NULL)) ? show_equations(e, NULL, PRINT_LATEX, out) : (void)0; break;
    case CMD_NOETHER: noether_print(c, NULL, 2, NULL, out); break;
    case CMD_PAGE: put_model(c, first, out); break;
    default: break;
  }
}

/* {"check": as `lagc check --json`, "text": what the command prints}; free it with the module. command: check,
 * derive (as LaTeX), noether, page (the JSON of `lagc page`), or picture (the same of the first scene alone). */
const char *playground_answer(const char *command, const char *text) {
  ArenaConfig config = {.max_bytes = (size_t)MEMORY_LIMIT_MIB << 20};
  Compiler c = {.arena = arena_new(&config), .argv0 = "lagc", .o = {.file = "model.lag", .json = 1}};
  jmp_buf out_of_memory;
  if (!c.arena) playground_fail();
  arena_guard(c.arena, &out_of_memory);
  int first = strcmp(command, "picture") == 0;
  c.o.command = command_named(first ? "page" : command);
  compiler_begin(&c);
  c.sources->library = "lib"; /* library_files.c */
  StrBuf said = strbuf(c.arena), out = strbuf(c.arena);
  if (!source_add(c.sources, c.o.file, text, strlen(text))) playground_fail();
  c.sources->files.at[0].is_file = 1;
  if (compiler_parse(&c) == STATUS_OK) put_answer(&c, first, &said);
  if (c.o.command == CMD_CHECK) check_json_report(&c, &said);
  if (!c.diags->errors) model_warn_unused(c.ast);
  sb_puts(&out, "{\"check\": ");
  check_json_put(&c, &out);
  sb_puts(&out, ", \"text\": ");
  sb_json(&out, c.diags->errors ? "" : sb_text(&said));
  sb_puts(&out, "}");
  return sb_text(&out);
}
