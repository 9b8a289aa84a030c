"""Tables and recordings for other programs, read back by them: every value is that of the artifact to the bit."""

import csv
import shutil
import subprocess
from pathlib import Path

import crumple
import numpy as np
import pytest
from crumple._artifact import write
from crumple._program import program

ROOT = Path(__file__).parents[2]
RECORD = ROOT / "fixtures/double/crash.csv"
UNITS = {"m/s^2": "m_per_s2", "m/s": "m_per_s", "m": "m", "N": "n"}


def of_program(*words):
    return subprocess.run([program(), *map(str, words)], check=True, capture_output=True, text=True)


@pytest.fixture(scope="module")
def made():
    return crumple.run(RECORD)


@pytest.fixture(scope="module")
def columns(made):
    """Every waveform of the run by the name of its column: times and samples."""
    found = {}
    for path in sorted(made.folder.glob("[0-9]-*.mcap")):
        for id, wave in crumple.read(path).waves.items():
            body, _, last = id.rpartition("/")
            if last == wave.quantity and body:
                name = f"{body}/{last}_{UNITS[wave.unit]}"
            elif body.endswith("/force"):
                name = f"{body.removesuffix('/force')}/force_{last}_n"
            else:
                name = f"{id}{'/unfiltered' if path.name.startswith('1') else ''}/{wave.quantity}_{UNITS[wave.unit]}"
            found[name] = wave.time, wave.samples
    assert len(found) > 90
    return found


def assert_same(table, columns):
    """`table`: times and, by name, values with NaN where a cell is empty."""
    times, values = table
    assert set(values) == set(columns)
    at = {round(float(time) * 1e9): row for row, time in enumerate(times)}
    assert len(at) == len(times) and (np.diff(times) > 0).all()
    for name, (own, samples) in columns.items():
        rows = [at[round(float(time) * 1e9)] for time in own]
        column = np.asarray(values[name], np.float64)
        assert (column[rows].view(np.int64) == samples.view(np.int64)).all(), name
        assert np.isfinite(column).sum() == len(samples), name


def of_waves(names):
    """Names of tables of waveforms: of the test, of models and predictions, those that begin late."""
    return [name for name in names if name.startswith(("waves", "simulated"))]


def assert_all(tables, columns):
    """The tables, each times and values by name, have all columns, each in one of them."""
    assert sorted(name for _, values in tables for name in values) == sorted(columns)
    for times, values in tables:
        assert_same((times, values), {name: columns[name] for name in values})


def test_csv(made, columns, tmp_path):
    of_program("export", made.folder, "--to", "csv", "-o", tmp_path)
    tables = []
    for table in of_waves(file.stem for file in tmp_path.glob("*.csv")):
        with open(tmp_path / f"{table}.csv", encoding="utf-8", newline="") as file:
            heads, *rows = csv.reader(file)
        cells = np.array([[float(cell or "nan") for cell in row] for row in rows]).T
        tables.append((cells[0], dict(zip(heads[1:], cells[1:]))))
    assert_all(tables, columns)
    of_program("export", made.folder, "--to", "csv", "-o", tmp_path / "again")
    for file in tmp_path.glob("*.csv"):
        assert file.read_bytes() == (tmp_path / "again" / file.name).read_bytes()
    of_program("export", made.folder, "--to", "csv", "-o", tmp_path / "german", "--semicolon", "--what", "waves")
    german = (tmp_path / "german/waves.csv").read_text("utf-8")
    assert german.replace(",", ".").replace(";", ",") == (tmp_path / "waves.csv").read_text("utf-8")
    refused = subprocess.run([program(), "export", str(made.folder), "--to", "csv", "-o", str(tmp_path)], check=False)
    assert refused.returncode == 2


def test_parameters_and_metrics_are_those_of_the_summary(made, tmp_path):
    of_program("export", made.folder, "--to", "csv", "-o", tmp_path)

    def rows(table):
        with open(tmp_path / f"{table}.csv", encoding="utf-8", newline="") as file:
            return list(csv.DictReader(file))

    parameters = {(row["candidate"], row["name"]): float(row["value"]) for row in rows("parameters")}
    expected = {(c["id"], name): value for c in made.candidates for name, value in c["parameters"].items()}
    assert parameters == expected
    assert {row["candidate"] for row in rows("parameters") if row["recommended"] == "true"} == {made.summary["recommended"]}
    channel = made.summary["test"]["channel"]
    metrics = {row["metric"]: row["value"] for row in rows("metrics") if row["channel"] == channel}
    for name, metric in made.summary["metrics"].items():
        assert metric["value"] is None or float(metrics[name]) == metric["value"], name
    crushes = [float(row["dynamic_crush_m"]) for row in rows("predictions")]
    assert crushes == [made_by["dynamic_crush_m"] for made_by in made.summary["predictions"]]


def test_parquet(made, columns, tmp_path):
    pandas, polars, parquet = (pytest.importorskip(name) for name in ("pandas", "polars", "pyarrow.parquet"))
    of_program("export", made.folder, "--to", "parquet", "-o", tmp_path)
    files = [tmp_path / f"{table}.parquet" for table in of_waves(file.stem for file in tmp_path.glob("*.parquet"))]
    for read in (
        pandas.read_parquet,
        lambda file: polars.read_parquet(file).to_pandas(),
        lambda file: parquet.read_table(file).to_pandas(),
    ):
        frames = [read(file) for file in files]
        values = [{name: frame[name].to_numpy(dtype=float) for name in frame.columns[1:]} for frame in frames]
        assert_all([(frame["time_s"].to_numpy(), own) for frame, own in zip(frames, values)], columns)
    units = [parquet.read_schema(file).metadata for file in files]
    assert sum(map(len, units)) == len(columns) + len(files)
    assert [table[b"accel_g/displacement_m"] for table in units if b"accel_g/displacement_m" in table] == [b"m"]


def test_a_workbook(made, columns, tmp_path):
    openpyxl = pytest.importorskip("openpyxl")
    file = tmp_path / "crash.xlsx"
    of_program("export", made.folder, "--to", "xlsx", "-o", file)
    book = openpyxl.load_workbook(file)
    others = [name for name in book.sheetnames if name not in of_waves(book.sheetnames)]
    assert others == ["parameters", "metrics", "predictions", "notes"]
    assert book["waves"].freeze_panes == "A2" and book["waves"]["A1"].font.b
    tables = []
    for table in of_waves(book.sheetnames):
        heads, *rows = book[table].iter_rows(values_only=True)
        cells = np.array([[np.nan if cell is None else cell for cell in row] for row in rows], float).T
        tables.append((cells[0], dict(zip(heads[1:], cells[1:]))))
    assert_all(tables, columns)
    of_program("export", made.folder, "--to", "xlsx", "-o", tmp_path / "again.xlsx")
    assert file.read_bytes() == (tmp_path / "again.xlsx").read_bytes()


def test_libreoffice_opens_the_workbook(made, tmp_path):
    office = shutil.which("soffice")
    if not office:
        pytest.skip("SKIPPED LibreOffice: soffice is not installed")
    file = tmp_path / "crash.xlsx"
    of_program("export", made.folder, "--to", "xlsx", "-o", file, "--what", "parameters")
    of_program("export", made.folder, "--to", "csv", "-o", tmp_path, "--what", "parameters")
    convert = [office, "--headless", "--convert-to", "csv:Text - txt - csv (StarCalc):44,34,76,1,,0,false,true,false,false,false,1"]
    subprocess.run([*convert, "--outdir", str(tmp_path / "office"), str(file)], check=True, capture_output=True)
    read = lambda path: list(csv.reader(path.open(encoding="utf-8", newline="")))
    ours, theirs = read(tmp_path / "parameters.csv"), read(next((tmp_path / "office").glob("*.csv")))
    assert [row[:2] for row in ours] == [row[:2] for row in theirs]
    assert np.allclose([float(row[2]) for row in ours[1:]], [float(row[2]) for row in theirs[1:]], rtol=1e-9)


def messages(file):
    reader = pytest.importorskip("mcap_protobuf.reader")
    return list(reader.read_protobuf_messages(str(file)))


def test_a_recording(made, columns, tmp_path):
    file = tmp_path / "view.mcap"
    of_program("view", made.folder, "-o", file, "--all")
    found, last, topics = {}, 0, {}
    for message in messages(file):
        assert message.log_time_ns == message.publish_time_ns >= last
        last = message.log_time_ns
        topics.setdefault(message.topic, []).append(message)
    for name, (times, samples) in columns.items():
        body, _, field = name.rpartition("/")
        candidate, _, mass = body.rpartition("/m")
        body = f"{candidate}/mass{mass}" if mass.isdigit() else body
        if name.startswith("prediction/"):
            topic = next(topic for topic in topics if topic.startswith(f"/prediction/{body.split('/')[1]}_at_"))
        elif name.startswith("accel_g"):
            topic = f"/test/{body}"
        else:
            topic = f"/model/{body}"
        if not topics[topic][0].proto_msg.DESCRIPTOR.fields_by_name.get(field):
            topic = next(other for other in topics if other.startswith(f"{topic}/") and other.count("/") == topic.count("/") + 1)
        own = [m for m in topics[topic] if m.proto_msg.HasField(field)]
        values = np.array([getattr(m.proto_msg, field) for m in own])
        assert (values.view(np.int64) == samples.view(np.int64)).all(), name
        clock = [m.log_time_ns - 10**9 for m in own]
        assert np.abs(np.array(clock) - np.round(times * 1e9)).max() <= 1, name
    events = {m.proto_msg.name: m.proto_msg for m in topics["/event"]}
    crush = made.summary["events"]["dynamic_crush_m"]
    assert events["dynamic crush"].value == crush and events["dynamic crush"].unit == "m"
    (summary,) = topics["/summary"]
    assert summary.proto_msg.recommended == made.summary["recommended"]
    of_program("view", made.folder, "-o", tmp_path / "again.mcap", "--all")
    assert file.read_bytes() == (tmp_path / "again.mcap").read_bytes()
    assert file.stat().st_size < 5_000_000


def test_a_thinned_recording_keeps_its_peaks(tmp_path):
    """A million samples of noise are above 5 MB."""
    rng = np.random.default_rng(1)
    samples = rng.normal(size=1_000_000)
    samples[654_321] = -321.0
    made = crumple.run(RECORD)
    shutil.copytree(made.folder, tmp_path / "run")
    stage = crumple.read(tmp_path / "run/1-ingest.mcap")
    wave = crumple.Wave(samples, 1e-4, 0.0, "acceleration")
    write(tmp_path / "run/1-ingest.mcap", crumple.Artifact(stage.records, {"long": wave}))
    file = tmp_path / "view.mcap"
    of_program("view", tmp_path / "run", "-o", file)
    assert file.stat().st_size < 5_000_000
    own = [m for m in messages(file) if m.topic == "/test/long/unfiltered"]
    lowest = min(own, key=lambda m: m.proto_msg.acceleration_m_per_s2)
    assert (lowest.proto_msg.acceleration_m_per_s2, len(own) < 300_000) == (-321.0, True)


def test_rerun_converts_the_recording(made, tmp_path):
    rerun = shutil.which("rerun")
    if not rerun:
        pytest.skip("SKIPPED Rerun: rerun is not installed")
    of_program("view", made.folder, "-o", tmp_path / "view.mcap")
    subprocess.run([rerun, "mcap", "convert", str(tmp_path / "view.mcap"), "-o", str(tmp_path / "view.rrd")], check=True)
    assert (tmp_path / "view.rrd").stat().st_size > 100_000
