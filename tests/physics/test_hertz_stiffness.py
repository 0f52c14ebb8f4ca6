"""The stiffness that Hertz's theory makes of materials and radii; a ball that hardly fits."""

import itertools
import math

import pytest
from scipy.integrate import quad
from scipy.optimize import brentq

from support.checks import check_relative, start


def elliptic(modulus, a, b):
    """k_h from the integrals of the pressure under an ellipse themselves, by quadrature and without elliptic
    integrals in closed form: K. L. Johnson, Contact Mechanics (1985), (3.65) and (4.25), semi-axes 1 and k.
    """

    def between(ratio, rate):  # of the scales of the integrand, and beyond the last
        places = [0.0, ratio, 1.0, 10.0, math.inf]
        parts = itertools.pairwise(places)
        return 2 * sum(quad(rate, *part, epsabs=0.0, epsrel=1e-13)[0] for part in parts)

    def integral(axis, other):  # of dw/((axis^2 + w) sqrt((axis^2 + w)(other^2 + w) w)), with w = t^2
        return between(
            min(axis, other),
            lambda t: 1 / ((axis**2 + t**2) * math.sqrt((axis**2 + t**2) * (other**2 + t**2))),
        )

    ratio = brentq(lambda k: integral(1, k) / integral(k, 1) - a / b, a / b, 1 - 1e-9, xtol=1e-15)
    depth = between(ratio, lambda t: 1 / math.sqrt((1 + t**2) * (ratio**2 + t**2)))
    # p_0 = 1: A = k/(2 E*) integral(1, k), delta = k/(2 E*) depth, load 2 pi k/3; lengths grow with the scale
    scale = ratio / (2 * modulus) * integral(1, ratio) / a
    return 2 * math.pi * ratio / 3 * scale**2 / (ratio / (2 * modulus) * depth * scale) ** 1.5


MATERIALS = {"source": (7e10, 0.33), "destination": (2e9, 0.4)}
MODULUS = 1 / sum((1 - nu**2) / e for e, nu in MATERIALS.values())


def automatic(radius, shell, location):
    values = {"contact.law": "hertz", "contact.penalty_control": "automatic", "contact.location": location}
    values |= {"source.radius": radius, "destination.radius": shell, "source.center": [0.0, 0.5 * shell, 0.0]}
    for body, (modulus, ratio) in MATERIALS.items():
        values |= {f"{body}.youngs_modulus": modulus, f"{body}.poissons_ratio": ratio}
    return values


@pytest.mark.parametrize("location", ["outside", "inside"])
def test_stiffness_of_spheres_is_that_of_hertz(opened, location):
    for radius, shell in ((0.1, 0.5), (2.0, 2.5), (1e-3, 40.0)):
        fmu = start(opened("SphereSphere"), automatic(radius, shell, location))
        sign = 1 if location == "outside" else -1
        expected = 4 / 3 * MODULUS * math.sqrt(radius * shell / (shell + sign * radius))
        check_relative("k_h", fmu["contact.effective_hertz_stiffness"], expected, 1e-14)


@pytest.mark.parametrize("location", ["outside", "inside"])
def test_stiffness_of_sphere_and_cylinder_is_that_of_the_elliptic_contact(opened, location):
    for radius, shell in ((0.1, 0.5), (0.4, 0.5), (1e-2, 40.0)):
        fmu = start(opened("SphereCylinder"), automatic(radius, shell, location))
        sign = 1 if location == "outside" else -1
        across = 0.5 * (1 / radius + sign / shell)
        expected = elliptic(MODULUS, *sorted((0.5 / radius, across)))
        check_relative("k_h", fmu["contact.effective_hertz_stiffness"], expected, 1e-9)


def test_a_ball_hardly_smaller_than_its_shell_is_warned_of(opened):
    fmu = opened("SphereSphere")
    for radius, warned in ((0.92, True), (0.88, False)):
        values = automatic(radius, 1.0, "inside") | {"source.center": [0.0, 0.01, 0.0]}
        start(fmu, values)
        found = [message for message in fmu.messages if "source.radius" in message.text]
        assert bool(found) == warned
        assert not found or "destination.radius" in found[0].text
