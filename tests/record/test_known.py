"""`known:` in campaign.yaml: read, written, joined, and every mistake named."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

from bench.record.campaign import Campaign, Run
from bench.record.carried import with_payloads
from bench.record.check import check_campaign
from bench.record.joined import joined
from bench.record.known import Known, contradictions
from bench.record.read import read_campaign
from bench.record.write import write_campaign

KNOWN = (
    Known("payload_kg", 151.0, 2.0, note="crane scale"),
    Known("stiffness_nm_per_rad", 2.3e6, 1e5, joint=2),
    Known("gas_pressure_pa", 1.6e7, 2e5, at=(0.5, -1.25)),
    Known("gas_temperature_k", 301.0, 1.0),
)


def run(name: str, recording: str = "", **more: float) -> Run:
    time = np.linspace(0.0, 2.0, 40)
    wave = np.sin(time)
    columns = {
        "time_s": time,
        "q_cmd_1_rad": wave,
        "q_cmd_2_rad": -wave,
        "current_1_a": 3 * np.cos(time + (name == "two")),
    }
    return Run(name, "motion", 0.0, columns | {k: np.full(40, v) for k, v in more.items()}, recording=recording)


CAMPAIGN = Campaign("small", (run("one"),), known=KNOWN)


def test_reads_back_as_written(tmp_path: Path) -> None:
    write_campaign(CAMPAIGN, tmp_path / "campaign")
    assert read_campaign(tmp_path / "campaign").known == KNOWN


def test_the_example_of_the_page_can_be_used(tmp_path: Path) -> None:
    page = (Path(__file__).parents[2] / "bench/record/README.md").read_text()
    example = next(part for part in page.split("```yaml\n") if part.startswith("known:")).split("```")[0]
    write_campaign(replace(CAMPAIGN, known=()), tmp_path / "campaign")
    manifest = tmp_path / "campaign" / "campaign.yaml"
    manifest.write_text(manifest.read_text() + example)
    assert {one.quantity for one in read_campaign(tmp_path / "campaign").known} == {one.quantity for one in KNOWN}


@pytest.mark.parametrize(
    ("entry", "said"),
    [
        ({"quantity": "payload", "value": 1, "sigma": 1}, "known[0].quantity: 'payload'"),
        ({"quantity": "payload_kg", "value": 1}, "known[0].sigma: is missing"),
        ({"quantity": "payload_kg", "value": 1, "sigma": 0}, "known[0].sigma: '0'"),
        ({"quantity": "payload_kg", "value": -1, "sigma": 1}, "known[0].value: -1 cannot be"),
        ({"quantity": "payload_kg", "value": 1, "sigma": 1, "joint": 2}, "known[0].joint: a stiffness is of one joint"),
        ({"quantity": "stiffness_nm_per_rad", "value": 1, "sigma": 1}, "known[0].joint: a stiffness is of one joint"),
        ({"quantity": "gas_pressure_pa", "value": 1, "sigma": 1}, "known[0].at: a gas pressure is of one pose"),
        ({"quantity": "payload_kg", "value": 1, "sigma": 1, "recording": "may"}, "there is no recording 'may'"),
        ({"quantity": "payload_kg", "value": 1, "sigma": 1, "wight": 2}, "unknown key 'wight'"),
        ("151 kg", "known[0]"),
    ],
)
def test_mistakes_are_named(tmp_path: Path, entry: object, said: str) -> None:
    write_campaign(replace(CAMPAIGN, known=()), tmp_path / "campaign")
    manifest = tmp_path / "campaign" / "campaign.yaml"
    manifest.write_text(manifest.read_text() + yaml.safe_dump({"known": [entry]}))
    report = check_campaign(tmp_path / "campaign")
    assert report.campaign is None
    assert said in "\n".join(str(finding) for finding in report.findings)


def test_known_has_to_be_a_list(tmp_path: Path) -> None:
    write_campaign(replace(CAMPAIGN, known=()), tmp_path / "campaign")
    manifest = tmp_path / "campaign" / "campaign.yaml"
    manifest.write_text(manifest.read_text() + "known: {payload_kg: 3}\n")
    (finding,) = check_campaign(tmp_path / "campaign").findings
    assert "known: no list" in str(finding)


def test_of_several_recordings_one_has_to_be_named(tmp_path: Path) -> None:
    both = replace(CAMPAIGN, runs=(run("one", "may"), run("two", "june")), known=())
    write_campaign(both, tmp_path / "campaign")
    manifest = tmp_path / "campaign" / "campaign.yaml"
    text = manifest.read_text()
    entries = [{"quantity": "payload_kg", "value": 1.0, "sigma": 1.0}]
    manifest.write_text(text + yaml.safe_dump({"known": entries}))
    (finding,) = check_campaign(tmp_path / "campaign").findings
    assert "known[0].recording: is missing, and the campaign has several" in str(finding)
    assert "may, june" in str(finding)
    manifest.write_text(text + yaml.safe_dump({"known": [{**entries[0], "recording": "june"}]}))
    assert read_campaign(tmp_path / "campaign").known[0].recording == "june"


def test_joined_campaigns_keep_what_is_known_of_each() -> None:
    both = joined({"may": CAMPAIGN, "june": replace(CAMPAIGN, known=KNOWN[:1])})
    assert [one.recording for one in both.known] == ["may", "", "may", "may", "june"]


def test_runs_carry_a_payload_that_is_known() -> None:
    """Where runs state none; its weight stands in the load if the table has one."""
    runs = (run("plain"), run("loaded", load_z_n=-100.0), run("stated", load_mass_kg=7.0))
    found = with_payloads(replace(CAMPAIGN, runs=runs)).runs
    assert [one.columns["load_mass_kg"][0] for one in found] == [151.0, 151.0, 7.0]
    assert "load_z_n" not in found[0].columns
    np.testing.assert_allclose(found[1].columns["load_z_n"], -100.0 - 151.0 * 9.80665)
    assert with_payloads(replace(CAMPAIGN, known=KNOWN[1:])).runs == CAMPAIGN.runs


@pytest.mark.parametrize(("second", "is_told"), [(20.9, False), (40.0, True)])
def test_one_thing_known_twice_and_not_alike_is_told(second: float, is_told: bool) -> None:
    first = Known("payload_kg", 20.0, 0.2)
    between = Known("stiffness_nm_per_rad", 1e6, 1e5, joint=1)
    found = list(contradictions([first, between, replace(first, value=second)]))
    assert [key for key, _ in found] == ["known[2].value"] * is_told
    if is_told:
        assert "40 ± 0.2 and 20 ± 0.2 (known[0])" in found[0][1]


def test_a_thing_known_many_times_is_held_against_its_first_reading() -> None:
    """Each against each, a stranger's list of some thousand readings would have taken minutes."""
    many = [Known("payload_kg", value=10.0 if i else 50.0, sigma=0.1) for i in range(20_000)]
    assert len(list(contradictions(many))) == len(many) - 1
