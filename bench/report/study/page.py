"""The page of a study, one self-contained HTML file."""

from base64 import b64encode
from importlib.resources import files

from bench.report.figures.style import svg_of
from bench.report.study.figures import calibration_figure
from bench.report.study.words import margin_words, measured_words, met_words, share_words
from bench.study.scores import Scores
from bench.study.study import Settings

TEMPLATE = "page.html.j2"
MOST_MISSES = 200  # on the page; study.json has them all


def page_of(scores: Scores, settings: Settings, n_campaigns: int, session: str) -> str:
    """Return the page.

    Args:
        scores: The numbers.
        settings: Of the study.
        n_campaigns: How many were diagnosed.
        session: What was done in each, in words.
    """
    from jinja2 import Environment, StrictUndefined

    environment = Environment(autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True)
    environment.filters |= {"measured": measured_words, "met": met_words, "share": share_words, "margin": margin_words}
    source = files("bench.report.study").joinpath(TEMPLATE).read_text(encoding="utf-8")
    picture = b64encode(svg_of(calibration_figure(scores.bins), "study").encode()).decode() if scores.bins else ""
    return environment.from_string(source).render(
        scores=scores,
        settings=settings,
        n_campaigns=n_campaigns,
        session=session,
        picture=picture,
        misses=scores.misses[:MOST_MISSES],
        n_misses=len(scores.misses),
    )
