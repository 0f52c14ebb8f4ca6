#!/usr/bin/env bash
# scripts/report.sh: installs what is missing, builds the FMUs, measures error against run time and writes the report
# of it: CSV, figures, index.html and README.md in docs/report.
#   --peers        installs the optional simulators of requirements-peers.txt into .venv, and RADAU5, and measures them
#                  too; the newest Drake wants PYTHON=/path/to/python3.12 or later
#   --quick        few runs, to see that it works
#   --output DIR   instead of docs/report
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
known_options "$@"

if [[ " $* " == *" --peers "* ]]; then
    set_up --peers
    "$python" -m pip install --quiet --disable-pip-version-check --no-input \
        -r "$root/requirements.txt" -r "$root/requirements-peers.txt" </dev/null
else
    set_up
fi
build
contact_fmus report "$@"
