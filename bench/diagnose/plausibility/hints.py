"""What a fast look shows of errors that a diagnosis weighs itself, in numbers: channels scaled, late, not explained."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from pathlib import Path

import numpy as np

from bench.diagnose.plausibility.between_runs import too_far_apart
from bench.diagnose.plausibility.channels import doubts_of
from bench.diagnose.plausibility.cold_gears import cold_gears
from bench.diagnose.plausibility.copied_repeats import copied_repeats
from bench.diagnose.plausibility.drive_looks import DriveLook, Factor
from bench.diagnose.plausibility.known_temperature import known_temperatures
from bench.diagnose.plausibility.late_channels import SURE, Late, late_drives, late_gauges, late_reflectors
from bench.diagnose.plausibility.loads import unlike_weights, weights_that_drives_doubt
from bench.diagnose.plausibility.one_more_number import one_more_number
from bench.diagnose.plausibility.one_run import unlike_other_runs
from bench.diagnose.plausibility.repeated import Repeated
from bench.diagnose.plausibility.reported_torques import unlike_currents
from bench.diagnose.plausibility.single_rows import beyond_guessed_limits, overloads
from bench.diagnose.plausibility.stated_noise import coarse_encoders, noise_as_stated, rounded_places
from bench.diagnose.plausibility.unexplained import unexplained
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.world import NOMINAL
from bench.effects.conditions import REFERENCE_K
from bench.effects.gas import GasLoss, GasTemperature
from bench.effects.recorded import LATEST_DRIVE_S
from bench.effects.recording_channel import ChannelDelay
from bench.effects.sensing_drive import DriveDelay, TorqueConstant
from bench.errors import ConvergenceError
from bench.record.campaign import Campaign
from bench.record.finding import Finding
from bench.record.rules.clock import is_unsteady
from bench.robot.compiled import CompiledRobot
from bench.store.store import Store

# derived: beyond it a channel's scale is likelier than a torque constant: of an even distribution as wide as its range
SCALED = SURE * TorqueConstant.parameters[0].sigma


def doubts_and_hints_of(
    campaign: Campaign,
    compiled: CompiledRobot,
    known: Sequence[Finding] = (),
    store: Store | None = None,
) -> tuple[Finding, ...]:
    """Return a doubt for each channel that can hardly be what its name says, and where nothing is doubted, hints.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
        known: What was found before.
        store: Where what was simulated is kept between processes; None: nowhere.
    """
    repeated = Repeated.of(campaign, compiled)
    doubts = doubts_of(campaign, compiled, known, repeated)
    return doubts + hints_of(campaign, compiled, (*known, *doubts), store, repeated)


def hints_of(
    campaign: Campaign,
    compiled: CompiledRobot,
    known: Sequence[Finding] = (),
    store: Store | None = None,
    repeated: Repeated | None = None,
) -> tuple[Finding, ...]:
    """Return a warning for each channel that looks scaled, late or unlike its drive, as far as a linear look can tell.

    Args:
        campaign: A checked campaign.
        compiled: Its robot, nominal.
        known: What was found before; with a doubt among it nothing is said.
        store: Where what was simulated is kept between processes; None: nowhere.
        repeated: The campaign as its robot repeats it, where somebody has looked at it before; None: made here.
    """
    if any(finding.level in ("doubt", "error") for finding in known):
        return ()
    repeated = repeated or Repeated.of(campaign, compiled)
    campaign = repeated.campaign
    found = [*too_far_apart(campaign, compiled), *unlike_currents(campaign, compiled), *unlike_weights(campaign)]
    found += [*known_temperatures(campaign), *cold_gears(campaign), *noise_as_stated(campaign, compiled.robot)]
    found += [*coarse_encoders(campaign, compiled.robot), *rounded_places(campaign, compiled.robot)]
    found += copied_repeats(repeated)
    told = {finding.column for finding in known}
    found += [hint for hint in overloads(campaign, compiled) if hint.column not in told]
    found += [hint for hint in beyond_guessed_limits(campaign, compiled) if hint.column not in told]
    if not repeated.quantities:
        words = (
            "nothing can be held against the model: no drive torque or current is recorded, and nothing else that it "
            "predicts"
        )
        remedy = "record tau_motor_N_nm or current_N_a of the drives"
        return (*found, Finding("warning", "all runs", None, "", words, remedy))
    try:
        if not repeated.segments:
            words = (
                "nothing can be held against the model: there is no rest, and no motion that goes on for long enough"
            )
            remedy = "look at the clock; move for longer"
            return (*found, Finding("warning", "all runs", None, "time_s", words, remedy))
        if paid := repeated.paid:
            picture, at_rest = repeated.picture, repeated.at_rest
            scaled = tuple(_scaled(repeated.looks, compiled))
            found += scaled or weights_that_drives_doubt(campaign, compiled)  # currents of a wrong scale say nothing
            alone = (DriveDelay if compiled.n_joints == 1 else ChannelDelay).name
            found += _late(late_drives(repeated.by_drives, picture, at_rest), LATEST_DRIVE_S, alone)
            unsteady = [repr(run) for run in _unsteady(campaign)]  # tell no acceleration, and that was said of them

            def is_new(hint: Finding) -> bool:
                return not any(run in hint.message for run in unsteady)

            found += filter(is_new, unlike_other_runs(picture, paid, at_rest))
            told = {hint.column for hint in found}
            found += [hint for hint in unexplained(picture, paid) if hint.column not in told and is_new(hint)]
        if repeated.seen:
            replay = repeated.by_others
            both = (*late_reflectors(replay), *late_gauges(replay))
            found += _late(both, ChannelDelay.parameters[0].low, ChannelDelay.name)
            found += _gauge(replay)
        found += one_more_number(repeated, frozenset(_suspected(campaign, found)), store)
    except ConvergenceError:
        return tuple(found)
    return tuple(found)


def _unsteady(campaign: Campaign) -> list[str]:
    """Return motions whose clock was found not to tell when each row was read."""
    return [run.name for run in campaign.of_kind("motion") if is_unsteady(run.columns["time_s"])]


def _suspected(campaign: Campaign, found: Sequence[Finding]) -> Iterator[str]:
    """Yield runs of which something was said, or whose loads or forces were found to disagree."""
    yield from _unsteady(campaign)
    for run in campaign.runs:
        of_loads = {Path(hint.file).stem for hint in found if hint.column.startswith(("load_", "force_", "moment_"))}
        if run.name in of_loads or any(repr(run.name) in hint.message for hint in found):
            yield run.name


def _scaled(looks: Sequence[DriveLook], compiled: CompiledRobot) -> Iterator[Finding]:
    factors = {look.column: _factor(look, compiled) for look in looks if look.fits}
    told = {column: factor for column, factor in factors.items() if np.isfinite(factor.relative)}
    if alike := _all_alike(told):
        yield alike
        return
    for column, factor in told.items():
        others = [other.value for name, other in told.items() if name != column]
        as_stated = [abs(value - 1) < SCALED for value in others]
        off = abs(factor.value - 1)
        if others and 2 * sum(as_stated) > len(others) and off > SCALED and off > SURE * factor.sigma:
            times = f"{factor.value:.2f} ± {factor.sigma:.2f} times what the model needs, others as stated"
            yield _hint(column, f"{_looks(factor.value)}: {times}", "channel_scale")


def _looks(factor: float) -> str:
    if abs(factor / 2 - 1) < SCALED / 2:
        return "looks doubled"
    return "looks halved" if abs(2 * factor - 1) < SCALED / 2 else "looks scaled"


def _gauge(replay: Replay) -> Iterator[Finding]:
    """Yield a warning where a gauge reads more or less than gas that was lost or is warm accounts for."""
    observed, nominal = replay.observed, replay.predict(NOMINAL)
    warm = GasTemperature.parameters[0].high / REFERENCE_K
    least, most = (1 - GasLoss.parameters[0].high) * (1 - warm), 1 + warm
    for c, quantity in enumerate(replay.quantities):
        rows = np.isfinite(observed[:, c])
        if quantity.kind != "gas_pressure" or not np.any(rows):
            continue
        ratio = float(np.median(observed[rows, c]) / np.median(nominal[rows, c]))
        if not least < ratio < most:
            made = f"lost or warm gas makes {least:.2f} to {most:.2f}"
            yield _hint(
                quantity.column, f"{_looks(ratio)}: {ratio:.2f} times what the model has; {made}", "channel_scale"
            )


def _all_alike(told: Mapping[str, Factor]) -> Finding | None:
    """Return a warning where all channels have one factor that is not 1; no defect of a robot does that to all.

    The one that is known best tells it, and the others agree: what is known less well is no reason to doubt it, and
    errors that all masses share (all guessed by one density) do not shrink with the number of channels.
    """
    factors = [factor.value for factor in told.values()]
    if len(factors) < 2:
        return None
    middle = float(np.median(factors))
    best = min(factor.relative for factor in told.values())
    if not all(abs(value - 1) > SCALED for value in factors) or abs(np.log(middle)) < SURE * best:
        return None
    if max(abs(np.log(np.array(factors) / middle))) > SCALED:
        return None
    message = f"looks scaled, and so do {', '.join([*told][1:])}: about {middle:.2f} times what the model needs"
    remedy = "peak for root mean square? per cent of a rated value? the torque constants of another robot?"
    return Finding("warning", "all runs", None, next(iter(told)), message, remedy)


def _factor(look: DriveLook, compiled: CompiledRobot) -> Factor:
    """Return by how much a channel is scaled: by gravity where it is told, else by inertia, known less well.

    What is stated of masses is right to a share of all that they need, and the factor is told by a part of that alone:
    so uncertain is a factor of 1, and a larger one more.
    """
    figures = compiled.robot.figures
    inertia = float(figures.drive_uncertainty.rotor_inertia[look.index])
    gain = figures.drives[look.index].torque_constant_error
    by_gravity = look.gravity.relative < inertia
    if not by_gravity and figures.uncertainty.payload_kg:  # a payload that nobody stated has inertia, too
        return Factor(np.nan, np.inf)
    value, own = (look.gravity, figures.uncertainty.mass) if by_gravity else (look.whole, inertia)
    of_figures = max(1.0, value.value) * float(np.hypot(own / value.share, gain))
    return Factor(value.value, float(np.hypot(value.sigma, of_figures)))


def _late(found: Iterable[Late], least: float, effect: str) -> Iterator[Finding]:
    """Yield warnings of what is late, or early, where that explains most of what is left."""
    for late in found:
        delay = late.delay
        if abs(delay.value) > least + SURE * delay.sigma and late.explains_most:
            how = "late" if delay.value > 0 else "early"
            message = f"looks {how}, by about {1e3 * abs(delay.value):.0f} ms against the encoders"
            yield _hint(late.column, message, effect)


def _hint(column: str, message: str, effect: str) -> Finding:
    return Finding("warning", "all runs", None, column, message, f"bench diagnose weighs it ({effect})")
