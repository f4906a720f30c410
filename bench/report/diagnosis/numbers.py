"""How numbers are shown on the page and on the terminal: in units of a workshop, with the digits that they have."""

from collections.abc import Sequence

import numpy as np

# SI -> what a workshop reads, and how many of it make one
WORKSHOP = {"m": ("mm", 1e3), "rad": ("deg", 180 / np.pi), "rad/s": ("deg/s", 180 / np.pi), "Pa": ("bar", 1e-5)}
SIGNIFICANT = 2  # digits of half an interval
MOST_DECIMALS = 6  # of numbers without an exponent
MOST_DIGITS = 15  # of numbers with one: those that a double has
LARGE = 1e5  # from where on numbers have an exponent
LEAST_WIDER = 1 + 0.5 * 10 ** (1 - SIGNIFICANT)  # derived: by less, half an interval of 10 still reads 10


def workshop(unit: str) -> tuple[str, float]:
    """Return the unit in which a workshop reads a quantity of an SI unit, and how many of it make one."""
    return WORKSHOP.get(unit, (unit, 1.0))


def unit_name(unit: str) -> str:
    """Return the unit in which a quantity is shown; "" for a pure number."""
    return "" if unit == "1" else workshop(unit)[0]


def shown(values: Sequence[float], unit: str, resolution: float) -> tuple[str, ...]:
    """Return values as they are shown, without their unit: with the same decimals, or with exponents.

    Args:
        values: In `unit`.
        unit: SI.
        resolution: What two digits should be left of, in `unit`; where it is 0 or unknown, a hundredth of the largest.
    """
    scale = workshop(unit)[1]
    largest = max((abs(value * scale) for value in values if np.isfinite(value)), default=0.0)
    step = abs(resolution * scale)
    step = step if np.isfinite(step) and step > 0 else largest / 100
    decimals = max(_last_place(step), 0)
    if largest >= LARGE or decimals > MOST_DECIMALS:
        return tuple(_with_exponent(value * scale, step) for value in values)
    return tuple(_zero(f"{value * scale:.{decimals}f}") if np.isfinite(value) else "-" for value in values)


def _last_place(step: float) -> int:
    """Return the decimal place at which two digits of a step end, 3 for 0.012 and -1 for 120; 3 for no step."""
    return SIGNIFICANT - 1 - int(np.floor(np.log10(step))) if step > 0 else 3


def _with_exponent(value: float, step: float) -> str:
    """Return a large or small value with the digits that a step leaves it, one at least: "3.2e+07", "1.6e-07"."""
    if not np.isfinite(value):
        return "-"
    first = -int(np.floor(np.log10(abs(value)))) if value else 0
    return f"{value:.{int(np.clip(_last_place(step) - first + 1, 1, MOST_DIGITS))}g}"


def nats(value: float, *, sign: bool = False, tenths: bool = True) -> str:
    """Return a logarithm of odds: to a tenth where that may decide, from 100 on whole, in groups of three digits."""
    if not np.isfinite(value):
        return "-"
    plus = "+" if sign else ""
    return f"{value:{plus}.1f}" if tenths and abs(value) < 100 else f"{value:{plus},.0f}".replace(",", " ")


def percent(share: float) -> str:
    """Return a share or a probability in percent, never rounded to what it is not."""
    value = 100 * share
    if not np.isfinite(value):
        return "-"
    if 0 < value < 0.1:
        return "< 0.1 %"
    if -0.1 < value < 0:
        return "> -0.1 %"
    if 99.9 < value < 100:
        return "> 99.9 %"
    if 99 < value < 100:
        return f"{value:.1f} %"
    return f"{value:.0f} %" if abs(value) >= 10 else f"{value:.2g} %"


def gain_percent(share: float) -> str:
    """Return a gain in percent to a tenth: one that is smaller says nothing of a model, whatever its sign."""
    value = 100 * share
    if not np.isfinite(value):
        return "-"
    if abs(value) >= 10:
        return percent(share)
    return f"{_zero(f'{value:.1f}')} %"


def _zero(text: str) -> str:
    return text.removeprefix("-") if float(text) == 0 else text
