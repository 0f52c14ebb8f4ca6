"""scipy's solve_ivp: one phase at a time, flight or contact, each ended by an event at gap zero.

Written the way that serves scipy best: plain numbers in the right-hand side, a restart at every corner of the force, an
event that fires 1e-13 m behind the corner, so that the next phase begins on its own side and does not see the same one
again. An event is looked for only in the sign of the gap at the ends of a step, so a step that passes in and out again
sees nothing; `max_step` is the usual remedy. It is set to a quarter of a short contact at the start of every contact
(one that lasts longer is left to the error control) and to 0.1 s in flight."""

from math import inf, sqrt

from .problems import Run

FLIGHT_STEP = 0.1  # s, a quarter of what the ball takes to fall through the sphere
PASSED = 1e-13  # m, above what the event is found to: 8 ε times 5 s at 6 m/s, and the rounding of the gap
PHASES = 10_000  # more than any problem has: a run that restarts for ever is ended


def equations(problem):
    """Right-hand sides in flight and in contact, the gap"""
    across = 0.0 if problem.inside else 1.0  # does y count in the distance?
    side = -1.0 if problem.inside else 1.0
    touch, gravity = problem.touching_distance, problem.gravity
    stiffness, damping = problem.stiffness / problem.mass, problem.damping / problem.mass

    def flight(_time, state):
        return (*state.tolist()[3:], 0.0, 0.0, -gravity)

    def contact(_time, state):
        x, y, z, vx, vy, vz = state.tolist()
        distance = sqrt(x * x + across * y * y + z * z)
        nx, ny, nz = x / distance, across * y / distance, z / distance
        push = -stiffness * (distance - touch) - damping * (nx * vx + ny * vy + nz * vz)
        return (vx, vy, vz, push * nx, push * ny, push * nz - gravity)

    def gap(state):
        x, y, z = state.tolist()[:3]
        return side * (sqrt(x * x + across * y * y + z * z) - touch)

    return flight, contact, gap


class Motion:
    def __init__(self, problem, case):
        import numpy as np

        self.problem, self.state = problem, np.array([*problem.position, *problem.velocity])
        self.equations = equations(problem)
        self.method, self.tolerance = case.integrator, case.parameter
        self.limited = not case.setting.endswith("no max_step")
        self.onsets = 0

    def phase(self, start, end, touching, resume):
        """Integrates to the end or to the next event. It returns the time reached and whether there was an event."""
        from scipy.integrate import solve_ivp

        flight, contact, gap = self.equations
        options = {"rtol": self.tolerance, "atol": 1e-3 * self.tolerance, "max_step": inf}
        if self.limited and not resume:
            options["max_step"] = self.problem.contact_time / 4 if touching else FLIGHT_STEP

        def event(_time, state):  # that ends the phase
            return gap(state) + (-PASSED if touching else PASSED)

        event.terminal, event.direction = True, 1 if touching else -1
        rates = contact if touching else flight
        run = solve_ivp(rates, (start, end), self.state, method=self.method, events=event, **options)
        if run.status < 0:
            raise ArithmeticError(run.message)
        self.state = run.y[:, -1]
        return float(run.t[-1]), run.status == 1

    def advance(self):
        problem, time = self.problem, 0.0
        touching, resume = problem.touching, False
        self.onsets = int(touching)
        for _ in range(PHASES):
            end = problem.end
            if self.limited and touching and not resume:
                end = min(end, time + 2 * problem.contact_time)
            time, crossed = self.phase(time, end, touching, resume)
            if time >= problem.end:
                return
            resume = not crossed
            if crossed:
                touching = not touching
                self.onsets += touching
        raise ArithmeticError(f"not done after {PHASES} phases: the gap changes its sign without end")


def prepare(problem, case):
    import scipy.integrate  # noqa: F401  (before the clock starts)

    motion = Motion(problem, case)
    return Run(motion.advance, lambda: motion.state.tolist(), lambda: motion.onsets)
