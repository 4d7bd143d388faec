"""Planar impact of one point with friction, integrated over the normal impulse in all coordinates (Routh): independent of planar_impact.c,
which works with the 2 x 2 matrix W. M: mass matrix, n, t: rows of the normal and tangential velocity of the point, u: velocities."""
from mpmath import mp, mpf, matrix, lu_solve, cos, sin, sqrt, inf
mp.dps = 40
def impact(M, n, t, u, mu, e, law):
    n, t, u = matrix(n), matrix(t), matrix(u)
    dot = lambda a, b: sum(a[i]*b[i] for i in range(len(a)))
    An, At = lu_solve(M, n), lu_solve(M, t)
    vn0 = dot(n, u); p = mpf(0); work = mpf(0); pc = wc = None; T0 = dot(u, M*u)/2
    for _ in range(20):
        vn, vt = dot(n, u), dot(t, u)
        if abs(vt) < mpf(10)**-30:
            f = -dot(t, An)/dot(t, At)              # holds the point
            if abs(f) > mu: f = mu*(1 if f > 0 else -1)
        else: f = -mu*(1 if vt > 0 else -1)
        du = An + f*At
        an, at = dot(n, du), dot(t, du)
        ends = [(-vt/at, 's')] if vt*at < 0 else []
        if pc is None:
            if vn*an < 0: ends.append((-vn/an, 'c'))
        elif law == 'newton': ends.append(((-e*vn0 - vn)/an, 'e'))
        elif law == 'poisson': ends.append(((1 + e)*pc - p, 'e'))
        else:
            left = e*e*wc - (work + wc)               # work still to be done: vn d + an d^2/2 = left
            ends.append(((-vn + sqrt(vn*vn + 2*an*left))/an, 'e'))
        d, what = min(ends)
        work += vn*d + an*d*d/2; p += d; u = u + d*du
        if what == 'c': pc, wc = p, -work
        if what == 'e': return u, dot(u, M*u)/2 - T0
def double_pendulum(a, b, l=mpf(1), m=mpf(1)):
    """uniform rods; angles from the vertical, the floor below the hinge: rows for (a', b')"""
    M = matrix([[m*l*l*4/3, m*l*l/2*cos(a - b)], [m*l*l/2*cos(a - b), m*l*l/3]])
    return M, [l*sin(a), l*sin(b)], [l*cos(a), l*cos(b)]   # tip: x = l sin a + l sin b, y = -l cos a - l cos b
def rod(th, l=mpf(1), m=mpf(1)):
    """free uniform rod, its foot at (x - l/2 cos th, y - l/2 sin th): rows for (x', y', th')"""
    return matrix([[m, 0, 0], [0, m, 0], [0, 0, m*l*l/12]]), [0, 1, -l/2*cos(th)], [1, 0, l/2*sin(th)]


if __name__ == '__main__':
    for mu, law in [(m, l) for m in ('0.5', '0.7') for l in ('stronge', 'poisson', 'newton')]:
        M, n, t = double_pendulum(mp.pi/9, mp.pi/6)
        v, dT = impact(M, n, t, [mpf('-0.1'), mpf('-0.2')], mpf(mu), mpf('0.5'), law)
        print('double pendulum', mu, law, [mp.nstr(x, 20) for x in v], mp.nstr(dT, 10))
    for mu, law in [(m, l) for m in ('0.3', '0.6') for l in ('stronge', 'poisson', 'newton')]:
        M, n, t = rod(mpf(1))
        v, dT = impact(M, n, t, [mpf('-0.3'), -1, mpf(0)], mpf(mu), mpf('0.6'), law)
        print('rod', mu, law, [mp.nstr(x, 20) for x in v], mp.nstr(dT, 10))
