#!/bin/sh
# Runs a record with this stage in its place of the chain, into run/ beside this file, and checks what the stage wrote.
# sh test.sh RECORD
set -eu
here=$(cd "$(dirname "$0")" && pwd)
CRUMPLE_STAGE="COMMAND '$here/stage.ENDING'" crumple run "${1:?name a record: sh test.sh RECORD}" -o "$here/run"
crumple check "$here/run/OUTPUT"
