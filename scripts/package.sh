#!/usr/bin/env bash
# scripts/package.sh [SCENE.toml...]: release FMUs for Linux, Windows and macOS of all shipped scenes, or of those named:
# build/release/fmus/*.fmu (FMI 2.0) and build/release/fmus-fmi3/*.fmu (FMI 3.0). It compiles with zig, which it looks for
# as the Python package ziglang and on the path. The same sources give the same bytes.
#   --sundials-source DIR  sources of SUNDIALS for scenes with CVODE; without it they are fetched
#   -h, --help             prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
options=()
scenes=()
while (($#)); do
    case $1 in
        --sundials-source) (($# > 1)) || refuse "$1 lacks a value"; options+=("$1" "$2"); shift ;;
        -*) refuse "unknown argument $1" ;;
        *) scenes+=("$1") ;;
    esac
    shift
done
((${#scenes[@]})) || scenes=("$root"/modelDescription/scenes/*.toml)

use_build "$root/build"
release=$root/build/release
for scene in "${scenes[@]}"; do
    say "$(basename "$scene" .toml)"
    contact_fmus build "$scene" --platforms all --output "$release/fmus" "${options[@]}"
    contact_fmus build "$scene" --platforms all --fmi 3 --output "$release/fmus-fmi3" "${options[@]}"
done
