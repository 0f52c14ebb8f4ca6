#!/usr/bin/env bash
# Installs what is missing, builds, and prints ratios of run times measured side by side: what a step in flight
# costs, event_driven against CVODE, stiff against soft, and with --baseline COMMIT this build against that of
# another commit. --check: the status is 1 where a ratio is not as asked; --quick: few runs.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

scripts/setup.sh
cmake --preset default -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$root/.venv/bin/python"
cmake --build --preset default -- --quiet

export PYTHONPATH=$root/scripts PYTHONDONTWRITEBYTECODE=1
export CONTACT_BUILD=$root/build CONTACT_FMUS=$root/build/fmus
exec .venv/bin/python -m contact_report.bench "$@"
