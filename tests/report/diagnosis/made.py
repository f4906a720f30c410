"""Verdicts of every kind, made up; nothing is simulated."""

from dataclasses import replace

from bench.diagnose.name.learned_shape import LearnedCurve
from bench.diagnose.verdict import (
    AmbiguityGroup,
    Baseline,
    ChannelGain,
    DetectionLimit,
    DriveErrors,
    Explanation,
    NamedCause,
    ParameterValue,
    PossibleCause,
    PredictedError,
    Proposal,
    Step,
    Unlisted,
    Verdict,
)
from bench.report.diagnosis.facts import Data, Facts, RunFacts
from bench.report.diagnosis.readings import Channel

HOSTILE = "<script>alert('x')</script> & \"quoted\""

GAS = NamedCause(
    "gas_loss",
    "loss of gas",
    "robot",
    (ParameterValue("lost", 0.1326, 0.1127, 0.1525, "", "share of the charge that is gone"),),
    "Gas leaks through seals and valve over months.",
    "range: assumed",
)
COLD = ParameterValue("offset", -38.4, -44.2, -32.6, "K")
WARM = NamedCause("gas_temperature", "gas warmer or colder", "robot", (COLD,))
OFF = ParameterValue("offset", 3.1e-4, 2.2e-4, 4.0e-4, "rad")
ZERO = NamedCause("joint_zero", "zero of a joint", "joint 2", (OFF,))
MASS = NamedCause("link_mass", "mass of a link", "upper_arm", (ParameterValue("change", 0.0327, 0.0028, 0.0626, ""),))


PRIOR_ODDS = -4.0  # logarithm, of each cause


def explanation(causes: tuple[NamedCause, ...], probability: float, log_evidence: float) -> Explanation:
    """Return an explanation that is as probable among those fitted as among everything."""
    log_posterior = log_evidence + PRIOR_ODDS * len(causes)
    return Explanation(causes, probability, log_evidence, probability, log_posterior)


def finding(*causes: NamedCause) -> AmbiguityGroup:
    """Return a finding that may have several names, all as likely."""
    return AmbiguityGroup(tuple(PossibleCause(cause, 1 / len(causes)) for cause in causes), 1.0)


STEP_GAIN = ChannelGain(
    channel="current_2_a",
    unit="A",
    before=0.612,
    after=0.081,
    floor=0.074,
    gain=0.868,
    low=0.83,
    high=0.904,
    measured=2.31,
    nominal=0.405,
    over_better=0.8,
    over_better_low=0.742,
    over_better_high=0.855,
    readings=400,
)
NO_GAIN = ChannelGain(
    channel="reflector_1_z_m",
    unit="m",
    before=2.11e-4,
    after=2.14e-4,
    floor=2.0e-4,
    gain=-0.0142,
    low=-0.05,
    high=0.021,
    measured=0.35,
    nominal=3.2e-4,
    over_better=-0.0142,
    over_better_low=-0.05,
    over_better_high=0.021,
    readings=400,
)
UNKNOWN_GAIN = ChannelGain("reflector_1_x_m", "m", *[float("nan")] * 11, 0)
NOTHING = Verdict(
    kind="nothing found",
    false_alarm_rate=0.01,
    threshold=5.9,
    noise_scale=1.0,
    explanations=(),
    rivals=(),
    unlisted=None,
    missing={"friction_temperature": ("gear_temperature",), "torque_constant_temperature": ("motor_temperature",)},
    not_simulated=("backlash",),
    detectable=(
        DetectionLimit("joint_zero", "joint 2", "offset", 2.1e-4, "rad", 2.1e-4, 2e-3, 1),
        DetectionLimit("transmission_error", "joint 2", "sin", 3.1e-5, "rad", 9.4e-5, 3e-4, 14),
        DetectionLimit("link_length", "upper_arm", "length", 18.391, "m", 18.391, 1e-3, 1),
        DetectionLimit("stribeck", "joint 1", "rise", 0.2, "", 1.7, 0.5, 5),
        DetectionLimit("stribeck", "joint 2", "rise", 0.1, "", 1.7, 0.5, 5),
    ),
    predicted=(
        PredictedError("q_link_1_rad", "rad", "motion", 4, 1.9e-4, 1.1e-4, 3.3e-4),
        PredictedError("tau_motor_1_n", "N", "motion", 1, 4.48, float("nan"), float("nan")),
    ),
)
CAUSE = replace(
    NOTHING,
    kind="cause",
    noise_scale=1.7,
    explanations=(explanation((GAS,), 0.9997, 94.3),),
    rivals=(explanation((MASS,), 0.0003, 82.1),),
    findings=(finding(GAS),),
    gain=(
        STEP_GAIN,
        UNKNOWN_GAIN,
        NO_GAIN,
    ),
    held_out_by="run",
    steps=(
        Step((GAS,), 94.3, 81.2, 60.1, 103.4, True, "held-out runs become more probable", (STEP_GAIN, NO_GAIN)),
        Step((MASS,), 6.1, 0.4, -3.1, 4.2, False, "held-out runs do not become more probable"),
    ),
    next=(Proposal("the sweeps again, slower", ("loss of gas", ""), 0.4, 0.0, "lost: 0.13 +- 0.01 today"),),
)
A_SET = replace(
    CAUSE,
    explanations=(explanation((GAS, ZERO), 0.58, 87.0), explanation((WARM, ZERO), 0.42, 86.7)),
    findings=(finding(ZERO), finding(GAS, WARM)),
    next=(Proposal("a thermometer on the cylinder", ("loss of gas", "gas warmer or colder"), 24.2, 0.3),),
)
SEVERAL = replace(
    CAUSE,
    kind="several causes",
    explanations=(explanation((GAS, ZERO), 1.0, 120.4),),
    findings=(finding(GAS), finding(ZERO)),
    rivals=(),
)
UNLISTED = replace(
    NOTHING, kind="unlisted cause", unlisted=Unlisted("joint 2", "motor torque", "angle and direction"), detectable=()
)
BESIDE = replace(CAUSE, kind="unlisted cause", unlisted=Unlisted("tracker", "reading", "place"))
WITHIN = replace(
    UNLISTED,
    explanations=(explanation((ZERO,), 1.0, 96.4),),
    findings=(AmbiguityGroup((PossibleCause(ZERO, 0.5),), 0.5, may_be_unlisted=True),),
)
REMAINDER = replace(CAUSE, unlisted=Unlisted("joint 2", "motor torque", "speed", stands_out=False))
LITTLE = replace(GAS, share=0.11, sigmas=6.2)
LARGE = replace(ZERO, share=0.62, sigmas=4.4)
SURE = replace(MASS, share=0.4, sigmas=9.1)
SMALL = replace(CAUSE, explanations=(explanation((LITTLE,), 0.9997, 94.3),), findings=(finding(LITTLE),))
MESSY = replace(
    SEVERAL,
    explanations=(explanation((LITTLE, LARGE, SURE), 1.0, 120.4),),
    findings=(finding(SURE), finding(LARGE), finding(LITTLE)),
)
ENOUGH = DriveErrors(2, "joint2", "Nm", 368, 1316.4, 65.53, 4.217, 8.604, 3.712, 1.0, is_missed=False)
TOO_LITTLE = DriveErrors(4, "joint4", "Nm", 120, 88.13, 13.42, 1.218, 0.9014, 3.927, 2e-5, is_missed=True)
MISSING = replace(CAUSE, baseline=Baseline("run", 4, (ENOUGH, TOO_LITTLE), repeats=False))
NOT_MISSING = replace(NOTHING, baseline=Baseline("block", 8, (ENOUGH,), repeats=True))
VERDICTS = {
    "nothing": NOTHING,
    "cause": CAUSE,
    "set": A_SET,
    "several": SEVERAL,
    "unlisted": UNLISTED,
    "unlisted beside a listed one": BESIDE,
    "a part of the unlisted one": WITHIN,
    "a remainder": REMAINDER,
    "small": SMALL,
    "messy": MESSY,
    "missing": MISSING,
    "as good as least squares": NOT_MISSING,
}
CURVE = LearnedCurve(
    "", "angle", "rad", "Nm", (-0.5, 0.0, 0.5), (12.0, -3.0, 20.0), (9.0, -6.0, 16.0), (15.0, 0.0, 24.0)
)


def has_shape(verdict: Verdict) -> bool:
    """Whether something unlisted has a shape that stands out."""
    return verdict.unlisted is not None and verdict.unlisted.stands_out


def facts_for(verdict: Verdict) -> Facts:
    """Return facts that suit a verdict."""
    is_found = verdict.kind != "nothing found"
    return Facts(
        data=Data(
            robot="HH-150",
            started="2026-11-02 08:00:00",
            notes=HOSTILE,
            runs=(RunFacts(1, "pose1", "static", 40, 8), RunFacts(2, HOSTILE, "motion", 400, 132)),
            rows=440,
            compared=140,
            readings=280,
        ),
        channels=(
            Channel("current_2_a", "A", 140, 8.31, 0.94 if is_found else None),
            Channel("gas_pressure_pa", "Pa", 140, 0.71, 0.7 if is_found else None),
        ),
        learned=(CURVE,) if has_shape(verdict) else (),
        versions={"bench": "0.1.0", "mujoco": "4.0.0"},
        command=f"bench diagnose {HOSTILE}",
    )
