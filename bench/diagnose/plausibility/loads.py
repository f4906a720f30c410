"""Loads that do not go with what drives paid, though no force sensor says so: of another unit, direction or step.

Within a visit to a pose only the load changes. Friction takes part of it or adds to it at each step, up to twice its
level; a load in kilonewtons is a thousand times too small.
"""

from collections.abc import Iterator

import numpy as np

from bench.diagnose.plausibility.drive_picture import DrivePicture
from bench.diagnose.plausibility.mistaken import NEAR, POUND_N, doubt
from bench.diagnose.plausibility.mistaken_inputs import ELSEWHERE, Recording, torque_with
from bench.diagnose.replay.instants import instants_of
from bench.effects.recording_log import HungLoad
from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.from_campaign import static_readings
from bench.identify.weights_by_drives import WEIGH, weights_by_drives
from bench.record.campaign import Array, Campaign
from bench.record.finding import Finding
from bench.record.units import STANDARD_GRAVITY
from bench.robot.compiled import CompiledRobot
from bench.robot.links import rigid_bodies

# derived: times; half way, on a logarithmic scale, from a load written down twice too small (hung_load) to pounds
TOO_SMALL = ((1 + HungLoad.parameters[0].high) * POUND_N) ** 0.5
ROUNDED = 0.01  # rounding: of a weight; gravity taken as 9.8 or 9.81, or a mass as full kilograms
OTHERS = 3  # declared: runs whose mass and weight agree, at least, beside the one where they do not
UNLIKE = 0.1  # declared: share of what drives paid that loads as stated leave; friction that turns round leaves less
FAR_BETTER = 0.2  # declared: part of it that other loads leave
# derived: correlation of what drives paid and what loads ask for, over all drives and states: they leave as little
ALIKE = (1 - FAR_BETTER) ** 0.5
UNITS = {
    1e3: "kilonewtons? multiply by 1000",
    STANDARD_GRAVITY: "kilograms? multiply by 9.80665",
    POUND_N: "pounds? multiply by 4.44822",
}


def mistaken_at_rest(picture: DrivePicture, recording: Recording) -> Iterator[Finding]:
    """Yield a doubt where currents ask for loads that are several times as large, or hang otherwise.

    Args:
        picture: What drives did.
        recording: The same, to be replayed with other loads.
    """
    bare = torque_with(recording)
    if bare is None:
        return
    factor = _slope(*_changes(picture, picture.model - bare, recording))
    if factor > TOO_SMALL:
        guess = next(
            (words for unit, words in UNITS.items() if abs(np.log(factor / unit)) < NEAR), "look at their unit"
        )
        yield doubt("load_z_n", f"drives paid for loads about {factor:.2g} times as large", guess)
        return
    unlike = _unlike(*_changes(picture, picture.model - bare, recording, inner=True))
    found = []
    for column, message, remedy, loads in ELSEWHERE if unlike > UNLIKE else ():
        other = torque_with(recording, loads)
        if other is not None:
            found.append((_unlike(*_changes(picture, other - bare, recording, inner=True)), column, message, remedy))
    if found and min(found)[0] < FAR_BETTER * unlike:
        _, column, message, remedy = min(found)
        yield doubt(column, f"loads {message}", remedy)


def _changes(
    picture: DrivePicture, of_loads: Array, recording: Recording, *, inner: bool = False
) -> tuple[Array, Array]:
    """Return what drives paid more than before, and what loads ask for, shape (m,) each.

    Before is the first state of a visit; with `inner` the state before, without the first and the last change of a
    visit: where rows slipped by a step, the load at one end of it stands nowhere.
    """
    paid, asked = [np.zeros(0)], [np.zeros(0)]
    for segment, rows in zip(recording.segments, instants_of(recording.segments), strict=True):
        if segment.is_static and len(segment) > 1:
            seen, asks = picture.observed[rows] / picture.slack, of_loads[rows] / picture.slack
            for found, values in ((paid, seen), (asked, asks)):
                found.append((np.diff(values, axis=0)[1:-1] if inner else values[1:] - values[0]).ravel())
    y, x = np.concatenate(paid), np.concatenate(asked)
    known = np.isfinite(y)
    return y[known], x[known]


def _unlike(y: Array, x: Array) -> float:
    """Return the share of the square of what drives paid that no multiple of the loads explains; 0 of nothing."""
    total, power = float(y @ y), float(x @ x)
    return 1 - float(x @ y) ** 2 / (power * total) if power * total > 0 else float(total > 0)


def _slope(y: Array, x: Array) -> float:
    """Return y over x by least squares, 0 where they do not go together."""
    power = float(np.sqrt((x @ x) * (y @ y)))
    return float(x @ y) / float(x @ x) if power > 0 and float(x @ y) > ALIKE * power else 0.0


def weights_that_drives_doubt(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield a warning where drives paid for other weights than hung there by what was written down.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
    """
    try:
        readings = static_readings(campaign, compiled.robot.figures)
    except InputError:  # no rests, or none without a load
        return
    arm, known = Arm(rigid_bodies(compiled)), compiled.robot.figures.uncertainty.load
    found = weights_by_drives(arm, compiled.counterbalance, readings, known)
    if found and found.are_wrong:
        yield Finding("warning", "all runs", None, "load_z_n", found.words, WEIGH)


def unlike_weights(campaign: Campaign) -> Iterator[Finding]:
    """Yield a warning for the motion whose bolted mass does not have the weight that its load states, as all others do.

    Args:
        campaign: A checked campaign.
    """
    states = {
        run.name: (float(np.mean(run.columns["load_mass_kg"])), -float(np.mean(run.columns["load_z_n"])))
        for run in campaign.of_kind("motion")
        if {"load_mass_kg", "load_z_n"} <= run.columns.keys()
    }
    ratios = {run: weight / STANDARD_GRAVITY / mass for run, (mass, weight) in states.items() if mass > 0}
    unlike = [run for run, ratio in ratios.items() if abs(ratio - 1) > ROUNDED]
    if len(unlike) == 1 and len(ratios) > OTHERS:
        mass, weight = states[unlike[0]]
        message = (
            f"is {mass:.4g} kg in run {unlike[0]!r}, whose load_z_n of {-weight:.4g} N is the weight of "
            f"{weight / STANDARD_GRAVITY:.4g} kg; in all other runs both agree"
        )
        yield Finding(
            "warning", "all runs", None, "load_mass_kg", message, "look which of the two was written down wrong"
        )
