"""The values of every run, by its number: any stretch of runs, in any order, gives the same bits.

Lists and grids make every combination, the last one named fastest; at each combination all samples are
taken. Samples are numbers in [0, 1), one row for each: a Latin hypercube with the bits of scipy.stats.qmc,
sequences by scipy.stats.qmc itself. Of a Latin hypercube only the strata are kept, 4 bytes for each sample
and parameter; the place within a stratum is drawn again where it is needed, in blocks. Samples of a Latin
hypercube and random ones depend on the parameter's name, the seed and the count alone.
"""

from __future__ import annotations

import hashlib
import math
import warnings
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .spread import Parameter

METHODS = ("latin_hypercube", "random", "sobol", "halton")
# Samples drawn at a time from one seed: short enough to draw again for a batch, long enough to cost nothing.
BLOCK = 8192


@dataclass(frozen=True)
class Sampling:
    method: str = "latin_hypercube"
    count: int = 1
    seed: int = 0


class Samples:
    """Start values of runs 0 to `runs` - 1"""

    def __init__(self, parameters: Sequence[Parameter], sampling: Sampling):
        self.parameters = parameters
        self.listed = [one for one in parameters if not one.sampled]
        self.sampled = [one for one in parameters if one.sampled]
        self.sampling = sampling
        self.shape = tuple(len(one.values) for one in self.listed)
        self.samples = sampling.count if self.sampled else 1
        self.runs = math.prod(self.shape) * self.samples
        self._strata: dict[str, np.ndarray] = {}

    def prepare(self) -> None:
        """What takes a moment, where there are many samples"""
        if self.sampling.method == "latin_hypercube":
            for one in self.sampled:
                self._stratum(one.name)

    def values(self, first: int, count: int) -> dict[str, np.ndarray]:
        """By parameter: a row for each run of the stretch"""
        runs = np.arange(first, first + count)
        found: dict[str, np.ndarray] = {}
        if self.listed:
            places = np.unravel_index(runs // self.samples, self.shape)
            found = {one.name: one.values[place] for one, place in zip(self.listed, places, strict=True)}
        if self.sampled:
            uniform = self._uniform(first, count)
            for index, one in enumerate(self.sampled):
                found[one.name] = one.quantile(uniform[:, index])
        return {one.name: found[one.name] for one in self.parameters}

    def _uniform(self, first: int, count: int) -> np.ndarray:
        """Rows of numbers in [0, 1) for the stretch, which may begin again with the first sample"""
        parts = []
        while count > 0:
            start = first % self.samples
            size = min(count, self.samples - start)
            parts.append(self._stretch(start, size))
            first, count = first + size, count - size
        return parts[0] if len(parts) == 1 else np.concatenate(parts)

    def _stretch(self, start: int, size: int) -> np.ndarray:
        if self.sampling.method in ("sobol", "halton"):
            return self._sequence(start, size)
        columns = [self._jitter(one.name, start, size) for one in self.sampled]
        if self.sampling.method == "latin_hypercube":
            strata = [self._stratum(one.name)[start : start + size] for one in self.sampled]
            columns = [
                (stratum + jitter) / self.samples for stratum, jitter in zip(strata, columns, strict=True)
            ]
            # Rounding must not lift the last stratum to 1.
            columns = [np.minimum(column, np.nextafter(1.0, 0.0)) for column in columns]
        return np.stack(columns, axis=1)

    def _sequence(self, start: int, size: int) -> np.ndarray:
        from scipy.stats import qmc  # takes a second to import

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", UserWarning)  # a count that is no power of 2 is allowed
            if self.sampling.method == "sobol":
                engine: qmc.QMCEngine = qmc.Sobol(len(self.sampled), rng=self.sampling.seed)
            else:
                engine = qmc.Halton(len(self.sampled), rng=self.sampling.seed)
            if start:
                engine.fast_forward(start)
            return engine.random(size)

    def _stratum(self, name: str) -> np.ndarray:
        """Sample by sample the stratum of one parameter, 0 to count - 1: each once"""
        if name not in self._strata:
            # As scipy.stats.qmc.LatinHypercube permutes them, bit by bit; to import that takes a second.
            strata = np.arange(self.samples, dtype=np.uint32)
            self._generator(name, "strata").spawn(1)[0].shuffle(strata)
            self._strata[name] = strata
        return self._strata[name]

    def _jitter(self, name: str, start: int, size: int) -> np.ndarray:
        blocks = range(start // BLOCK, (start + size - 1) // BLOCK + 1)
        drawn = np.concatenate([self._generator(name, "block", block).random(BLOCK) for block in blocks])
        offset = start - blocks[0] * BLOCK
        return drawn[offset : offset + size]

    def _generator(self, name: str, *purpose: str | int) -> np.random.Generator:
        text = "\n".join([name, *map(str, purpose)])
        words = np.frombuffer(hashlib.sha256(text.encode()).digest(), np.uint32)
        return np.random.default_rng(np.random.SeedSequence([self.sampling.seed, *map(int, words)]))
