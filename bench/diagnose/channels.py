"""Drive channels that are not what their name says: sign, unit or joint, against what the nominal model needs.

The nominal model may lack friction, payload and gas, so nothing rests on how well it fits. What is told rests on laws
that no such lack can break: friction takes energy, a drive stays within its limits, and a joint's torque follows that
joint's motion.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.drive_picture import DrivePicture, drive_picture
from bench.diagnose.quantities import quantities_of
from bench.diagnose.replay import Replay
from bench.diagnose.segments import segments_of
from bench.diagnose.turned_axes import doubt, turned_axes
from bench.effects.places import speed_limit, torque_limit
from bench.errors import ConvergenceError
from bench.record.campaign import Array, Campaign
from bench.record.finding import Finding
from bench.robot.compiled import CompiledRobot

BINS = 400  # of all motion; enough to tell a sign
BLOCKS = 6  # of the readings; what is said has to hold with any of them left out
LEAST = 30  # readings of a drive in motion
GAINED = 0.05  # of all work exchanged, that friction may seem to give; see bench.record.rules.work
BEYOND = 2.0  # times the limits of a drive
FEEBLE = 0.1  # of the torque that the model needs; friction only adds to it, no counterbalance takes so much away
ANOTHERS, FAR_BETTER = 0.8, 0.3  # variance explained by another joint's motion; part of the own misfit that this leaves


def doubts_of(campaign: Campaign, compiled: CompiledRobot, known: Sequence[Finding] = ()) -> tuple[Finding, ...]:
    """Return a warning for each drive channel that cannot be what its name says.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
        known: What was found before; a column is not reported twice.
    """
    told = {finding.column for finding in known}
    quantities = tuple(q for q in quantities_of(campaign.runs, compiled) if q.is_drive)
    segments = segments_of(campaign, compiled, quantities, BINS)
    if not segments:
        return ()
    try:
        picture = drive_picture(Replay(compiled, segments, quantities))
    except ConvergenceError as error:
        return (doubt("", f"the nominal model cannot follow the motion ({error})", "look at angles and their units"),)
    if too_fast := tuple(_beyond_speed(picture, compiled)):
        return too_fast
    found = []
    for j, name in enumerate(picture.names):
        if not name or name in told:
            continue
        rows = np.isfinite(picture.observed[:, j])
        if rows.sum() >= LEAST:
            found += list(_of_drive(picture, compiled, j, rows))[:1]
    return tuple(found) or tuple(turned_axes(picture, segments, quantities, compiled))


def _beyond_speed(picture: DrivePicture, compiled: CompiledRobot) -> Iterator[Finding]:
    for j, top in enumerate(np.max(np.abs(picture.velocity), axis=0)):
        drive, limit = compiled.robot.figures.drives[j].joint, speed_limit(compiled, j)
        if top > BEYOND * limit:
            message = f"{drive} moves at {top:.3g} per s, its limit is {limit:.3g}"
            yield doubt(f"q_motor_{j + 1}", message, "degrees or millimetres? give SI units")


def _of_drive(picture: DrivePicture, compiled: CompiledRobot, j: int, rows: NDArray[np.bool_]) -> Iterator[Finding]:
    """Yield what is wrong with one drive's channel, the surest first."""
    name, drive = picture.names[j], compiled.robot.figures.drives[j].joint
    values, model, velocity = picture.observed[rows, j], picture.model[rows, j], picture.velocity[rows, j]
    columns = picture.columns(j)[rows]
    largest, limit = float(np.max(np.abs(values))), torque_limit(compiled, j)
    if largest > BEYOND * limit:
        yield doubt(
            name, f"reaches {largest / limit:.3g} times the limit of {drive}", "mNm, or divided twice? give SI units"
        )
    own, other = _misfit(columns, values), _best_other(picture, j, rows)
    if other is not None and other[1] < min(FAR_BETTER * own, (1 - ANOTHERS) * float(np.var(values))):
        yield doubt(
            name, f"follows the motion of joint {other[0] + 1}, not of {j + 1}", "look at the order of the joints"
        )
    ratio = float(np.sqrt(np.mean(values**2) / np.mean(model**2))) if np.any(model) else np.inf
    if ratio < FEEBLE:
        yield doubt(
            name,
            f"is {1 / ratio:.3g} times smaller than what {drive} needs",
            "on the motor side of the gear, or in kNm? multiply by the gear ratio, give SI units",
        )
    gains = [_energy(columns[kept], values[kept], velocity[kept]) for kept in _leaving_out(len(values))]
    if max(gains) < -GAINED:
        yield doubt(name, f"friction of {drive} would give energy", "turn the sign of this channel, or of the angle")


def _fit(columns: Array, values: Array) -> Array:
    size = np.maximum(np.linalg.norm(columns, axis=0), 1e-12)
    found: Array = np.linalg.lstsq(columns / size, values)[0] / size
    return found


def _misfit(columns: Array, values: Array) -> float:
    """Return the variance that columns leave."""
    return float(np.mean((values - columns @ _fit(columns, values)) ** 2))


def _best_other(picture: DrivePicture, j: int, rows: NDArray[np.bool_]) -> tuple[int, float] | None:
    """Return the other joint whose motion explains a channel best, and the variance that it leaves."""
    others = [k for k in range(len(picture.names)) if k != j and np.ptp(picture.velocity[rows, k]) > 0]
    misfits = [(k, _misfit(picture.columns(k)[rows], picture.observed[rows, j])) for k in others]
    return min(misfits, key=lambda found: found[1]) if misfits else None


def _leaving_out(n: int) -> Iterator[NDArray[np.bool_]]:
    """Yield masks over n readings, each with one block of them left out."""
    block = np.arange(n) * BLOCKS // n
    for b in range(BLOCKS):
        yield block != b


def _energy(columns: Array, values: Array, velocity: Array) -> float:
    """Return what friction takes, as a part of all power exchanged."""
    found = _fit(columns, values)
    taken = columns[:, 1:3] @ found[1:3] * velocity
    return float(taken.sum() / np.abs(values * velocity).sum())
