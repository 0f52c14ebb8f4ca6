"""Samples: strata, seeds, scales, and the same bits however the runs are cut"""

from itertools import pairwise

import numpy as np
import pytest
from scipy import stats
from scipy.stats import qmc

from support.sweeps import read, write_study

RADIUS, FORCE = "source.radius", "contact.penalty_factor"


def samples_of(folder, vary, count, method="latin_hypercube"):
    file = write_study(folder, vary=vary, count=count)
    file.write_text(file.read_text().replace("seed = 3", f'seed = 3\nmethod = "{method}"'))
    return read(file).samples()


def test_each_stratum_of_each_parameter_has_one_sample(tmp_path):
    count = 2000
    vary = {RADIUS: "{ range = [0.05, 0.15] }", FORCE: '{ range = [1e5, 1e8], scale = "log" }'}
    values = samples_of(tmp_path, vary, count).values(0, count)
    linear = (values[RADIUS][:, 0] - 0.05) / 0.1
    logarithmic = np.log(values[FORCE][:, 0] / 1e5) / np.log(1e3)
    for unit in (linear, logarithmic):
        assert np.bincount(np.floor(unit * count).astype(int), minlength=count).tolist() == [1] * count
        # evenly spread within its stratum too: not all in the middle
        assert stats.kstest(np.modf(unit * count)[0], "uniform").pvalue > 1e-3
    # one parameter says nothing of the other
    assert abs(stats.spearmanr(linear, logarithmic).statistic) < 4 / np.sqrt(count)


def test_a_latin_hypercube_is_that_of_scipy(tmp_path):
    for count in (1, 2, 9000):
        samples = samples_of(tmp_path, {RADIUS: "{ range = [0.05, 0.15] }"}, count)
        engine = qmc.LatinHypercube(1, scramble=False, rng=samples._generator(RADIUS, "strata"))
        centers = engine.random(count)[:, 0] * count
        values = samples.values(0, count)[RADIUS][:, 0]
        assert np.floor((values - 0.05) / 0.1 * count).tolist() == np.floor(centers).tolist()


@pytest.mark.parametrize("method", ["latin_hypercube", "random", "sobol", "halton"])
def test_runs_have_the_same_bits_however_they_are_cut(tmp_path, method):
    vary = {"contact.dashpot": '["unclamped", "non_adhesive", "approach_only"]'}
    vary |= {RADIUS: "{ range = [0.05, 0.15] }", FORCE: '{ range = [1e5, 1e8], scale = "log" }'}
    count = 9000  # more than a block
    whole = samples_of(tmp_path, vary, count, method).values(0, 3 * count)
    cuts = [0, 1, 5, 8190, 8193, 9000, 17_000, 27_000]
    again = samples_of(tmp_path, vary, count, method)
    for first, end in pairwise(cuts):
        part = again.values(first, end - first)
        for name, column in whole.items():
            assert np.array_equal(part[name], column[first:end]), (name, first)
    # every sample at every value of the list
    assert np.array_equal(whole[RADIUS][:count], whole[RADIUS][count : 2 * count])
    assert np.unique(whole["contact.dashpot"], return_counts=True)[1].tolist() == [count] * 3
    assert len(np.unique(whole[RADIUS])) == count


def test_grids_make_every_combination_the_last_fastest(tmp_path):
    vary = {FORCE: '{ from = 1e4, to = 1e6, count = 3, scale = "log" }', "contact.method": '["penalty"]'}
    vary |= {"source.center": "[[0.0, 0.0, 1.0], [0.0, 0.0, 2.0]]"}
    text = write_study(tmp_path, vary=vary, count=0)
    text.write_text(text.read_text().replace('[start]\n"contact.method" = "penalty_dynamic"', ""))
    values = read(text).samples().values(0, 6)
    assert values[FORCE][:, 0] == pytest.approx([1e4, 1e4, 1e5, 1e5, 1e6, 1e6], rel=1e-12)
    assert values["source.center"][:, 2].tolist() == [1.0, 2.0] * 3
    assert values["contact.method"][:, 0].tolist() == [1] * 6


@pytest.mark.parametrize("entry,expected", [
    ('{ distribution = "normal", mean = 2.0, deviation = 0.2 }', stats.norm(2.0, 0.2)),
    ('{ distribution = "lognormal", median = 2.0, deviation = 0.3 }', stats.lognorm(0.3, scale=2.0)),
    ('{ distribution = "triangular", range = [1.0, 4.0], mode = 2.0 }', stats.triang(1 / 3, 1.0, 3.0)),
    ('{ distribution = "normal", mean = 2.0, deviation = 1.0, range = [1.5, 4.0] }',
        stats.truncnorm(-0.5, 2.0, 2.0, 1.0)),
])  # fmt: skip
def test_samples_have_the_distribution_asked_for(tmp_path, entry, expected):
    values = samples_of(tmp_path, {"source.mass": entry}, 5000).values(0, 5000)
    # A Latin hypercube's distribution function is off by less than one stratum.
    assert stats.kstest(values["source.mass"][:, 0], expected.cdf).statistic <= 1 / 5000 + 1e-12


def test_another_parameter_leaves_the_samples_of_the_first(tmp_path):
    one = {RADIUS: "{ range = [0.05, 0.15] }"}
    two = {FORCE: "{ range = [1e5, 1e8] }", **one}
    alone, both = (samples_of(tmp_path, vary, 100).values(0, 100)[RADIUS] for vary in (one, two))
    assert np.array_equal(alone, both)
