"""Stages of a user: swapped_stages.py MODE INPUT... -o OUTPUT, by the plain files of an artifact."""
import array, json, math, pathlib, subprocess, sys, tempfile

mode, *words = sys.argv[1:]
output = words[words.index("-o") + 1]
inputs = [word for word in words[: words.index("-o")] if word.endswith(".mcap")]
parent = tempfile.TemporaryDirectory()
records, waves = {}, {}
for number, path in enumerate(inputs):
    folder = pathlib.Path(parent.name, str(number))
    subprocess.run(["crumple-artifact", "unpack", "-q", path, folder], check=True)
    for line in (folder / "records.ndjson").read_text().splitlines():
        record = json.loads(line)
        records[record["topic"]] = record
    for line in (folder / "waves.ndjson").read_text().splitlines():
        wave = json.loads(line)
        samples = array.array("d", (folder / wave.pop("file")).read_bytes())
        waves[wave["id"]] = wave | {"x": list(samples)}
test = records["/test"]["data"]
pulse = test.get("pulse") or next(c["id"] for c in test["channels"] if c["quantity"] == "acceleration")


def running(samples, step):
    total, sums = 0.0, [0.0]
    for a, b in zip(samples, samples[1:]):
        total += (a + b) / 2 * step
        sums.append(total)
    return sums


def mean(samples, half):
    sums = [0.0]
    for x in samples:
        sums.append(sums[-1] + x)
    ends = [(max(0, k - half), min(len(samples), k + half + 1)) for k in range(len(samples))]
    return [(sums[end] - sums[start]) / (end - start) for start, end in ends]


def low_pass(samples, step, cutoff):
    """Two poles, one way: a Butterworth filter that is late."""
    w = math.tan(math.pi * cutoff * step)
    d = 1 + math.sqrt(2) * w + w * w
    a, b, c = w * w / d, 2 * (w * w - 1) / d, (1 - math.sqrt(2) * w + w * w) / d
    out, x1, x2, y1, y2 = [], 0.0, 0.0, 0.0, 0.0
    for x in samples:
        y = a * (x + 2 * x1 + x2) - b * y1 - c * y2
        out.append(y)
        x1, x2, y1, y2 = x, x1, y, y1
    return out


def filtered():
    accelerations = [c for c in test["channels"] if c["quantity"] == "acceleration" and c["id"] in waves]
    for channel in accelerations:
        channel["cfc"] = 60
    kept = {c["id"]: waves[c["id"]] | {"x": mean(waves[c["id"]]["x"], 22)} for c in accelerations}
    wave, raw = kept[pulse], waves[pulse]["x"]
    x, step = wave["x"], wave["dt_s"]
    both_ways = lambda samples: low_pass(low_pass(samples, step, 125)[::-1], step, 125)[::-1]
    after = lambda seconds: max(0, round((seconds - wave["t0_s"]) / step))
    change = {
        "honest": {}, "butterworth": {"x": both_ways(raw)}, "raw": {"x": raw},
        "rate": {"x": x[::10], "dt_s": step * 10}, "rounded": {"x": [float(round(v)) for v in x]},
        "wide": {"x": mean(raw, 30)}, "twice": {"x": mean(mean(raw, 15), 15)},
        "tail": {"x": x[: int(len(x) * 0.95)]},
        "causal": {"x": low_pass(raw, step, 125)},
        "lag": {"x": [sum(raw[max(0, k - 88): k + 1]) / min(k + 1, 89) for k in range(len(raw))]},
        "late 20": {"t0_s": wave["t0_s"] + 0.02}, "early 20": {"t0_s": wave["t0_s"] - 0.02},
        "late 3": {"t0_s": wave["t0_s"] + 0.003}, "early 3": {"t0_s": wave["t0_s"] - 0.003},
        "sign": {"x": [-v for v in x]}, "g": {"x": [v / 9.80665 for v in x]}, "mm": {"x": [v * 1000 for v in x]},
        "gain": {"x": [v * 1.1 for v in x]}, "small gain": {"x": [v * 0.94 for v in x]},
        "offset": {"x": [v - 20 for v in x]}, "clip": {"x": [max(v, -200.0) for v in x]}, "reverse": {"x": x[::-1]},
        "every second": {"x": x[::2]}, "in ms": {"dt_s": step * 1000}, "zero": {"x": [0.0] * len(x)},
        "velocity": {"x": [15.5 + v for v in running(x, step)]}, "cut": {"x": x[: int(len(x) * 0.4)]},
        "begins late": {"x": x[after(0.06):], "t0_s": 0.06}, "begins at 10 ms": {"x": x[after(0.01):], "t0_s": 0.01},
        "half": {"x": [v if k < after(0.05) else 0.0 for k, v in enumerate(x)]},
        "absolute": {"x": [abs(v) for v in x]}, "jerk": {"x": [0.0] + [b - a for a, b in zip(x, x[1:])]},
        "failed": {}, "mass": {}, "speed": {}, "other title": {}, "no pulse": {},
        "stated late": {"t0_s": wave["t0_s"] + 0.02}, "stated early": {"t0_s": wave["t0_s"] - 0.02},
        "20 ms wide": {"x": mean(raw, round(0.01 / step))}, "60 ms wide": {"x": mean(raw, round(0.03 / step))},
        "100 ms wide": {"x": mean(raw, round(0.05 / step))},
    }[what]
    wave |= change
    if what == "failed":
        for channel in test["channels"]:
            channel["status"] = "failed"
    if what == "mass":
        test["mass_kg"] *= 2
    if what == "speed":
        test["impact_speed_m_per_s"] *= 3.6
    if what == "other title":
        test["title"] = "another"
    kept[pulse] = wave
    said = []
    if what.startswith("stated"):
        shift = change["t0_s"] - waves[pulse]["t0_s"]
        data = {"mode": "moving-average", "phase": "zero", "width_s": 45 * step, "shift_s": shift, "notes": [],
                "samples_added": 0, "coefficients": [], "zero_level_removed": 0.0}
        said = [{"topic": f"/filter/{pulse}", "schema": "crumple.ChannelFilter.v1", "data": data}]
    if what == "no pulse":
        kept.pop(pulse)
    return [records["/test"], *said], kept


def integrated():
    wave, speed, mass = waves[pulse], test["impact_speed_m_per_s"], test["mass_kg"]
    x, step, start = wave["x"], wave["dt_s"], wave["t0_s"]
    zero = max(0, round(-start / step))
    simpson = lambda y: [0.0] + [a + (b - a) for a, b in zip(running(y, step), running(y, step)[1:])]
    rule = {"euler": lambda y: [sum_ for sum_ in euler(y)], "simpson": simpson}.get(what, lambda y: running(y, step))

    def euler(y):
        total = 0.0
        for value in y:
            yield total
            total += value * step

    drift = {"drift": 8.0, "small drift": 0.5}.get(what, 0.0)
    v = [speed + value + drift * max(0.0, start + k * step) for k, value in enumerate(rule(x))]
    s = rule(v)
    s = [value - s[zero] for value in s]
    top = max(range(zero, len(s)), key=lambda k: s[k])
    low = min(range(top, len(v)), key=lambda k: v[k])
    events = {
        "channel": pulse, "time_zero_s": 0.0, "time_zero_rule": "file", "dynamic_crush_m": s[top],
        "time_of_dynamic_crush_s": start + top * step, "centroid_time_s": s[top] / speed,
        "rebound_velocity_m_per_s": v[low], "coefficient_of_restitution": -v[low] / speed,
        "delta_v_m_per_s": speed - v[low], "time_of_rebound_s": start + low * step, "impact_speed_m_per_s": speed,
        "rule": "trapezoid", "start": "record-start", "intervals": [],
    }
    metric = {"name": "dynamic_crush", "value": s[top], "unit": "m", "channel": pulse, "definition": "largest"}
    metrics = [metric]
    names = {"velocity": v, "displacement": s, "force": [-mass * a for a in x]}
    made = {name: {"id": f"{pulse}/{name}", "quantity": name, "t0_s": start, "dt_s": step, "x": y}
            for name, y in names.items()}
    times = lambda name, factor: made[name].update(x=[value * factor for value in made[name]["x"]])
    what_is = {
        "no metrics": lambda: metrics.clear(), "no force": lambda: made.pop("force"),
        "rate": lambda: [w.update(x=w["x"][::10], dt_s=step * 10) for w in made.values()],
        "displacement in mm": lambda: times("displacement", 1000), "velocity in km/h": lambda: times("velocity", 3.6),
        "both in mm": lambda: (times("displacement", 1000), events.update(dynamic_crush_m=s[top] * 1000)),
        "crush in mm": lambda: events.update(dynamic_crush_m=s[top] * 1000),
        "time in ms": lambda: events.update(time_of_dynamic_crush_s=events["time_of_dynamic_crush_s"] * 1000),
        "crush x 1.3": lambda: (metrics.clear(), events.update(dynamic_crush_m=s[top] * 1.3)),
        "crush x 0.95": lambda: (metrics.clear(), events.update(dynamic_crush_m=s[top] * 0.95)),
        "restitution": lambda: events.update(coefficient_of_restitution=0.5),
        "speed x 1.2": lambda: events.update(impact_speed_m_per_s=speed * 1.2),
        "delta-v": lambda: events.update(delta_v_m_per_s=-events["delta_v_m_per_s"]),
        "delta-v in km/h": lambda: events.update(delta_v_m_per_s=events["delta_v_m_per_s"] * 3.6),
        "sign": lambda: (times("displacement", -1), times("velocity", -1)),
        "sign of displacement": lambda: times("displacement", -1),
        "all signs": lambda: (times("displacement", -1), times("velocity", -1),
                              events.update(dynamic_crush_m=-s[top])),
        "displacement late": lambda: made["displacement"].update(t0_s=start + 0.02),
        "all late": lambda: [w.update(t0_s=start + 0.02) for w in made.values()],
        "without speed": lambda: made["velocity"].update(x=[value - speed for value in v]),
        "force in kN": lambda: times("force", 1e-3), "force of another mass": lambda: times("force", 1.5),
        "metric in km/h": lambda: metrics.append(
            metric | {"name": "delta_v", "value": events["delta_v_m_per_s"] * 3.6, "unit": "km/h"}),
        "another crush": lambda: metric.update(value=s[top] * 1.05),
        "outside": lambda: events["intervals"].append(
            {"name": "dynamic_crush_m", "low": s[top] * 1.1, "high": s[top] * 1.2, "interval_by": "mine"}),
        "metric outside": lambda: metric.update(low=s[top] * 1.1, high=s[top] * 1.2),
        "peak of another": lambda: events.update(rebound_velocity_m_per_s=-v[low]),
    }
    what_is.get(what, lambda: None)()
    if what not in what_is and what not in ("honest", "euler", "simpson", "no events", "drift", "small drift"):
        sys.exit(2)
    data = [("/test", "crumple.Test.v1", test), ("/events", "crumple.Events.v1", events),
            ("/metrics", "crumple.Metrics.v2", {"metrics": metrics})]
    if what == "no events":
        data.pop(1)
    return [dict(zip(("topic", "schema", "data"), row)) for row in data], {w["id"]: w for w in made.values()}


def identified():
    w, z = 35.0, 0.5
    a = [[0.0, 1.0], [-w * w, -2 * z * w]]
    space = {"a": a, "b": [[0.0], [1.0]], "c": [[1.0, 0.0]], "d": [[0.0]], "sample_time_s": 0.0,
             "input": "unit impulse", "output": f"acceleration {pulse}, m/s^2"}
    modes = [{"re_per_s": -z * w, "im_rad_per_s": sign * w * math.sqrt(1 - z * z), "natural_frequency_rad_per_s": w,
              "damping_ratio": z} for sign in (1, -1)]
    found = {"method": "mine", "order": 2, "channel": pulse, "treated_as": "free-decay", "from_s": 0.0, "to_s": 0.1,
             "samples": 1000, "singular_values": [], "notes": []}
    step = 1e-4
    what_is = {
        "honest": lambda: None, "no modes": lambda: modes.clear(),
        "two rows": lambda: space.update(b=[[0.0], [1.0], [2.0]]), "ragged": lambda: a[0].append(3.0),
        "of another": lambda: space.update(a=[[0.0, 1.0], [-4 * w * w, -2 * z * w]]),
        "in Hz": lambda: [m.update(natural_frequency_rad_per_s=w / 2 / math.pi) for m in modes],
        "damping": lambda: [m.update(damping_ratio=5.0) for m in modes], "fit": lambda: found.update(fit_percent=250.0),
        "sampled": lambda: space.update(a=[[1.0, step], [-w * w * step, 1 - 2 * z * w * step]]),
        "sign": lambda: [m.update(re_per_s=z * w) for m in modes],
    }
    what_is[what]()
    data = [("/test", "crumple.Test.v1", test), ("/model/mine-2/continuous", "crumple.StateSpace.v1", space),
            ("/modes/mine-2", "crumple.Modes.v2", {"modes": modes}),
            ("/identification/mine-2", "crumple.Identification.v1", found)]
    return [dict(zip(("topic", "schema", "data"), row)) for row in data], {}


def solved():
    events, mass = records["/events"]["data"], test["mass_kg"]
    speed, crush, time = (events[name] for name in
                          ("impact_speed_m_per_s", "dynamic_crush_m", "time_of_dynamic_crush_s"))

    def of(damping):
        root = math.sqrt(1 - damping * damping)
        t = math.atan2(root, damping) / root
        return math.exp(-damping * t) * math.sin(root * t) / root, t

    damping = min((k / 500 for k in range(1, 490)), key=lambda d: abs(of(d)[0] / of(d)[1] / (crush / (speed * time)) - 1))
    w = of(damping)[1] / time
    k, c = mass * w * w, 2 * damping * mass * w
    numbers = {"mass_kg": mass, "stiffness_n_per_m": k, "damping_n_s_per_m": c}
    mine = {"model": "kelvin", "method": "mine", "parameters": numbers, "physical": True, "notes": []}
    name, choice = "kelvin/mine/1", {}
    named = lambda who: choice.update(recommended=who, recommended_because="I say so", simplest=who,
                                      simplest_because="x", closest=who, closest_because="y", candidates=[])
    ends = lambda low, high: mine.update(uncertainty={
        "method": "mine", "standard_deviation": {"stiffness_n_per_m": 0.01 * k},
        "interval_low": {"stiffness_n_per_m": low * k}, "interval_high": {"stiffness_n_per_m": high * k}})
    what_is = {
        "honest": lambda: None, "recommended": lambda: named(name), "interval": lambda: ends(0.9, 1.1),
        "double mass": lambda: numbers.update(mass_kg=2 * mass),
        "in N/mm": lambda: numbers.update(stiffness_n_per_m=k / 1000, damping_n_s_per_m=c / 1000),
        "three times as stiff": lambda: numbers.update(stiffness_n_per_m=3 * k),
        "outside": lambda: ends(1.1, 1.2), "nobody": lambda: named("kelvin/other/1"),
        "other names": lambda: mine.update(parameters={"mass_kg": mass, "k": k, "c": c}),
        "of tomorrow": lambda: mine.update(model="of-tomorrow"),
        "no mass": lambda: numbers.pop("mass_kg"), "no damping": lambda: numbers.pop("damping_n_s_per_m"),
        "negative": lambda: numbers.update(stiffness_n_per_m=-k),
        "recommended of double mass": lambda: (numbers.update(mass_kg=2 * mass), named(name)),
        "recommended in N/mm": lambda: (numbers.update(stiffness_n_per_m=k / 1000), named(name)),
    }
    what_is[what]()
    data = [("/test", "crumple.Test.v1", test), (f"/parameters/{name}", "crumple.Candidate.v1", mine)]
    data += [("/recommendation", "crumple.Recommendation.v1", choice)] if choice else []
    return [dict(zip(("topic", "schema", "data"), row)) for row in data], {}


def changed():
    """The result of the project's own stage, changed."""
    own = pathlib.Path(parent.name, "own.mcap")
    others = ["--speeds", "30km/h"] if what == "other speeds" else []
    subprocess.run([f"crumple-{stage}", *words[: words.index("-o")], "-q", "-o", own, *words[words.index("-o") + 2:],
                    *others], check=True)
    folder = pathlib.Path(parent.name, "own")
    subprocess.run(["crumple-artifact", "unpack", "-q", own, folder], check=True)
    lines = [json.loads(line) for line in (folder / "records.ndjson").read_text().splitlines()]
    if what == "no predictions":
        lines = [line for line in lines if not line["topic"].startswith("/prediction/")]
    for line in lines:
        data = line["data"]
        if line["topic"].startswith("/simulation/") and what == "crush":
            data["dynamic_crush_m"] *= 1.2
        if stage == "simulate" and what == "nobody" and line["topic"].startswith("/simulation/"):
            line["topic"] = "/simulation/of/nobody/1"
            break
        if line["topic"].startswith("/prediction/"):
            if what == "value":
                data["dynamic_crush_m"] *= 3
            if what == "interval":
                for interval in data["intervals"]:
                    interval.update(low=interval["low"] * 2, high=interval["high"] * 2)
            if what == "nobody":
                data["candidate"] = "of/nobody/1"
            if what == "delta-v":
                data.update(delta_v_m_per_s=2 * data["delta_v_m_per_s"], intervals=[])
            if what in ("mass", "mass alone"):
                data["mass_kg"] *= 1.5
            if what == "mass alone":
                data["energy"] = None
            if what == "sure":
                data["extrapolates"] = False
            if what == "falls" and data["impact_speed_m_per_s"] > 16:
                data.update(dynamic_crush_m=data["dynamic_crush_m"] / 2, intervals=[])
            if what == "too far":
                data.update(dynamic_crush_m=1.1 * data["impact_speed_m_per_s"] * data["time_of_dynamic_crush_s"],
                            intervals=[])
            if what == "no speed":
                data["impact_speed_m_per_s"] *= -1
            if what == "more":
                data["dynamic_crush_m"] *= 1.2
                for interval in (i for i in data["intervals"] if i["name"] == "dynamic_crush_m"):
                    interval.update(low=interval["low"] * 1.2, high=interval["high"] * 1.2)
        if what == "own, stiffer" and line["topic"].startswith("/parameters/"):
            numbers = data["parameters"]
            data["uncertainty"] = None
            numbers.update({name: value * 1.5 for name, value in numbers.items() if name.endswith("_n_per_m")})
    (folder / "records.ndjson").write_text("\n".join(map(json.dumps, lines)))
    (folder / "provenance.json").unlink()
    subprocess.run(["crumple-artifact", "pack", "-q", folder, output], check=True)


stage, what = mode.split(":")
if stage in ("simulate", "predict") or what.startswith("own"):
    changed()
    sys.exit()
kept, made = {"filter": filtered, "integrate": integrated, "identify": identified, "parameter-solve": solved}[stage]()
folder = pathlib.Path(parent.name, "made")
(folder / "waves").mkdir(parents=True)
(folder / "records.ndjson").write_text("\n".join(map(json.dumps, kept)))
with open(folder / "waves.ndjson", "w") as lines:
    for number, (name, wave) in enumerate(made.items()):
        samples = array.array("d", wave["x"])
        (folder / f"waves/{number}.f64").write_bytes(samples.tobytes())
        line = {"id": name, "quantity": wave["quantity"], "t0_s": wave["t0_s"], "dt_s": wave["dt_s"],
                "samples": len(samples), "file": f"waves/{number}.f64"}
        lines.write(json.dumps(line) + "\n")
subprocess.run(["crumple-artifact", "pack", "-q", folder, output], check=True)
