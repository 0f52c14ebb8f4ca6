#!/usr/bin/env bash
# scripts/stability.sh: installs what is missing, builds the FMUs and sweeps stiff and extreme scenes over all solver
# methods and communication steps: CSV, heat maps, a table of limits, index.html and README.md in docs/stability.
#   --quick        few of the scenes
#   --check        the status is 1 unless event_driven comes to its end everywhere and is right there
#   --output DIR   instead of docs/stability
#   --beyond FIRST LAST   nothing of that: random scenes far beyond the atlas's axes, by event_driven; seeds
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"

options=()
beyond=()
output=$root/docs/stability
while (($#)); do
    case $1 in
        --quick | --check) options+=("$1") ;;
        --output)
            (($# > 1)) || refuse "--output lacks a folder"
            output=$(realpath -m -- "$2")
            shift
            ;;
        --beyond)
            [[ ${2:-} =~ ^[0-9]+$ && ${3:-} =~ ^[0-9]+$ ]] ||
                refuse "--beyond takes two seeds, the first and the one after the last"
            beyond=("$2" "$3")
            shift 2
            ;;
        *) refuse "unknown argument $1" ;;
    esac
    shift
done

set_up
build
if ((${#beyond[@]})); then
    contact_fmus beyond "${beyond[@]}"
else
    contact_fmus stability "${options[@]}" --output "$output"
fi
