"""Integrators of a free ball of 1 kg on a line, whose contact force comes from a force element, step by step.

u, v: displacement and velocity of the ball, g gravity, h the communication step, F the force. words.toml tells the
couplings: where the force comes from, and when. The iterated mean force keeps the energy of an undamped contact at
every h: with v1 = v + h (g + F) and u1 = u + h (v + v1)/2 the work of F along the line is the change of kinetic energy.
"""

from collections.abc import Callable
from typing import Any, NamedTuple

from contact_fmus.fmu.contact_fmu import ContactFmu

MOST_REPEATS = 60
BOTH_PRESCRIBED = {"source.motion": "prescribed", "destination.motion": "prescribed"}


class FmuElement:
    """A contact FMU whose caller moves the source along z. Both bodies are prescribed, the destination rests."""

    def __init__(self, fmu: ContactFmu, values: dict[str, Any]):
        self.fmu = fmu
        fmu.reset()
        fmu.start(values | {name: value for name, value in BOTH_PRESCRIBED.items() if name in fmu})
        kinds = ("displacement", "velocity")
        self.inputs = [fmu.variable(f"source.prescribed_{kind}[3]").references[0] for kind in kinds]

    def force_at(self, u: float, v: float) -> float:
        """The force in this state. No step is needed, because the force has no memory."""
        self.fmu.call("setReal", self.inputs, [u, v])
        return self.fmu["contact.source_force[3]"]

    def step(self, h: float, u: float, v: float, *slopes: float) -> None:
        """Over the step u + rate t + curvature t^2/2 goes on, and v + acceleration t, where `slopes` are these
        three; without them both are held."""
        self.fmu.call("setReal", self.inputs, [u, v])
        if slopes:
            self.fmu.call("setRealInputDerivatives", [self.inputs[place] for place in (0, 0, 1)], [1, 2, 1], slopes)
        self.fmu.step(h)

    @property
    def force(self) -> float:
        """The force at the end of the step"""
        return self.fmu["contact.source_force[3]"]

    @property
    def mean(self) -> float:
        """The mean force over the step: its impulse divided by the step"""
        return self.fmu["contact.mean_force[3]"]

    def remember(self) -> None:
        self._state = self.fmu.save()

    def take_back(self) -> None:
        """Goes back to the remembered state, so that the step can be done again with another path"""
        self.fmu.restore(self._state)


class LinearElement:
    """F = -k u - c v with the calls of FmuElement"""

    def __init__(self, stiffness: float, damping: float):
        self.stiffness, self.damping = stiffness, damping

    def force_at(self, u: float, v: float) -> float:
        return -self.stiffness * u - self.damping * v

    def step(self, h: float, u: float, v: float, rate=0.0, curvature=0.0, acceleration=0.0) -> None:
        self.force = self.force_at(u + rate * h + curvature * h**2 / 2, v + acceleration * h)
        self.mean = self.force_at(u + rate * h / 2 + curvature * h**2 / 6, v + acceleration * h / 2)

    remember = take_back = lambda self: None


class Tool(NamedTuple):
    """What acts on the ball besides the contact, and the contact's factors, from which the iteration starts"""

    gravity: float
    stiffness: float
    damping: float


class Ball(NamedTuple):
    u: float
    v: float
    force: float = 0.0  # the last one received


Step = Callable[[Any, Tool, Ball, float], Ball]


class Scheme(NamedTuple):
    integrator: str
    coupling: str
    step: Step
    order: int  # of convergence in a lasting contact


# Displacement and velocity after a step, from the acceleration before and the one with the force that came. A tool
# that integrates exactly, as Runge-Kutta does, has the old force until the next point.
EULER, VERLET, RUNGE_KUTTA = "semi-implicit Euler", "velocity Verlet", "Runge-Kutta 4"
MOVES: dict[str, Callable[[Ball, float, float, float], tuple[float, float]]] = {
    EULER: lambda ball, a, _new, h: (ball.u + h * (ball.v + h * a), ball.v + h * a),
    VERLET: lambda ball, a, new, h: (ball.u + h * ball.v + 0.5 * h * h * a, ball.v + 0.5 * h * (a + new)),
    RUNGE_KUTTA: lambda ball, a, _new, h: (ball.u + h * ball.v + 0.5 * h * h * a, ball.v + h * a),
}


def euler_at_once(element, tool: Tool, ball: Ball, h: float) -> Ball:
    force = element.force_at(ball.u, ball.v)
    element.step(h, ball.u, ball.v)
    return Ball(*MOVES[EULER](ball, tool.gravity + force, 0.0, h), force)


def verlet_at_once(element, tool: Tool, ball: Ball, h: float) -> Ball:
    """Velocity Verlet; a dashpot is given the velocity that the old acceleration leads to."""
    a = tool.gravity + ball.force
    u, v = MOVES[RUNGE_KUTTA](ball, a, 0.0, h)
    force = element.force_at(u, v)
    element.step(h, u, v)
    return Ball(*MOVES[VERLET](ball, a, tool.gravity + force, h), force)


def runge_kutta_at_once(element, tool: Tool, ball: Ball, h: float) -> Ball:
    """The classical method of fourth order; the force is asked for at each of its four stages."""

    def rate(u: float, v: float) -> tuple[float, float]:
        return v, tool.gravity + element.force_at(u, v)

    u, v, _ = ball
    u1, v1 = rate(u, v)
    u2, v2 = rate(u + 0.5 * h * u1, v + 0.5 * h * v1)
    u3, v3 = rate(u + 0.5 * h * u2, v + 0.5 * h * v2)
    u4, v4 = rate(u + h * u3, v + h * v3)
    element.step(h, u, v)
    return Ball(u + h / 6 * (u1 + 2 * u2 + 2 * u3 + u4), v + h / 6 * (v1 + 2 * v2 + 2 * v3 + v4), ball.force)


def beside(integrator: str, derivatives: int) -> Step:
    """The FMU steps beside the tool, which moves the ball with the force that comes"""

    def step(element, tool: Tool, ball: Ball, h: float) -> Ball:
        a = tool.gravity + ball.force
        element.step(h, ball.u, ball.v, *((ball.v, (0.0, a)[derivatives - 1], a) if derivatives else ()))
        return Ball(*MOVES[integrator](ball, a, tool.gravity + element.force, h), element.force)

    return step


def _moved(tool: Tool, ball: Ball, force: float, h: float, weight: float) -> Ball:
    """Over a step with the mean force; the displacement by weight v + (1 - weight) v1."""
    velocity = ball.v + h * (tool.gravity + force)
    return Ball(ball.u + h * (weight * ball.v + (1.0 - weight) * velocity), velocity, force)


def mean_predicted(weight: float) -> Step:
    def step(element, tool: Tool, ball: Ball, h: float) -> Ball:
        element.step(h, ball.u, ball.v, ball.v, 0.0, tool.gravity + ball.force)
        return _moved(tool, ball, element.mean, h, weight)

    return step


def mean_iterated(weight: float) -> Step:
    """The secant method. It starts from the share of the correction that the whole contact, half of its spring
    and all of its dashpot, would leave."""

    def step(element, tool: Tool, ball: Ball, h: float) -> Ball:
        inertia = 1.0 / ((1.0 - weight) * h * h)
        share = inertia / (inertia + 0.5 * tool.stiffness + tool.damping / h)
        target, last = _moved(tool, ball, ball.force, h, weight).u, None
        element.remember()
        for repeat in range(MOST_REPEATS):
            if repeat > 0:
                element.take_back()
            way = (target - ball.u) / h
            element.step(h, ball.u, way, way, 0.0, 0.0)
            moved = _moved(tool, ball, element.mean, h, weight)
            missing = moved.u - target
            if last is not None and missing != last:
                share = -share * last / (missing - last)
            if abs(share * missing) <= 1e-14 * (1.0 + abs(ball.u)):
                return moved
            target, last = target + share * missing, missing
        raise ArithmeticError(f"no mean force found after {MOST_REPEATS} repeats of a step of {h} s")

    return step


BESIDE = ("held", "derivative 1", "derivatives 1, 2")


def _schemes(integrator: str, at_once: Step, order: int, beside_orders: tuple[int, ...]) -> list[Scheme]:
    found = [Scheme(integrator, "at once", at_once, order)]
    for number, coupling in enumerate(BESIDE):
        found.append(Scheme(integrator, coupling, beside(integrator, number), beside_orders[number]))
    if integrator != RUNGE_KUTTA:
        weight = 0.5 if integrator == VERLET else 0.0  # of the old velocity
        found.append(Scheme(integrator, "mean, predicted", mean_predicted(weight), order))
        found.append(Scheme(integrator, "mean, iterated", mean_iterated(weight), order))
    return found


SCHEMES = [
    *_schemes(EULER, euler_at_once, 1, (1, 1, 1)),
    *_schemes(VERLET, verlet_at_once, 2, (1, 2, 2)),
    *_schemes(RUNGE_KUTTA, runge_kutta_at_once, 4, (1, 1, 1)),
]


def run(scheme: Scheme, element, tool: Tool, ball: Ball, h: float, steps: int, enough=lambda ball: False) -> Ball:
    """`steps` steps of h; it ends early where enough(ball) says so."""
    ball = ball._replace(force=element.force_at(ball.u, ball.v))
    for _ in range(steps):
        ball = scheme.step(element, tool, ball, h)
        if enough(ball):
            break
    return ball
