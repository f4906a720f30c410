"""The method study as a chapter: which method is right where, and what Table 6 says about friction."""

import json
from collections.abc import Mapping
from pathlib import Path

import numpy as np

from bench.executor.contract import Executor, Progress
from bench.report.figures.style import save
from bench.report.jsonable import to_jsonable
from bench.report.paper.chapter import Chapter
from bench.report.paper.methods.figures import ratio_figure, trust_figure
from bench.report.paper.methods.study import STUDIED, Condition, ConditionResult, study_methods
from bench.robot.bodies import Array
from bench.scenario.loading import Loading

AMOUNTS = (0.0, 0.25, 0.5, 1.0, 1.5, 2.0)  # of friction, relative to the robot's figures
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
SEEDS = 6
MIXED = Condition(link_share=0.5)
WAYS = {
    "as planned": MIXED,
    "noise of tracker and force sensor threefold": Condition(link_share=0.5, noise=3.0),
    "direction of slanting loads off by 20 mrad": Condition(link_share=0.5, direction_rad=0.02),
    "poses approached from below only": Condition(link_share=0.5, approach=(1,)),
    "loads only put on, not taken off": Condition(link_share=0.5, unload=False),
    "both of these": Condition(link_share=0.5, approach=(1,), unload=False),
}
NUMBERS = "methods.json"


def run_trust(
    scenario: Loading,
    joint_names: tuple[str, ...],
    table6: Mapping[str, Array],
    folder: Path,
    progress: Progress,
    executor: Executor,
) -> Chapter:
    """Study the methods over friction and ways of measuring; write numbers and figures into an existing folder.

    Args:
        scenario: A loading scenario.
        joint_names: Length n.
        table6: "current" and "force" -> published stiffness, shape (n,) [Nm/rad].
        folder: Where to write.
        progress: Called with the share that is done.
        executor: Where to simulate.
    """
    grid = [Condition(friction=amount, link_share=share) for amount in AMOUNTS for share in SHARES]
    results = study_methods(scenario, [*grid, *WAYS.values()], SEEDS, progress, executor)
    over_friction, over_ways = results[: len(grid)], dict(zip(WAYS, results[len(grid) :], strict=True))
    published = table6["force"] / table6["current"]
    save(trust_figure(over_friction), folder / "trust.png")
    shown = [result for result in over_friction if result.condition.link_share in (0.0, 0.5, 1.0)]
    save(ratio_figure(shown, joint_names, {"paper, Table 6": published}), folder / "ratio.png")
    data = {
        "friction": [_as_json(result) for result in over_friction],
        "ways_of_measuring": {name: _as_json(result) for name, result in over_ways.items()},
        "table6_ratio": to_jsonable(published),
    }
    (folder / NUMBERS).write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    of_the_paper = _friction_of_the_paper(over_friction, joint_names, published)
    sentences = (*_trust(over_friction), *_ways(over_ways), of_the_paper)
    return Chapter("methods", "Which method to trust: friction, its side, the way of measuring", (), sentences, data)


def _trust(results: list[ConditionResult]) -> list[str]:
    sentences = []
    for method in STUDIED:
        worst = max(results, key=lambda result: _typical(result, method))
        good = np.mean([_typical(result, method) < 0.02 for result in results])
        sentences.append(
            f"{method} method: within 2 % (median over the joints) in {100 * good:.0f} % of {len(results)} "
            f"combinations of amount and side of friction; at worst {100 * _typical(worst, method):.1f} % off, with "
            f"{100 * worst.condition.link_share:.0f} % of {worst.condition.friction:g} times the friction on the link "
            "side."
        )
    return sentences


def _ways(results: Mapping[str, ConditionResult]) -> list[str]:
    sentences = []
    for name, result in results.items():
        listed = ", ".join(
            f"{method} {100 * _typical(result, method):.1f} ± {100 * float(np.nanmedian(result.spread(method))):.1f} %"
            for method in STUDIED
        )
        sentences.append(f"Friction shared evenly, {name}: {listed} (bias and spread, medians over the joints).")
    return sentences


def _friction_of_the_paper(results: list[ConditionResult], joint_names: tuple[str, ...], published: Array) -> str:
    """Return which side of friction can give the published ratios of the two methods, and how much of it that takes."""
    amount, link = _ratio_over_friction(results, 1.0)
    _, motor = _ratio_over_friction(results, 0.0)
    needed = []
    for j, name in enumerate(joint_names):
        known = np.isfinite(link[:, j])
        rising = np.maximum.accumulate(link[known, j])
        within = rising[0] <= published[j] <= rising[-1]
        level = np.interp(published[j], rising, amount[known])
        needed.append(f"{name} {level:.1f}" if within else f"{name} not up to {amount[known][-1]:g}")
    by_link, by_motor = (
        np.sum((np.nanmin(ratio, axis=0) <= published) & (published <= np.nanmax(ratio, axis=0)))
        for ratio in (link, motor)
    )
    listed = ", ".join(f"{value:.2f}" for value in published)
    return (
        f"Table 6 has force over current at {listed}. Up to twice the friction assumed can give that, on the link "
        f"side alone in {by_link} of {len(published)} joints, on the motor side alone in {by_motor}. Level needed "
        f"on the link side, relative to the one assumed: {', '.join(needed)}."
    )


def _ratio_over_friction(results: list[ConditionResult], share: float) -> tuple[Array, Array]:
    line = sorted((r for r in results if r.condition.link_share == share), key=lambda r: r.condition.friction)
    return np.array([r.condition.friction for r in line]), np.stack([r.ratio() for r in line])


def _typical(result: ConditionResult, method: str) -> float:
    return float(np.nanmedian(np.abs(result.bias(method))))


def _as_json(result: ConditionResult) -> dict[str, object]:
    condition = result.condition
    return {
        "friction": condition.friction,
        "link_share": condition.link_share,
        "noise": condition.noise,
        "direction_rad": condition.direction_rad,
        "approach": list(condition.approach),
        "unload": condition.unload,
        "servo": condition.servo,
        "bias": {method: to_jsonable(result.bias(method)) for method in STUDIED},
        "spread": {method: to_jsonable(result.spread(method)) for method in STUDIED},
        "force_over_current": to_jsonable(result.ratio()),
    }
