#!/usr/bin/env bash
# scripts/stability.sh: installs what is missing, builds the FMUs and sweeps stiff and extreme scenes over all solver
# methods and communication steps: CSV, heat maps, a table of limits, index.html and README.md in docs/stability.
#   --quick        few of the scenes
#   --check        the status is 1 unless event_driven comes to its end everywhere and is right there
#   --output DIR   instead of docs/stability
#   --beyond FIRST LAST   runs random scenes far beyond the atlas's axes instead, one for each seed from FIRST to LAST
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
known_options "$@"

set_up
build
contact_fmus stability "$@"
