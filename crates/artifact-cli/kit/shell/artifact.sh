# Reads and writes artifacts for stages in shell: `. artifact.sh` unpacks the inputs of the stage.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir "$work/out"
inputs=0
while [ $# -gt 0 ]; do
    case $1 in
        -o) output=$2; shift ;;
        --pipeline) shift ;;
        -*) ;; # flags of the stages of the project
        *)
            inputs=$((inputs + 1))
            crumple artifact unpack --quiet --text "$1" "$work/$inputs"
            sed "s|\"file\":\"|&$work/$inputs/|" "$work/$inputs/waves.ndjson" >> "$work/waves"
            cat "$work/$inputs/records.ndjson" >> "$work/records" ;;
    esac
    shift
done

# refuse MESSAGE: ends the run with exit code 3.
refuse() {
    echo "error: $*" >&2
    exit 3
}

# number_of EXPRESSION: what awk computes of it.
number_of() {
    awk "BEGIN { printf \"%.17g\", ($1) }"
}

# truth EXPRESSION: true or false.
truth() {
    awk "BEGIN { print ($1) ? \"true\" : \"false\" }"
}

# record TOPIC: its line; of several inputs that of the last.
record() {
    grep -F "{\"topic\":\"$1\"," "$work/records" | tail -n 1
}

# number TOPIC NAME: the first number of that name in a record.
number() {
    record "$1" | grep -o "\"$2\":-*[0-9][-+.0-9eE]*" | head -n 1 | cut -d : -f 2 | grep . ||
        refuse "$1 has no $2, which this stage needs"
}

# text TOPIC NAME [DEFAULT]: the first text of that name in a record, the default where there is none.
text() {
    record "$1" | grep -o "\"$2\":\"[^\"]*\"" | head -n 1 | cut -d '"' -f 4 | grep . || echo "${3-}"
}

# topics START: the topics that start so.
topics() {
    cut -d '"' -f 4 "$work/records" | grep "^$1"
}

# waves: the ids of all waveforms.
waves() {
    cut -d '"' -f 4 "$work/waves"
}

# wave ID FIELD: its quantity, t0_s, dt_s, samples, or its file with a number a line.
wave() {
    grep -F "{\"id\":\"$1\"," "$work/waves" | tail -n 1 | grep -o "\"$2\":[^,}]*" | cut -d : -f 2- | tr -d '"' |
        grep . || refuse "there is no waveform $1"
}

# pulse: the id of the crash pulse, else of the only acceleration.
pulse() {
    text /test pulse | grep . ||
        grep '"quantity":"acceleration"' "$work/waves" | head -n 1 | cut -d '"' -f 4
}

# put TOPIC TYPE JSON: a record for the output.
put() {
    printf '{"topic":"%s","schema":"crumple.%s","data":%s}' "$1" "$2" "$3" | tr -d '\n' >> "$work/out/records.ndjson"
    echo >> "$work/out/records.ndjson"
}

# put_wave ID QUANTITY T0 DT FILE: a waveform for the output, samples from a file with a number a line.
put_wave() {
    count=$(wc -l < "$5" | tr -d ' ')
    place=$(ls "$work/out" | wc -l | tr -d ' ').txt
    cp "$5" "$work/out/$place"
    printf '{"id":"%s","quantity":"%s","t0_s":%s,"dt_s":%s,"samples":%s,"file":"%s"}\n' \
        "$1" "$2" "$3" "$4" "$count" "$place" >> "$work/out/waves.ndjson"
}

# pass START: records for the output, unchanged, those whose topics start so.
pass() {
    grep "^{\"topic\":\"$1" "$work/records" >> "$work/out/records.ndjson" || true
}

# finish: writes the output with /test, which every stage passes on.
finish() {
    record /test >> "$work/out/records.ndjson"
    crumple artifact pack --quiet "$work/out" "$output"
}
