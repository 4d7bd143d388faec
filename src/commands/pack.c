/* Bytes for pages, packed by liblzma. */
#include "commands/pack.h"

#include <stdint.h>

#ifdef LAGC_WITH_XZ
#include <lzma.h>

/* Bytes of the stream at `to`; 0: it cannot be made. */
static size_t pack(const StrBuf *bytes, char *to, size_t room) {
  lzma_options_lzma options;
  const lzma_filter filters[] = {{LZMA_FILTER_LZMA1, &options}, {LZMA_VLI_UNKNOWN, NULL}};
  size_t n = 0;
  if (lzma_lzma_preset(&options, 9 | LZMA_PRESET_EXTREME)) return 0;
  options.lc = options.lp = 0;
  options.pb = 2;
  return lzma_raw_buffer_encode(filters, NULL, (const uint8_t *)bytes->at, bytes->n, (uint8_t *)to, &n, room) == LZMA_OK
             ? n
             : 0;
}
#else
static size_t pack(const StrBuf *bytes, char *to, size_t room) {
  (void)bytes, (void)to, (void)room;
  return 0;
}
#endif

int pack_append(const StrBuf *bytes, StrBuf *out) {
  size_t room = bytes->n + 64; /* beyond it packing is no use */
  char *packed = arena_alloc(out->arena, room);
  size_t n = pack(bytes, packed, room);
  for (int i = 0; i < 32; i += 8) sb_putc(out, (char)(bytes->n >> i & 255));
  if (n) return sb_putn(out, packed, n), 1;
  sb_putc(out, 1);
  sb_putn(out, bytes->at, bytes->n);
  return 0;
}
