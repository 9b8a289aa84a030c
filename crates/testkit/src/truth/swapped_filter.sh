# A filter stage that is not the product's: it hands the pulse on and leaves no record of how it was filtered.
# sh swapped_filter.sh BIN INPUT -o OUTPUT [flags of crumple-filter]
set -eu
bin=$1
shift
"$bin/crumple-filter" "$@"
while [ "$1" != -o ]; do shift; done
plain="$2.plain"
rm -rf "$plain"
"$bin/crumple-artifact" unpack "$2" "$plain" >/dev/null 2>&1
grep -v '"topic": *"/filter' "$plain/records.ndjson" >"$plain/left.ndjson"
mv "$plain/left.ndjson" "$plain/records.ndjson"
rm "$2"
"$bin/crumple-artifact" pack "$plain" "$2" >/dev/null 2>&1
rm -rf "$plain"
