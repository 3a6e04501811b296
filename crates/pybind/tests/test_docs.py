"""The guides of docs/reference work, name everything, and their links lead somewhere."""

from __future__ import annotations

import doctest
import inspect
import re
from pathlib import Path

import pytest
import wythe
from helpers import ROOT, python
from matplotlib import pyplot
from test_names import NAMES

GUIDES = ROOT / "docs" / "reference"
GUIDE, STUDIES, CALIBRATION = (GUIDES / f"{name}.md" for name in ("python", "studies", "calibration"))
TEXT = GUIDE.read_text(encoding="utf-8")


@pytest.mark.parametrize("page", [GUIDE, STUDIES], ids=lambda page: page.stem)
def test_a_guide_works(page: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    if page is STUDIES:
        pytest.importorskip("cloudpickle", reason="the functions of this page are of no module")
        # Workers of our own start sooner than a cluster; test_study_dask.py has those.
        monkeypatch.setattr("wythe._study._dask.is_there", lambda: False)
    monkeypatch.chdir(tmp_path)
    found = doctest.testfile(
        str(page), module_relative=False, optionflags=doctest.ELLIPSIS, encoding="utf-8"
    )
    pyplot.close("all")
    assert found.attempted > 20
    assert found.failed == 0


@pytest.mark.parametrize(
    "module", [wythe, wythe.build, wythe.templates, wythe.tests], ids=lambda m: str(m.__name__)
)
def test_docstrings_work(module: object) -> None:
    found = doctest.testmod(module)  # type: ignore[arg-type]
    assert found.failed == 0


def test_every_name_is_in_the_guide() -> None:
    """Names of the package; of the classes that the guides describe, their attributes."""
    described = (
        "Model", "Findings", "Problem", "Results", "Frame", "Interfaces", "Picture",
        "Calibration", "CurveFit", "FailedRun", "Posterior",
    )  # fmt: skip
    wanted = {name for name in NAMES if name.count(".") == 1}
    wanted |= {name for name in NAMES if name.split(".")[1] in (*described, "build", "templates")}
    # What only annotations name.
    wanted -= {
        f"wythe.{name}" for name in ("__version__", "Distribution", "Rank", "Ranking", "WorkerDied")
    }
    text = TEXT + STUDIES.read_text(encoding="utf-8") + CALIBRATION.read_text(encoding="utf-8")
    missing = {
        name for name in wanted if not re.search(rf"\b{re.escape(name.split('.')[-1])}\b", text)
    }
    assert not missing


def test_every_command_is_in_the_table() -> None:
    told = python("-m", "wythe", "--help").stdout
    names = re.findall(r"^  (\w+) {2,}\S", told.split("Commands:")[1].split("Options:")[0], re.M)
    assert "run" in names
    table = TEXT.split("## From the command to Python")[1]
    assert {name for name in names if f"`wythe {name}" not in table} == {"help"}


def test_the_parameters_of_templates_are_in_their_table() -> None:
    for name in wythe.templates.__all__:
        maker = getattr(wythe.templates, name)
        if name in ("names", "text"):
            continue
        (row,) = re.findall(rf"^\| `{name}\((.*?)\)`", TEXT, re.M)
        told = [part.strip().rstrip("=") for part in row.split(",")]
        assert told == list(inspect.signature(maker).parameters)


#: Pages outside the site, whose links `mkdocs build --strict` does not see, and the guides.
LINKED = [
    *sorted(ROOT.glob("*.md")),
    ROOT / "examples" / "README.md",
    ROOT / "crates" / "pybind" / "README.md",
    GUIDE,
    STUDIES,
    CALIBRATION,
]


@pytest.mark.parametrize("page", LINKED, ids=lambda page: str(page.relative_to(ROOT)))
def test_links_lead_somewhere(page: Path) -> None:
    def anchors(path: Path) -> set[str]:
        titles = re.findall(r"^#+ (.*)$", path.read_text(encoding="utf-8"), re.M)
        return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}

    for target in re.findall(r"\]\(([^)]+)\)", page.read_text(encoding="utf-8")):
        if target.startswith("http"):
            continue
        file, _, anchor = target.partition("#")
        path = page.parent / file if file else page
        assert path.exists(), target
        assert not anchor or anchor in anchors(path), target


def test_the_readme_is_short() -> None:
    assert len((ROOT / "README.md").read_text(encoding="utf-8").split()) <= 500


def test_lines_are_short() -> None:
    """At most 120 columns, but for tables and output; generated pages have texts of their cases."""
    folders = ("how-to", "tutorials", "reference", "theory", "decisions")
    pages = [page for folder in folders for page in sorted((ROOT / "docs" / folder).glob("*.md"))]
    pages += [ROOT / "README.md", ROOT / "CONTRIBUTING.md", ROOT / "SECURITY.md"]
    assert len(pages) > 50
    long = []
    for page in pages:
        text = re.sub(r"^```(pycon|text)\n.*?^```", "", page.read_text(encoding="utf-8"), flags=re.M | re.S)
        long += [f"{page}: {line}" for line in text.splitlines() if len(line) > 120 and line[0] != "|"]
    assert not long


def test_the_gallery_has_every_example() -> None:
    text = (ROOT / "docs" / "gallery.md").read_text(encoding="utf-8")
    decks = sorted(path.stem for path in (ROOT / "examples").glob("[0-9][0-9]_*.toml"))
    assert decks
    for name in decks:
        assert f"](gallery/{name}.png)" in text, f"{name}: run python docs/gallery.py"
        assert (ROOT / "docs" / "gallery" / f"{name}.png").is_file(), name
    pictures = list((ROOT / "docs" / "gallery").iterdir())
    assert len(pictures) == len(decks)
    # What a reader downloads with the page.
    assert sum(path.stat().st_size for path in pictures) < 3e6


def test_files_that_pages_name_are_there() -> None:
    pages = [*ROOT.glob("*.md"), *(ROOT / "docs").rglob("*.md")]
    pages.remove(ROOT / "CHANGELOG.md")  # of files as they were
    place = r"`((?:crates|tests|benches|examples|docs|src)/[\w./-]+\.\w+)`"
    named = [(page, name) for page in pages for name in re.findall(place, page.read_text("utf-8"))]
    assert len(named) > 50
    missing = [
        f"{page.relative_to(ROOT)}: {name}"
        for page, name in named
        if "NAME" not in name and not (ROOT / name).exists()
    ]
    assert not missing


def test_sources_and_tests_that_the_theory_names_are_there() -> None:
    """Short names too, as the tables of a page write them: `path.rs`, `../assembly/matrix.rs`."""
    sources = [
        path
        for folder in ("crates", "tests", "benches", "examples")
        for path in (ROOT / folder).rglob("*.*")
        if path.suffix in {".rs", ".py"} and "target" not in path.parts
    ]
    files = ["/" + path.relative_to(ROOT).as_posix() for path in sources]
    functions = set()
    for path in sources:
        functions |= set(re.findall(r"\b(?:fn|def) (\w+)", path.read_text(encoding="utf-8")))
    missing, found = [], 0
    for page in (ROOT / "docs" / "theory").glob("*.md"):
        text = page.read_text(encoding="utf-8")
        for name in re.findall(r"`([\w./]+\.rs)`", text):
            found += 1
            if not any(file.endswith("/" + re.sub(r"^(\.\./)+", "", name)) for file in files):
                missing.append(f"{page.name}: {name}")
        for part in text.split("\n## ")[1:]:
            if part.startswith("Verification"):
                # A test's name is long; shorter words in code marks are keys of a deck.
                tests = re.findall(r"`([a-z][a-z0-9]*(?:_[a-z0-9]+){3,})`", part)
                found += len(tests)
                missing += [f"{page.name}: {name}" for name in tests if name not in functions]
    assert found > 200
    assert not missing, "\n".join(missing)


CITATION = re.compile(r"theory/([a-z-]+)\.md(?:, eqs?\. ?(\d+)|, eqs (\d+)(?: (?:to|and) (\d+))?)?")


def test_citations_of_the_theory_lead_to_a_page_and_an_equation() -> None:
    """Citations have the form `theory/PAGE.md, eq. N`; the page shows (N) at the end of a line."""
    pages = {}
    for page in (ROOT / "docs" / "theory").glob("*.md"):
        blocks = re.findall(r"^```[^\n]*\n(.*?)^```", page.read_text(encoding="utf-8"), re.M | re.S)
        numbers = re.findall(r"\((\d+)\)[ \t]*$", "\n".join(blocks), re.M)
        pages[page.stem] = {int(number) for number in numbers}
    assert len(pages) >= 14
    wrong, found = [], 0
    for folder in ("crates", "tests", "benches", "examples", "docs"):
        for path in (ROOT / folder).rglob("*"):
            if path.suffix not in {".rs", ".md", ".toml", ".py"} or "target" in path.parts:
                continue
            text = path.read_text(encoding="utf-8")
            # Old forms: a section of a document that is not in the tree.
            for old in re.findall(r"\btheory [A-G](?:\.\d)?\b", text):
                wrong.append(f"{path}: {old}")
            for page, *numbers in CITATION.findall(text):
                found += 1
                if page not in pages:
                    wrong.append(f"{path}: there is no page theory/{page}.md")
                    continue
                for number in filter(None, numbers):
                    if int(number) not in pages[page]:
                        wrong.append(f"{path}: theory/{page}.md has no equation {number}")
    assert found > 100
    assert not wrong, "\n".join(wrong)
