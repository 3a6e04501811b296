"""Runs the notebooks of examples/ and stores them with their outputs.

    python crates/pybind/tests/store_notebooks.py

Progress on standard error, times of execution and the versions of the kernel are not stored, so that only results differ
from one run to the next.
"""

from __future__ import annotations

from pathlib import Path

import nbclient
import nbformat

EXAMPLES = Path(__file__).resolve().parents[3] / "examples"


def store(path: Path) -> None:
    book = nbformat.read(path, as_version=4)
    nbclient.NotebookClient(
        book,
        timeout=600,
        kernel_name="python3",
        record_timing=False,
        resources={"metadata": {"path": str(EXAMPLES)}},
    ).execute()
    for cell in book.cells:
        if cell.cell_type == "code":
            cell.outputs = [out for out in cell.outputs if out.get("name") != "stderr"]
    book.metadata.get("language_info", {}).pop("version", None)
    nbformat.write(book, path)


if __name__ == "__main__":
    for notebook in sorted(EXAMPLES.glob("*.ipynb")):
        store(notebook)
        print(notebook.name)
