/* Pictures as SVG, and as PNG where the path ends so and the program was built with librsvg. */
#include <errno.h>

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

static int make_png(const App *app, const char *svg, const char *path) {
  char why[300] = "";
  Outfile o;
  if (lag_outfile_open(&o, path)) return lag_app_io_error(app, path);
  if (app->extras.png(svg, o.f, why, sizeof why))
    return lag_outfile_close(&o, OUTFILE_DROP), lag_app_error(&app->args, "%s: %s", path, why);
  return lag_outfile_close(&o, OUTFILE_KEEP) ? lag_app_io_error(app, path) : 0;
}

int lag_app_picture(const App *app, const char *path, const char *title, int (*write)(const Picture *p, void *context),
                    void *context) {
  char part[4200];
  int png = lag_outfile_has_suffix(path, "png");
  const char *svg = png ? part : path;
  Outfile o;
  if (png) snprintf(part, sizeof part, "%s.part-%ld.svg", path, (long)getpid());
  if (lag_outfile_open(&o, svg)) return lag_app_io_error(app, svg);
  int bad = write(&(Picture){o.f, title, &app->args.picture}, context), why = errno;
  fputs("</svg>\n", o.f);
  int lost = lag_outfile_close(&o, bad ? OUTFILE_DROP : OUTFILE_KEEP);
  if (bad) errno = why;
  if (bad || lost) return lag_app_io_error(app, svg);
  int rc = png ? make_png(app, svg, path) : 0;
  if (png) unlink(svg);
  return rc;
}

static int write_table(const Picture *p, void *app) {
  const App *a = app;
  if (p->options->drawing) return lag_drawing_write(p, &a->table, &a->show);
  lag_svg_write(p, &a->table, &a->drawn);
  return 0;
}

int lag_app_draw_table(App *app, const char *title) {
  return app->args.svg ? lag_app_picture(app, app->args.svg, title, write_table, app) : 0;
}
