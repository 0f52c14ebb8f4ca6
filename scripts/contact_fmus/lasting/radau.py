"""Coefficients of Radau IIA with any number of stages, as build/lasting_contact reads them.

The nodes are the zeros of P_s(2 c - 1) - P_(s-1)(2 c - 1) (Hairer and Wanner, Solving Ordinary Differential
Equations II, IV.5); everything else follows in the basis of Legendre polynomials, which keeps the digits.
The Newton iteration of a step splits into systems of the size of the problem, one for each real eigenvalue
of A^-1 and one for each conjugate pair (IV.8).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.polynomial import legendre


@dataclass(frozen=True)
class Radau:
    nodes: np.ndarray  # c
    matrix: np.ndarray  # A
    inverse: np.ndarray  # A^-1


def _values(at: np.ndarray, degree: int) -> np.ndarray:
    """[i, k]: P_k(2 at_i - 1)"""
    return legendre.legvander(2.0 * at - 1.0, degree)


def _integrals(at: np.ndarray, degree: int) -> np.ndarray:
    """[i, k]: the integral of P_k(2 t - 1) from 0 to at_i"""
    columns = [
        0.5 * legendre.legval(2.0 * at - 1.0, legendre.legint(unit, lbnd=-1)) for unit in np.eye(degree + 1)
    ]
    return np.array(columns).T


def radau(stages: int) -> Radau:
    polynomial = np.zeros(stages + 1)
    polynomial[-2:] = -1.0, 1.0
    nodes = 0.5 * (1.0 + np.sort(legendre.legroots(polynomial).real))
    nodes[-1] = 1.0
    integrals, values = _integrals(nodes, stages - 1), _values(nodes, stages - 1)
    matrix = np.linalg.solve(values.T, integrals.T).T
    return Radau(nodes, matrix, np.linalg.solve(integrals.T, values.T).T)


def coefficients(stages: int) -> str:
    """The standard input of lasting_contact"""
    method = radau(stages)
    eigenvalues, vectors = np.linalg.eig(method.inverse)
    covectors = np.linalg.inv(vectors)
    kept = [k for k, value in enumerate(eigenvalues) if value.imag >= 0.0]
    weight = [1.0 if eigenvalues[k].imag == 0.0 else 2.0 for k in kept]
    numbers = [weight, _parts(eigenvalues[kept])]
    for i in range(stages):
        numbers += [method.inverse[i], _parts(vectors[i, kept])]
    numbers += [_parts(covectors[k]) for k in kept]
    lines = [f"{stages} {len(kept)}"] + [" ".join(f"{x:.17g}" for x in row) for row in numbers]
    return "\n".join(lines) + "\n"


def _parts(row: np.ndarray) -> np.ndarray:
    """Real and imaginary parts in turn"""
    return np.ascontiguousarray(row, dtype=complex).view(float)
