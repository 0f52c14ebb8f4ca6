"""The stiffness that Hertz's theory makes of materials and radii; a ball that hardly fits."""

import math

import pytest
from mpmath import mpf

from contact_fmus.stability.motions import elliptic_stiffness
from support.checks import check_relative, start

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
        expected = float(elliptic_stiffness(MODULUS, *map(mpf, sorted((0.5 / radius, across)))))
        check_relative("k_h", fmu["contact.effective_hertz_stiffness"], expected, 1e-9)


def test_a_ball_hardly_smaller_than_its_shell_is_warned_of(opened):
    fmu = opened("SphereSphere")
    for radius, warned in ((0.92, True), (0.88, False)):
        values = automatic(radius, 1.0, "inside") | {"source.center": [0.0, 0.01, 0.0]}
        start(fmu, values)
        found = [message for message in fmu.messages if "source.radius" in message.text]
        assert bool(found) == warned
        assert not found or "destination.radius" in found[0].text
