/* Output files that appear only when complete. This header and its source include nothing of the runtime, because
 * the compiler is built with a copy of both (Makefile). */
#pragma once

#include <stdio.h>

/* An open output file. Path "-" is standard output; devices, pipes, /dev/stdout and the like are written directly. */
typedef struct Outfile {
  FILE *f;
  char path[4096], part[4160]; /* final path, links resolved; temporary path, "" if written directly */
} Outfile;

/* Opens a temporary file PATH.part-N-M beside path, created exclusively: two runs with one path do not mix, and a
 * planted file or link is not followed. The file is locked; unlocked ones of this path are left from killed runs,
 * and are removed. An existing file at path must be writable and keeps its mode; a symbolic link is followed if the
 * user or root owns it. 0, or -1 with errno set. */
int lag_outfile_open(Outfile *o, const char *path);

/* KEEP renames the file to its path; SYNC does so once it is on the disk; DROP removes it. -1 with errno set:
 * writing failed, no file is left. */
enum { OUTFILE_DROP, OUTFILE_KEEP, OUTFILE_SYNC };
int lag_outfile_close(Outfile *o, int keep);

/* Whether the name ends in one of the suffixes, a list with spaces: "csv npy". */
int lag_outfile_has_suffix(const char *path, const char *suffixes);
/* The suffix of the name if it is a known file type that is not in suffixes, as "png" for "svg"; else NULL. */
const char *lag_outfile_other_type(const char *path, const char *suffixes);
/* Contents of files whose names end in one of these suffixes, a hint of options.def: "CSV, or NumPy where the name
 * ends in .npy". */
const char *lag_outfile_contents(const char *suffixes);
