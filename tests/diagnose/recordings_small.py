"""Recordings of one HH-150 with encoders on two links: a sweep of joint 2, twenty seconds."""

from collections.abc import Mapping
from dataclasses import replace
from functools import cache

import numpy as np

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.effects.catalogue import catalogue
from bench.effects.effect import Acting
from bench.hide.campaign import hide_campaign
from bench.record.campaign import Campaign
from bench.robot.compiled import CompiledRobot, compile_robot
from bench.robot.folder import Robot, load_robot
from bench.robot.instruments import LinkEncoder
from tests.diagnose.sweeps import SWEEP, changed

ZEROED = 2e-3  # [rad], how well link encoders are set
BINS = 80
EFFECTS = catalogue()
CHOICE = ("coulomb_level", "viscous_level", "unstated_payload", "joint_compliance", "gas_loss", "current_offset")


def with_encoders() -> Robot:
    robot = load_robot("hh150")
    figures = robot.figures
    joints = tuple(drive.joint for drive in figures.drives[:2])
    encoder = LinkEncoder(joints=joints, accuracy_rad=1e-5, offset_sigma_rad=ZEROED)
    instruments = figures.instruments.model_copy(update={"link_encoder": encoder})
    return replace(robot, figures=figures.model_copy(update={"instruments": instruments}))


@cache
def compiled() -> CompiledRobot:
    return compile_robot(with_encoders())


def recording(seed: int, hidden: Mapping[str, Mapping[str, float]] = {}, zero_rad: float = 0.0) -> Campaign:
    """Return a campaign with effects in joint 2, and the encoder of its link off zero."""
    acting = []
    for name, values in hidden.items():
        places = EFFECTS[name].places(compiled())
        acting.append(Acting(EFFECTS[name], places[min(1, len(places) - 1)], EFFECTS[name].complete(values)))
    rng = np.random.default_rng(seed)
    campaign = hide_campaign(with_encoders(), SWEEP, acting, rng, background=False).campaign
    return changed(campaign, lambda columns: columns.update(q_link_2_rad=columns["q_link_2_rad"] + zero_rad))


def diagnosed(campaign: Campaign, names: tuple[str, ...] = CHOICE) -> Diagnosis:
    choice = {name: EFFECTS[name] for name in names}
    return diagnose(campaign, compiled(), choice, most_bins=BINS, proposes=False)
