"""What is identified along a line, against an independent world: exact without noise, calibrated with it."""

from dataclasses import fields, replace

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.compensation import compensation
from bench.identify.estimate import JointEstimate, StiffnessEstimate
from bench.identify.friction_pairs import pair_friction, sliding_direction
from bench.identify.line_comparison import compare
from bench.identify.line_deflection import (
    LineModel,
    line_model,
    measured_deflection,
    measured_lost_motion,
    predicted_deflection,
    predicted_lost_motion,
)
from bench.identify.line_passes import line_passes, white_noise
from bench.identify.link_share import link_share
from bench.record.campaign import Campaign, Run
from bench.robot.folder import load_robot
from tests.identify.hh150 import COUNTERBALANCE, STIFFNESS, TORQUE_CONSTANT, hh150
from tests.identify.line_world import TURNING, LineWorld, passes, path
from tests.identify.static_world import pushing

LEVEL = np.array([34.0, 440.0, 440.0, 108.0, 220.0, 28.0])  # [Nm], both sides together
EXACT = 1e-9  # [m]; two Newton steps of the equilibrium leave less
SECOND_ORDER = 1e-5  # [m]; friction bends the arm by some 1e-4 rad, and there load and Jacobian are others
FEEDBACK = 0.015  # for the same reason the load changes friction's torque by about this share
SEEDS = 200
CURRENT_NOISE = 0.02  # [A]
TRACKER_NOISE = 3e-5  # [m]


@pytest.fixture(scope="module")
def arm() -> Arm:
    return Arm(hh150())


@pytest.fixture(scope="module")
def q() -> np.ndarray:
    return path()


def world(share: float, **noise: object) -> LineWorld:
    return LineWorld(share * LEVEL, (1 - share) * LEVEL, **noise)


def estimate(
    method: str, compliance: np.ndarray, covariance: np.ndarray | None = None, share: float = 0.3
) -> StiffnessEstimate:
    known = StiffnessEstimate(
        method,
        hh150().names,
        compliance,
        np.zeros((6, 6)) if covariance is None else covariance,
        np.inf,
        1.0,
        np.ones(6, dtype=bool),
        {},
        (),
    )
    if method != "joint":
        return known
    values = {field.name: getattr(known, field.name) for field in fields(known)}
    unused = dict.fromkeys(("friction_scale", "current_gain", "current_gain_sigma"), np.zeros(6))
    return JointEstimate(**values, **unused, link_share=np.full(6, share), link_share_sigma=np.zeros(6))


def modelled(arm: Arm, q: np.ndarray, true: LineWorld, rng: np.random.Generator | None = None) -> LineModel:
    return line_model(arm, COUNTERBALANCE, passes(true, q, rng))


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_half_the_difference_is_the_friction_of_both_sides(arm: Arm, q: np.ndarray, share: float) -> None:
    """Eq. (48); exact but for what the few tenths of a milliradian between out and back change in the load's torque."""
    friction = modelled(arm, q, world(share)).friction["loaded"]
    np.testing.assert_allclose(friction.level[TURNING], LEVEL[TURNING], rtol=FEEDBACK * share + 1e-12)
    assert np.all(np.isnan(friction.level[~TURNING])), "joints that do not turn do not tell"
    np.testing.assert_array_equal(np.sign(friction.along()[0]), [0, 1, -1, 0, 1, 0])


def test_friction_is_calibrated(arm: Arm, q: np.ndarray) -> None:
    z = []
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        gain = 0.02 * rng.standard_normal(6)
        found = pair_friction(*_pair(passes(world(0.0, current=CURRENT_NOISE, gain=gain), q, rng)), np.full(6, 0.02))
        z.append(((found.level - LEVEL) / found.sigma)[TURNING])
    assert_calibrated(np.concatenate(z))


def _pair(found):
    return found.of("loaded", "out"), found.of("loaded", "back")


def test_friction_is_not_known_near_a_turning_point() -> None:
    q = np.stack([np.linspace(-0.01, 0.01, 201) ** 2 * 50, np.linspace(0, 0.1, 201), np.zeros(201)], axis=1)
    direction = sliding_direction(q)
    assert direction[0, 0] == -1
    assert direction[-1, 0] == 1
    unknown = direction[:, 0] == 0
    np.testing.assert_array_equal(unknown, np.abs(q[:, 0]) < 1e-3)
    np.testing.assert_array_equal(direction[:, 1], 1)
    np.testing.assert_array_equal(direction[:, 2], 0)


def test_white_noise_is_seen_through_the_curve(rng: np.random.Generator) -> None:
    t = np.linspace(0, 1, 2000)
    curves = np.stack([np.sin(3 * t), 5 * t**2], axis=1)
    noisy = curves + [3e-5, 2.0] * rng.standard_normal(curves.shape)
    np.testing.assert_allclose(white_noise(noisy), [3e-5, 2.0], rtol=0.05)


@pytest.mark.parametrize("way", ["out", "back"])
@pytest.mark.parametrize("method", ["current", "force", "joint"])
@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_with_the_true_stiffness_every_method_predicts_the_deflection(
    arm: Arm, q: np.ndarray, share: float, method: str, way: str
) -> None:
    """Friction cancels between passes of one direction, on whichever side it is."""
    model = modelled(arm, q, world(share))
    predicted = predicted_deflection(model, estimate(method, 1 / STIFFNESS, share=share), way)
    measured, _ = measured_deflection(model.passes, way)
    np.testing.assert_allclose(predicted.displacement, measured, rtol=0, atol=SECOND_ORDER)
    assert np.abs(measured[:, 2]).max() > 1e-3


def test_without_friction_the_methods_are_exact_and_so_is_the_closed_form(arm: Arm, q: np.ndarray) -> None:
    model = modelled(arm, q, LineWorld(np.zeros(6), np.zeros(6)))
    measured, _ = measured_deflection(model.passes, "out")
    for method in ("current", "force"):
        predicted = predicted_deflection(model, estimate(method, 1 / STIFFNESS), "out")
        np.testing.assert_allclose(predicted.displacement, measured, rtol=0, atol=EXACT)
    wrench = model.passes.of("loaded", "out").wrench
    load = arm.jacobian(q, "load").transpose(0, 2, 1) @ wrench[..., None]
    plain = arm.jacobian(q, "reflector_1")[:, :3] @ (load / STIFFNESS[:, None])  # J_m K^-1 J_f^T W, Eq. (35)
    np.testing.assert_allclose(plain[..., 0], measured, rtol=0, atol=0.02 * np.abs(measured).max())


@pytest.mark.parametrize("share", [0.0, 0.3, 1.0])
def test_lost_motion_belongs_to_the_link_side(arm: Arm, q: np.ndarray, share: float) -> None:
    model = modelled(arm, q, world(share))
    measured, _ = measured_lost_motion(model.passes, "loaded")
    force = predicted_lost_motion(model, estimate("force", 1 / STIFFNESS), "loaded").displacement
    current = predicted_lost_motion(model, estimate("current", 1 / STIFFNESS), "loaded").displacement
    joint = predicted_lost_motion(model, estimate("joint", 1 / STIFFNESS, share=share), "loaded").displacement
    np.testing.assert_allclose(force, 0, atol=1e-15)
    np.testing.assert_allclose(joint, measured, rtol=0, atol=SECOND_ORDER)
    np.testing.assert_allclose(share * current, measured, rtol=0, atol=SECOND_ORDER)
    found = link_share(model, estimate("joint", 1 / STIFFNESS))
    assert found.value == pytest.approx(share, rel=FEEDBACK, abs=1e-6)


def test_what_the_line_says_is_calibrated(arm: Arm, q: np.ndarray) -> None:
    """Estimates drawn from their own covariance, noise of tracker and currents: z-scores and intervals."""
    sigma = 0.05 / STIFFNESS
    covariance = np.diag(sigma**2) + 0.5 * np.outer(sigma, sigma)
    root = np.linalg.cholesky(covariance)
    z, covered, allowed = [], [], []
    for seed in range(SEEDS):
        rng = np.random.default_rng(seed)
        gain = 0.02 * rng.standard_normal(6)
        model = modelled(arm, q, world(0.3, tracker=TRACKER_NOISE, current=CURRENT_NOISE, gain=gain), rng)
        found = estimate("force", 1 / STIFFNESS + root @ rng.standard_normal(6), covariance)
        for axis in compare(*measured_deflection(model.passes, "out"), predicted_deflection(model, found, "out"), rng)[
            ::2
        ]:
            z.append(axis.mean / axis.mean_error)
            allowed.append([axis.as_expected, axis.maximum <= axis.maximum_allowed])
        low, high = link_share(model, found).interval()
        covered.append(low <= 0.3 <= high)
    assert_calibrated(np.array(z))
    assert 0.92 <= np.mean(covered) <= 0.98
    assert np.all(np.abs(np.mean(allowed, axis=0) - 0.95) < 0.03)


def assert_calibrated(z: np.ndarray) -> None:
    assert abs(z.mean()) < 0.3
    assert 0.85 < z.std() < 1.15
    assert 0.92 <= np.mean(np.abs(z) < 1.96) <= 0.98


def test_an_error_of_the_torque_constants_cancels_in_the_current_method(arm: Arm, q: np.ndarray) -> None:
    gain = np.array([0.0, 0.03, -0.02, 0.0, 0.05, 0.0])
    model = modelled(arm, q, LineWorld(np.zeros(6), np.zeros(6), gain=gain))
    variance = np.diag((0.02 / STIFFNESS) ** 2)
    wrong = estimate("current", 1 / STIFFNESS / (1 + gain), variance)
    predicted = predicted_deflection(model, wrong, "out")
    np.testing.assert_allclose(predicted.displacement, measured_deflection(model.passes, "out")[0], atol=EXACT)
    right = estimate("current", 1 / STIFFNESS, variance)
    np.testing.assert_allclose(predicted_deflection(model, right, "out").standard_error, 0, atol=EXACT)


@pytest.mark.parametrize("share", [0.0, 0.3])
def test_corrected_commands_put_the_links_on_the_line(arm: Arm, q: np.ndarray, share: float) -> None:
    model = modelled(arm, q, world(share))
    given = compensation(model, estimate("joint", 1 / STIFFNESS, share=share))
    wrench = model.passes.of("loaded", "out").wrench
    for way, sign in (("out", -1), ("back", 1)):
        direction = TURNING * np.sign(q[-1] - q[0]) * sign
        needed = -(pushing(q, wrench) + share * LEVEL * direction) / STIFFNESS
        at_knots = np.stack([np.interp(given.share, np.linspace(0, 1, len(q)), column) for column in needed.T], axis=1)
        np.testing.assert_allclose(given.ways[way].knots, at_knots, atol=5e-6)
        np.testing.assert_allclose(given.ways[way].removed.displacement[:, 1], 0, atol=1e-6)


def test_joints_that_the_estimate_does_not_know_count_as_rigid(arm: Arm, q: np.ndarray) -> None:
    model = modelled(arm, q, world(0.3))
    known = estimate("force", 1 / STIFFNESS, np.eye(6) * 1e-20)
    compliance, covariance = known.compliance.copy(), known.covariance.copy()
    compliance[0] = covariance[0] = covariance[:, 0] = np.nan
    blind = predicted_deflection(model, replace(known, compliance=compliance, covariance=covariance), "out")
    full = predicted_deflection(model, known, "out")
    np.testing.assert_allclose(blind.displacement, full.displacement, atol=EXACT)  # the load does not turn joint 1
    assert np.all(np.isfinite(blind.standard_error))


def campaign_of(rows: dict[str, int]) -> Campaign:
    """Return straight runs in joint space with that many rows, named as given; currents 2 A out and 1 A back."""
    runs = []
    for name, count in rows.items():
        way = np.linspace(0, 1, count) if name.endswith("out") else np.linspace(1, 0, count)
        columns = {"time_s": np.arange(count) * 0.1} | {f"q_cmd_{j}_rad": 0.1 * j * way for j in range(1, 7)}
        columns |= {f"current_{j}_a": np.full(count, 2.0 if name.endswith("out") else 1.0) for j in range(1, 7)}
        columns |= {f"reflector_1_{axis}_m": 1 + way for axis in "xyz"}
        runs.append(Run(name, "motion", 0.0, columns))
    return Campaign("hh150", tuple(runs))


def test_runs_are_brought_to_equal_places() -> None:
    figures = load_robot("hh150").figures
    found = line_passes(campaign_of({"loaded-out": 21, "loaded-back": 31}), figures)
    out, back = found.of("loaded", "out"), found.of("loaded", "back")
    assert len(out) == len(back) == 21
    np.testing.assert_allclose(back.q_cmd, out.q_cmd, atol=1e-12)
    np.testing.assert_array_equal(out.q_motor, out.q_cmd)  # no encoder was logged
    np.testing.assert_allclose(pair_friction(out, back, found.current_gain).level, TORQUE_CONSTANT / 2, rtol=1e-6)


def test_what_is_missing_is_named() -> None:
    figures = load_robot("hh150").figures
    with pytest.raises(InputError, match="named unloaded-out, unloaded-back, loaded-out, loaded-back"):
        line_passes(campaign_of({"sweep": 20}), figures)
    with pytest.raises(InputError, match="has 3 rows"):
        line_passes(campaign_of({"loaded-out": 3}), figures)
    found = line_passes(campaign_of({"loaded-out": 20}), figures)
    with pytest.raises(InputError, match="no run loaded-back"):
        found.of("loaded", "back")
