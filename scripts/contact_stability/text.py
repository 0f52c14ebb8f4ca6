"""The words of the page"""

CHECKS = (
    "Head-on scenes have a closed form, evaluated with 60 digits from the very numbers the FMU is given: flights "
    "are parabolas, contacts damped oscillations, joined where the gap, the gap rate or the force changes its "
    "sign. Oblique scenes, grazes and soft bodies passed off their middle have an end computed with 40 digits by "
    "a Taylor integrator, and are repeated in other units of length, mass and time (powers of two): the numbers "
    "are extreme, the motion is the same.",
    "Asked of every run: finite outputs; the place at the end; energy.total constant, over the largest energy in "
    "play; no mechanical energy gained where nothing gives any; momentum against the impulses of contact, "
    "gravity and force; the number of onsets and the time of the last one. A run that is refused "
    "(fmi2Discard or fmi2Error with a message) must have finite outputs and its energy in balance up to the time "
    "it reached.",
)

LIMITS = ()
