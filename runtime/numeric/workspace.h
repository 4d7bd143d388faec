/* Work space: one block, cut into parts. */
#ifndef LAG_NUMERIC_WORKSPACE_H
#define LAG_NUMERIC_WORKSPACE_H

#include <stddef.h>

/* A block of zeros with `n` parts of these sizes, whose places go to `parts`. Give it to free(). NULL: no memory.
 * Under the address sanitizer a gap that must not be touched follows each part. */
double *lag_workspace(size_t n, double **const parts[], const size_t sizes[]);

#endif
