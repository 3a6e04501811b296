"""The command by way of the package."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import wythe


def test_exit_codes_are_those_of_the_command(
    tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    deck = tmp_path / "couplet.toml"
    deck.write_text(wythe.templates.text("couplet"))
    assert wythe.command(["check", str(deck)]) == 0
    assert "2 units" in capfd.readouterr().out
    assert wythe.command(["check", str(tmp_path / "nothing.toml")]) == 4
    assert wythe.command(["check", str(deck), "--set", "wall.courses=0"]) == 2
    assert "wall.courses" in capfd.readouterr().err


def test_arguments_must_be_texts() -> None:
    with pytest.raises(TypeError, match="arguments: expected a sequence of str"):
        wythe.command("check wall.toml")


def test_the_module_is_the_command() -> None:
    said = subprocess.run(
        [sys.executable, "-m", "wythe", "--version"], capture_output=True, text=True, check=True
    )
    assert said.stdout.strip() == f"wythe {wythe.__version__}"
