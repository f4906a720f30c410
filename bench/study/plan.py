"""What a study hides: single effects, nothing, what nobody listed, pairs, and twins; each in every world asked for."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal
from zlib import crc32

import numpy as np

from bench.effects.catalogue import catalogue
from bench.errors import InputError, unknown_names
from bench.hide.thermometers import USUAL
from bench.robot.compiled import CompiledRobot
from bench.study.labs import Lab
from bench.study.worlds import World, listed_in, unlisted_in

Kind = Literal["null", "single", "unlisted", "pair", "twin"]
SizeRule = Literal["three limits", "plausible", "clear"]


@dataclass(frozen=True)
class Counts:
    """How much a study hides.

    Attributes:
        seeds: Campaigns for each single effect; half at three times the detection limit, half over the plausible range.
            8 of every effect that can act make 700 campaigns with the rest, for which a few hours have room.
        nulls: Campaigns without an effect.
        unlisted: Campaigns with an effect that is not in the catalogue.
        pairs: Campaigns with two effects.
        twins: Whether the four pairs of twins are hidden, each in an ordinary session and in one that splits them.
        effects: Names of the single effects and of those in pairs; empty: all that can act on the robot.
        worlds: In which all of this is hidden; twins are of the plain one.

    Raises:
        InputError: A number is below 0.
    """

    seeds: int = 6
    nulls: int = 200
    unlisted: int = 40
    pairs: int = 40
    twins: bool = True
    effects: tuple[str, ...] = ()
    worlds: tuple[World, ...] = ("plain",)

    def __post_init__(self) -> None:
        numbers = {"seeds": self.seeds, "nulls": self.nulls, "unlisted": self.unlisted, "pairs": self.pairs}
        if problems := [
            f"{name} {number}: give a number of campaigns, 0 or more." for name, number in numbers.items() if number < 0
        ]:
            raise InputError(problems)


SMALL = Counts(seeds=2, nulls=2, unlisted=2, pairs=2, twins=False, effects=("gas_loss", "coulomb_level"))


@dataclass(frozen=True)
class Twin:
    """Two causes that look alike.

    Attributes:
        hidden: Effect and place, in words, that acts.
        other: Effect and place of its twin.
        size: Of what acts, as a share of the largest plausible: as large as its twin can be too.
        ordinary: A lab that cannot tell them apart.
        extra: The lab that can.
        remedy: What it has more, in words.
    """

    hidden: tuple[str, str]
    other: tuple[str, str]
    size: float
    ordinary: Lab
    extra: Lab
    remedy: str


@dataclass(frozen=True)
class Trial:
    """One campaign to be made and diagnosed.

    Attributes:
        name: Unique in a study; its random numbers follow from it and from the study's seed.
        kind: What it tests.
        effects: Names of what is hidden.
        number: Of its kind and effect, from 0; places take turns by it.
        size: How sizes are drawn.
        twin: Of a twin.
        is_split: Whether a twin is hidden in the lab that can tell.
        world: How the campaign is beside what is hidden.
    """

    name: str
    kind: Kind
    effects: tuple[str, ...] = ()
    number: int = 0
    size: SizeRule = "plausible"
    twin: Twin | None = None
    is_split: bool = False
    world: World = "plain"

    def rng(self, seed: int) -> np.random.Generator:
        """Return the random numbers of this campaign in a study with a seed."""
        return np.random.default_rng([seed, crc32(self.name.encode())])


def plan(counts: Counts, compiled: CompiledRobot, seed: int, lab: Lab | None = None) -> tuple[Trial, ...]:
    """Return the campaigns of a study; what takes long comes first.

    Args:
        counts: How many of each.
        compiled: The robot.
        seed: Of the study.
        lab: Where; None: the ordinary one.

    Raises:
        InputError: An unknown effect, or one that cannot act on the robot.
    """
    known = singles_of(compiled, lab or Lab())
    if unknown := unknown_names("effect that can act", counts.effects, known):
        raise InputError(unknown)
    return tuple(_trials(counts, counts.effects or known, compiled, np.random.default_rng(seed)))


def twins_of(compiled: CompiledRobot) -> tuple[Twin, ...]:
    """Return the twins that a robot can have."""
    found = []
    if compiled.counterbalance is not None:
        balanced = f"joint {compiled.counterbalance.joint + 1}"
        brief = Lab(without=("loading", "repeat_at_end", "line", "dwell", "tracker", "pressure"), is_brief=True)
        thermometer = Lab(channels=("gas_temperature",))
        longer = f"sweeps of {balanced} over its range, "
        loss, warmer = ("gas_loss", "robot"), ("gas_temperature", "robot")
        seal, coulomb = ("seal_friction", "robot"), ("coulomb_level", balanced)
        payload, constant = ("payload_mass", "robot"), ("torque_constant", balanced)
        found += [
            Twin(loss, warmer, 0.6, Lab(), thermometer, "a thermometer on the gas"),
            Twin(seal, coulomb, 0.6, brief, Lab(), longer + "and a gauge on the gas"),
            Twin(constant, payload, 1.0, brief, Lab(), longer + "a second payload, and the tracker"),
        ]
    gear, foot = ("joint_compliance", "joint 1"), ("base_torsion", "robot")
    found.append(Twin(gear, foot, 0.3, Lab(), Lab(link_encoder=True), "an encoder on the link of joint 1"))
    return tuple(found)


def singles_of(compiled: CompiledRobot, lab: Lab) -> tuple[str, ...]:
    """Return the effects of the catalogue that can act on a robot in a lab and be seen with its channels."""
    channels = {*USUAL, *lab.channels, *type(compiled.robot.figures.instruments).model_fields}
    return tuple(
        name for name, effect in catalogue().items() if lab.places(effect, compiled) and set(effect.needs) <= channels
    )


def _trials(
    counts: Counts, effects: tuple[str, ...], compiled: CompiledRobot, rng: np.random.Generator
) -> Iterator[Trial]:
    for twin in twins_of(compiled) if counts.twins and "plain" in counts.worlds else ():
        for is_split in (False, True):
            words = "split" if is_split else "ordinary"
            yield Trial(f"twin {twin.hidden[0]} {words}", "twin", (twin.hidden[0],), twin=twin, is_split=is_split)
    for world in counts.worlds:
        listed, others = listed_in(world, effects), tuple(unlisted_in(world))
        for trial in _of_world(counts, listed, others, rng):
            name = trial.name if world == "plain" else f"{world} {trial.name}"
            yield replace(trial, name=name, world=world)


def _of_world(
    counts: Counts, effects: tuple[str, ...], others: tuple[str, ...], rng: np.random.Generator
) -> Iterator[Trial]:
    for i in range(counts.pairs if len(effects) > 1 else 0):
        first, second = rng.choice(len(effects), 2, replace=False)
        pair = (effects[first], effects[second])
        yield Trial(f"pair {i + 1} {' '.join(pair)}", "pair", pair, i, "clear")
    for i in range(counts.unlisted):
        kind = others[i % len(others)]
        yield Trial(f"unlisted {kind} {i // len(others) + 1}", "unlisted", (kind,), i // len(others), "clear")
    for i in range(counts.seeds):
        size: SizeRule = "plausible" if i % 2 else "three limits"
        for effect in effects:  # places take turns within each rule of sizes
            yield Trial(f"single {effect} {i + 1}", "single", (effect,), i // 2, size)
    for i in range(counts.nulls):
        yield Trial(f"null {i + 1}", "null", number=i)
