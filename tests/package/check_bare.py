"""The wheel in a bare Debian 12, as root: `.venv/bin/python -m pytest tests/package/check_bare.py`

From `pip install` to an animation of a new scene, with gcc, then with zig. It takes some three minutes and
the network, so that `scripts/test.sh` does not run it."""

import shutil
from pathlib import Path

import pytest

from support.programs import PATIENCE, checked, finished

# The way to the network
FROM_HERE = ("/etc/resolv.conf", "/etc/pip.conf", "/etc/ssl/certs/ca-certificates.crt")
GCC = ("cc", "gcc", "gcc-12", "x86_64-linux-gnu-gcc", "x86_64-linux-gnu-gcc-12")


@pytest.fixture(scope="module")
def bare(tmp_path_factory, wheel):
    """Debian with Python and gcc, and the wheel in its root folder"""
    root = tmp_path_factory.mktemp("bare") / "root"
    include = "--include=gcc,libc6-dev,python3-venv,ca-certificates"
    checked(["debootstrap", "--variant=minbase", include, "bookworm", root], timeout=PATIENCE)
    for file in FROM_HERE:
        if Path(file).is_file():
            shutil.copy(file, root / file[1:])
    shutil.copy(wheel, root)
    for folder in ("dev", "proc"):  # zig asks /proc where it is
        finished(["mount", "--bind", f"/{folder}", root / folder], check=True)
    yield root
    for folder in ("dev", "proc"):
        finished(["umount", root / folder], check=True)
    shutil.rmtree(root)


def from_install_to_animation(bare, wheel, extras):
    """What it said"""
    script = f"""set -e
        rm -rf /env /work && mkdir /work && cd /work
        python3 -m venv /env && . /env/bin/activate
        pip install --quiet '/{wheel.name}[{extras}]'
        contact-fmus run SphereSphere --plot
        contact-fmus new Mine --shape cylinder
        contact-fmus build Mine.toml
        contact-fmus run Mine.fmu --csv mine.csv
        contact-fmus animate Mine.fmu"""
    environment = {"PATH": "/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root"}
    done = finished(["chroot", bare, "bash", "-c", script], env=environment)
    assert done.returncode == 0, done.stdout + done.stderr
    for file in ("SphereSphere.png", "Mine.fmu", "mine.csv", "Mine.html"):
        assert (bare / "work" / file).stat().st_size > 0
    return done.stdout


def test_with_gcc(bare, wheel):
    assert "gcc" in from_install_to_animation(bare, wheel, "plot")


def test_with_zig_where_gcc_is_away(bare, wheel):
    for name in GCC:
        (bare / "usr/bin" / name).unlink(missing_ok=True)
    assert "zig" in from_install_to_animation(bare, wheel, "plot,zig")
