# Crumple: a crash pulse in, a physical model out. `just` alone lists the recipes.

set positional-arguments
set shell := ["bash", "-euc"]

# Pipeline: a file below pipelines/ without its ending, e.g. `just pipeline=papers/civic run crash.csv`, or the path of a file elsewhere, e.g. `./my.toml`.
pipeline := "default"
# Run folder; empty: runs/<input stem>/<pipeline>.
out := ""
# Flags for every stage, e.g. `just flags="-q --force" run crash.csv`.
flags := ""
# Where the binaries are.
bin := env("CARGO_TARGET_DIR", justfile_directory() / "target") / "release"

# Any stage can be any program that follows docs/format.md, e.g. `just identify="python3 my_stage.py" run crash.csv`.
ingest := bin / "crumple-ingest"
filter := bin / "crumple-filter"
integrate := bin / "crumple-integrate"
identify := bin / "crumple-identify"
parameter_solve := bin / "crumple-parameter-solve"
simulate := bin / "crumple-simulate"
report := bin / "crumple-report"

[private]
default:
    @just --list --unsorted

# The main job: `just run crash.csv [--mass 873kg --impact-speed 35km/h ...]`; flags go to ingest.
[group('pipeline')]
[no-cd]
[no-exit-message]
run input *args: build
    #!/usr/bin/env bash
    set -euo pipefail
    case "$1" in -*) echo "error: the record comes first: just run RECORD [flags of crumple-ingest]" >&2; exit 2;; esac
    # What ingest prints about itself or the record ends the run.
    for flag in "${@:2}"; do
        case "$flag" in -h|--help|-V|--version|--list) exec {{ ingest }} "$@";; esac
    done
    there() { command -v -- "$1" >/dev/null || { echo "error: $1: no such program; nothing was run" >&2; exit 2; }; }
    there {{ ingest }}; there {{ filter }}; there {{ integrate }}; there {{ identify }}
    there {{ parameter_solve }}; there {{ simulate }}; there {{ report }}
    # The path of a file is that file, all else a name below pipelines/.
    pipeline={{ quote(pipeline) }}
    name=${pipeline#pipelines/} name=${name%.toml}
    if [[ "$pipeline" == [/.]* || ( "$pipeline" == *.toml && -f "$pipeline" ) ]]; then
        [[ "$pipeline" == pipelines/* ]] || name=$(basename "$name")
    else
        pipeline={{ quote(justfile_directory()) }}/pipelines/$name.toml
    fi
    dir={{ quote(out) }}
    [ -n "$dir" ] || dir={{ quote(justfile_directory() / "runs" / file_stem(trim_end_matches(input, "/"))) }}/$name
    bin={{ quote(bin) }}
    options=(--pipeline "$pipeline" {{ flags }})
    results=(1-ingest.mcap 2-filter.mcap 3-integrate.mcap 4-identify.mcap 5-parameter-solve.mcap 6-simulate.mcap report.html summary.json)
    known() { "$bin/crumple-$1" --help | grep -qE -- "^ +(-., )?$2( |=|\$)"; }
    # Flags go to ingest: says whose another one is.
    whose() {
        for flag in "$@"; do
            flag=${flag%%=*}
            [[ $flag == --* ]] && ! known ingest "$flag" || continue
            for stage in filter integrate identify parameter-solve simulate; do
                ! known $stage "$flag" || echo "tip: $flag is an option of crumple-$stage: just ${stage/-/_}=\"$bin/crumple-$stage $flag ...\" run RECORD, or a key of [$stage] in a pipeline" >&2
            done
        done
    }
    failed() {
        [ ! -e "$dir/report.html" ] || echo "note: the report in $dir is that of an earlier run" >&2
        exit "$1"
    }
    source_of() { "$bin/crumple-artifact" show --json --topic /test "$1" 2>/dev/null | sed -n 's/.*"source":{"format":"\([^"]*\)","name":"\([^"]*\)","digest":"[^"]*:\(.\{12\}\).*/\2 (\1, content \3)/p'; }
    # A stage whose output is up to date leaves it alone. Where it wrote, what stands after it is out of date and goes, so that no
    # failure of a later stage, of whatever kind, leaves results of another record. Until the record is read nothing goes.
    # Exit code 4 (no acceptable result, diagnosis written) does not stop the run: the report shows the diagnosis.
    started=$(mktemp)
    trap 'rm -f "$started"' EXIT
    reached=0
    step() {
        output="$dir/${results[$reached]}" code=0
        reached=$((reached + 1))
        exec 3<&-
        [ ! -e "$output" ] || exec 3<"$output"
        "$@" "${options[@]}" -o "$output" 3<&- || code=$?
        [ "$output" -ef /dev/fd/3 -a ! "$output" -nt "$started" ] || [ ! -e "$output" ] || (cd "$dir" && rm -f "${results[@]:$reached}")
        [ "$code" -eq 0 ] || [ "$code" -eq 4 ] || return "$code"
    }
    step {{ ingest }} "$@" || { code=$?; [ "$code" -ne 2 ] || whose "${@:2}"; failed "$code"; }
    if [ -e /dev/fd/3 ] && before=$(source_of /dev/fd/3) && [ -n "$before" ] && [ "$before" != "$(source_of "$output")" ]; then
        echo "note: replaces the run of $before in $dir: another record, or this one before a change (just out=DIR run keeps both)" >&2
    fi
    step {{ filter }} "$dir/1-ingest.mcap" || failed $?
    step {{ integrate }} "$dir/2-filter.mcap" || failed $?
    step {{ identify }} "$dir/2-filter.mcap" "$dir/3-integrate.mcap" || failed $?
    step {{ parameter_solve }} "$dir/2-filter.mcap" "$dir/3-integrate.mcap" "$dir/4-identify.mcap" || failed $?
    step {{ simulate }} "$dir/2-filter.mcap" "$dir/3-integrate.mcap" "$dir/5-parameter-solve.mcap" || failed $?
    {{ report }} "$dir"/[1-6]-*.mcap "${options[@]}" -o "$dir/report.html" || { code=$?; [ "$code" -ne 4 ] || exit 4; failed "$code"; }

# Semantic comparison of two run folders or artifacts: exit 0 same, 1 different, 2 trouble.
[group('pipeline')]
[no-cd]
[no-exit-message]
diff a b *args: build
    @{{ bin }}/crumple-diff "$@"

# Records of an artifact as JSON, waveforms summarised.
[group('pipeline')]
[no-cd]
[no-exit-message]
show artifact *args: build
    @{{ bin }}/crumple-artifact show "$@"

# Release build of all binaries. Asks cargo only if a source is newer than the last build: cargo alone takes 0.2 s to see that nothing is to do.
[group('development')]
build:
    #!/usr/bin/env bash
    set -euo pipefail
    stamp={{ quote(bin / ".crumple-built") }}
    if [ ! -e "$stamp" ] || [ -n "$(find Cargo.toml Cargo.lock rust-toolchain.toml crates -newer "$stamp" -print -quit)" ]; then
        mkdir -p {{ quote(bin) }} && touch "$stamp.$$"
        cargo build --release --workspace --bins
        mv "$stamp.$$" "$stamp"
    fi

# All tests.
[group('development')]
test *args: build
    cargo test --workspace --doc --quiet
    cargo nextest run --workspace "$@"

# Times of the numerical kernels and of reading CSV on one thread, each beside a plain memory pass; docs/performance.md.
[group('development')]
bench *args:
    RAYON_NUM_THREADS=1 cargo bench --quiet --workspace --bench '*' -- "$@"

# Formatting, lints, crate arrows, documentation.
[group('development')]
lint:
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --quiet -- -D warnings
    cargo test --package crumple-testkit --test architecture --quiet
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

# Runs the fixtures and compares with the committed results.
[group('development')]
golden: build
    #!/usr/bin/env bash
    set -euo pipefail
    rm -rf target/golden
    for fixture in fixtures/*/; do
        fresh="target/golden/$(basename "$fixture")"
        just flags=-q out="$fresh" run "$fixture/crash.csv"
        for expected in "$fixture"golden/*; do
            {{ bin }}/crumple-diff "$expected" "$fresh/$(basename "$expected")"
        done
    done

# Writes the committed results of the fixtures anew. Say in CHANGELOG.md why the numbers changed.
[group('development')]
golden-update: build
    #!/usr/bin/env bash
    set -euo pipefail
    for fixture in fixtures/*/; do
        rm -rf "$fixture/golden"
        just flags=-q out="$fixture/golden" run "$fixture/crash.csv"
        rm -f "$fixture/golden/report.html"
        # The simulated waveforms are the bulk; one fixture keeps them, the others their figures in summary.json.
        [ "$(basename "$fixture")" = double ] || rm -f "$fixture/golden/6-simulate.mcap"
    done

# The three papers' numbers, recomputed and compared: writes docs/papers.md, ends with `N of M items`.
[group('development')]
papers:
    CRUMPLE_WRITE_PAPERS=1 cargo test --quiet --package crumple-lumped-fit --test papers

# Shell completions and man pages of all programs, into target/shell.
[group('development')]
shell-files: build
    #!/usr/bin/env bash
    set -euo pipefail
    mkdir -p target/shell
    for program in ingest filter integrate identify parameter-solve simulate report diff artifact; do
        for kind in bash zsh fish man; do
            {{ bin }}/crumple-$program --generate $kind > target/shell/crumple-$program.$kind
        done
    done

# Makes the fixtures anew.
[group('development')]
fixtures:
    cargo run --quiet --release --package crumple-testkit --bin make-fixtures -- fixtures

# Removes run folders and build products.
[group('development')]
clean:
    rm -rf runs target
