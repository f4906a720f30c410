"""What a campaign could not show, in sentences: the missing instruments with what each would show."""

from collections.abc import Iterator

from bench.diagnose.verdict import UndetectableEffect, Verdict
from bench.report.diagnosis.names import effect_at, effect_name, listed, motion_of, title_of
from bench.report.diagnosis.numbers import shown, unit_name

INSTRUMENTS = {
    "current": "motor currents or torques (current_i_a, tau_motor_i_nm; of a slide tau_motor_i_n)",
    "reflector": "a laser tracker (reflector_k_x_m, _y_m, _z_m)",
    "q_link": "link encoders (q_link_i_rad; of a slide q_link_i_m)",
    "force": "a force sensor (force_x_n, _y_n, _z_n)",
    "moment": "a moment sensor (moment_x_nm, _y_nm, _z_nm)",
    "gas_pressure": "a gauge of the gas (gas_pressure_pa)",
    "gear_temperature": "gear temperatures (gear_temperature_i_k)",
    "motor_temperature": "motor temperatures (motor_temperature_i_k)",
}
MOST = 10  # effects in a sentence; verdict.json has all


def not_looked_for(verdict: Verdict) -> dict[tuple[str, ...], list[str]]:
    """Return the channels that a campaign has not -> titles of the effects that were not looked for without them."""
    found: dict[tuple[str, ...], list[str]] = {}
    for effect, channels in verdict.missing.items():
        found.setdefault(tuple(channels), []).append(effect_name(effect))
    return found


def missing_sentences(verdict: Verdict) -> Iterator[str]:
    """Yield which instruments are missing, and what was not looked for without them."""
    for channels, effects in not_looked_for(verdict).items():
        yield f"Not looked for without {_instruments(channels)}: {', '.join(effects)}."


def without_balance(verdict: Verdict) -> list[str]:
    """Return the causes that were not looked for, as their model found no balance: "Stribeck effect (joint 1)"."""
    keys = (key.partition(" ") for key in verdict.not_simulated)  # effect, and place
    return [effect_at(effect, [place]) for effect, _, place in keys]


def blind_sentences(verdict: Verdict) -> Iterator[str]:
    """Yield what this campaign could not have shown even at the largest plausible size, and what would have."""
    unseen = [spot for spot in verdict.blind if not (spot.taken_by or _is_shown_by_motion(spot))]
    for kind in dict.fromkeys(kind for spot in unseen for kind in spot.shown_by):
        shown = [spot for spot in unseen if kind in spot.shown_by]
        yield f"Not to be seen here; these runs with {_instruments((kind,))} would show: {_named(shown)}."
    if other := [spot for spot in unseen if not spot.shown_by]:
        yield f"Not to be seen here; other joints, speeds, loads or hours may show: {_named(other)}."
    slow = [spot for spot in verdict.blind if _is_shown_by_motion(spot)]
    for motion in dict.fromkeys(motion_of(spot.effect) for spot in slow):
        there = [spot for spot in slow if motion_of(spot.effect) == motion]
        yield f"Not to be seen here; {motion} would show: {', '.join(map(_of_shapes, there))}."
    taken = [spot for spot in verdict.blind if spot.taken_by]
    if taken:
        figures = sorted({title_of(name)[0] for spot in taken for name in spot.taken_by})
        yield (
            "No findings of their own here, for fitted figures may be as far off and change the readings in the same "
            f"way: {_named(taken)}. What the figures came out as is in figures.csv ({listed(figures, 'and')})."
        )
    for kind in dict.fromkeys(kind for spot in taken for kind in spot.shown_by):
        told = [spot for spot in taken if kind in spot.shown_by]
        yield f"These runs with {_instruments((kind,))} would show more of: {_named(told)}."


def _is_shown_by_motion(spot: UndetectableEffect) -> bool:
    return bool(motion_of(spot.effect)) and not (spot.taken_by or spot.shown_by)


def _of_shapes(spot: UndetectableEffect) -> str:
    """Return "Stribeck effect (joint 2)", or "Stribeck effect (joint 1) of a speed below 0.02 m/s"."""
    if not spot.below:
        return effect_at(spot.effect, list(spot.places))
    said = []
    for place, value in zip(spot.places, spot.below, strict=True):
        (number,) = shown((value,), spot.unit, value / 10)
        below = f"of a {spot.shape.replace('_', ' ')} below {number} {unit_name(spot.unit)}"
        said.append(f"{effect_at(spot.effect, [place])} {below}")
    return ", ".join(said)


def _instruments(kinds: tuple[str, ...]) -> str:
    return listed([INSTRUMENTS.get(kind, kind.replace("_", " ")) for kind in kinds], "and")


def _named(spots: list[UndetectableEffect]) -> str:
    """Return "Coulomb level (joints 1, 3), loss of gas", each effect once."""
    places: dict[str, list[str]] = {}
    for spot in spots:
        places.setdefault(spot.effect, []).extend(spot.places)
    named = [effect_at(effect, some) for effect, some in places.items()]
    more = [f"{len(named) - MOST} more (blind in verdict.json)"] if len(named) > MOST else []
    return ", ".join([*named[:MOST], *more])
