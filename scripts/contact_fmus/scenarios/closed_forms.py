"""What theory says about one contact. SI units; every function is checked numerically in tests/scenarios.

Symbols: k = p_n penalty factor, c = p_nv viscous penalty factor, m = m_eff, g = gravity's magnitude (> 0),
zeta = c / (2 sqrt(k m)) damping ratio, omega = sqrt(k/m), omega_d = omega sqrt(1 - zeta^2).

While the bodies overlap head-on without gravity, the penetration s = -gap obeys m s'' + c s' + k s = 0 with
s(0) = 0, s'(0) = v, hence (zeta < 1)  s = (v/omega_d) exp(-zeta omega t) sin(omega_d t).
"""

import math

import numpy as np


def damping_ratio(mass: float, stiffness: float, damping: float) -> float:
    return damping / (2.0 * math.sqrt(stiffness * mass))


def _angle_ratio(zeta: float) -> float:
    """acos(zeta)/sqrt(1 - zeta^2), through its limit 1 at zeta = 1 on to acosh(zeta)/sqrt(zeta^2 - 1)"""
    if abs(zeta - 1.0) < 1e-8:
        return 1.0 - (zeta - 1.0) / 3.0
    if zeta < 1.0:
        return math.acos(zeta) / math.sqrt((1.0 - zeta) * (1.0 + zeta))
    return math.acosh(zeta) / math.sqrt((zeta - 1.0) * (zeta + 1.0))


def restitution(dashpot: str, zeta: float) -> float:
    """Speed after / speed before a head-on contact, gravity off.

    unclamped      ends when s = 0 at omega_d t = pi: e = exp(-pi zeta / sqrt(1 - zeta^2)); for zeta >= 1 the
                   bodies never part.
    non_adhesive   the force k s + c s' vanishes when s'' = 0, at omega_d t = 2 acos(zeta), where
                   s' = -v exp(-zeta omega t). From there on the clipped force stays zero, because s falls and
                   s' stays: e = exp(-2 zeta acos(zeta) / sqrt(1 - zeta^2)).
    approach_only  s' = 0 at omega_d t = acos(zeta) with s = (v/omega) exp(-zeta omega t); the way back is
                   undamped and ends with speed omega s: e = exp(-zeta acos(zeta) / sqrt(1 - zeta^2))."""
    if dashpot == "unclamped":
        return math.exp(-math.pi * zeta / math.sqrt(1.0 - zeta * zeta)) if zeta < 1.0 else 0.0
    if dashpot == "non_adhesive":
        return math.exp(-2.0 * zeta * _angle_ratio(zeta))
    if dashpot == "approach_only":
        return math.exp(-zeta * _angle_ratio(zeta))
    raise ValueError(f"no dashpot '{dashpot}'")


def ratio_for(wanted: float, dashpot: str) -> float:
    """The damping ratio zeta that gives a coefficient of restitution in [1e-6, 1]; it falls as zeta grows."""
    from scipy.optimize import brentq  # only what checks claims needs scipy

    highest = 1.0 - 1e-16 if dashpot == "unclamped" else 1e6
    return brentq(lambda zeta: restitution(dashpot, zeta) - wanted, 0.0, highest, xtol=1e-16, rtol=1e-15)


def overlap_duration(dashpot: str, mass: float, stiffness: float, damping: float) -> float:
    """How long s > 0 in a head-on contact, gravity off; pi sqrt(m/k) for every dashpot when c = 0.

    non_adhesive: when the force vanishes k s = -c s', so the free way out takes s/|s'| = c/k."""
    omega = math.sqrt(stiffness / mass)
    zeta = damping_ratio(mass, stiffness, damping)
    if dashpot == "unclamped":
        return math.pi / (omega * math.sqrt(1.0 - zeta * zeta)) if zeta < 1.0 else math.inf
    if dashpot == "non_adhesive":
        return 2.0 * _angle_ratio(zeta) / omega + damping / stiffness
    if dashpot == "approach_only":
        return _angle_ratio(zeta) / omega + 0.5 * math.pi / omega
    raise ValueError(f"no dashpot '{dashpot}'")


def velocities_after(
    mass_1: float, velocity_1: float, mass_2: float, velocity_2: float, e: float = 1.0
) -> tuple[float, float]:
    """Head-on collision with restitution e; an infinite mass_2 is a body that keeps its velocity"""
    if math.isinf(mass_2):
        return velocity_2 - e * (velocity_1 - velocity_2), velocity_2
    mean = (mass_1 * velocity_1 + mass_2 * velocity_2) / (mass_1 + mass_2)
    part = e * (velocity_1 - velocity_2) / (mass_1 + mass_2)
    return mean - mass_2 * part, mean + mass_1 * part


def elastic_bounce_gap(time: np.ndarray, gap: float, mass: float, g: float, stiffness: float) -> np.ndarray:
    """Gap of a body dropped at rest from `gap` head-on onto a fixed one, undamped.

    Flight takes t1 = sqrt(2 gap/g) and ends at speed v = g t1. In contact, tau after touching,
    gap = -(g/omega^2)(1 - cos(omega tau)) - (v/omega) sin(omega tau), zero again when
    tan(omega tau/2) = -v omega/g, that is at omega tau = 2 (pi - atan(v omega/g)). All repeats with the
    period 2 t1 + tau."""
    omega = math.sqrt(stiffness / mass)
    flight = math.sqrt(2.0 * gap / g)
    speed = g * flight
    contact = 2.0 * (math.pi - math.atan(speed * omega / g)) / omega
    since_apex = np.mod(np.asarray(time, dtype=float), 2.0 * flight + contact)
    touching = since_apex - flight
    rising = since_apex - flight - contact
    falling_gap = gap - 0.5 * g * since_apex**2
    contact_gap = -(g / omega**2) * (1.0 - np.cos(omega * touching)) - speed / omega * np.sin(omega * touching)
    rising_gap = speed * rising - 0.5 * g * rising**2
    return np.where(touching < 0.0, falling_gap, np.where(rising < 0.0, contact_gap, rising_gap))


def viscous_sinking(time: np.ndarray, mass: float, g: float, damping: float) -> np.ndarray:
    """Penetration of a body laid at rest on a viscous-only contact: m s'' = m g - c s'

    s = (m g/c) (t - (m/c)(1 - exp(-c t/m))); the speed tends to m g/c."""
    decay = mass / damping
    return decay * g * (time + decay * np.expm1(-np.asarray(time, dtype=float) / decay))


def free_flight(time: float, position: np.ndarray, velocity: np.ndarray, gravity: np.ndarray) -> np.ndarray:
    return np.asarray(position) + np.asarray(velocity) * time + 0.5 * np.asarray(gravity) * time**2


def cylinder_extent(radius: float, axis: np.ndarray, length: float) -> np.ndarray:
    """Half the edges of a cylinder's box: |e_i| L/2 + r sqrt(1 - e_i^2); length 0 is its cross-section"""
    unit = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    return 0.5 * length * np.abs(unit) + radius * np.sqrt(np.maximum(0.0, 1.0 - unit**2))


# What theory says about solid balls that roll and slide, and a cylinder that is hit. SI units; every
# function is checked numerically in tests/scenarios.
#
# A solid ball has I = 2/5 m a^2: where a force at its surface moves its centre by 1, it moves the surface by
# 7/2. All forms are limits: friction that needs no slip to hold (v_0 = 0), surfaces that do not yield (p_n
# infinite).

BALL = 2.0 / 5.0


def slide_to_roll(
    time: np.ndarray, speed: float, slip: float, friction: float, g: float
) -> tuple[np.ndarray, np.ndarray]:
    """Way and speed of a ball set down on a plane with `speed`, its surface slipping by `slip` (speed - a
    omega): slowed by mu g until t = 2 slip/(7 mu g), and rolling evenly from then on."""
    slowing = math.copysign(friction * g, slip)
    sliding = np.minimum(time, slip / (3.5 * slowing))
    velocity = speed - slowing * sliding
    return speed * sliding - 0.5 * slowing * sliding**2 + velocity * (time - sliding), velocity


def vertical_tube(time: np.ndarray, rate: float, g: float) -> np.ndarray:
    """Height of a ball that rolls round a vertical tube `rate` rad/s, from rest in height, without spin
    about the radius: a harmonic motion of sqrt(2/7) of the rate, down by 5 g/rate^2 and up again."""
    return -2.5 * g / rate**2 * (1.0 - np.cos(math.sqrt(2.0 / 7.0) * rate * time))


def pendulum(time: np.ndarray, angle: float, rate: float) -> np.ndarray:
    """Angle of a pendulum let go at `angle`, which swings with `rate` rad/s where it swings a little:
    a'' = -rate^2 sin a"""
    from scipy.special import ellipj

    modulus = math.sin(0.5 * angle)
    _, cosine, delta, _ = ellipj(rate * time, modulus**2)
    return 2.0 * np.arcsin(modulus * cosine / delta)


def rolling_in_a_groove(time: np.ndarray, start: np.ndarray, lengths: np.ndarray, g: float) -> np.ndarray:
    """Place of a solid ball that rolls from rest a little beside the lowest point of a groove: its centre is on a
    surface with the radii of curvature `lengths` along and across the groove, and swings in each direction with
    sqrt(5 g/(7 length))."""
    return start * np.cos(np.sqrt(g / ((1.0 + BALL) * lengths)) * time[:, None])


def friction_drive(
    time: np.ndarray, speed: float, radius: float, inertia: float, limit: float, slip: float
) -> np.ndarray:
    """Angular velocity of a roller at rest that is pressed on a surface which moves with `speed`, under
    friction `limit` (1 - exp(-u/slip)): the slip u = speed - radius omega has u' = -(radius^2/inertia) of it."""
    done = radius**2 / inertia * limit * time / slip
    with np.errstate(divide="ignore"):
        left = np.logaddexp(speed / slip - done, np.log(-np.expm1(-done)))  # log(1 + e^(u_0 - done) - e^-done)
    return (speed - slip * left) / radius


def turntable(time: np.ndarray, start: np.ndarray, velocity: np.ndarray, rate: float) -> tuple[np.ndarray, np.ndarray]:
    """Place and velocity in the plane of a ball that rolls on a plane which turns about the origin: a
    circle, gone round at 2/7 of the rate, since v' = (2/7) rate e_z x v."""
    orbit = rate * BALL / (1.0 + BALL)
    middle = start + np.array([-velocity[1], velocity[0]]) / orbit
    cosine, sine = np.cos(orbit * time), np.sin(orbit * time)

    def turned(v: np.ndarray) -> np.ndarray:
        return np.stack([cosine * v[0] - sine * v[1], sine * v[0] + cosine * v[1]], axis=-1)

    return middle + turned(start - middle), turned(velocity)


def hit_beside(speed: float, ball: float, cylinder: float, inertia: float, lever: float) -> tuple[float, ...]:
    """Speeds of ball and cylinder and the cylinder's angular velocity after an elastic impact across its
    axis, `lever` from its middle: an impulse 2 v/(1/m_1 + 1/m_2 + h^2/I)."""
    impulse = 2.0 * speed / (1.0 / ball + 1.0 / cylinder + lever**2 / inertia)
    return speed - impulse / ball, impulse / cylinder, lever * impulse / inertia
