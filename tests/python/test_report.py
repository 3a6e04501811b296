"""The page of `wythe report` in a browser: it draws, responds, and requests nothing."""

import shutil
import subprocess
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

from browser import Browser, find
from conftest import TARGET

WIDE = (1280, 900)
PHONE = (390, 844)
LEFT, RIGHT, HOME = ("ArrowLeft", 37), ("ArrowRight", 39), ("Home", 36)


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Browser]:
    command = find()
    if command is None:
        pytest.skip("no Chromium here: apt-get install chromium, or name one in CHROMIUM")
    browser = Browser(command, tmp_path_factory.mktemp("profile"))
    yield browser
    browser.close()


def report(folder: Path, page: Path, *more: str) -> Path:
    command = [TARGET / "release" / "wythe", "report", folder, "--out", page, *more]
    done = subprocess.run(command, capture_output=True, text=True, timeout=60)
    assert done.returncode == 0, done.stderr
    return page


@pytest.fixture(scope="module")
def page(couplet: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("report")
    measured = folder / "measured.csv"
    measured.write_text("# invented\ndisplacement_mm,force_kN\n0,0\n0.01,6\n")
    return report(couplet, folder / "report.html", "--experiment", str(measured))


def pixels(png: bytes, folder: Path) -> np.ndarray:
    file = folder / "picture.png"
    file.write_bytes(png)
    reader = vtkPNGReader()
    reader.SetFileName(str(file))
    reader.Update()
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())[:, :3].astype(int)


def drawn(browser: Browser, folder: Path, selector: str) -> float:
    """Fraction of the pixels of an element that differ from its most frequent colour."""
    of = pixels(browser.picture(selector), folder)
    _, counts = np.unique(of, axis=0, return_counts=True)
    return 1 - counts.max() / len(of)


def quiet(browser: Browser, page: Path) -> None:
    assert browser.errors == []
    assert browser.asked == [page.resolve().as_uri()]


@pytest.mark.parametrize("scheme", ["light", "dark"])
@pytest.mark.parametrize("size", [WIDE, PHONE])
def test_the_page_draws_wall_and_curves_and_requests_nothing(
    browser: Browser, page: Path, tmp_path: Path, size: tuple[int, int], scheme: str
) -> None:
    browser.open(page, *size, prefers_color_scheme=scheme)
    # The couplet fills a good part of its stage, in two colours and more.
    assert drawn(browser, tmp_path, "#view") > 0.15
    for chart in ("curve", "energies", "solves", "residuals"):
        assert drawn(browser, tmp_path, f"#{chart}") > 0.005, chart
    assert "peak 5." in str(browser.tell("document.querySelector('#curve').textContent"))
    assert browser.tell("document.querySelectorAll('#curve path.line').length") >= 2
    wide = browser.tell("document.documentElement.scrollWidth")
    assert wide <= size[0], "nothing sticks out"
    paper = browser.tell("getComputedStyle(document.body).backgroundColor.match(/\\d+/g).map(Number)")
    assert (sum(paper) > 384) == (scheme == "light")
    quiet(browser, page)


def test_keys_and_clicks_move_the_run(browser: Browser, page: Path, tmp_path: Path) -> None:
    browser.open(page, *WIDE, prefers_reduced_motion="reduce")
    at = "+document.getElementById('frame').value"
    end = browser.tell("+document.getElementById('frame').max")
    assert end > 3 and browser.tell(at) == end
    last = browser.picture("#view")
    # The slider itself, by keys
    browser.tell("document.getElementById('frame').focus()")
    browser.press(*LEFT)
    assert browser.tell(at) == end - 1
    browser.press(*HOME)
    assert browser.tell(at) == 0
    assert browser.tell("document.getElementById('moment').textContent") == "at rest"
    assert browser.picture("#view") != last
    # The curve, by keys and by a click at its peak
    browser.tell("document.querySelector('#curve svg').focus()")
    browser.press(*RIGHT)
    assert browser.tell(at) == 1
    assert browser.tell("document.querySelector('#curve svg').getAttribute('aria-valuetext')") != ""
    where = browser.tell(
        "(() => { document.querySelector('#curve').scrollIntoView({ block: 'center' });"
        " const b = document.querySelector('#curve circle[r=\"5\"]').getBoundingClientRect();"
        " return [b.x + b.width / 2, b.y + b.height / 2]; })()"
    )
    browser.click(*where)
    clicked = browser.tell(at)
    browser.tell("document.getElementById('to-peak').click()")
    assert browser.tell(at) == clicked
    assert 1 <= clicked <= end
    quiet(browser, page)


def test_colours_magnification_and_the_point_of_view_change_the_picture(
    browser: Browser, page: Path
) -> None:
    browser.open(page, *WIDE, prefers_reduced_motion="reduce")
    seen = {browser.picture("#view")}
    for kind in ("unit", "state"):
        browser.tell(
            "(() => { const s = document.getElementById('colour');"
            f" s.value = '{kind}'; s.dispatchEvent(new Event('change')); }})()"
        )
        seen.add(browser.picture("#view"))
    browser.tell("document.getElementById('magnification').focus()")
    browser.press(*LEFT)
    seen.add(browser.picture("#view"))
    browser.tell("document.getElementById('view').focus()")
    for key in (RIGHT, ("+", 187)):
        browser.press(*key)
        seen.add(browser.picture("#view"))
    assert len(seen) == 6, "each is another picture"
    legend = str(browser.tell("document.getElementById('legend').textContent"))
    assert "failed, open" in legend
    # Every control has a label.
    nameless = browser.tell(
        "[...document.querySelectorAll('input,select,button')].filter(e => !e.labels?.length"
        " && !e.textContent.trim() && !e.getAttribute('aria-label')).length"
    )
    assert nameless == 0
    quiet(browser, page)


def test_a_page_of_a_killed_run(browser: Browser, couplet: Path, tmp_path: Path) -> None:
    folder = tmp_path / "killed.out"
    shutil.copytree(couplet, folder)
    (folder / "summary.json").unlink()
    (folder / "results.vtkhdf").write_text("no HDF5")
    page = report(folder, tmp_path / "killed.html")
    browser.open(page, *PHONE)
    assert browser.tell("document.getElementById('player').hidden")
    assert browser.tell("document.querySelectorAll('#curve path.line').length") >= 1
    assert "going on, or killed" in str(browser.tell("document.body.textContent"))
    quiet(browser, page)


def test_no_deck_gets_script_into_the_page(browser: Browser, couplet: Path, tmp_path: Path) -> None:
    folder = tmp_path / "evil.out"
    shutil.copytree(couplet, folder)
    evil = "</title></script><script>window.evil = 1</script><img src=x onerror='window.evil = 2'>"
    (folder / "model.toml").write_text(f'title = "{evil}"\n# {evil}\n')
    page = report(folder, tmp_path / "evil.html")
    browser.open(page, *WIDE)
    assert browser.tell("window.evil") is None
    assert browser.tell("document.title") == evil
    assert drawn(browser, tmp_path, "#view") > 0.1
    quiet(browser, page)
