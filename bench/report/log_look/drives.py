"""Lines of a proposed `log.yaml` for torques and currents, held against the robot where it is known."""

from collections.abc import Iterator, Mapping, Sequence

import numpy as np

from bench.identify.drive_scale import DriveScale, drive_scale
from bench.record.campaign import Array
from bench.record.look.families import Family
from bench.record.look.values import evenly
from bench.report.log_look.lines import Line, as_logged
from bench.robot.nominal_dynamics import NominalDynamics

EXPLAINED = 0.5  # share of a reading's variance, mean over drives, from which it is a torque or a current (assumed)
NEAR_ONE = 0.25  # relative: a factor this near to one is no gear ratio; payload and masses may be off so far (assumed)
UNTOLD = 0.3  # relative standard deviation of a factor that is no proposal (assumed: gears of one arm differ by less)


def drives(
    families: Sequence[Family],
    lines: Sequence[Line],
    time: Array,
    columns: Mapping[str, Array],
    nominal: NominalDynamics | None,
    remarks: list[str],
) -> list[Line]:
    """Return the lines of torques and currents; turned angles are remarked."""
    candidates = [f for f in families if f.kind in ("torque", "current", "unknown") and not f.is_command]
    places = {line.column: line for line in lines}
    if nominal is None:
        named = [family for family in candidates if family.kind != "unknown"]
        unknown = [family.shown for family in candidates if family.kind == "unknown"]
        if unknown:
            remarks.append(f"{', '.join(unknown)}: move with the robot; currents or torques? --robot DIR tells")
        if named:
            remarks.append("torques and currents are as logged: --robot DIR tells gear ratio, sign and delay")
        return [line for family in named for line in as_logged(family, columns)]
    angles = [
        next(
            (
                places[name]
                for name in (f"{q}_{j}_{u}" for q in ("q_motor", "q_cmd") for u in ("rad", "m"))
                if name in places
            ),
            None,
        )
        for j in range(1, nominal.n_joints + 1)
    ]
    found: list[Line] = []
    for family in candidates if all(angles) and len(angles) == nominal.n_joints else ():
        sources = {line.source: line for line in angles if line}
        clock, slow = evenly(time, {name: columns[name] for name in (*sources, *family.sources)})
        position = np.stack([line.factor * slow[name] for name, line in sources.items()], axis=1)[5:-5]
        reading = np.stack([slow[name] for name in family.sources], axis=1)[5:-5]
        if not np.all(np.ptp(reading, axis=0) > 0):
            continue
        scale = drive_scale(nominal, clock[5:-5], position, reading)
        if np.mean(scale.explained) < EXPLAINED:
            remarks.append(
                f"{family.shown}: the model explains {100 * np.mean(scale.explained):.0f} % of it; not taken"
            )
            continue
        found += _scaled(family, scale, nominal, remarks)
    return found


def _scaled(family: Family, scale: DriveScale, nominal: NominalDynamics, remarks: list[str]) -> Iterator[Line]:
    """Yield the lines of one family of readings that go by the torque that the arm needs."""
    names = nominal.bodies.names
    if np.any(scale.turned):
        who = ", ".join(name for name, turned in zip(names, scale.turned, strict=True) if turned)
        remarks.append(f"angles of {who} seem to count the other way round than the model: give them factor -1")
    remarks.append(
        f"{family.shown}: held against the masses of the robot with {scale.payload:.3g} kg of payload, with which "
        f"all drives agree best; they lag the angles by {1e3 * scale.delay:.1f} ms"
    )
    near = bool(np.all(np.abs(np.abs(scale.factor) - 1) < NEAR_ONE))
    if family.kind == "current":
        estimated = zip(names, scale.factor, scale.sigma, strict=True)
        constants = ", ".join(f"{name} {abs(k):.3g} +- {100 * s:.0f} %" for name, k, s in estimated)
        remarks.append(f"for figures.yaml, torque_constant_nm_per_a as estimated: {constants} (torque_constant_error)")
    elif not near:
        widest = float(np.max(scale.sigma[scale.sigma < UNTOLD], initial=0.01))
        remarks.append(
            f"factors of {family.shown} are estimates: write gear ratios or constants there where they are known, else "
            f"`gain_sigma: {widest:.2g}` under instruments: torque: of figures.yaml"
        )
    for number, source in zip(family.numbers, family.sources, strict=True):
        k = number - 1
        sign = float(np.sign(scale.factor[k]))
        unit = "nm" if nominal.bodies.is_hinge[k] else "n"
        told = f"{100 * scale.explained[k]:.0f} % explained"
        if family.kind == "current":
            yield Line(f"current_{number}_a", source, sign, 0.0, f"{told}; sign as the model has it")
        elif near:
            why = f"{told}; joint torque within {100 * abs(abs(scale.factor[k]) - 1):.0f} % of the model's"
            yield Line(f"tau_motor_{number}_{unit}", source, sign, 0.0, why)
        else:
            wide = scale.sigma[k] > UNTOLD
            remedy = ": not told by this log, write the gear ratio" if wide else ""
            why = f"{told}; +- {100 * scale.sigma[k]:.0f} %{remedy}"
            factor = float(f"{scale.factor[k]:.3g}")
            yield Line(f"tau_motor_{number}_{unit}", source, factor, 0.0, why, is_open=bool(wide))
