#!/usr/bin/env bash
# scripts/setup.sh: installs what building, running and testing the contact FMUs needs on Debian 12 or later: Debian
# packages, a Python environment in .venv, and three.js by npm. Repeatable: a second run changes nothing.
# PYTHON=/path/to/python3 names another Python.
#   --demo         only what building and running need, without what the tests look at the code and the pages with
#   --peers        also the Debian package that the report's peers need
#   -h, --help     prints this
source "$(dirname "${BASH_SOURCE[0]}")/prologue.sh"
help_asked "$@"
known_options "$@"
purpose=tests
[[ " $* " != *" --demo "* ]] || purpose=demo

packages=(
    gcc libc6-dev cmake ninja-build
    git ca-certificates                        # where sources must be fetched instead
    python3 python3-venv
)
[[ $purpose == demo ]] || packages+=(
    libsundials-dev                            # CVODE
    build-essential clang                      # the other compiler that is supported
    clang-format clang-tidy                    # what the tests check the sources with
    libclang-rt-dev valgrind                   # fuzzers, and one more look at memory
    default-jdk-headless maven                 # VDMCheck, a validator of model descriptions, in the tests
    chromium                                   # shows the animations in the tests
)

[[ " $* " != *" --peers "* ]] || packages+=(r-cran-desolve)    # RADAU5

tell() { printf 'setup: %s\n' "$*"; }
fail() { printf 'setup: %s\n' "$*" >&2; exit 1; }

install_debian_packages() {
    command -v dpkg-query >/dev/null && command -v apt-get >/dev/null ||
        fail "this is no Debian: install what it calls ${packages[*]}; make .venv from requirements.txt"
    local package missing=()
    for package in "${packages[@]}"; do
        [[ $(dpkg-query -W -f '${db:Status-Abbrev}' "$package" 2>/dev/null) == ii* ]] || missing+=("$package")
    done
    if ((${#missing[@]} == 0)); then
        tell "Debian packages: already installed"
        return
    fi
    local as_root=()
    if ((EUID != 0)); then
        command -v sudo >/dev/null || fail "missing: ${missing[*]}. Run as root, or install sudo."
        as_root=(sudo)
    fi
    tell "Debian packages: installing ${missing[*]}"
    local apt=("${as_root[@]}" env DEBIAN_FRONTEND=noninteractive
        apt-get -qq -o Dpkg::Use-Pty=0 -o DPkg::Lock::Timeout=300)
    "${apt[@]}" update </dev/null
    # what dpkg tells of its progress is of no use; errors still show
    "${apt[@]}" install -y --no-install-recommends "${missing[@]}" </dev/null >/dev/null
}

# CVODE for the demo: libsundials-dev depends on some 340 packages, MPI, PETSc and a Fortran compiler among them, and
# CVODE on none of them. So its archives and headers alone go where cmake/ContactSundials.cmake looks for them.
unpack_sundials() {
    local target=$root/build/debian-sundials archives=(/usr/lib/*/libsundials_cvode.a) folder
    if [[ $purpose == tests || -e ${archives[0]} ]]; then
        rm -rf "$target"
        return
    elif [[ -d $target ]]; then
        tell "SUNDIALS: already unpacked"
        return
    fi
    tell "SUNDIALS: unpacking CVODE from libsundials-dev"
    folder=$(mktemp -d)
    chmod 755 "$folder"    # apt downloads as a user of its own
    (cd "$folder" && apt-get -qq download libsundials-dev </dev/null && dpkg-deb --extract ./*.deb "$folder")
    mkdir -p "$folder/fit/lib"
    cp "$folder"/usr/lib/*/libsundials_{cvode,nvecserial}.a "$folder/fit/lib"
    mv "$folder/usr/include" "$folder/fit"
    mkdir -p "$root/build"
    mv "$folder/fit" "$target"
    rm -r "$folder"
}

# The system's Python first: apt has just given it what venv needs. PYTHON=... has the last word.
find_python() {
    local candidate
    for candidate in ${PYTHON:+"$PYTHON"} /usr/bin/python3 python3; do
        if "$candidate" -c 'import ensurepip, sys, venv; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then
            printf '%s\n' "$candidate"
            return
        fi
    done
    fail "no Python 3.11 or later with venv; name one: PYTHON=/path/to/python3 ${BASH_SOURCE[0]}"
}

# What pyproject.toml asks for to build the package, to run it and to draw; requirements.txt says which version.
names_for_demo() {
    "$1" - "$root/pyproject.toml" <<'END'
import re, sys, tomllib
from pathlib import Path
about = tomllib.loads(Path(sys.argv[1]).read_text())
project = about["project"]
wanted = [*about["build-system"]["requires"], *project["dependencies"], *project["optional-dependencies"]["plot"]]
print(*sorted({re.match(r"[\w-]+", one)[0] for one in wanted}))
END
}

# An environment for the demo becomes one for the tests by what it lacks.
make_python_environment() {
    local python wanted has="" stamp=$root/.venv/made-from
    local -a names
    python=$(find_python)
    wanted="$("$python" --version), requirements.txt $(sha256sum <"$root/requirements.txt")"
    [[ ! -x $root/.venv/bin/python || ! -f $stamp ]] || has=$(<"$stamp")
    if [[ $has == "$wanted tests" || $has == "$wanted $purpose" ]]; then
        tell "Python environment .venv: already installed"
        return
    fi
    tell "Python environment .venv: installing requirements.txt for $("$python" --version)"
    if [[ $has != "$wanted demo" ]]; then
        rm -rf "$root/.venv"
        "$python" -m venv "$root/.venv"
    fi
    if [[ $purpose == tests ]]; then
        names=(-r "$root/requirements.txt")
    else
        read -ra names <<<"$(names_for_demo "$python")"
        names+=(--constraint "$root/requirements.txt")
    fi
    rm -f "$stamp"
    "$root/.venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-input "${names[@]}" </dev/null
    printf '%s\n' "$wanted $purpose" >"$stamp"    # last, so that an interrupted installation starts anew
}

# The command contact-fmus, by the sources of this clone; its C code is what the scripts build. The installation notes
# where each module lies, so a module that is new, moved or gone asks for another one.
install_package() {
    local about wanted stamp=$root/.venv/package-made-from
    # All of pyproject.toml before the settings of ruff and pytest, and the names of the modules
    about=$(sed '/^\[tool\.ruff\]/,$d' "$root/pyproject.toml" &&
        cd "$root/scripts" && find contact_fmus -name '*.py' | LC_ALL=C sort)
    wanted=$(sha256sum <<<"$about")
    if [[ -f $stamp && $(<"$stamp") == "$wanted" ]]; then
        tell "command contact-fmus: already installed"
        return
    fi
    tell "command contact-fmus: installing"
    rm -f "$stamp"
    "$root/.venv/bin/python" -m pip install --quiet --disable-pip-version-check --no-input --no-deps \
        --no-build-isolation --config-settings=wheel.cmake=false --editable "$root" </dev/null
    printf '%s\n' "$wanted" >"$stamp"
}

# three.js for the animations: from its npm package into one file, which pages carry. Where there is no npm, PyPI has it
# in one package, and Debian in hundreds.
make_three() {
    local python=$root/.venv/bin/python told
    command -v npm >/dev/null ||
        "$python" -m pip install --quiet --disable-pip-version-check --no-input \
            "$(sed -n 's/^NODE = "\(.*\)"$/\1/p' "$root/scripts/build_backend.py")" </dev/null
    told=$("$python" "$root/scripts/build_backend.py")
    tell "$told"
}

install_debian_packages
unpack_sundials
make_python_environment
[[ $purpose == demo ]] || make_three
install_package
tell "done"
