#!/usr/bin/env bash
# scripts/report.sh: installs what is missing, builds the FMUs, measures error against run time and writes the report
# of it: CSV, figures, index.html and README.md in docs/report.
#   --peers        installs the optional simulators of requirements-peers.txt into .venv and measures them too
#   --quick        few runs, to see that it works
#   --output DIR   instead of docs/report
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"

peers=false
quick=()
output=$root/docs/report
while (($#)); do
    case $1 in
        --peers) peers=true ;;
        --quick) quick=(--quick) ;;
        --output)
            (($# > 1)) || refuse "--output lacks a folder"
            output=$(realpath -m -- "$2")
            shift
            ;;
        *) refuse "unknown argument $1" ;;
    esac
    shift
done

say "Set-up"
set_up
if $peers; then
    "$python" -m pip install --quiet --disable-pip-version-check --no-input \
        -r "$root/requirements.txt" -r "$root/requirements-peers.txt" </dev/null
fi

say "Build"
build

say "The FMU's solvers"
contact_fmus measure "${quick[@]}" --output "$output"

say "The FMU as a force element"
contact_fmus force-element "${quick[@]}" --output "$output"

if $peers; then
    say "Other simulators"
    contact_fmus peers "${quick[@]}" --output "$output"
fi

say "Page"
contact_fmus page --output "$output"
