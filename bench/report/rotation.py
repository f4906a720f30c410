"""The rotation experiment from scenario to report: C and l_c of the counterbalance, and the paper's claims beside ours."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.errors import InputError
from bench.identify.balancing_torque import BalancingTorque, Geometry, Priors, balancing_torques, nuisances
from bench.identify.counterbalance_check import Prediction, Spread, predict, spread
from bench.identify.counterbalance_fit import CounterbalanceFit, fit_counterbalance
from bench.identify.traverse_friction import FrictionOverSpeed, friction_over_speed
from bench.identify.traverses import traverses
from bench.report.campaigns import open_campaign
from bench.report.results import CAMPAIGN, TRUTH, write_session
from bench.report.scoring import ParameterScore, score_counterbalance
from bench.robot.bodies import Array
from bench.robot.compiled import rigid_bodies
from bench.robot.drives import drives_of
from bench.scenario.files import read_scenario
from bench.simulate.session import run_session

Progress = Callable[[float], None]

IDENTIFICATION, VALIDATION = "rotation", "rotation-validation"  # scenarios, and folders of their results
UNCERTAIN_MASSES = 0.01  # relative error of the first moment for which the report says what C would still be good for


@dataclass(frozen=True)
class RotationIdentification:
    """What one campaign of rotations says.

    Attributes:
        torques: M of each traverse.
        spread: The same at common angles.
        fit: C and l_c.
        with_uncertain_masses: The same, if the arm's first moment is known to `UNCERTAIN_MASSES` only.
        friction: Of the joint, over speed; None with one speed.
        stiffness: k_2^0, of the joint's elastic element [Nm/rad].
        stiffness_sigma: Its standard deviation [Nm/rad].
        limits: Shape (2,) [rad], of the joint.
    """

    torques: tuple[BalancingTorque, ...]
    spread: Spread
    fit: CounterbalanceFit
    with_uncertain_masses: CounterbalanceFit
    friction: FrictionOverSpeed
    stiffness: float
    stiffness_sigma: float
    limits: Array


@dataclass(frozen=True)
class RotationReport:
    """The rotation experiment and its validation.

    Attributes:
        identified: From the scenario "rotation".
        predictions: Of the traverses of "rotation-validation", by what was identified.
        scores: C and l_c beside the truth.
    """

    identified: RotationIdentification
    predictions: tuple[Prediction, ...]
    scores: tuple[ParameterScore, ...]


def run_rotation(folder: Path, progress: Progress = lambda share: None) -> RotationReport:
    """Run both scenarios, identify the counterbalance from the first, predict the second, and write what came out.

    Args:
        folder: Existing folder; gets a folder for each scenario, "rotation.json" and the figures.
        progress: Called with the share that is done.
    """
    from bench.report.rotation_results import write_rotation

    for i, name in enumerate((IDENTIFICATION, VALIDATION)):
        session = run_session(read_scenario(name), lambda share, i=i: progress((i + share) / 2))  # type: ignore[misc]
        (folder / name).mkdir()
        write_session(session, folder / name)
    identified = identify_rotation(folder / IDENTIFICATION / CAMPAIGN)
    predictions = predict(identified.fit, torques_of(folder / VALIDATION / CAMPAIGN))
    report = RotationReport(identified, predictions, score_counterbalance(identified.fit, folder / IDENTIFICATION / TRUTH))
    write_rotation(report, folder)
    return report


