#!/usr/bin/env bash
# Guess: a channel read from a file and written to another one holds the same values: its scale is applied once.
# Seen: a channel of values and properties as read is scaled again when the copy is read, without a word; the
#   channel itself handed to the writer makes a file of 16-bit samples that cannot be read (ValueError). Only
#   defragment() keeps the values.
# Version: npTDMS 1.13.0, Python 3.11
# Hurts: cutting or converting a TDMS record multiplies the acceleration by its scale a second time.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
cd "$folder"
python3 -m venv venv
venv/bin/pip install --quiet --disable-pip-version-check --no-compile --only-binary :all: \
  npTDMS==1.13.0 numpy==2.4.6
cat > run.py <<'PY'
from importlib.metadata import version

import numpy as np
from nptdms import ChannelObject, TdmsFile, TdmsWriter

print("npTDMS", version("npTDMS"))
scale = {
    "NI_Scaling_Status": "unscaled",
    "NI_Number_Of_Scales": np.uint32(1),
    "NI_Scale[0]_Scale_Type": "Linear",
    "NI_Scale[0]_Linear_Slope": 0.5,
    "NI_Scale[0]_Linear_Y_Intercept": 1.0,
    "NI_Scale[0]_Linear_Input_Source": np.uint32(0xFFFFFFFF),
}
counts = np.arange(1000, dtype=np.int16)
with TdmsWriter("crash.tdms") as writer:
    writer.write_segment([ChannelObject("test", "accel", counts, properties=scale)])
read = TdmsFile.read("crash.tdms")["test"]["accel"]

with TdmsWriter("values.tdms") as writer:
    writer.write_segment([ChannelObject("test", "accel", read[:], properties=read.properties)])
values = TdmsFile.read("values.tdms")["test"]["accel"][:]

with TdmsWriter("channel.tdms") as writer:
    writer.write_segment([read])
try:
    TdmsFile.read("channel.tdms")
    refused = "no error"
except ValueError as error:
    refused = "ValueError"
    print("channel handed to the writer:", str(error)[:40])

TdmsWriter.defragment("crash.tdms", "whole.tdms")
whole = TdmsFile.read("whole.tdms")["test"]["accel"][:]
print("record:", read[:3], "values and properties written:", values[:3], "defragmented:", whole[:3])
assert np.allclose(read[:], 0.5 * counts + 1), "changed: scale of the record"
assert np.allclose(values, 0.5 * read[:] + 1), "changed: the copy is not scaled twice"
assert refused == "ValueError", "changed: the channel itself can be copied"
assert np.allclose(whole, read[:]), "changed: defragment"
PY
venv/bin/python run.py
