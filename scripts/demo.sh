#!/usr/bin/env bash
# Installs what is missing, builds all FMUs, runs every scenario of scripts/scenarios and prints what each
# claims, measures and expects, then what leaving out saves. Plots and an HTML page end up in build/scenarios.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

say() { printf '\n== %s\n' "$*"; }

say "Set-up"
scripts/setup.sh

say "Build"
cmake --preset default -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$root/.venv/bin/python"
cmake --build --preset default -- --quiet
printf 'built: %s\n' build/fmus/*.fmu

export PYTHONPATH=$root/scripts PYTHONDONTWRITEBYTECODE=1 CONTACT_FMUS=$root/build/fmus
claims=0
say "Scenarios"
.venv/bin/python -m contact_scenarios run --output build/scenarios || claims=$?

say "Leave out"
.venv/bin/python -m contact_scenarios leave-out

say "Pictures"
printf 'plots:     %s\nHTML page: %s\n' "$root/build/scenarios/plots" "$root/build/scenarios/index.html"
if ((claims != 0)); then
    printf 'Not every claim holds: see the table above.\n' >&2
fi
exit "$claims"
