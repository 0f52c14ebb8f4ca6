#!/usr/bin/env bash
# scripts/fuzz.sh: runs each fuzzer ten minutes. New inputs are kept in build-fuzz/found/NAME, what broke a claim in
# build-fuzz/findings/NAME; `build-fuzz/tests/fuzz/fuzz_NAME FILE` runs one again and prints its values. The status is 1
# when there is a finding, or a fuzzer did not run.
#   --minutes N    instead of ten
#   --only NAME    one fuzzer: calls and calls3 (any calls of Co-Simulation, FMI 2.0 and 3.0), exchange and exchange3 (of
#                  Model Exchange), these three with _turning, _plane, _caps or _cvode (other scenes), state, run_sphere,
#                  run_cylinder, run_plane, run_three_balls, run_two_pairs, scene_files
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
known_options "$@"

set_up
use_build "$root/build"
"$python" "$root/tests/fuzz/search.py" "$@"
