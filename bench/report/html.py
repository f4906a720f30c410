"""Words of the terminal as a page shows them."""

import re
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from markupsafe import Markup

CODE = re.compile(r"`([^`]+)`")
ARROW = " -> "
UNBROKEN_ARROW = "\N{NO-BREAK SPACE}\N{RIGHTWARDS ARROW}\N{NO-BREAK SPACE}"


def as_html(words: str) -> "Markup":
    """Return words, escaped, with what stands between backticks as code and arrows on one line with their numbers."""
    from markupsafe import Markup, escape

    parts = CODE.split(words.replace(ARROW, UNBROKEN_ARROW))  # code stands at every second place
    shown = [Markup("<code>{}</code>").format(part) if i % 2 else escape(part) for i, part in enumerate(parts)]
    return Markup("").join(shown)
