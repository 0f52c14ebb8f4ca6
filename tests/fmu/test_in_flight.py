"""Steps and readings in flight, which the FMU does by shorter ways than others: with the same answers."""

import math
from ctypes import c_double, c_uint

from support.fmi2 import raw
from support.fmi2.raw import DISCARD, ERROR, array


def test_refused_steps_leave_no_trace_in_a_run(fmu):
    """Between good steps, most of them in flight, which an FMU may look at less closely than at others."""
    bad = [(-0.5, 1.0, ERROR), (1e-3, 1.0, ERROR), (math.nan, 1.0, ERROR), (-1e-5, 1.0, ERROR)]
    bad += [(0.0, factor, DISCARD) for factor in (0.0, -0.0, -1.0, math.nan, -math.inf, math.inf, 1e-17)]
    bad += [(0.0, 81.0, ERROR), (0.0, 1e300, ERROR)]  # past the stop time
    step, stop = 2.0**-10, 80 * 2.0**-10
    with raw.Instance(fmu) as disturbed, raw.Instance(fmu) as calm:
        disturbed.initialize(stop=stop)
        calm.initialize(stop=stop)
        for index in range(80):
            time = index * step
            if index % 3 == 2:
                shift, factor, status = bad[index // 3 % len(bad)]
                assert disturbed.call("DoStep", time + shift, factor * step, 1) == status, (shift, factor)
            disturbed.ok("DoStep", time, step, 1)
            calm.ok("DoStep", time, step, 1)
            if index >= 3 * len(bad):
                assert disturbed.bits("output") == calm.bits("output")
        assert disturbed.call("DoStep", stop, step, 1) == ERROR
        assert disturbed.save() == calm.save()


def test_reals_are_the_same_however_many_are_read_at_once(fmu, instance):
    reals = [variable.reference for variable in fmu.select("output", kind="Real")]
    instance.initialize()
    for index in range(20):
        instance.ok("DoStep", index * 1e-3, 1e-3, 1)
        alone = {
            one: instance.get_one(variable)
            for variable in fmu.variables.values()
            if (one := variable.reference) in reals
        }
        for count in (2, 3, 4, 6):
            for first in range(len(reals) - count + 1):
                for chosen in (reals[first : first + count], reals[first : first + count][::-1]):
                    values = array(c_double, [math.nan] * count)
                    instance.ok("GetReal", array(c_uint, chosen), count, values)
                    assert list(values) == [alone[one] for one in chosen]
