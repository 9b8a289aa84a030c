#!/usr/bin/env bash
# What a release holds, into dist/: a static program, the wheel with it, the page, sample data, a bill of materials,
# checksums. `just dist` calls it. At the end the program and the wheel do the main job in an environment without Rust.
set -euo pipefail
cd "$(dirname "$0")/.."
target=x86_64-unknown-linux-gnu
built=target/static/$target/release

rm -rf dist
mkdir -p dist/sample
RUSTFLAGS="-C target-feature=+crt-static -C strip=symbols" target/python/bin/maturin build --quiet --locked --release \
    --target "$target" --target-dir target/static --compatibility manylinux_2_17 --out dist
tar -czf dist/crumple-x86_64-linux.tar.gz --owner=0 --group=0 README.md CHANGELOG.md LICENSE-APACHE LICENSE-MIT \
    -C "$built" crumple
just page
cp target/page/crumple.html dist/
cargo metadata --format-version 1 --locked --filter-platform "$target" | scripts/sbom.py "$target" > dist/crumple.cdx.json

# The main job, by what was unpacked, where no Rust is found.
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
tar -xzf dist/crumple-x86_64-linux.tar.gz -C "$scratch" crumple
(cd "$scratch" && env -i PATH=/usr/bin:/bin HOME="$scratch" ./crumple demo --quiet)
test -s "$scratch/runs/crumple-demo/default/report.html"
cp "$scratch/crumple-demo.csv" dist/sample/
cp fixtures/elastoplastic/crash.csv dist/sample/elastoplastic.csv
tar -czf dist/crumple-sample-data.tar.gz --owner=0 --group=0 -C dist sample
rm -r dist/sample
python3 -m venv "$scratch/env"
"$scratch/env/bin/pip" install --quiet --disable-pip-version-check dist/*.whl
(cd "$scratch" && env -i PATH=/usr/bin:/bin HOME="$scratch" env/bin/python -c \
    'import crumple; print(crumple.run("crumple-demo.csv").verdict.splitlines()[0])')
(cd dist && sha256sum -- * > SHA256SUMS)
ls -l dist
