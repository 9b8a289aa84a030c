#!/bin/sh
# A stage for tests: copies its first input to its output, as the stages of the project write theirs; the report has a
# summary beside it. fake-stage.sh INPUT... --pipeline FILE -o OUTPUT [--dependent FILE]...
set -eu
previous=
for word; do
    if [ "$previous" = -o ]; then output=$word; fi
    previous=$word
done
name=${output##*/}
folder=${output%/*}
cp "$1" "$folder/.$name.$$.tmp"
if [ "$name" = report.html ]; then
    cp "$1" "$folder/.summary.json.$$.tmp"
    rm -f "$output" "$folder/summary.json"
fi
for word; do
    if [ "$previous" = --dependent ]; then rm -f "$word"; fi
    previous=$word
done
mv "$folder/.$name.$$.tmp" "$output"
if [ "$name" = report.html ]; then mv "$folder/.summary.json.$$.tmp" "$folder/summary.json"; fi
