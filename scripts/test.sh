#!/usr/bin/env bash
# scripts/test.sh [PATHS...]: installs what is missing, builds all FMUs and runs every test, or those of the paths: the
# C unit tests by ctest, the rest by pytest. With CI=true compiler warnings are errors. The status is 0 only when all
# tests pass.
#   -k WORDS       only Python tests whose name has the words (pytest's expression)
#   -x             stops at the first Python test that fails
#   -- OPTION ...  all that follows goes to pytest
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
options=()
paths=()
while (($#)); do
    case $1 in
        -k) (($# > 1)) || refuse "-k lacks its words"; options+=(-k "$2"); shift ;;
        -x) options+=(-x) ;;
        --) shift; options+=("$@"); break ;;
        -*) refuse "unknown argument $1" ;;
        *) paths+=("$1") ;;
    esac
    shift
done
((${#paths[@]})) || paths=(tests)
cd "$root"

say "Set-up"
set_up

say "Build"
errors=OFF
if [[ ${CI:-} == true ]]; then
    errors=ON
fi
build -DCONTACT_WARNINGS_AS_ERRORS="$errors"

say "C unit tests"
unit=0
ctest --preset default -L unit --no-tests=error </dev/null || unit=$?

say "FMU, physics, property, generator and architecture tests"
rest=0
# A file's tests stay in one process, which makes the file's fixtures once; tests/conftest.py puts files in order.
"$python" -m pytest -n 2 --dist loadscope --no-loadscope-reorder "${options[@]}" "${paths[@]}" </dev/null || rest=$?

if ((unit != 0)); then
    printf 'ctest failed with status %d\n' "$unit" >&2
fi
exit $((unit != 0 ? unit : rest))
