#!/usr/bin/env bash
# scripts/mutate.sh: breaks the C code in a few hundred small ways, one at a time, and lists what no test notices.
# Builds as the other scripts do and works in build-mutation, never in the sources. Results are in
# build-mutation/mutants.csv, where a run that was stopped goes on, and in docs/mutation.md, with the reasons of
# scripts/contact_fmus/mutation/reasons.toml. The status is 1 when a change that no test notices has no reason.
#   --count N      changes that compile, instead of 300
#   --seed S       another choice of changes; 1 without it
#   --only FILE    only in files whose name has FILE
#   --minutes N    stops after about as long
#   --jobs N       so many changes at once; 1 without it
#   --patience S   processor's time for the tests that a change meets which the quick ones let pass; 60 s, all take 300
#   --again        forgets the results of earlier runs
#   --page         only writes docs/mutation.md anew
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
options=()
while (($# > 0)); do
    case $1 in
        --count | --seed | --minutes | --jobs | --patience)
            [[ ${2:-} =~ ^[0-9]+$ ]] || refuse "$1 takes a whole number"; options+=("$1" "$2"); shift 2 ;;
        --only) [[ -n ${2:-} ]] || refuse "--only lacks its file"; options+=("$1" "$2"); shift 2 ;;
        --again | --page) options+=("$1"); shift ;;
        *) refuse "unknown argument $1" ;;
    esac
done

set_up
build
contact_fmus mutate "${options[@]}"
