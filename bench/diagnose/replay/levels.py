"""What belongs to a machine, and what to one of its recordings: background errors of each, and worlds as each has them.

Geometry, masses, gears, friction laws and the law of the gas are the machine's, and so are the weights of the lab. Link
encoders are zeroed, a tracker is set up, reflectors are put into their nests, the force sensor is hung in and a payload
bolted on anew in each recording. Torque constants, levels of friction, the calibration of the force sensor and the
zeros of current and torque channels are the machine's with a drift (`effects/drifts.py`). The gas is as warm as the air
of the day.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from functools import partial

from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.world import World
from bench.effects.conditions import REFERENCE_K
from bench.effects.drifts import AIR_DAY_K, COULOMB, DAY_K
from bench.effects.figure_edits import LEAST_SHARE
from bench.effects.friction_elements import scale_coulomb
from bench.effects.gas import amount_scaled
from bench.effects.levels import acts_in
from bench.robot.compiled import CompiledRobot, SpecEdit
from bench.robot.figures import Drive

GAS_OF_THE_DAY = "temperature of the gas"


def with_recordings(
    nuisances: Sequence[Nuisance], compiled: CompiledRobot, recordings: Sequence[str]
) -> tuple[Nuisance, ...]:
    """Return the background errors of several recordings; of one recording, those that were given.

    Args:
        nuisances: Of robot and instruments, as in one recording.
        compiled: The robot.
        recordings: Names.
    """
    if len(recordings) < 2:
        return tuple(nuisances)
    found = [one for nuisance in nuisances for one in _in_recordings(nuisance, recordings)]
    found += [replace(one, recording=name) for one in _coulomb_of_the_day(compiled) for name in recordings]
    if compiled.counterbalance:
        found += [replace(gas_of_the_day(), recording=name) for name in recordings]
    return tuple(found)


def world_in(world: World, recording: str) -> World:
    """Return what of a world acts in one of its recordings."""
    if not world.is_told_apart:
        return world
    return World(
        {nuisance: value for nuisance, value in world.deviations.items() if nuisance.recording in (None, recording)},
        tuple(acting for acting in world.acting if acts_in(acting.place, recording)),
    )


def as_of(world: World, recording: str) -> World:
    """Return what of a world acts in one of its recordings, as the world of a machine that has no other."""
    here = world_in(world, recording)
    return World(
        {replace(nuisance, recording=None): value for nuisance, value in here.deviations.items()},
        tuple(replace(acting, place=replace(acting.place, recording=None)) for acting in here.acting),
    )


def handed_over(world: World, recordings: Sequence[str]) -> World:
    """Return what of a world is handed over: the machine with what belongs to the last of its recordings.

    Of what drifts from day to day, and of the warmth of the gas, each day has another part. The next one has another
    again, so of several recordings the mean of their days is handed over, which is nearest to any day.

    Args:
        world: Of all recordings.
        recordings: Names.
    """
    deviations = {one: mean_of_days(world.deviations, one) for one in world.deviations}
    return as_of(World(deviations, world.acting), recordings[-1])


def mean_of_days(deviations: Mapping[Nuisance, float], nuisance: Nuisance) -> float:
    """Return what is handed over of something that may be off: of what is of a day, the mean over all of them."""
    if not nuisance.is_of_day:
        return deviations[nuisance]
    days = [
        x for one, x in deviations.items() if one.is_of_day and (one.name, one.unit) == (nuisance.name, nuisance.unit)
    ]
    return sum(days) / len(days)


def _in_recordings(nuisance: Nuisance, recordings: Sequence[str]) -> Iterator[Nuisance]:
    if nuisance.lasting > 0:
        yield replace(nuisance, sigma=nuisance.lasting, between="same", own=0.0)
    if nuisance.own > 0:
        earlier = None if nuisance.lasting > 0 else nuisance.earlier  # else it is counted in what lasts
        own = replace(nuisance, sigma=nuisance.own, after_effects=nuisance.between == "drifts", earlier=earlier)
        for name in recordings:
            yield replace(own, recording=name)


def _coulomb_of_the_day(compiled: CompiledRobot) -> Iterator[Nuisance]:
    """Yield Coulomb friction of each joint that is not what it is on other days, where it may be off at all.

    What is stated of it, and what was found, is that of all days; without this a joint that runs stiffly on one of two
    days is blamed on everything else.
    """
    figures, sigma = compiled.robot.figures, COULOMB * DAY_K

    def scaled(drive: Drive, change: float) -> SpecEdit:
        return lambda spec, robot: scale_coulomb(spec, drive, 1 + max(change, LEAST_SHARE))

    for drive, uncertain in zip(figures.drives, figures.drive_uncertainty.friction, strict=True):
        if uncertain > 0:
            yield Nuisance(
                f"Coulomb friction of {drive.joint}",
                "",
                sigma,
                edit=partial(scaled, drive),
                between="drifts",
                own=sigma,
                least=LEAST_SHARE,
                after_effects=True,
            )


def gas_of_the_day() -> Nuisance:
    """Return gas that is warmer than nominal: it pulls more, and the thermometer shows it."""

    def edit(kelvin: float) -> SpecEdit:
        change = amount_scaled(1 + kelvin / REFERENCE_K)
        return change or (lambda spec, robot: None)

    return Nuisance(
        GAS_OF_THE_DAY,
        "K",
        AIR_DAY_K,
        edit=edit,
        on_reading=lambda x, reading: replace(reading, gas_temperature=reading.gas_temperature + x),
        between="anew",
        own=AIR_DAY_K,
    )
