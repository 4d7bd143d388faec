/* Threads of POSIX. Those of Windows are in windows.c. */
#include "io/posix.h"

typedef struct Call {
  pthread_t thread;
  void (*work)(void *data);
  void *data;
} Call;

static void *call(void *of) {
  const Call *c = of;
  c->work(c->data);
  return NULL;
}

void lag_on_threads(int n, void (*work)(void *data), void *const *data) {
  Call *c = calloc((size_t)n, sizeof *c);
  int begun = 1;
  for (; c && begun < n; begun++) {
    c[begun].work = work;
    c[begun].data = data[begun];
    if (pthread_create(&c[begun].thread, NULL, call, &c[begun])) break;
  }
  work(data[0]);
  for (int i = 1; c && i < begun; i++) pthread_join(c[i].thread, NULL);
  free(c);
}
