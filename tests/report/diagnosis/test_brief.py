"""What of a verdict the terminal shows: what decides, and where the rest stands."""

from dataclasses import replace

from bench.diagnose.verdict import RecordingGain
from bench.report.diagnosis.words import MOST_MOVED, MOST_REFUSED, brief_words, words_of
from tests.report.diagnosis.made import MASS, NO_GAIN, NOTHING, VERDICTS


def test_the_terminal_shows_what_each_finding_is_worth_beside_it() -> None:
    first = VERDICTS["cause"].steps[0]
    steps = (first, replace(first, added=(MASS,), log_evidence=7.0, channels=(NO_GAIN,)))
    both = replace(VERDICTS["cause"], steps=steps)
    lines = list(brief_words(both))
    (at,) = (
        i for i, line in enumerate(lines) if line.endswith("without it -> with it: motor current 2 0.612 -> 0.081 A")
    )
    assert lines[at - 1].lstrip().startswith("lost 0.133"), "below the size of the finding"
    assert not any("held out +81" in line for line in lines)
    assert not any(line.startswith("Not looked for") for line in lines)
    assert lines[-1].startswith("More in verdict.txt and on the page: what each finding is worth; ")
    assert len(" ".join(lines).split()) < len(" ".join(words_of(both)).split())


def test_the_terminal_shows_the_first_of_many_figures_that_moved() -> None:
    moved = [f"stiffness of joint{i}: +50 %" for i in range(1, MOST_MOVED + 3)]
    lines = list(brief_words(NOTHING, moved))
    assert [line for line in lines if line in moved] == moved[:MOST_MOVED]
    assert "2 more" in lines
    assert [line for line in words_of(NOTHING, moved) if line in moved] == moved
    assert "figures that moved" not in list(brief_words(NOTHING, moved[:2]))[-1]


def test_the_terminal_says_which_recordings_confirm_a_finding() -> None:
    """Only verdict.txt did, since the terminal was made short."""
    first = VERDICTS["cause"].steps[0]
    known = (RecordingGain("may", 30.0), RecordingGain("june", 12.0))
    steps = (replace(first, recordings=known), replace(first, added=(MASS,), channels=(NO_GAIN,)))
    lines = list(brief_words(replace(VERDICTS["cause"], steps=steps)))
    assert any(line.endswith("; confirmed by 2 of 2 recordings (may +30, june +12)") for line in lines)
    alone = replace(VERDICTS["cause"], steps=steps[:1])
    assert "confirmed by 2 of 2 recordings (may +30, june +12)" in [line.strip() for line in brief_words(alone)]
    assert "Confirmed by 2 of 2 recordings (may +30, june +12)." in list(words_of(alone))


def test_the_terminal_says_what_was_refused() -> None:
    taken, refused = VERDICTS["cause"].steps[0], next(one for one in VERDICTS["cause"].steps if not one.accepted)
    several = [replace(refused, reason=f"reason {k}") for k in range(MOST_REFUSED + 2)]
    lines = list(brief_words(replace(VERDICTS["cause"], steps=(taken, *several))))
    assert sum(line.startswith("Refused: mass of a link") for line in lines) == MOST_REFUSED
    assert lines[lines.index("What was refused") + MOST_REFUSED + 1] == "2 more"
    assert "what was refused" in lines[-1]


def test_where_nothing_was_found_no_heading_says_what_was() -> None:
    assert "How sure that is" in list(brief_words(NOTHING))
    assert not any(line.startswith("What was found") for line in words_of(NOTHING))
