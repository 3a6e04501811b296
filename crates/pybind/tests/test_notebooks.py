"""The notebooks run from their first cell to their last, and are stored with the outputs of these cells."""

from __future__ import annotations

import sys
import tempfile
from pathlib import Path
from typing import Any

import pytest

nbformat = pytest.importorskip("nbformat")
nbclient = pytest.importorskip("nbclient")
pytest.importorskip("ipykernel")

EXAMPLES = Path(__file__).parents[3] / "examples"
NOTEBOOKS = sorted(EXAMPLES.glob("*.ipynb"))


def test_there_are_five() -> None:
    assert len(NOTEBOOKS) == 5


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_runs(path: Path, monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    book = nbformat.read(path, as_version=4)
    stored = [kinds(cell) for cell in book.cells]
    assert any(stored), "stored without outputs: python crates/pybind/tests/store_notebooks.py"
    # The kernel of this interpreter, whatever others are installed.
    kernel = tmp_path / "kernels" / "python3"
    kernel.mkdir(parents=True)
    (kernel / "kernel.json").write_text(
        '{"argv": ["%s", "-m", "ipykernel_launcher", "-f", "{connection_file}"], '
        '"display_name": "Python 3", "language": "python"}' % sys.executable
    )
    monkeypatch.setenv("JUPYTER_PATH", str(tmp_path))
    monkeypatch.setenv("MPLBACKEND", "module://matplotlib_inline.backend_inline")
    client = nbclient.NotebookClient(
        book, timeout=300, kernel_name="python3", resources={"metadata": {"path": str(EXAMPLES)}}
    )
    client.execute()
    again = "run python crates/pybind/tests/store_notebooks.py"
    assert [kinds(cell) for cell in book.cells] == stored, again


def kinds(cell: Any) -> list[tuple[str, ...]]:
    """What a cell shows: the types of its outputs and of their data, progress left out."""
    return [
        (out["output_type"], *sorted(out.get("data", {})))
        for out in cell.get("outputs", [])
        if out.get("name") != "stderr"
    ]


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_outputs_name_no_folder_of_a_machine(path: Path) -> None:
    text = path.read_text(encoding="utf-8")
    places = [EXAMPLES.parent, Path.home(), Path(tempfile.gettempdir())]
    assert not [place for place in places if f"{place}/" in text]
