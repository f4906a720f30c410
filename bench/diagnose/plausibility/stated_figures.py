"""Figures of a robot that are no error, and hardly what somebody meant: per cent, and instruments that see nothing."""

from collections.abc import Iterator

import numpy as np

from bench.effects.places import most_acceleration, torque_limit
from bench.record.finding import Finding
from bench.record.rules.alignment import SEARCH_S
from bench.record.rules.sheet import TRAVEL
from bench.robot.compiled import CompiledRobot
from bench.robot.plausible import OF_ROTORS

WHOLE = 1.0  # exact: 100 %; a mass, level or gain that is off by itself may as well be left out
OF_THE_WHOLE = ("mass", "friction", "gas_constant", "load")  # what else is relative is known to a factor of several


def remarks_on(compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield a warning for each figure that is hardly what somebody meant.

    Args:
        compiled: A robot.
    """
    for key, message, remedy in (*_uncertainties(compiled), *_instruments(compiled)):
        yield Finding("warning", f"{compiled.robot.folder.name}/figures.yaml", None, key, message, remedy)
    for j, drive in enumerate(compiled.robot.figures.drives):
        acceleration = most_acceleration(compiled, j)
        if np.isfinite(acceleration) and acceleration > OF_ROTORS.most:
            message = (
                f"{OF_ROTORS.what} is {acceleration:.2g} {OF_ROTORS.unit}; in a robot it is {OF_ROTORS.most:g} at most"
            )
            yield Finding("warning", compiled.robot.mjcf.name, None, drive.joint, message, OF_ROTORS.remedy)


def _uncertainties(compiled: CompiledRobot) -> Iterator[tuple[str, str, str]]:
    figures = compiled.robot.figures
    stated: dict[str, float] = {}
    for key in OF_THE_WHOLE:
        value = getattr(figures.uncertainty, key)
        each = {f"[{j}]": one for j, one in enumerate(value)} if isinstance(value, tuple) else {"": value}
        stated |= {f"uncertainty.{key}{place}": one for place, one in each.items()}
    stated |= {f"drives[{j}].torque_constant_error": one.torque_constant_error for j, one in enumerate(figures.drives)}
    for name in ("force", "current", "torque"):
        if sensor := getattr(figures.instruments, name):
            stated[f"instruments.{name}.gain_sigma"] = sensor.gain_sigma
    for key, value in stated.items():
        if value > WHOLE:
            yield key, f"is stated {value:.0%} uncertain", f"per cent? write {value / 100:g}"


def _instruments(compiled: CompiledRobot) -> Iterator[tuple[str, str, str]]:
    """Yield what is coarser than all that it has to read."""
    instruments, n = compiled.robot.figures.instruments, compiled.n_joints
    ranges = [torque_limit(compiled, j) for j in range(n)]
    if sensor := instruments.current:
        least = min(most / abs(constant) for most, constant in zip(ranges, compiled.torque_constant, strict=True))
        for key in ("sigma_a", "resolution_a", "offset_sigma_a"):
            if (value := getattr(sensor, key)) > least:
                message = f"{value:g} A is more than a drive has, {least:.3g} A"
                yield f"instruments.current.{key}", message, "milliamperes? multiply by 0.001"
    if torque := instruments.torque:
        for j, (value, most) in enumerate(zip(torque.sigma_of(n), ranges, strict=True), start=1):
            if value > most:
                yield (
                    "instruments.torque.sigma_nm",
                    f"{value:g} is more than drive {j} has, {most:.3g}",
                    "mNm? multiply by 0.001",
                )
    encoders = {"encoder": instruments.encoder, "link_encoder": instruments.link_encoder}
    for key, encoder in encoders.items():
        if encoder and encoder.resolution_rad >= TRAVEL["rad"]:
            message = f"{encoder.resolution_rad:g} rad is as much as a joint moves to be called moving"
            yield f"instruments.{key}.resolution_rad", message, "degrees, or of the motor before its gear?"
    if instruments.encoder and instruments.encoder.delay_s > SEARCH_S:
        message = f"{instruments.encoder.delay_s:g} s is later than any controller logs"
        yield "instruments.encoder.delay_s", message, "milliseconds? multiply by 0.001"
