/* Pictures as SVG, and as PNG where the path ends so and the program was built with librsvg. */
#include <stdlib.h>
#include <string.h>

#include "app/app.h"
#include "io/posix.h"

int lag_app_check_parts(const App *app) {
  const char *paths[] = {app->args.svg, app->args.out, app->args.motions};
  for (size_t i = 0; i < sizeof paths / sizeof *paths; i++) {
    if (!paths[i]) continue;
    if (!app->extras.png && lag_outfile_has_suffix(paths[i], "png"))
      return lag_app_error(
          &app->args, "%s: this program writes pictures as SVG; `lagc plot`, `run`, `cost` and `sweep` also as PNG",
          paths[i]);
    if (!app->extras.hdf5 && lag_outfile_has_suffix(paths[i], "h5"))
      return lag_app_error(&app->args, "%s: this program writes CSV and NumPy; `lagc sweep` also HDF5", paths[i]);
  }
  return 0;
}

int lag_app_picture(const App *app, const char *path, int (*write)(const char *svg, void *context), void *context) {
  char svg[4200], why[300] = "";
  Outfile o;
  if (!lag_outfile_has_suffix(path, "png")) return write(path, context) ? lag_app_io_error(app, path) : 0;
  snprintf(svg, sizeof svg, "%s.part-%ld.svg", path, (long)getpid());
  if (write(svg, context)) return lag_app_io_error(app, svg);
  int rc = lag_outfile_open(&o, path) ? lag_app_io_error(app, path) : 0;
  if (rc == 0 && app->extras.png(svg, o.f, why, sizeof why)) {
    lag_outfile_close(&o, OUTFILE_DROP);
    rc = lag_app_error(&app->args, "%s: %s", path, why);
  } else if (rc == 0 && lag_outfile_close(&o, OUTFILE_KEEP)) {
    rc = lag_app_io_error(app, path);
  }
  unlink(svg);
  return rc;
}

typedef struct Drawing {
  const App *app;
  const char *title;
} Drawing;

static int write_table(const char *svg, void *drawing) {
  const Drawing *d = drawing;
  const char *instants = d->app->args.drawing;
  if (instants) return lag_drawing_write(svg, &d->app->table, d->title, &d->app->show, atoi(instants));
  return lag_svg_write(svg, &d->app->table, d->title, &d->app->drawn);
}

int lag_app_draw_table(const App *app, const char *title) {
  return app->args.svg ? lag_app_picture(app, app->args.svg, write_table, &(Drawing){app, title}) : 0;
}
