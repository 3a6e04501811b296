"""Folders of runs that nobody has named."""

from __future__ import annotations

import os
import shutil
import tempfile
import weakref

__all__ = ["Temporary"]


class Temporary:
    """A folder for one run, removed together with this object or at the end of the process."""

    def __init__(self) -> None:
        self._name = tempfile.mkdtemp(prefix="wythe-")
        weakref.finalize(self, _remove, self._name, os.getpid())

    @property
    def run(self) -> str:
        """Folder of the run, created by the run."""
        return os.path.join(self._name, "run")


def _remove(name: str, owner: int) -> None:
    # A forked process has a copy of the object but does not own the folder.
    if os.getpid() == owner:
        shutil.rmtree(name, ignore_errors=True)
