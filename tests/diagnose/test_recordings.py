"""The diagnosis on recordings of real robots, and on stand-ins of the same format where those are not here."""

from pathlib import Path

import numpy as np
import pytest
from scipy import signal

from bench.diagnose.diagnose import Diagnosis, diagnose
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.segments import segments_of
from bench.effects.catalogue import catalogue
from bench.identify.rigid_motion_fit import Filtering, axis_columns, smooth_motion
from bench.record.campaign import Array, Campaign
from bench.record.convert import convert
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.robot.logs import log_format_of
from tests.recordings import data_folder, write_emps, write_kr300

SLIDING = (
    "coulomb_friction",
    "viscous_level",
    "torque_offset",
    "direction_friction",
    "load_friction",
    "torque_constant",
)
PUBLISHED = {"coulomb": 20.394, "offset": -3.165}  # [N], data set of the EMPS, 2019
CLOSE = 0.15  # of the Coulomb level: which of offset, asymmetry and viscous change stands beside it moves it by so much
BLOCKS = 8


def read(log: Path, robot: str) -> Campaign:
    campaign = convert(log, log_format_of(load_robot(robot)), robot).campaign
    assert campaign
    return campaign


def found(campaign: Campaign) -> Diagnosis:
    effects = catalogue()
    return diagnose(campaign, compile_robot(load_robot(campaign.robot)), {name: effects[name] for name in SLIDING})


def levels(diagnosis: Diagnosis) -> dict[str, float]:
    """Return the first parameter of every cause of the best explanation."""
    best = diagnosis.naming.models[0].fit
    return {u.cause.effect.name: float(v) for u, v in zip(best.unknowns, best.values, strict=True)}


def test_emps_needs_coulomb_friction_first() -> None:
    diagnosis = found(read(data_folder("emps") / "emps.csv", "emps"))
    first = diagnosis.naming.findings[0]
    assert first.cause.effect.name == "coulomb_friction"
    assert first.held_out.is_gain
    assert first.held_out.channels[0].after < 0.3 * first.held_out.channels[0].before
    np.testing.assert_allclose(levels(diagnosis)["coulomb_friction"], PUBLISHED["coulomb"], rtol=CLOSE)


def test_stand_in_of_emps_is_read_alike(tmp_path: Path, rng: np.random.Generator) -> None:
    truth = write_emps(tmp_path / "emps.csv", rng, seconds=12.0)
    diagnosis = found(read(tmp_path / "emps.csv", "emps"))
    assert diagnosis.naming.findings[0].cause.effect.name == "coulomb_friction"
    np.testing.assert_allclose(levels(diagnosis)["coulomb_friction"], truth["coulomb"], rtol=CLOSE)


@pytest.mark.parametrize("rolling", [0.0, 40.0])
def test_friction_that_bends_over_speed_is_named_where_it_is(
    tmp_path: Path, rng: np.random.Generator, rolling: float
) -> None:
    truth = write_emps(tmp_path / "emps.csv", rng, seconds=30.0, rolling=rolling, slow=0.15)
    effects = catalogue()
    names = (*SLIDING, "rolling_friction")
    campaign = read(tmp_path / "emps.csv", "emps")
    diagnosis = diagnose(campaign, compile_robot(load_robot("emps")), {name: effects[name] for name in names})
    named = levels(diagnosis)
    assert ("rolling_friction" in named) == (rolling > 0)
    np.testing.assert_allclose(named["coulomb_friction"], truth["coulomb"], rtol=CLOSE)
    if rolling:
        np.testing.assert_allclose(named["rolling_friction"], rolling, rtol=CLOSE)


def emps() -> dict[str, Array]:
    """Return inertia, friction and force of EMPS, filtered and thinned."""
    (run,) = read(data_folder("emps") / "emps.csv", "emps").runs
    filtering = Filtering()
    motion = smooth_motion(run.columns["time_s"], run.columns["q_motor_1_m"][:, None], filtering)
    columns = axis_columns(motion, 0) | {"force": run.columns["tau_motor_1_n"]}
    return {k: signal.decimate(x, filtering.decimation, ftype="fir", zero_phase=True)[2:-2] for k, x in columns.items()}


def test_emps_by_least_squares_with_blocks_held_out() -> None:
    """An independent way to the figures of the ladder: nominal, with Coulomb friction, and with an offset too."""
    thin = emps()
    missing = thin["force"] - 95.109 * thin["inertia"] - 203.50 * thin["viscous"]
    slides = np.abs(thin["viscous"]) > 0.08 * np.max(np.abs(thin["viscous"]))
    left = [np.sqrt(np.mean(missing[slides] ** 2))]
    for names in (["coulomb"], ["coulomb", "offset"]):
        regressor = np.stack([thin[name] for name in names], axis=1)
        errors = []
        for block in np.array_split(np.arange(len(missing)), BLOCKS):
            others = np.setdiff1d(np.flatnonzero(slides), block)
            fit = np.linalg.lstsq(regressor[others], missing[others])[0]
            errors.append((missing - regressor @ fit)[block][slides[block]])
        left.append(np.sqrt(np.mean(np.concatenate(errors) ** 2)))
        whole = np.linalg.lstsq(regressor[slides], missing[slides])[0]
        for name, value in zip(names, whole, strict=True):
            np.testing.assert_allclose(value, PUBLISHED[name], rtol=0.05)
    np.testing.assert_allclose(left, [20.8, 4.24, 2.02], rtol=0.02)


def test_offset_of_emps_is_viscous_friction_that_differs_between_directions() -> None:
    """Figures of models/emps/README.md, by least squares on all that slides: without and with a term |v|."""
    thin = emps()
    thin["one way"] = np.abs(thin["viscous"])
    slides = thin["one way"] > 0.08 * np.max(thin["one way"])
    names = ["viscous", "offset", "inertia", "coulomb", "one way"]
    for count, expected, error in ((4, (198.2, -3.27), 2.00), (5, (198.4, -0.21, -37.2), 1.47)):
        regressor = np.stack([thin[name][slides] for name in names[:count]], axis=1)
        values = np.linalg.lstsq(regressor, thin["force"][slides])[0]
        left = thin["force"][slides] - regressor @ values
        np.testing.assert_allclose(np.delete(values, (2, 3)), expected, rtol=0.02)
        assert np.sqrt(np.mean(left**2)) == pytest.approx(error, rel=0.01)


@pytest.mark.parametrize("source", ["recording", "stand-in"])
def test_readings_of_a_turning_joint_are_left_out_and_the_others_kept(source: str, tmp_path: Path) -> None:
    """Six joints that turn at different times leave most readings of each; dropping every such instant left 43 %."""
    log = tmp_path / "log.csv"
    if source == "recording":
        log = data_folder("kr300") / "recording_a.csv"
    else:
        write_kr300(log, np.random.default_rng(4))
    campaign, compiled = read(log, "kr300"), compile_robot(load_robot("kr300"))
    quantities = quantities_of(campaign.runs, compiled)
    (segment,) = segments_of(campaign, compiled, quantities)
    kept = np.isfinite(segment.observed)
    for c, quantity in enumerate(quantities):
        assert 0.6 < kept[:, c].mean() < 1.0, quantity.column
    # in a bin that is kept, its joint slides in one direction
    speed = np.abs(segment.motion.velocity[segment.motion.read])
    for c, quantity in enumerate(quantities):
        assert speed[kept[:, c], quantity.index].min() > 0.05 * speed[:, quantity.index].max()
