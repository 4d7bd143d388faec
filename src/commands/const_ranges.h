/* Constants that `lagc sweep` varies, N=2,4,8: the scene is compiled once for each combination of their values, and
 * one program holds all. */
#pragma once

#include "commands/run_request.h"

/* Takes word number i of o->rest, a range of the constant called name, as numbers that the compiler and the
 * simulator share: 2..8:4 becomes 2,4,6,8. Defines the first value. Returns 0 on a mistake, which is in *error or
 * ast->diags. */
int const_range_take(Ast *ast, Options *o, uint32_t i, const char *name, const char **error);

/* Number of combinations; 1 where no constant varies. 0: more than are compiled, or with --zip not as many values of
 * each; *error. */
uint32_t const_range_variants(Arena *a, const Options *o, const char **error);

/* Gives the constants their values of combination number v: the last constant runs first; with --zip all run
 * together. Returns 0 on a mistake, which is in ast->diags. */
int const_range_define(Ast *ast, Options *o, uint32_t v);

/* Their names, with commas. */
const char *const_range_names(Arena *a, const Options *o);
