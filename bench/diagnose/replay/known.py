"""What the lab knows besides the tables, as readings: a rest at which nothing is read but that.

A known value is one more measured row with a column of its own. What a world says of it follows from its robot
(payload, stiffness) or from where the arm rests (gas), so it acts in signatures, in the search, in fits and in what is
held out. No error of an instrument that the campaign logs is in it.
"""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np

from bench.diagnose.replay.nuisances import Nuisance
from bench.diagnose.replay.quantities import Quantity
from bench.diagnose.replay.segments import Segment, conditions_of
from bench.diagnose.replay.static_segments import visits_of
from bench.errors import CampaignError
from bench.record.campaign import Array, Campaign, Run
from bench.record.known import PAYLOAD, Known
from bench.record.manifest import MANIFEST
from bench.record.rules.scale import BESIDE
from bench.robot.compiled import CompiledRobot

# to Nm/rad, or N/m of a slide: what data sheets have
STIFFNESS_UNITS = {"Nm/arcmin": 180 * 60 / np.pi, "kNm/rad or kN/m": 1e3, "MNm/rad or kN/mm": 1e6}
PER_DEGREE = 180 / np.pi  # exact: from Nm/deg to Nm/rad
CLOSE = 2.0  # declared: times; what is 29 to 115 times softer than the model is that by its unit, and not by its gear
FAR = 100.0  # derived: times; joints of one size differ by less, and the smallest of these factors is ten times that
STIFFER = 1e4  # derived: times; two orders above `FAR`, for the model's figure may be that of a soft one
KINDS = {
    "payload_kg": "known_payload",
    "stiffness_nm_per_rad": "known_stiffness",
    "gas_pressure_pa": "known_gas_pressure",
    "gas_temperature_k": "known_gas_temperature",
}
# declared: Times the error of a reading, the prior of what it reads: the estimate then keeps 1 / (1 + FLAT^2) of the
# prior, and derivatives are taken over no more than that, for friction and play of a robot with a much heavier
# payload are others.
FLAT = 10.0
OF_GAS = ("gas_pressure_pa", "gas_temperature_k")


def known_quantities(campaign: Campaign, compiled: CompiledRobot) -> tuple[Quantity, ...]:
    """Return a column for each thing that the lab knows besides.

    Raises:
        CampaignError: The robot has no such joint, cylinder or gauge; every fault is listed.
    """
    if faults := known_faults(campaign, compiled):
        raise CampaignError(f"{MANIFEST}: {key}: {words}" for key, words in faults)
    return tuple(dict.fromkeys(_quantity_of(one, compiled) for one in campaign.known))


def known_faults(campaign: Campaign, compiled: CompiledRobot) -> list[tuple[str, str]]:
    """Return key and fault of all that is known besides and that the robot cannot have."""
    return [
        (f"known[{i}].{key}", words) for i, one in enumerate(campaign.known) for key, words in _faults(one, compiled)
    ]


def with_known_segments(
    segments: Sequence[Segment], campaign: Campaign, compiled: CompiledRobot, quantities: Sequence[Quantity]
) -> tuple[Segment, ...]:
    """Return segments with a rest for each thing that the lab knows besides.

    It belongs to the last run of its recording, so that it is never held out alone.

    Args:
        segments: Of the campaign.
        campaign: It.
        compiled: Its robot.
        quantities: With those of `known_quantities`.
    """
    found = list(segments)
    replayed = {segment.run for segment in segments}
    for i, one in enumerate(campaign.known):
        mine = [r for r in campaign.runs if r.name in replayed and one.recording in ("", r.recording)]
        if not mine:
            continue
        rest = _rest(one, mine[-1], f"known {i + 1}", compiled, quantities)
        last = max(j for j, segment in enumerate(found) if segment.run == mine[-1].name)
        found.insert(last + 1, rest)
    return tuple(found)


def with_known_payload(nuisances: Iterable[Nuisance], campaign: Campaign) -> tuple[Nuisance, ...]:
    """Return figures among which a payload that is known by a reading is known by nothing but that reading.

    Else it would be stated within what weights that are written down may be off.
    """
    widths: dict[str, float] = {}
    for one in campaign.known:
        if one.quantity == PAYLOAD and one.value:
            widths[one.recording] = max(widths.get(one.recording, 0.0), FLAT * one.sigma / one.value)
    found = []
    for nuisance in nuisances:
        # of the only recording, whatever its name
        wide = max(widths.values(), default=0.0) if nuisance.recording is None else widths.get(nuisance.recording, 0.0)
        found.append(replace(nuisance, sigma=max(nuisance.sigma, wide)) if nuisance.scales_payload else nuisance)
    return tuple(found)


def known_value(quantity: Quantity, compiled: CompiledRobot, gas_force: Array, gas_temperature: Array) -> Array:
    """Return what is known besides as it is in a world, shape (T,).

    Args:
        quantity: What.
        compiled: The robot of the world.
        gas_force: Shape (T,) [N], of the cylinder.
        gas_temperature: Shape (T,) [K], true.
    """
    match quantity.kind:
        case "known_payload":
            return np.full(len(gas_force), carried_mass(compiled))
        case "known_stiffness":
            return np.full(len(gas_force), float(compiled.stiffness[quantity.index]))
        case "known_gas_pressure":
            gauge = compiled.robot.figures.instruments.pressure
            assert gauge
            return gas_force / gauge.piston_area_m2
    return gas_temperature


def carried_mass(compiled: CompiledRobot) -> float:
    """Return the mass at the load point of a robot [kg]: the load body with everything on it."""
    model = compiled.model
    load = model.body(compiled.robot.figures.load_body).id
    on_it = {load}
    for body in range(load + 1, model.nbody):  # MuJoCo numbers children after their parents
        if int(model.body_parentid[body]) in on_it:
            on_it.add(body)
    return float(sum(model.body_mass[body] for body in on_it))


def _quantity_of(one: Known, compiled: CompiledRobot) -> Quantity:
    kind = KINDS[one.quantity]
    if one.joint:
        unit = "N/m" if compiled.is_slide[one.joint - 1] else "Nm/rad"
        return Quantity(f"{kind}_{one.joint}_{unit.lower().replace('/', '-per-')}", kind, unit, one.joint - 1)
    unit = {"payload_kg": "kg", "gas_pressure_pa": "Pa", "gas_temperature_k": "K"}[one.quantity]
    return Quantity(f"{kind}_{unit.lower()}", kind, unit)


def _faults(one: Known, compiled: CompiledRobot) -> Iterator[tuple[str, str]]:
    n, name = compiled.n_joints, compiled.robot.name
    if one.joint > n:
        yield "joint", f"{name} has {n} joints, not {one.joint}"
    elif one.joint and one.value > 0:
        yield from _another_unit(
            one.value, float(compiled.stiffness[one.joint - 1]), bool(compiled.is_slide[one.joint - 1])
        )
    if one.at and len(one.at) != n:
        yield "at", f"needs a position for each of the {n} joints of {name}, not {len(one.at)}"
    limited = compiled.model.jnt_limited[compiled.at.joint]
    for number, (q, (low, high)) in enumerate(zip(one.at, compiled.limits, strict=False), start=1):
        if limited[number - 1] and not low - BESIDE["rad"] <= q <= high + BESIDE["rad"]:
            yield "at", f"joint {number} of {name} goes from {low:.4g} to {high:.4g} [rad, m], not to {q:g}"
    if one.quantity in OF_GAS and compiled.counterbalance is None:
        yield "quantity", f"{name} has no counterbalance with gas in it"
    elif one.quantity == "gas_pressure_pa" and compiled.robot.figures.instruments.pressure is None:
        yield "quantity", f"figures.yaml of {name} has no instruments.pressure.piston_area_m2"


def _another_unit(value: float, nominal: float, is_slide: bool) -> Iterator[tuple[str, str]]:
    """Yield a fault where a stiffness is far from the model's and another unit brings it near."""
    in_degrees = value * PER_DEGREE / nominal
    if not is_slide and 1 / CLOSE < in_degrees < CLOSE:
        words = f"{value:g} is {nominal / value:.3g} times softer than the model's joint"
        yield "value", f"{words}: Nm/deg? multiply by {PER_DEGREE:.6g}"
        return
    off = {unit: abs(np.log(factor * value / nominal)) for unit, factor in STIFFNESS_UNITS.items()}
    unit = min(off, key=lambda name: off[name])
    if value * FAR < nominal and off[unit] < np.log(FAR) / 2:
        words = f"{value:g} is {nominal / value:.3g} times softer than the model's joint"
        yield "value", f"{words}: {unit}? multiply by {STIFFNESS_UNITS[unit]:.6g}"
    if value > STIFFER * nominal:
        yield "value", f"{value:g} is {value / nominal:.3g} times stiffer than the model's joint: look at its unit"


def _rest(one: Known, run: Run, label: str, compiled: CompiledRobot, quantities: Sequence[Quantity]) -> Segment:
    """Return an instant at which the arm stands and one thing is read; no visit, for friction at rest is not in it."""
    angles = [name for i in range(compiled.n_joints) for name in _angles_of(run, i + 1)]
    positions = one.at or tuple(float(run.columns[name][-1]) for name in angles)
    columns = {name.replace("q_motor", "q_cmd"): np.array([x]) for name, x in zip(angles, positions, strict=True)}
    still = Run(run.name, "static", run.start_s, {**columns, "pose": np.ones(1), "load_step": np.zeros(1)})
    (visit,) = visits_of(still, compiled)
    mine = np.array([quantity == _quantity_of(one, compiled) for quantity in quantities])
    n = compiled.n_joints
    return Segment(
        run=run.name,
        label=label,
        is_static=False,
        motion=visit.motion,
        conditions=conditions_of(run, np.arange(len(run)), n),
        observed=np.where(mine, one.value, np.nan)[None],
        sigma=np.where(mine, one.sigma, np.nan)[None],
        standing=np.ones(n, dtype=bool),
        acceleration_error=np.zeros((1, n)),
        rings=np.zeros(1, dtype=bool),
        recording=run.recording,
        is_known=True,
    )


def _angles_of(run: Run, number: int) -> list[str]:
    """Return the column that says where a drive was; encoders come before commands."""
    names = [f"{quantity}_{number}_{unit}" for quantity in ("q_motor", "q_cmd") for unit in ("rad", "m")]
    return [name for name in names if name in run.columns][:1]
