"""A ball on a plane in closed form, to sixty digits, where all that acts is constant: the atlas's motion on a
line, with the gap as its coordinate. A ball that is dropped straight on a body is the same."""

from mpmath import mpf

from contact_fmus.stability.line_motion import Line


def plane_motion(gap, rate, acceleration, mass, penalty, viscous, dashpot, end):
    """Returns the gap and its rate at `end` (`place` and `speed`), and what happened. `acceleration` [m/s^2]
    is the gap's without the contact, `mass` [kg] the relative one."""
    law = {"stiffness": mpf(penalty), "damping": mpf(viscous), "dashpot": dashpot}
    start = {"push": mpf(acceleration), "place": mpf(gap), "speed": mpf(rate)}
    return Line(inside=False, reach=mpf(0), mass=mpf(mass), flat=True, **law, **start).run(end)
