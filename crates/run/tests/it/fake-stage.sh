#!/bin/sh
# A stage for tests: copies its first input to its output, as the stages of the project write theirs; the report has a
# summary beside it. fake-stage.sh INPUT... --pipeline FILE -o OUTPUT [--dependent FILE]...
set -eu
previous=
for word; do
    if [ "$word" = --check-options ]; then
        for flag; do if [ "$flag" = --wrong ]; then echo "error: unexpected --wrong" >&2; exit 2; fi; done
        exit 0
    fi
    if [ "$previous" = -o ]; then output=$word; fi
    previous=$word
done
name=${output##*/}
# With a log, it notes its start there, and leaves alone what is up to date.
if [ -n "${STARTED-}" ]; then
    echo "$name" >> "$STARTED"
    if [ "$name" != report.html ] && cmp -s "$1" "$output"; then exit 0; fi
fi
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
