"""Digests: what differs in any way has another one."""

from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from bench.store.digest import digest

SIMPLE = st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False) | st.text() | st.binary()
NESTED = st.recursive(SIMPLE, lambda inner: st.lists(inner, max_size=4) | st.tuples(inner, inner), max_leaves=8)


def exactly(value: object) -> object:
    """Return something that compares equal only for values of the same type and bits."""
    if isinstance(value, list | tuple):
        return type(value), tuple(exactly(one) for one in value)
    return type(value), value.hex() if isinstance(value, float) else value


@given(st.lists(NESTED, max_size=5), st.lists(NESTED, max_size=5))
def test_equal_digests_mean_equal_values(one: list[object], other: list[object]) -> None:
    assert (digest(*one) == digest(*other)) == (exactly(one) == exactly(other))


@pytest.mark.parametrize(
    ("one", "other"),
    [
        (("ab", "c"), ("a", "bc")),
        (("a", b"b"), ("a", "b")),
        ((1,), (True,)),
        ((1,), (1.0,)),
        ((0.0,), (-0.0,)),
        ((None,), ()),
        (((1, 2), 3), ((1,), 2, 3)),
        (({"a": 1, "b": 2},), ({"a": 2, "b": 1},)),
        ((np.zeros((2, 3)),), (np.zeros((3, 2)),)),
        ((np.zeros(2),), (np.zeros(2, np.float32),)),
        ((np.zeros(2),), (np.zeros(2).tobytes(),)),
        ((np.array([1.0, 2.0]),), (np.array([1.0, np.nextafter(2.0, 3.0)]),)),
    ],
)
def test_what_is_nearly_the_same_differs(one: tuple[object, ...], other: tuple[object, ...]) -> None:
    assert digest(*one) != digest(*other)


def test_layout_in_memory_does_not_count() -> None:
    array = np.arange(12.0).reshape(3, 4)
    assert digest(array) == digest(np.asfortranarray(array)) == digest(array[::-1][::-1])


def test_dataclasses_count_by_their_fields() -> None:
    @dataclass(frozen=True)
    class Point:
        x: float
        name: str = ""

    assert digest(Point(1.0)) == digest(Point(1.0))
    assert digest(Point(1.0)) != digest(Point(2.0))
    assert digest(Point(1.0)) != digest(Point(1.0, "a"))


@pytest.mark.parametrize("value", [object(), {1, 2}, np.array(["a"]), np.array([None]), 1j, len])
def test_what_nobody_can_compare_has_no_digest(value: object) -> None:
    with pytest.raises(TypeError, match="no digest"):
        digest([value])


def test_a_read_only_mapping_has_one() -> None:
    assert digest(MappingProxyType({"a": 1.0})) != digest(MappingProxyType({"a": 2.0}))
