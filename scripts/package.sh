#!/usr/bin/env bash
# scripts/package.sh [SCENE.toml...]: release FMUs for Linux, Windows and macOS of all shipped scenes, or of those named:
# build/release/fmus/*.fmu (FMI 2.0) and build/release/fmus-fmi3/*.fmu (FMI 3.0). It compiles with zig, which it looks for
# as the Python package ziglang and on the path. All of them are in build/release/contact-fmus-VERSION.tar.gz, the archive
# of a release. The same sources give the same bytes.
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

version=$(sed -n 's/^project(contact_fmus VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
archive=$release/contact-fmus-$version.tar.gz
cp "$root/README.md" "$root/CHANGELOG.md" "$root/LICENSE" "$release"
# one order, owner and time, so that nothing of this machine or hour is inside
tar -C "$release" --sort=name --owner=0 --group=0 --numeric-owner --mtime=1980-01-01 \
    -c README.md CHANGELOG.md LICENSE fmus fmus-fmi3 | gzip -9n >"$archive"
say "$archive"
