"""The examples in Python run and look alike; the code of the READMEs speaks of what there is."""

from __future__ import annotations

import ast
import re
import shutil
from pathlib import Path

import pytest
import wythe
from helpers import EXAMPLES, ROOT, python

SCRIPTS = sorted(EXAMPLES.glob("[0-9][0-9]_*.py"))

#: Those are run by test_study_examples.py.
STUDIES = ("11_bond_scatter", "12_sensitivity")


@pytest.fixture
def copies(tmp_path: Path) -> Path:
    """The examples where they may write."""
    for pattern in ("*.toml", "*.py", "*.csv", "*.inp"):
        for path in EXAMPLES.glob(pattern):
            shutil.copy(path, tmp_path)
    return tmp_path


@pytest.mark.parametrize("name", [path.stem for path in SCRIPTS if path.stem not in STUDIES])
def test_a_script_runs(name: str, copies: Path) -> None:
    done = python(f"{name}.py", folder=copies)
    assert done.returncode == 0, done.stderr
    assert done.stdout
    assert list(copies.glob(f"{name}.out/*"))


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_script_begins_with_a_drawing(script: Path) -> None:
    head = script.read_text(encoding="utf-8").split("\n\n")[0].splitlines()
    assert all(line.startswith("#") for line in head)
    assert any("┌" in line for line in head)
    assert f"#     python examples/{script.name}" in "\n".join(head)
    assert max(map(len, script.read_text(encoding="utf-8").splitlines())) <= 120


def test_the_five_lines_of_the_readmes_speak_of_what_is_there() -> None:
    for page in (ROOT / "README.md", ROOT / "crates" / "pybind" / "README.md"):
        blocks = re.findall(r"```python\n(.*?)```", page.read_text(encoding="utf-8"), re.S)
        assert blocks
        for block in blocks:
            ast.parse(block)
            for name in re.findall(r"wythe\.([\w.]+)\(", block):
                thing: object = wythe
                for part in name.split("."):
                    thing = getattr(thing, part)
            for name in re.findall(r"run\.(\w+)", block):
                assert hasattr(wythe.Results, name), name


def test_the_five_lines_of_the_readme_run_without_other_packages(tmp_path: Path) -> None:
    (block,) = re.findall(r"```python\n(.*?)```", (ROOT / "README.md").read_text("utf-8"), re.S)
    assert len(block.splitlines()) == 5
    # An environment into which only the wheel and NumPy were installed.
    missing = "import sys; sys.modules.update(dict.fromkeys(['matplotlib', 'pyvista', 'pandas', 'dask']))\n"
    shown = "import webbrowser; webbrowser.open = print\n"
    (tmp_path / "five.py").write_text(missing + shown + block, encoding="utf-8")
    done = python("five.py", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    page = tmp_path / "wall.html"
    assert done.stdout.strip() == page.resolve().as_uri()
    assert "<canvas" in page.read_text(encoding="utf-8")
