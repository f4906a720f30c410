"""The table of everything that was fitted, and what it says of figures that moved."""

import csv
from dataclasses import fields, replace

import numpy as np
import pytest

from bench.diagnose.cross_validation.figures import FittedFigure, fitted_figures
from bench.diagnose.cross_validation.jackknife import with_jackknife
from bench.diagnose.cross_validation.leave_out import tangent_of
from bench.diagnose.extend.refit import refit
from bench.diagnose.linearise.candidates import Cause
from bench.diagnose.linearise.linearised_model import LinearisedModel
from bench.effects.nominal import PRESLIDING
from bench.report.handover.figures_table import COLUMNS, csv_of, moved_sentences
from tests.report.handover.made import EFFECTS, SECOND


def test_the_table_is_the_fit(linear: LinearisedModel) -> None:
    """Values and errors of findings are those of the fit; the table reads back as it was written."""
    effect = EFFECTS["coulomb_level"]
    fit = refit(linear, (Cause(effect, SECOND, effect.parameters, ()),), {})
    rows = fitted_figures(linear, fit)
    assert len(rows) == len(linear.nuisances) + 1
    found = rows[0]
    assert found.kind == "finding"
    assert (found.found, found.stated) == (fit.values[0], 0.0)
    told = with_jackknife(linear, fit).sigma[0]  # as the page and verdict.json have it
    np.testing.assert_allclose((found.high - found.low) / 2 / 1.959964, told, rtol=1e-6)
    by_name = {(row.name, row.kind): row for row in rows}
    for nuisance, x in zip(linear.nuisances, fit.nuisances, strict=True):
        row = by_name.get((nuisance.name, "figure")) or by_name[nuisance.name, "campaign"]
        if nuisance.name.startswith("torque constant of"):
            stated = 100.0 if "current_1_a" in [quantity.column for quantity in linear.quantities] else 1.0
            constant = row.found + (row.stated == 0)
            np.testing.assert_allclose(constant * (1 + x * nuisance.sigma), stated)
            assert row.low < row.found < row.high
            assert row.sigmas == -x
        else:
            off, low, high = row.found, row.low, row.high
            if nuisance.is_factor:
                off, low, high = (nuisance.sigma * np.log1p([off, low, high]) / np.log1p(nuisance.sigma)).tolist()
            assert (row.sigmas, row.sigma) == (x, nuisance.sigma)
            assert off == pytest.approx(x * nuisance.sigma, abs=1e-12)
            assert high - low <= 2 * 1.96 * nuisance.sigma * (1 + 1e-9)  # data never know less than was stated
    names = [*(nuisance.name for nuisance in linear.nuisances), found.name]
    columns = np.linalg.solve(tangent_of(linear, fit).precision, np.eye(len(names)))
    rho = columns / np.sqrt(np.outer(np.diag(columns), np.diag(columns))) - np.eye(len(names))
    assert len(set(names)) == len(names)
    partners = [names[i] if abs(row[i]) > np.sqrt(0.5) else "" for row in rho for i in [int(np.argmax(np.abs(row)))]]
    weights = by_name["weights that hang", "figure"]  # the sensor reads (1 + gain) (1 + share) of what was written down
    assert weights.trades_with == "gain of the force sensor"
    assert weights.correlation < 0
    for row in rows:
        assert row.trades_with == partners[names.index(row.name)]
        assert np.isnan(row.correlation) == (row.trades_with == "")
    read = list(csv.DictReader(csv_of(rows).splitlines()))
    assert list(read[0]) == list(COLUMNS)
    for row, text in zip(rows, read, strict=True):
        for field in fields(FittedFigure):
            value = getattr(row, field.name)
            if isinstance(value, str):
                assert text[field.name] == (value or ("share" if field.name == "unit" else ""))
            else:
                assert (text[field.name] == "") if np.isnan(value) else float(text[field.name]) == value


def test_the_part_of_a_day_is_told_as_a_share(linear: LinearisedModel) -> None:
    """A constant of 10.97 Nm/A and its part of a day, 9.07 "instead of 9.40": the robot had 10.59."""
    which = next(i for i, one in enumerate(linear.nuisances) if one.name.startswith("torque constant of"))
    own = replace(linear.nuisances[which], recording="june")
    both = replace(
        linear,
        nuisances=(*linear.nuisances, own),
        sensitivities=np.concatenate([linear.sensitivities, linear.sensitivities[:, :, [which]]], axis=2),
        jacobian=np.concatenate([linear.jacobian, linear.jacobian[:, [which]]], axis=1),
    )
    fit = refit(linear, (), {})
    fit = replace(fit, nuisances=np.append(fit.nuisances, 0.5))
    rows = {row.name: row for row in fitted_figures(both, fit)}
    day = rows[str(own)]
    assert day.unit == ""
    assert day.stated == 0
    assert 1 + day.found == pytest.approx(1 / (1 + 0.5 * own.sigma))
    assert rows[own.name].found != day.found


def test_a_figure_that_moved_is_named_with_what_it_trades_against() -> None:
    moved = FittedFigure("stiffness of a", "figure", "", 0.0, 0.09, 0.07, 0.11, 0.03, 3.0, "mass of b", -0.8)
    turned = FittedFigure("turn", "figure", "rad", 0.0, -1e-3, -1.2e-3, -8e-4, 2e-4, -5.0, "", np.nan)
    still = replace(moved, sigmas=1.9)
    held = replace(moved, kind="campaign")
    assert list(moved_sentences([moved, still, held, turned])) == [
        "stiffness of a: +9.0 % (7.0 to 11.0), 3.0 times its stated uncertainty; it trades against mass of b "
        "(correlation -0.80)",
        "turn: -0.057 deg (-0.069 to -0.046), 5.0 times its stated uncertainty",
    ]
    constant = FittedFigure(
        "torque constant of a", "figure", "Nm/A", 220.8, 247.6, 246.6, 248.6, 4.4, 5.2, "weights", 0.9
    )
    assert list(moved_sentences([constant])) == [
        "torque constant of a: 247.6 Nm/A (246.6 to 248.6) instead of 220.8, 5.2 times its stated uncertainty; "
        "it trades against weights (correlation +0.90)"
    ]


def test_a_figure_whose_interval_holds_what_was_stated_shows_nothing_by_itself() -> None:
    """A mass by 5 % as stated came out as "+57 % (-83 to 197), 11.4 times its stated uncertainty", as a finding."""
    open_mass = FittedFigure("mass of a", "figure", "", 0.0, 0.57, -0.83, 1.97, 0.05, 11.4)
    moved = FittedFigure("mass of b", "figure", "", 0.0, 0.2, 0.1, 0.3, 0.05, 4.0)
    assert list(moved_sentences([open_mass, moved])) == [
        "mass of b: +20 % (10 to 30), 4.0 times its stated uncertainty",
        "mass of a: +57 % (-83 to 197), 11.4 times its stated uncertainty; its interval holds the stated value, so by "
        "itself it shows nothing",
    ]


def test_what_moved_from_an_earlier_diagnosis_stands_beside_that() -> None:
    """A frame that is set up anew is held against what was found before; what has changed is said elsewhere."""
    turned = FittedFigure(
        "tracker frame, turn x", "figure", "rad", 0.0, 3e-3, 2.8e-3, 3.2e-3, 4e-4, 5.0, "", np.nan, earlier=1e-3
    )
    changed = replace(turned, has_changed=True)
    assert list(moved_sentences([turned, changed])) == [
        "tracker frame, turn x: 0.172 deg (0.160 to 0.183) instead of 0.057, 5.0 times its uncertainty"
    ]


def test_presliding_is_told_as_replays_see_it() -> None:
    """On five sound robots the motor side of joint 1 came out too soft each time."""
    soft = FittedFigure(
        f"{PRESLIDING} on the motor side of a", "figure", "", 0.0, -0.9, -0.95, -0.8, 2.0, -2.1, "", np.nan
    )
    assert "as replays of rests see it" in next(moved_sentences([soft]))
