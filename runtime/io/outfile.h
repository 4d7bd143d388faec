/* A file that appears only when it is complete. This header and its source include nothing of the runtime's: the compiler is built with a copy of
 * both (Makefile). */
#ifndef LAG_IO_OUTFILE_H
#define LAG_IO_OUTFILE_H

#include <stdio.h>

/* A file in the making. path "-" is standard output; devices, pipes, /dev/stdout and the like are written directly. */
typedef struct Outfile {
  FILE *f;
  char path[4096], part[4160]; /* path: where links lead; part "": direct */
} Outfile;

/* Opens a temporary file beside path, PATH.part-N-M, made for this run alone: two runs with one path do not mix, and a file or a link
 * planted there is not followed. It is locked: what lies there unlocked is left from a run that was killed, and is removed. An existing file keeps
 * its mode, and must be writable; a symbolic link is followed where it is the user's own or root's. 0, or -1 with errno set. */
int outfile_open(Outfile *o, const char *path);

/* KEEP: the file gets its name; SYNC: once it is on the disk; DROP: it is removed. -1 with errno set: it could not be written; nothing is left. */
enum { OUTFILE_DROP, OUTFILE_KEEP, OUTFILE_SYNC };
int outfile_close(Outfile *o, int keep);

/* Whether the name ends in one of the suffixes, which are written with spaces between them: "csv npy". */
int outfile_is(const char *path, const char *suffixes);
/* The suffix that says another kind of file than these are, as .png of a picture: NULL where the name says none, or one that nobody knows. */
const char *outfile_other_kind(const char *path, const char *suffixes);

#endif
