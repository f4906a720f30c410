"""The method study as a chapter: which method is right where, under which protocol, and what Table 6 says."""

import json
from collections.abc import Mapping, Sequence
from pathlib import Path

import numpy as np

from bench.executor.contract import Executor, Progress
from bench.report.figures.style import save
from bench.report.jsonable import to_jsonable
from bench.report.paper.chapter import Chapter, ChapterTable
from bench.report.paper.methods.figures import protocol_figure, ratio_figure, trust_figure
from bench.report.paper.methods.protocols import AS_PLANNED, PROTOCOLS
from bench.report.paper.methods.study import (
    ANALYSES,
    AS_THE_PAPER,
    METHODS,
    Condition,
    ConditionResult,
    study_methods,
)
from bench.report.paper.methods.survival import RIGHT, SIDES, UnderProtocol, lab_advice, survivals
from bench.report.paper.methods.table6 import needed_friction
from bench.report.tables import Column, Measured, Row
from bench.robot.bodies import Array
from bench.scenario.loading import Loading

AMOUNTS = (0.0, 0.5, 1.0, 1.5, 2.0)  # of friction, relative to the robot's figures
SHARES = (0.0, 0.25, 0.5, 0.75, 1.0)
SEEDS = 3
OF_FRICTION, OF_PROTOCOLS = 0.45, 0.35  # share of the time, measured
MIXED = Condition(link_share=0.5)
WAYS = {
    "as planned": MIXED,
    "noise of tracker and force sensor threefold": Condition(link_share=0.5, noise=3.0),
    "direction of slanting loads off by 20 mrad": Condition(link_share=0.5, direction_rad=0.02),
}
NUMBERS = "methods.json"


def run_trust(
    scenario: Loading,
    joint_names: tuple[str, ...],
    table6: Mapping[str, Array],
    folder: Path,
    progress: Progress,
    executor: Executor,
) -> tuple[Chapter, list[UnderProtocol]]:
    """Study the methods over friction, ways of measuring and protocols; write numbers and figures into a folder.

    Args:
        scenario: A loading scenario.
        joint_names: Length n.
        table6: "current" and "force" -> published stiffness, shape (n,) [Nm/rad].
        folder: Where to write; exists.
        progress: Called with the share that is done.
        executor: Where to simulate.
    """
    grid = [Condition(friction=amount, link_share=share) for amount in AMOUNTS for share in SHARES]
    results = study_methods(
        scenario, [*grid, *WAYS.values()], SEEDS, lambda done: progress(OF_FRICTION * done), executor
    )
    over_friction, over_ways = results[: len(grid)], dict(zip(WAYS, results[len(grid) :], strict=True))
    published = table6["force"] / table6["current"]
    found = study_protocols(
        scenario, published, lambda done: progress(OF_FRICTION + (1 - OF_FRICTION) * done), executor
    )
    save(trust_figure(over_friction, AS_PLANNED.title), folder / "trust.png")
    shown = [result for result in over_friction if result.condition.link_share in (0.0, 0.5, 1.0)]
    save(ratio_figure(shown, joint_names, {"paper, Table 6": published}, AS_PLANNED.title), folder / "ratio.png")
    save(protocol_figure(found), folder / "protocols.png")
    data = {
        "friction": [_as_json(result) for result in over_friction],
        "ways_of_measuring": {name: _as_json(result) for name, result in over_ways.items()},
        "protocols": {each.protocol.name: _protocol_as_json(each) for each in found},
        "table6_ratio": to_jsonable(published),
    }
    (folder / NUMBERS).write_text(json.dumps(data, indent=1) + "\n", encoding="utf-8")
    sentences = (
        f"Protocol of what follows, where none is named: {AS_PLANNED.title}.",
        *_trust(over_friction),
        *_ways(over_ways),
        "",
        "Protocols: " + "; ".join(f"{p.name}: {p.title}" for p in PROTOCOLS) + ".",
        "From below means that joint angles rise.",
        *survivals(found),
        *lab_advice(found),
    )
    chapter = Chapter(
        name="methods",
        title="Which method to trust: friction, its side, the protocol of the experiment",
        rows=(),
        sentences=sentences,
        data=data,
        tables=_tables(found, joint_names, published),
    )
    return chapter, found


def study_protocols(scenario: Loading, published: Array, progress: Progress, executor: Executor) -> list[UnderProtocol]:
    """Run the loading experiment under every protocol.

    Args:
        scenario: A loading scenario.
        published: Shape (n,), force over current in Table 6.
        progress: Called with the share that is done.
        executor: Where to simulate.
    """
    sides = [
        Condition(link_share=share, protocol=protocol, orientation=True)
        for protocol in PROTOCOLS
        for share in SIDES.values()
    ]
    ideal = [
        Condition(friction=amount, link_share=share, protocol=protocol)
        for protocol in PROTOCOLS
        for amount in AMOUNTS
        for share in SIDES.values()
    ]
    by_side = study_methods(scenario, sides, SEEDS, lambda done: progress(OF_PROTOCOLS * done), executor, ANALYSES)
    compared = {name: METHODS[name] for name in ("current", "force")} | AS_THE_PAPER
    lines = study_methods(
        scenario, ideal, 0, lambda done: progress(OF_PROTOCOLS + (1 - OF_PROTOCOLS) * done), executor, compared
    )
    plain_current, plain_force = AS_THE_PAPER
    found = []
    for i, protocol in enumerate(PROTOCOLS):
        line = [result for result in lines if result.condition.protocol == protocol]
        found.append(
            UnderProtocol(
                protocol,
                dict(zip(SIDES, by_side[len(SIDES) * i : len(SIDES) * (i + 1)], strict=True)),
                needed_friction(line, published, "force", "current"),
                needed_friction(line, published, plain_force, plain_current),
                line,
            )
        )
    return found


def _trust(results: list[ConditionResult]) -> list[str]:
    sentences = []
    for method in METHODS:
        worst = max(results, key=lambda result: result.typical(method))
        good = np.mean([result.typical(method) < RIGHT for result in results])
        sentences.append(
            f"{method} method: within {100 * RIGHT:.0f} % (median over the joints) in {100 * good:.0f} % of "
            f"{len(results)} combinations of amount and side of friction; at worst {100 * worst.typical(method):.1f} % "
            f"off, with {100 * worst.condition.link_share:.0f} % of {worst.condition.friction:g} times the friction on "
            "the link side."
        )
    return sentences


def _ways(results: Mapping[str, ConditionResult]) -> list[str]:
    sentences = []
    for name, result in results.items():
        listed = ", ".join(
            f"{method} {100 * result.typical(method):.1f} ± {100 * float(np.nanmedian(result.spread(method))):.1f} %"
            for method in METHODS
        )
        sentences.append(f"Friction shared evenly, {name}: {listed} (bias and spread, medians over the joints).")
    return sentences


def _tables(found: Sequence[UnderProtocol], joint_names: Sequence[str], published: Array) -> tuple[ChapterTable, ...]:
    sides = ChapterTable(
        "Median error of the stiffness by protocol and by the side of friction; the servo gives",
        [Column(f"{method}, {side}", "%", 1) for side in SIDES for method in METHODS],
        [
            Row(
                each.protocol.name,
                tuple(Measured(100 * each.off(method, side)) for side in SIDES for method in METHODS),
            )
            for each in found
        ],
    )
    others = [name for name in ANALYSES if name not in METHODS]
    plain = ChapterTable(
        "The same by plain least squares, and from the first load on; friction on the link side",
        [Column(name, "%", 1) for name in others],
        [
            Row(each.protocol.name, tuple(Measured(100 * each.off(name, "link side")) for name in others))
            for each in found
        ],
    )
    listed = ", ".join(f"{value:.2f}" for value in published)
    needed = ChapterTable(
        f"Friction on the link side, relative to the robot's figures, that gives Table 6 (force over current {listed})",
        [Column(name, "", 2) for name in joint_names] + [Column("motor side alone", "joints", 0)],
        [
            Row(
                f"{each.protocol.name}, {weights}",
                (*(Measured(level) for level in of.level), Measured(float(of.by_motor.sum()))),
            )
            for each in found
            for weights, of in (("weighted", each.weighted), ("plain", each.plain))
        ],
    )
    return sides, plain, needed


def _protocol_as_json(each: UnderProtocol) -> dict[str, object]:
    return {
        "title": each.protocol.title,
        "sides": {side: _as_json(result) for side, result in each.by_side.items()},
        "link_side_friction_of_table_6": {
            "weighted": to_jsonable(each.weighted.level),
            "plain": to_jsonable(each.plain.level),
        },
    }


def _as_json(result: ConditionResult) -> dict[str, object]:
    condition = result.condition
    return {
        "friction": condition.friction,
        "link_share": condition.link_share,
        "noise": condition.noise,
        "direction_rad": condition.direction_rad,
        "protocol": condition.protocol.name,
        "servo": condition.servo,
        "bias": {name: to_jsonable(result.bias(name)) for name in result.error},
        "spread": {name: to_jsonable(result.spread(name)) for name in result.error},
        "force_over_current": to_jsonable(result.ratio()),
    }
