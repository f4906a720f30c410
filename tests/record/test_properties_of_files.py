"""Whatever stands in a manifest, a log format, figures or a table of a stranger is refused, or it is sound."""

from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np
import yaml
from hypothesis import given, settings
from hypothesis import strategies as st

from bench.errors import CampaignError, InputError, RobotError
from bench.record.check import check_campaign
from bench.record.convert import convert
from bench.record.log_format import LogFormat, read_log_format
from bench.record.yaml_text import YamlFault, dump_yaml, in_quotes, load_typed_yaml, load_yaml
from bench.robot.figures import Figures
from bench.robot.folder import load_robot
from tests.record.build import motion, sweep, write_folder
from tests.small_robot import FIGURES, write_small_robot

EXAMPLES = settings(max_examples=80)
words = st.text(st.characters(codec="utf-8"), max_size=20)
scalars = (
    st.none()
    | st.booleans()
    | st.integers()
    | st.floats()
    | words
    | st.dates()
    | st.sampled_from(["", "1e3", "no", "~"])
)
values = st.recursive(
    scalars, lambda inner: st.lists(inner, max_size=3) | st.dictionaries(words, inner, max_size=3), max_leaves=6
)
SYNTAX = st.text(st.sampled_from("ab:-[]{}&*!|>'\"%@`#,?~ \n\t\0\x85\ufeff01.é"), max_size=60)


def named(problems: tuple[str, ...]) -> None:
    assert problems
    assert all(problems)


def changed(draw: st.DrawFn, content: Any) -> Any:
    """Put something else into one place of a tree of lists and mappings."""
    if isinstance(content, dict) and content and draw(st.integers(0, 3)):
        key = draw(st.sampled_from(sorted(content)))
        return content | {key: changed(draw, content[key])}
    if isinstance(content, list) and content and draw(st.integers(0, 3)):
        i = draw(st.integers(0, len(content) - 1))
        return [*content[:i], changed(draw, content[i]), *content[i + 1 :]]
    if isinstance(content, dict) and draw(st.booleans()):
        return content | {draw(words): draw(values)}
    return draw(values)


@st.composite
def manifests(draw: st.DrawFn) -> Any:
    run = {"name": "a", "kind": "motion", "start_s": 0.0, "recording": "x", "note": "y", "file": "runs/a.csv"}
    whole = {
        "format": 1,
        "robot": "small",
        "noise": {"current": 0.1},
        "notes": "",
        "started": "2024-05-13",
        "runs": [run],
    }
    return changed(draw, whole)


@st.composite
def log_formats(draw: st.DrawFn) -> Any:
    columns = {"time_s": {"from": "t"}, "q_cmd_1_rad": {"from": "q", "factor": 2.0, "offset": 1.0, "optional": True}}
    return changed(draw, {"kind": "motion", "columns": columns, "noise": {"current": 0.1}, "notes": "x"})


@st.composite
def figures(draw: st.DrawFn) -> Any:
    return changed(draw, FIGURES | {"uncertainty": {"mass": 0.1}, "reflectors": ["nest_1"]})


@EXAMPLES
@given(content=manifests())
def test_a_manifest_is_refused_at_a_place_or_sound(content: Any) -> None:
    with TemporaryDirectory() as place:
        folder = write_folder(Path(place) / "campaign", motion(sweep()))
        (folder / "campaign.yaml").write_text(yaml.safe_dump(content, allow_unicode=True), encoding="utf-8")
        report = check_campaign(folder)
    assert (report.campaign is None) == bool(report.errors)
    assert all(error.message and error.remedy for error in report.errors)
    if report.campaign is not None:
        assert all(np.isfinite(run.start_s) for run in report.campaign.runs)
        assert all(0 < sigma < np.inf for sigma in report.campaign.noise.values())


@EXAMPLES
@given(content=log_formats())
def test_a_log_format_is_refused_or_converts(content: Any) -> None:
    with TemporaryDirectory() as place:
        file, log = Path(place) / "log.yaml", Path(place) / "log.csv"
        file.write_text(yaml.safe_dump(content, allow_unicode=True), encoding="utf-8")
        log.write_text("t,q\n0,0.1\n0.1,0.2\n")
        try:
            layout = read_log_format(file)
            assert isinstance(layout, LogFormat)
            converted = convert(log, layout, "small")
        except (InputError, CampaignError) as error:
            named(error.problems)
            return
    for run in converted.campaign.runs:
        assert all(np.all(np.isfinite(column)) for column in run.columns.values())


@EXAMPLES
@given(content=figures())
def test_figures_are_refused_or_sound(content: Any) -> None:
    with TemporaryDirectory() as place:
        folder = write_small_robot(Path(place) / "robot")
        (folder / "figures.yaml").write_text(yaml.safe_dump(content, allow_unicode=True), encoding="utf-8")
        try:
            robot = load_robot(folder)
        except RobotError as error:
            named(error.problems)
            return
    assert Figures.model_validate(robot.figures.model_dump()) == robot.figures


@EXAMPLES
@given(text=SYNTAX)
def test_any_text_is_yaml_or_a_fault(text: str) -> None:
    with TemporaryDirectory() as place:
        file = Path(place) / "a.yaml"
        file.write_text(text, encoding="utf-8")
        for load in (load_yaml, load_typed_yaml):
            try:
                assert isinstance(load(file), dict)
            except YamlFault as fault:
                named((str(fault), fault.remedy))


@EXAMPLES
@given(content=st.dictionaries(words.filter(str.strip), st.lists(words | st.floats(allow_nan=False), max_size=3)))
def test_what_is_written_is_read(content: dict[str, object]) -> None:
    with TemporaryDirectory() as place:
        file = Path(place) / "a.yaml"
        file.write_text(dump_yaml(content), encoding="utf-8")
        assert load_typed_yaml(file) == content


@EXAMPLES
@given(text=st.text(st.sampled_from("0123456789.,-+eE;\n\r\t \"'nai_xq"), max_size=120))
def test_any_table_is_refused_or_numbers(text: str) -> None:
    with TemporaryDirectory() as place:
        folder = write_folder(Path(place) / "campaign", motion(sweep()))
        (folder / "runs" / "a.csv").write_text(
            "time_s,q_cmd_1_rad,q_motor_1_rad\n" + text, encoding="utf-8", newline=""
        )
        report = check_campaign(folder)
    if report.campaign is not None:
        for column in report.campaign.runs[0].columns.values():
            assert np.all(np.isfinite(column))


@EXAMPLES
@given(word=st.text(max_size=40))
def test_a_text_in_quotes_is_read_as_it_was(word: str) -> None:
    """JSON has characters beyond the basic plane as halves of pairs, which no YAML may hold."""
    line = in_quotes(word)
    assert len(line.splitlines()) == 1
    with TemporaryDirectory() as folder:
        (file := Path(folder) / "a.yaml").write_text(f"a: {line}\n", encoding="utf-8")
        assert load_yaml(file) == {"a": word}
