# Where a bead on a hoop with friction by its own force sticks, for run_sensitivity_contacts.sh: with u = th'^2 and k = g/R,
# du/dth = -2 k sin th - 2 mu (u + k cos th) is linear, u = C exp(-2 mu th) + A sin th + B cos th; derivatives of its root by differences of
# that form, of order 6, wrong by 1e-13 or so.
from math import cos, exp, sin


def u(th, mu, k, th0, w):
    A, B = -6 * mu * k / (1 + 4 * mu**2), 2 * k * (1 - 2 * mu**2) / (1 + 4 * mu**2)
    return (w**2 - A * sin(th0) - B * cos(th0)) * exp(-2 * mu * (th - th0)) + A * sin(th) + B * cos(th)


def stops(mu, k, th0, w):
    a, b = -0.5, 0.6
    for _ in range(60):
        c = (a + b) / 2
        a, b = (c, b) if u(c, mu, k, th0, w) > 0 else (a, c)
    th = (a + b) / 2
    for _ in range(3):
        th -= u(th, mu, k, th0, w) / (-2 * k * sin(th) - 2 * mu * (u(th, mu, k, th0, w) + k * cos(th)))
    return th


at = [0.5, 9.81 / 1.1, -0.9, 1.0]
th = stops(*at)
d = []
for i in range(4):
    h = 2e-3 * abs(at[i])
    f = lambda k: stops(*[x + (j == i) * k * h for j, x in enumerate(at)])
    d.append(sum(c * (f(k) - f(-k)) for k, c in ((1, 0.75), (2, -0.15), (3, 1 / 60))) / h)
# x = R sin th; by mu, g, th0, w, and R, which is in k, too
print("dx/dmu %.12g dx/dg %.12g dx/dth %.12g dx/dw %.12g dx/dR %.12g"
      % (1.1 * cos(th) * d[0], cos(th) * d[1], 1.1 * cos(th) * d[2], 1.1 * cos(th) * d[3],
         sin(th) - 1.1 * cos(th) * d[1] * 9.81 / 1.1**2))
