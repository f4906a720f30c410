"""Robots, campaigns and fits for tests of what is handed over."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import yaml

from bench.diagnose.extend.fit import Fit, unknowns_of
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.diagnose.replay.world import NOMINAL
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Effect, Place
from bench.effects.learned import values_of
from bench.effects.learned_readings import OF_READING, LearnedScale
from bench.hide.campaign import hide_campaign
from bench.report.handover.robot_folder import TOLERANCES
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import load_robot
from tests.simulate.loading_small import small_loading
from tests.simulate.rotation_small import small_rotation
from tests.small_robot import FIGURES, write_small_robot

PAYLOADS_KG = (0.0, 6.0)  # of the segments in turn
WARM_K = 25.0
FAR = 100.0  # times as much as folder and fit may differ, by which each of the two differs from the nominal robot
SECOND = Place("joint", 1, "hinge_b")
Values = Mapping[str, float]


@dataclass(frozen=True)
class Case:
    """What acts beside deviations of all figures."""

    causes: tuple[tuple[Effect, Place, Values], ...]
    beside: tuple[str, ...] = ()  # effects that no MJCF holds


EFFECTS = catalogue()
TORQUE_CONSTANT = (EFFECTS["torque_constant"], SECOND, {"change": 0.08})
SCALE = LearnedScale(values_of(OF_READING[:3], OF_READING[:3], "A", 1.0), "current", 30.0)
CASES = {
    "figures alone": Case(()),
    "friction": Case(((EFFECTS["coulomb_level"], SECOND, {"change": 0.4}),)),
    "a joint more": Case(((EFFECTS["base_compliance"], WHOLE, {}),)),
    "play": Case(((EFFECTS["backlash"], SECOND, {"gap": 4e-4}),)),
    "torque constant": Case((TORQUE_CONSTANT,)),
    "torque constant and saturation": Case(
        (TORQUE_CONSTANT, (EFFECTS["torque_saturation"], SECOND, {"curvature": 2e-4})),
        ("torque_constant", "torque_saturation"),
    ),
    "current offset": Case((TORQUE_CONSTANT, (EFFECTS["current_offset"], SECOND, {"offset": 0.4}))),
    "current offset and saturation": Case(
        ((EFFECTS["current_offset"], SECOND, {"offset": 0.4}), (EFFECTS["torque_saturation"], SECOND, {})),
        ("current_offset", "torque_saturation"),
    ),
    "encoder delay": Case(((EFFECTS["encoder_delay"], WHOLE, {"delay": 3e-3}),), ("encoder_delay",)),
    "learned reading": Case(
        ((SCALE, SECOND, {"square": 0.5, "cube": -0.3, "signed_square": 0.8}),), ("learned_scale",)
    ),
    "unstated payload": Case(
        (
            (
                EFFECTS["unstated_payload"],
                WHOLE,
                {"mass": 4.0, "second_moment_x": 0.1, "moment_x": 0.2, "moment_z": -0.4},
            ),
        )
    ),
    "payload that is heavier": Case(((EFFECTS["payload_mass"], WHOLE, {"change": 0.1}),), ("payload_mass",)),
    "payload beside its place": Case(((EFFECTS["payload_com"], WHOLE, {"x": 0.02, "z": 0.03}),), ("payload_com",)),
    "warm friction": Case(((EFFECTS["friction_temperature"], SECOND, {"decrease": 0.02}),), ("friction_temperature",)),
}


def torque_robot(folder: Path) -> Path:
    """Write the two-joint robot with drives that report torque instead of current, and a secondary encoder."""
    write_small_robot(folder)
    instruments = FIGURES["instruments"] | {
        "current": None,
        "torque": {"sigma_nm": 1.0, "offset_sigma_nm": 2.0},
        "link_encoder": {"joints": ["hinge_b"], "offset_sigma_rad": 1e-4},
    }
    (folder / "figures.yaml").write_text(yaml.safe_dump(FIGURES | {"instruments": instruments}))
    return folder


def design_for(compiled: CompiledRobot) -> LinearisedModel:
    """Return a campaign with motion, rests under load, payloads, and drives that warm up."""
    robot = compiled.robot
    campaign = hide_campaign(robot, small_rotation(robot.folder), [], np.random.default_rng(1)).campaign
    loads = hide_campaign(robot, small_loading(robot.folder), [], np.random.default_rng(2)).campaign
    campaign = replace(campaign, runs=(*campaign.runs[:1], *loads.runs))
    quantities = quantities_of(campaign.runs, compiled)
    segments = []
    for i, segment in enumerate(segments_of(campaign, compiled, quantities, 60)):
        warm = segment.conditions.gear_k + WARM_K * (i % 3)
        conditions = replace(segment.conditions, payload_kg=PAYLOADS_KG[i % 2], gear_k=warm)
        segments.append(replace(segment, conditions=conditions))
    return linearised_model_of(Replay(compiled, tuple(segments), quantities), nuisances_of(compiled, quantities))


def fit_of(linear: LinearisedModel, case: Case, rng: np.random.Generator) -> Fit:
    """Return a fit in which every figure is off, as nobody would fit it."""
    causes, values = [], []
    for effect, place, given in case.causes:
        sizes = tuple(p for p in effect.parameters if not p.is_shape)
        shapes = tuple(p for p in effect.parameters if p.is_shape)
        causes.append(Cause(effect, place, sizes, shapes))
        values += [given.get(p.name, p.null if given else p.typical) for p in (*sizes, *shapes)]
    unknowns = unknowns_of(tuple(causes))
    k, nuisances = len(unknowns), rng.standard_normal(len(linear.nuisances))
    residual = np.zeros(linear.replay.shape)
    jacobian = np.zeros((*residual.shape, k))
    return Fit(
        tuple(causes),
        unknowns,
        np.array(values),
        np.eye(k),
        nuisances,
        0.0,
        0.0,
        residual,
        jacobian,
        linear.scatter.play,
    )


def predictions(linear: LinearisedModel, fit: Fit, folder: Path) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return what the fit predicts, the folder, and the nominal robot, in units of each channel's largest reading."""
    compiled, campaign = linear.replay.compiled, (linear.segments, linear.quantities)
    nominal = Replay(compiled, *campaign, TOLERANCES[0])
    handed = Replay(compile_robot(load_robot(folder)), *campaign, TOLERANCES[0])
    fitted = nominal.predict(fit.world(linear))
    scale = np.nanmax(np.fmax(np.abs(fitted), np.concatenate([s.sigma for s in linear.segments])), axis=0)
    return fitted / scale, handed.predict(NOMINAL) / scale, nominal.predict(NOMINAL) / scale
