"""Extreme scenes that event_driven once got wrong, each against its closed form"""

from dataclasses import replace

import pytest

from contact_fmus.stability.motions import GEOMETRIES, HeadOn
from contact_fmus.stability.run import METHODS, run_scene
from contact_fmus.stability.scenes import Jump, Scene, at_once


def check_right(scene):
    rows = run_scene(scene, METHODS[:1])
    found = [(row.wrong, row.status, row.message, row.onsets, row.expected_onsets) for row in rows]
    assert all(not row.wrong and row.status == "ok" for row in rows), found
    return rows


HOLLOW = ("sphere inside", "cylinder inside")


@pytest.mark.parametrize("law", ["undamped", "non_adhesive", "unclamped", "approach_only"])
@pytest.mark.parametrize("speed", [1e4, 1e5, 1e6, 1e9])
@pytest.mark.parametrize("geometry", HOLLOW)
def test_a_ball_that_comes_back_from_far_beyond_its_shell_touches_once(geometry, speed, law):
    """The way is thousands of times as long as the bodies are large, and its rounding that much coarser."""
    check_right(Scene("speed", speed, HeadOn(geometry=geometry, law=law, speed=speed), steps=(1, 2, 7)))


@pytest.mark.parametrize("law", ["undamped", "approach_only"])
@pytest.mark.parametrize("force", [1e8, 1e12, 1e14])
def test_a_ball_pulled_far_out_of_its_shell_touches_once_each_time(force, law):
    scene = HeadOn(geometry="sphere inside", law=law, force=force, gravity=0.0)
    check_right(Scene("force", force, scene, steps=(1, 7)))


@pytest.mark.parametrize("radii", [100.0, 1e3, 1e5])
@pytest.mark.parametrize("law", ["undamped", "non_adhesive", "unclamped", "approach_only"])
def test_a_shell_that_jumps_far_away_hits_its_ball_once_in_every_swing(law, radii):
    ball = HeadOn(geometry="sphere inside", law=law, prescribed=True, gravity=0.0)
    end = 40 * ball.contact_time()
    given = (Jump(2, -0.5 * radii), Jump(5, 0.0))
    check_right(Scene("jump", radii, replace(ball, speed=0.6 / end, end=end), steps=(8,), jumps=given))


@pytest.mark.parametrize("group, number", [(0, 17), (1, 5), (5, 7), (8, 35), (9, 29)])
def test_random_deep_impacts_touch_once_each(group, number):
    scenes = {(one.value, int(one.note.split()[1])): one.motion for one in at_once()}
    check_right(Scene("all at once", group, scenes[group, number]))


@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_ball_that_a_dashpot_has_stopped_causes_no_more_events(geometry, dashpot):
    """Its gap rate has become 0, which is neither approach nor parting."""
    stopped = HeadOn(
        geometry=geometry, law="viscous_only", damping=1e4, dashpot=dashpot, gravity=0.0, speed=30.0, end=10.0
    )
    for row in check_right(Scene("viscous only", 1e4, stopped, steps=(1, 7, 50))):
        assert row.events <= 3 and row.steps <= 50 + row.communication_steps


SOLID = ("sphere outside", "cylinder outside")


@pytest.mark.parametrize("damping", [1e-6, 1e-5, 1e-4])
@pytest.mark.parametrize("geometry", SOLID)
def test_a_weak_dashpot_without_a_spring_keeps_its_digits(geometry, damping):
    """The parts of its closed form nearly cancel."""
    weak = HeadOn(geometry=geometry, law="viscous_only", dashpot="unclamped", damping=damping, end=0.5)
    check_right(Scene("viscous only", damping, weak, steps=(1, 7)))


@pytest.mark.parametrize("law", ["undamped", "non_adhesive", "unclamped", "approach_only"])
@pytest.mark.parametrize("depth, speed", [(1.1, 1e5), (2.0, 1e6), (1e3, 1e4), (1e6, 1e6), (1e9, 1e3)])
@pytest.mark.parametrize("geometry", SOLID)
def test_a_bullet_passes_the_middle_in_a_few_pieces(geometry, depth, speed, law):
    """`depth` of the impact over the way to the middle"""
    small = HeadOn(geometry=geometry, law=law, source_radius=2.0**-17, destination_radius=2.0**-10, gap=0.5)
    penalty = (speed / (depth * small.reach)) ** 2
    shot = replace(small, gravity=0.0, speed=speed, penalty=penalty, ratio=0.05, end=1e3 / speed)
    for row in check_right(Scene("bullet", depth, shot, steps=(1, 7))):
        assert row.fallbacks == 0 and row.steps <= 40


@pytest.mark.parametrize("law", ["undamped", "non_adhesive", "unclamped", "approach_only", "viscous_only"])
@pytest.mark.parametrize("speed", [1.0, 0.0, -1.0, 1e-9])
@pytest.mark.parametrize("overlap", [0.999999, 1.0])
@pytest.mark.parametrize("geometry", SOLID)
def test_a_start_in_the_middle_of_a_solid_is_right(geometry, overlap, speed, law):
    one = HeadOn(geometry=geometry, law=law)
    placed = replace(one, place=one.reach * (1 - overlap), gap=0.0, speed=speed, end=0.05)
    for row in check_right(Scene("start", overlap, placed, steps=(1, 7, 50))):
        assert row.fallbacks == 0 and row.steps <= 100 + 2 * row.communication_steps


@pytest.mark.parametrize("group, number", [(3, 1), (3, 2), (5, 5), (8, 13), (9, 22)])
def test_random_ways_through_the_middle_are_right(group, number):
    scenes = {(one.value, int(one.note.split()[1])): one.motion for one in at_once()}
    for row in check_right(Scene("all at once", group, scenes[group, number])):
        assert row.fallbacks == 0 and row.steps <= 100


@pytest.mark.parametrize("share", [0.7, 1e-3, 1e-7])
@pytest.mark.parametrize("clearance", [1e-9, 1e-11, 1e-13])
@pytest.mark.parametrize("geometry", HOLLOW)
def test_the_gap_of_a_ball_that_all_but_fills_its_shell_has_all_its_digits(geometry, clearance, share):
    """Errors over the way, which is as short as the clearance, and of gaps far below the rounding of radii"""
    tight = HeadOn(geometry=geometry, law="undamped", source_radius=0.5 - clearance, gap=share * clearance)
    slow = replace(tight, gravity=0.0, speed=clearance, penalty=100.0)
    check_right(Scene("clearance", clearance, slow, steps=(1, 7)))


@pytest.mark.parametrize("law", ["undamped", "non_adhesive", "unclamped"])
@pytest.mark.parametrize("fall", [1e2, 1e5, 1e8])
@pytest.mark.parametrize("length", [None, 4e7])
def test_a_long_fall_onto_a_finite_cylinder_touches_where_the_gap_is_zero(length, fall, law):
    """It is pressed in by a millionth of a metre, which is no more than what the fall is rounded to."""
    roller = HeadOn(geometry="cylinder outside", law=law, source_radius=6.5e6, destination_radius=6.5e5)
    impact = replace(roller, gap=fall, speed=1.0, gravity=1.6, length=length, along=2.4e6 if length else 0.0)
    hit = (2.0 * 1.6 * fall + 1.0) ** 0.5
    check_right(Scene("fall", fall, replace(impact, penalty=(hit / 1e-6) ** 2), steps=(1, 31)))


@pytest.mark.parametrize("force", [1e3, 1e6, 1e9])
def test_a_ball_pressed_far_beyond_its_tube_leaves_by_the_end(force):
    """Where it is along the tube is no less exact for the way that it has gone across."""
    tube = HeadOn(geometry="cylinder inside", law="undamped", penalty=1e-6, gravity=0.0, force=force)
    moving = replace(tube, length=2.0, along=0.3, along_speed=1e-3, end=1e3)
    check_right(Scene("end", force, moving, steps=(1, 31)))


@pytest.mark.parametrize("speed", [1e2, 1e5, 1e8])
@pytest.mark.parametrize("mass", [1e-4, 1e-8])
def test_a_light_shell_carried_off_by_its_ball_causes_no_more_events(mass, speed):
    """The gap rate is the difference of two speeds, and rounded as they are."""
    shell = HeadOn(geometry="sphere inside", law="viscous_only", dashpot="approach_only", damping=10.0)
    shell = replace(shell, destination_mass=mass, gravity=0.0, force=1e-6)
    shot = replace(shell, speed=speed, end=2.5 / speed)
    for row in check_right(Scene("carried", mass, shot, steps=(1, 16))):
        assert row.events <= 3 and row.steps <= 50 + row.communication_steps


@pytest.mark.parametrize("law", ["undamped", "non_adhesive", "unclamped", "approach_only"])
@pytest.mark.parametrize("clearance", [1e-4, 1e-6, 1e-8])
@pytest.mark.parametrize("geometry", HOLLOW)
def test_a_ball_thrown_between_near_walls_touches_each_once(geometry, clearance, law):
    """It comes back from depths far larger than the clearance, with a gap rounded as those are."""
    ball = HeadOn(geometry=geometry, law=law, source_radius=0.5 - clearance, gap=0.5 * clearance)
    check_right(Scene("clearance", clearance, replace(ball, gravity=0.0, end=0.038), steps=(1, 7, 50)))


def test_a_penetration_that_has_died_away_does_not_open_again():
    """Far overdamped, without any load: what is left after so many decay times is noise of 1e-119 m."""
    tube = HeadOn(geometry="cylinder inside", law="unclamped", speed=0.54, gap=3608.0, gravity=0.0)
    tube = replace(tube, source_radius=0.0037, destination_radius=24581.0)
    slow = replace(tube, source_mass=1582.0, destination_mass=3e-5)
    check_right(Scene("died away", 0.0, replace(slow, penalty=1.66e8, ratio=43.0, end=16746.0), steps=(1, 7)))
