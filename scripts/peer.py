"""What `just bench --peer` times beside `crumple run`: the same job as people script it, in pandas, scipy and matplotlib.

CFC 60 of SAE J211, double integration, crush, a Kelvin and an elastoplastic model by least squares over the
acceleration, each predicted at another speed, three figures and a page. Run as `peer.py RECORD FOLDER`; the record is a
table with time_s, accel_g and comment lines for mass and impact speed, such as a fixture.
"""

import re
import sys
from pathlib import Path

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np
import pandas as pd
from scipy.integrate import cumulative_trapezoid, solve_ivp
from scipy.optimize import least_squares
from scipy.signal import lfilter

G = 9.80665


def cfc(samples, dt, wanted):
    """Both passes of the filter of SAE J211, appendix C."""
    w = np.tan(2 * np.pi * wanted * 2.0775 * dt / 2)
    root2 = np.sqrt(2)
    a0 = w**2 / (1 + root2 * w + w**2)
    b1 = -2 * (w**2 - 1) / (1 + root2 * w + w**2)
    b2 = (-1 + root2 * w - w**2) / (1 + root2 * w + w**2)
    ahead = lfilter([a0, 2 * a0, a0], [1, -b1, -b2], samples)
    return lfilter([a0, 2 * a0, a0], [1, -b1, -b2], ahead[::-1])[::-1]


def kelvin(numbers, mass, speed, times):
    k, c = numbers
    motion = solve_ivp(
        lambda t, y: [y[1], -(k * y[0] + c * y[1]) / mass], (0, times[-1]), [0, speed], t_eval=times, rtol=1e-8
    )
    return motion.y[0], -(k * motion.y[0] + c * motion.y[1]) / mass


def elastoplastic(numbers, mass, speed, times):
    """Loads with k, unloads with ku from the largest crush, no tension."""
    k, unloading = numbers
    w, wu = np.sqrt(k / mass), np.sqrt(max(unloading, k) / mass)
    t_m, crush = np.pi / 2 / w, speed / w
    back = np.minimum((times - t_m) * wu, np.pi / 2)
    swing = crush * w**2 / wu**2
    x = np.where(times < t_m, crush * np.sin(w * times), crush - swing * (1 - np.cos(back)))
    a = np.where(times < t_m, -speed * w * np.sin(w * times), -crush * w**2 * np.cos(back))
    return x, a


def main(record, folder):
    text = Path(record).read_text()
    mass = float(re.search(r"mass:\s*([\d.]+)\s*kg", text)[1])
    speed = float(re.search(r"impact speed:\s*([\d.]+)\s*km/h", text)[1]) / 3.6
    table = pd.read_csv(record, comment="#")
    t, raw = table.iloc[:, 0].to_numpy(), table.iloc[:, 1].to_numpy() * G
    dt = (t[-1] - t[0]) / (len(t) - 1)
    before = (t > -0.05) & (t < -0.01)
    raw = raw - (raw[before].mean() if before.any() else 0.0)
    a = cfc(raw, dt, 60)
    v = speed + cumulative_trapezoid(a, dx=dt, initial=0)
    x = cumulative_trapezoid(v, dx=dt, initial=0)
    x -= np.interp(0, t, x)
    crush, peak = x.max(), -a.min() / G
    window = (t >= 0) & (t <= 1.5 * t[x.argmax()])
    times, measured = t[window] - t[window][0], a[window]
    rows, curves = [], {}
    w0 = speed / crush
    for name, model, start in [
        ("kelvin", kelvin, [mass * w0**2, 0.05 * mass * w0]),
        ("elastoplastic", elastoplastic, [mass * w0**2, 20 * mass * w0**2]),
    ]:
        residual = lambda n: cfc(model(np.exp(n), mass, speed, times)[1], dt, 60) - measured
        fit = least_squares(residual, np.log(start), method="lm" if name == "kelvin" else "trf")
        numbers = np.exp(fit.x)
        curves[name] = model(numbers, mass, speed, times)
        other = model(numbers, mass, 40 / 3.6, times)[0].max()
        rows.append((name, *numbers, float(np.sqrt(np.mean(fit.fun**2))), curves[name][0].max(), other))
    results = pd.DataFrame(rows, columns=["model", "first", "second", "rms m/s^2", "crush m", "crush at 40 km/h m"])
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    results.to_csv(folder / "results.csv", index=False)
    pictures = []
    for name, of_test, of_model, unit in [
        ("acceleration", a / G, lambda c: c[1] / G, "g"),
        ("displacement", 1e3 * x, lambda c: 1e3 * c[0], "mm"),
        ("force over crush", None, None, "kN"),
    ]:
        figure, axes = plt.subplots(figsize=(8, 4))
        if of_test is None:
            axes.plot(1e3 * x[window], -mass * a[window] / 1e3, label="test")
            for model, curve in curves.items():
                axes.plot(1e3 * curve[0], -mass * curve[1] / 1e3, label=model)
        else:
            axes.plot(1e3 * t, of_test, label="test")
            for model, curve in curves.items():
                axes.plot(1e3 * times, of_model(curve), label=model)
        axes.set_ylabel(unit)
        axes.legend()
        picture = name.replace(" ", "-") + ".svg"
        figure.savefig(folder / picture)
        plt.close(figure)
        pictures.append(f'<img src="{picture}" alt="{name}">')
    head = f"<h1>Crush {1e3 * crush:.0f} mm, peak {peak:.1f} g</h1>"
    (folder / "report.html").write_text(head + results.to_html(index=False) + "".join(pictures))
    print(f"crush {1e3 * crush:.1f} mm, peak {peak:.2f} g")
    print(results.to_string(index=False))


main(*sys.argv[1:3])
