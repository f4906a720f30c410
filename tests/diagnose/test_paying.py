"""What pays: fits without a finding, side by side, and no longer than what is plain needs."""

from collections.abc import Hashable
from functools import cache

import pytest

from bench.diagnose.extend.refit import refit
from bench.diagnose.extend.size import wald
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.diagnose.name import paying
from bench.diagnose.name.models import Model
from bench.diagnose.name.naming import Finding
from bench.diagnose.name.paying import held_findings
from bench.effects.catalogue import catalogue
from bench.executor.contract import Executor
from bench.executor.processes import Processes
from bench.executor.serial import SERIAL
from tests.diagnose.small_models import linear_of
from tests.diagnose.sweeps import SWEEPS, made, nominal

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
        assert [cause.key for cause in one.without.causes] == [cause.key for cause in beside[key].without.causes]
        assert [u.cause.key for u in one.without.unknowns] == [u.cause.key for u in beside[key].without.unknowns]


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
