"""The package beside the program: the same numbers to the bit, errors by their kind, arrays, threads, interruption."""

import json
import os
import pickle
import signal
import subprocess
import sys
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import crumple
import numpy as np
import pytest
from crumple._program import program

ROOT = Path(__file__).parents[2]
RECORD = ROOT / "fixtures/elastoplastic/crash.csv"
KELVIN = {"mass_kg": 1000.0, "stiffness_n_per_m": 5e5, "damping_n_s_per_m": 1e4}
DT = 1e-4


@pytest.fixture(scope="module")
def made():
    return crumple.run(RECORD)


def of_program(*words):
    return subprocess.run([program(), *map(str, words)], check=True, capture_output=True, text=True).stdout


def oscillator(samples=800):
    """Input and output of y[k] = 1.6 y[k-1] - 0.8 y[k-2] + u[k-1], and its poles, 1/s."""
    u = np.random.default_rng(1).normal(size=samples)
    y = np.zeros(samples)
    for k in range(2, samples):
        y[k] = 1.6 * y[k - 1] - 0.8 * y[k - 2] + u[k - 1]
    return u, y, np.sort_complex(np.log(np.roots([1, -1.6, 0.8])) / DT)


def test_a_run_is_that_of_the_program(made, tmp_path):
    of_program("run", "--out", tmp_path / "by-program", RECORD)
    assert crumple.diff(made, tmp_path / "by-program")["same"]
    assert made.summary == json.loads((tmp_path / "by-program/summary.json").read_text("utf-8"))
    assert made.verdict.splitlines()[0] == made.summary["verdict"]["status_sentence"]
    assert made.recommended.id == made.summary["recommended"]
    assert [one.id for one in made.candidates] == [one["id"] for one in made.summary["candidates"]]
    assert pickle.loads(pickle.dumps(made.recommended)) == made.recommended
    assert made.summary["verdict"]["status"] in made._repr_html_()


def test_what_a_run_says_is_a_value(made):
    assert made.record in ("sound", "check", "wrong")
    assert all("kind" in one for one in made.good_for)
    codes = [one.code for one in made.remarks]
    assert codes and all(code.startswith("CR") for code in codes)
    weights = [one.weight for one in made.remarks]
    assert weights[-1] == 0, "what is good to know comes last"
    assert made.remarks[0].code in made.remarks._repr_html_()
    pandas = pytest.importorskip("pandas")
    table = made.remarks.table()
    assert isinstance(table, pandas.DataFrame) and list(table["code"]) == codes


def test_waves_are_those_of_the_artifacts(made, tmp_path):
    of_program("artifact", "unpack", made.folder / "3-integrate.mcap", tmp_path / "plain")
    for line in (tmp_path / "plain/waves.ndjson").read_text("utf-8").splitlines():
        stated = json.loads(line)
        wave = made.wave(stated["id"])
        assert wave.samples.tobytes() == (tmp_path / "plain" / stated["file"]).read_bytes()
        assert (wave.t0, wave.dt, wave.quantity) == (stated["t0_s"], stated["dt_s"], stated["quantity"])
        assert wave.time[7] == wave.t0 + 7 * wave.dt
    with pytest.raises(ValueError):
        made.wave("accel_g").samples[0] = 0
    with pytest.raises(crumple.Usage, match="nearest are accel_g/displacement"):
        made.wave("accel_g/displacment")


def test_a_table_has_the_motion_of_the_pulse(made):
    pandas = pytest.importorskip("pandas")
    table = made.table()
    assert isinstance(table, pandas.DataFrame)
    assert table["accel_g/displacement"].max() == made.wave("accel_g/displacement").samples.max()
    assert table.attrs["units"] == {"accel_g": "m/s^2", "accel_g/velocity": "m/s", "accel_g/displacement": "m"}


def test_what_is_written_is_read_again(made, tmp_path):
    artifact = crumple.read(made.folder / "3-integrate.mcap")
    long = crumple.Wave(np.arange(200_000.0), DT, -0.25, "force")
    crumple.write(tmp_path / "a.mcap", artifact | crumple.Artifact(waves={"long": long}))
    of_program("artifact", "check", tmp_path / "a.mcap")
    again = crumple.read(tmp_path / "a.mcap")
    assert again.records == artifact.records
    assert [again.records[topic].schema for topic in artifact.records] == [r.schema for r in artifact.records.values()]
    assert (again.waves["long"].samples == long.samples).all() and again.waves["long"].t0 == -0.25
    assert all((again.waves[id].samples == wave.samples).all() for id, wave in artifact.waves.items())


def test_predictions_are_those_of_the_run(made):
    of_run = made.summary["predictions"]
    speeds = [one["impact_speed_m_per_s"] for one in of_run if one["recommended"]]
    before = sorted((path, path.stat().st_mtime_ns) for path in made.folder.iterdir())
    assert crumple.predict(made, speeds) == of_run
    assert crumple.predict(made, np.array([12.0]), mass=1500)[0].mass_kg == 1500
    assert sorted((path, path.stat().st_mtime_ns) for path in made.folder.iterdir()) == before


def test_options_reach_the_stages(tmp_path):
    kept = crumple.run(RECORD, set={"filter.cfc": 180}, pipeline={"title": "Mine", "filter": {"cfc": "60"}},
                       mass=1500, impact_speed="54 km/h", out=tmp_path / "kept")
    assert kept.folder == tmp_path / "kept"
    test = kept.summary["test"]
    assert (test["mass_kg"], test["impact_speed_m_per_s"]) == (1500, 15)
    assert crumple.read(kept.folder / "2-filter.mcap").records["/filter/accel_g"].cfc == 180
    assert crumple.open_run(kept.folder).summary == kept.summary


def test_several_tests_have_one_model(tmp_path):
    for name, speed in (("a", "56 km/h"), ("b", "50 km/h")):
        text = RECORD.read_text("utf-8").replace("# impact speed: 56 km/h", f"# impact speed: {speed}")
        (tmp_path / f"{name}.csv").write_text(text, "utf-8")
    joint = crumple.together([tmp_path / "a.csv", crumple.run(tmp_path / "b.csv", out=tmp_path / "b")])
    assert [one["name"] for one in joint.summary["tests"]] == ["a", "b"]
    assert joint.report.is_file() and joint.verdict


def test_a_temporary_folder_lives_as_long_as_its_run(tmp_path):
    run = crumple.run(RECORD)
    folder, saved = run.folder, run.save(tmp_path / "kept")
    del run
    assert not folder.parent.exists() and saved.report.is_file()


def test_filters_as_the_stage(made):
    run = crumple.run(RECORD, set={"filter.zero_level": "none"})
    files = ("1-ingest.mcap", "2-filter.mcap")
    measured, filtered = (crumple.read(run.folder / file).waves["accel_g"] for file in files)
    assert (crumple.filter_cfc(measured.samples, measured.dt) == filtered.samples).all()
    by_class = crumple.filter_cfc(measured.samples, measured.dt, 180, mode="sae_reflect")
    assert np.abs(by_class - filtered.samples).max() > 0


def test_a_simulated_model_is_that_of_the_run(made):
    wave = made.wave("kelvin/closed-form/1/displacement")
    kelvin = next(one for one in made.candidates if one.id == "kelvin/closed-form/1")
    after = wave.samples[wave.time >= 0]
    speed = made.summary["test"]["impact_speed_m_per_s"]
    motion = crumple.simulate("kelvin", kelvin.parameters, v0=speed, t=np.arange(len(after)) * wave.dt)
    assert (motion.displacement == after).all()


def test_a_model_is_fitted_to_its_own_motion():
    motion = crumple.simulate("kelvin", KELVIN, v0=14, t=np.arange(2000) * DT)
    fitted = crumple.fit("kelvin", motion.acceleration, DT, mass=1000, v0=14)
    # The trapezoidal rule is off by (w dt)^2/12 = 4e-7 at w = 22 rad/s; parameters are by a few times that. In time T
    # it is off by dt^2/12 times the change of the slope of a, 11,000 m/s^3 at most, times T = 0.2 s.
    assert fitted.parameters == pytest.approx(KELVIN, rel=1e-5)
    integrated = crumple.crush(motion.acceleration, DT, 14.0, mass=1000)
    assert integrated.record.dynamic_crush_m == pytest.approx(motion.record.dynamic_crush_m, rel=1e-6)
    assert np.abs(integrated.displacement - motion.displacement).max() < DT**2 / 12 * 11_000 * 0.2


def test_known_systems_come_back():
    u, y, poles = oscillator()
    for model in (crumple.n4sid(u, y, DT, order=2), crumple.arx(u, y, DT, (2, 1, 1)), crumple.okid(u, y, DT, order=2)):
        assert np.sort_complex(model.poles) == pytest.approx(poles, rel=1e-6), model.id
        assert model.fit > 99.999 and model.a.shape == (2, 2) and model.dt == DT
        assert np.sort_complex(np.log(np.linalg.eigvals(model.a)) / DT) == pytest.approx(poles, rel=1e-6)
    t = np.arange(400) * 1e-3
    for model in (crumple.era(np.exp(-5 * t) * np.sin(60 * t), 1e-3, order=n) for n in (2, None)):
        assert np.sort_complex(model.poles) == pytest.approx([-5 - 60j, -5 + 60j], rel=1e-6)
    # 1/(s^2 + 10 s + 3600), its input held between samples of 1 ms.
    rates, shapes = np.linalg.eig(np.array([[0, 1], [-3600, -10]]))
    step = (shapes * np.exp(rates * 1e-3) @ np.linalg.inv(shapes)).real
    u, state, y = u[:400], np.zeros(2), []
    for held in u:
        y.append(state[0])
        state = step @ (state - [held / 3600, 0]) + [held / 3600, 0]
    model = crumple.tfest(u, y, 1e-3, poles=2, zeros=0, hold="zero-order")
    assert model.denominator == pytest.approx([1, 10, 3600], rel=1e-6) and model.dt == 0
    assert model.numerator == pytest.approx([1], rel=1e-6)


@pytest.mark.parametrize(("values", "said"), [
    ([1.0, 2.0, np.nan, 4.0], r"a\[2\] is nan"),
    (np.zeros((40, 2)), r"2 dimensions, expected one\n  hint: a\[:, 0\]"),
    (np.zeros(40, complex), "holds complex128"),
    (np.array([1, None, 2]), "holds object"),
    (np.zeros(40, "datetime64[s]"), "holds datetime64"),
    (np.ma.masked_array(np.zeros(40), [True] + [False] * 39), "masked values"),
    ([1.0], "1 values"),
])
def test_arrays_without_meaning_are_refused(values, said):
    with pytest.raises(crumple.Refused, match=said):
        crumple.filter_cfc(values, DT)


def test_arrays_of_any_layout_are_taken():
    a = np.sin(np.arange(400) / 20)
    filtered = crumple.filter_cfc(a, DT)
    for same in (list(a), np.repeat(a, 2)[::2], a.astype(">f8")):
        assert (crumple.filter_cfc(same, DT) == filtered).all()
    assert np.abs(crumple.filter_cfc(a.astype("f4"), DT) - filtered).max() < 1e-6


def test_errors_have_their_kind_and_the_text_of_the_program(tmp_path):
    words = [program(), "run", "--out", str(tmp_path / "out"), str(tmp_path / "none.csv")]
    with pytest.raises(crumple.Refused) as refused:
        crumple.run(tmp_path / "none.csv")
    assert str(refused.value) == subprocess.run(words, capture_output=True, text=True).stderr.strip()
    assert refused.value.exit_code == 3 and isinstance(refused.value, ValueError)
    assert pickle.loads(pickle.dumps(refused.value)).args == refused.value.args
    with pytest.raises(crumple.Usage, match="channel frequency class"):
        crumple.filter_cfc(np.zeros(40), DT, 77)
    for mass in (True, float("nan"), float("inf"), -1, 0, [1]):
        with pytest.raises(crumple.Usage, match="expected a positive number"):
            crumple.run(RECORD, mass=mass)
    with pytest.raises(crumple.Usage, match="no unit"):
        crumple.run(RECORD, mass="1200")
    flat = tmp_path / "flat.csv"
    rows = "".join(f"{k / 1000},0\n" for k in range(-60, 200))
    flat.write_text("# mass: 1200 kg\n# impact speed: 50 km/h\ntime_s,accel_g\n" + rows, "utf-8")
    with pytest.raises(crumple.NoResult) as nothing:
        crumple.run(flat)
    assert nothing.value.exit_code == 4 and nothing.value.run.report.is_file()
    first = nothing.value.run.remarks[0]
    said = str(nothing.value).splitlines()
    assert said[0] == nothing.value.run.verdict.splitlines()[0] and f"[{first.code}]" in said[1]
    whole = (tmp_path / "whole.mcap", tmp_path / "half.mcap")
    crumple.write(whole[0], crumple.Artifact(waves={"a": crumple.Wave(np.zeros(400), DT)}))
    whole[1].write_bytes(whole[0].read_bytes()[:-100])
    for damaged in (whole[1], tmp_path / "none.mcap", RECORD):
        with pytest.raises(crumple.Refused):
            crumple.read(damaged)


def test_two_columns_are_time_and_acceleration():
    rows = [line.split(",")[:2] for line in RECORD.read_text("utf-8").splitlines() if line[:1] in "-0123456789"]
    table = np.array(rows, float)
    known = {"unit": "g", "mass": 1200, "impact_speed": "50 km/h"}
    by_step = crumple.run(table[:, 1], dt=table[1, 0] - table[0, 0], time_zero=f"{-table[0, 0]}s", **known)
    by_column = crumple.run(table, **known)
    crush = [run.summary["events"]["dynamic_crush_m"] for run in (by_step, by_column)]
    assert crush[0] == pytest.approx(crush[1], rel=1e-6)
    with pytest.raises(crumple.Usage, match="does not rise"):
        crumple.run(table[::-1], **known)


def test_a_simulation_beside_its_test_and_speed_from_damage(tmp_path):
    run = crumple.run(RECORD, out=tmp_path / "test")
    equal = crumple.compare(run, run.save(tmp_path / "copy"), require=["crush<=1mm"], page=tmp_path / "page.html")
    [one] = equal["simulations"]
    assert one["decision"] == "equal" and one["required"][0]["held"] and (tmp_path / "page.html").is_file()
    found = crumple.damage(test="1400kg,56km/h,48cm,150cm", profile="10,25,38,40,31,12cm", width="150cm", mass="1400kg")
    assert found["vehicle"]["damage"]["equivalent_barrier_speed_m_per_s"] > 5


def test_names_with_spaces_and_umlauts(tmp_path):
    record = tmp_path / "Prüfung 1 – links.csv"
    record.write_bytes(RECORD.read_bytes())
    assert crumple.run(record, out=tmp_path / "Läufe hier").report.is_file()


def test_runs_side_by_side(made):
    with ThreadPoolExecutor(4) as pool:
        runs = list(pool.map(crumple.run, [RECORD] * 4))
    assert all(run.summary == made.summary for run in runs)


@pytest.mark.skipif(sys.platform == "win32", reason="signals")
def test_an_interruption_ends_the_program_and_removes_its_folder(tmp_path):
    lines = ("import crumple", "import numpy as np", "u = np.random.default_rng(1).normal(size=4000)",
             "crumple.tfest(u, np.cumsum(u), 1e-4, poles=6, zeros=4, bootstrap=100000)")
    scratch = {**os.environ, "TMPDIR": str(tmp_path)}
    child = subprocess.Popen([sys.executable, "-c", "\n".join(lines)], env=scratch, stderr=subprocess.PIPE, text=True)
    while not list(tmp_path.glob("*/array.mcap")) and child.poll() is None:
        time.sleep(0.02)
    time.sleep(0.5)
    child.send_signal(signal.SIGINT)
    assert "KeyboardInterrupt" in child.communicate(timeout=20)[1]
    assert not list(tmp_path.iterdir())


def test_it_starts_quietly_and_fast():
    lines = ("import time", "import numpy, sys, subprocess, tempfile, sysconfig", "before = time.perf_counter()",
             "import crumple", "print(time.perf_counter() - before)", "assert 'pandas' not in sys.modules")
    shown = subprocess.run([sys.executable, "-W", "error", "-c", "\n".join(lines)], capture_output=True, text=True)
    assert shown.stderr == "" and float(shown.stdout) < 0.1


@pytest.mark.skipif("CRUMPLE_WHEEL" not in os.environ, reason="installed by hand")
def test_the_wheel_is_small():
    assert Path(os.environ["CRUMPLE_WHEEL"]).stat().st_size <= 15_000_000
