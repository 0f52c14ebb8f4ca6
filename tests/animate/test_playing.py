"""An animation plays, dwells on contacts, and does what mouse, fingers and keys ask."""

import numpy as np
import pytest

# A busy machine is not waited for by the clock, but by what it has drawn.
TEN_FRAMES = """new Promise((done) => {
  let left = 10;
  const next = () => (left-- > 0 ? requestAnimationFrame(next) : done());
  next();
})"""


@pytest.mark.parametrize("case", ["BallInShell", "BallOffRoller", "ThreeBalls", "free_pair"])
def test_it_plays_until_it_is_told_to_pause(case, opened, browser):
    page = opened(case, width=900, height=700)
    page.run("contactAnimation.play()")
    before, frames = page.run("contactAnimation.time"), page.run("contactAnimation.frames")
    page.wait_for(f"contactAnimation.time !== {before!r} && contactAnimation.frames > {frames}")
    page.run("contactAnimation.pause()")
    before = page.run("contactAnimation.time")
    page.run(TEN_FRAMES)
    assert page.run("contactAnimation.time") == before


def test_it_dwells_on_a_contact_unless_told_not_to(opened):
    page = opened("BallInShell")
    rate = "(contactAnimation.seek({0}), contactAnimation.playback.rate())"
    shown = "contactAnimation.playback.toShown(0.304838) - contactAnimation.playback.toShown(0.301681)"
    assert page.run(rate.format(0.2)) == pytest.approx(1.0)  # of a run of 3 s: real time
    assert page.run(rate.format(0.3032)) < 0.01
    assert page.run(shown) > 1.0  # s, for a contact of 3.2 ms
    page.run("document.querySelector('[data-is=slow]').click()")
    assert page.run(rate.format(0.3032)) == pytest.approx(1.0)
    assert page.run(shown) == pytest.approx(0.0032, rel=0.05)


def test_the_next_contact_is_one_press_away(opened):
    page = opened("BallInShell")
    page.run("contactAnimation.seek(0.4); document.querySelector('[data-is=after]').click()")
    assert 0.49 < page.run("contactAnimation.time") < 0.4971456
    page.run("document.querySelector('[data-is=before]').click()")
    assert 0.29 < page.run("contactAnimation.time") < 0.3016808


def test_forces_are_arrows_from_the_contact(opened):
    page = opened("BallInShell")
    arrows = "contactAnimation.world.contacts[0].forces.map((one) => one.arrow.arrow.visible)"
    value = "contactAnimation.world.contacts[0].forces[0].value"
    page.run("contactAnimation.seek(0.2)")
    assert page.run(arrows) == [False, False]
    page.run("contactAnimation.seek(0.303)")
    assert page.run(arrows) == [True, True]
    assert page.run(value) > 2000  # N; the chart of the force says 2.4 kN
    page.run("document.querySelector('[data-is=forces]').click(); contactAnimation.seek(0.303)")
    assert page.run(arrows) == [False, False]


def direction(page):
    camera = page.run("contactAnimation.camera()")
    apart = np.array(camera["position"]) - camera["target"]
    return apart / np.linalg.norm(apart), float(np.linalg.norm(apart))


def middle(page):
    x, y = page.run(
        "(r => [r.left + 0.5 * r.width, r.top + 0.5 * r.height])"
        "(document.querySelector('.stage').getBoundingClientRect())"
    )
    return x, y


def settled(page, browser):
    page.run(TEN_FRAMES)
    return direction(page)


def test_the_mouse_turns_and_zooms(opened, browser):
    page = opened("BallInShell", width=900, height=700)
    (before, far), (x, y) = direction(page), middle(page)
    page.mouse("mousePressed", x, y, button="left", buttons=1, clickCount=1)
    for way in (50, 100, 150):
        page.mouse("mouseMoved", x + way, y + 20, button="left", buttons=1)
    page.mouse("mouseReleased", x + 150, y + 20, button="left", clickCount=1)
    after, same = settled(page, browser)
    assert before @ after < 0.9
    assert same == pytest.approx(far)
    page.mouse("mouseWheel", x, y, deltaX=0, deltaY=-300)
    assert settled(page, browser)[1] < 0.95 * far


def test_fingers_turn_and_zoom(opened, browser):
    page = opened("BallInShell", width=500, height=800)
    (before, far), (x, y) = direction(page), middle(page)
    page.touch("touchStart", [(x, y)])
    for way in (40, 80, 120):
        page.touch("touchMove", [(x + way, y)])
    page.touch("touchEnd", [])
    after, _ = settled(page, browser)
    assert before @ after < 0.9
    page.touch("touchStart", [(x - 30, y), (x + 30, y)])
    for way in (40, 60, 80):
        page.touch("touchMove", [(x - way, y), (x + way, y)])
    page.touch("touchEnd", [])
    assert settled(page, browser)[1] < 0.8 * far


@pytest.mark.parametrize("dark", [False, True])
def test_a_narrow_window_shows_all_of_it(opened, dark):
    page = opened("free_pair", width=500, height=800, dark=dark)
    assert page.run("document.documentElement.scrollWidth") <= 500
    places = "[...document.querySelectorAll('main *')].map((one) => one.getBoundingClientRect())"
    sides = page.run(f"{places}.map((one) => [one.left, one.right])")
    assert all(left >= 0 and right <= 500 for left, right in sides)
    light = np.mean(page.picture())
    assert light < 80 if dark else light > 180
