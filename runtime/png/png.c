/* Pictures as PNG: librsvg draws the SVG that liblag wrote, cairo and libpng write the pixels. */
#include <cairo.h>
#include <librsvg/rsvg.h>
#include <stdio.h>
#include <string.h>

#include "lag.h"

static cairo_status_t put(void *file, const unsigned char *bytes, unsigned n) {
  return fwrite(bytes, 1, n, file) == n ? CAIRO_STATUS_SUCCESS : CAIRO_STATUS_WRITE_ERROR;
}

int lag_png_write(const char *svg, void *file, char *why, size_t size) {
  const double scale = 2; /* for screens with small pixels, and print */
  double width = 0, height = 0;
  GError *error = NULL;
  RsvgHandle *h = rsvg_handle_new_from_file(svg, &error);
  if (!h || !rsvg_handle_get_intrinsic_size_in_pixels(h, &width, &height)) {
    snprintf(why, size, "librsvg: %s", error ? error->message : "the picture has no size");
    g_clear_error(&error);
    if (h) g_object_unref(h);
    return -1;
  }
  cairo_surface_t *s = cairo_image_surface_create(CAIRO_FORMAT_RGB24, (int)(scale * width), (int)(scale * height));
  cairo_t *c = cairo_create(s);
  RsvgRectangle all = {0, 0, scale * width, scale * height};
  int drawn = rsvg_handle_render_document(h, c, &all, &error);
  cairo_status_t status = cairo_surface_write_to_png_stream(s, put, file);
  if (!drawn || status) snprintf(why, size, "%s", error ? error->message : cairo_status_to_string(status));
  g_clear_error(&error);
  cairo_destroy(c);
  cairo_surface_destroy(s);
  g_object_unref(h);
  return drawn && !status ? 0 : -1;
}
