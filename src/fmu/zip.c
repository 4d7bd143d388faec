/* ZIP archives, by minizip. */
#include "fmu/zip.h"

#include <stdio.h>

#ifdef LAGC_WITH_ZIP
#include <minizip/zip.h>

static void *opened(void *file, const void *name, int mode) {
  (void)name;
  (void)mode;
  return file;
}

static int left_open(void *opaque, void *file) {
  (void)opaque;
  (void)file;
  return 0;
}

static int write_file(zipFile zip, const ZipFile *f) {
  enum { STORED = 0, FIRST_OF_JANUARY_1980 = 33 << 16 };
  const zip_fileinfo info = {.dosDate = FIRST_OF_JANUARY_1980};
  int ok = zipOpenNewFileInZip(zip, f->name, &info, NULL, 0, NULL, 0, NULL, STORED, 0) == ZIP_OK;
  return ok && zipWriteInFileInZip(zip, f->bytes, (unsigned)f->n) == ZIP_OK && zipCloseFileInZip(zip) == ZIP_OK;
}

static int write_archive(FILE *to, const ZipFile *files, size_t n) {
  zlib_filefunc64_def io;
  fill_fopen64_filefunc(&io);
  io.zopen64_file = opened;
  io.zclose_file = left_open;
  io.opaque = to;
  zipFile zip = zipOpen2_64("", APPEND_STATUS_CREATE, NULL, &io);
  int ok = zip != NULL;
  for (size_t i = 0; i < n && ok; i++) ok = write_file(zip, &files[i]);
  return zip && zipClose(zip, NULL) == ZIP_OK && ok;
}

int zip_write(const ZipFile *files, size_t n, StrBuf *out, const char **error) {
  FILE *f = tmpfile();
  char block[65536];
  int ok = f && write_archive(f, files, n) && fseek(f, 0, SEEK_SET) == 0;
  for (size_t got; ok && (got = fread(block, 1, sizeof block, f)) > 0;) sb_putn(out, block, got);
  ok = ok && !ferror(f);
  if (f) fclose(f);
  return ok ? 1 : fail_with(error, "the archive cannot be written to a temporary file");
}

#else

int zip_write(const ZipFile *files, size_t n, StrBuf *out, const char **error) {
  (void)files;
  (void)n;
  (void)out;
  return fail_with(error, "this lagc was built without minizip, which writes the archives of FMUs: apt-get install "
                          "libminizip-dev, and make lagc anew");
}

#endif
