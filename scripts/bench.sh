#!/usr/bin/env bash
# scripts/bench.sh: installs what is missing, builds, and prints how fast the FMUs are: instruction counts and their
# bounds, what a step in flight costs, event_driven against CVODE, stiff against soft.
#   --quick               few runs
#   --instructions        the instruction counts only
#   --against DIR         with --instructions: beside those of the FMUs in DIR, such as another clone's build/fmus
#   --baseline COMMIT     run times of this build beside those of another commit as well
#   --check               the status is 1 where a count or a ratio is not as promised
#   -h, --help            prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
known_options "$@"

set_up
build
contact_fmus bench "$@"
