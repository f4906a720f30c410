"""By which code a study was made: a fingerprint of everything that its results depend on."""

from hashlib import sha256
from pathlib import Path

from bench.robot.folder import load_robot
from bench.scenario.files import read_scenario, scenario_file

PACKAGE = Path(__file__).parents[1]
SOURCES = (".py", ".c", ".h")
LIBRARIES = (".so", ".dylib", ".dll")  # a wheel brings the plugin compiled, without its sources
ROBOT = (".xml", ".yaml", ".stl", ".obj")
LENGTH = 16  # hexadecimal digits that are kept


def code_of(session: str, package: Path = PACKAGE) -> str:
    """Return the fingerprint of the package's sources, of a session's scenario and of its robot.

    It does not depend on where these lie.

    Args:
        session: Name or file of the session.
        package: Folder of the package.

    Raises:
        InputError: There is no such session.
        RobotError: Its robot is broken.
    """
    sources = _below(package, SOURCES)
    if not any(file.suffix == ".c" for file in sources.values()):
        sources |= _below(package, LIBRARIES)
    robot = _below(load_robot(read_scenario(session).robot).folder, ROBOT)
    digest = sha256()
    for name, file in (*sorted(sources.items()), *sorted(robot.items()), ("session", scenario_file(session))):
        content = file.read_bytes()
        digest.update(f"{name} {len(content)} ".encode())
        digest.update(content)
    return digest.hexdigest()[:LENGTH]


def _below(folder: Path, suffixes: tuple[str, ...]) -> dict[str, Path]:
    """Return the files of some kinds below a folder by their names in it; robots of a wheel lie in the package."""
    files = (file for file in folder.rglob("*") if file.suffix in suffixes and file.is_file())
    named = {file.relative_to(folder).as_posix(): file for file in files}
    return {name: file for name, file in named.items() if not name.startswith("_data/")}
