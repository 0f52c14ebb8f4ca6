"""Extreme scenes that event_driven once got wrong, each against its closed form"""

from dataclasses import replace

import pytest
from contact_stability import together
from contact_stability.head_on import GEOMETRIES, HeadOn
from contact_stability.run import run_scene
from contact_stability.scene import Jump, Scene


def check_right(scene):
    rows = [row for row in run_scene(scene) if row.method == "event_driven"]
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
    scenes = {(group, number): motion for group, number, motion in together.scenes()}
    check_right(Scene("all at once", group, scenes[group, number]))


@pytest.mark.parametrize("dashpot", ["non_adhesive", "unclamped", "approach_only"])
@pytest.mark.parametrize("geometry", GEOMETRIES)
def test_a_ball_that_a_dashpot_has_stopped_causes_no_more_events(geometry, dashpot):
    """Its gap rate has become 0, which is neither approach nor parting."""
    stopped = HeadOn(
        geometry=geometry, law="viscous_only", damping=1e4, dashpot=dashpot, gravity=0.0, speed=30.0, end=10.0
    )
    for row in check_right(Scene("viscous only", 1e4, stopped, steps=(1, 7, 50))):
        assert row.events <= 3 and row.steps <= 50 + row.communication_steps
