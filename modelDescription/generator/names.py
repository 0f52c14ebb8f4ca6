"""Names that a scene must not have: its FMU, or a target of the build, would be taken for another one."""

from pathlib import Path

SHIPPED = Path(__file__).resolve().parent.parent / "scenes"

# Targets that CMake makes by itself with any of its generators, with and without CTest and CPack
# (cmake-policies(7), CMP0037). The project's own targets are checked by cmake/ContactFmu.cmake.
CMAKE_TARGETS = (
    *("all", "all_build", "clean", "continuous", "depend", "edit_cache", "experimental", "help", "install"),
    *("list_install_components", "nightly", "nightlymemorycheck", "package", "package_source", "preinstall"),
    *("rebuild_cache", "run_tests", "test", "zero_check"),
)


def refused_name(name: str, file: Path) -> str:
    """Why the scene in `file` cannot have this name, as a clause; '' where it can."""
    if name.lower() in CMAKE_TARGETS:
        return "a target that every CMake build has"
    for own in SHIPPED.glob("*.toml"):  # some file systems take capitals for small letters
        if own.stem.lower() == name.lower() and own.read_bytes() != file.read_bytes():
            return f"that of {own.stem}, a scene that ships with the project"
    return ""
