"""A number with its unit, such as "50 mm" or "2 deg/s", in the unit of a variable; pint knows the units

Scene files are read with it, and values of the command line too (scripts/contact_fmus/fmu/settings.py).
"""

import functools
import re
from decimal import Decimal

NUMBER = re.compile(r"\s*([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)\s*(.*?)\s*")


def in_unit(text: str, unit: str) -> float:
    """`unit` as FMI writes it: N.s/m, kg.m2. ValueError says what is wrong, as a clause"""
    match = NUMBER.fullmatch(text)
    if match is None:
        raise ValueError("no number with a unit")
    if not match[2]:
        raise ValueError(f"a text: without quotes it is a number in {unit}")
    try:
        registry = _registry()
    except ModuleNotFoundError:
        raise ValueError(
            "in a unit of its own, which needs the Python package pint: pip install pint"
        ) from None
    wanted = registry.Unit(_as_pint_writes(unit))
    try:
        given = registry.Unit(_as_pint_writes(match[2]))
    except Exception:  # pint's parser raises errors of many classes
        raise ValueError(f"in '{match[2]}', which is no unit that pint knows") from None
    # Angles count here, though pint takes a radian for 1: rpm is an angular velocity and Hz is none.
    if _root(registry, given) != _root(registry, wanted):
        raise ValueError(f"in '{match[2]}', which cannot be converted to {unit}")
    return float(registry.Quantity(Decimal(match[1]), given).to(wanted).magnitude)


@functools.cache
def _registry():
    """In decimal digits: 35 mm is the double nearest to 0.035 m"""
    import pint  # takes half a second, which only files with units pay

    return pint.UnitRegistry(non_int_type=Decimal)


def _as_pint_writes(unit: str) -> str:
    powers = re.sub(r"([^\W\d])(\d+(?:\.\d+)?)", r"\1**\2", unit)
    return "" if powers == "1" else re.sub(r"(?<=[^\W\d])\.|(?<=\d)\.(?=[^\W\d])", "*", powers)


def _root(registry, unit) -> dict:
    return dict(registry.Quantity(Decimal(1), unit).to_root_units().unit_items())
