"""The K_C analysis from its scenario to Figs. 4 to 6."""

import json
from dataclasses import asdict
from pathlib import Path

import numpy as np

from bench.identify.arm import Arm
from bench.identify.complementary_map import complementary_map, grid_over_limits
from bench.identify.complementary_prediction import prediction_error
from bench.report.figures.style import save
from bench.report.jsonable import to_jsonable
from bench.report.paper.chapter import Chapter
from bench.report.paper.complementary.figures import (
    GOOD,
    figure_4,
    figure_5,
    figure_6,
    figure_6_for_others,
    prediction_bounds,
)
from bench.report.paper.complementary.other_stiffness import (
    other_zones,
    stiffness_values,
    zones_sentence,
    zones_table,
)
from bench.report.paper.published import as_json
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.links import rigid_bodies
from bench.scenario.complementary import Complementary

NUMBERS = "complementary.json"
OTHERS = "figure-6-other-stiffness.png"


def run_complementary(scenario: Complementary, folder: Path) -> Chapter:
    """Compute the map and the prediction errors; write numbers and figures into an existing folder.

    Raises:
        InputError: The scenario does not fit its robot.
        RobotError: The robot has no such point.
    """
    robot = load_robot(scenario.robot)
    compiled = compile_robot(robot)
    scenario.check(robot, compiled.limits)
    arm = Arm(rigid_bodies(compiled))
    joints = (scenario.swept[0] - 1, scenario.swept[1] - 1)
    grid = grid_over_limits(arm, np.deg2rad(scenario.rest_deg), joints, np.deg2rad(scenario.step_deg))
    wrench = np.array([*scenario.force_n, *scenario.moment_nm])
    found = complementary_map(arm, grid, scenario.point, np.array(scenario.stiffness_nm_per_rad), wrench)
    prediction = prediction_error(arm, found, scenario.point, found.zone(GOOD))
    save(figure_4(found, arm.joint_names), folder / "figure-4.png")
    save(figure_5(prediction, grid, arm.joint_names), folder / "figure-5.png")
    save(figure_6(found, arm.joint_names), folder / "figure-6.png")
    tried = stiffness_values(found.stiffness, arm.joint_names)
    others = other_zones(arm, found, tried, scenario.point, wrench)
    optimal = found.zone(GOOD)
    save(
        figure_6_for_others(grid, [optimal, *(each.zone for each in others.values())], arm.joint_names), folder / OTHERS
    )
    rows = prediction_bounds(prediction)
    share, zone = found.fraction(GOOD), float(optimal.mean())
    data = {
        "share_of_poses_below_5_percent": to_jsonable(share),
        "share_of_poses_below_10_percent": to_jsonable(found.fraction(0.10)),
        "share_of_poses_in_the_optimal_zone": zone,
        "beside_the_paper": as_json(rows),
        "first_deg": to_jsonable(np.rad2deg(grid.first)),
        "second_deg": to_jsonable(np.rad2deg(grid.second)),
        "optimal_zone": optimal.astype(int).tolist(),
        "other_stiffness": {
            name: {key: value for key, value in asdict(each).items() if key != "zone"}
            | {"share_in_the_optimal_zone": float(each.zone.mean())}
            for name, each in others.items()
        },
    }
    (folder / NUMBERS).write_text(json.dumps(data) + "\n", encoding="utf-8")
    listed = ", ".join(f"{100 * value:.0f}" for value in share)
    sentence = (
        f"Without K_C the stiffness is within 5 % in {listed} % of the poses, joint by joint; of all joints at once in "
        f"{100 * zone:.0f} %. The rest are narrow bands where the load puts no torque on a joint."
    )
    sentences = (sentence, zones_sentence(optimal, others))
    title = "K_C analysis, Tables 3 and 4, Figs. 4 to 6"
    return Chapter("complementary", title, rows, sentences, data, (zones_table(optimal, others),))
