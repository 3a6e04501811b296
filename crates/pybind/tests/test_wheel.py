"""What the wheel installs: these tests read the installed package, never the sources beside them."""

from __future__ import annotations

import re
import subprocess
import sys
import sysconfig
from importlib import metadata
from pathlib import Path

import wythe
from wythe import _wythe

SOURCES = Path(__file__).resolve().parents[1]
COMMAND = Path(sysconfig.get_path("scripts")) / "wythe"


def run(*arguments: str | Path, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [str(a) for a in arguments], cwd=folder, capture_output=True, text=True, timeout=300
    )


def files() -> set[str]:
    """Installed files of the package, without what Python compiles."""
    listed = metadata.files("wythe")
    assert listed is not None
    return {str(f) for f in listed if f.parts[0] == "wythe" and "__pycache__" not in f.parts}


def test_the_package_is_the_installed_one() -> None:
    site = Path(sysconfig.get_path("platlib")).resolve()
    for module in (wythe, _wythe):
        assert Path(str(module.__file__)).resolve().is_relative_to(site), (
            "tests/run installs the wheel and tests that one"
        )


def test_the_wheel_has_every_file_of_the_sources_and_no_other() -> None:
    here = {
        str(path.relative_to(SOURCES / "python"))
        for path in (SOURCES / "python").rglob("*")
        if path.suffix in {".py", ".pyi", ".typed"}
    }
    assert files() - {"wythe/_wythe.abi3.so"} == here


def test_one_version() -> None:
    assert metadata.version("wythe") == wythe.__version__
    done = run(COMMAND, "--version")
    assert (done.returncode, done.stdout) == (0, f"wythe {wythe.__version__}\n"), done.stderr


def test_extras_and_licences() -> None:
    about = metadata.metadata("wythe")
    assert {"plot", "study"} <= set(about.get_all("Provides-Extra") or [])
    needs = [r for r in metadata.requires("wythe") or [] if "extra ==" not in r]
    assert [re.split(r"[<>=]", r)[0] for r in needs] == ["numpy"]
    assert about["License-Expression"] == "MIT OR Apache-2.0"
    assert {"LICENSE-MIT", "LICENSE-APACHE"} <= set(about.get_all("License-File") or [])


def test_the_command_makes_a_model_and_runs_it(tmp_path: Path) -> None:
    made = run(COMMAND, "new", "couplet", "--template", "couplet", folder=tmp_path)
    assert made.returncode == 0, made.stderr
    deck = next(tmp_path.rglob("*.toml"))
    done = run(COMMAND, "run", deck, "--set", "steps.1.displacement=0.002", folder=tmp_path)
    assert done.returncode == 0, done.stderr
    (folder,) = tmp_path.rglob("*.out")
    assert wythe.Results(folder).status == "completed"


def test_it_is_a_module_too() -> None:
    assert run(sys.executable, "-m", "wythe", "--version").stdout.startswith("wythe ")
    assert (
        run(COMMAND, "check", "nowhere.toml").returncode
        == run(sys.executable, "-m", "wythe", "check", "nowhere.toml").returncode
        != 0
    )
