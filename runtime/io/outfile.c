/* A file that appears only when it is complete. Enters: a path; leaves: the file, or nothing. Holds: an
 * existing file keeps its contents until the new one is complete; devices and pipes are written directly. */
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#include "io/io.h"

int outfile_open(Outfile *o, const char *path)
{
  struct stat st;

  memset(o, 0, sizeof *o);
  if (strlen(path) >= sizeof o->path) {
    errno = ENAMETOOLONG;
    return -1;
  }
  strcpy(o->path, path);
  if (strcmp(path, "-") == 0) {
    o->f = stdout;
    return 0;
  }
  if (stat(path, &st) == 0 && !S_ISREG(st.st_mode)) {
    o->f = fopen(path, "wb");
  } else {
    snprintf(o->part, sizeof o->part, "%s.part", path);
    o->f = fopen(o->part, "wb");
  }
  return o->f ? 0 : -1;
}

int outfile_close(Outfile *o, int keep)
{
  int bad = ferror(o->f) != 0, error;

  errno = bad ? EIO : 0;
  if (o->f == stdout) {
    bad |= fflush(stdout) != 0;
    return bad ? -1 : 0;
  }
  bad |= fclose(o->f) != 0;
  o->f = NULL;
  error = errno;
  if (o->part[0] && !bad && keep && rename(o->part, o->path) != 0) {
    error = errno;
    bad = 1;
  }
  if (o->part[0] && (bad || !keep)) {
    remove(o->part);
  }
  errno = error ? error : EIO;
  return bad ? -1 : 0;
}
