"""The force law stands once: who needs a force, its slopes or its events asks contact/law.h."""

import re

import pytest

from support.sources import HEADERS, UNITS, code_only, label

# The law's own constants, p_n and p_nv, or k_h and chi.
READS = r"(?:->|\.)(?:stiffness|damping)\b"
LAW = {
    "fmu_src/contact/law.h", "fmu_src/contact/law.c",
    "fmu_src/model/inputs.c",  # which makes them from the user's choices
}  # fmt: skip
# Of the tangential spring and dashpot of elastic friction, k_t and c_t: a law of its own.
OF_FRICTION = {
    "fmu_src/contact/friction.c", "fmu_src/contact/slopes.c", "fmu_src/scene/evaluate.c",
    "fmu_src/scene/ode.c",  # of friction alone; the normal law it asks
    "fmu_src/scene/transition.c", "fmu_src/prescribed/prescribed.c",
}  # fmt: skip
# The recurrences of Hertz's law: its series is made with k_h, as closed forms are with p_n.
HERTZ = {label(file) for file in UNITS if re.fullmatch(r"(?:pair_)?hertz(?:_\w+)?\.c", file.name)}

# The constants k and c of the linear law, for what is in closed form because the law is linear, those of any
# law, and for the factors that users see.
ASKS_FOR_CONSTANTS = r"\bcontact_(?:coefficients|factors)_of\("
FAST_PATHS = {
    "fmu_src/touch/pair.c", "fmu_src/touch/segment.c", "fmu_src/touch/chain.c", "fmu_src/touch/island.c",
}  # fmt: skip
FACTORS = {
    "fmu_src/model/outputs.c",
    "fmu_src/integrator/general.c",  # whose depth to come is made with k_h
    "fmu_src/scene/evaluate.c",  # whose speed of an onset from rest is made with k_h
}  # fmt: skip

# k g + c g', by whatever names.
FORMULA = r"\b(?:k|stiffness) \* [^;]*gap\b[^;]*\+[^;]*\b(?:c|damping) \* [^;]*rate\b"

every_file = pytest.mark.parametrize("file", HEADERS + UNITS, ids=label)


@every_file
def test_only_the_law_reads_stiffness_and_damping(file):
    if label(file) not in LAW | OF_FRICTION | HERTZ:
        assert re.findall(READS, code_only(file.read_text())) == []


@every_file
def test_only_fast_paths_and_reported_factors_ask_for_the_constants(file):
    if label(file) not in LAW | FAST_PATHS | FACTORS:
        assert re.findall(ASKS_FOR_CONSTANTS, code_only(file.read_text())) == []


@every_file
def test_the_formula_stands_once(file):
    found = re.findall(FORMULA, code_only(file.read_text()))
    assert len(found) == (1 if label(file) == "fmu_src/contact/law.c" else 0)


def test_the_allowed_files_exist_and_make_use_of_it():
    texts = {label(file): code_only(file.read_text()) for file in HEADERS + UNITS}
    for name in FAST_PATHS | FACTORS:
        assert re.search(ASKS_FOR_CONSTANTS, texts[name]), name
