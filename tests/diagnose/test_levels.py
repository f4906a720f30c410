"""Several recordings of one machine: what is the machine's, what is one recording's, and what repeats."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.cross_validation.figures import fitted_figures
from bench.diagnose.cross_validation.folds import folds_of
from bench.diagnose.diagnose import Diagnosis, signatures_of
from bench.diagnose.explain import recorded_by
from bench.diagnose.linearise.reference_motion import session_of
from bench.diagnose.replay.courses import courses_of
from bench.diagnose.replay.levels import as_of, with_recordings
from bench.diagnose.replay.nuisances import nuisances_of
from bench.diagnose.replay.quantities import quantities_of
from bench.diagnose.replay.replay import Replay
from bench.diagnose.replay.segments import MOST_BINS, MOST_READINGS, Segment, segments_of
from bench.diagnose.replay.world import NOMINAL, World, edits_in, model_of
from bench.effects.catalogue import catalogue
from bench.effects.conditions import Conditions
from bench.effects.drifts import DAY_K, VISCOUS
from bench.effects.effect import Acting, Place
from bench.effects.levels import places_of
from bench.effects.lubricant import viscous
from bench.record.campaign import Campaign
from bench.record.joined import joined
from bench.report.diagnosis.words import words_of
from bench.report.handover.readme import AGREES
from bench.report.handover.robot_folder import hand_over
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from bench.store.store import Store
from tests.diagnose.recordings_small import BINS, CHOICE, EFFECTS, ZEROED, compiled, diagnosed, recording

EXACT = 1e-9  # of the largest reading of a channel, in SI units; balances are found from the same start


@pytest.fixture(scope="module")
def plain() -> tuple[Campaign, Campaign]:
    """Return two recordings of the nominal robot; an encoder was zeroed anew between them."""
    return recording(1, zero_rad=1e-3), recording(2, zero_rad=-2e-3)


@pytest.fixture(scope="module")
def both(plain: tuple[Campaign, Campaign]) -> Campaign:
    return joined(dict(zip("AB", plain, strict=True)))


@pytest.fixture(scope="module")
def of_both(both: Campaign) -> Diagnosis:
    return diagnosed(both)


def segments(campaign: Campaign, bins: int = BINS) -> tuple[Segment, ...]:
    return segments_of(campaign, compiled(), quantities_of(campaign.runs, compiled()), bins)


def named(diagnosis: Diagnosis) -> set[tuple[str, str, str]]:
    """Return effect, place and level of each cause of the first explanation."""
    explanations = diagnosis.verdict.explanations
    return {(one.effect, one.place, one.level) for one in explanations[0].causes} if explanations else set()


@pytest.mark.parametrize(
    ("name", "values"),
    [
        ("unstated_payload", {"mass": 60.0}),
        ("gas_temperature", {"offset": -20.0}),
        ("gas_loss", {"lost": 0.1}),
        ("current_offset", {"offset": 0.2}),
        ("channel_delay", {"delay": 0.02}),
        ("tracker_frame", {"tx": 3e-4, "rz": 5e-4}),
    ],
)
def test_what_belongs_to_a_recording_acts_there_alone(name: str, values: dict[str, float], both: Campaign) -> None:
    """A world of two recordings shows of each what that recording shows by itself."""
    quantities = quantities_of(both.runs, compiled())
    places = [p for p in places_of(EFFECTS[name], compiled(), recorded_by(both, compiled())) if p.recording is not None]
    acting = tuple(
        Acting(EFFECTS[name], place, EFFECTS[name].complete({k: share * v for k, v in values.items()}))
        for share, recording in ((1.0, "A"), (0.5, "B"))
        for place in [next(one for one in places if one.recording == recording and one.index in (0, 1))]
    )
    nuisances = with_recordings(nuisances_of(compiled(), quantities), compiled(), both.recordings)
    off = {one: one.sigma for one in nuisances if one.recording is not None}
    world = World(off, acting)
    replay = Replay(compiled(), segments(both), quantities)
    shown = replay.predict(world)
    edges = np.cumsum([len(segment) for segment in replay.segments])[:-1]
    scale = np.maximum(np.max(np.abs(shown), axis=0), 1.0)
    parts = np.split(shown, edges)
    for which, part in zip(replay.segments, parts, strict=True):
        alone = Replay(compiled(), (which,), quantities).predict(as_of(world, which.recording))
        np.testing.assert_allclose(part / scale, alone / scale, atol=EXACT)
    assert not np.allclose(shown, replay.predict(World(acting=acting[:1])))


def test_each_recording_has_a_prior_of_its_own(both: Campaign) -> None:
    signatures = signatures_of(both, compiled(), {})
    zeros = [one for one in signatures.nuisances if one.name == "zero of link encoder 2"]
    assert [(one.recording, one.sigma) for one in zeros] == [("A", ZEROED), ("B", ZEROED)]
    drifting = [one for one in signatures.nuisances if one.name == "current offset of joint2"]
    stated = compiled().robot.figures.instruments.current
    assert stated
    assert [one.recording for one in drifting] == [None, "A", "B"]
    assert np.hypot(drifting[0].sigma, drifting[1].sigma) == pytest.approx(stated.offset_sigma_a)
    masses = [one for one in signatures.nuisances if one.name.startswith("mass of")]
    assert len({one.name for one in masses}) == len(masses)
    friction = {str(one): one.sigma for one in signatures.nuisances if one.name == "viscous friction of joint2"}
    stated_friction = compiled().robot.figures.uncertainty.friction
    day = VISCOUS * DAY_K  # on top of what is stated, which holds at one temperature
    assert list(friction.values()) == pytest.approx([stated_friction, day, day])


def test_a_warm_day_changes_what_friction_was_found_as_well(both: Campaign) -> None:
    """A robot from a drawing has none to begin with, and a day that was colder became an unlisted torque over speed."""
    nuisances = with_recordings(nuisances_of(compiled(), quantities_of(both.runs, compiled())), compiled(), "AB")
    (drift,) = (one for one in nuisances if (one.name, one.recording) == ("viscous friction of joint1", "B"))
    effect = catalogue()["viscous_friction"]
    found = Acting(effect, Place("joint", 0, "joint1"), effect.complete({"coefficient": 100.0}))
    reference = Conditions.reference(compiled().n_joints)
    damping = {
        kind: viscous(compile_robot(compiled().robot, edits_in(as_of(World({drift: value}, acting), "B"), reference)))[
            0
        ]
        for kind, value, acting in (("stated", 0.0, ()), ("found", 0.0, (found,)), ("cold", 0.2, (found,)))
    }
    assert damping["found"] == pytest.approx(damping["stated"] + 100)
    assert damping["cold"] == pytest.approx(1.2 * damping["found"])


def test_what_belongs_to_a_recording_shows_there_alone_and_as_if_there_were_no_other(both: Campaign) -> None:
    parts = segments(both)
    signatures = signatures_of(both, compiled(), {})
    changes = signatures.sensitivities(parts).nuisances
    is_b = np.concatenate([np.full(len(segment), segment.recording == "B") for segment in parts])
    campaign = replace(both, runs=tuple(run for run in both.runs if run.recording == "A"))
    single = signatures_of(campaign, compiled(), {})
    alone = single.sensitivities(segments(campaign)).nuisances
    shows = {one.name: bool(np.any(alone[:, :, i])) for i, one in enumerate(single.nuisances)}
    own = [(i, one) for i, one in enumerate(signatures.nuisances) if one.recording == "A"]
    for i, one in own:
        assert not np.any(changes[is_b, :, i])
        if one.name in shows:  # the air of the day is of several recordings only
            assert bool(np.any(changes[~is_b, :, i])) is shows[one.name]
    assert {"zero of link encoder 2", "current offset of joint2", "viscous friction of joint2"} <= {
        one.name for _, one in own if shows.get(one.name)
    }


def test_an_encoder_that_is_zeroed_anew_is_no_scatter(of_both: Diagnosis) -> None:
    diagnosis = of_both
    assert diagnosis.verdict.kind == "nothing found"
    assert not diagnosis.verdict.noisy
    fitted = dict(zip(map(str, diagnosis.linear.nuisances), diagnosis.naming.null.nuisances, strict=True))
    between = fitted["zero of link encoder 2 in recording A"] - fitted["zero of link encoder 2 in recording B"]
    assert between * ZEROED == pytest.approx(3e-3, abs=3e-5)


@pytest.mark.parametrize(
    ("draws", "least"),
    [(((3, 4),), 1), pytest.param(((3, 4), (5, 6), (7, 8)), 4, marks=pytest.mark.study)],
    ids=["one", "three"],
)
def test_payloads_that_differ_are_found_where_they_were_carried(draws: tuple[tuple[int, int], ...], least: int) -> None:
    """Intervals are held to what they promise: 1 of 2 holds but for one draw in 100, 4 of 6 but for one set in 63."""
    true = {"A": 40.0, "B": 90.0}
    spread = {f"second_moment_{axis}": 1.0 for axis in "xyz"}
    held = []
    for seeds in draws:
        made = {
            name: recording(seed, {"unstated_payload": {"mass": mass, **spread}}, zero)
            for (name, mass), seed, zero in zip(true.items(), seeds, (1e-3, -1e-3), strict=True)
        }
        diagnosis = diagnosed(joined(made))
        assert named(diagnosis) == {("unstated_payload", f"robot in recording {name}", "recording") for name in true}
        for cause in diagnosis.verdict.explanations[0].causes:
            mass = cause.parameters[0]
            assert mass.name == "mass"
            held.append(mass.low < true[cause.place[-1]] < mass.high)
        assert "payload that is not stated (in recording B)" in "\n".join(words_of(diagnosis.verdict))
    assert sum(held) >= least


@pytest.mark.parametrize("change", [0.3, pytest.param(-0.2, marks=pytest.mark.study)])
def test_coulomb_friction_of_another_day_is_no_scatter(change: float) -> None:
    """Taken to be the same on both days, it was scatter beyond what the instruments explain, or other causes."""
    payload = {"unstated_payload": {"mass": 40.0}}
    stiff = {"coulomb_level": {"change": change}}
    diagnosis = diagnosed(joined({"A": recording(5, payload), "B": recording(6, {**payload, **stiff})}))
    assert {name for name, *_ in named(diagnosis)} == {"unstated_payload"}
    assert not diagnosis.verdict.noisy
    nuisances = diagnosis.linear.nuisances
    fitted = {str(one): float(x) * one.sigma for one, x in zip(nuisances, diagnosis.naming.null.nuisances, strict=True)}
    of_day = [1 + fitted[f"Coulomb friction of joint2 in recording {name}"] for name in "AB"]
    assert of_day[1] / of_day[0] == pytest.approx(1 + change, abs=0.03)


def test_a_cause_in_both_recordings_is_the_machines_and_confirmed_by_both() -> None:
    hidden = {"coulomb_level": {"change": 0.6}}
    diagnosis = diagnosed(joined({"A": recording(5, hidden), "B": recording(6, hidden)}))
    assert named(diagnosis) == {("coulomb_level", "joint 2", "machine")}
    (step,) = [one for one in diagnosis.verdict.steps if one.accepted]
    assert step.confirmed_by == ("A", "B")
    assert diagnosis.verdict.held_out_by == "recording"


@pytest.mark.parametrize(
    ("name", "values", "expected"),
    [
        ("current_offset", {"offset": 0.2}, {("current_offset", "drive 2 in recording B", "recording")}),
        ("coulomb_level", {"change": 0.6}, None),  # friction is the same in all recordings: nothing fits
        ("gas_loss", {"lost": 0.12}, {("gas_loss", "robot in recording B", "recording")}),
        ("joint_compliance", {"change": 0.5}, None),
    ],
)
def test_a_cause_in_one_recording_is_never_called_the_machines(
    name: str, values: dict[str, float], expected: set[tuple[str, str, str]] | None, plain: tuple[Campaign, Campaign]
) -> None:
    diagnosis = diagnosed(joined({"A": plain[0], "B": recording(7, {name: values}, -2e-3)}))
    if expected is not None:
        assert named(diagnosis) == expected
    causes = [cause for one in diagnosis.verdict.explanations for cause in one.causes]
    assert all(cause.level != "machine" for cause in causes)


def test_folds_are_recordings_and_the_runs_of_one_that_shows_an_effect_alone(both: Campaign) -> None:
    diagnosis = diagnosed(both, ("coulomb_level",))
    linear = diagnosis.linear
    folds = folds_of(linear)
    assert folds.by == "recording"
    assert folds.recordings == ("A", "B")
    of_rows, _ = folds.of_rows(linear)
    whose = np.array([folds.recordings[fold] for fold in of_rows])
    assert set(np.array(linear.runs)[linear.run_of[whose == "A"].astype(int)]) == {
        run.name for run in both.runs if run.recording == "A"
    }
    alone = folds_of(linear, np.where(whose == "B", 1.0, 1e-3))
    assert alone.by == "run"
    assert not alone.recordings
    runs = sum(run.recording == "B" for run in both.runs)
    assert len(alone) == runs + 1  # its runs, and the other recording as a whole


def test_one_recording_is_diagnosed_as_a_campaign_without_recordings() -> None:
    campaign = recording(8, {"coulomb_level": {"change": 0.6}})
    renamed = replace(campaign, runs=tuple(replace(run, recording="may") for run in campaign.runs))
    assert joined({"may": campaign}) is campaign
    one, other = (diagnosed(which, CHOICE[:3]).verdict.as_json() for which in (campaign, renamed))
    np.testing.assert_equal(one, other)


def test_what_is_handed_over_has_the_mean_of_all_days_and_the_zeros_of_the_last_recording(
    of_both: Diagnosis, tmp_path: Path
) -> None:
    """The day of the last recording was in it, from which the next day differs by both; the table has what each has."""
    fit, linear = of_both.naming.null, of_both.linear
    (tmp_path / "out").mkdir()
    handed = hand_over(linear, fit, tmp_path / "out" / "robot", tmp_path / "out" / "nominal.xml")
    assert handed.disagreement < AGREES
    readings = load_robot(tmp_path / "out" / "robot").figures.fitted.readings
    rows = {row.name: row.found for row in fitted_figures(linear, fit)}
    zeros = {name: rows[f"zero of link encoder 2 in recording {name}"] for name in "AB"}
    assert readings.link_encoder_zero_rad["joint2"] == zeros["B"] != zeros["A"]
    shared = rows["current offset of joint2"]
    days = [rows[f"current offset of joint2 in recording {name}"] for name in "AB"]
    assert abs(days[1] - np.mean(days)) > 0.2 * abs(shared + np.mean(days))
    gain = 1 + readings.current_gain.get("joint2", 0.0)
    assert readings.current_offset_a["joint2"] == pytest.approx(shared + np.mean(days), rel=0.1), gain
    assert "`B`" in (tmp_path / "out" / "robot" / "README.md").read_text()


def test_stored_signatures_know_which_run_is_of_which_recording(both: Campaign, tmp_path: Path) -> None:
    first = segments(both)
    other = tuple(replace(segment, recording="A") for segment in first)
    store = Store(tmp_path)
    assert session_of(first, store).key != session_of(other, store).key


def test_bins_of_a_run_do_not_depend_on_other_runs(plain: tuple[Campaign, Campaign]) -> None:
    """Ten recordings are cut as each is alone."""
    one = plain[0]
    alone = segments(one, MOST_BINS)
    ten = segments(joined({f"r{i}": one for i in range(10)}), MOST_BINS)
    assert sum(len(segment) for segment in ten) * len(quantities_of(one.runs, compiled())) < MOST_READINGS
    for i, segment in enumerate(ten):
        expected = alone[i % len(alone)]
        np.testing.assert_array_equal(segment.motion.time, expected.motion.time)
        np.testing.assert_array_equal(segment.observed, expected.observed)


def test_each_recording_is_followed_for_itself(both: Campaign) -> None:
    """Each has its own clock: what gas or friction remembers of one says nothing of the next."""
    parts = segments(both)
    models = [model_of(NOMINAL, part.run, part.recording, part.conditions) for part in parts]
    for course in courses_of(parts, models, with_temperatures=False):
        assert len({parts[i].recording for i in course.segments}) == 1
