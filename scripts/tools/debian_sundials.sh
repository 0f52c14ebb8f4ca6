# shellcheck shell=bash
# debian_sundials DIR: prints the folder of SUNDIALS' sources below DIR, those of Debian 12, which the shipped FMUs of one
# platform are linked with. Downloads them where they are not there yet; prints nothing where apt-get does not have them.

sundials_version=6.4.1+dfsg1
# of sundials_6.4.1+dfsg1.orig.tar.xz, as the signed sundials_6.4.1+dfsg1-3.dsc has it
sundials_sha256=c61157f1d4be06c704bea40cb131eb63ba2dada161989071604d0a0959cdf04a

debian_sundials() {
    local folder=$1 archive=$1/sundials_$sundials_version.orig.tar.xz
    mkdir -p "$folder"
    if [[ ! -f $archive ]]; then
        command -v apt-get >/dev/null || return 0
        _download_debian_sundials "$folder" >&2 || return 0
    fi
    sha256sum --quiet --check <<<"$sundials_sha256  $archive" >&2 || return 1
    [[ -d $folder/sundials-6.4.1 ]] || tar -C "$folder" -xf "$archive"
    printf '%s\n' "$folder/sundials-6.4.1"
}

# By the sources of packages where this machine has its packages from, which its own lists need not name.
_download_debian_sundials() {
    local apt=$1/apt file
    mkdir -p "$apt/lists/partial" "$apt/parts"
    for file in /etc/apt/sources.list.d/debian.sources; do
        [[ ! -f $file ]] || sed 's/^Types: .*/Types: deb-src/' "$file" >"$apt/parts/debian.sources"
    done
    if [[ -f /etc/apt/sources.list ]]; then
        sed -n 's/^deb /deb-src /p' /etc/apt/sources.list >"$apt/parts/debian.list"
    fi
    local options=(-qq -o Dir::Etc::sourcelist=/dev/null -o "Dir::Etc::sourceparts=$apt/parts"
        -o "Dir::State::lists=$apt/lists" -o Dir::Cache::pkgcache= -o Dir::Cache::srcpkgcache= -o APT::Sandbox::User=root)
    apt-get "${options[@]}" update </dev/null &&
        (cd "$1" && apt-get "${options[@]}" source --download-only "sundials=$sundials_version-3" </dev/null)
}
