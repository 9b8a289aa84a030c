"""As people use it in a notebook: arrays and tables in, figures and tables out, units stated or refused."""

from pathlib import Path

import crumple
import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
RECORD = ROOT / "fixtures/elastoplastic/crash.csv"
STATED = {"mass": "1000 kg", "impact_speed": "50 km/h"}


def columns():
    rows = [line for line in RECORD.read_text("utf-8").splitlines() if line and not line.startswith("#")]
    names = rows[0].split(",")
    return names, np.array([[float(one) for one in row.split(",")] for row in rows[1:]])


@pytest.fixture(scope="module")
def made():
    return crumple.run(RECORD)


def test_an_array_is_a_record(tmp_path):
    names, rows = columns()
    time, a = rows[:, 0], rows[:, 1]
    unit = names[1].rsplit("_", 1)[1]
    dt = float(np.diff(time).mean())
    of_file = tmp_path / "crash.csv"
    of_file.write_text("time_s,a_g\n" + "".join(f"{k * dt!r},{one!r}\n" for k, one in enumerate(a.tolist())), "utf-8")
    by_file = crumple.run(of_file, **STATED)
    by_array = crumple.run(a, dt=dt, unit=unit, **STATED)
    assert by_array.summary["events"]["dynamic_crush_m"] == by_file.summary["events"]["dynamic_crush_m"]
    by_list = crumple.run(a.tolist(), dt=dt, unit=unit, **STATED)
    assert by_list.summary["key_numbers"] == by_array.summary["key_numbers"]


def test_an_array_states_its_unit_and_its_step():
    a = np.zeros(100)
    with pytest.raises(crumple.Usage, match="does not state its unit\n.*unit=\"g\""):
        crumple.run(a, dt=1e-4)
    with pytest.raises(crumple.Usage, match="does not state its dt"):
        crumple.run(a, unit="g")
    with pytest.raises(crumple.Usage, match="dt is of an array"):
        crumple.run(RECORD, dt=1e-4)
    with pytest.raises(crumple.Refused, match="nan"):
        crumple.run([0.0, float("nan"), 1.0], dt=1e-4, unit="g")


def test_a_table_of_pandas_is_a_record(made):
    pandas = pytest.importorskip("pandas")
    names, rows = columns()
    frame = pandas.DataFrame(rows, columns=names)
    crush = made.summary["events"]["dynamic_crush_m"]
    stated = {"mass": made.summary["test"]["mass_kg"], "impact_speed": made.summary["test"]["impact_speed_m_per_s"]}
    for given in (frame, frame.set_index(names[0]), frame.set_index(names[0])[names[1]]):
        assert crumple.run(given, **stated).summary["events"]["dynamic_crush_m"] == pytest.approx(crush, rel=1e-12)
    timed = frame.set_index(pandas.to_timedelta(frame[names[0]], unit="s"))[[names[1]]]
    # Nanoseconds of a timedelta.
    assert crumple.run(timed, **stated).summary["events"]["dynamic_crush_m"] == pytest.approx(crush, rel=1e-6)
    with pytest.raises(crumple.Usage, match="the series has no time"):
        crumple.run(frame[names[1]], **stated)
    assert len(frame.columns) == len(names), "what is given stays as it is"


def test_an_acceleration_in_g_is_refused_as_m_per_s2():
    t = np.arange(2000) * 1e-4
    kelvin = {"mass_kg": 1000.0, "stiffness_n_per_m": 5e5, "damping_n_s_per_m": 1e4}
    a = crumple.simulate("kelvin", kelvin, v0=14, t=t).acceleration
    in_g = a / 9.80665
    with pytest.raises(crumple.Refused, match="in g it would be .*\n.*unit=\"g\""):
        crumple.fit("kelvin", in_g, 1e-4, mass=1000, v0=14)
    with pytest.raises(crumple.Refused, match="in g it would be"):
        crumple.crush(in_g, 1e-4, 14)
    found = crumple.fit("kelvin", in_g, 1e-4, mass=1000, v0=14, unit="g")
    assert found.parameters["stiffness_n_per_m"] == pytest.approx(5e5, rel=1e-3)
    # Stated, it is taken as it is: half of a pulse may have lost little speed.
    assert crumple.crush(in_g, 1e-4, 14, unit="m/s^2").displacement.max() > 1
    with pytest.raises(crumple.Usage, match="expected 'm/s\\^2' or 'g'"):
        crumple.crush(a, 1e-4, 14, unit="ft")


def test_what_a_prompt_shows_has_three_lines(made):
    shown = [made, made.remarks, made.predict(["40 km/h", 20.0]), made.recommended, made.wave("accel_g"),
             crumple.read(made.folder / "3-integrate.mcap"), crumple.era(np.exp(-np.arange(400) * 5e-3), 1e-3, order=1),
             crumple.crush(np.full(1000, -140.0), 1e-4, 14)]
    for one in shown:
        lines = repr(one).splitlines()
        assert 1 <= len(lines) <= 3 and all(len(line) <= 100 for line in lines), repr(one)
    assert "crush 497 mm" in repr(made.predict("40 km/h"))


def test_a_run_predicts_and_shows_tables(made):
    predicted = made.predict(speed="40 km/h", mass="1500 kg")
    assert predicted == crumple.predict(made, "40 km/h", mass="1500 kg")
    assert predicted[0].mass_kg == 1500
    for one in (made, made.remarks, predicted, made.recommended):
        html = one._repr_html_()
        assert "<table>" in html and html.count("<tr>") > 0
    pandas = pytest.importorskip("pandas")
    table = predicted.table()
    assert isinstance(table, pandas.DataFrame)
    assert (table["low"] < table["dynamic_crush_m"]).all() and (table["dynamic_crush_m"] < table["high"]).all()


def test_a_run_is_drawn(made, tmp_path):
    pytest.importorskip("matplotlib")
    figure = made.plot()
    pulse, force, predictions = figure.axes
    assert [line.get_label() for line in pulse.lines] == ["test", "model"]
    # The wave of the artifact, thousandths of a millisecond apart.
    crush = 1e3 * made.summary["events"]["dynamic_crush_m"]
    assert max(force.lines[0].get_xdata()) == pytest.approx(crush, rel=1e-3)
    assert len(predictions.lines) > 1
    figure.savefig(tmp_path / "run.png")
    assert (tmp_path / "run.png").stat().st_size > 10_000
