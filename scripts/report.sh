#!/usr/bin/env bash
# Installs what is missing, builds the FMUs, measures error against run time and writes the report of it:
# CSV, figures, index.html and README.md in docs/report.
#   --peers        installs the optional simulators of requirements-peers.txt into .venv and measures them too
#   --quick        few runs, to see that it works
#   --output DIR   instead of docs/report
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

say() { printf '\n== %s\n' "$*"; }
fail() { printf 'report: %s\n' "$*" >&2; exit 2; }

peers=false
quick=()
output=$root/docs/report
while (($#)); do
    case $1 in
        --peers) peers=true ;;
        --quick) quick=(--quick) ;;
        --output)
            (($# > 1)) || fail "--output lacks a folder"
            output=$(realpath -m -- "$2")
            shift
            ;;
        *) fail "unknown argument $1 (--peers, --quick, --output DIR)" ;;
    esac
    shift
done
cd "$root"

say "Set-up"
scripts/setup.sh
if $peers; then
    .venv/bin/python -m pip install --quiet --disable-pip-version-check --no-input \
        -r requirements.txt -r requirements-peers.txt </dev/null
fi

say "Build"
cmake --preset default -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$root/.venv/bin/python"
cmake --build --preset default -- --quiet

export PYTHONPATH=$root/scripts PYTHONDONTWRITEBYTECODE=1
export CONTACT_BUILD=$root/build CONTACT_FMUS=$root/build/fmus
say "The FMU's solvers"
.venv/bin/python -m contact_report measure "${quick[@]}" --output "$output"

say "The FMU as a force element"
.venv/bin/python -m contact_report.force_element "${quick[@]}" --output "$output"
if $peers; then
    say "Other simulators"
    .venv/bin/python -m contact_report.peers "${quick[@]}" --output "$output"
fi

say "Page"
.venv/bin/python -m contact_report page --output "$output"
