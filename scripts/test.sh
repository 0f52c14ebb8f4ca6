#!/usr/bin/env bash
# Installs what is missing, builds all FMUs and runs every test: the C unit tests by ctest, the rest by
# pytest. Arguments go to pytest. With CI=true compiler warnings are errors. The status is 0 only when all
# tests pass.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
cd "$root"

say() { printf '\n== %s\n' "$*"; }

say "Set-up"
scripts/setup.sh

say "Build"
errors=OFF
if [[ ${CI:-} == true ]]; then
    errors=ON
fi
cmake --preset default -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$root/.venv/bin/python" \
    -DCONTACT_WARNINGS_AS_ERRORS="$errors"
cmake --build --preset default -- --quiet

say "C unit tests"
unit=0
ctest --preset default -L unit --no-tests=error </dev/null || unit=$?

say "FMU, physics, property, generator and architecture tests"
export PYTHONPATH=$root/scripts PYTHONDONTWRITEBYTECODE=1
export CONTACT_BUILD=$root/build CONTACT_FMUS=$root/build/fmus
rest=0
.venv/bin/python -m pytest -n 2 "$@" tests </dev/null || rest=$?

if ((unit != 0)); then
    printf 'ctest failed with status %d\n' "$unit" >&2
fi
exit $((unit != 0 ? unit : rest))
