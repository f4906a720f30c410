"""`bench store`: what is kept on disk between diagnoses."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Store:
    """Say what signatures are kept on disk, and how much room they take; `bench/store/README.md` says what for.

    The environment variable BENCH_STORE names another folder.
    """

    clear: bool = False
    """Remove everything that is kept."""
    limit: str | None = None
    """What the store may take from now on, such as 500MB; what exceeds it is removed."""

    def run(self) -> int:
        """Change what was asked for, and print what is there; return the exit code."""
        import time

        from bench.errors import InputError
        from bench.store.listing import words_of
        from bench.store.place import bytes_of, limited, open_store

        store = open_store()
        if self.limit is not None:
            store = limited(store, bytes_of(self.limit))
        if self.clear and (why := store.clear()):
            raise InputError(why)
        for line in words_of(store, time.time()):
            print(line)
        return 0
