"""What a person asks to hide, in words: `coulomb_level@2=0.2`."""

import re
from collections.abc import Iterable, Mapping, Sequence
from math import inf, isfinite, nan

from bench.effects.effect import Acting, Effect, Place
from bench.effects.recorded import NOTHING_RECORDED, Recorded
from bench.errors import InputError, unknown_name
from bench.robot.compiled import CompiledRobot

WORDS = re.compile(r"(?P<name>[^@:=]+)(@(?P<place>[^:=]+))?(:(?P<parameter>[^=]+))?(=(?P<value>.+))?")
GRAMMAR = (
    "write NAME, NAME=VALUE, NAME:PARAMETER=VALUE, and NAME@PLACE for one joint, body, channel or run; "
    "NAME@PLACE@RUN or NAME@RUN for what sets in with a run"
)


def effects_of(
    words: Iterable[str],
    compiled: CompiledRobot,
    catalogue: Mapping[str, Effect],
    joint: int | None = None,
    recorded: Recorded = NOTHING_RECORDED,
) -> tuple[Acting, ...]:
    """Return the effects that some words ask for.

    Each is `NAME[@PLACE][:PARAMETER][=VALUE]`. Without a parameter the first is meant, without a value its typical one.
    The same effect at the same place may be named again for another parameter.

    Args:
        words: What is asked for.
        compiled: The nominal robot.
        catalogue: Name -> effect.
        joint: Number of the joint, from 1, for effects that act on a joint and are named without a place.
        recorded: Runs and columns of the session; without them errors of the recording have no place.

    Raises:
        InputError: Unknown names, values that are no number, a parameter that is given twice, an effect that has no
            place on this robot, or several and none was named; every fault is listed.
    """
    problems: list[str] = []
    found: dict[tuple[str, Place], dict[str, float]] = {}
    for word in words:
        try:
            effect, place, parameter, value = _one(word, compiled, catalogue, joint, recorded)
        except InputError as error:
            problems += error.problems
            continue
        values = found.setdefault((effect.name, place), {})
        if parameter in values:
            where = f" at {place}" if len(effect.places_in(compiled, recorded)) > 1 else ""
            problems.append(
                f"{word!r}: {parameter} of effect {effect.name!r}{where} is given twice; name it once, with one value."
            )
        values[parameter] = value
    if problems:
        raise InputError(problems)
    return tuple(
        Acting(catalogue[name], place, catalogue[name].complete(values)) for (name, place), values in found.items()
    )


def _one(
    word: str, compiled: CompiledRobot, catalogue: Mapping[str, Effect], joint: int | None, recorded: Recorded
) -> tuple[Effect, Place, str, float]:
    match = WORDS.fullmatch(word)
    if match is None:
        raise InputError(f"{word!r}: {GRAMMAR}.")
    name = match["name"]
    if name not in catalogue:
        raise InputError(unknown_name("effect", name, catalogue))
    effect = catalogue[name]
    chosen = match["parameter"] or effect.parameters[0].name
    known = [parameter.name for parameter in effect.parameters]
    if chosen not in known:
        raise InputError(f"effect {name!r}: {unknown_name('parameter', chosen, known)}")
    place = _place(effect, match["place"], effect.places_in(compiled, recorded), joint)
    parameter = effect.parameters_at(compiled, place)[known.index(chosen)]
    share = "" if parameter.unit else "; a share of 2 % is written 0.02"
    try:
        value = parameter.typical if match["value"] is None else float(match["value"])
    except ValueError:
        value = nan
    if not isfinite(value):
        remedy = share.removeprefix("; ") if str(match["value"]).rstrip().endswith("%") and share else GRAMMAR
        raise InputError(f"{word!r}: {match['value']!r} is not a number; {remedy}.")
    least, most = parameter.least, parameter.most
    if not least <= value <= most:
        allowed = f"at least {least:g}" if most == inf else f"between {least:g} and {most:g}"
        allowed = f"at most {most:g}" if least == -inf else allowed
        raise InputError(f"{word!r}: {chosen} is {allowed}; beyond it means nothing{share}.")
    return effect, place, chosen, value


def _place(effect: Effect, asked: str | None, places: Sequence[Place], joint: int | None) -> Place:
    if not places:
        raise InputError(f"effect {effect.name!r}: there is no place for it on this robot in this session.")
    known: dict[str, Place] = {}
    for place in places:
        since = f"@{place.since}" if place.since else ""
        known |= {place.name + since: place} if place.name else {place.since: place} if place.since else {}
        known |= {f"{place.index + 1}{since}": place} if place.kind == "joint" else {}
    if asked is None and joint is not None and any(place.kind == "joint" for place in places):
        asked = str(joint)
    if asked is not None:
        if asked not in known:
            raise InputError(f"effect {effect.name!r}: {unknown_name('place', asked, known)}")
        return known[asked]
    if len(places) > 1:
        raise InputError(
            f"effect {effect.name!r}: acts at {', '.join(map(str, places))}; say where with @ or --joint, such as "
            f"{effect.name}@{next(iter(known))}."
        )
    return places[0]
