"""Words of the terminal on a page: commands as code, arrows that no line breaks, nothing executed."""

import pytest

from bench.report.html import UNBROKEN_ARROW, as_html


@pytest.mark.parametrize(
    ("words", "shown"),
    [
        ("plain", "plain"),
        ("type `bench compare` & look", "type <code>bench compare</code> &amp; look"),
        ("`<b>` and <b>", "<code>&lt;b&gt;</code> and &lt;b&gt;"),
        ("0.6 -> 0.1 A", f"0.6{UNBROKEN_ARROW}0.1 A"),
        ("a ` alone", "a ` alone"),
    ],
)
def test_words_become_html(words: str, shown: str) -> None:
    assert str(as_html(words)) == shown
