"""The Galton board of scripts/studies: by which gaps do the balls leave?"""

import re
from math import comb
from pathlib import Path

import numpy as np
from scipy.stats import chi2

from support.sweeps import read, run_here

STUDY = Path(__file__).resolve().parents[2] / "scripts" / "studies" / "galton_board.toml"
GRAVITY, PITCH, ROWS, DROP = 9.81, 0.023, 7, 0.018  # m/s^2; m between pegs of a row, m between rows
# Balls by gap, of the 100,000 of the study (results.parquet, counted by gaps_of)
STUDIED = np.array([408, 4587, 16215, 28693, 28818, 16342, 4517, 420])
BINOMIAL = np.array([comb(ROWS, k) for k in range(ROWS + 1)]) / 2**ROWS


def gaps_of(x, z, speed_x, speed_z):
    """The gap of each ball, counted from the left, from where it is later: it falls freely from there"""
    level = -(ROWS - 1) * DROP - 0.01  # a ball's centre below the middles of the lowest pegs
    assert np.all(z < level - 0.1)
    since = (-speed_z - np.sqrt(speed_z**2 - 2.0 * GRAVITY * (level - z))) / GRAVITY
    left = x - speed_x * since
    return np.clip(np.floor(left / PITCH + (ROWS + 1) / 2), 0, ROWS).astype(int)


def test_the_gaps_are_those_of_the_large_study_and_nearly_binomial(tmp_path):
    """The chance of a wrong alarm is 1e-6, that of a chi-squared beyond its limit."""
    few = tmp_path / "few.toml"
    few.write_text(
        re.sub(r"count = .*\nseed = 1", "count = 3000\nseed = 2", STUDY.read_text(encoding="utf-8"))
    )
    _, rows = run_here(read(few))
    assert not rows.status.any()
    counts = np.bincount(gaps_of(*rows.values), minlength=ROWS + 1)
    total, share = counts + STUDIED, counts.sum() / (counts.sum() + STUDIED.sum())
    apart = np.sum((counts - share * total) ** 2 / (share * (1.0 - share) * total))
    assert apart < chi2.isf(1e-6, ROWS)
    off = STUDIED - STUDIED.sum() * BINOMIAL  # the walls push back: fewer balls at the ends than binomial
    assert np.abs(off).sum() / 2.0 < 0.04 * STUDIED.sum()
