/* The picture of a fit: for each column the data over the fitted motion, and the residuals below, as SVG. */
#include <math.h>
#include <string.h>

#include "app/fit_run.h"
#include "io/svg_panel.h"

enum { HIGH = 240, LOW = 110, GAP = 26 };

/* Range of the data and the motion of column c; or of the residuals. */
static void range_of(const FitRun *r, int c, int residuals, double *lo, double *hi) {
  const Fit *f = &r->fit;
  *lo = HUGE_VAL, *hi = -HUGE_VAL;
  for (int i = 0; i < f->nrows; i++) {
    double x = f->data[i * f->ncolumns + c], y = f->model[i * f->ncolumns + c];
    if (isnan(x)) continue;
    *lo = fmin(*lo, residuals ? x - y : fmin(x, y));
    *hi = fmax(*hi, residuals ? x - y : fmax(x, y));
  }
  if (residuals) *lo = -(*hi = fmax(fabs(*lo), fabs(*hi)));
  lag_widen_range(lo, hi, 1e-9, 0.05);
}

static void put_points(FILE *out, const FitRun *r, int c, const Panel *p, int residuals) {
  const Fit *f = &r->fit;
  for (int i = 0; i < f->nrows; i++) {
    double x = f->data[i * f->ncolumns + c], y = residuals ? x - f->model[i * f->ncolumns + c] : x;
    if (!isnan(x))
      fprintf(out, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"2.2\" fill=\"%s\" fill-opacity=\"0.7\"/>\n",
              lag_panel_x(p, f->t[i] / r->time_unit), lag_panel_y(p, y), lag_colour[0]);
  }
}

/* The fitted motion between the rows, by a run of its own. */
static void put_curve(FILE *out, FitRun *r, int c, const Panel *p) {
  enum { POINTS = 1200 };
  Fit *f = &r->fit;
  lag_sim *sim = f->fresh(f->context);
  int rc = sim ? LAG_OK : LAG_ENOMEM, put = 0;
  for (int j = 0; j < f->n && rc == LAG_OK; j++) rc = lag_sim_set(sim, f->target[j].name, f->target[j].value);
  double from = r->app->scene->t0, to = f->t[f->nrows - 1];
  for (int i = 0; i <= POINTS && rc == LAG_OK; i++) {
    double t = from + (to - from) * i / POINTS;
    rc = i ? lag_sim_advance(sim, t) : LAG_OK;
    rc = rc ? rc : lag_sim_outputs(sim, f->row);
    double y = f->row[f->column[c].output];
    if (rc == LAG_OK && isfinite(y) && t >= f->t[0])
      fprintf(out, "%s%.1f %.1f", put++ ? "L" : "<path d=\"M", lag_panel_x(p, t / r->time_unit), lag_panel_y(p, y));
  }
  if (put) fprintf(out, "\" fill=\"none\" stroke=\"%s\" stroke-width=\"1.4\"/>\n", lag_colour[1]);
  lag_sim_free(sim);
}

static void put_panels(FILE *out, FitRun *r, int c, double y, int last) {
  const Fit *f = &r->fit;
  Panel p = {.x = LEFT, .y = y, .w = WIDTH - LEFT - 20, .h = HIGH, .xlabel = r->data[0].file.names[0]}, q = p;
  p.x0 = q.x0 = f->t[0] / r->time_unit;
  p.x1 = q.x1 = f->t[f->nrows - 1] / r->time_unit;
  lag_widen_range(&p.x0, &p.x1, 1e-9, 0);
  q.x0 = p.x0, q.x1 = p.x1;
  q.y = y + HIGH + GAP;
  q.h = LOW;
  range_of(r, c, 0, &p.y0, &p.y1);
  range_of(r, c, 1, &q.y0, &q.y1);
  lag_svg_axes(out, &p, f->column[c].label, 0);
  put_curve(out, r, c, &p);
  put_points(out, r, c, &p, 0);
  char label[80];
  const char *unit = strrchr(f->column[c].label, '[');
  int has_unit = unit && unit[strlen(unit) - 1] == ']' && unit > f->column[c].label && unit[-1] == ' ';
  snprintf(label, sizeof label, "data - fit %.60s", has_unit ? unit : "");
  lag_svg_axes(out, &q, label, last);
  fprintf(out, "<path d=\"M%.1f %.1fH%.1f\" stroke=\"%s\"/>\n", q.x, lag_panel_y(&q, 0), q.x + q.w, lag_colour[1]);
  put_points(out, r, c, &q, 1);
}

static int draw(const Picture *picture, void *run) {
  FitRun *r = run;
  FILE *f = picture->f;
  int n = r->fit.ncolumns, each = HIGH + LOW + 2 * GAP;
  lag_svg_head(picture, WIDTH, TOP + n * each + BOTTOM);
  for (int c = 0; c < n; c++) put_panels(f, r, c, TOP + c * each, c + 1 == n);
  fprintf(f, "<circle cx=\"%d\" cy=\"22\" r=\"2.5\" fill=\"%s\"/>\n", WIDTH - 120, lag_colour[0]);
  fprintf(f, "<path d=\"M%d 22h20\" stroke=\"%s\" stroke-width=\"2\"/>\n", WIDTH - 66, lag_colour[1]);
  lag_svg_text(f, WIDTH - 112, 26, "", "data");
  lag_svg_text(f, WIDTH - 40, 26, "", "fit");
  return 0;
}

int lag_fit_picture(FitRun *r) {
  const Args *a = &r->app->args;
  const char *slash = strrchr(a->data, '/');
  char title[300];
  snprintf(title, sizeof title, "%s: %s, fitted to %s", r->app->scene->model->name, r->app->scene->name,
           slash ? slash + 1 : a->data);
  return lag_app_picture(r->app, a->svg, title, draw, r);
}
