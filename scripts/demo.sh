#!/usr/bin/env bash
# scripts/demo.sh: installs what the demo needs, builds the FMUs for FMI 2.0, runs every scenario of scripts/scenarios
# and prints what each claims, measures and expects, then what leaving out saves. Plots and an HTML page end up in
# build/scenarios. The status is 0 only when all claims hold.
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
(($# == 0)) || refuse "unknown argument $1"
cd "$root"

say "Set-up"
set_up --demo

say "Build"
build_fmus
printf 'built: %s\n' build/fmus/*.fmu

claims=0
say "Scenarios"
contact_fmus scenarios --output build/scenarios || claims=$?

say "Leave out"
contact_fmus leave-out

say "Pictures"
printf 'plots:     %s\nHTML page: %s\n' "$root/build/scenarios/plots" "$root/build/scenarios/index.html"
if ((claims != 0)); then
    printf 'Not every claim holds: see the table above.\n' >&2
fi
exit "$claims"
