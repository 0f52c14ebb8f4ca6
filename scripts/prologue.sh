# shellcheck shell=bash
# What the scripts share; each sources this file first. $root is the repository, $here the script's name.
#
#   help_asked "$@"     after -h or --help: prints the comment at the script's top and ends with status 0
#   refuse TEXT         ends with status 2: the request makes no sense
#   known_options "$@"  ends with status 2 where an argument is none that the comment at the script's top names as
#                       "#   --option VALUE ...  text", with as many values
#   say TEXT            a heading
#   set_up [--demo]     installs what is missing (scripts/setup.sh)
#   build               configures and builds the preset "default"; arguments go to the configuration
#   build_fmus          the same, but no more than the FMUs for FMI 2.0 and what runs them
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

known_options() {
    local line
    local -a values
    local -A takes=()
    while IFS= read -r line; do
        if [[ $line =~ ^#\ +(--[a-z-]+)((\ [A-Z]+)*)\ \  ]]; then
            read -ra values <<<"${BASH_REMATCH[2]}"
            takes[${BASH_REMATCH[1]}]=${#values[@]}
        fi
    done < <(sed '/^[^#]/q' "$0")
    while (($#)); do
        [[ -n $1 && -n ${takes[$1]:-} ]] || refuse "unknown argument $1"
        (($# > takes[$1])) || refuse "$1 lacks a value"
        shift $((takes[$1] + 1))
    done
}

set_up() { "$root/scripts/setup.sh" "$@"; }

configure() {
    (cd "$root" && cmake --preset default -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$python" "$@")
}

build() {
    configure -DBUILD_TESTING=ON "$@"
    (cd "$root" && cmake --build --preset default -- --quiet)
    use_build "$root/build"
}

build_fmus() {
    configure -DBUILD_TESTING=OFF # without debug information, which takes a third of the time of compiling
    (cd "$root" && cmake --build --preset default --target fmus fmu_host)
    use_build "$root/build"
}

# use_build DIR: the FMUs that Python sees
use_build() {
    export PYTHONPATH=$root/scripts PYTHONDONTWRITEBYTECODE=1 CONTACT_BUILD=$1 CONTACT_FMUS=$1/fmus
}

contact_fmus() { "$python" -m contact_fmus "$@" </dev/null; }
