#!/usr/bin/env bash
# scripts/coverage.sh [PYTEST PATHS...]: which branches of the C code the tests and the fuzzers' corpora take.
# Builds with gcc --coverage in build-coverage, runs the C tests, the replays and the Python tests named (default: FMU,
# physics, property), prints what each file has and each line with a branch that nothing took, and writes
# build-coverage/coverage/index.html with every line.
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
for path in "$@"; do
    [[ $path != -* ]] || refuse "unknown argument $path"
done
cd "$root"
build=$root/build-coverage
gcovr_version=8.3

paths=("$@")
((${#paths[@]} > 0)) || paths=(tests/fmu tests/physics tests/property)

set_up
cmake --preset default -B "$build" -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$python" \
    -DCMAKE_BUILD_TYPE=Debug -DCONTACT_STRIP=OFF "-DCMAKE_C_FLAGS=--coverage -fprofile-update=atomic"
find "$build" -name '*.gcda' -delete
cmake --build "$build" -- --quiet

if [[ ! -x $build/venv/bin/gcovr ]]; then
    python3 -m venv "$build/venv"
    "$build/venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-input "gcovr==$gcovr_version"
fi

ctest --test-dir "$build" -L unit --output-on-failure </dev/null || true
use_build "$build"
# How big and how bare the finished libraries are is no claim about this build.
"$python" -m pytest -q -n 2 -p no:cacheprovider --ignore=tests/fmu/test_leave_out.py \
    --ignore=tests/fmu/test_validity.py --ignore=tests/fmu/test_determinism.py "${paths[@]}" </dev/null || true

# The sanitizers put branches of their own into what they watch: their objects are left out.
find "$build/tests/sanitize" \( -name '*.gcno' -o -name '*.gcda' \) -delete
mkdir -p "$build/coverage"
"$build/venv/bin/gcovr" --root "$root" --filter 'fmu_src/' --gcov-ignore-errors=all --merge-mode-functions=merge-use-line-min \
    --txt-metric branch --txt "$build/coverage/branches.txt" --html-details "$build/coverage/index.html" \
    --json-summary "$build/coverage/summary.json" --json "$build/coverage/coverage.json" "$build"
cat "$build/coverage/branches.txt"
"$python" scripts/tools/untaken_branches.py "$build/coverage/coverage.json"
