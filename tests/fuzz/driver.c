/* A main for fuzz targets without libFuzzer: replays a corpus as TAP, or mutates one for a while.
 *   fuzz_NAME FOLDER each file of the folder once, in the order of names; those named long_* with SLOW set
 *   fuzz_NAME --mutate SECONDS SEED-FILE DIR  random mutations of them; a failure leaves its input in SEED-FILE
 * The target is LLVMFuzzerTestOneInput, so that clang's libFuzzer can drive it as well. What it must not do:
 * crash, leak, or upset a sanitizer. Mutations are the same in every run (one seed, an LCG). */
#include <dirent.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

int LLVMFuzzerTestOneInput(const uint8_t *data, size_t size);

enum { MAX_FILES = 100000, MAX_SIZE = 1 << 24, MUTANT = 4096 };

typedef struct {
  char *path;
  uint8_t *data;
  size_t size;
} Seed;

static Seed *seeds;
static size_t nseeds;

static void die(const char *what, const char *path) {
  fprintf(stderr, "fuzz driver: %s %s\n", what, path);
  exit(2);
}

static int by_path(const void *a, const void *b) {
  return strcmp(((const Seed *)a)->path, ((const Seed *)b)->path);
}

static void read_file(const char *path, Seed *s) {
  FILE *f = fopen(path, "rb");
  if (!f) die("cannot read", path);
  uint8_t *all = malloc(MAX_SIZE);
  if (!all) die("no memory for", path);
  s->size = fread(all, 1, MAX_SIZE, f);
  fclose(f);
  /* an exact block, so that reading past the end is seen */
  s->data = malloc(s->size ? s->size : 1);
  if (!s->data) die("no memory for", path);
  memcpy(s->data, all, s->size);
  free(all);
}

static void read_folder(const char *folder) {
  DIR *d = opendir(folder);
  if (!d) die("cannot open", folder);
  seeds = calloc(MAX_FILES, sizeof *seeds);
  for (struct dirent *e; seeds && nseeds < MAX_FILES && (e = readdir(d));) {
    /* `make test-long` sets SLOW */
    if (e->d_name[0] == '.' || (strncmp(e->d_name, "long_", 5) == 0 && !getenv("SLOW"))) continue;
    size_t n = strlen(folder) + strlen(e->d_name) + 2;
    char *path = malloc(n);
    if (!path) die("no memory for", folder);
    snprintf(path, n, "%s/%s", folder, e->d_name);
    seeds[nseeds].path = path;
    read_file(path, &seeds[nseeds++]);
  }
  closedir(d);
  if (!nseeds) die("no files in", folder);
  qsort(seeds, nseeds, sizeof *seeds, by_path);
}

static void replay(void) {
  setenv("FUZZ_REPLAY", "1", 1);
  printf("1..%zu\n", nseeds);
  for (size_t i = 0; i < nseeds; i++) {
    printf("# %s\n", seeds[i].path);
    fflush(stdout);
    LLVMFuzzerTestOneInput(seeds[i].data, seeds[i].size);
    printf("ok %zu - %s\n", i + 1, strrchr(seeds[i].path, '/') + 1);
  }
}

/* ---- mutations ---- */

static uint64_t rng = 1;

static size_t below(size_t n) {
  rng = rng * 6364136223846793005u + 1442695040888963407u;
  return n ? (size_t)(rng >> 33) % n : 0;
}

static size_t mutate(uint8_t *out) {
  static const char *const bits[] = {"(", ")", "[", "]", "{", "}", "'", "^", "1e999", "sum(i in 1..3, ", "\n", "\"",
                                     "lagrangian = ", "coord ", "let ", "scene s {", "0/0", "\xce\xb8", "\xff"};
  const Seed *s = &seeds[below(nseeds)];
  size_t n = s->size < MUTANT / 2 ? s->size : MUTANT / 2;
  memcpy(out, s->data, n);
  for (size_t edits = 1 + below(6); edits--;) {
    size_t at = below(n + 1);
    switch (below(5)) {
      case 0: /* change a byte */
        if (at < n) out[at] = (uint8_t)below(256);
        break;
      case 1: { /* drop a stretch */
        size_t k = below((n - at < 16 ? n - at : 16) + 1);
        memmove(out + at, out + at + k, n - at - k);
        n -= k;
        break;
      }
      case 2: { /* put in a word */
        const char *w = bits[below(sizeof bits / sizeof *bits)];
        size_t k = strlen(w);
        if (n + k > MUTANT) break;
        memmove(out + at + k, out + at, n - at);
        memcpy(out + at, w, k);
        n += k;
        break;
      }
      case 3: { /* a stretch of another file */
        const Seed *o = &seeds[below(nseeds)];
        size_t from = below(o->size), k = below(64);
        if (k > o->size - from) k = o->size - from;
        if (n + k > MUTANT) break;
        memmove(out + at + k, out + at, n - at);
        memcpy(out + at, o->data + from, k);
        n += k;
        break;
      }
      default: /* cut off the end */
        if (below(4) == 0) n = at;
    }
  }
  return n;
}

static void mutate_for(long seconds, const char *keep) {
  uint8_t *buffer = malloc(MUTANT);
  if (!buffer) die("no memory for", "a mutant");
  time_t end = time(NULL) + seconds;
  unsigned long runs = 0;
  for (; runs % 16 || time(NULL) < end; runs++) {
    size_t n = mutate(buffer);
    FILE *f = fopen(keep, "wb"); /* there when the target does not return */
    if (!f || fwrite(buffer, 1, n, f) != n || fclose(f)) die("cannot write", keep);
    uint8_t *exact = malloc(n ? n : 1);
    if (!exact) die("no memory for", "a mutant");
    memcpy(exact, buffer, n);
    LLVMFuzzerTestOneInput(exact, n);
    free(exact);
  }
  remove(keep);
  free(buffer);
  printf("%lu mutants, no failure\n", runs);
}

int main(int argc, char **argv) {
  if (argc == 5 && !strcmp(argv[1], "--mutate")) {
    read_folder(argv[4]);
    mutate_for(strtol(argv[2], NULL, 10), argv[3]);
  } else if (argc == 2) {
    read_folder(argv[1]);
    replay();
  } else {
    fputs("usage: fuzz_NAME FOLDER | fuzz_NAME --mutate SECONDS INPUT FOLDER\n", stderr);
    return 2;
  }
  for (size_t i = 0; i < nseeds; i++) {
    free(seeds[i].path);
    free(seeds[i].data);
  }
  free(seeds);
  return 0;
}
