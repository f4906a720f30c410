"""Comparisons to be shown."""

from dataclasses import replace

from bench.compare.comparison import (
    Change,
    ChangedFinding,
    ChangedSize,
    ChannelNoise,
    Compared,
    Comparison,
    Component,
    Explanation,
    Interval,
    PossibleName,
    UnlistedChange,
)

NAN = float("nan")
GAS = Change(
    "gas_loss",
    "loss of gas",
    "robot",
    "machine",
    (ChangedSize("lost", "", "share", Interval(0.0124, 0.0112, 0.0136)),),
    {},
    "step",
    "june",
)
COLD = replace(
    GAS,
    effect="gas_temperature",
    title="gas warmer or colder than nominal",
    sizes=(ChangedSize("offset", "K", "of the gas", Interval(-3.6, -4.0, -3.2)),),
)
WEEKLY = replace(
    GAS,
    course="trend",
    sizes=(ChangedSize("lost", "", "share", Interval(0.024, 0.022, 0.026), Interval(0.006, 0.0055, 0.0065)),),
)
NOTHING = Comparison(
    recordings=(
        Compared("may", False, None, NAN, 90, 0.98),
        Compared("june", True, None, NAN, 90, 0.97),
    ),
    false_alarm_rate=0.01,
    threshold=5.2,
    probability_unchanged=0.9,
    explanations=(),
    findings=(),
    unlisted=None,
    components=(
        Component(
            "gas_loss", "loss of gas", "robot", "lost", "", (Interval(0.001, -0.001, 0.003),), 0.003, 0.003, 0.3, False
        ),
        Component(
            "ripple", "ripple of joint 2", "joint 2", "sin", "Nm", (Interval(1.0, -9.0, 11.0),), 12.0, 18.0, 5.0, False
        ),
    ),
    noise=(ChannelNoise("current_2_a", True, 1.0, 0.4, 64),),
)


POURED = replace(
    GAS,
    effect="gas_step",
    title="gas lost or filled in from run first-joint2-payload0-speed40-up on",
    place="robot from run first-joint2-payload0-speed40-up on",
    level="run",
)


def finding(*changes: Change) -> ChangedFinding:
    names = tuple(PossibleName(one.effect, one.title, one.place, 0.9 / len(changes)) for one in changes)
    return ChangedFinding(names, 0.9)


ONE = replace(
    NOTHING, explanations=(Explanation((GAS,), 0.993, 40.0),), findings=(finding(GAS),), probability_unchanged=1e-9
)
SET = replace(
    NOTHING,
    explanations=(Explanation((GAS,), 0.6, 40.0), Explanation((COLD,), 0.39, 39.5)),
    findings=(finding(GAS, COLD),),
)
MORE = replace(
    SET,
    explanations=(*SET.explanations, Explanation((POURED,), 0.03, 37.0)),
    findings=(finding(COLD, GAS, POURED),),
)
FRICTION = tuple(
    replace(GAS, effect=f"friction_{k}", title=f"friction of joint {k}, long name {k}", place=f"joint {k}")
    for k in range(5)
)
TWO = replace(
    NOTHING,
    explanations=tuple(Explanation((gas, friction), 0.1, 40.0) for gas in (GAS, COLD) for friction in FRICTION),
    findings=(finding(*FRICTION), finding(GAS, COLD)),
)
OTHER = replace(SET, explanations=(*SET.explanations, Explanation(FRICTION[:2], 0.01, 36.0)))
UNLISTED = replace(NOTHING, unlisted=UnlistedChange("", "joint 2", "link torque", "angle", "step", "june", 31.0))
THREE = replace(
    ONE,
    recordings=(
        replace(NOTHING.recordings[0], started="2024-05-01T00:00:00", days=0.0),
        *(Compared(f"day{k}", True, f"2024-05-{7 * k:02}T00:00:00", 7.0 * k, 90, 0.9) for k in (1, 2, 3, 4)),
    ),
    explanations=(Explanation((WEEKLY,), 0.95, 60.0),),
    components=tuple(
        replace(one, values=tuple(Interval(k * 0.006, k * 0.006 - 0.001, k * 0.006 + 0.001) for k in (1, 2, 3, 4)))
        for one in NOTHING.components
    ),
)
