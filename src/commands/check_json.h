/* `lagc check --json`: all messages with their spans, facts, scenes and verdicts as one JSON object, schema
 * lagc-check-1 (grammar/LANGUAGE.md, the command line). */
#pragma once

#include "claims/expect.h"
#include "commands/compiler.h"

/* Members of the object, each appended to c->json. lines: what `lagc check` says of the model first. */
void check_json_facts(Compiler *c, const Eqns *e);
void check_json_scene(Compiler *c, const char *kind, Name name, const Model *m, int ok);
void check_json_symmetries(Compiler *c, const Eqns *e, Name effect);
void check_json_expects(Compiler *c, const ExpectResults *all);
void check_json_units(Compiler *c, const FoundUnit *at, uint32_t n);

/* All that `lagc check` says, line by line. */
void check_json_report(Compiler *c, const StrBuf *lines);

/* Appends the object, with the messages recorded so far; prints it. */
void check_json_put(Compiler *c, StrBuf *out);
int check_json_print(Compiler *c);
