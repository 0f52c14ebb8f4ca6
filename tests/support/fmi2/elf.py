"""What binutils know of a shared library."""

import itertools
import re
import subprocess


def run(*command):
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def needed(library):
    """Returns names of the libraries that the loader brings along."""
    return set(re.findall(r"\(NEEDED\).*\[(.*)\]", run("readelf", "-dW", library)))


def exported(library):
    """Returns names that others can link to."""
    lines = run("nm", "-D", "--defined-only", library).splitlines()
    return {line.split()[-1].partition("@")[0] for line in lines}


def glibc_version(library):
    """Returns the oldest glibc that has everything the library asks of it, as (2, 29)."""
    versions = re.findall(r"GLIBC_(\d+)\.(\d+)", run("readelf", "-VW", library))
    return max((int(major), int(minor)) for major, minor in versions)


def symbols(library):
    """Returns all names in the symbol table of a library that was not stripped, static functions included."""
    table = run("nm", library)
    assert table.strip(), f"{library} is stripped"
    return {line.split()[-1].partition("@")[0] for line in table.splitlines()}


def lines_with_code(library):
    """(file name, line) of each source line that left an instruction, from the debug information."""
    rows = re.findall(r"^(\S+\.[ch])\s+(\d+|-)\s+(0x[0-9a-f]+)", run("readelf", "-wL", library), re.MULTILINE)
    assert rows, f"{library} has no debug information"
    # A row holds up to the address of the next; one of no byte is optimized away. "-" ends a sequence.
    return {
        (name, int(line))
        for (name, line, start), (_, _, end) in itertools.pairwise(rows)
        if line != "-" and int(end, 16) != int(start, 16)
    }


def text(library):
    """Returns the printable strings of the whole file."""
    return run("strings", "-a", "-n", "4", library)
