"""Places, and processes of their own."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt
import pytest
import wythe

#: The repository.
ROOT = Path(__file__).resolve().parents[3]
EXAMPLES = ROOT / "examples"
#: The package in the repository, whichever is imported.
SOURCES = ROOT / "crates" / "pybind" / "python" / "wythe"
#: Where what is made of the repository lies.
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))


def environment() -> dict[str, str]:
    """For processes that import the package that is tested."""
    above = str(Path(wythe.__file__).parents[1])
    paths = [above, *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(paths), "NO_COLOR": "1"}


def python(*arguments: str, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    """Runs the interpreter with these arguments, to its end."""
    return subprocess.run(
        [sys.executable, *arguments],
        env=environment(),
        cwd=folder,
        capture_output=True,
        text=True,
        timeout=120,
        check=False,
    )


def lines(path: str | os.PathLike[str]) -> list[str]:
    """Of a text file."""
    return Path(path).read_text(encoding="utf-8").splitlines()


def read_only(array: npt.NDArray[Any]) -> None:
    """That nobody can write to it."""
    assert not array.flags.writeable
    with pytest.raises(ValueError, match="read-only"):
        array[...] = 0


def borrowed(array: npt.NDArray[Any], shape: tuple[int, ...], kind: type[np.generic]) -> None:
    """Shape and type, read-only, and that NumPy looks at memory that it did not copy."""
    assert array.shape == shape
    assert array.dtype.type is kind
    assert array.flags.c_contiguous
    assert not array.flags.owndata
    assert array.base is not None
    read_only(array)
