"""The folder of a diagnosis as far as other commands read it, without a search: a loss of gas, fitted."""

from pathlib import Path

import numpy as np

from bench.diagnose.cross_validation.figures import fitted_figures
from bench.diagnose.cross_validation.posterior import posterior_of
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.nominal_model import linearised_model_of
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import segments_of
from bench.effects.catalogue import catalogue
from bench.effects.effect import WHOLE, Acting
from bench.hide.campaign import hide_campaign
from bench.report.diagnosis.file_names import DIFFERENCE, FIGURES, NOMINAL_MJCF, ROBOT
from bench.report.handover.figures_table import csv_of
from bench.report.handover.posterior_file import write_posterior
from bench.report.handover.robot_folder import hand_over
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests.simulate.rotation_small import small_rotation

BINS = 120
LOST = 0.12


def write_found(robot: Path, folder: Path, **changes: object) -> Path:
    """Write what a diagnosis hands over of the two-joint robot with a loss of gas, and return the folder.

    Args:
        robot: Its folder.
        folder: A new one.
        changes: Of the rotation that is recorded.
    """
    compiled = compile_robot(load_robot(robot))
    effect = catalogue()["gas_loss"]
    acting = [Acting(effect, WHOLE, {"lost": LOST})]
    rng = np.random.default_rng(1)
    campaign = hide_campaign(compiled.robot, small_rotation(robot, **changes), acting, rng).campaign
    quantities = quantities_of(campaign.runs, compiled)
    segments = segments_of(campaign, compiled, quantities, BINS)
    linear = linearised_model_of(Replay(compiled, segments, quantities), nuisances_of(compiled, quantities))
    fit = refit(linear, (Cause(effect, WHOLE, effect.parameters, ()),), {})
    folder.mkdir()
    handed = hand_over(linear, fit, folder / ROBOT, folder / NOMINAL_MJCF)
    write_posterior(folder / ROBOT, posterior_of(linear, fit))
    (folder / DIFFERENCE).write_text(handed.difference)
    (folder / FIGURES).write_text(csv_of(fitted_figures(linear, fit)))
    return folder
