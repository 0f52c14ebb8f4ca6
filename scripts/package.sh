#!/usr/bin/env bash
# scripts/package.sh [SCENE.toml...]: release FMUs for Linux, Windows and macOS of all shipped scenes, or of those named:
# build/release/fmus/*.fmu (FMI 2.0) and build/release/fmus-fmi3/*.fmu (FMI 3.0). It compiles with zig, and installs
# requirements-package.txt for that. All shipped scenes together become build/release/contact-fmus-VERSION.tar.gz, the
# archive of a release, with headers and library of the model for C. The same sources give the same bytes.
#   --sundials-source DIR  sources of SUNDIALS for scenes with CVODE; without it Debian's source package, which
#                          build/release-sundials keeps, or elsewhere than on Debian the project's repository
#   --check                makes what is missing there, of all shipped scenes or of those named, and runs it: Windows by
#                          wine, ARM by qemu, the sources by other compilers and in a bare Debian, macOS inspected, all
#                          built again elsewhere. Installs what that needs and wants to be root. Nothing of it is among
#                          the tests of scripts/test.sh.
#   -h, --help             prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
source "$root/scripts/tools/debian_sundials.sh"
help_asked "$@"
sundials=
check=
scenes=()
while (($#)); do
    case $1 in
        --sundials-source) (($# > 1)) || refuse "$1 lacks a value"; sundials=$2; shift ;;
        --check) check=yes ;;
        -*) refuse "unknown argument $1" ;;
        *) scenes+=("$1") ;;
    esac
    shift
done
release=$root/build/release
version=$(sed -n 's/^project(contact_fmus VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
archive=$release/contact-fmus-$version.tar.gz

install_tools() {
    "$python" -m pip install --quiet --disable-pip-version-check --no-input \
        -r "$root/requirements.txt" -r "$root/requirements-package.txt" </dev/null
    [[ -n $sundials ]] || sundials=$(debian_sundials "$root/build/release-sundials")
}

make_fmus() {
    local options=()
    [[ -z $sundials ]] || options+=(--sundials-source "$sundials")
    say "FMI 2.0"
    contact_fmus build "$@" --platforms all --output "$release/fmus" "${options[@]}"
    say "FMI 3.0"
    contact_fmus build "$@" --platforms all --fmi 3 --output "$release/fmus-fmi3" "${options[@]}"
}

make_archive() {
    say "Archive"
    rm -rf "$release/c"
    cmake --install "$root/build" --component c --prefix "$release/c" >/dev/null
    cp -r "$root/examples/c" "$release/c/example"
    cp "$root/README.md" "$root/CHANGELOG.md" "$root/LICENSE" "$release"
    # one order, owner and time, so that nothing of this machine or hour is inside
    tar -C "$release" --sort=name --owner=0 --group=0 --numeric-owner --mode=u+rw,go+r-w --mtime=1980-01-01 \
        -c README.md CHANGELOG.md LICENSE c fmus fmus-fmi3 | gzip -9n >"$archive"
    printf '%s\n' "$archive"
}

run_checks() {
    local as_root=() missing=() package
    ((EUID == 0)) || as_root=(sudo)
    for package in wine64 qemu-user-static libc6-arm64-cross gcc-mingw-w64-x86-64 debootstrap; do
        [[ $(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null) == ii* ]] || missing+=("$package")
    done
    if ((${#missing[@]})); then
        say "Installing ${missing[*]}"
        "${as_root[@]}" apt-get -qq update </dev/null
        "${as_root[@]}" env DEBIAN_FRONTEND=noninteractive \
            apt-get -qq install -y --no-install-recommends "${missing[@]}" </dev/null >/dev/null
    fi
    say "Checks"
    cd "$root/tests/platforms"
    PYTHONPATH=$root/scripts:$root/tests CONTACT_RELEASE=$release CONTACT_SUNDIALS_SOURCE=$sundials \
        CONTACT_CHECKED="${*##*/}" "$python" -m pytest -q check_release.py check_sources.py </dev/null
}

# The ordinary build of these scenes, which the release is compared with, in both versions of FMI
build_ordinary() {
    local name targets=()
    for name in "$@"; do
        name=$(basename "$name" .toml)
        [[ -f $root/modelDescription/scenes/$name.toml ]] || refuse "--check: $name is no scene that is shipped"
        targets+=("${name}_fmu" "${name}_fmi3_fmu")
    done
    (cd "$root" && cmake --preset default -Wno-dev --log-level=WARNING -DPython3_EXECUTABLE="$python" &&
        cmake --build --preset default --target "${targets[@]}" -- --quiet)
}

set_up
use_build "$root/build"
install_tools
shipped=("$root"/modelDescription/scenes/*.toml)
if [[ -n $check ]]; then
    ((${#scenes[@]})) || scenes=("${shipped[@]}")
    build_ordinary "${scenes[@]}"
    missing=()
    for scene in "${scenes[@]}"; do
        fmu=$(basename "$scene" .toml).fmu
        [[ -f $release/fmus/$fmu && -f $release/fmus-fmi3/$fmu ]] || missing+=("$scene")
    done
    ((${#missing[@]} == 0)) || make_fmus "${missing[@]}"
    run_checks "${scenes[@]}"
elif ((${#scenes[@]})); then
    make_fmus "${scenes[@]}"
else
    build
    make_fmus "${shipped[@]}"
    make_archive
fi
