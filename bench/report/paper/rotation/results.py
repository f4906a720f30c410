"""The rotation experiment on paper: numbers beside the published ones, JSON and figures."""

import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from bench.identify.counterbalance_fit import CounterbalanceFit
from bench.report import scoring
from bench.report.figures.style import save
from bench.report.jsonable import to_jsonable
from bench.report.paper import published
from bench.report.paper.published import PublishedRow
from bench.report.paper.rotation.figures import figure_11, figure_12, figure_13
from bench.report.paper.rotation.identification import RotationIdentification
from bench.report.scoring import Score
from bench.robot.bodies import Array

RESULTS = "rotation.json"
CURVE_STEP = np.deg2rad(1.0)  # [rad], of k_b and k_2 in the results


@dataclass(frozen=True)
class RotationReport:
    """The rotation experiment and how far it can be trusted.

    Attributes:
        identified: From the campaigns.
        scores: C and l_c beside the truth.
    """

    identified: RotationIdentification
    scores: tuple[Score, ...]


def published_rows(found: RotationIdentification) -> tuple[PublishedRow, ...]:
    """Return our numbers beside those of section 5."""
    fit = found.fit
    (c_low, c_high), (l_low, l_high) = fit.intervals
    worst = max(prediction.error for prediction in found.predictions)
    zero, corrected = (float(np.rad2deg(s.zero)) for s in (found.spread, found.corrected))
    return (
        PublishedRow("C, Eq. (47)", "Nm", fit.gas_constant, 4771.4, "equal", float(c_low), float(c_high)),
        PublishedRow("l_c, Eq. (47)", "m", fit.critical_length, 0.9112, "equal", float(l_low), float(l_high)),
        PublishedRow("angle where M is zero, as measured, Fig. 11", "deg", zero, 3.3),
        PublishedRow("the same, torque constant corrected", "deg", corrected, 3.3),
        PublishedRow("spread of M over speeds and loads, Fig. 11", "", found.spread.largest, 0.05, "less"),
        PublishedRow("error of predicted M, Fig. 12", "", worst, 0.07, "less"),
    )


def write_rotation(report: RotationReport, folder: Path) -> None:
    """Write `rotation.json` and Figs. 11 to 13 into an existing folder."""
    found = report.identified
    (folder / RESULTS).write_text(json.dumps(as_json(report), indent=1) + "\n", encoding="utf-8")
    theta = found.torques[0].theta
    save(figure_11(found.torques, found.spread, found.fit, found.torque_gain), folder / "figure-11.png")
    save(figure_12(found.predictions, found.fit, (theta.min(), theta.max())), folder / "figure-12.png")
    save(figure_13(_range(found), found.fit, found.stiffness, found.stiffness_sigma), folder / "figure-13.png")


def as_json(report: RotationReport) -> dict[str, object]:
    """Return the report as plain data, units in the keys; what is undefined is null."""
    found = report.identified
    theta = _range(found)
    k_b = found.fit.counterbalance.stiffness(theta)
    friction = found.friction
    return {
        "beside_the_paper": published.as_json(published_rows(found)),
        "beside_the_truth": scoring.as_json(report.scores),
        "torque_gain_error": found.torque_gain,
        "fit": _fit(found.fit),
        "fit_with_masses_known_to_1_percent": _fit(found.uncertain),
        "friction": {
            "speed_rad_per_s": to_jsonable(friction.speed),
            "torque_nm": to_jsonable(friction.torque),
            "sigma_nm": to_jsonable(friction.sigma),
            "coulomb_nm": friction.coulomb,
            "viscous_nm_s_per_rad": friction.viscous,
        },
        "figure_11": [
            {"run": t.name, "payload_kg": t.payload, **_curve(theta_rad=t.theta, m_nm=t.torque)} for t in found.torques
        ],
        "figure_12": [
            {
                "run": p.name,
                "largest_error": p.error,
                "largest_error_corrected": p.corrected_error,
                "largest_error_of_spring": p.spring_error,
                **_curve(
                    theta_rad=p.theta,
                    measured_nm=p.measured,
                    corrected_nm=p.corrected,
                    predicted_nm=p.predicted,
                    by_spring_nm=p.by_spring,
                ),
            }
            for p in found.predictions
        ],
        "figure_13": {
            "k_2_0_nm_per_rad": found.stiffness,
            "k_2_0_sigma_nm_per_rad": found.stiffness_sigma,
            **_curve(
                theta_rad=theta,
                k_b_nm_per_rad=k_b,
                k_b_sigma_nm_per_rad=found.fit.stiffness_sigma(theta),
                k_2_nm_per_rad=found.stiffness + k_b,
            ),
        },
    }


def _fit(fit: CounterbalanceFit) -> dict[str, object]:
    return {
        "gas_constant_nm": fit.gas_constant,
        "critical_length_m": fit.critical_length,
        "interval_level": fit.level,
        "gas_constant_interval_nm": to_jsonable(fit.intervals[0]),
        "critical_length_interval_m": to_jsonable(fit.intervals[1]),
        "covariance": to_jsonable(fit.covariance),
        "correlation": fit.correlation,
        "chi_square": fit.chi_square,
        "degrees_of_freedom": fit.degrees_of_freedom,
        "spring_rate_n_per_m": fit.spring.rate,
        "spring_rest_length_m": fit.spring.rest_length,
        "spring_chi_square": fit.spring.chi_square,
        "spring_misfit_nm": fit.spring_misfit,
        "preferred_law": fit.preferred,
        "nuisances_in_prior_sigma": dict(fit.nuisances),
        "notes": list(fit.notes),
    }


def _range(found: RotationIdentification) -> Array:
    """Return the joint's range as far as the identified gas has a volume, shape (T,) [rad]."""
    low, high = found.limits
    theta = np.arange(low, high + CURVE_STEP / 2, CURVE_STEP)
    return theta[found.fit.counterbalance.length(theta) < found.fit.critical_length]


def _curve(**columns: Array) -> dict[str, object]:
    return {name: to_jsonable(values) for name, values in columns.items()}
