"""What pydantic finds wrong with a value, in the words of people who write such files."""

from collections.abc import Iterator, Mapping, Sequence
from typing import Any, get_args

from pydantic import BaseModel, ValidationError

from bench.errors import unknown_name

ONE_LINE = r"^[^\x00-\x1f\x7f-\x9f\u2028\u2029]*$"  # text without line breaks and control characters
BLOCK = "is no list of `key: value` lines"
WORDS: Mapping[str, str] = {
    "missing": "is missing",
    "extra_forbidden": "is no key of this file",
    "model_type": BLOCK,
    "dict_type": BLOCK,
    "list_type": "is no list",
    "tuple_type": "is no list",
    "string_type": "is no text",
    "string_pattern_mismatch": "has characters that may not stand here",
}


def faults_of(error: ValidationError) -> list[Mapping[str, Any]]:
    """Return what is wrong; not that a list is too short where nothing but its own faults made it so."""
    every: list[Mapping[str, Any]] = [*error.errors()]
    inner = {one["loc"][:k] for one in every for k in range(len(one["loc"]))}
    return [one for one in every if one["type"] != "too_short" or one["loc"] not in inner]


def words_of(detail: Mapping[str, Any], model: type[BaseModel] | None = None) -> str:
    """Return what is wrong, from an entry of `pydantic.ValidationError.errors()`.

    Args:
        detail: The entry.
        model: What the whole file was validated as. With it an unknown key is told with those that are known.
    """
    if detail["type"] == "extra_forbidden" and model is not None:
        *place, key = detail["loc"]
        return unknown_name("key", str(key), _keys_at(place, model)).removesuffix(".")
    return WORDS.get(detail["type"], str(detail["msg"]).removeprefix("Value error, "))


def _keys_at(place: Sequence[str | int], model: type[BaseModel]) -> set[str]:
    """Return the keys that may stand at a place in a file; where it may be one of several models, those of all."""
    models = [model]
    for part in place:  # an index of a list, a name of a mapping and the name of a model lead no deeper
        fields = [field for one in models for name, field in one.model_fields.items() if part in (name, field.alias)]
        models = [inner for field in fields for inner in _models_in(field.annotation)] or models
    return {field.alias or name for one in models for name, field in one.model_fields.items()}


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    """Yield the models that a type is made of, such as X of `dict[str, X | None]`."""
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)
