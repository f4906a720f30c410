"""Which models are simulated."""

from types import SimpleNamespace
from typing import Any

from bench.diagnose.name.leaders import scattering
from bench.diagnose.name.search import Alternative, Subset


def linearised() -> Any:
    """Friction and softening at joint 1, friction at joint 2, and play at joint 1, which nothing has found."""
    names = ("friction 1", "softening 1", "friction 2", "play 1")
    causes = [SimpleNamespace(key=name, effect=SimpleNamespace(scatters=name.startswith("play"))) for name in names]
    return SimpleNamespace(
        what=[SimpleNamespace(drive=int(name[-1])) for name in names],
        model=SimpleNamespace(terms=causes),
        cause=causes.__getitem__,
        candidate_of=lambda which: frozenset(names[i] for i in which),
    )


def test_a_play_is_tried_beside_and_in_the_place_of_whatever_is_at_its_joint() -> None:
    leader = Alternative(frozenset({"friction 1", "softening 1", "friction 2"}), Subset((0, 1, 2), 0.0), 0.0)
    found = scattering(linearised(), leader, set())
    assert {
        there: set(candidate) - there  # type: ignore[call-overload]
        for there, candidate in found.items()
    } == {
        frozenset({"friction 1", "softening 1", "play 1"}): {"friction 2"},
        frozenset({"friction 1", "play 1"}): {"friction 2"},
        frozenset({"softening 1", "play 1"}): {"friction 2"},
    }


def test_a_play_that_fell_behind_is_not_tried_again_for_what_is_found_elsewhere() -> None:
    leader = Alternative(frozenset({"friction 1", "friction 2"}), Subset((0, 2), 0.0), 0.0)
    behind = scattering(linearised(), leader, set()).keys()
    alone = Alternative(frozenset({"friction 1"}), Subset((0,), 0.0), 0.0)
    assert scattering(linearised(), alone, behind) == {}
    assert scattering(linearised(), Alternative(frozenset({"softening 1"}), Subset((1,), 0.0), 0.0), behind)
