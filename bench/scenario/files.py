"""Scenario files: find, read, validate; all faults at once."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

from pydantic import ValidationError

from bench import paths
from bench.errors import InputError, ScenarioError, UnknownRobotError, unknown_name
from bench.record.yaml_text import YamlFault, load_typed_yaml
from bench.robot.folder import problems_of
from bench.scenario.complementary import Complementary
from bench.scenario.line import Line
from bench.scenario.loading import Loading
from bench.scenario.rotation import Rotation
from bench.scenario.session import SessionScenario

Experiment = Line | Loading | Rotation | SessionScenario  # on the robot; they run as a session
Scenario = Experiment | Complementary
Kind = TypeVar("Kind", Line, Loading, Rotation, SessionScenario, Complementary)
EXPERIMENTS: dict[str, type[Scenario]] = {
    "complementary": Complementary,
    "line": Line,
    "loading": Loading,
    "rotation": Rotation,
    "session": SessionScenario,
}


def scenario_names() -> tuple[str, ...]:
    """Return the names of the scenarios that come with the package, sorted."""
    return tuple(sorted(file.stem for file in paths.scenarios_dir().glob("*.yaml")))


def scenario_file(name_or_file: str | Path) -> Path:
    """Find a scenario by name or by path.

    Raises:
        InputError: No such file.
    """
    file = Path(name_or_file)
    if not file.is_file():
        file = paths.scenarios_dir() / f"{Path(name_or_file).stem}.yaml"
        if not file.is_file() or Path(name_or_file).suffix not in ("", ".yaml") or len(Path(name_or_file).parts) > 2:
            known = ", ".join(scenario_names())
            raise InputError(f"no scenario file {str(name_or_file)!r}. Those that come along: {known}.")
    return file


def read_scenario(name_or_file: str | Path) -> Scenario:
    """Read a scenario by name or by path.

    Raises:
        InputError: No such file, not YAML, unknown experiment, or keys that break its schema; every fault is listed.
    """
    file = scenario_file(name_or_file)
    try:
        content = load_typed_yaml(file)
    except YamlFault as fault:
        raise InputError(f"{file.name}: {fault}; {fault.remedy}.") from fault
    experiment = content.get("experiment")
    if not isinstance(experiment, str) or experiment not in EXPERIMENTS:
        raise InputError(f"{file.name}: experiment: {unknown_name('experiment', str(experiment), EXPERIMENTS)}")
    try:
        return EXPERIMENTS[experiment].model_validate(content)
    except ValidationError as error:
        raise InputError(problems_of(error, file.name, EXPERIMENTS[experiment])) from error


@contextmanager
def said_of(name_or_file: str | Path) -> Iterator[None]:
    """Name the file of a scenario in what is wrong with it while it is held against its robot.

    Raises:
        ScenarioError: As the block, with the file before each key.
        UnknownRobotError: As the block, with file and key.
    """
    try:
        yield
    except ScenarioError as error:
        file = scenario_file(name_or_file).name
        raise ScenarioError(f"{file}: {problem}" for problem in error.problems) from error
    except UnknownRobotError as error:
        raise UnknownRobotError(f"{scenario_file(name_or_file).name}: robot: {error}") from error


def read_as(kind: type[Kind], name_or_file: str | Path) -> Kind:
    """Read a scenario of one kind of experiment.

    Raises:
        InputError: As `read_scenario`, and where the scenario is of another experiment.
    """
    scenario = read_scenario(name_or_file)
    if not isinstance(scenario, kind):
        raise InputError(f"{name_or_file}: is a scenario of experiment {scenario.experiment!r}, not a {kind.__name__}.")
    return scenario
