"""The words of the page; formulas stand between $ (pages/formula.py)"""

# What each axis is about; scenes.py says what its scenes are.
AXES = {
    "stiffness": "How stiff the contact is, everything else the same",
    "mass": "The ball's mass, on a fixed body",
    "mass ratio": "Both bodies are free; the destination weighs 1 kg",
    "size": "All lengths and the speed grow alike; gravity stays, so that it rules the small ones",
    "radius ratio": "A body of 0.125 m and one that is so much larger; the ball is either of them",
    "clearance": "A ball that all but fills a hollow body: how much room it has. It crosses, or settles on the wall",
    "speed": "How fast the ball is thrown at the body",
    "bullet": "A ball of 8 µm shot at a body of 1 mm, at up to 1000 km/s, in one step that "
    "ends far beyond: how deep the impact goes. From 1 on the ball comes out on the "
    "other side",
    "damping": "How strong the dashpot is; at 1, critical damping, an unloaded contact no longer swings",
    "viscous only": "Contacts that are a dashpot without a spring: its factor",
    "communication step": "A flight, an impact and what follows within 1, 20 or 100 communication steps of this size",
    "offset": "Both bodies so far from the origin, where places have fewer digits to spare",
    "start": "The bodies overlap already at the start: at 0 they touch, at 1 the centres of solid ones coincide",
    "rim": "The ball passes the end of a finite cylinder so long before or after it touches",
    "force": "A force presses the ball on the body",
    "jump": "The importer moves the destination by so many radii at once, into the ball or away, and back",
    "plane": "A ball on a plane: how stiff the contact is. The ball is dropped, thrown or set down, or the "
    "plane is free too",
    "over the edge": "A ball comes down on the cap of a cylinder, or across its side, so far within the edge "
    "or beyond it: it meets the face or the rim, or passes",
    "edge-on impact": "A ball meets the rim along the bisector, dead centre and beside it, and parallel to "
    "the cap: how fast, from a millionth to half of its radius deep",
    "modulus": "Impacts by Hertz's law with the stiffness of the material",
    "restitution": "Impacts by either law whose damping follows from the coefficient of restitution",
    "exponent": "Impacts by the linear law (1) and by Hertz's (3/2), from 1e-6 to 1e6 m/s, all about a millimetre deep",
    "slip velocity": "A ball slides on a plane until it rolls, under regularized friction: the slip velocity "
    "at which friction comes to most of its limit, from Coulomb's friction to one that creeps",
    "friction": "The same: how strong friction is",
    "spin": "The same with back-spin: how fast the ball turns at the start, for a thousand turns at most",
    "inertia ratio": "The same: how heavy the ball is to turn; a solid one has 2/5, a hollow one 2/3",
    "tumbling rate": "A cylinder that turns about its fixed middle meets a ball: how fast it turns. One run "
    "ends just after the impact has begun",
    "all at once": "Forty scenes in each of ten groups, drawn at random with everything above "
    "extreme at once. The number is the group's and has no order",
    "unit of length": "Oblique scenes told in another unit of length, 2 to this power of a metre: the "
    "motion must be the same",
    "unit of mass": "The same with another unit of mass",
    "unit of time": "The same with another unit of time",
    "unit of all": "The same with all three units changed at once",
}

LAWS = {
    "undamped": "a spring without a dashpot",
    "non_adhesive": "spring and dashpot; the force is clipped where it would pull",
    "unclamped": "spring and dashpot as they stand; the contact may pull while the bodies part",
    "approach_only": "the dashpot acts only while the bodies approach",
    "viscous_only": "a dashpot without a spring, with any of the three ways it acts",
}

CHECKS = (
    "Head-on scenes have a closed form, evaluated with 60 digits from the very numbers the FMU is "
    "given: flights are parabolas, contacts damped oscillations, joined where the gap, the gap rate or "
    "the force changes its sign. Impacts by Hertz's law have a closed form up to one quadrature. "
    "Oblique scenes, grazes and soft bodies passed off their middle have an end computed with 40 digits by "
    "a Taylor integrator, and are repeated in other units of length, mass and time (powers of two): the "
    "numbers are extreme, the motion is the same.",
    "Asked of every run: finite outputs; the place at the end; energy.total constant, over the largest "
    "energy in play; no mechanical energy gained where nothing gives any; momentum against the impulses "
    "of contact, gravity and force; the number of onsets and the time of the last one; the work. A run "
    "that is refused (fmi2Discard or fmi2Error with a message) must have finite outputs and its energy "
    "in balance up to the time it reached. Errors may be larger by what the rounding of the given radii "
    "and places leaves open, and onsets that rounding alone decides are not counted.",
)

LIMITS = (
    "event_driven has no limit of stiffness: its steps follow events and the slow motion. Its work is "
    "bounded by 3000 internal steps for each communication step, event and radian of slow swinging; a "
    "run that bounces for ever in one communication step ends with fmi2Discard at "
    "solver.max_internal_steps, the state whole, and goes on when fmi2DoStep is called again. Nothing of "
    "it is left to CVODE: a way through the middle of a solid body ($d = 0$), where the normal turns round, "
    "is taken in two pieces.",
    "event_driven resolves every turn of a body that rubs: an internal step covers about 7 radians, so that "
    "a run of more than 10000 turns in one communication step ends with fmi2Discard at "
    "solver.max_internal_steps and goes on when fmi2DoStep is called again.",
    "cvode_bdf and cvode_adams resolve every oscillation of a contact, cvode_adams every decay as well. "
    "A contact that lasts long against $sqrt(m/p_n)$, or $m/p_nv$, ends with fmi2Discard at "
    "solver.max_internal_steps: use event_driven.",
    "cvode_bdf and cvode_adams hold their tolerance in displacements. An impact whose depth $v "
    "sqrt(m/p_n)$ is not large against relative tolerance times displacement (mass ratios from 1e10, "
    "$p_n/m$ from 1e16 1/s² on) gives a speed that is off by more than the tolerance, with energy in "
    "balance to rounding or not: use event_driven.",
    "cvode_bdf and cvode_adams take internal steps of about a tenth of $r_d - r_s$ in a hollow body at the "
    "speed of the moment: an impact that is 1000 clearances deep ends with fmi2Discard at "
    "solver.max_internal_steps.",
    "cvode_bdf and cvode_adams find events by samples: a flight shorter than an internal step (a ball "
    "that swings through a hollow body much smaller than its amplitude) is not seen, and contact.onsets "
    "counts too few.",
    "Bodies that have gone far together lose digits of their gap: 1e-16 of the displacement.",
)
