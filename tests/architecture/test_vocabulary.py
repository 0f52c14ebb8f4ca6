"""docs/vocabulary.md names places that there are."""

import re

from support.sources import ROOT, SOURCE

PAGE = (ROOT / "docs" / "vocabulary.md").read_text(encoding="utf-8")
PLACES = set(re.findall(r"`(\w+/\w+\.[ch])`", PAGE))


def test_every_place_is_a_file():
    assert len(PLACES) > 40
    assert sorted(place for place in PLACES if not (SOURCE / place).is_file()) == []


def test_every_regime_has_its_row():
    law = (SOURCE / "contact" / "law.h").read_text(encoding="utf-8")
    regimes = set(re.findall(r"\bREGIME_[A-Z]+\b", law))
    assert len(regimes) == 4
    assert sorted(name for name in regimes if f"| {name} |" not in PAGE) == []


def test_every_regime_of_friction_has_its_row():
    friction = (SOURCE / "contact" / "friction.h").read_text(encoding="utf-8")
    regimes = set(re.findall(r"\bFRICTION_[A-Z]+\b", friction)) - {"FRICTION_NONE", "FRICTION_REGULARIZED"}
    assert len(regimes) == 4
    assert sorted(name for name in regimes if f"| {name} |" not in PAGE) == []
