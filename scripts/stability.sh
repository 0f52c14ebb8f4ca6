#!/usr/bin/env bash
# Installs what is missing, builds the FMUs and sweeps stiff and extreme scenes over all solver methods and
# communication steps: CSV, heat maps, a table of limits, index.html and README.md in docs/stability.
#   --quick        few of the scenes
#   --check        the status is 1 unless event_driven comes to its end everywhere and is right there
#   --output DIR   instead of docs/stability
#   --beyond FIRST LAST   nothing of that: random scenes far beyond the atlas's axes, by event_driven; seeds
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)

fail() { printf 'stability: %s\n' "$*" >&2; exit 2; }

options=()
beyond=()
output=$root/docs/stability
while (($#)); do
    case $1 in
        --quick | --check) options+=("$1") ;;
        --output)
            (($# > 1)) || fail "--output lacks a folder"
            output=$(realpath -m -- "$2")
            shift
            ;;
        --beyond)
            [[ ${2:-} =~ ^[0-9]+$ && ${3:-} =~ ^[0-9]+$ ]] || fail "--beyond takes two seeds, the first and the one after the last"
            beyond=("$2" "$3")
            shift 2
            ;;
        *) fail "unknown argument $1 (--quick, --check, --output DIR, --beyond FIRST LAST)" ;;
    esac
    shift
done
cd "$root"

scripts/setup.sh
cmake --preset default -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$root/.venv/bin/python"
cmake --build --preset default -- --quiet

export PYTHONPATH=$root/scripts PYTHONDONTWRITEBYTECODE=1
export CONTACT_BUILD=$root/build CONTACT_FMUS=$root/build/fmus
if ((${#beyond[@]})); then
    exec .venv/bin/python -m contact_stability.beyond "${beyond[@]}"
fi
exec .venv/bin/python -m contact_stability "${options[@]}" --output "$output"
