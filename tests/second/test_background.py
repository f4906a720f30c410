"""What is a little wrong with the second plant's arm: as much as is stated, drive by drive."""

from pathlib import Path

import numpy as np

from bench.hide.second_plant import figures_of
from bench.robot.compiled import compile_robot
from bench.robot.figures import Uncertainty
from bench.robot.folder import load_robot
from bench.second.background import drawn
from tests.small_robot import write_small_robot

DRAWS = 2000
WITHIN = 0.08  # relative, of a standard deviation of 2000 draws: five of its standard errors


def test_each_drive_errs_by_what_is_stated_of_it(tmp_path: Path, rng: np.random.Generator) -> None:
    nominal = figures_of(compile_robot(load_robot(write_small_robot(tmp_path))))
    stated = {"friction": [0.0, 0.2], "rotor_inertia": [0.1, 0.0], "stiffness": [0.03, 0.3]}
    known = Uncertainty.model_validate(stated)
    found = [drawn(nominal, known, rng) for _ in range(DRAWS)]
    for key, values, about in (
        ("friction", [one.motor.level for one in found], nominal.motor.level),
        ("friction", [one.link.level for one in found], nominal.link.level),
        ("rotor_inertia", [one.rotor_inertia for one in found], nominal.rotor_inertia),
        ("stiffness", [one.springs.stiffness for one in found], nominal.springs.stiffness),
    ):
        np.testing.assert_allclose(np.std(np.array(values) / about, axis=0), stated[key], rtol=WITHIN, atol=1e-12)
