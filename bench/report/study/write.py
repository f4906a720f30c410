"""The files of a study."""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from bench.report.files import replacing
from bench.report.jsonable import to_jsonable
from bench.report.study.page import page_of
from bench.study.goals import Goal
from bench.study.outcome import Outcome
from bench.study.score import marks_of
from bench.study.scores import Scores
from bench.study.study import Settings

RESULTS, PAGE = "study.json", "study.html"


def write_study(outcomes: Sequence[Outcome], scores: Scores, settings: Settings, session: str, folder: Path) -> None:
    """Write study.json, with every campaign as a row, and study.html into an existing folder.

    Args:
        outcomes: Every campaign.
        scores: The numbers.
        settings: Of the study.
        session: What was done in each campaign, in words.
        folder: Where to write.
    """
    content = {
        "format": 1,
        "settings": asdict(settings),
        "goals": [_goal(goal) for goal in scores.goals],
        "probabilities": [asdict(one) for one in scores.bins],
        "effects": [asdict(one) for one in scores.effects],
        "worlds": {world: [_goal(goal) for goal in goals] for world, goals in scores.worlds},
        "ranks": [asdict(one) for one in scores.ranks],
        "margin": asdict(scores.margin) if scores.margin else None,
        "campaigns": [_campaign(one) for one in outcomes],
    }
    with replacing(folder / RESULTS) as file:
        file.write_text(json.dumps(to_jsonable(content), indent=1) + "\n", encoding="utf-8")
    with replacing(folder / PAGE) as file:
        file.write_text(page_of(scores, settings, len(outcomes), session), encoding="utf-8")


def _campaign(outcome: Outcome) -> dict[str, Any]:
    marks = marks_of(outcome)
    row: dict[str, Any] = json.loads(outcome.as_json())
    return row | {"marks": asdict(marks) | {"covered": marks.covered}}


def _goal(goal: Goal) -> dict[str, Any]:
    return asdict(goal) | {
        "measured": asdict(goal.measured) | {"share_or_mean": goal.measured.value, "interval": goal.measured.interval}
    }
