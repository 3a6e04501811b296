"""Runs the notebooks of examples/ and stores them with their outputs.

    python crates/pybind/tests/store_notebooks.py

Progress on standard error, times of execution, temporary folders and the version of the kernel are not stored.
"""

from __future__ import annotations

import re
import tempfile
from importlib import import_module
from pathlib import Path
from typing import Any

# Packages without types.
nbclient: Any = import_module("nbclient")
nbformat: Any = import_module("nbformat")

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
    text = nbformat.writes(book)
    # Runs without a folder of their own name a temporary one, another each time.
    text = re.sub(re.escape(tempfile.gettempdir()) + r"/[\w./-]+", "a temporary folder", text)
    path.write_text(text + "\n", encoding="utf-8")


if __name__ == "__main__":
    for notebook in sorted(EXAMPLES.glob("*.ipynb")):
        store(notebook)
        print(notebook.name)
