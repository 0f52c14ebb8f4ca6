"""ContactFmu: saved states as handles and as bytes, and an instance that is closed"""

import gc

import pytest

from contact_fmus.fmu.contact_fmu import ContactFmu, FmuError
from contact_fmus.running import scenarios as command

NAME = "SphereSphere"
FALL = {"source.center": [0.03, 0.04, 1.1], "contact.method": "penalty"}


@pytest.fixture
def fmu(fmu_path):
    with ContactFmu(fmu_path(NAME)) as instance:
        instance.start(FALL, tolerance=1e-9)
        yield instance


def go_on(fmu):
    for _ in range(7):
        fmu.step(0.1)
    return [*fmu["source.position"], fmu["contact.onsets"], fmu["energy.total"]]


def test_a_saved_state_restores_motion_and_time(fmu):
    fmu.step(0.3)
    state = fmu.save()
    first = go_on(fmu)
    fmu.restore(state)
    assert fmu.time == state.time == 0.3
    assert go_on(fmu) == first
    fmu.restore(state)  # as often as one likes
    assert go_on(fmu) == first


def test_bytes_of_it_restore_another_instance(fmu, fmu_path):
    fmu.step(0.3)
    state = fmu.save()
    first = go_on(fmu)
    for given in (state, bytes(state)):
        with ContactFmu(fmu_path(NAME)) as other:
            other.start(FALL, tolerance=1e-9)
            other.restore(given)
            assert other.time == 0.3
            assert go_on(other) == first


def test_nothing_is_serialized_unless_asked_for(fmu, monkeypatch):
    def refuse(*_):
        raise AssertionError("serialized")

    monkeypatch.setattr(fmu.slave, "serializeFMUstate", refuse)
    state = fmu.save()
    fmu.step(0.1)
    fmu.restore(state)
    with pytest.raises(AssertionError, match="serialized"):
        bytes(state)


def test_a_state_is_freed_when_it_goes(fmu, monkeypatch):
    freed = []
    free = fmu.slave.freeFMUstate
    monkeypatch.setattr(fmu.slave, "freeFMUstate", lambda handle: (freed.append(handle), free(handle)))
    state, other = fmu.save(), fmu.save()
    del state
    gc.collect()
    assert len(freed) == 1
    fmu.close()
    assert len(freed) == 2
    with pytest.raises(ValueError, match=r"the state of 0\.0 s went with its instance"):
        bytes(other)


def test_a_closed_instance_says_so(fmu):
    fmu.close()
    fmu.close()
    calls = {"step": lambda: fmu.step(0.1), "read": lambda: fmu["source.position"]}
    calls |= {"count": lambda: fmu["contact.onsets"], "write": lambda: fmu.__setitem__("source.mass", 2.0)}
    calls |= {"save": fmu.save, "reset": fmu.reset, "start": fmu.start}
    for call in calls.values():
        with pytest.raises(FmuError, match="This instance of SphereSphere is closed"):
            call()


def test_messages_show_numbers_as_a_user_writes_them(fmu):
    """The shortest digits that read back: neither 0.69999999999999996 nor fewer than there are"""
    fmu.reset()
    with pytest.raises(FmuError, match=r"source\.radius = 0\.7 m >= destination\.radius = 0\.5 m"):
        fmu.start({"source.radius": 0.7, "contact.location": "inside"})
    fmu.reset()
    refused = r"source\.mass = -0\.30000000000000004 refused \(allowed: 1e-150 \.\. 1e\+150\)"
    with pytest.raises(FmuError, match=refused):
        fmu["source.mass"] = -(0.1 + 0.2)


def test_the_leave_out_table_knows_no_fmu_whose_scene_is_gone(fmu_path, tmp_path, monkeypatch, capfd):
    for name in ("ForceElement", "Gone"):
        (tmp_path / f"{name}.fmu").write_bytes(fmu_path("ForceElement").read_bytes())
    monkeypatch.setenv("CONTACT_FMUS", str(tmp_path))
    assert command.leave_out([]) == 0
    told = capfd.readouterr().out
    assert "ForceElement" in told and "Gone" not in told and "library [bytes]" in told
