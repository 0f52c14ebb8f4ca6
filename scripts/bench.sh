#!/usr/bin/env bash
# scripts/bench.sh: installs what is missing, builds, and prints how many instructions the FMUs execute, and their
# bounds.
#   --against DIR  also counts those of the FMUs in DIR, such as another clone's build/fmus
#   --check        the status is 1 where a count is above its bound
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
known_options "$@"

set_up
build
contact_fmus bench "$@"
