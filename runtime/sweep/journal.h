/* The journal of a sweep: its finished chunks of runs, in a file beside the output. Enters: rows of a chunk; leaves:
 * the same rows, in this or a later process. Holds: what was put a tenth of a second ago is there after kill -9; a
 * record that was cut is as if it were not there; a journal of another sweep is refused. */
#pragma once

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef struct Journal {
  int fd;
  char path[4096];
  long long chunks;   /* of the sweep */
  size_t size;        /* numbers of a whole chunk */
  long long *at;      /* [chunks] place of the chunk's record in the file, 0: not there */
  long long finished; /* chunks that are there */
  uint64_t signature; /* of the sweep */
  long long end;      /* length of the file, with what is not yet written */
  double *kept;       /* [chunks][size] the numbers, too; NULL: more than memory is taken for */
  FILE *f;            /* fd */
  double written, synced; /* clock at the last write, and at the last write to the disk [s] */
} Journal;

/* Opens the journal at path for the sweep that j has: chunks, size, signature. A new one, or with
 * resume 1 one that is there. 0, with why[nwhy] := "", or a note where a file to resume had no run;
 * or -1 with the reason. Free with lag_journal_close, also after an error. */
int lag_journal_open(Journal *j, const char *path, int resume, char *why, size_t nwhy);

/* Adds a chunk: row[n], which is written within a tenth of a second of work, or by lag_journal_flush. -1 with errno
 * set. Not for several threads at once. */
int lag_journal_put(Journal *j, long long chunk, const double *row, size_t n);
int lag_journal_flush(Journal *j);

/* row[n] := the first numbers of a chunk that is there: from memory, or where that is too much from the file. -1: it
 * cannot be read. */
int lag_journal_get(const Journal *j, long long chunk, double *row, size_t n);

/* remove 1: the file, too. */
void lag_journal_close(Journal *j, int remove);
