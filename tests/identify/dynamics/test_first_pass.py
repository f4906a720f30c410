"""The first pass on a rigid arm that MuJoCo moved: exact without noise, honest with it."""

from dataclasses import replace

import numpy as np
import pytest

from bench.errors import InputError
from bench.identify.arm import Arm
from bench.identify.dynamics.advice import _candidates, _information, advise, sentence
from bench.identify.dynamics.consistency import inertial_parameters
from bench.identify.dynamics.equations import DRIVE_COLUMNS
from bench.identify.dynamics.first_pass import first_pass
from bench.identify.dynamics.found import FirstPass
from bench.identify.dynamics.prior import weighed
from bench.identify.dynamics.quantities import Quantity, quantities
from bench.identify.dynamics.regressor import N_INERTIAL, payload_columns
from bench.record.campaign import Campaign, Run
from bench.record.known import Known
from bench.record.units import STANDARD_GRAVITY
from bench.report.dynamics.as_json import AXES, as_json
from bench.report.dynamics.identify import Dynamics
from bench.report.dynamics.text import _head
from bench.robot.bodies import Point, read_only
from bench.robot.payload import with_payload
from tests.identify.dynamics.rigid_world import Friction, N, arm, drawn, recorded, robot, truth_of

FRICTION = Friction(np.array([12.0, 9.0, 4.0]), np.array([15.0, 10.0, 6.0]), np.array([0.5, -1.0, 0.8]))
UNCERTAIN = {"mass": 0.02, "centre_of_mass_m": 0.005}
SHORT = {"seconds": 10.0, "rate": 100.0}


def by_name(found: FirstPass) -> dict[str, Quantity]:
    return {one.name: one for one in quantities(found)}


def test_parameters_are_found_without_noise() -> None:
    """What the filters do to sign(v) at the turns is all that is left."""
    rng = np.random.default_rng(1)
    nominal = robot(arm(), payload=20.0, **UNCERTAIN)
    true = drawn(nominal, rng)
    loaded = replace(true, bodies=with_payload(true.bodies, 8.0, "hook"))
    found = first_pass(recorded(loaded, FRICTION, rng, sigma=1e-3), nominal)
    truth = truth_of(found, true, FRICTION, 8.0)
    for one in quantities(found):
        if one.kind == "friction" and "difference" not in one.name:
            assert abs(one.value - one.combine @ truth) < 0.15, one.name  # [Nm] and [Nm s/rad], of 4 to 15
    np.testing.assert_allclose(found.torques(found.stretches).rms("first_pass"), 0, atol=0.2)
    assert np.all(found.held_out_rms() < 0.03 * found.held_out.rms("nominal"))


def test_intervals_cover() -> None:
    """85 to 95 % of the 90 % intervals of what is told hold the truth, in noise that remembers for 0.1 s."""
    inside = []
    for seed in range(10):
        rng = np.random.default_rng(seed)
        nominal = robot(arm(), payload=20.0, **UNCERTAIN)
        true, payload = drawn(nominal, rng), float(rng.uniform(0, 15))
        friction = Friction(rng.uniform(2, 15, N), rng.uniform(2, 20, N), rng.normal(0, 1, N))
        loaded = replace(true, bodies=with_payload(true.bodies, payload, "hook"))
        found = first_pass(recorded(loaded, friction, rng, runs=2, **SHORT), nominal, find_delay=False)
        truth = truth_of(found, true, friction, payload)
        for one in quantities(found):
            if one.told and one.kind in ("friction", "inertia"):
                low, high = one.interval(found.quantile(0.9))
                inside.append(low <= one.combine @ truth <= high)
    assert len(inside) > 200
    assert 0.85 <= np.mean(inside) <= 0.95


def test_delay_of_the_torques_is_found() -> None:
    nominal = robot(arm())
    found = first_pass(recorded(nominal, FRICTION, np.random.default_rng(2), sigma=0.5, late=6e-3), nominal)
    assert abs(found.solution.delay - 6e-3) < found.quantile(0.99) * found.solution.delay_sigma + 1e-4
    assert found.solution.delay_sigma < 1e-3


def test_a_delay_that_is_not_taken_has_limits() -> None:
    """It was "no delay", said of torques 3.2 ms late, said nothing of how late they may be."""
    nominal, late = robot(arm()), 2e-4
    found = first_pass(recorded(nominal, FRICTION, np.random.default_rng(2), sigma=5.0, late=late, **SHORT), nominal)
    assert found.solution.delay == found.solution.delay_sigma == 0
    assert found.solution.not_taken
    delay, sigma = found.solution.not_taken
    assert abs(delay - late) < found.quantile(0.99) * sigma
    content = as_json(Dynamics((), found, (), (), {}), 0.9)
    low, high = content["delay_not_taken"]["interval_s"]  # type: ignore[index]
    assert low < late < high
    said = next(line for line in _head(found) if "delay" in line)
    assert f"with one of {1e3 * delay:.2f} ms (" in said


def test_moments_of_a_payload_are_along_the_axes_of_the_body_that_carries_it() -> None:
    """The load point of the KR300 is turned by 180 degrees, and nothing said which axes `dynamics.json` means."""
    hook = arm().points["hook"]
    turned = replace(arm(), points={"hook": replace(hook, rotation=read_only(np.diag([1.0, -1.0, -1.0])))})
    columns = [payload_columns(Arm(bodies), "hook")[1] for bodies in (arm(), turned)]
    np.testing.assert_array_equal(*columns)
    about = inertial_parameters(np.outer([*hook.position, 1.0], [*hook.position, 1.0]))
    np.testing.assert_allclose(columns[1][:, 0], about)  # one kilogram in the load point, about the joint
    assert "axes of the body that carries it" in AXES


def test_payload_is_told_against_stated_masses() -> None:
    nominal = robot(arm(), payload=20.0, **UNCERTAIN)
    loaded = replace(nominal, bodies=with_payload(nominal.bodies, 9.0, "hook"))
    found = first_pass(recorded(loaded, FRICTION, np.random.default_rng(3)), nominal)
    payload = by_name(found)["unstated payload"]
    low, high = payload.interval(found.quantile())
    assert payload.told
    assert low < 9.0 < high
    assert payload.sigma < 1.5


def test_a_payload_reaches_far_beyond_a_flange_that_is_close_to_the_last_joint() -> None:
    """Its size was taken for the flange's distance from the joint, and figures had to err in its place."""
    rng, parts = np.random.default_rng(6), {"grip": (0.12, 0.03, 0.05), "jaw": (0.25, -0.05, 0.0)}
    hook = Point(N - 1, read_only([0.02, 0.0, 0.0]), read_only(np.eye(3)))
    ends = {name: replace(hook, position=read_only(place)) for name, place in parts.items()}
    nominal = robot(replace(arm(), points={"hook": hook, **ends}), payload=20.0, **UNCERTAIN)
    true = drawn(nominal, rng)
    bodies, carried = true.bodies, np.zeros(N_INERTIAL)
    for name, place in parts.items():
        bodies = with_payload(bodies, 4.0, name)
        lever = np.array(place) - hook.position
        carried += inertial_parameters(4.0 * np.outer([*lever, 1.0], [*lever, 1.0]))
    found = first_pass(recorded(replace(true, bodies=bodies), FRICTION, rng), nominal, find_delay=False)
    truth = truth_of(found, true, FRICTION, 0.0)
    truth[found.layout.payload] = carried
    assert found.solution.widths.figures == 0
    inside = [
        low <= one.combine @ truth <= high
        for one in quantities(found)
        if one.told and one.kind == "inertia"
        for low, high in [one.interval(found.quantile(0.9))]
    ]
    assert len(inside) > 10
    assert np.mean(inside) >= 0.8  # 90 % of a dozen, less twice their standard deviation


def test_a_payload_that_was_weighed_is_carried_and_tells_the_scale_of_torques() -> None:
    """It was ignored; within a diagnosis its inertia was taken and its weight was not."""
    nominal = replace(robot(arm(), payload=20.0, **UNCERTAIN), torque_gain_sigma=np.full(N, 0.1))
    loaded = replace(nominal, bodies=with_payload(nominal.bodies, 9.0, "hook"))
    campaign = recorded(loaded, FRICTION, np.random.default_rng(3))
    known = replace(campaign, known=(Known("payload_kg", 9.0, 0.05),))
    found, blind = first_pass(known, nominal, find_delay=False), first_pass(campaign, nominal, find_delay=False)
    carries = {"load_mass_kg": 9.0, "load_z_n": -9.0 * STANDARD_GRAVITY}
    written = [
        replace(r, columns={**r.columns, **{k: np.full(len(r), v) for k, v in carries.items()}}) for r in campaign.runs
    ]
    stated = first_pass(replace(campaign, runs=tuple(written)), nominal, find_delay=False)
    np.testing.assert_allclose(found.held_out.rms("nominal"), stated.held_out.rms("nominal"), rtol=1e-9)
    np.testing.assert_allclose(found.held_out.rms("rival"), stated.held_out.rms("rival"), rtol=1e-2)
    beyond = by_name(found)["unstated payload"]
    assert abs(beyond.value) < 3 * beyond.sigma <= 0.2
    scale = [name for name in by_name(found) if name.startswith("torque scale")]
    assert scale
    assert by_name(found)[scale[0]].sigma < 0.9 * by_name(blind)[scale[0]].sigma


def test_a_payload_that_was_weighed_in_one_recording_says_nothing_of_another() -> None:
    nominal = robot(arm(), payload=20.0)
    campaign = recorded(nominal, FRICTION, np.random.default_rng(3))
    two = replace(campaign, runs=tuple(replace(run, recording=f"r{i}") for i, run in enumerate(campaign.runs)))
    one = Known("payload_kg", 9.0, 0.05, recording="r0")
    assert weighed(nominal, replace(two, known=(one,))) is nominal
    both = weighed(nominal, replace(two, known=tuple(replace(one, recording=name) for name in two.recordings)))
    assert (both.payload, both.payload_sigma) == pytest.approx((9.05, 0.05))


def test_another_campaign_is_predicted_better_than_by_the_nominal_model() -> None:
    rng = np.random.default_rng(4)
    nominal = robot(arm(), **UNCERTAIN)
    true = drawn(nominal, rng)
    found = first_pass(recorded(true, FRICTION, rng), nominal)
    torques = found.predict(recorded(true, FRICTION, rng, runs=1))
    assert np.all(torques.rms("first_pass") < 0.4 * torques.rms("nominal"))
    assert np.all(torques.rms("first_pass") < 2.5)  # the noise is 2 Nm, and some of it is filtered away


def test_a_stretch_that_is_too_short_for_the_filter_predicts_nothing() -> None:
    """A log of which a lost sample cuts off half a second ended in a traceback."""
    nominal = robot(arm(), **UNCERTAIN)
    found = first_pass(recorded(nominal, FRICTION, np.random.default_rng(4), runs=2), nominal)
    (run,) = recorded(nominal, FRICTION, np.random.default_rng(5), runs=1).runs
    columns = {name: values[:70] for name, values in run.columns.items()}
    short = replace(run, columns=columns, name="short", start_s=100.0)
    both, alone = (found.predict(Campaign("cut", runs)) for runs in ((run, short), (run,)))
    np.testing.assert_array_equal(both.rms("first_pass"), alone.rms("first_pass"))


def test_a_joint_that_stands_is_not_told_and_a_motion_is_named_that_would_tell_it() -> None:
    rng = np.random.default_rng(5)
    nominal = robot(arm(), **UNCERTAIN)
    runs = []
    for run in recorded(nominal, FRICTION, rng, runs=2).runs:
        runs.append(replace(run, columns={**run.columns, "q_motor_3_rad": np.full(len(run), 0.3)}))
    found = first_pass(Campaign("rigid", tuple(runs)), nominal)
    told = by_name(found)
    elbow = [one for name, one in told.items() if one.kind == "friction" and "(elbow)" in name]
    assert elbow
    assert not any(one.told for one in elbow)
    assert told["Coulomb friction (shoulder)"].told
    assert found.solution.noise[2] is None
    motions = advise(found, quantities(found))
    assert any("Coulomb friction (elbow)" in motion.tells and 2 in motion.joints for motion in motions)
    assert "elbow" in sentence(motions[0], found)


def test_a_motion_that_is_proposed_halves_the_variance_of_what_it_tells() -> None:
    """What was just short of told was "told" by any motion: the rotor of a quill by its base turning."""
    nominal = robot(arm(), **UNCERTAIN)
    found = first_pass(recorded(nominal, FRICTION, np.random.default_rng(5), runs=2, **SHORT), nominal)
    short_of_it = [
        replace(one, prior_sigma=0.9999 * np.sqrt(2) * one.sigma) for one in quantities(found) if one.kind == "inertia"
    ]
    motions = advise(found, short_of_it)
    factor = found.prior.factor(found.solution.widths.all_free())
    known = np.eye(len(factor)) + factor.T @ found.solution.normal.gram @ factor
    assert motions
    for motion in motions:
        more = known + factor.T @ _information(found, motion) @ factor
        for one in short_of_it:
            if one.name in motion.tells:
                before, after = (np.linalg.solve(h, factor.T @ one.combine) for h in (known, more))
                assert one.combine @ factor @ after < one.combine @ factor @ before / 2, (one.name, motion.joints)
        known = more


def test_a_motion_informs_each_drive_of_its_own_friction() -> None:
    """With a sixth column of drives, advice still counted five: friction of the elbow was that of the shoulder."""
    found = first_pass(recorded(robot(arm()), FRICTION, np.random.default_rng(5), runs=2, **SHORT), robot(arm()))
    motion = next(one for one in _candidates(found) if one.joints == (2,))
    shown = np.diag(_information(found, motion)) > 0
    for name in set(DRIVE_COLUMNS) - {"warming"}:  # friction falls from one motion to the next
        assert shown[found.layout.of_drives(name)].tolist() == [False, False, True], name


def test_currents_serve_with_the_torque_constant() -> None:
    nominal = robot(arm())
    (run,) = recorded(nominal, FRICTION, np.random.default_rng(6), runs=1).runs
    columns = {name: values for name, values in run.columns.items() if not name.startswith("tau")}
    columns |= {f"current_{j}_a": run.columns[f"tau_motor_{j}_nm"] / 50.0 for j in (1, 2, 3)}
    by_current = first_pass(Campaign("rigid", (replace(run, columns=columns),)), nominal)
    by_torque = first_pass(Campaign("rigid", (run,)), nominal)
    np.testing.assert_allclose(by_current.parameters, by_torque.parameters, rtol=1e-6, atol=1e-6)


def test_a_known_load_is_taken_into_account() -> None:
    """A mass that the campaign states is no payload."""
    nominal = robot(arm(), payload=20.0, **UNCERTAIN)
    loaded = replace(nominal, bodies=with_payload(nominal.bodies, 12.0, "hook"))
    campaign = recorded(loaded, FRICTION, np.random.default_rng(7), sigma=0.2)
    stated = {"load_z_n": -12.0 * 9.81, "load_mass_kg": 12.0}
    runs = [
        replace(run, columns={**run.columns, **{name: np.full(len(run), value) for name, value in stated.items()}})
        for run in campaign.runs
    ]
    found = by_name(first_pass(replace(campaign, runs=tuple(runs)), nominal))["unstated payload"]
    assert found.value < 1.0


def test_lost_samples_split_a_run() -> None:
    nominal = robot(arm())
    (run,) = recorded(nominal, FRICTION, np.random.default_rng(8), runs=1).runs
    kept = np.ones(len(run), dtype=bool)
    kept[1500:1520] = False
    cut = replace(run, columns={name: values[kept] for name, values in run.columns.items()})
    found = first_pass(Campaign("rigid", (cut,)), nominal)
    assert len(found.stretches) == 2
    assert found.held_out_rms().max() < 3.0


@pytest.mark.parametrize(
    ("columns", "said"),
    [
        ({}, "tau_motor_i_nm"),
        ({"tau_motor_1_nm": np.ones(500)}, "all stand still"),
    ],
)
def test_data_that_do_not_serve_are_refused(columns: dict[str, np.ndarray], said: str) -> None:
    still = {"time_s": np.arange(500) / 100, **{f"q_motor_{j}_rad": np.zeros(500) for j in (1, 2, 3)}}
    with pytest.raises(InputError, match=said):
        first_pass(Campaign("rigid", (Run("run", "motion", 0.0, still | columns),)), robot(arm()))


def test_a_cut_off_must_be_a_frequency() -> None:
    nominal = robot(arm())
    campaign = recorded(nominal, FRICTION, np.random.default_rng(9), runs=1, **SHORT)
    with pytest.raises(InputError, match="positive"):
        first_pass(campaign, nominal, cutoff_hz=0.0)
    with pytest.raises(
        InputError, match="leaves next to nothing"
    ):  # a period of it is longer than any number of samples
        first_pass(campaign, nominal, cutoff_hz=1e-308)


def test_a_stated_inertia_that_is_far_off_is_found_by_widening() -> None:
    """CAD figures that are wrong by ten times what they claim are given up where the data say so."""
    rng = np.random.default_rng(10)
    nominal = robot(arm(), mass=0.002, centre_of_mass_m=1e-4)
    moved = nominal.bodies.com + 0.05 * rng.standard_normal((N, 3))
    true = replace(nominal, bodies=replace(nominal.bodies, com=read_only(moved)))
    found = first_pass(recorded(true, FRICTION, rng), nominal)
    assert found.solution.widths.figures >= 3
    assert np.all(found.held_out_rms() < 2.5)
