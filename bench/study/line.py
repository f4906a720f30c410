"""A row of a study as one line of JSON."""

from typing import Any, Self

from pydantic import TypeAdapter


class JsonLine:
    """A frozen dataclass of plain data that is written as one line, and read back as it was."""

    def as_json(self) -> str:
        """Return it as one line."""
        return _adapter(type(self)).dump_json(self).decode()

    @classmethod
    def from_json(cls, line: str) -> Self:
        """Read what `as_json` gave.

        Raises:
            ValueError: The line is not whole.
        """
        row: Self = _adapter(cls).validate_json(line)
        return row


_adapters: dict[type, TypeAdapter[Any]] = {}  # made once for each kind of row


def _adapter(row: type) -> TypeAdapter[Any]:
    if row not in _adapters:
        _adapters[row] = TypeAdapter(row)
    return _adapters[row]
