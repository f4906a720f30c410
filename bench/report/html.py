"""Report pages as self-contained HTML, and words of the terminal as they show them."""

import re
from base64 import b64encode
from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from markupsafe import Markup

CODE = re.compile(r"`([^`]+)`")
ARROW = " -> "
Filters = Mapping[str, Callable[..., Any]]
UNBROKEN_ARROW = "\N{NO-BREAK SPACE}\N{RIGHTWARDS ARROW}\N{NO-BREAK SPACE}"


def render(template: str, filters: Filters, **values: object) -> str:
    """Return a page; everything but `Markup` is escaped.

    Args:
        template: Path of its template in this folder.
        filters: Name -> function, which the template applies to values, beside `html` (`as_html`) and `base64`.
        values: By the names that the template has for them.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined

    loader = FileSystemLoader(Path(__file__).parent)
    environment = Environment(
        autoescape=True, undefined=StrictUndefined, trim_blocks=True, lstrip_blocks=True, loader=loader
    )
    environment.filters |= {"html": as_html, "base64": lambda text: b64encode(text.encode()).decode(), **filters}
    return environment.get_template(template).render(**values)


def as_html(words: str) -> "Markup":
    """Return words, escaped, with what stands between backticks as code and arrows on one line with their numbers."""
    from markupsafe import Markup, escape

    parts = CODE.split(words.replace(ARROW, UNBROKEN_ARROW))  # code stands at every second place
    shown = [Markup("<code>{}</code>").format(part) if i % 2 else escape(part) for i, part in enumerate(parts)]
    return Markup("").join(shown)
