"""Every number between the data and a verdict says where it comes from."""

import ast
from collections.abc import Iterator
from pathlib import Path

import pytest

import bench
from tests.diagnose.test_assumed import CHECKS

ORIGINS = {
    "exact": "mathematics",
    "declared": "what the verdict promises, and says",
    "derived": "follows from a figure that is cited beside it",
    "rounding": "a step or a tolerance, far below what data resolve",
    "effort": "how much is tried; more of it costs time and finds no less",
    "assumed": "nobody has derived it: `bench study --vary` shows what a factor of two does",
}
MOST = 40  # fewer are assumed, all along the way to a verdict (issue 15)
PACKAGE = Path(bench.__file__).parent
ON_THE_WAY = ("diagnose", "effects", "record/moving.py", "record/held_out.py")
ASKED = ("diagnose/plausibility", "diagnose/experiment_design")  # before a verdict, and proposed after it
BESIDE = ("identify/dynamics", "compare", "predict", *ASKED)  # the first pass, and what is asked of a diagnosed model
APART = ("effects/unlisted.py", "effects/listing.py")  # effects that are only hidden, and how effects are listed


def numbers(text: str) -> Iterator[tuple[str, str]]:
    """Yield the names of constants that are numbers in the text of a module, each with its comment."""
    lines = text.splitlines()
    for node in ast.parse(text).body:
        targets = (
            node.targets if isinstance(node, ast.Assign) else [node.target] if isinstance(node, ast.AnnAssign) else []
        )
        named = [one for target in targets for one in ast.walk(target) if isinstance(one, ast.Name)]
        names = [one.id for one in named if one.id.isupper()]
        value = getattr(node, "value", None)
        leaves = [leaf.value for leaf in ast.walk(value) if isinstance(leaf, ast.Constant)] if value else []
        kinds = {type(leaf) for leaf in leaves}
        if not names or not kinds & {int, float} or str in kinds or isinstance(value, ast.Subscript):
            continue
        first = node.lineno - 1
        while lines[first - 1].startswith("#"):
            first -= 1
        comment = " ".join(line.partition("#")[2].strip() for line in lines[first : node.end_lineno])
        for name in names:
            yield name, comment.strip()


def constants(among: tuple[str, ...], without: tuple[str, ...] = ()) -> list[tuple[str, str, str]]:
    """Return module, name and comment of every number in some places of the package, without those in others."""
    places = [PACKAGE / place for place in among]
    paths = [path for place in places for path in (sorted(place.rglob("*.py")) if place.is_dir() else [place])]
    names = [str(path.relative_to(PACKAGE)) for path in paths]
    known = [(n, *one) for n, path in zip(names, paths, strict=True) for one in numbers(path.read_text())]
    return [one for one in known if not one[0].startswith((*APART, *without))]


@pytest.mark.parametrize(
    ("module", "name", "comment"),
    [pytest.param(*one, id=f"{one[0]}:{one[1]}") for one in constants(ON_THE_WAY, BESIDE) + constants(BESIDE)],
)
def test_it_says_its_origin(module: str, name: str, comment: str) -> None:
    origin = comment.partition(":")[0]
    assert origin in ORIGINS, f"{module}: {name} begins its comment with none of {', '.join(ORIGINS)}"
    assert len(comment) > len(origin) + 3, f"{module}: {name} does not say what it is"


def test_few_are_assumed_and_each_has_a_check() -> None:
    """Of half of it, and of twice as much: `test_assumed.py`."""
    assumed, asked, beside = (
        {words_of(module, name) for module, name, comment in found if comment.startswith("assumed:")}
        for found in (constants(ON_THE_WAY, without=BESIDE), constants(ASKED), constants(BESIDE))
    )
    assert len(assumed) < MOST, "\n".join(sorted(assumed))
    assert assumed | asked <= set(CHECKS) <= assumed | beside


def words_of(module: str, name: str) -> str:
    """Return what `bench study --vary` calls a constant."""
    return f"{module.removeprefix('diagnose/').removesuffix('.py').replace('/', '.')}.{name}"


def test_a_number_without_origin_is_seen() -> None:
    text = (
        'HALF = 0.5\n# assumed: what is\n# below\nTHIRD = 1 / 3\nNAMES = ("a", "b")\nWIDE: float = 2.0  # exact: two\n'
    )
    text += "FIRST, SECOND = 1.0, 2.0  # exact: both\n"
    both = [("FIRST", "exact: both"), ("SECOND", "exact: both")]
    assert list(numbers(text)) == [("HALF", ""), ("THIRD", "assumed: what is below"), ("WIDE", "exact: two"), *both]
