#!/usr/bin/env bash
# Sets up a fresh Debian machine that has Rust (rustup). Does nothing where everything is there already.
#   scripts/setup.sh        what `just run` needs: a C compiler, just
#   scripts/setup.sh test   what `just test` and `just lint` need too: cargo-nextest, Chromium, Python with mcap, typos
#   scripts/setup.sh fleet  what `just fleet-slurm` needs too: Snakemake in an environment of its own, .venv-fleet
set -euo pipefail
cd "$(dirname "$0")/.."

have() { command -v "$1" >/dev/null 2>&1; }

apt_install() {
    local sudo=""
    [ "$(id -u)" -eq 0 ] || sudo=sudo
    [ -n "${apt_updated:-}" ] || { $sudo apt-get update -qq; apt_updated=1; }
    DEBIAN_FRONTEND=noninteractive $sudo apt-get install -y -qq "$@"
}

have cargo || { echo "setup: Rust is missing, see https://rustup.rs" >&2; exit 1; }
have cc || apt_install build-essential
export PATH="${CARGO_HOME:-$HOME/.cargo}/bin:$PATH"
have just || cargo install just --locked --quiet

if [ "${1:-}" = test ]; then
    have cargo-nextest || cargo install cargo-nextest --locked --quiet
    have chromium || apt_install chromium
    if ! .venv/bin/python -c "import mcap" 2>/dev/null; then
        # Debian's own python3 can make environments only with python3-venv.
        python3 -c "import venv, ensurepip" 2>/dev/null || apt_install python3 python3-venv
        rm -rf .venv
        python3 -m venv .venv
        .venv/bin/pip install --quiet "mcap>=1.2,<2"
    fi
    .venv/bin/typos --version >/dev/null 2>&1 || .venv/bin/pip install --quiet "typos>=1.52,<2" ||
        echo "setup: typos could not be installed, \`just lint\` goes without it" >&2
fi
if [ "${1:-}" = fleet ] && ! .venv-fleet/bin/snakemake --version >/dev/null 2>&1; then
    python3 -c "import venv, ensurepip" 2>/dev/null || apt_install python3 python3-venv
    python3 -c "import sys; sys.exit(sys.version_info < (3, 11))" || {
        echo "setup: Snakemake 9 needs Python 3.11 or later, here is $(python3 --version)" >&2
        exit 1
    }
    rm -rf .venv-fleet
    python3 -m venv .venv-fleet
    .venv-fleet/bin/pip install --quiet "snakemake>=9,<10" "snakemake-executor-plugin-slurm>=2,<3" \
        "snakemake-executor-plugin-cluster-generic>=1,<2" "snakemake-executor-plugin-kubernetes>=0.5,<0.6" \
        "snakemake-storage-plugin-fs>=1,<2"
fi
echo "setup: ready"
