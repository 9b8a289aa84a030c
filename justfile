# Crumple: a crash pulse in, a physical model out. `just` alone lists the recipes.

set positional-arguments
set shell := ["sh", "-euc"]

# Pipeline: a file below pipelines/ without its ending, e.g. `just pipeline=papers/civic run crash.csv`, or the path of a file elsewhere, e.g. `./my.toml`.
# It says what it changes of the default pipeline, unless it stands alone (base = "none").
export pipeline := "default"
# Run folder; empty: runs/<input stem>/<pipeline>.
export out := ""
# Flags for every stage, e.g. `just flags="-q --force" run crash.csv`.
export flags := ""
# Profile of the programs: release, or dev, which the tests are built in.
export profile := env("CRUMPLE_PROFILE", "release")
# Where the programs are.
export bin := env("CARGO_TARGET_DIR", justfile_directory() / "target") / if profile == "dev" { "debug" } else { profile }
# How they are built: in dev with the tests, so that nothing is compiled twice.
compile := if profile == "dev" { "cargo nextest run --no-run" } else { "cargo build --profile " + profile + " --exclude crumple-testkit --bins" }
export project := justfile_directory()

# The chain, one line a stage with what it reads and writes, is pipelines/chain: `just chain`.
# Any stage can be any program that follows docs/format.md, e.g. `just identify="python3 my_stage.py" run crash.csv`.
ingest := "crumple-ingest"
filter := "crumple-filter"
integrate := "crumple-integrate"
identify := "crumple-identify"
parameter_solve := "crumple-parameter-solve"
simulate := "crumple-simulate"
predict := "crumple-predict"
report := "crumple-report"

export CRUMPLE_INGEST := ingest
export CRUMPLE_FILTER := filter
export CRUMPLE_INTEGRATE := integrate
export CRUMPLE_IDENTIFY := identify
export CRUMPLE_PARAMETER_SOLVE := parameter_solve
export CRUMPLE_SIMULATE := simulate
export CRUMPLE_PREDICT := predict
export CRUMPLE_REPORT := report

[private]
default:
    @just --list --unsorted

# The stages are the lines of pipelines/chain; crumple-run starts them and keeps what a run folder promises.
# The main job: `just run crash.csv [--set filter.cfc=180] [--mass 873kg --impact-speed 35km/h ...]`; other flags go to ingest.
[group('pipeline')]
[no-cd]
[no-exit-message]
run record *args: build
    @"$bin/crumple-run" --project "$project" --pipeline "$pipeline" --out "$out" --flags "$flags" -- "$@"

# The stages of pipelines/chain, one plain line each.
[group('pipeline')]
chain:
    @cat pipelines/chain

# Writes 7-predict.mcap of that run again, with the speeds of its pipeline and those asked for, and the report and the summary.
# The models of a run, or of several tests (runs/together/NAME), at other speeds and masses: `just predict runs/crash/default --speed 40km/h,64km/h [--mass 1500kg] [--candidate ID] [--partner OTHER_RUN]`.
[group('pipeline')]
[no-cd]
[no-exit-message]
predict $folder *args: build
    @shift; "$bin/crumple-run" --project "$project" --pipeline "$pipeline" --again "$folder" --flags "$flags" -- "$@"

# Runs every record, fits one model to all of them into runs/together/NAME, and predicts every test from the others.
# One model for several tests: `just together A.EV5 B.EV5 ... [--name NAME] [--speed 64km/h]`; a run folder stands for its record.
[group('pipeline')]
[no-cd]
[no-exit-message]
together *args: build
    @"$bin/crumple-together" --project "$project" --pipeline "$pipeline" --out "$out" --flags "$flags" -- "$@"

# A run that is up to date is left alone, a record that fails is a row with its error; tables and fleet.html in runs/fleet/NAME (docs/fleet.md).
# Many records: `just fleet FOLDER|@LIST|'PATTERN' [--pipelines a,b] [--set STAGE.KEY=v1,v2] [-j N] [--name NAME]`.
[group('pipeline')]
[no-cd]
[no-exit-message]
fleet *args: build
    @"$bin/crumple-fleet" --project "$project" --pipeline "$pipeline" --out "$out" --flags "$flags" "$@"

# Words behind the records: settings of pipelines/fleet/config.yaml, then flags of Snakemake. Records and fleet lie on a disk that every node sees.
# A fleet on a Slurm cluster: `just fleet-slurm FOLDER|@LIST|'PATTERN' [out=FOLDER] [batches=N] [--dry-run ...]`.
[group('pipeline')]
[no-cd]
[no-exit-message]
fleet-slurm $records *settings: build
    @"$project/scripts/setup.sh" fleet >&2
    @shift; "$project/.venv-fleet/bin/snakemake" --snakefile "$project/pipelines/fleet/Snakefile" \
        --profile "$project/pipelines/fleet/profiles/slurm" --config records="$records" out="$out" flags="$flags" "$@"

# Runs the fleet, joins the tests of each vehicle, regresses stiffness and damping, predicts each test from the others: runs/fleet/NAME/study.
# What many tests say of vehicles: `just study FOLDER [--classes FILE] [flags of just fleet]`.
[group('pipeline')]
[no-cd]
[no-exit-message]
study *args: build
    @"$bin/crumple-study" --project "$project" --pipeline "$pipeline" --out "$out" --flags "$flags" "$@"

# Semantic comparison of two run folders or artifacts: exit 0 same, 1 different, 2 trouble.
[group('pipeline')]
[no-cd]
[no-exit-message]
diff a b *args: build
    @"$bin/crumple-diff" "$@"

# One page of several runs: curves over each other, numbers and settings side by side: `just compare RUN_A RUN_B [-o compare.html] [--markdown FILE]`.
[group('pipeline')]
[no-cd]
[no-exit-message]
compare *runs: build
    @"$bin/crumple-report" --compare "$@"

# Many runs as one sortable table with their pulses, numbers and first warnings: `just index RUN...|@LIST [-o index.html]`.
[group('pipeline')]
[no-cd]
[no-exit-message]
index *runs: build
    @"$bin/crumple-report" --index "$@"

# Records of an artifact as JSON, waveforms summarised.
[group('pipeline')]
[no-cd]
[no-exit-message]
show artifact *args: build
    @"$bin/crumple-artifact" show "$@"

# The notes of a run alone: warnings by their weight, then what is good to know: `just notes runs/crash/default`.
[group('pipeline')]
[no-cd]
[no-exit-message]
notes folder *args: build
    @"$bin/crumple-artifact" notes "$@"

# Static force-deflection curves of a run's recommended candidate: `just curve runs/crash/default [--candidate ID] [--format csv|ls-dyna|madymo|pc-crash] [--to 900mm]`.
[group('pipeline')]
[no-cd]
[no-exit-message]
curve $folder *args: build
    @shift; "$bin/crumple-artifact" curve "$folder/5-parameter-solve.mcap" "$@"

# Release build of all binaries. Asks cargo only if a source is newer than the last build: cargo alone takes 0.2 s to see that nothing is to do.
[group('development')]
build:
    @stamp="$bin/.crumple-built"; \
    if [ ! -e "$stamp" ] || [ -n "$(find Cargo.toml Cargo.lock rust-toolchain.toml crates pipelines/chain \
        -type d \( -name tests -o -name testkit \) -prune -o -newer "$stamp" -print -quit)" ]; then \
        mkdir -p "$bin"; touch "$stamp.$$"; \
        {{ compile }} --workspace; \
        mv "$stamp.$$" "$stamp"; \
    fi

# All tests.
[group('development')]
test *args:
    CRUMPLE_PROFILE=dev just build
    cargo test --workspace --doc --quiet
    CRUMPLE_PROFILE=dev cargo nextest run --workspace "$@"

# Times of the numerical kernels and of reading CSV on one thread, each beside a plain memory pass, and of whole runs: writes the tables of docs/performance.md. With arguments (`just bench era`): kernels alone; `just bench --peer [--turns N]`: a Python script of pandas, scipy and matplotlib in turns with `crumple run`; `just bench --binout`: a binout of 1 GB beside lasso-python.
[group('development')]
bench *args:
    @case "${1-}" in --peer) shift; just peer-bench "$@";; --binout) just binout-bench;; *) just own-bench "$@";; esac

[private]
peer-bench *args: build
    @[ -x target/peer/bin/python ] || python3 -m venv target/peer
    @target/peer/bin/pip install --quiet --disable-pip-version-check pandas==3.1.1 scipy==1.17.1 matplotlib==3.11.2
    @cargo run --quiet --release --package crumple-testkit -- peer --bin "$bin" target/peer/bin/python "$@"

[private]
binout-bench: build
    @[ -x target/binout-peer/bin/python ] || python3 -m venv target/binout-peer
    @target/binout-peer/bin/pip install --quiet --disable-pip-version-check lasso-python==2.0.4
    @cargo run --quiet --release --package crumple-testkit -- make-binout target/binout-peer/binout0000
    @target/binout-peer/bin/python scripts/binout_peer.py "$bin/crumple-ingest" target/binout-peer/binout0000 3
    @rm target/binout-peer/binout0000

[private]
own-bench *args:
    @mkdir -p target; rm -f target/bench.ndjson
    CRUMPLE_BENCH="$project/target/bench.ndjson" RAYON_NUM_THREADS=1 cargo bench --quiet --workspace --bench '*' -- "$@"
    [ $# -gt 0 ] || { CRUMPLE_PROFILE=release just build; \
        cargo run --quiet --release --package crumple-testkit -- performance target/bench.ndjson; }

# Every candidate of the runs as Modelica, simulated by Rumoca beside the numbers of Crumple. Installs Rumoca below target/.
[group('development')]
modelica +runs: build
    @[ -x target/modelica/bin/python ] || python3 -m venv target/modelica
    @target/modelica/bin/pip install --quiet --disable-pip-version-check rumoca==0.10.2 numpy==2.3.5
    @target/modelica/bin/python scripts/modelica.py "$bin/crumple-export" "$@"

# Of the whole workspace, as `just test` is: one package alone has other features of its dependencies, and all would be compiled twice.
# Each installs the public packages it is about in a folder of its own (Python 3.11, a package index, a quarter of an hour).
# Runs findings/*.sh in turn and says which still behave as stated (CONTRIBUTING.md#findings): `just findings [NAME ...]`.
[group('development')]
[no-exit-message]
findings *names:
    @log="$(mktemp)"; trap 'rm -f "$log"' EXIT; changed=0; \
    [ $# -gt 0 ] || set -- $(for file in findings/*.sh; do basename "$file" .sh; done); \
    for name in "$@"; do \
        start=$(date +%s); verdict="as stated"; \
        "findings/$name.sh" >"$log" 2>&1 || { verdict=changed; changed=1; }; \
        printf '%-36s %4s s  %s\n' "$name" "$(($(date +%s) - start))" "$verdict"; \
        [ "$verdict" = "as stated" ] || sed 's/^/    /' "$log" >&2; \
    done; \
    exit "$changed"

# Spelling, formatting, lints, the rules of the house (crates/testkit/tests/architecture), documentation.
[group('development')]
lint:
    @if [ -x .venv/bin/typos ]; then .venv/bin/typos; else echo "SKIPPED typos: scripts/setup.sh test installs it" >&2; fi
    cargo test --workspace --test architecture --quiet
    cargo fmt --all --check
    cargo clippy --workspace --all-targets --quiet -- -D warnings
    @# As users build it, without what checks alone turn on.
    cargo check --workspace --exclude crumple-testkit --bins --quiet
    RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

# Writes docs/schemas/, the JSON Schemas of all records and of summary.json. They are built into the programs: for a record type that is new, make an empty file first.
[group('development')]
schemas:
    CRUMPLE_WRITE_SCHEMAS=1 cargo nextest run --workspace -E 'test(the_schemas_in_the_docs)'

# Runs the fixtures and compares with the committed results.
[group('development')]
golden: build
    @rm -rf target/golden
    @for fixture in fixtures/*/; do \
        fresh="target/golden/$(basename "$fixture")/default"; \
        just flags=-q out="$fresh" run "$fixture/crash.csv"; \
        for expected in "$fixture"golden/*; do \
            "$bin/crumple-diff" --rounding "$expected" "$fresh/$(basename "$expected")"; \
        done; \
    done
    @"$bin/crumple" diff ci/expected target/golden

# The simulated and predicted waveforms are the bulk; one fixture keeps them, the others their figures in summary.json.
# Writes the committed results of the fixtures again. Say in CHANGELOG.md why the numbers changed.
[group('development')]
golden-update: build
    @for fixture in fixtures/*/; do \
        rm -rf "$fixture/golden"; \
        just flags=-q out="$fixture/golden" run "$fixture/crash.csv"; \
        fresh="target/accepted/$(basename "$fixture")/default"; \
        rm -rf "$fresh"; mkdir -p "$(dirname "$fresh")"; cp -r "$fixture/golden" "$fresh"; \
        rm -f "$fixture/golden/report.html" "$fixture/golden/0-pipeline.toml"; \
        [ "$(basename "$fixture")" = double ] || rm -f "$fixture/golden/6-simulate.mcap" "$fixture/golden/7-predict.mcap"; \
    done
    @"$bin/crumple" accept target/accepted --into ci/expected

# For changes that must not change a byte: `just bytes A` before, `just bytes B` after, `just bytes --compare A B [--content | --masked]`;
# `just bin=OTHER/release bytes A` for programs built elsewhere. What a line holds: crates/testkit/src/bytes/run.rs.
#
# Digests of everything the programs write over fixtures, pipelines, methods and solvers, into OUT (default: target/bytes.txt).
[group('development')]
[no-cd]
[no-exit-message]
bytes *args:
    @[ "$bin" != "${CARGO_TARGET_DIR:-$project/target}/release" ] || [ "${1-}" = --compare ] || just --justfile "$project/justfile" build
    @cargo run --quiet --manifest-path "$project/Cargo.toml" --package crumple-testkit -- bytes --bin "$bin" "$@"

# With words of names: those records alone, and the page stays. `--accept` writes ci/instructions.json: say in CHANGELOG.md why.
# Instructions of whole runs by stage (callgrind, one thread, no load moves them) into docs/performance.md; above 1.03 of what is accepted it fails.
[group('development')]
instructions *args: build
    @command -v valgrind >/dev/null || { echo "valgrind is missing: apt-get install valgrind" >&2; exit 2; }
    @rm -rf target/instructions; mkdir -p target/instructions; : >target/instructions/figures.ndjson
    @words=0; for word in "$@"; do case "$word" in -*) ;; *) words=1 ;; esac; done; [ "$words" = 0 ] || exit 0; \
        counted='*benchmark*counted*'; CRUMPLE_BENCH_COUNTED=1 RAYON_NUM_THREADS=1 \
        CRUMPLE_BENCH="$project/target/instructions/figures.ndjson" \
        cargo bench --quiet --workspace --bench '*' --config "target.'cfg(all())'.runner = ['valgrind', '--quiet', \
            '--tool=callgrind', '--collect-atstart=no', '--toggle-collect=$counted', '--dump-after=$counted', \
            '--callgrind-out-file=$project/target/instructions/%p']" >target/instructions/said.txt 2>&1 \
        || { cat target/instructions/said.txt >&2; exit 1; }
    @cargo run --quiet --release --package crumple-testkit -- instructions --bin "$bin" --kernels target/instructions "$@"

# How often the 95 % intervals of fitted parameters hold the truth, 300 made records a family: `just interval-benchmark [--choice] [--contact] [--clean] [--records N] [--first K] [FAMILY ...]`.
[group('development')]
interval-benchmark *args: build
    @cargo run --quiet --release --package crumple-testkit -- interval-benchmark --bin "$bin" "$@"

# How often nominal 90 % intervals of identified modes hold the truth, 100 made records a kind, and whether ambient records show their modes alone: `just identification-benchmark [--records N] [--first K] [KIND ...]`.
[group('development')]
identification-benchmark *args: build
    @cargo run --quiet --release --package crumple-testkit -- identification-benchmark --bin "$bin" "$@"

# How far predictions of other tests are off, 50 made cars of 13 kinds each: `just prediction-benchmark [--cars N] [--first K] [--tests 56,40] [--candidates] [--keep FOLDER] [KIND ...]`.
[group('development')]
prediction-benchmark *args: build
    @cargo run --quiet --release --package crumple-testkit -- prediction-benchmark --bin "$bin" "$@"

# Values, remarks and shown numbers of runs against known truth, 4 made cars a family and kind: `just truth [--cars N] [--short] [NAME ...]`.
[group('development')]
truth *args: build
    @cargo run --quiet --release --package crumple-testkit -- truth --bin "$bin" "$@"

# Ranks of the truth in the posteriors behind intervals, 50 made records a family and condition, into docs/calibration.md (an hour; `--print FAMILY ...`: the table of some).
[group('development')]
calibration *args: build
    @cargo run --quiet --release --package crumple-testkit -- calibration --bin "$bin" "$@"

# Published figures beside what the programs give: writes docs/atlas.md and ci/atlas.json, fails where a hit is lost. Needs CRUMPLE_SHARED.
[group('development')]
atlas: build
    @cargo run --quiet --release --package crumple-testkit -- atlas --bin "$bin"

# The same records through public packages, into docs/peers.md: needs Python 3.11, a package index and CRUMPLE_SHARED.
[group('development')]
peers: build
    @[ -x target/peers/bin/python ] || python3 -m venv target/peers
    @target/peers/bin/pip install --quiet --disable-pip-version-check --only-binary :all: pyisomme==1.1.0 crashmetrics==0.6.0 \
        endaq==1.5.3 aeroid==0.5.0 objective-rating-metrics==1.3 npTDMS==1.13.0 numpy==1.26.4 scipy==1.12.0 pandas==2.2.3
    @rm -rf target/peers/cars
    @cargo run --quiet --release --package crumple-testkit -- make-cars target/peers/cars 40
    @target/peers/bin/python scripts/peers.py "$bin/crumple" target/peers/cars "${CRUMPLE_SHARED:-../shared}" docs/peers.md

# What a fleet costs, on an idle machine: wall times as the fleet says them, then CPU time of all children so far, and disk: `just fleet-benchmark [RECORDS]`.
[group('development')]
fleet-benchmark $records="2000" $folder="target/fleet-benchmark": build
    @rm -rf "$folder"
    @cargo run --quiet --release --package crumple-testkit -- make-fleet "$folder/records" "$records" 1
    @for run in first second; do \
        echo "$run run"; \
        just out="$folder/fleet" fleet "$folder/records"; \
        times; \
    done
    @du -sh "$folder/fleet/runs"

# The product over a file of reference cases, every number compared, ends with `N of M cases`: `just cases identification|metrics|papers|prediction|records FILE`.
[group('development')]
cases subject file:
    @cargo test --quiet --workspace --test cases -- "$@"

# The three papers' numbers, recomputed and compared: writes docs/papers.md, ends with `N of M cases`.
[group('development')]
papers:
    CRUMPLE_WRITE_PAPERS=1 cargo test --quiet --workspace --test cases -- papers

# docs/ as a book with a search, target/book/index.html. What runs its commands: crates/testkit/tests/it/book.rs.
[group('development')]
book:
    [ -x target/tools/bin/mdbook ] || cargo install --quiet --locked mdbook@0.5.4 --no-default-features --features search --root target/tools
    target/tools/bin/mdbook build

# The Python wheel for this machine, into target/wheels: docs/python.md.
[group('development')]
wheel: python-tools
    rm -rf target/wheels
    target/python/bin/maturin build --quiet --locked --profile "$profile" --out target/wheels

# With numpy 2 and, where Python is older than 3.13, with numpy 1.26. The wheel: that of `just wheel`, or a file.
# Installs the wheel into a new environment, checks types, runs python/tests, the code of documents and the notebook.
[group('development')]
python-test $wheel="":
    [ -n "$wheel" ] || just wheel
    rm -rf target/python-test
    python3 -m venv target/python-test
    wheel="$(realpath "${wheel:-$(ls target/wheels/*.whl)}")"; export CRUMPLE_WHEEL="$wheel"; \
    PATH="$PWD/target/python-test/bin:$PATH"; \
    pip install --quiet --disable-pip-version-check "$wheel[pandas,plot]" mypy pandas-stubs pytest; \
    pip install --quiet --disable-pip-version-check polars pyarrow openpyxl mcap mcap-protobuf-support; \
    mypy; \
    (cd python/tests; python -m pytest -q -p no:cacheprovider); \
    if python -c "import sys; sys.exit(sys.version_info >= (3, 13))"; then \
        pip uninstall --quiet --yes pyarrow; \
        pip install --quiet --disable-pip-version-check "numpy==1.26.*" "pandas<3"; \
        pip check; \
        (cd python/tests; python -m pytest -q -p no:cacheprovider); \
    fi

# What a release holds, into dist/: a static program, the wheel with it, the page, sample data, a bill of materials, checksums.
[group('development')]
dist: python-tools
    scripts/dist.sh

# Tools from the Python registry, into target/python.
[private]
python-tools:
    @[ -x target/python/bin/python ] || python3 -m venv target/python
    @target/python/bin/pip install --quiet --disable-pip-version-check "maturin>=1.16,<2"

# What every change must pass, and what is too slow for that: before an issue is called resolved.
[group('development')]
ci-full:
    .ci/run
    CRUMPLE_KILLS=120 cargo nextest run --workspace -E 'package(crumple-run) | test(/^just_run::/)'
    CRUMPLE_FLEET_RECORDS=200 cargo nextest run --workspace -E 'package(crumple-testkit) & test(/^fleet::/)'
    CRUMPLE_SLURM_FOR="a fleet on Slurm" scripts/local-slurm.sh \
        cargo nextest run --workspace -E 'test(a_fleet_outlives_a_node_that_dies)' --run-ignored all
    just papers
    [ -z "${CRUMPLE_SHARED-}" ] || just atlas
    just truth
    just calibration --print --records 30 kelvin elastoplastic maxwell
    just book
    just windows
    just page
    CRUMPLE_PAGE=target/page/crumple.html cargo nextest run --workspace -E 'package(crumple-testkit) & test(/^page::/)'
    just python-test
    just instructions
    RAYON_NUM_THREADS=1 just bytes target/bytes-1.txt
    RAYON_NUM_THREADS=4 just bytes target/bytes-4.txt
    just bytes --compare target/bytes-1.txt target/bytes-4.txt

# The program as WebAssembly in one page that works from a disk, target/page/crumple.html: needs gzip, base64 and awk.
[group('development')]
page: (target "wasm32-wasip1")
    cargo build --quiet --locked --profile page --target wasm32-wasip1 --package crumple-cli --no-default-features
    @mkdir -p target/page
    @# A line of the template that starts with @ is replaced by what its command prints.
    @module="${CARGO_TARGET_DIR:-target}/wasm32-wasip1/page/crumple.wasm" \
        awk '/^@/ { fflush(); if (system(substr($0, 2))) exit 1; next } { print }' page/crumple.html > target/page/crumple.html.new
    @mv target/page/crumple.html.new target/page/crumple.html
    @ls -l target/page/crumple.html

# Installs a target of Rust where it is missing.
[private]
target name:
    @[ -d "$(rustc --print sysroot)/lib/rustlib/{{ name }}" ] || rustup target add {{ name }}

# The programs compile for Windows and for the page, without a C compiler.
[group('development')]
windows: (target "x86_64-pc-windows-gnu") (target "wasm32-wasip1")
    cargo check --quiet --locked --workspace --exclude crumple-testkit --target x86_64-pc-windows-gnu
    cargo check --quiet --locked --package crumple-cli --no-default-features --target wasm32-wasip1

# Mutated files and tampered artifacts through the programs, 1000 of each, and 100 plausible records through the chain: `just fuzz [--files N] [--first K] [--folder FOLDER] [--simulations]`.
[group('development')]
fuzz *args: build
    @cargo run --quiet --release --package crumple-testkit -- fuzz --bin "$bin" "$@"

# Coverage-guided fuzzing of the readers, so many seconds a target (cargo-fuzz, nightly Rust); corpus in fuzz/corpus.
[group('development')]
fuzz-readers seconds="60":
    mkdir -p target/fuzz/record target/fuzz/artifact
    cd fuzz && for target in record artifact; do \
        cargo +nightly fuzz run "$target" "../target/fuzz/$target" corpus/record corpus/artifact -- \
            -max_total_time="$1" -rss_limit_mb=3072 -timeout=10 || exit 1; \
    done

# Shell completions and man pages of all programs, into target/shell.
[group('development')]
shell-files: build
    @mkdir -p target/shell
    @for program in demo ingest filter integrate identify parameter-solve simulate predict report diff accept artifact show notes curve check run together fleet study export view passport damage compare index explain new-stage; do \
        for kind in bash zsh fish man; do \
            "$bin/crumple" $program --generate $kind > target/shell/crumple-$program.$kind; \
        done; \
    done; \
    for kind in bash zsh fish man; do "$bin/crumple" --generate $kind > target/shell/crumple.$kind; done

# Writes the fixtures again.
[group('development')]
fixtures:
    cargo run --quiet --release --package crumple-testkit -- make-fixtures fixtures

# Removes run folders and build products.
[group('development')]
clean:
    rm -rf runs target
