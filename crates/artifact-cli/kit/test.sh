#!/bin/sh
# Runs a record with this stage in its place of the chain and checks what it wrote: sh test.sh RECORD
set -eu
here=$(cd "$(dirname "$0")" && pwd)
runs=$(mktemp -d)
trap 'rm -rf "$runs"' EXIT
CRUMPLE_STAGE="COMMAND '$here/stage.ENDING'" crumple run "${1:?name a record: sh test.sh RECORD}" -o "$runs/run"
crumple check "$runs/run/OUTPUT"
