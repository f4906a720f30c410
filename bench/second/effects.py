"""What can be hidden in the second plant, by the names and values of the catalogue; each is a change of its figures.

A change takes figures, the index or name of the place and the values, and returns other figures.
"""

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from bench.errors import InputError, unknown_name
from bench.second.figures import ROOM_K, Array, Figures, Friction, Lump
from bench.second.readout import Channel

GAUGE, FORCE_SENSOR = "gauge", "force sensor"  # channels that no drive has

Values = Mapping[str, float]
Change = Callable[[Figures, int | str, Values], Figures]


def changed(figures: Figures, name: str, place: int | str, values: Values) -> Figures:
    """Return figures in which an effect acts.

    Args:
        figures: Before.
        name: Of the effect.
        place: Index of the drive or name of the body; it does not matter for effects of the whole robot.
        values: Of its parameters, all of them.

    Raises:
        InputError: This plant does not know the effect.
    """
    if name not in CHANGES:
        raise InputError(unknown_name("effect of the second plant", name, CHANGES))
    return CHANGES[name](figures, place, values)


def _with(values: Array, j: int | str, change: Callable[[float], float]) -> Array:
    assert isinstance(j, int)
    new = values.copy()
    new[j] = change(float(values[j]))
    return new


def _rubs(name: str, parameter: str, sides: tuple[str, ...] = ("motor", "link"), scales: bool = False) -> Change:
    """Return the change of one attribute of friction: to the parameter's value, or by it."""

    def change(figures: Figures, place: int | str, values: Values) -> Figures:
        x = values[parameter]
        sided: dict[str, Any] = {}
        for side in sides:
            friction: Friction = getattr(figures, side)
            new: dict[str, Any] = {name: _with(getattr(friction, name), place, lambda v: v * (1 + x) if scales else x)}
            sided[side] = replace(friction, **new)
        return replace(figures, **sided)

    return change


def _in_turn(*changes: Change) -> Change:
    def change(figures: Figures, place: int | str, values: Values) -> Figures:
        for one in changes:
            figures = one(figures, place, values)
        return figures

    return change


def _gas(change: Callable[[Figures, Values], dict[str, Any]]) -> Change:
    def changed(figures: Figures, place: int | str, values: Values) -> Figures:
        assert figures.gas
        return replace(figures, gas=replace(figures.gas, **change(figures, values)))

    return changed


def _gas_amount(figures: Figures, values: Values) -> dict[str, Any]:
    assert figures.gas
    return {"amount": figures.gas.amount * (1 - values["lost"])}


def _warmer_gas(figures: Figures, values: Values) -> dict[str, Any]:
    assert figures.gas
    return {"amount": figures.gas.amount * (1 + values["offset"] / ROOM_K)}


def _viscous(figures: Figures, place: int | str, values: Values) -> Figures:
    return replace(figures, viscous=_with(figures.viscous, place, lambda v: v * (1 + values["change"])))


def _rotor_inertia(figures: Figures, place: int | str, values: Values) -> Figures:
    return replace(figures, rotor_inertia=_with(figures.rotor_inertia, place, lambda v: v * (1 + values["change"])))


def _compliance(figures: Figures, place: int | str, values: Values) -> Figures:
    stiffness = _with(figures.springs.stiffness, place, lambda k: k / (1 + values["change"]))
    return replace(figures, springs=replace(figures.springs, stiffness=stiffness))


def _softening(figures: Figures, place: int | str, values: Values) -> Figures:
    assert isinstance(place, int)
    springs, knee = figures.springs, values["knee"] * float(figures.torque_limit[place])
    softness = _with(springs.softness, place, lambda _: values["softness"])
    return replace(
        figures, springs=replace(springs, softness=softness, knee=_with(springs.knee, place, lambda _: knee))
    )


def _backlash(figures: Figures, place: int | str, values: Values) -> Figures:
    gap = _with(figures.springs.gap, place, lambda _: values["gap"])
    return replace(figures, springs=replace(figures.springs, gap=gap))


def _base(figures: Figures, place: int | str, values: Values) -> Figures:
    return replace(figures, base_compliance=values["compliance"])


def _payload_mass(figures: Figures, place: int | str, values: Values) -> Figures:
    return replace(figures, payload_change=(1 + figures.payload_change) * (1 + values["change"]) - 1)


def _payload_com(figures: Figures, place: int | str, values: Values) -> Figures:
    return replace(figures, payload_com=_xyz(values))


def _unstated_payload(figures: Figures, place: int | str, values: Values) -> Figures:
    mass, load = values["mass"], figures.load
    moment, second = _xyz(values, "moment_"), _xyz(values, "second_moment_")
    if mass == 0:
        return figures
    centre = load.position + load.axes @ moment / mass
    inertia = (load.axes * (second.sum() - second)) @ load.axes.T
    lump = Lump("unstated payload", load.joint, mass, centre, inertia, load.axes)
    return replace(figures, lumps=(*figures.lumps, lump))


def _lump(change: Callable[[Figures, Lump, Values], Lump]) -> Change:
    def changed(figures: Figures, place: int | str, values: Values) -> Figures:
        lumps = tuple(change(figures, lump, values) if lump.name == place else lump for lump in figures.lumps)
        return replace(figures, lumps=lumps)

    return changed


def _heavier(figures: Figures, lump: Lump, values: Values) -> Lump:
    factor = 1 + values["change"]
    return replace(lump, mass=factor * lump.mass, inertia=factor * lump.inertia)


def _moved(figures: Figures, lump: Lump, values: Values) -> Lump:
    return replace(lump, com=lump.com + lump.axes @ _xyz(values))


def _readout(name: str, parameter: str) -> Change:
    def change(figures: Figures, place: int | str, values: Values) -> Figures:
        new: dict[str, Any] = {name: _with(getattr(figures.readout, name), place, lambda _: values[parameter])}
        return replace(figures, readout=replace(figures.readout, **new))

    return change


def _frame(figures: Figures, place: int | str, values: Values) -> Figures:
    return replace(figures, readout=replace(figures.readout, shift=_xyz(values, "t"), turn=_xyz(values, "r")))


def _of_readout(name: str, value: Callable[[Values], Any]) -> Change:
    """Return the change by which what is one for the whole robot grows."""

    def change(figures: Figures, place: int | str, values: Values) -> Figures:
        new: dict[str, Any] = {name: getattr(figures.readout, name) + value(values)}
        return replace(figures, readout=replace(figures.readout, **new))

    return change


def _channel(name: str, parameter: str) -> Change:
    """Return the change of what a current, the gauge or the force sensor shows; of that one there is but a scale."""

    def change(figures: Figures, place: int | str, values: Values) -> Figures:
        out, x = figures.readout, values[parameter]
        if place == FORCE_SENSOR:
            out = replace(out, force_gain=(1 + out.force_gain) * (1 + x) - 1)
        elif place == GAUGE:
            out = replace(out, gauge=_shifted(out.gauge, name, lambda now: now + x))
        else:
            out = replace(out, currents=_shifted(out.currents, name, lambda now: _with(now, place, lambda v: v + x)))
        return replace(figures, readout=out)

    return change


def _shifted(channel: Channel, name: str, change: Callable[[Any], Any]) -> Channel:
    new: dict[str, Any] = {name: change(getattr(channel, name))}
    return replace(channel, **new)


def _dent(figures: Figures, place: int | str, values: Values) -> Figures:
    assert isinstance(place, int)
    return replace(figures, dents=(*figures.dents, (place, values["torque"], values["angle"], values["width"])))


def _xyz(values: Values, prefix: str = "") -> Array:
    return np.array([values[prefix + axis] for axis in "xyz"])


CHANGES: Mapping[str, Change] = {
    "gas_loss": _gas(_gas_amount),
    "polytropic_exponent": _gas(lambda _, values: {"exponent": values["exponent"]}),
    "seal_friction": _gas(lambda _, values: {"seal": values["share"]}),
    "gas_temperature": _gas(_warmer_gas),
    "gas_leak": _gas(lambda _, values: {"leak": values["rate"]}),
    "coulomb_level": _rubs("level", "change", scales=True),
    "viscous_level": _viscous,
    "stribeck": _in_turn(_rubs("rise", "rise"), _rubs("speed", "speed")),
    "load_friction": _rubs("by_load", "coefficient", ("motor",)),
    "direction_friction": _rubs("asymmetry", "asymmetry"),
    "friction_ripple": _in_turn(_rubs("sin", "sin"), _rubs("cos", "cos"), _rubs("period", "period")),
    "joint_compliance": _compliance,
    "softening": _softening,
    "backlash": _backlash,
    "base_compliance": _base,
    "payload_mass": _payload_mass,
    "payload_com": _payload_com,
    "unstated_payload": _unstated_payload,
    "link_mass": _lump(_heavier),
    "link_com": _lump(_moved),
    "rotor_inertia": _rotor_inertia,
    "joint_zero": _readout("zero", "offset"),
    "current_offset": _channel("offset", "offset"),
    "torque_constant": _readout("torque_constant", "change"),
    "encoder_delay": _of_readout("delay", lambda values: values["delay"]),
    "tracker_frame": _frame,
    "tracker_drift": _of_readout("creep", _xyz),
    "tracker_scale": _of_readout("scale", lambda values: values["scale"]),
    "force_gain": _of_readout("force_gain", lambda values: values["gain"]),
    "force_tilt": _of_readout("force_tilt", _xyz),
    "tracker_creep": _in_turn(
        _of_readout("creep", _xyz), _of_readout("leaning", lambda values: _xyz(values, prefix="r"))
    ),
    "channel_scale": _channel("scale", "scale"),
    "channel_offset": _channel("offset", "offset"),
    "channel_drift": _channel("drift", "rate"),
    # in no catalogue, for verdicts of "unlisted"
    "detent": _dent,
    "current_dead_band": _readout("dead_band", "width"),
    "angle_load_friction": _in_turn(_rubs("mixed", "coefficient", ("motor",)), _rubs("period", "period", ("motor",))),
}
