"""What is said about the methods, and under which protocols of the experiment it is true."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from bench.report.paper.methods.protocols import Protocol
from bench.report.paper.methods.study import ConditionResult
from bench.report.paper.methods.table6 import NeededFriction

RIGHT = 0.02  # median error over the joints of a method that is called right; half the smallest gap of Table 6's rows
WRONG = 0.05  # and of one that is called wrong: what the paper calls a negligible error of the stiffness (section 4.2)
SIDES = {"link side": 1.0, "both sides": 0.5, "motor side": 0.0}  # title -> share of friction on the link side


@dataclass(frozen=True)
class UnderProtocol:
    """Results of one protocol.

    Attributes:
        protocol: Which.
        by_side: Key of `SIDES` -> errors with the robot's own amount of friction there.
        weighted: Friction that Table 6 needs, by the methods with the noise as their weight.
        plain: The same by plain least squares, as the paper identifies.
        ideal: Over amounts and sides of friction, read by ideal instruments.
    """

    protocol: Protocol
    by_side: Mapping[str, ConditionResult]
    weighted: NeededFriction
    plain: NeededFriction
    ideal: Sequence[ConditionResult] = ()

    def off(self, analysis: str, side: str) -> float:
        """Return the median error over the joints."""
        return self.by_side[side].typical(analysis)


def survivals(found: Sequence[UnderProtocol]) -> list[str]:
    """Return each claim with the protocols under which it holds."""
    joints = len(found[0].weighted.level)

    def right(each: UnderProtocol, *where: tuple[str, str]) -> bool:
        return all(each.off(method, side) < RIGHT for method, side in where)

    everywhere = [(method, side) for method in ("current", "force") for side in SIDES]
    claims = {
        "friction on the link side: currents right": [right(e, ("current", "link side")) for e in found],
        "friction on the link side: force wrong": [e.off("force", "link side") > WRONG for e in found],
        "friction on the motor side: force right": [right(e, ("force", "motor side")) for e in found],
        "friction on the motor side, servo gives: currents wrong": [
            e.off("current", "motor side") > WRONG for e in found
        ],
        "joint method right, wherever friction sits": [right(e, *(("joint", side) for side in SIDES)) for e in found],
        "force and currents both right, wherever friction sits": [right(e, *everywhere) for e in found],
        f"link-side friction can give Table 6 in most of {joints} joints": [
            2 * min(e.weighted.by_link, e.plain.by_link) > joints for e in found
        ],
        f"motor-side friction can give Table 6 in most of {joints} joints": [
            2 * max(e.weighted.by_motor.sum(), e.plain.by_motor.sum()) > joints for e in found
        ],
    }
    return [_sentence(claim, holds, found) for claim, holds in claims.items()]


def _sentence(claim: str, holds: Sequence[bool], found: Sequence[UnderProtocol]) -> str:
    if all(holds):
        return f"{claim}: under all {len(found)} protocols."
    if not any(holds):
        return f"{claim}: under none of {len(found)} protocols."
    names = ", ".join(each.protocol.name for each, true in zip(found, holds, strict=True) if true)
    return f"{claim}: under {sum(holds)} of {len(found)} protocols ({names})."


def lab_advice(found: Sequence[UnderProtocol]) -> list[str]:
    """Return what a lab must do so that either method is right, and what is left to do where it was not done."""
    worst = {each.protocol: _worst(each, "force", "current") for each in found}
    best = min(worst, key=lambda protocol: worst[protocol])
    (at_best,) = (each for each in found if each.protocol == best)
    from_first = _worst(at_best, "force, from the first load", "current, from the first load")
    rising = [each for each in found if each.protocol.loads == "rising"]
    others = [each for each in found if each.protocol.loads != "rising"]
    return [
        f"So that forces and currents are both right: {best.title} ({best.name}). The worse of them is then off by "
        f"{100 * worst[best]:.1f} %, wherever friction sits (median over the joints, from rest to rest; the servo "
        "gives): friction slides the way of the load before the unloaded reading and at each load, and cancels.",
        "A servo that holds brings a motor back after each load, and the motor's friction then points the other way "
        "than at the unloaded reading, whatever the approach was. So hold the loads against the first one as well: "
        f"the worse is then off by {100 * from_first:.1f} % from rest to rest; what it is in time, `bench paper "
        "--in-time` says.",
        f"Where that was not done and loads only rose, hold them against the first load: with friction on the link "
        f"side the force method's error goes {_from_first(rising)}. Where loads were taken off it is no help: "
        f"{_from_first(others)}.",
        f"The joint method needs neither: at most {100 * max(_worst(each, 'joint') for each in found):.1f} % off under "
        f"these {len(found)} protocols, wherever friction sits.",
        f"Plain Eq. (25), six components with the measured deflection in the regressor, is off by "
        f"{_range(found, 'force, plain Eq. (25)', 'motor side')} with all friction on the motor side, where forces are "
        f"right; plain Eq. (35), positions alone, by {_range(found, 'force, plain Eq. (35)', 'motor side')}.",
    ]


def _worst(each: UnderProtocol, *methods: str) -> float:
    return max(each.off(method, side) for method in methods for side in SIDES)


def _from_first(found: Sequence[UnderProtocol]) -> str:
    return ", ".join(
        f"{100 * each.off('force', 'link side'):.1f} to "
        f"{100 * each.off('force, from the first load', 'link side'):.1f} % ({each.protocol.name})"
        for each in found
    )


def _range(found: Sequence[UnderProtocol], analysis: str, side: str) -> str:
    off = [100 * each.off(analysis, side) for each in found]
    return f"{min(off):.1f} to {max(off):.1f} %"
