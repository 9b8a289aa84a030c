#!/bin/sh
# Runs a record with this stage in its place of the chain, into run/ beside this file, and checks what was written.
# sh test.sh RECORD
set -eu
here=$(cd "$(dirname "$0")" && pwd)
crumple run "${1:?name a record: sh test.sh RECORD}" --stage NAME="COMMAND '$here/stage.ENDING'" -o "$here/run"
crumple check "$here/run"
