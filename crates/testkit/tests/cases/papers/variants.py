"""Writes variants.json: cases of the kinds of the papers with other numbers, by mpmath with fifty digits.

Three-mass forward polynomials, other masses and root configurations, multiple roots. Independent of the project's code:
polynomials by the tridiagonal recursion, crush by the matrix exponential in steps and Newton, solutions of coefficient matching by
the roots of the cubic. Usage: python3 variants.py > variants.json
"""

import json

import mpmath as mp

mp.mp.dps = 50
F = mp.mpf
items = []


def num(z):
    z = mp.mpc(z)
    if abs(z.imag) < F(10) ** -20 * max(1, abs(z)):
        return float(z.real)
    return {"re": float(z.real), "im": float(z.imag)}


def put(name, kind, inputs, expected):
    items.append({
        "id": name, "kind": kind, "inputs": inputs, "expected": expected, "tolerance_to_recomputed_relative": 1e-9,
    })


def times(a, b):
    r = [F(0)] * (len(a) + len(b) - 1)
    for i, x in enumerate(a):
        for j, y in enumerate(b):
            r[i + j] += x * y
    return r


def minus(a, b):
    n = max(len(a), len(b))
    return [(a[i] if i < len(a) else 0) - (b[i] if i < len(b) else 0) for i in range(n)]


def of_chain(m, k, c):
    """Monic characteristic polynomial, highest power first."""
    n = len(m)
    k, c = list(k) + [0], list(c) + [0]
    before, here = [F(1)], None
    for i in range(n):
        own = [F(k[i]) + k[i + 1], F(c[i]) + c[i + 1], F(m[i])]
        link = [F(k[i]), F(c[i])]
        if here is None:
            here = own
        else:
            before, here = here, minus(times(own, here), times(times(link, link), before))
    return [x / here[-1] for x in reversed(here)]


def roots_of(p):
    return mp.polyroots(p, maxsteps=500, extraprec=600)


def configuration(r):
    pairs = sum(1 for z in r if z.imag > F(10) ** -15 * abs(z))
    return {"complex_pairs": pairs, "real_roots": len(r) - 2 * pairs, "stable": all(z.real < 0 for z in r)}


def inputs_of(m, k, c):
    return {f"{a}{i + 1}": v for a, l in (("m", m), ("k", k), ("c", c)) for i, v in enumerate(l)}


def chain(name, m, k, c):
    p = of_chain(m, k, c)
    r = roots_of(p)
    expected = {"roots": [num(z) for z in r], "configuration": configuration(r)}
    if len(m) == 2:
        expected.update(dict(zip("tuvw", [num(x) for x in p[1:]])))
    expected["coefficients_descending_monic"] = [num(x) for x in p]
    put(name, "charpoly_two_mass" if len(m) == 2 else "charpoly_three_mass", inputs_of(m, k, c), expected)


def crush(name, m, k, c, v0, until=2.0):
    n = len(m)
    r = roots_of(of_chain(m, k, c))
    kk, cc = list(k) + [0], list(c) + [0]
    a = mp.matrix(2 * n, 2 * n)
    for i in range(n):
        a[i, n + i] = 1
        for col, of in ((0, kk), (n, cc)):
            a[n + i, col + i] = -F(of[i] + of[i + 1]) / m[i]
            if i > 0:
                a[n + i, col + i - 1] = F(of[i]) / m[i]
            if i + 1 < n:
                a[n + i, col + i + 1] = F(of[i + 1]) / m[i]
    h = F("0.0005")
    step = mp.expm(a * h)
    x = mp.matrix([0] * n + [F(v0)] * n)
    t, expected, done = F(0), {}, [False] * n
    while t < until and not all(done):
        y = step * x
        for i in range(n):
            if not done[i] and x[n + i] > 0 and y[n + i] <= 0:
                d = h * x[n + i] / (x[n + i] - y[n + i])
                for _ in range(8):
                    z = mp.expm(a * d) * x
                    d -= z[n + i] / (a[n + i, :] * z)[0]
                z = mp.expm(a * d) * x
                expected[f"t_m{i + 1}"], expected[f"C{i + 1}"], done[i] = num(t + d), num(z[i]), True
        x, t = y, t + h
    for i in range(n):
        if not done[i]:
            expected[f"t_m{i + 1}"] = expected[f"C{i + 1}"] = None
    expected.update({"searched_until_s": until, "roots": [num(z) for z in r], "configuration": configuration(r)})
    put(name, "crush", {**inputs_of(m, k, c), "v0": v0}, expected)


def match(name, m1, m2, polynomial, roots=None):
    t, u, v, w = [F(x) for x in polynomial]
    kappa, reduced = F(m1 + m2) / m1, F(m1) * m2 / (m1 + m2)
    cubic = [1, -2 * u, u * u + t * v - 4 * kappa * w, kappa * v * v + t * t * w - t * u * v]
    zetas = roots_of(cubic)
    found = []
    for zeta in zetas:
        r1 = mp.sqrt(t * t - 4 * kappa * zeta)
        r0 = (t * (u - zeta) - 2 * kappa * v) / r1
        for s in (1, -1):
            found.append({
                "c1": m1 * (t + s * r1) / 2, "c2": reduced * (t - s * r1) / 2,
                "k1": m1 * ((u - zeta) + s * r0) / 2, "k2": reduced * ((u - zeta) - s * r0) / 2,
            })
    solutions = []
    for one in found:
        values = {key: num(x) for key, x in one.items()}
        real = all(isinstance(x, float) for x in values.values())
        physical = real and values["k1"] > 0 and values["k2"] > 0 and values["c1"] >= 0 and values["c2"] >= 0
        solutions.append({**values, "real": real, "physical": physical})
    to_q = F(m2) * (m1 + m2) * m1 * m2
    put(name, "match", {"m1": m1, "m2": m2, **({"roots": roots} if roots else dict(zip("tuvw", map(float, polynomial))))}, {
        "cubic_in_q_roots": [num(z * to_q) for z in zetas],
        "n_solutions_with_multiplicity": 6,
        "n_real_with_multiplicity": sum(s["real"] for s in solutions),
        "n_physical_with_multiplicity": sum(s["physical"] for s in solutions),
        "solutions": solutions,
    })


def maxwell(name, m, k, c, v0):
    """The mass behind a spring and a damper in series, at rest relative to them at the start; real exponents."""
    m, k, c, v0 = F(m), F(k), F(c), F(str(v0))
    a, b = -k / (2 * c), mp.sqrt((k / (2 * c)) ** 2 - k / m)
    # x(0) = 0, x'(0) = v0, x''(0) = 0.
    first, second, third = mp.lu_solve(
        mp.matrix([[1, 1, 1], [0, a + b, a - b], [0, (a + b) ** 2, (a - b) ** 2]]), mp.matrix([0, v0, 0]))
    put(name, "maxwell", {"m": float(m), "k": float(k), "c": float(c), "v0": float(v0)}, {
        "a": num(a), "b": num(b), "kind": "real", "x_inf": num(first),
        "C1": num(first), "C2": num(second), "C3": num(third), "t_m": None, "C": None,
    })


def realization(name, a, b, c, d, dt, rows, columns):
    n = len(a)
    block = mp.expm(mp.matrix([[*a[i], b[i]] for i in range(n)] + [[0] * (n + 1)]) * F(str(dt)))
    discrete, state = block[:n, :n], block[:n, n]
    markov = [F(d)]
    for _ in range(rows + columns):
        markov.append(sum(F(str(c[i])) * state[i] for i in range(n)))
        state = discrete * state
    put(name, "realization", {"A": a, "B": b, "C": c, "D": d, "dt": dt, "alpha": rows, "beta": columns}, {
        "markov_parameters": [num(x) for x in markov],
    })


def expanded(roots):
    p = [mp.mpc(1)]
    for r in roots:
        p = [(p[i] if i < len(p) else 0) - (r * p[i - 1] if i > 0 else 0) for i in range(len(p) + 1)]
    return [mp.re(x) for x in p]


def match_roots(name, m1, m2, roots):
    match(name, m1, m2, expanded(roots)[1:], [num(z) for z in roots])


chain("three-three-pairs", [200, 350, 900], [500000, 300000, 400000], [2000, 3000, 1000])
chain("three-mixed", [150, 80, 1100], [800000, 200000, 900000], [40000, 9000, 30000])
chain("three-undamped", [100, 100, 100], [100000, 100000, 100000], [0, 0, 0])
chain("three-overdamped", [300, 200, 700], [10000, 20000, 30000], [90000, 50000, 70000])
chain("two-other-masses", [410, 1234], [330000, 710000], [9000, 11000])
chain("two-double-root", [2, 1], [50, 25], [20, 10])
crush("crush-three-masses", [200, 350, 900], [500000, 300000, 400000], [2000, 3000, 1000], 12.5)
crush("crush-two-pairs", [410, 1234], [330000, 710000], [9000, 11000], 15.0)
crush("crush-four-real", [655, 220], [75000, 46000], [18000, 11000], 9.0)
match("match-light-front", 300, 1100, [40, 3000, 60000, 700000])
match("match-equal-masses", 500, 500, [100, 5000, 90000, 400000])
match("match-heavy-front", 800, 400, [12.5, 2500, 9000, 500000])
match_roots("match-two-pairs", 300, 600, [mp.mpc(-3, 20), mp.mpc(-3, -20), mp.mpc(-8, 60), mp.mpc(-8, -60)])
match_roots("match-double-pole", 300, 600, [mp.mpc(-5), mp.mpc(-5), mp.mpc(-40), mp.mpc(-90)])
match_roots("match-double-pair", 300, 600, [mp.mpc(-6, 30), mp.mpc(-6, -30)] * 2)
match("match-equal-roots", 500, 500, ["93.6", "1001.16", "3516.696", "3932.6634"])
maxwell("maxwell-real", 873, 500000, 4000, 9.7222)
realization("realization-tall", [[-3, 40], [-40, -5]], [1, 2], [0.5, -1], 0.25, 0.01, 6, 4)
put("coefficients-triple-root", "roots_to_coefficients", {"roots": [-7.0, -7.0, -7.0, -2.0]}, {
    "coefficients_descending_monic": [num(x) for x in expanded([mp.mpc(-7)] * 3 + [mp.mpc(-2)])],
})
print(json.dumps({"items": items}, indent=1))
