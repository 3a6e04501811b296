"""Reading no more than what is asked for, and folders that lack something."""

from __future__ import annotations

import math
import os
import shutil
from pathlib import Path

import pytest
import wythe


def read_so_far() -> int:
    """Bytes that this process has read from files."""
    path = Path("/proc/self/io")
    if not path.is_file():
        pytest.skip("the system does not count what is read")
    return int(path.read_text().split()[1])


def test_fields_are_not_read_before_they_are_asked_for(wall: wythe.Results) -> None:
    size = (Path(wall.path) / "results.vtkhdf").stat().st_size
    began = read_so_far()
    run = wythe.Results(wall.path)
    assert run.history.increments > 0
    assert run.status == "completed"
    small = read_so_far() - began
    # History and summary only.
    limit = sum((Path(wall.path) / name).stat().st_size for name in ("history.csv", "summary.json"))
    assert small < 3 * limit
    assert run.frames > 40
    frame, opened = run.frame(20), read_so_far()
    assert frame.tensile_damage.shape == (len(wall.elements),)
    # One of 44 frames, one of 15 fields: far less than a frame.
    # The file is read once more for its check sum.
    assert read_so_far() - opened < size + size / run.frames
    assert frame.tensile_damage is frame.tensile_damage
    again = read_so_far()
    frame.tensile_damage.sum()
    assert read_so_far() - again < 500


def test_histories_need_no_fields(own: wythe.Results) -> None:
    Path(own.path, "results.vtkhdf").write_bytes(b"no HDF5")
    run = wythe.Results(own.path)
    assert run.history.increments == 164
    assert run.peak_force == pytest.approx(5.573, abs=1e-3)
    assert run.picture("curves").svg.startswith("<svg")
    assert "'a run': completed" in repr(run)
    assert "<svg" in run._repr_html_()
    assert run.model == wythe.templates.couplet("0.02 mm")
    for ask in (lambda: run.frames, lambda: run.title, lambda: run.frame(), lambda: run.nodes):
        with pytest.raises(wythe.OutputError, match=r"results\.vtkhdf"):
            ask()


def test_a_killed_run(killed: wythe.Results) -> None:
    assert not Path(killed.path, "summary.json").exists()
    assert killed.summary == {}
    assert (killed.status, killed.message) == ("unfinished", "")
    assert (killed.warnings, killed.log) == ([], [])
    assert killed.history.increments == 12
    # What the history tells is there; what only the end tells is not.
    assert killed.peak_force == killed.history.force_kN.max()
    at = killed.history.force_kN.argmax()
    assert killed.displacement_at_peak == killed.history.displacement_mm[at]
    assert killed.initial_stiffness > 1000
    assert math.isnan(killed.energy_balance_error)
    assert "unfinished, largest 5.5" in repr(killed)
    assert killed.frames >= 1
    assert killed.frame("peak").displacement.shape == (75, 3)


def test_a_killed_run_goes_on_to_the_same_bytes(
    killed: wythe.Results, model: wythe.Model, tmp_path: Path
) -> None:
    whole = model.run(tmp_path / "whole.out")
    assert killed.status == "unfinished"
    resumed = killed.resume()
    for run in (resumed, killed):
        assert run.status == "completed"
        assert run.history.increments == 20
    history = Path(whole.path, "history.csv").read_bytes()
    assert Path(killed.path, "history.csv").read_bytes() == history
    assert (killed.frame().stress == whole.frame().stress).all()


def test_the_path_of_a_run(
    own: wythe.Results, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("", "results.vtkhdf", "history.csv"):
        assert wythe.Results(Path(own.path) / name).history.increments == 164
    monkeypatch.chdir(own.path)
    assert wythe.Results("results.vtkhdf").peak_force == own.peak_force
    for wrong in (tmp_path / "none", tmp_path):
        with pytest.raises(wythe.OutputError, match="no results of a run") as raised:
            wythe.Results(wrong)
        assert "--" not in raised.value.fix
    with pytest.raises(TypeError, match=r"path: expected a path \(str or os.PathLike\), got 3"):
        wythe.Results(3)  # type: ignore[arg-type]
    (tmp_path / "history.csv").write_text("a,b\n1,2\n")
    with pytest.raises(wythe.OutputError, match=r"history\.csv:1: the columns are not those"):
        wythe.Results(tmp_path)


def test_a_folder_without_its_deck(own: wythe.Results) -> None:
    os.remove(Path(own.path, "model.toml"))
    assert own.deck is None
    with pytest.raises(wythe.OutputError, match=r"model\.toml"):
        own.model  # noqa: B018
    with pytest.raises(wythe.OutputError, match=r"there is no model\.toml"):
        own.resume()


def test_a_cut_row_is_left_out(killed: wythe.Results) -> None:
    path = Path(killed.path, "history.csv")
    path.write_bytes(path.read_bytes()[:-20])
    assert wythe.Results(killed.path).history.increments == 11


def test_files_that_the_deck_names_are_found_from_the_results(tmp_path: Path) -> None:
    """They lie beside the deck, not in the folder of the run."""
    decks = tmp_path / "decks"
    decks.mkdir()
    (decks / "measured.csv").write_text("displacement_mm,force_kN\n0,0\n0.01,5\n")
    deck = wythe.templates.couplet("0.02 mm").with_({"output.experiment": "measured.csv"})
    deck.save(decks / "couplet.toml")
    model = wythe.Model.from_toml(decks / "couplet.toml")
    stopped = model.run(tmp_path / "out", callback=lambda row: row.increment < 5)
    assert stopped.model == model
    assert stopped.model.check()
    assert stopped.resume().status == "completed"
    moved = wythe.Results(shutil.move(stopped.path, tmp_path / "moved"))
    assert moved.model == model


def test_resuming_with_other_values(own: wythe.Results) -> None:
    assert own.resume().history.increments == 164
    longer = own.resume({"steps.1.displacement": "0.03 mm", "output.every": 1})
    assert longer.history.displacement_mm[-1] == pytest.approx(0.036)
    assert own.model.to_dict()["output"]["every"] == 1
    with pytest.raises(
        wythe.ModelError, match="wall.courses was 2 when the run began, and is 3 now"
    ) as raised:
        own.resume({"wall.courses": 3})
    assert "`wythe" not in raised.value.fix
    with pytest.raises(wythe.ModelError, match="not longer"):
        own.resume({"steps.1.displacement": "0.001 mm"})
    with pytest.raises(wythe.ModelError) as raised:
        own.resume({"wall.curses": 3})
    assert (raised.value.key, raised.value.file) == ("wall.curses", None)
    with pytest.raises(TypeError, match="changes: expected a mapping"):
        own.resume(3)  # type: ignore[arg-type]
    assert own.status == "completed"


def test_resuming_can_be_watched(killed: wythe.Results, capsys: pytest.CaptureFixture[str]) -> None:
    seen: list[int] = []
    killed.resume(callback=lambda row: seen.append(row.increment), progress=True, threads=1)
    # The checkpoint is the first increment or later.
    assert seen[-1] == 20
    assert seen == list(range(seen[0], 21))
    assert "couplet: completed" in capsys.readouterr().err


def test_a_run_has_a_verdict(couplet: wythe.Results) -> None:
    assert couplet.verdict_kind == "peak_passed"
    assert couplet.verdict.startswith("peak of ")
