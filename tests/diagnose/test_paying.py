"""What pays: fits without a finding, side by side, and no longer than what is plain needs."""

from collections.abc import Hashable
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from bench.diagnose.extend.refit import refit
from bench.diagnose.extend.size import evidence_of, wald
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name import paying
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Finding
from bench.diagnose.name.paying import held_findings, shape_pays
from bench.effects.catalogue import catalogue
from bench.errors import ConvergenceError
from bench.executor.contract import Executor
from bench.executor.processes import Processes
from bench.executor.serial import SERIAL
from bench.record.campaign import Campaign, Run
from bench.robot.compiled import compile_robot
from bench.robot.folder import load_robot
from tests import stranger
from tests.diagnose.noise_free import linearised
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import SWEEPS, made, nominal
from tests.stranger_started import started

THRESHOLD = 5.0  # [nats]


@cache
def linear_once() -> LinearisedModel:
    return linear_of(made(SWEEPS, 3, hidden={"gas_loss": 0.05, "direction_friction": 0.3}))


def cause_of(name: str, index: int | None = None) -> Cause:
    effect = catalogue()[name]
    place = next(place for place in effect.places(nominal()) if index is None or place.index == index)
    return Cause(effect, place, effect.parameters_at(nominal(), place), ())


def held(executor: Executor = SERIAL) -> dict[Hashable, Finding]:
    causes = (cause_of("gas_loss"), cause_of("direction_friction", 1), cause_of("payload_mass"))
    fit = refit(linear_once(), causes, {})
    return held_findings(linear_once(), refit(linear_once(), (), {}), Model(fit), fit.causes, THRESHOLD, executor)


def test_findings_are_held_out_side_by_side() -> None:
    alone, beside = held(), held(Processes(2))
    assert [key for key, one in alone.items() if one.is_taken] == [key for key, one in beside.items() if one.is_taken]
    for key, one in alone.items():
        assert one.log_evidence == pytest.approx(beside[key].log_evidence)
        assert (one.without is None) == one.is_taken, "a fit that nobody needs any more is not kept"
        if one.without and (other := beside[key].without):
            assert [cause.key for cause in one.without.causes] == [cause.key for cause in other.causes]
            assert [u.cause.key for u in one.without.unknowns] == [u.cause.key for u in other.unknowns]


def test_a_shape_without_which_there_is_no_balance_pays(monkeypatch: pytest.MonkeyPatch) -> None:
    """The diagnosis ended with an error, for listed causes alone such a fit was expected."""

    def without_balance(*_: object) -> None:
        raise ConvergenceError("no balance")

    monkeypatch.setattr(paying, "fit_without_shape", without_balance)
    null = refit(linear_once(), (), {})
    assert shape_pays(linear_once(), null, Model(null), THRESHOLD)


def test_what_is_plainly_needed_is_needed_by_brief_fits_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Two thirds of a diagnosis of an arm without friction went into what each of its frictions is worth exactly."""
    found = []
    for plain in (float("inf"), paying.DECIDED):
        monkeypatch.setattr(paying, "PLAIN", plain)
        found.append(held())
    thorough, brief = found
    assert {key: one.is_taken for key, one in brief.items()} == {key: one.is_taken for key, one in thorough.items()}
    for key, one in thorough.items():
        if one.log_evidence > 10 * paying.DECIDED:
            assert brief[key].log_evidence == pytest.approx(one.log_evidence, rel=0.1)


def test_derivatives_tell_what_a_fit_loses_without_a_cause() -> None:
    fit = refit(linear_once(), (cause_of("gas_loss"), cause_of("direction_friction", 1)), {})
    for cause in fit.causes:
        others = tuple(other for other in fit.causes if other is not cause)
        without = refit(linear_once(), others, {}, fit.nuisances, fit)
        lost = (without.objective - fit.objective) / 2
        assert wald(cause, fit)[0] / 2 == pytest.approx(lost, rel=0.1)
        assert evidence_of(cause, fit) == pytest.approx(fit.log_evidence - without.log_evidence, rel=0.1)


def test_friction_of_one_joint_is_worth_what_its_own_drive_shows(tmp_path: Path, rng: np.random.Generator) -> None:
    """Without that of joint 1, drives 2 and 3 erred by fifty times as much as with it, and were told first.

    A fit without it had ended 164 standard deviations off, and was worth twenty times what it lost.
    """
    started(tmp_path)
    arm = compile_robot(load_robot(tmp_path / "arm"))
    runs = []
    for number in range(2):
        motion = stranger.moved(rng, 8.0, stranger.as_filed(12.0))
        columns = {"time_s": motion.time}
        for j in range(3):
            columns |= {f"q_motor_{j + 1}_rad": motion.position[:, j], f"tau_motor_{j + 1}_nm": motion.torque[:, j]}
        runs.append(Run(f"run{number}", "motion", 100.0 * number, columns))
    linear = linearised(Campaign(str(arm.robot.folder), tuple(runs)), arm)
    names = ("coulomb_friction", "viscous_friction", "unstated_payload")
    effects = [catalogue()[name] for name in names]
    causes = tuple(
        Cause(effect, place, effect.parameters_at(arm, place), ()) for effect in effects for place in effect.places(arm)
    )
    model = Model(refit(linear, causes, {}))
    found = held_findings(linear, refit(linear, (), {}), model, causes, THRESHOLD)
    for cause in causes[:3]:
        finding = found[cause.key]
        times = {one.channel: one.before / one.after for one in finding.held_out.channels}
        own = times.pop(f"tau_motor_{cause.place.index + 1}_nm")
        assert own > 5
        assert max(times.values()) < own / 3
        assert 0.5 < finding.log_evidence / finding.held_out.nats < 2
