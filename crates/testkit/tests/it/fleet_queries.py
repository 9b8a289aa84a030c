"""Runs the examples of docs/fleet.md on the tables of a fleet: `fleet_queries.py PAGE FOLDER`."""

import os
import re
import sys

import duckdb
import polars

page, folder = sys.argv[1:]
text = open(page, encoding="utf-8").read()
blocks = dict(re.findall(r"```\w+ (duckdb|polars)\n(.*?)```", text, re.S))
os.chdir(folder)

rows = duckdb.sql(blocks["duckdb"]).fetchall()
assert rows, "the example for DuckDB finds nothing"
for vehicle, mass_kg, km_per_h, model, fit_percent in rows:
    assert "MADE" in vehicle and 900 < mass_kg < 3000, (vehicle, mass_kg)
    assert min(abs(km_per_h - speed) for speed in (40, 56)) < 1e-9, km_per_h
    assert fit_percent <= 100, (model, fit_percent)

names = {}
exec(blocks["polars"], names)
by_speed = names["by_speed"]
assert by_speed["impact_speed_m_per_s"].to_list() == [11.1, 15.6], by_speed
assert by_speed["dynamic_crush_m"].is_sorted(), "a faster impact crushes more"

# Each table says the same as Parquet and as CSV, in the same order.
for table in ("tests", "candidates", "metrics", "predictions"):
    parquet = polars.read_parquet(f"{table}.parquet")
    csv = polars.read_csv(f"{table}.csv", schema=parquet.schema).with_columns(polars.col("settings").fill_null(""))
    assert parquet.height > 0 and parquet.equals(csv), table
print(f"{len(rows)} rows")
