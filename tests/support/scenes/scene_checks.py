"""One run of a random scene compared with the reference in all that it says: place, velocity, energies,
onsets, durations, impulse, peaks, events and internal steps."""

import numpy as np

from contact_fmus.fmu.contact_fmu import FmuError
from support.checks import differences, start

FMU = {"sphere": "SphereSphere", "cylinder": "SphereCylinder", "plane": "SpherePlane"}
TOLERANCE = 1e-10  # solver.relative_tolerance of the runs
# m and, per unit of the size in play, m/s, J, N and N s. CVODE holds its tolerance by the step; steps add up.
ALLOWED = {"event_driven": 1e-9, "cvode_bdf": 1e-6, "cvode_adams": 1e-6}
ENERGIES = ("kinetic", "potential", "contact", "dissipated", "external_work")
# Internal steps of event_driven at most for each communication step and event, besides those of the
# reference: towards a centre or a contact that dies away lengths change by all binary digits of a number.
STEPS_EACH = 64
# A run that is stuck ends there.
MOST_STEPS = {"event_driven": 20_000, "cvode_bdf": 300_000, "cvode_adams": 300_000}


class Run:
    """What is summed over the communication steps of a run."""

    def __init__(self, fmu, values, stops, method):
        self.fmu, self.impulse, self.stray = fmu, np.zeros(3), 0.0
        start(fmu, {"solver.max_internal_steps": MOST_STEPS[method], **values}, TOLERANCE, method)
        self.begin = fmu["energy.total"]
        self.in_play = max(abs(fmu[f"energy.{name}"]) for name in ENERGIES)
        for stop in stops:
            size = stop - fmu.time
            fmu.step(size)
            self.impulse += size * fmu["contact.mean_force"]
            self.in_play = max(self.in_play, *(abs(fmu[f"energy.{name}"]) for name in ENERGIES))
            self.stray = max(self.stray, abs(fmu["energy.total"] - self.begin))


def failures(fmu, values, stops, method, expected, leaves_open=frozenset()):
    """Returns a line for each figure that is off, or for the refusal of the run. `fmu` is left at its end."""
    try:
        run = Run(fmu, values, stops, method)
    except FmuError as error:
        return [f"refused at {fmu.time!r} s: {error}"]
    found = {}
    for name, (value, right, allowed) in figures(run, expected, stops, ALLOWED[method]).items():
        found[name] = differences(name, value, right, allowed)
    found |= counts(fmu, expected, method, stops)
    return [line for name, lines in found.items() if name not in leaves_open for line in lines]


def figures(run, expected, stops, allowed):
    """By name: value, right value, and how far off it may be."""
    fmu, rows = run.fmu, {}
    fastest = max(1.0, *(float(np.linalg.norm(v)) for v in expected.velocity.values()))
    for body in ("source", "destination"):
        way = max(1.0, float(np.linalg.norm(expected.position[body])))
        rows[f"{body}.position"] = fmu[f"{body}.position"], expected.position[body], allowed * way
        rows[f"{body}.velocity"] = fmu[f"{body}.velocity"], expected.velocity[body], 10 * allowed * fastest
    energy = 10 * allowed * max(1.0, run.in_play)  # as the velocities
    rows["total"] = run.stray, 0.0, energy / 10
    works = {"energy.contact": expected.stored_energy(), "energy.dissipated": expected.dissipated}
    works |= {"energy.external_work": expected.external_work}
    rows |= {name: (fmu[name], work, energy) for name, work in works.items()}
    scale = max(1.0, float(np.linalg.norm(expected.impulse)))
    rows["impulse"] = run.impulse, expected.impulse, 10 * allowed * scale
    # As good as the force at a time, which is off by its rates times the error of the motion.
    stiff = max(1.0, expected.penalty, expected.viscous)
    force = 10 * allowed * max(1.0, expected.peak_force, stiff * fastest * 1e-3)
    rows["peak_force"] = fmu["contact.peak_force"], expected.peak_force, force
    rows["peak_penetration"] = fmu["contact.peak_penetration"], expected.peak_penetration, allowed * fastest
    if expected.onsets:
        rows["onset"] = fmu["contact.last_onset_time"], expected.onset_times[-1], 10 * allowed
        lasting = expected.touching and expected.within
        duration = stops[-1] - expected.onset_times[-1] if lasting else expected.durations[-1]
        rows["duration"] = fmu["contact.last_duration"], duration, 10 * allowed
    return rows


def counts(fmu, expected, method, stops):
    """By name: a line where it is wrong. Only event_driven finds an event as often as there is one."""
    found, events = {}, len(expected.event_times)
    # Bodies that just touch at the start and part may overlap by a rounding before.
    parts = expected.just_touches and 0.0 not in expected.onset_times
    if fmu["contact.onsets"] not in (expected.onsets, expected.onsets + parts):
        found["onsets"] = [f"onsets: got {fmu['contact.onsets']}, expected {expected.onsets}"]
    if method != "event_driven":
        return found
    # Bodies that just touch at the start, give or take a rounding, are in contact at once or right after it.
    least = expected.sure_events()
    if not least <= fmu["solver.events"] <= events + expected.just_touches:
        found["events"] = [f"events: got {fmu['solver.events']}, expected {least} to {events}"]
    most = STEPS_EACH * (len(stops) + events + 1) + expected.steps
    if fmu["solver.steps"] > most:
        found["steps"] = [f"steps: got {fmu['solver.steps']}, expected at most {most}"]
    return found
