/* Models that are evaluated, not compiled: a lag_program from the bytes that lagc writes. */
#ifndef EVALUATOR_EVALUATOR_H
#define EVALUATOR_EVALUATOR_H

#include <stddef.h>

#include "lag_model.h"

/* The program of bytes[n], checked throughout; they may go afterwards. NULL with *why: they are cut short, damaged, or
 * of another version. Several threads may use it at once. */
const lag_program *lag_program_read(const void *bytes, size_t n, const char **why);
/* From now on the evaluated program calls the functions of the same program, compiled: between two steps, as work space
 * then holds nothing. Returns whether it is the same, and has room. */
int lag_program_change_over(const lag_program *evaluated, const lag_program *compiled);
void lag_program_free(const lag_program *program);

#endif
