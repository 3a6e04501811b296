"""Folders of results that the tests read."""

import os
import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
HINT = "run tests/run: it builds what these tests read"


@pytest.fixture(scope="session")
def known() -> Path:
    """Fields known in closed form, written by tests/verification/results/files.rs."""
    folder = TARGET / "tmp" / "known_fields.out"
    assert (folder / "summary.json").is_file(), HINT
    return folder


@pytest.fixture(scope="session")
def couplet(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Example 01 pulled beyond its peak, to 0.02 mm in two steps, by the command."""
    command = TARGET / "release" / "wythe"
    assert command.is_file(), HINT
    folder = tmp_path_factory.mktemp("couplet")
    model = shutil.copy(ROOT / "examples" / "01_couplet_tension.toml", folder / "couplet.toml")
    done = subprocess.run(
        [command, "run", model, "--set", "steps.1.displacement=0.014"],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return folder / "couplet.out"
