"""A first pass as plain data for JSON; units stand in the keys or beside the values, what is undefined is null."""

import numpy as np

from bench.identify.dynamics.advice import sentence
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.regressor import N_INERTIAL, NAMES
from bench.report.dynamics.identify import Dynamics
from bench.report.dynamics.notes import notes_of
from bench.report.dynamics.words import MODELS
from bench.report.jsonable import to_jsonable

AXES = (
    "Moments and inertias of a link, mx to Izz, are about the origin of its joint's frame, along the axes of its body "
    "in the MJCF. Those of a payload are about the load point, along the axes of the body that carries it, whichever "
    "way the frame of the load point is turned; so are payload mx, my and mz in sums of base parameters."
)


def as_json(result: Dynamics, level: float) -> dict[str, object]:
    """Return a first pass as plain data."""
    found = result.found
    quantile = found.quantile(level)
    return {
        "method": "dynamics",
        "campaigns": [str(folder) for folder in result.campaigns],
        "joints": list(found.joints),
        "cutoff_hz": to_jsonable(found.band.cutoff_hz),
        "bandwidth_hz": to_jsonable(found.band.bandwidth_hz),
        "delay_s": to_jsonable(found.solution.delay),
        "delay_sigma_s": to_jsonable(found.solution.delay_sigma),
        "delay_not_taken": _not_taken(found, quantile),
        "interval_level": level,
        "quantities": [
            {
                "kind": one.kind,
                "name": one.name,
                "unit": one.unit,
                "nominal": to_jsonable(one.nominal),
                "value": to_jsonable(one.value),
                "sigma": to_jsonable(one.sigma),
                "interval": to_jsonable(one.interval(quantile)),
                "told_by_these_data": one.told,
                "together_with": " ".join(one.meaning),
            }
            for one in result.quantities
        ],
        "axes": AXES,
        "gravity_m_per_s2": to_jsonable(found.gravity),
        "links": _links(found),
        "compliance_rad_per_nm": None if found.compliance is None else to_jsonable(found.compliance),
        "held_out_by": found.folds.by,
        "held_out": list(found.folds.names),
        "held_out_rms_nm": {model: to_jsonable(found.held_out.rms(model)) for model in MODELS},
        "predicted_rms_nm": {
            str(folder): {model: to_jsonable(torques.rms(model)) for model in MODELS}
            for folder, torques in result.predicted.items()
        },
        "not_physical_before_constraints": list(found.bodies.broken(found.solution.parameters)),
        "advice": [sentence(motion, found) for motion in result.motions],
        "notes": list(notes_of(found, result.quantities, result.predicted)),
    }


def _not_taken(found: FirstPass, quantile: float) -> dict[str, object] | None:
    """Return the delay of a fit with one, where that predicts no better and is not taken; null elsewhere."""
    if found.solution.not_taken is None:
        return None
    delay, sigma = found.solution.not_taken
    half = quantile * sigma
    return {"delay_s": to_jsonable(delay), "interval_s": [to_jsonable(delay - half), to_jsonable(delay + half)]}


def _links(found: FirstPass) -> list[dict[str, object]]:
    """Return the inertial parameters of each link in its joint's frame, nominal and found; and its rotor's inertia."""
    layout = found.layout
    own, nominal = (
        values[layout.links].reshape(layout.n, N_INERTIAL) for values in (found.parameters, found.prior.mean)
    )
    rotors = np.arange(layout.size)[layout.of_drives("rotor")]
    return [
        {
            "joint": joint,
            "nominal": dict(zip(NAMES, map(to_jsonable, nominal[i]), strict=True)),
            "found": dict(zip(NAMES, map(to_jsonable, own[i]), strict=True)),
            "rotor_kg_m2": to_jsonable(found.parameters[rotors[i]]),
        }
        for i, joint in enumerate(found.joints)
    ]
