"""The contact law of DESIGN section 1, written again and on its own: geometry, factors, force in long double.

A configuration is a flat dictionary of FMI variable names, as it is given to an FMU. The rest has the start
values of DESIGN section 2. Everything is computed with numpy.longdouble, so that differences are the FMU's.

Every result comes with the *size of its terms*: the sum of the magnitudes that were added up to get it.
Rounding errors are relative to that size, not to a result that may have cancelled to nothing."""

from dataclasses import dataclass

import mpmath
import numpy as np

REAL = np.longdouble

START_VALUES = {
    "source.radius": 0.1, "destination.radius": 0.5, "source.mass": 1.0, "destination.mass": 1.0,
    "source.center": [0.0, 0.0, 1.1], "destination.center": [0.0, 0.0, 0.0], "source.motion": "free",
    "destination.motion": "fixed",
    **{f"{body}.{row}": [0.0, 0.0, 0.0] for body in ("source",
        "destination") for row in ("initial_displacement", "initial_velocity", "prescribed_displacement",
        "prescribed_velocity", "external_force")},
    "destination.axis": [0.0, 0.0, 1.0], "destination.finite_length": False, "destination.length": 1.0,
    "contact.location": "automatic", "contact.method": "penalty_dynamic",
    "contact.penalty_control": "user_defined", "contact.penalty_multiplier": 1.0,
    "contact.penalty_factor": 1e6, "contact.viscous_control": "user_defined",
    "contact.characteristic_time": 1e-4, "contact.viscous_penalty_factor": 100.0,
    "contact.reference_modulus": 1e9, "contact.restitution": 0.8, "contact.dashpot": "non_adhesive",
    "contact.gap_beyond_ends": 1e30, "gravity": [0.0, 0.0, -9.81],
}  # fmt: skip


def complete(configuration):
    """Returns the configuration with DESIGN's start values for missing names. Unknown names are refused."""
    return {**START_VALUES, **{k: v for k, v in configuration.items() if not k.startswith("solver.")}}


def vector(values):
    return np.array([REAL(value) for value in values], dtype=REAL)


def norm(values):
    """Euclidean length, scaled by the largest component: neither 1e150 nor 1e-150 is squared."""
    largest = np.max(np.abs(values))
    if largest == 0:
        return REAL(0)
    return largest * np.sqrt(np.sum((values / largest) ** 2))


def rising_root(function, low, high):
    """Where a function that is below zero at first is zero, by halving to 30 digits"""
    with mpmath.workdps(30):
        low, high = mpmath.mpf(low), mpmath.mpf(high)
        while high - low > mpmath.mpf("1e-28") * high:
            middle = (low + high) / 2
            low, high = (middle, high) if function(middle) < 0 else (low, middle)
        return high


@dataclass
class Motion:
    """Displacement and velocity of both bodies at one instant."""

    source_displacement: np.ndarray
    source_velocity: np.ndarray
    destination_displacement: np.ndarray
    destination_velocity: np.ndarray


def start_motion(configuration):
    """Returns displacements and velocities at the end of initialization, by each body's kind of motion."""
    values = {}
    for body in ("source", "destination"):
        prefix = {"free": "initial", "prescribed": "prescribed"}.get(configuration[f"{body}.motion"])
        for row in ("displacement", "velocity"):
            start = configuration[f"{body}.{prefix}_{row}"] if prefix else (0.0, 0.0, 0.0)
            values[f"{body}_{row}"] = vector(start)
    return Motion(**values)


class ReferenceContact:
    """What initialization fixes: the axis, the location and the two factors in force."""

    def __init__(self, configuration, shape):
        self.values = values = complete(configuration)
        self.shape = shape
        self.source_radius = REAL(values["source.radius"])
        self.destination_radius = REAL(0 if shape == "plane" else values["destination.radius"])
        self.axis = None
        self.half_length = None
        if shape != "sphere":
            axis = vector(values["destination.axis"])
            self.axis = axis / norm(axis)
        if shape == "cylinder" and values["destination.finite_length"]:
            self.half_length = REAL(values["destination.length"]) / 2
        start = start_motion(values)
        self.location = values["contact.location"]
        if shape == "plane":
            self.location = "outside"
        if self.location == "automatic":
            fits = self.source_radius < self.destination_radius
            hollow = fits and self.separation(start)[0] < self.destination_radius
            self.location = "inside" if hollow else "outside"
        self.diagonal = self.bounding_box_diagonal(start)
        self.penalty, self.viscous = self.factors()

    def connection(self, motion):
        """c = x_dst - x_src and the size of its terms; a common offset of the centres cancels first."""
        offset = vector(self.values["destination.center"]) - vector(self.values["source.center"])
        moved = motion.destination_displacement - motion.source_displacement
        return offset + moved, norm(offset) + norm(moved)

    def separation(self, motion):
        """d, the vector of that length (c or its part across the axis), c.e_d, and the size of the terms"""
        across, size = self.connection(motion)
        along = REAL(0)
        if self.shape == "plane":  # with its sign
            distance = -np.dot(across, self.axis)
            return distance, -distance * self.axis, along, size
        if self.axis is not None:
            along = np.dot(across, self.axis)
            across = across - along * self.axis
        return norm(across), across, along, size

    def bounding_box_diagonal(self, motion):
        """Axis-parallel box around both bodies; of an infinite cylinder its cross-section is in it."""
        if self.shape == "plane":  # that of the source alone
            return norm(np.full(3, 2 * self.source_radius, dtype=REAL))
        if self.axis is None:
            reach = np.full(3, self.destination_radius, dtype=REAL)
        else:
            reach = self.destination_radius * np.sqrt(np.maximum(0, 1 - self.axis**2))
            if self.half_length is not None:
                reach = reach + self.half_length * np.abs(self.axis)
        apart, _ = self.connection(motion)
        lowest = np.minimum(-self.source_radius, apart - reach)
        return norm(np.maximum(self.source_radius, apart + reach) - lowest)

    def factors(self):
        """Returns p_n and p_nv in force. p_n is 0 for viscous only, p_nv is 0 without a dashpot."""
        values = self.values
        modulus_length = REAL(values["contact.reference_modulus"]) * self.diagonal
        control = values["contact.penalty_control"]
        if control == "user_defined":
            penalty = REAL(values["contact.penalty_factor"])
        elif control == "automatic":
            penalty = REAL(values["contact.penalty_multiplier"]) * modulus_length
        else:
            penalty = REAL(0)
        if values["contact.method"] == "penalty":
            viscous = REAL(0)
        elif values["contact.viscous_control"] == "user_defined":
            viscous = REAL(values["contact.viscous_penalty_factor"])
        elif values["contact.viscous_control"] == "restitution":
            viscous = 2 * self.damping_ratio() * np.sqrt(penalty * self.reduced_mass())
        else:
            scale = modulus_length if control == "viscous_only" else penalty
            viscous = REAL(values["contact.characteristic_time"]) * scale
        return penalty, viscous

    def reduced_mass(self):
        """Of the free bodies: the others are infinitely heavy."""
        values = self.values
        free = [body for body in ("source", "destination") if values[f"{body}.motion"] == "free"]
        return 1 / sum(1 / REAL(values[f"{body}.mass"]) for body in free)

    def damping_ratio(self):
        """sin(phi), for which an impact loses the factor exp(-turned tan(phi)): support/scenes/head_on.py.
        mpmath inverts it with complex phi, that is beyond critical damping too."""
        wanted = -mpmath.log(mpmath.mpf(float(self.values["contact.restitution"])))
        if self.values["contact.dashpot"] == "unclamped":
            return REAL(float(wanted / mpmath.hypot(mpmath.pi, wanted)))
        times = 2 if self.values["contact.dashpot"] == "non_adhesive" else 1

        def missing(ratio):
            phi = mpmath.asin(mpmath.mpc(ratio))
            return mpmath.re(times * (mpmath.pi / 2 - phi) * mpmath.tan(phi)) - wanted

        return REAL(float(rising_root(missing, 0, mpmath.exp(wanted)))) if wanted else REAL(0)

    def normal_force(self, gap, gap_rate):
        """Returns F_n of the laws and dashpots of DESIGN section 1."""
        if not gap < 0:
            return REAL(0)
        dashpot = self.values["contact.dashpot"]
        rate = min(gap_rate, REAL(0)) if dashpot == "approach_only" else gap_rate
        force = -self.penalty * gap - self.viscous * rate
        return max(force, REAL(0)) if dashpot == "non_adhesive" else force

    def evaluate(self, motion):
        """FMI output name -> (value, size of its terms) at one instant; none for d = 0, without direction"""
        distance, across, along, length = self.separation(motion)
        inside = self.location == "inside"
        radii = self.source_radius + self.destination_radius
        gap = self.destination_radius - self.source_radius - distance if inside else distance - radii
        normal = -self.axis if self.shape == "plane" else across / distance
        velocity = motion.destination_velocity - motion.source_velocity
        distance_rate = np.dot(normal, velocity)
        gap_rate = -distance_rate if inside else distance_rate
        within = self.half_length is None or abs(along) <= self.half_length
        if self.shape == "cylinder":
            direction = -normal if inside else normal  # towards the contact point
            away = -direction
        else:
            direction = normal  # towards the destination's centre
            away = direction if inside else -direction

        # The direction's error is that of `across` over d, and everything projected on it inherits it.
        sharpness = REAL(1) if self.shape == "plane" else length / distance
        speed = norm(velocity) * sharpness
        force = self.normal_force(gap, gap_rate) if within else REAL(0)
        force_size = self.penalty * (length + radii) + self.viscous * speed
        vector_size = force_size + abs(force) * sharpness
        source = vector(self.values["source.center"]) + motion.source_displacement
        # Point of the destination's surface nearest to the source's centre, for all four geometries.
        point = source + across - self.destination_radius * normal
        reach = norm(vector(self.values["source.center"])) + norm(motion.source_displacement)
        results = {
            "contact.distance": (distance, length),
            "contact.direction": (direction, sharpness),
            "contact.normal_force": (force, force_size),
            "contact.source_force": (force * away, vector_size),
            "contact.destination_force": (-force * away, vector_size),
            "contact.active": (bool(within and gap < 0), None),
        }
        if within:
            results["contact.gap"] = (gap, length + radii)
            results["contact.gap_rate"] = (gap_rate, speed)
            results["contact.point"] = (point, reach + length + radii * (1 + sharpness))
        else:
            results["contact.gap"] = (REAL(self.values["contact.gap_beyond_ends"]), REAL(0))
        if self.shape == "cylinder":
            results["contact.within_extents"] = (bool(within), None)
        return results

    def constants(self):
        """FMI calculated parameter -> (value, size of its terms)."""
        _, length = self.connection(start_motion(self.values))
        size = length + self.diagonal
        share = size / self.diagonal  # the factors inherit the diagonal's error where they are made from it
        return {
            "contact.diagonal": (self.diagonal, size),
            "contact.effective_penalty_factor": (self.penalty, self.penalty * share),
            "contact.effective_viscous_penalty_factor": (self.viscous, self.viscous * share),
        }
