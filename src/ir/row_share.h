/* Nests whose rows several threads compute: which of them give the same bits whatever the number of threads. */
#pragma once

#include "ir/prog.h"
#include "ir/program_set.h"

typedef enum {
  SHARE_NONE,
  SHARE_TILES, /* tiles of rows and turns, one after those above it and before it */
  SHARE_LISTS, /* members of a list of neighbours, whose sums one thread adds up */
  SHARE_TREE   /* groups of bodies of a tree */
} RowShare;

/* listed: neighbours are found by lists, far bodies taken together by trees, as in models; not in headers. times: see
 * ProgramSet. */
RowShare nest_row_share(const Nest *n, int listed, double times);

/* Whether two indices, positions in n->at, never meet: their ranges are apart, or one lies between the
 * steps of the other. */
int nest_never_meet(const Nest *n, uint32_t i, uint32_t k);

/* Whether some nest of the programs is shared. */
int unit_shares(const ProgramSet *u, int listed);
