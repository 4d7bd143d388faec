/* The commands of lagc, one a file. Each returns an exit status; those that compile find the model in c->ast. */
#pragma once

#include "commands/compiler.h"

int command_check(Compiler *c);
int command_verify(Compiler *c);
int command_derive(Compiler *c);
int command_noether(Compiler *c);
int command_action(Compiler *c);
int command_emit(Compiler *c);
int command_header(Compiler *c);
int command_fmu(Compiler *c);
int command_page(Compiler *c);
int command_build(Compiler *c);
int command_run(Compiler *c); /* run, plot, animate, modes, lyapunov, cost */
int command_effects(Compiler *c);

/* Appends what `lagc check` says: facts, scenes (or the one named), effects that no scene uses, units found,
 * symmetries, expectations. Returns 0 when the model is wrong and nothing is worth printing; the reasons, and false
 * claims, are in c->diags. */
int check_print(Compiler *c, const char *scene, int allow_numeric, StrBuf *out);

/* Appends the symmetries of the scene's model; scene NULL: of the model without effects, and of
 * each effect alone. format: text, latex, json, or NULL; seconds: of the processor, for the search.
 * Returns 0, with the reasons in c->diags: a wrong model, a false symmetry, no Lagrangian. */
int noether_print(Compiler *c, const char *scene, double seconds, const char *format, StrBuf *out);

/* Topics of `lagc help`, each once, except functions, units and options. */
typedef VEC(Name) Topics;
void help_topics(Arena *a, Topics *out);

/* Appends a line for each model of the gallery whose name or title has the word (NULL: for each), and returns their
 * number. */
uint32_t models_list(Compiler *c, const char *word, StrBuf *out);

/* These read no model. */
int command_help(Compiler *c);
int command_methods(Compiler *c);
int command_completion(Compiler *c);
int command_manpage(Compiler *c);
int command_cache(Compiler *c);
int command_models(Compiler *c);
int command_new(Compiler *c);
int command_playground(Compiler *c);
