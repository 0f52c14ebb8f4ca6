# shellcheck shell=bash
# What the scripts share; each sources this file first. $root is the repository, $here the script's name.
#
#   help_asked "$@"     after -h or --help: prints the comment at the script's top and ends with status 0
#   refuse TEXT         ends with status 2: the request makes no sense
#   say TEXT            a heading
#   set_up              installs what is missing (scripts/setup.sh)
#   build               configures and builds the preset "default"; arguments go to the configuration
#   contact_fmus ...    the Python package, with the FMUs just built
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
here=$(basename "$0" .sh)
python=$root/.venv/bin/python

say() { printf '\n== %s\n' "$*"; }
refuse() { printf '%s: %s (--help says what there is)\n' "$here" "$*" >&2; exit 2; }

help_asked() {
    local argument
    for argument in "$@"; do
        if [[ $argument == -h || $argument == --help ]]; then
            sed -n '2,/^[^#]/{s/^# \{0,1\}//p;}' "$0"
            exit 0
        fi
    done
}

set_up() { "$root/scripts/setup.sh"; }

build() {
    (cd "$root" && cmake --preset default -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$python" "$@" &&
        cmake --build --preset default -- --quiet)
    use_build "$root/build"
}

# use_build DIR: the FMUs that Python sees
use_build() {
    export PYTHONPATH=$root/scripts PYTHONDONTWRITEBYTECODE=1 CONTACT_BUILD=$1 CONTACT_FMUS=$1/fmus
}

contact_fmus() { "$python" -m contact_fmus "$@" </dev/null; }
