"""The page of a study, one self-contained HTML file."""

from bench.report.figures.style import svg_of
from bench.report.html import Filters, render
from bench.report.study.figures import calibration_figure
from bench.report.study.words import margin_words, measured_words, met_words, share_words
from bench.study.scores import Scores
from bench.study.study import Settings

TEMPLATE = "study/page.html.j2"
FILTERS: Filters = {"measured": measured_words, "met": met_words, "share": share_words, "margin": margin_words}
MOST_MISSES = 200  # on the page; study.json has them all


def page_of(scores: Scores, settings: Settings, n_campaigns: int, session: str) -> str:
    """Return the page.

    Args:
        scores: The numbers.
        settings: Of the study.
        n_campaigns: How many were diagnosed.
        session: What was done in each, in words.
    """
    return render(
        TEMPLATE,
        FILTERS,
        scores=scores,
        settings=settings,
        n_campaigns=n_campaigns,
        session=session,
        picture=svg_of(calibration_figure(scores.bins), "study") if scores.bins else "",
        misses=scores.misses[:MOST_MISSES],
        n_misses=len(scores.misses),
    )
