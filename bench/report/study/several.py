"""The study of several recordings in words and numbers."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

from bench.study.several import SeveralOutcome, SeveralSettings
from bench.study.several_scores import SeveralGoal

NUMBERS = "several.json"


def lines_of(goals: Sequence[SeveralGoal]) -> Iterator[str]:
    """Yield one line for each number."""
    for goal in goals:
        met = {True: "met", False: "missed", None: ""}[goal.is_met]
        aim = f" (goal: {goal.goal})" if goal.goal else ""
        yield f"{met:8}{goal.name}: {measured(goal)}{aim}"


def measured(goal: SeveralGoal) -> str:
    """Return a share in words, with its 95 % interval."""
    share = goal.share
    if not share.of:
        return "not tried"
    low, high = (100 * end for end in share.interval)
    return f"{share.hits} of {share.of} [{low:.1f} to {high:.1f} %]"


def write_several(
    goals: Sequence[SeveralGoal], outcomes: Sequence[SeveralOutcome], settings: SeveralSettings, folder: Path
) -> Path:
    """Write all numbers of a study into its folder, and return the file."""
    content = {
        "format": 1,
        "settings": asdict(settings),
        "goals": [
            {"name": goal.name, "goal": goal.goal, "hits": goal.share.hits, "of": goal.share.of, "is_met": goal.is_met}
            for goal in goals
        ],
        "machines": [json.loads(one.as_json()) for one in outcomes],
    }
    file = folder / NUMBERS
    file.write_text(json.dumps(content, indent=1) + "\n", encoding="utf-8")
    return file
