"""Rerun's library, the largest that the bench loads: what can do without a recording asks here first."""

from importlib import import_module

from bench.errors import NoLibraryError, interrupt_behind, not_loaded


def expect_rerun() -> None:
    """Load Rerun's library.

    Raises:
        NoLibraryError: It cannot be loaded; an interrupt while it is loaded is raised as it comes.
    """
    try:
        import_module("rerun.blueprint")
    except ImportError as error:
        if interrupt_behind(error):
            raise
        raise NoLibraryError(f"no Rerun recording is written: {not_loaded(error)}") from error
