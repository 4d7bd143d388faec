"""Writes forms.txt: one-dimensional models with forms that are finite at any distance, and their accelerations by mpmath with 60
digits from closed forms. A line `form NAME L`, with the rest of L after q'^2/2; lines `U ACCELERATION`, at q = U*a and q' = 1. `python3 forms.py >forms.txt`."""
from mpmath import mp, mpf, exp, cosh, sinh, tanh, log

mp.dps = 60
a, b = mpf(1) / 8, mpf(3)
sech = lambda u: 1 / cosh(u)
s = lambda u: 1 / (1 + exp(-u))
ds = lambda u: s(u) * s(-u) / a
sech2 = lambda u: sech(u) ** 2 / a
forms = {
    "- tanh(q/a)": lambda u: -sech2(u),
    "- log(cosh(q/a))": lambda u: -tanh(u) / a,
    "- b*tanh(q/a)^2 - tanh(q/a)": lambda u: -(2 * b * tanh(u) + 1) * sech2(u),
    "- 1/(1 + exp(-q/a))": lambda u: -ds(u),
    "- b/(1 + exp(q/a)) - b/(1 + exp(q/a))^2": lambda u: b * ds(u) * (1 + 2 * s(-u)),
    "- log(1 + exp(q/a))": lambda u: -s(u) / a,
    "+ b/(1 + exp(-q/a) + exp(-2*q/a))": lambda u: b * (exp(-u) + 2 * exp(-2 * u)) / (1 + exp(-u) + exp(-2 * u)) ** 2 / a,
    "+ (exp(q/a) - 1)/(exp(q/a) + b)": lambda u: (1 + b) / (1 + b * exp(-u)) / (exp(u) + b) / a,
    "- b/cosh(q/a)^2": lambda u: 2 * b * tanh(u) * sech2(u),
    "- 2*atan(tanh(q/(2*a)))": lambda u: -sech(u) / a,
    "- asin(tanh(q/a))": lambda u: -sech(u) / a,
    "- atan(sinh(q/a))": lambda u: -sech(u) / a,
    "- cos(q + asin(tanh(q/a)))": lambda u: (1 + sech(u) / a) * mp.sin(u * a + mp.asin(tanh(u))),
    "- 1/(b + exp(q/a))^2": lambda u: 2 / (b * exp(-u) + 1) / (b + exp(u)) ** 2 / a,
    "- sqrt(1 + exp(-2*q/a)/(1 + exp(-2*q/a)))": lambda u: ds(2 * u) / mp.sqrt(1 + s(-2 * u)),
    "+ (1 + b*tanh(q/a))^2*q'^2/2": lambda u: -b * sech2(u) * (1 + b * tanh(u)) / (1 + (1 + b * tanh(u)) ** 2),
    "+ q'^2/(2*cosh(q/a))": lambda u: sech(u) * tanh(u) / a / (2 * (1 + sech(u))),
    "+ q'^2/(2*(1 + exp(-q/a)))": lambda u: -ds(u) / (2 * (1 + s(u))),
    "- b*q*tanh(q/a)": lambda u: -b * (tanh(u) + u * sech(u) ** 2),
    "- exp(-log(cosh(q/a)))": lambda u: sech(u) * tanh(u) / a,
    "- hypot(q, 1)": lambda u: -u * a / mp.sqrt((u * a) ** 2 + 1),
    "- exp((q - a)/a - (q + a)/a)*q": lambda u: -exp(-2),
    "- exp(b*(q/a - b))/exp(b*(q/a + b))*q^2/2": lambda u: -exp(-2 * b * b) * u * a,
}
for n, (text, f) in enumerate(forms.items()):
    print(f"form {n + 1} {text}")
    for u in (1, 50, 180, 400, 700, 10000):
        for sign in (1, -1):
            print(sign * u, mp.nstr(f(mpf(sign * u)), 17))
