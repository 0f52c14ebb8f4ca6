"""MuJoCo: a soft constraint, made as near to a spring and dashpot as it goes.

Negative `solref` gives stiffness and damping directly, per unit of mass. The constraint leaves the share
1 - d of the acceleration without contact (here gravity) in place, d being `solimp`'s impedance; the least
d it takes, 1e-4, comes nearest to a force that is simply added. The force never pulls. Similar, therefore:
equal to p_n and p_nv but for 1e-4 of gravity while touching, and for the clip where there is a dashpot.
"""

from pathlib import Path

from contact_fmus.report.measure import SIMILAR

from .problems import STEP_SIZE, CannotExpress, Case, Run, steps_of

NAME = "MuJoCo"
PACKAGES = ("mujoco",)
IMPORT = "mujoco"
LAW = (
    "similar: a soft constraint of the same stiffness and damping, which never pulls and takes away 1e-4"
    " of gravity while the bodies touch"
)

IMPEDANCE = 1e-4
STEPS = {"Euler": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5, 5e-6), "RK4": (1e-3, 3e-4, 1e-4, 3e-5, 1e-5)}
SOFT = "a soft constraint: 1e-4 of gravity is lost while touching"


def cases(problem, quick):
    if problem.inside:
        raise CannotExpress("no hollow cylinder: primitives and meshes collide as convex bodies")
    note = SOFT + ("; the dashpot never pulls" if problem.damping else "")
    for method, steps in STEPS.items():
        for size in steps[:3:2] if quick else steps:
            yield Case(method, STEP_SIZE, size, SIMILAR, note)


def prepare(problem, case):
    import mujoco

    count, step = steps_of(problem.end, case.parameter)
    x, y, z = problem.position
    text = (
        Path(__file__)
        .with_suffix(".xml")
        .read_text(encoding="utf-8")
        .format(
            step=step,
            gravity=-problem.gravity,
            method=case.integrator,
            stiffness=-problem.stiffness / problem.mass,
            damping=-problem.damping / problem.mass,
            d=IMPEDANCE,
            wall_radius=problem.wall_radius,
            radius=problem.radius,
            mass=problem.mass,
            x=x,
            y=y,
            z=z,
        )
    )
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    data.qvel[:] = problem.velocity

    def advance():
        mujoco.mj_step(model, data, nstep=count)

    def position():
        if any(warning.number for warning in data.warning):
            raise ArithmeticError("MuJoCo warned of a bad state and began anew")
        return [start + moved for start, moved in zip(problem.position, data.qpos.tolist(), strict=True)]

    return Run(advance, position)
