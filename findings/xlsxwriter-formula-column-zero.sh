#!/usr/bin/env bash
# Guess: a column computed by formulas, read before any spreadsheet program has opened the file, is empty.
# Seen: XlsxWriter stores 0 as the result of each formula, so readers of values find a column of zeros; written
#   again by openpyxl the same formulas read as empty.
# Version: XlsxWriter 3.3.1, openpyxl 3.1.5, python-calamine 0.9.1, Python 3.11
# Hurts: an acceleration in m/s^2 computed from a column in g is a valid record of a test in which nothing
#   happens.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  xlsxwriter==3.3.1 openpyxl==3.1.5 python-calamine==0.9.1 pandas==2.2.3 numpy==2.4.6
cat > run.py <<'PY'
from importlib.metadata import version

import openpyxl
import pandas as pd
import xlsxwriter

print([f"{name} {version(name)}" for name in ("xlsxwriter", "openpyxl", "python-calamine")])
book = xlsxwriter.Workbook("made.xlsx")
sheet = book.add_worksheet("Data")
sheet.write_row(0, 0, ["time (s)", "raw (g)", "accel (m/s2)"])
for row in range(1, 61):
    sheet.write(row, 0, row * 1e-4)
    sheet.write(row, 1, -float(row))
    sheet.write_formula(row, 2, f"=B{row + 1}*9.80665")
book.close()
openpyxl.load_workbook("made.xlsx").save("again.xlsx")
seen = {}
for path in ("made.xlsx", "again.xlsx"):
    for engine in ("openpyxl", "calamine"):
        column = pd.read_excel(path, engine=engine)["accel (m/s2)"]
        seen[path, engine] = (int((column == 0).sum()), int(column.isna().sum()))
        print(path, "read by", engine, "zeros, empty:", seen[path, engine])
assert all(v == (60, 0) for k, v in seen.items() if k[0] == "made.xlsx"), "changed: results of XlsxWriter"
assert all(v == (0, 60) for k, v in seen.items() if k[0] == "again.xlsx"), "changed: results of openpyxl"
PY
venv/bin/python run.py
