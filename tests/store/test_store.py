"""The store: what is put comes back bit by bit, or not at all."""

import os
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays_of
from numpy.typing import NDArray

from bench.store.digest import digest
from bench.store.entry import BLOCK
from bench.store.store import Store

KEY, OTHER = digest("one"), digest("other")
HEADER = 500  # [bytes]; more than the header of these entries takes

ARRAYS = st.dictionaries(
    st.text(max_size=8),
    arrays_of.arrays(
        st.sampled_from(["<f8", ">f8", "<f4", "i2", "u1", "?", "c16"]), arrays_of.array_shapes(min_dims=0, min_side=0)
    ),
    max_size=3,
)


def bits(array: NDArray[Any]) -> tuple[str, tuple[int, ...], bytes]:
    return array.dtype.str, array.shape, array.tobytes()


@pytest.fixture
def store(tmp_path: Path) -> Store:
    return Store(tmp_path / "store")


@settings(max_examples=50)  # every write waits for the disk
@given(arrays=ARRAYS)
def test_round_trip(arrays: dict[str, NDArray[Any]], tmp_path_factory: pytest.TempPathFactory) -> None:
    store = Store(tmp_path_factory.mktemp("store"))
    assert store.put(KEY, arrays) is None
    found = store.get(KEY)
    assert found is not None
    assert {name: bits(array) for name, array in found.items()} == {name: bits(one) for name, one in arrays.items()}


def test_numbers_keep_every_bit(store: Store, rng: np.random.Generator) -> None:
    values = np.zeros((7, 1000))
    values[3] = rng.standard_normal(1000)
    values[5, ::50] = np.nan
    values[6, :3] = -0.0, np.inf, 5e-324
    store.put(KEY, {"values": values, "strided": values[::2, ::3]})
    found = store.get(KEY)
    assert found is not None
    assert bits(found["values"]) == bits(values)
    assert bits(found["strided"]) == bits(values[::2, ::3])
    assert not found["values"].flags.writeable


def test_zeros_take_no_room(store: Store) -> None:
    values = np.zeros(10**6)
    values[::10_000] = 1.0
    store.put(KEY, {"values": values})
    (entry,) = store.entries()
    assert entry.size < 100 * BLOCK + values.nbytes / BLOCK / 8 + HEADER


def test_an_entry_can_be_replaced(store: Store) -> None:
    store.put(KEY, {"x": np.zeros(3)})
    store.put(KEY, {"x": np.ones(2)})
    found = store.get(KEY)
    assert found is not None
    assert found["x"].tolist() == [1.0, 1.0]


def test_nothing_is_there_at_first(store: Store) -> None:
    assert store.get(KEY) is None
    assert store.entries() == store.known() == ()
    assert store.clear() is None
    assert not store.folder.exists()


def test_only_numbers_are_kept(store: Store) -> None:
    with pytest.raises(TypeError, match="only numbers"):
        store.put(KEY, {"x": np.array([None])})
    assert store.entries() == ()


@pytest.mark.parametrize("key", ["", "../../etc/passwd", KEY.upper(), KEY[:-1]])
def test_keys_are_digests(store: Store, key: str) -> None:
    with pytest.raises(ValueError, match="is no key"):
        store.get(key)


def test_a_list_says_what_is_there(store: Store) -> None:
    store.put(KEY, {"x": np.arange(3.0)}, label="three numbers")
    (entry,) = store.entries()
    assert (entry.key, entry.label) == (KEY, "three numbers")
    assert entry.size == (store.folder / f"{KEY}.entry").stat().st_size
    assert abs(entry.made_s - entry.used_s) < 3600


def test_keys_by_prefix(store: Store) -> None:
    for key in (KEY, OTHER, KEY + OTHER):
        store.put(key, {})
    assert set(store.known()) == {KEY, OTHER, KEY + OTHER}
    assert set(store.known(KEY)) == {KEY, KEY + OTHER}


def one_entry(store: Store) -> Path:
    """Put an entry with a dense and a sparse array; return its file."""
    sparse = np.zeros(200)
    sparse[150:] = np.pi
    store.put(KEY, {"dense": np.arange(1.0, 8.0), "sparse": sparse}, label="damaged soon")
    return store.folder / f"{KEY}.entry"


def test_damage_at_any_byte_is_seen_and_removed(store: Store) -> None:
    file = one_entry(store)
    whole = file.read_bytes()
    for at in range(len(whole)):
        for flipped in (0x01, 0x80):
            file.write_bytes(whole[:at] + bytes([whole[at] ^ flipped]) + whole[at + 1 :])
            store.entries()
            assert store.get(KEY) is None, at
            assert not file.exists(), at


def test_a_file_of_another_length_is_removed(store: Store) -> None:
    file = one_entry(store)
    whole = file.read_bytes()
    for content in (*(whole[:length] for length in range(len(whole))), whole + b"\0", whole + whole):
        file.write_bytes(content)
        store.entries()
        assert store.get(KEY) is None
        assert not file.exists()


def test_a_foreign_file_is_removed(store: Store) -> None:
    file = one_entry(store)
    renamed = store.folder / f"{OTHER}.entry"
    file.rename(renamed)  # a healthy entry, of another key
    assert store.get(OTHER) is None
    assert not renamed.exists()
    with file.open("wb") as opened:
        np.save(opened, np.array([{"a": 1}], dtype=object), allow_pickle=True)
    assert [entry.label for entry in store.entries()] == [""]
    assert store.get(KEY) is None
    assert not file.exists()


def test_files_of_others_are_not_touched(store: Store) -> None:
    one_entry(store)
    mine = [store.folder / name for name in ("notes.txt", "abc.entry", f"{KEY}.entry.bak", "thesis.partial")]
    for file in mine:
        file.write_text("precious")
    assert store.clear() is None
    assert store.entries() == ()
    assert all(file.read_text() == "precious" for file in mine)


def test_what_was_not_used_for_longest_gives_way(tmp_path: Path) -> None:
    keys = [digest(i) for i in range(5)]
    arrays = {"x": np.arange(1000.0)}
    store = Store(tmp_path, limit_bytes=4 * (8000 + HEADER))
    for age, key in enumerate(keys[:4]):
        assert store.put(key, arrays) is None
        os.utime(tmp_path / f"{key}.entry", (0, 1000 - 100 * (4 - age)))
    assert store.get(keys[0])  # used again, so the second one is the oldest now
    assert store.put(keys[4], arrays) is None
    assert set(store.known()) == {keys[0], keys[2], keys[3], keys[4]}


@settings(max_examples=30)
@given(sizes=st.lists(st.integers(0, 3000), min_size=1, max_size=12), same=st.booleans())
def test_the_limit_always_holds(sizes: list[int], same: bool, tmp_path_factory: pytest.TempPathFactory) -> None:
    store = Store(tmp_path_factory.mktemp("store"), limit_bytes=5000)
    for i, size in enumerate(sizes):
        key = KEY if same else digest(i)
        why = store.put(key, {"x": np.ones(size, np.uint8)})
        assert why is None
        assert sum(file.stat().st_size for file in store.folder.iterdir()) <= store.limit_bytes
        assert store.get(key)


def test_an_entry_larger_than_the_limit_is_refused(tmp_path: Path) -> None:
    store = Store(tmp_path, limit_bytes=5000)
    assert store.put(KEY, {"x": np.ones(10)}) is None
    why = store.put(OTHER, {"x": np.ones(1000)})
    assert why is not None
    assert "limit" in why
    assert store.known() == (KEY,)


def test_a_smaller_limit_removes_what_exceeds_it(tmp_path: Path) -> None:
    for i in range(6):
        Store(tmp_path).put(digest(i), {"x": np.ones(1000)})
    small = Store(tmp_path, limit_bytes=20_000)
    assert small.shrink() is None
    assert len(small.entries()) == 2


def test_a_folder_that_cannot_be_made_is_no_error(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("in the way")
    store = Store(tmp_path / "file" / "store")
    why = store.put(KEY, {"x": np.ones(3)})
    assert why is not None
    assert "cannot be written" in why
    assert store.get(KEY) is None
    assert store.entries() == ()
