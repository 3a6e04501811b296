"""What is made of a run's folder: reports, comparisons, exports, rescued messages."""

from __future__ import annotations

import json
import shutil
from pathlib import Path
from xml.etree import ElementTree

import numpy as np
import pytest
import wythe
from helpers import lines, python


def test_a_report(own: wythe.Results, measured: Path, tmp_path: Path) -> None:
    page = own.report()
    assert page == str(Path(own.path) / "report.html")
    assert Path(page).read_text().startswith("<!doctype html>")
    named = own.report(tmp_path / "page.html", experiment=measured)
    assert named == str(tmp_path / "page.html")
    assert "measured" in Path(named).read_text()
    with pytest.raises(wythe.OutputError) as raised:
        own.report(tmp_path / "no" / "page.html")
    assert raised.value.errno == 2
    with pytest.raises(TypeError, match="out: expected a path"):
        own.report(3)  # type: ignore[arg-type]


def test_a_comparison_is_that_of_the_command(own: wythe.Results, measured: Path) -> None:
    found = own.compare(measured, height=100)
    done = python("-m", "wythe", "compare", own.path, str(measured), "--json", "--height", "100")
    assert done.returncode == 0, done.stderr
    assert found == json.loads(done.stdout)
    assert found["experiment"]["peak_force_kN"] == 5.0
    assert found["run"]["peak_force_kN"] == own.peak_force
    assert found["ratio"]["peak_force_kN"] == pytest.approx(own.peak_force / 5.0)
    assert found["height_mm"] == 100.0
    assert found["rms_difference_kN"] > 0.0
    itself = own.compare(Path(own.path) / "history.csv")
    assert itself["rms_difference_kN"] == 0.0
    assert itself["height_mm"] is None


def test_curves_that_are_none(own: wythe.Results, tmp_path: Path) -> None:
    (tmp_path / "bad.csv").write_text("a,b\n1,2\n")
    for ask in (own.compare, own.plot):
        with pytest.raises(
            wythe.ModelError, match=r"bad\.csv:1: no column of displacement"
        ) as raised:
            ask(tmp_path / "bad.csv")
        assert raised.value.fix
        with pytest.raises(wythe.OutputError, match="cannot be read"):
            ask(tmp_path / "none.csv")


def test_vtu(own: wythe.Results, tmp_path: Path) -> None:
    files = own.export("vtu", frame="peak")
    number = own.frame("peak").number
    names = [f"frame_{number:04}.vtu", f"frame_{number:04}_interfaces.vtu"]
    assert files == [str(Path(own.path, "export", name)) for name in names]
    assert all(ElementTree.parse(file).getroot().tag == "VTKFile" for file in files)
    everything = own.export("vtu", tmp_path / "all", frame=None)
    assert len(everything) == 2 * own.frames + 1
    assert everything[-1] == str(tmp_path / "all" / "series.pvd")
    sets = ElementTree.parse(everything[-1]).getroot().iter("DataSet")
    times = [float(entry.attrib["timestep"]) for entry in sets]
    assert times == own.times.tolist()


def test_csv(own: wythe.Results, tmp_path: Path) -> None:
    nodes, elements, points = own.export("csv", tmp_path, frame=0)
    table = np.genfromtxt(nodes, delimiter=",", names=True)
    assert len(table) == len(own.nodes)
    assert len(lines(elements)) == len(own.elements) + 1
    assert len(lines(points)) == len(own.interfaces()) + 1


def test_inp(own: wythe.Results, tmp_path: Path) -> None:
    (file,) = own.export("inp", tmp_path / "new")
    assert file == str(tmp_path / "new" / "model.inp")
    assert Path(file).read_text() == own.model.to_inp()


def test_exports_that_are_none(own: wythe.Results, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="to: expected 'vtu', 'csv' or 'inp', got 'stl'"):
        own.export("stl")  # type: ignore[arg-type]
    (tmp_path / "file").write_text("")
    for to in ("vtu", "csv", "inp"):
        with pytest.raises(wythe.OutputError):
            own.export(to, tmp_path / "file")


def test_messages_are_rescued(own: wythe.Results, tmp_path: Path) -> None:
    messages = Path(own.path) / "run.mcap"
    whole: wythe.Salvaged = wythe.salvage(messages)
    assert whole["was_whole"] is True
    assert whole["lost_bytes"] == 0
    assert whole["messages"] > 164
    assert whole["attachments"] == 1
    cut = tmp_path / "cut.mcap"
    cut.write_bytes(messages.read_bytes()[:-5000])
    found = wythe.salvage(cut, tmp_path / "rescued.mcap")
    assert found["was_whole"] is False
    assert 0 < found["messages"] <= whole["messages"]
    assert wythe.salvage(tmp_path / "rescued.mcap") == {**found, "was_whole": True, "lost_bytes": 0}
    shutil.copy(cut, tmp_path / "again.mcap")
    assert wythe.salvage(tmp_path / "again.mcap") == found
    assert (tmp_path / "again.mcap").read_bytes() == (tmp_path / "rescued.mcap").read_bytes()
    with pytest.raises(wythe.OutputError) as raised:
        wythe.salvage(tmp_path / "none.mcap")
    assert raised.value.errno == 2
    (tmp_path / "text").write_text("no messages")
    with pytest.raises(wythe.OutputError, match="no MCAP file"):
        wythe.salvage(tmp_path / "text")


def test_saving_a_model_where_none_can_be(model: wythe.Model, tmp_path: Path) -> None:
    with pytest.raises(wythe.OutputError, match="cannot be written: No such file") as raised:
        model.save(tmp_path / "no" / "model.toml")
    assert raised.value.errno == 2
