"""What the C code does not do: print, end the process, allocate unasked (keep state: test_layers.py)."""

import re

import pytest

from support import sources

every_file = pytest.mark.parametrize("file", sources.HEADERS + sources.UNITS, ids=sources.label)

PRINTS = r"\b(?:v?f?printf|puts|fputs|putchar|fputc|putc|fwrite|perror|stdout|stderr)\b"
ENDS = r"\b(?:exit|_Exit|quick_exit|abort|assert|longjmp|raise|signal)\s*\("
ALLOCATES = r"\b(?:malloc|calloc|realloc|aligned_alloc|free|strdup|alloca)\s*\("
HIDDEN_STATE = r"\b(?:strtok|rand|srand|setlocale|strerror|localtime|gmtime|getenv)\s*\("


@every_file
def test_nothing_prints(file):
    attribute = "format(printf,"  # lets the compiler check the arguments of the logger
    assert re.findall(PRINTS, sources.code_only(file.read_text()).replace(attribute, "")) == []


@every_file
def test_nothing_ends_the_process(file):
    assert re.findall(ENDS, sources.code_only(file.read_text())) == []


@every_file
def test_only_the_adapters_call_an_allocator(file):
    """Where the importer gives none, an adapter takes the C library's; the others ask their host."""
    if sources.layer(file) not in sources.ADAPTERS:
        assert re.findall(ALLOCATES, sources.code_only(file.read_text())) == []


@every_file
def test_nothing_uses_the_hidden_state_of_the_c_library(file):
    assert re.findall(HIDDEN_STATE, sources.code_only(file.read_text())) == []


@pytest.mark.parametrize("scene", sources.SCENES)
def test_the_state_of_motion_has_no_padding(scene):
    """Saved states are its bytes, with a checksum over all of them."""
    unit = sources.SOURCE / "scene" / "scene_state.c"
    said = sources.compile_c("gcc", unit, scene, "-Wpadded", "-fsyntax-only")
    assert [line for line in said.splitlines() if "scene_state.h" in line and "error:" in line] == []


def test_the_patterns_find_what_they_look_for():
    bad = 'int n; void f(void) { printf("%d", n); /* exit */ abort(); free(strerror(1)); }'
    assert re.findall(PRINTS, sources.code_only(bad)) == ["printf"]
    assert re.findall(ENDS, sources.code_only(bad)) == ["abort("]
    assert re.findall(ALLOCATES, sources.code_only(bad)) == ["free("]
    assert re.findall(HIDDEN_STATE, sources.code_only(bad)) == ["strerror("]
    assert re.findall(PRINTS, sources.code_only('snprintf(text, 3, "printf");')) == []
