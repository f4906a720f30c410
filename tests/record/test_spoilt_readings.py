"""Readings that were lost, copied from another run, or that no instrument gives."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from bench.errors import MOST_OF_NAME, InputError, printable
from bench.record.campaign import Array
from bench.record.check import check_campaign, examine_all
from bench.record.finding import Finding
from bench.record.rules.repeated_runs import no_campaign_twice
from bench.record.rules.sheet import Sheet
from tests.record.build import examine, loading, motion, only, session, static, sweep, write_folder

ROW = 700


def spoilt(column: str, value: float, rows: slice | list[int]) -> list[Finding]:
    columns = {name: values.copy() for name, values in sweep().items()}
    columns[column][rows] = value
    return [finding for finding in examine(motion(columns)) if finding.column == column]


@pytest.mark.parametrize(
    ("column", "value"),
    [("current_2_a", 60.0), ("reflector_1_x_m", 5.0), ("gas_pressure_pa", 1e8), ("q_motor_2_rad", 2.0)],
)
def test_a_reading_that_stands_alone_is_told(column: str, value: float) -> None:
    finding = only(spoilt(column, value, [ROW]))
    assert (finding.level, finding.row) == ("warning", ROW + 1)
    assert f"reads {value:.6g} between" in finding.message


@pytest.mark.parametrize(("column", "value"), [("reflector_1_x_m", 0.0), ("current_2_a", 90.0), ("force_z_n", 5e3)])
def test_a_repeat_far_from_the_others_is_told(column: str, value: float) -> None:
    columns = loading()
    assert not examine(static(columns))
    columns[column][40] = value
    finding = only([finding for finding in examine(static(columns)) if "repeats" in finding.message])
    assert (finding.level, finding.column, finding.row) == ("warning", column, 41)


@pytest.mark.parametrize(
    ("rows", "guesses"),
    [([400, ROW], (True, False)), (slice(400, 420), (True, True)), (slice(0, 1900), (False, True))],
)
def test_a_few_angles_beyond_all_joints_are_lost_and_most_of_them_degrees(
    rows: slice | list[int], guesses: tuple[bool, bool]
) -> None:
    finding = only(spoilt("q_motor_2_rad", 100.0, rows))
    assert finding.level == "error"
    assert ("lost or spoilt?" in finding.remedy, "degrees?" in finding.remedy) == guesses


def test_where_every_reading_is_far_from_the_next_none_stands_alone() -> None:
    """A poisoner's log of zeros and ones in turn ended in a traceback."""
    columns = {name: values.copy() for name, values in sweep().items()}
    columns["current_2_a"][:] = np.arange(len(columns["time_s"])) % 2
    assert not [finding for finding in examine(motion(columns)) if "between" in finding.message]


@pytest.mark.parametrize(("filled", "is_told"), [(slice(600, 900), True), (slice(600, 610), False)])
def test_a_line_that_was_drawn_over_a_gap_is_told(filled: slice, is_told: bool) -> None:
    """A poisoner drew one over three seconds of each run; ten rows are no more than chance makes of coarse readings."""
    columns = {name: values.copy() for name, values in sweep().items()}
    assert not examine(motion(columns))
    for name, values in columns.items():
        if name != "time_s":
            values[filled] = np.linspace(values[filled][0], values[filled][-1], len(values[filled]))
    found = [finding for finding in examine(motion(columns)) if "straight line" in finding.message]
    assert bool(found) == is_told
    if is_told:
        assert only(found).level == "warning"
        assert only(found).row == 602


@pytest.mark.parametrize("freedom", [4.0, np.inf])
def test_tails_of_noise_are_no_spoilt_repeats(freedom: float) -> None:
    rng = np.random.default_rng(5)
    for repeats in (2, 3, 10):
        rows = np.repeat(np.arange(8.0), repeats)
        columns = {"pose": 0 * rows + 1, "approach": 0 * rows + 1, "load_step": rows}
        columns |= {f"current_{joint}_a": rng.standard_t(freedom, len(rows)) for joint in range(1, 300)}
        assert not [finding for finding in examine(static(columns)) if "repeats" in finding.message]


def test_lost_readings_of_one_number_are_told_though_small() -> None:
    rows = [300, 700, 1500]
    finding = only(spoilt("tau_motor_2_nm", 700.0, rows))
    assert finding.row == rows[0] + 1
    assert "rows 301, 701 and 1501" in finding.message


@pytest.mark.parametrize("freedom", [4.0, 6.0, np.inf])
def test_tails_of_noise_are_no_spikes(freedom: float) -> None:
    rng = np.random.default_rng(3)
    for rows in (50, 300, 3000):
        columns = {"time_s": np.arange(rows) * 0.01}
        columns |= {f"current_{joint}_a": rng.standard_t(freedom, rows) for joint in range(1, 100)}
        assert not [finding for finding in examine(motion(columns)) if "lost or spoilt" in finding.message]


def test_a_few_readings_far_off_are_more_than_tails_of_noise() -> None:
    noise = np.random.default_rng(4).standard_t(4.0, 300)
    columns = {"time_s": np.arange(300) * 0.01, "current_1_a": noise}
    columns["current_1_a"][[50, 150, 200]] += 30.0
    finding = only([f for f in examine(motion(columns)) if f.column == "current_1_a"])
    assert "rows 51, 151 and 201" in finding.message


def test_a_step_is_no_spike() -> None:
    assert not [f for f in spoilt("current_2_a", 15.0, slice(ROW, None)) if "between" in f.message]


@pytest.mark.parametrize(
    ("column", "value", "words"),
    [
        ("load_mass_kg", -5.0, "-5 kg is no mass that hangs on an arm"),
        ("load_z_n", -1e10, "over 1e+06 N"),
        ("gas_pressure_pa", -1e10, "further below zero than a gauge errs"),
    ],
)
def test_what_no_instrument_gives_is_an_error_at_its_row(column: str, value: float, words: str) -> None:
    columns = {name: values.copy() for name, values in sweep().items()}
    columns.setdefault(column, np.zeros(len(columns["time_s"])))[ROW] = value
    errors = [finding for finding in examine(motion(columns)) if finding.level == "error"]
    assert [(finding.column, finding.row) for finding in errors] == [(column, ROW + 1)]
    assert words in errors[0].message


def sheet(name: str, seed: int) -> Sheet:
    columns = sweep(seed)
    return Sheet(motion(columns, name, 100.0 * seed), f"runs/{name}.csv", tuple(columns))


def test_a_run_under_two_names_is_doubted() -> None:
    assert examine_all([sheet("a", 1), sheet("b", 2)]) == []
    copy = replace(sheet("c", 1), run=replace(sheet("c", 1).run, start_s=900.0))
    finding = only(examine_all([sheet("a", 1), sheet("b", 2), copy]))
    assert (finding.level, finding.file) == ("doubt", "runs/c.csv")
    assert "holds the same readings as runs/a.csv" in finding.message


def test_a_copy_with_little_noise_of_its_own_is_doubted_and_a_repeat_is_not(rng: np.random.Generator) -> None:
    """A thousandth of a percent of each range was enough to be a run of its own, and its readings counted twice."""
    smooth = {"time_s": np.arange(200) / 50, "q_cmd_1_rad": np.sin(np.arange(200) / 40)}
    smooth |= {"q_motor_1_rad": smooth["q_cmd_1_rad"]}
    torque, noise = 300 * np.cos(np.arange(200) / 40), rng.normal(size=(2, 200))

    def of(values: Array, name: str, start: float) -> Sheet:
        columns = smooth | {"tau_motor_1_nm": values}
        return Sheet(motion(columns, name, start), f"runs/{name}.csv", tuple(columns))

    first, repeat = of(torque + noise[0], "a", 0.0), of(torque + noise[1], "b", 100.0)
    copy = of(torque + noise[0] + 1e-5 * 600 * rng.normal(size=200), "c", 200.0)
    said = [finding for finding in examine_all([first, repeat, copy]) if "same readings" in finding.message]
    assert [finding.file for finding in said] == ["runs/c.csv"]


def test_logs_that_overlap_are_doubted() -> None:
    """A window of one log was a run of its own, and its readings counted twice."""
    whole, rows = sheet("a", 1), len(sheet("a", 1).run)
    later = {name: values[rows // 2 :] for name, values in whole.run.columns.items()}
    later |= {"time_s": later["time_s"] - later["time_s"][0]}
    window = Sheet(motion(later, "b", 500.0), "runs/b.csv", tuple(later))
    finding = only(examine_all([whole, window]))
    assert (finding.level, finding.file) == ("doubt", "runs/b.csv")
    said = f"{rows - rows // 2} rows from row 1 on read as runs/a.csv does from row {rows // 2 + 1} on"
    assert said in finding.message


def test_runs_without_noise_may_be_alike() -> None:
    columns = {"time_s": np.arange(40.0), "q_cmd_1_rad": np.zeros(40), "q_motor_1_rad": np.zeros(40)}
    runs = [motion(columns, name, start) for name, start in (("a", 0.0), ("b", 100.0))]
    assert not [f for f in examine_all([Sheet(r, r.name, tuple(columns)) for r in runs]) if "same" in f.message]


def test_a_copied_campaign_is_no_second_recording() -> None:
    assert list(no_campaign_twice({"may": session(1), "june": session(2)})) == []
    ((name, doubt),) = no_campaign_twice({"may": session(1), "june": session(2), "july": session(1)})
    assert (name, doubt.level) == ("july", "doubt")
    assert "2 of 2 runs hold the same readings as those of may" in doubt.message


@pytest.mark.parametrize("factor", [1 + 1e-9, 1 - 1e-12])
def test_a_campaign_copied_to_within_rounding_is_no_second_recording(factor: float) -> None:
    runs = session(1).runs
    again = tuple(replace(run, columns={name: factor * v for name, v in run.columns.items()}) for run in runs)
    copied = {"may": session(1), "june": replace(session(1), runs=again)}
    assert [name for name, _ in no_campaign_twice(copied)] == ["june"]


def test_a_force_without_a_stated_load_is_told() -> None:
    columns = loading()
    columns["load_z_n"] = np.zeros_like(columns["load_z_n"])
    (finding,) = (f for f in examine(static(columns)) if f.column == "force_z_n")
    assert finding.level == "warning"
    assert "while no load is stated to change" in finding.message


@pytest.mark.parametrize(
    ("line", "key", "words"),
    [
        ("runs: [{name: a, kind: motion, start_s: 1e300}]", "runs[0].start_s", "less than or equal"),
        ("noise: {current: 1e300}", "noise.current", "less than or equal"),
        ("noise: {current: 1e-300}", "noise.current", "greater than"),
        ("noise: {current: 0_1}", "noise.current", "is no decimal number"),
        ("runs: [{name: a, kind: motion, start_s: 617_843}]", "runs[0].start_s", "is no decimal number"),
        ("runs: [{name: a, kind: motion, start_s: 0617}]", "runs[0].start_s", "is no decimal number"),
        ("known: [{quantity: payload_kg, value: 010, sigma: 1}]", "known[0].value", "is no decimal number"),
        ("started: yesterday", "started", "is no moment; write it as 2024-05-13T09:00"),
        ("runs: [5]", "runs[0]", "is no list of `key: value` lines"),
        ("known: [{quantity: payload_kg, value: 1, sigma: 1.0e-300}]", "known[0].sigma", "greater than"),
    ],
)
def test_a_manifest_is_told_in_plain_words(tmp_path: Path, line: str, key: str, words: str) -> None:
    folder = write_folder(tmp_path / "campaign", motion(sweep()))
    text = "format: 1\nrobot: small\n" + line
    text += "" if line.startswith("runs") else "\nruns: [{name: a, kind: motion, start_s: 0}]"
    (folder / "campaign.yaml").write_text(text)
    (error,) = (finding for finding in check_campaign(folder).errors if finding.column == key)
    assert words in error.message


def test_names_of_strangers_do_not_steer_a_terminal() -> None:
    finding = Finding("error", "runs/a.csv", None, "\x1b[31m\ncurrent" + 10_000 * "x", "unknown", "rename it")
    assert "\x1b" not in str(finding)
    assert "\n" not in str(finding)
    assert len(str(finding)) < 2 * MOST_OF_NAME
    assert str(InputError(["a\x1b[2Jb", "c"])) == "a\\x1b[2Jb\nc"
    assert printable("5 °C, µm, \u202e") == "5 °C, µm, \\u202e"


@pytest.mark.parametrize("name", ["current_0_a", "current_02_a", "current_99999999_a"])
def test_a_wrong_number_is_not_proposed_again(name: str) -> None:
    columns = sweep()
    columns[name] = columns.pop("current_2_a")
    messages = [finding.message for finding in examine(motion(columns)) if finding.column == name]
    assert messages
    assert f"did you mean {name!r}" not in messages[0]


def test_an_arm_that_settles_is_not_spoilt() -> None:
    """Currents of repeats that drift after an arrival, all of them, as a servo's integral action makes them."""
    rng = np.random.default_rng(4)
    rows = np.repeat(np.arange(8.0), 3)
    currents = rows + 1e-2 * rng.normal(size=rows.size)
    columns = {"pose": rows, "approach": 1 + 0 * rows, "load_step": 0 * rows, "current_1_a": currents}
    assert not [finding for finding in examine(static(columns)) if "repeats" in finding.message]
    columns["current_1_a"][3:6] = 5.3, 4.7, 3.5
    assert not [finding for finding in examine(static(columns)) if "repeats" in finding.message]
    columns["current_1_a"][3:6] = 5.3, 1.0, 1.01
    assert [finding for finding in examine(static(columns)) if "repeats" in finding.message]
