"""Channels that are not what their name says: sign, unit or joint, against what the nominal model needs.

The nominal model may lack friction, payload and gas. What is told rests on laws that no such lack can break (friction
takes energy, a drive stays within its limits, a joint's torque follows that joint's motion), or on a model that fits
well once a channel is read in another way (`mistaken.py`), or on distances far beyond any defect (`displaced.py`).
"""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from bench.diagnose.plausibility.displaced import displaced
from bench.diagnose.plausibility.drive_looks import LEVEL, Clock, clock_of
from bench.diagnose.plausibility.drive_picture import LEAST, DrivePicture
from bench.diagnose.plausibility.follows_loads import not_with_the_loads
from bench.diagnose.plausibility.known_pressure import known_pressures
from bench.diagnose.plausibility.loads import mistaken_at_rest
from bench.diagnose.plausibility.mistaken import Mistake, doubt, mistakes_in, turned
from bench.diagnose.plausibility.mistaken_inputs import Recording, mistaken_joints, mistaken_loads, mistaken_payload
from bench.diagnose.plausibility.mistaken_run import mistaken_in_one_run
from bench.diagnose.plausibility.physical_fit import FAR_BETTER, HALF, misfit
from bench.diagnose.plausibility.repeated import BINS, Repeated
from bench.diagnose.plausibility.single_rows import BEYOND, jumps
from bench.diagnose.plausibility.slow_clock import slow_clock
from bench.diagnose.plausibility.smoothed import smoothed
from bench.diagnose.plausibility.some_channels import with_channels
from bench.diagnose.plausibility.speeds import least_top_speed
from bench.diagnose.plausibility.unstated_loads import unstated_loads
from bench.diagnose.replay.segments import segments_of
from bench.effects.places import speed_limit, torque_limit
from bench.errors import ConvergenceError, InputError
from bench.identify.dynamics.turned import turned_axis
from bench.record.campaign import Array, Campaign
from bench.record.finding import Finding
from bench.record.known import PAYLOAD
from bench.record.rules.work import GAINED
from bench.robot.compiled import CompiledRobot
from bench.robot.figures import MOST_RATINGS
from bench.robot.nominal_dynamics import nominal_dynamics

BLOCKS = 6  # declared: of the readings; what is said has to hold with any of them left out
# Times a limit that was made up: nearer, on a logarithmic scale, to what another unit would make of data (degrees, mNm)
# than to data in SI units
BEYOND_GUESS = {"speed limit": (180 / np.pi) ** 0.5, "torque limit": 1e3**0.5}
FEEBLE = (
    0.1  # assumed: of the torque that the model needs; friction only adds to it, no counterbalance takes so much away
)
LINEAR = "a model that is linear in what links weigh leaves"


@np.errstate(over="ignore", invalid="ignore")  # of a robot with absurd masses, whose model then finds no balance
def doubts_of(
    campaign: Campaign, compiled: CompiledRobot, known: Sequence[Finding] = (), repeated: Repeated | None = None
) -> tuple[Finding, ...]:
    """Return a doubt for each channel that can hardly be what its name says.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
        known: What was found before; a column is not reported twice, and where angles or loads are doubted already,
            nothing is made of them.
        repeated: The campaign as its robot repeats it, for who looks at it further; None: made here.
    """
    if any(finding.level == "doubt" and finding.column.startswith(("q_", "load_")) for finding in known):
        return ()
    if too_heavy := tuple(_beyond_rating(campaign, compiled)):
        return too_heavy
    if spoilt := tuple(jumps(campaign, compiled)):
        return spoilt
    told = {finding.column for finding in known if finding.level != "warning"}
    repeated = repeated or Repeated.of(campaign, compiled)
    stated, campaign = campaign, repeated.campaign
    try:
        if too_fast := tuple(_beyond_speed(campaign, compiled)):
            return too_fast
        found = list(_of_drives(repeated, told, partial(_of_payload, stated, repeated))) if repeated.paid else []
        found += known_pressures(repeated)
        if not any(finding.column.startswith("load_") for finding in found):  # else that is why they move
            found += unstated_loads(repeated)
        if repeated.seen:
            found += displaced(repeated.by_others)
        if not any(finding.level == "doubt" for finding in found):  # else that is why
            found += not_with_the_loads(repeated)
    except ConvergenceError as error:
        return (doubt("", f"the nominal model cannot follow the motion ({error})", "look at angles and their units"),)
    kept = tuple(finding for finding in found if finding.column not in told)
    kept = kept or tuple(_turned(campaign, compiled))
    told |= {finding.column for finding in found}
    return (
        *kept,
        *(finding for finding in smoothed(campaign, compiled, repeated.quantities) if finding.column not in told),
    )


def _turned(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield the axis that is turned in angle and torque alike, or in angle alone, whatever the links weigh."""
    try:
        turned = turned_axis(campaign, nominal_dynamics(compiled))
    except InputError:  # nothing moves for long enough
        return
    if turned:
        drives = [drive.joint for drive in compiled.robot.figures.drives]
        unit = "N" if compiled.is_slide[turned.drive] else "Nm"
        model = "its weight, friction and the stated offset leave" if turned.bounded else LINEAR
        how, back = ("and its torque does not", "its angle") if turned.alone else ("torque and angle alike", "both")
        message = (
            f"{' or '.join(drives[j] for j in turned.indices)} moves against the model's sense of turning, {how}: with "
            f"{back} turned, {model} {turned.after:.3g} {unit} of {drives[turned.drive]} instead of {turned.before:.3g}"
        )
        remedy = f"turn the sign of {back}{'' if turned.alone else ', or the axis in the MJCF'}"
        yield doubt(f"q_motor_{turned.indices[0] + 1}", message, remedy)


def _of_drives(
    repeated: Repeated, told: set[str], of_payload: Callable[[DrivePicture], Iterator[Mistake]]
) -> Iterator[Finding]:
    compiled, picture = repeated.compiled, repeated.picture
    if wrong_clock := tuple(_of_clock(clock_of(repeated.looks, compiled, LEVEL) or slow_clock(repeated, LEVEL))):
        yield from wrong_clock
        return
    dead = tuple(_dead(picture))
    yield from dead

    recording = Recording(repeated.by_drives)
    too_small = tuple(mistaken_at_rest(picture, recording))
    yield from too_small
    of_loads = chain(mistaken_loads(picture, recording), of_payload(picture))
    mistaken = [
        finding
        for finding in mistakes_in(picture, of_loads, lambda: mistaken_joints(picture, recording))
        if finding.column not in told and not any(finding.column == before.column for before in too_small)
    ]
    yield from mistaken
    for j, name in enumerate(picture.names if not mistaken else ()):
        if not name or name in told:
            continue
        rows = np.isfinite(picture.observed[:, j]) & ~picture.standing[:, j]
        if rows.sum() >= LEAST:
            of_drive = list(_of_drive(picture, compiled, j, rows))[:1]
            mistaken += of_drive
            yield from of_drive
    if not (dead or too_small or mistaken):
        yield from mistaken_in_one_run(picture, repeated.paid)


def _of_payload(stated: Campaign, repeated: Repeated, picture: DrivePicture) -> Iterator[Mistake]:
    """Yield the payload that is known besides, if there is one, as what may be wrong."""
    payloads = [one.value for one in stated.known if one.quantity == PAYLOAD and one.value > 0]
    if payloads:
        drives = repeated.drives
        segments = with_channels(segments_of(stated, repeated.compiled, drives, BINS), drives, drives)
        yield from mistaken_payload(picture, Recording(repeated.replay(segments, drives)), max(payloads))


def _of_clock(clock: Clock | None) -> Iterator[Finding]:
    if clock and not clock.low <= 1 <= clock.high:
        message = (
            f"counts {clock.rate:.2f} seconds for each second ({clock.low:.2f} to {clock.high:.2f}), by the inertia "
            f"that {clock.drives} drives paid for"
        )
        yield doubt("time_s", message, "look at the sampling rate that was stated")


def _beyond_rating(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield loads so far above what the robot is rated for that no drive holds them."""
    rating = compiled.robot.figures.rating
    for parts, rated, unit in ((slice(0, 3), rating.force_n, "N"), (slice(3, 6), rating.moment_nm, "Nm")):
        sizes = [(float(np.max(np.abs(run.load_wrench()[:, parts]), initial=0)), run.name) for run in campaign.runs]
        most, run = max(sizes, default=(0.0, ""))
        if most > MOST_RATINGS * rated:
            column = "load_z_n" if unit == "N" else "load_mx_nm"
            message = f"a load of {most:.3g} {unit} in run {run!r}, and the robot is rated for {rated:.3g}"
            yield doubt(column, message, "N and Nm? else correct the rating in figures.yaml")


def _beyond_speed(campaign: Campaign, compiled: CompiledRobot) -> Iterator[Finding]:
    """Yield joints that came further in a time than their drives can; a clock may be wrong as well as an angle."""
    for j in range(compiled.n_joints):
        drive, limit = compiled.robot.figures.drives[j].joint, speed_limit(compiled, j)
        top, run = max(
            ((least_top_speed(run, j + 1), run.name) for run in campaign.of_kind("motion")), default=(0.0, "")
        )
        if top > _tolerated(compiled, "speed limit", drive) * limit:
            message = f"{drive} moves at {top:.3g} per s in run {run!r}, its limit is {limit:.3g}"
            remedy = (
                "degrees or millimetres? give SI units; minutes or milliseconds in time_s? else correct "
                "speed_limit_rad_per_s in figures.yaml"
            )
            yield doubt(f"q_motor_{j + 1}", message, remedy)


def _tolerated(compiled: CompiledRobot, figure: str, drive: str) -> float:
    """Return how many times a limit of a drive data may reach without a doubt."""
    return BEYOND_GUESS[figure] if compiled.robot.figures.assumes(figure, drive) else BEYOND


def _dead(picture: DrivePicture) -> Iterator[Finding]:
    """Yield drives that read one number all along though the model needs more than friction can hold."""
    for j, name in enumerate(picture.names):
        seen = np.isfinite(picture.observed[:, j])
        if name and np.any(seen) and np.ptp(picture.observed[seen, j]) == 0:
            value, needed = picture.observed[seen, j][0], picture.model[seen, j]
            if np.max(np.abs(needed - value)) > picture.slack[j]:
                message = (
                    f"is {value / picture.unit[j]:g} all along, the model needs up to {np.max(np.abs(needed)):.3g} Nm"
                )
                yield doubt(name, message, "look whether it is connected, or remove it")


def _of_drive(picture: DrivePicture, compiled: CompiledRobot, j: int, rows: NDArray[np.bool_]) -> Iterator[Finding]:
    """Yield what is wrong with one drive's channel, the surest first."""
    name, drive = picture.names[j], compiled.robot.figures.drives[j].joint
    values, model, velocity = picture.observed[rows, j], picture.model[rows, j], picture.velocity[rows, j]
    columns = picture.columns(j)[rows]
    largest, limit = float(np.max(np.abs(values))), torque_limit(compiled, j)
    if largest > _tolerated(compiled, "torque limit", drive) * limit:
        yield doubt(
            name, f"reaches {largest / limit:.3g} times the limit of {drive}", "mNm, or divided twice? give SI units"
        )
    own, other = _misfit(columns, values), _best_other(picture, j, rows)
    if other is not None and other[1] < FAR_BETTER * own:
        yield doubt(
            name, f"follows the motion of joint {other[0] + 1}, not of {j + 1}", "look at the order of the joints"
        )
    ratio = float(np.sqrt(np.mean(values**2) / np.mean(model**2))) if np.any(model) else np.inf
    if ratio < FEEBLE:
        yield doubt(
            name,
            f"is {1 / ratio if ratio else np.inf:.3g} times smaller than what {drive} needs",
            "on the motor side of the gear, or in kNm? multiply by the gear ratio, give SI units",
        )
    gains = [_energy(columns[kept], values[kept], velocity[kept]) for kept in _leaving_out(len(values))]
    if max(gains) < -GAINED and misfit(turned(picture, (j,)))[j] < HALF * misfit(picture)[j]:
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
