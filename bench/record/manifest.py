"""`campaign.yaml`: what was done, with which robot, and which table belongs to which run."""

import os
from collections.abc import Mapping
from dataclasses import asdict
from datetime import date, datetime, time
from pathlib import Path
from typing import Annotated, Any, Literal, NamedTuple, TypeVar, get_args

from pydantic import BeforeValidator, Field, ValidationError

from bench.errors import MOST_OF_NAME, unknown_name
from bench.record.campaign import Campaign, RunKind
from bench.record.channels import NOISY
from bench.record.finding import Finding
from bench.record.known import Known, KnownQuantity
from bench.record.limits import CAMPAIGN_RUNS
from bench.record.possible import noise_faults
from bench.record.rules.values import IMPOSSIBLE
from bench.record.schema_words import ONE_LINE, words_of
from bench.record.strict import Strict
from bench.record.yaml_text import YamlFault, dump_yaml, is_odd, load_yaml

MANIFEST = "campaign.yaml"
INSIDE = "campaign"  # where `bench run`, `bench hide` and `bench demo` put the campaign of a folder that they write
RUN_NAME = r"^[A-Za-z0-9][A-Za-z0-9_.-]*$"  # a file name on every system
YEARS = range(1970, 2101)
SUFFIXES = (".csv", ".parquet")


def _moment(value: object) -> object:
    """Take a bare date as its midnight."""
    try:
        found = datetime.combine(date.fromisoformat(str(value)), time())
    except ValueError:
        try:
            found = datetime.fromisoformat(str(value))
        except ValueError:
            raise ValueError("is no moment; write it as 2024-05-13T09:00") from None
    if found.year not in YEARS:
        raise ValueError(f"is no moment at which a robot was measured; years are {YEARS[0]} to {YEARS[-1]}")
    return found


def _decimal(value: object) -> object:
    """Refuse numbers that robots and scenarios do not have either."""
    if isinstance(value, str) and is_odd(value):
        raise ValueError("is no decimal number; write it without 0 in front or _ between digits")
    return value


Number = Annotated[float, BeforeValidator(_decimal)]
Deviation = Annotated[
    float, Field(gt=0), Field(ge=1 / IMPOSSIBLE, le=IMPOSSIBLE), BeforeValidator(_decimal)
]  # of a reading


class RunEntry(Strict):
    """One run of the list."""

    name: str = Field(pattern=RUN_NAME, max_length=100, description="letters, digits, '_', '-' and '.'")
    kind: RunKind = Field(description="static or motion")
    start_s: Number = Field(
        ge=0, le=IMPOSSIBLE, description="seconds from the start of its recording; file dates are good enough"
    )
    recording: str = Field(
        "", pattern=ONE_LINE, max_length=100, description="name of the recording that the run belongs to, in one line"
    )
    file: str = Field("", pattern=r"^[^\x00]*$", description="default: runs/<name>.csv")
    note: str = ""

    @property
    def path(self) -> str:
        """Path of the table relative to the campaign folder."""
        return self.file or f"runs/{self.name}.csv"


class KnownEntry(Strict):
    """One thing that the lab knows besides."""

    quantity: KnownQuantity = Field(description=f"one of {', '.join(get_args(KnownQuantity))}")
    value: Number = Field(le=IMPOSSIBLE, description="the reading, in the unit of the quantity")
    sigma: Deviation = Field(description="its standard deviation, above 0")
    joint: Annotated[int, BeforeValidator(_decimal)] = Field(
        0, ge=0, description="number of the joint, from 1, of a stiffness"
    )
    at: tuple[Number, ...] = Field((), description="position of every joint [rad], of a slide [m], of a gas pressure")
    recording: str = Field(
        "", pattern=ONE_LINE, max_length=100, description="name of the recording in which it was so, in one line"
    )
    note: str = ""


class Head(Strict):
    """Everything but the runs."""

    format: Literal["1"] = Field(description="write 1")
    robot: str = Field(min_length=1, description="name of a robot folder, or a path to one")
    started: Annotated[datetime | None, BeforeValidator(_moment)] = None
    noise: dict[str, Deviation] = Field({}, description="of each quantity the standard deviation of one reading")
    notes: str = ""


class Manifest(NamedTuple):
    """What could be understood of `campaign.yaml`; `head` is None if it has errors, faulty runs are left out."""

    head: Head | None
    runs: tuple[RunEntry, ...]
    findings: tuple[Finding, ...]
    known: tuple[Known, ...] = ()


def read_manifest(folder: Path) -> Manifest:
    """Read `campaign.yaml` of a folder, as far as it can be understood."""
    try:
        content = load_yaml(folder / MANIFEST, ("noise",))
    except YamlFault as fault:
        message, remedy = _wrong_folder(folder) or (str(fault), fault.remedy)
        return Manifest(None, (), (_fault("", message, remedy),))
    entries, besides = content.pop("runs", None), content.pop("known", None)
    findings: list[Finding] = []
    head = _validated(Head, content, "", findings)
    for quantity in sorted(set(head.noise if head else ()) - set(NOISY)):
        findings.append(_fault(f"noise.{quantity}", unknown_name("quantity", quantity, NOISY), "rename or remove it"))
    for quantity, *words in noise_faults(head.noise if head else {}, NOISY):
        findings.append(_fault(f"noise.{quantity}", *words))
    if not isinstance(entries, list) or not entries:
        findings.append(_fault("runs", "no list of runs", "list at least one run"))
        entries = []
    if CAMPAIGN_RUNS.exceeded(len(entries)):
        findings.append(_fault("runs", f"more than {CAMPAIGN_RUNS}", CAMPAIGN_RUNS.remedy))
        entries = []
    runs = [_validated(RunEntry, entry, f"runs[{i}]", findings) for i, entry in enumerate(entries)]
    usable = tuple(run for run in runs if run is not None and _is_inside(folder, run, findings))
    findings += [*_repeated(usable), *_of_no_recording(usable)]
    known = _known(besides, tuple(dict.fromkeys(run.recording for run in usable)), findings)
    return Manifest(head, usable, tuple(findings), known)


def _wrong_folder(folder: Path) -> tuple[str, str] | None:
    """Return what is wrong with the path that was given, and what to do; None if it may be a campaign."""
    if os.path.isfile(folder):  # noqa: PTH113  a name may be too long for pathlib
        return (
            f"{folder.name} is a file, not a folder with a {MANIFEST}",
            "give the folder; of logs `bench convert` makes one",
        )
    try:
        os.lstat(folder)
    except FileNotFoundError:
        return (
            f"there is no folder {str(folder)[:MOST_OF_NAME]}",
            "give a campaign folder; of logs `bench convert` makes one",
        )
    except (OSError, ValueError):
        return None
    inside = folder / INSIDE
    if os.path.isfile(inside / MANIFEST) and not os.path.lexists(folder / MANIFEST):  # noqa: PTH113
        return "this folder is no campaign, but there is one in it", f"give {inside}"
    return None


def manifest_text(campaign: Campaign, suffix: str) -> str:
    """Return `campaign.yaml` for a campaign whose tables end in `suffix` (".csv" or ".parquet")."""
    head: dict[str, object] = {"format": 1, "robot": campaign.robot}
    if campaign.started is not None:
        head["started"] = campaign.started.isoformat()
    head |= {"noise": dict(campaign.noise)} if campaign.noise else {}
    head |= {"notes": campaign.notes} if campaign.notes else {}
    if campaign.known:
        head["known"] = [_text_of(known) for known in campaign.known]
    head["runs"] = [
        {"name": run.name, "kind": run.kind, "start_s": float(run.start_s)}
        | ({"file": f"runs/{run.name}{suffix}"} if suffix != ".csv" else {})
        | ({"recording": run.recording} if run.recording else {})
        | ({"note": run.note} if run.note else {})
        for run in campaign.runs
    ]
    return dump_yaml(head)


def _fault(key: str, message: str, remedy: str) -> Finding:
    return Finding("error", MANIFEST, None, key, message, remedy)


def _known(entries: object, recordings: tuple[str, ...], findings: list[Finding]) -> tuple[Known, ...]:
    """Return what is known besides, as far as it can be understood."""
    if entries is None:
        return ()
    if not isinstance(entries, list):
        findings.append(_fault("known", "no list", "list what is known besides, each with quantity, value and sigma"))
        return ()
    found = []
    for i, content in enumerate(entries):
        entry = _validated(KnownEntry, content, f"known[{i}]", findings)
        if entry is not None:
            found.append(Known(**entry.model_dump()))
            findings += [_fault(f"known[{i}].{key}", *words) for key, *words in found[-1].faults(recordings)]
    return tuple(found)


def _text_of(known: Known) -> dict[str, object]:
    every = asdict(known) | {"at": list(known.at)}
    return {key: value for key, value in every.items() if value or key in ("value", "sigma")}


_Model = TypeVar("_Model", bound=Strict)


def _validated(model: type[_Model], content: object, where: str, findings: list[Finding]) -> _Model | None:
    try:
        return model.model_validate(content)
    except ValidationError as error:
        findings += [_finding(model, dict(detail), where) for detail in error.errors()]
        return None


def _finding(model: type[Strict], detail: Mapping[str, Any], where: str) -> Finding:
    key = ".".join([where, *map(str, detail["loc"])]).lstrip(".")
    field = model.model_fields.get(str(detail["loc"][0])) if detail["loc"] else None
    expected = (field.description if field else None) or "correct it"
    match detail["type"]:
        case "extra_forbidden":
            known = [*model.model_fields, *([] if where else ["runs", "known"])]
            return _fault(key, unknown_name("key", str(detail["loc"][-1]), known), "rename or remove it")
        case "missing":
            return _fault(key, "is missing", f"add it: {expected}")
        case _:
            return _fault(key, f"{str(detail['input'])[:60]!r}: {words_of(detail, model)}", expected)


def _is_inside(folder: Path, run: RunEntry, findings: list[Finding]) -> bool:
    path = folder / run.path
    if not Path(os.path.realpath(path)).is_relative_to(os.path.realpath(folder)):  # survives a loop of links
        findings.append(_fault(f"{run.name}.file", f"{run.path} is outside of the campaign folder", "move it inside"))
        return False
    if path.suffix.lower() not in SUFFIXES:
        findings.append(_fault(f"{run.name}.file", f"{run.path} is no table", f"save it as {' or '.join(SUFFIXES)}"))
        return False
    return True


def _of_no_recording(runs: tuple[RunEntry, ...]) -> list[Finding]:
    """Return a fault for each run without a recording, where others have one: they would be one more recording."""
    named = [run.recording for run in runs if run.recording]
    remedy = f"write recording: {named[0]}, or where else it belongs, or leave the key out of all" if named else ""
    return [
        _fault(f"{run.name}.recording", "is missing, and other runs have one", remedy)
        for run in runs
        if named and not run.recording
    ]


def _repeated(runs: tuple[RunEntry, ...]) -> list[Finding]:
    found = []
    names: set[str] = set()
    files: set[str] = set()
    for run in runs:
        if run.name.casefold() in names:
            found.append(_fault(run.name, "two runs have this name", "rename one; capitals do not make a difference"))
        elif run.path.casefold() in files:
            found.append(_fault(run.name, f"{run.path} belongs to another run too", "name one table for each run"))
        names.add(run.name.casefold())
        files.add(run.path.casefold())
    return found
