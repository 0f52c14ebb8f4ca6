"""Tables of constants, which the build computes, satisfy what defines them."""

import re
import subprocess
import sys

import numpy as np
import pytest
from numpy.polynomial import chebyshev, legendre

from support.generator.generated import ROOT

TABLE = re.compile(r"static const double (\w+)\[\d+\] = \{([^}]*)\}")


@pytest.fixture(scope="module")
def tables(tmp_path_factory):
    file = tmp_path_factory.mktemp("nodes") / "node_tables.c"
    subprocess.run([sys.executable, ROOT / "cmake" / "make_nodes.py", file], check=True)
    return {name: np.array(eval(f"[{values}]")) for name, values in TABLE.findall(file.read_text())}


def legendre_series(*coefficients):
    return legendre.Legendre(coefficients)


@pytest.mark.parametrize(("name", "points"), [("4", 4), ("8", 8), ("12", 12), ("radau_12", 12)])
def test_nodes_of_collocation_and_their_polynomials(tables, name, points):
    node = tables[f"node_{name}"]
    of_radau = legendre_series(*[0] * (points - 1), 1, -1)
    of_lobatto = legendre_series(*[0] * (points - 1), 1).deriv() * legendre_series(1 / 3, 0, -1 / 3)
    zero = of_radau if name == "radau_12" else of_lobatto
    assert np.abs(zero(node) / zero.deriv()(node)).max() < 1e-15  # the way to the root, by Newton's method
    assert (np.diff(node) > 0).all()
    assert node[-1] == 1.0 and (name == "radau_12" or (node == -node[::-1]).all())
    # l_j is 1 at node j and 0 at the others; its integrals are those of its monomials
    lagrange = np.polynomial.polynomial.polyval(node, tables[f"monomial_{name}"].reshape(points, points).T)
    assert np.abs(lagrange - np.eye(points)).max() < 1e-12
    integral = tables[f"integral_{name}"].reshape(points, points)
    for k in range(points):
        assert node**k @ integral == pytest.approx((node ** (k + 1) - (-1) ** (k + 1)) / (k + 1), abs=1e-15)


@pytest.mark.parametrize("stages", [4, 8, 12])
def test_stages_of_radau_and_their_eigenvalues(tables, stages):
    def of(name, *shape):
        return tables[f"radau_{name}_{stages}"].reshape(*shape)

    node = of("node", stages)
    integral, inverse = of("integral", stages, stages), of("inverse", stages, stages)
    eigenvalue = of("eigenvalue", -1, 2) @ [1, 1j]
    into = np.tensordot([1, 1j], of("into", -1, 2, stages), (0, 1))
    back = np.tensordot([1, -1j], of("back", stages, -1, 2), (0, 2))
    for k in range(stages):
        assert integral @ node**k == pytest.approx(node ** (k + 1) / (k + 1), abs=1e-15)
    assert integral @ inverse == pytest.approx(np.eye(stages), abs=1e-13)
    # a real vector is the real part of the sum of its parts; the inverse multiplies each by its eigenvalue
    assert (eigenvalue.imag > 0).all()
    assert (np.diff(eigenvalue.imag) > 0).all()
    assert (back @ into).real == pytest.approx(np.eye(stages), abs=1e-11)
    assert (back * eigenvalue @ into).real == pytest.approx(inverse, abs=1e-10)
    assert np.abs(back).max(axis=0) == pytest.approx(2)


@pytest.mark.parametrize("stages", [4, 8, 12])
def test_bases_in_which_events_are_sought(tables, stages):
    node = tables[f"radau_node_{stages}"]
    to_chebyshev = tables[f"radau_chebyshev_{stages}"].reshape(stages + 1, stages)
    to_bernstein = tables[f"radau_bernstein_{stages}"].reshape(-1, stages + 1)
    for k in range(1, stages + 1):
        assert chebyshev.chebval(2 * node - 1, to_chebyshev @ node**k) == pytest.approx(node**k, abs=1e-13)
    for k in range(stages + 1):
        # s^k has the Bernstein coefficients binomial(i, k) / binomial(n, k)
        i = np.arange(stages + 1)
        exact = np.prod([(i - j) / (stages - j) for j in range(k)], axis=0) * np.ones(stages + 1)
        values = np.concatenate([[0.0], node]) ** k
        assert values @ to_bernstein == pytest.approx(exact, abs=1e-12)
