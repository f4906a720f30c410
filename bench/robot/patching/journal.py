"""What was noted, in order, so that the last of it can be taken back."""

from typing import Any

_NEW = object()  # stands for what was there before: nothing


class Journal:
    """Changes of tables and lists; all changes of them go through it."""

    def __init__(self) -> None:
        self._done: list[tuple[Any, Any, Any]] = []

    def __len__(self) -> int:
        return len(self._done)

    def put(self, table: dict[Any, Any], key: Any, value: Any) -> None:
        """Write an entry of a table."""
        self._done.append((table, key, table.get(key, _NEW)))
        table[key] = value

    def append(self, listed: list[Any], value: Any) -> None:
        """Write at the end of a list."""
        self._done.append((listed, None, _NEW))
        listed.append(value)

    def take_back(self, length: int) -> None:
        """Undo what was done since the journal had this length, the last first."""
        while len(self._done) > length:
            changed, key, before = self._done.pop()
            if isinstance(changed, list):
                changed.pop()
            elif before is _NEW:
                del changed[key]
            else:
                changed[key] = before
