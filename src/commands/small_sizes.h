/* Commands that print or emit the text of a large model as made from four small ones.
 *
 * Where a text says the same for every size N of its families (model/family_size.h), what a command writes for N is
 * what it writes for a smaller size n, but for whole numbers that are polynomials of degree 2 at most in n. They follow
 * from three sizes n with the remainder of N by FAMILY_STEP; the fourth shows that they are such polynomials. Each of
 * the small models is derived and compared with the text as any other. So neither time nor memory depends on N. */
#pragma once

#include "commands/compiler.h"

/* Runs the command for small sizes and writes its text for the one asked for, with the messages. Returns 0, and writes
 * nothing, where the command or the text is none of those, or the numbers do not follow: then it is run as it is. */
int small_sizes_run(Compiler *c, int (*command)(Compiler *c), int *status);
