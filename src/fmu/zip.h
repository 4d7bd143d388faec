/* ZIP archives: files stored without compression, dated 1980-01-01, so that equal contents are equal bytes. Format:
 * PKWARE, APPNOTE.TXT 6.3.10. */
#pragma once

#include "base/strbuf.h"

typedef struct {
  const char *name; /* with `/` between folders, ASCII */
  const char *bytes;
  size_t n;
} ZipFile;

/* Appends the archive, files in the order given. Each file, and the archive, is shorter than 4 GiB. Returns 0, with
 * *error, where it cannot be written, or lagc was built without minizip. */
int zip_write(const ZipFile *files, size_t n, StrBuf *out, const char **error);
