/* The period of what drives a motion (periodic_orbit.h), followed as a parameter changes. */
#include <math.h>
#include <stdio.h>

#include "analysis/periodic_orbit.h"

/* The drive has period T. */
static void take_drive(PeriodicOrbit *o, double T) {
  o->T = o->drives * T;
  o->flow.drive = T;
}

void lag_orbit_count_drives(PeriodicOrbit *o) {
  double shortest = lag_flow_find_drive(&o->flow, 1.01 * o->T);
  o->drives = shortest > 0 ? (int)fmax(1, rint(o->T / shortest)) : 1;
  o->flow.drive = o->T / o->drives;
}

/* T := as many periods of the drive as before, if its period is another one, yet near. 0: it is not. */
static int renew_drive(PeriodicOrbit *o, double near) {
  const double same = 1e-9;
  double T = o->T / o->drives;
  if (lag_flow_drive(&o->flow, &T) > same || fabs(T - o->T / o->drives) > near * T) return 0;
  take_drive(o, T);
  return 1;
}

int lag_orbit_period_is_usual(PeriodicOrbit *o) {
  const double longest = 30; /* near a homoclinic motion the period grows without limit */
  int asked = o->led >= 0 && o->held[o->led].kind == ORBIT_PERIOD; /* a range of periods is its own limit */
  if (o->T > 0 && (asked || o->T < longest * o->time)) return 1;
  snprintf(o->flow.message, sizeof o->flow.message,
           "the period has become %.6g s, %g times that at the begin: begin there to go on", o->T, longest);
  return 0;
}

/* The next value on the way to another one: strides change a frequency by little, lest twice the period be taken for
 * it. */
static double stride_to(const PeriodicOrbit *o, double value, double part) {
  const double of_range = 0.02, of_value = 0.015, least = 1e-6;
  double longest = fmax(fmin(of_range * o->parameter_unit, of_value * fabs(o->parameter)), least * o->parameter_unit);
  double left = value - o->parameter;
  return fabs(left) <= part * longest ? value : o->parameter + copysign(part * longest, left);
}

/* The parameter := value, with the period of the drive followed from value to value. */
static int follow_drive(PeriodicOrbit *o, double value) {
  const double near = 0.02, shortest = 1.0 / 64;
  double part = 1;
  for (int more = 1; more;) {
    double next = stride_to(o, value, part);
    int rc = lag_flow_set(&o->flow, o->name, next);
    if (rc) return rc;
    if (!renew_drive(o, near)) {
      if ((part /= 2) >= shortest) continue;
      double T = lag_flow_find_drive(&o->flow, 8 * o->time / o->drives);
      if (!(T > 0)) return LAG_EDOMAIN;
      take_drive(o, T);
    }
    part = fmin(2 * part, 1);
    o->parameter = next;
    if (!lag_orbit_period_is_usual(o)) return LAG_EDOMAIN;
    more = next != value;
  }
  return LAG_OK;
}

int lag_orbit_set_parameter(PeriodicOrbit *o, double value) {
  if (o->flow.forced && o->led < 0) return follow_drive(o, value);
  o->parameter = value;
  return o->led < 0 ? lag_flow_set(&o->flow, o->name, value) : LAG_OK;
}
