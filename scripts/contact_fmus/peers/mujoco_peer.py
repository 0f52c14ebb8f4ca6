"""MuJoCo: a soft constraint, made as near to a spring and dashpot as it goes.

Negative `solref` gives stiffness and damping directly, per unit of mass. The constraint leaves the share
1 - d of the acceleration without contact (here gravity) in place, d being `solimp`'s impedance; the least
d it takes, 1e-4, comes nearest to a force that is simply added. The force never pulls. Similar, therefore:
equal to p_n and p_nv but for 1e-4 of gravity while touching, and for the clip where there is a dashpot."""

from pathlib import Path

from .problems import Cradle, Run, steps_of

IMPEDANCE = 1e-4


def prepare(problem, case):
    import mujoco

    count, step = steps_of(problem.end, case.parameter)
    row = isinstance(problem, Cradle)
    given = problem._asdict() | {"step": step, "method": case.integrator, "d": IMPEDANCE}
    given["stiffness"] = -problem.stiffness / problem.mass * (2 if row else 1)  # both bodies of a cradle's contact move
    given |= {} if row else {"damping": -problem.damping / problem.mass, "gravity": -problem.gravity}
    template = Path(__file__).with_name("mujoco_cradle.xml" if row else "mujoco_peer.xml").read_text(encoding="utf-8")
    model = mujoco.MjModel.from_xml_string(template.format(apart=2 * problem.radius, **given))
    data = mujoco.MjData(model)
    data.qvel[:] = [problem.speed] + [0.0] * (problem.balls - 1) if row else problem.velocity

    def advance():
        mujoco.mj_step(model, data, nstep=count)

    def state():
        if any(warning.number for warning in data.warning):
            raise ArithmeticError("MuJoCo warned of a bad state and began anew")
        if row:
            return [x for k, moved in enumerate(data.qpos.tolist()) for x in (2 * problem.radius * k + moved, 0.0, 0.0)]
        place = [start + moved for start, moved in zip(problem.position, data.qpos.tolist(), strict=True)]
        return place + data.qvel.tolist()

    return Run(advance, state)
