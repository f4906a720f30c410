"""The stranger's arm as `bench new-robot` starts it, without a word from him."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.robot.nominal_dynamics import NominalDynamics, nominal_dynamics
from bench.robot.starter.folder import start_robot
from bench.robot.starter.source import read_source
from tests import stranger

MISSING = 1  # the drive whose rotor `but_one_rotor` leaves out


def started(folder: Path, text: str | None = None) -> NominalDynamics:
    """Return its nominal dynamics; the robot's folder is written into a folder that is there.

    Args:
        folder: To write into.
        text: Its MJCF, where it is another one.
    """
    (folder / "arm.xml").write_text(text or stranger.mjcf())
    return nominal_dynamics(start_robot("arm", read_source(folder / "arm.xml"), folder / "arm").compiled)


def but_one_rotor() -> str:
    """Return the MJCF without the armature of one joint."""
    text = stranger.mjcf()
    stated = f'armature="{stranger.ROTOR[MISSING]}"'
    assert text.count(stated) == 1
    return text.replace(stated, "")


def erring(arm: NominalDynamics, rng: np.random.Generator) -> NominalDynamics:
    """Return an arm that is wrong by what it states of itself; of rotors that nobody knows it states nothing."""
    unsure, links, n = arm.uncertainty, arm.bodies, arm.n_joints
    drives = arm.drive_uncertainty
    scale = 1 + unsure.mass * rng.normal(size=n)
    com = links.com + unsure.centre_of_mass_m * rng.normal(size=(n, 3))
    bodies = replace(links, mass=links.mass * scale, inertia=links.inertia * scale[:, None, None], com=com)
    sigma = np.where(drives.rotor_is_unknown, 0.0, drives.rotor_inertia)
    return replace(arm, bodies=bodies, rotor_inertia=arm.rotor_inertia * (1 + sigma * rng.normal(size=n)))
