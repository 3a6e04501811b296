"""Runs that cannot: lost convergence, folders that cannot be written, folders that are busy."""

from __future__ import annotations

import os
import pickle
from pathlib import Path

import pytest
import wythe
from helpers import EXAMPLES


@pytest.fixture
def stuck(model: wythe.Model) -> wythe.Model:
    """Static, in two iterations, in increments of half of the softening or not at all."""
    return model.with_(
        {
            "steps.1.procedure": "static",
            "steps.1.increments": {"initial": 0.5, "max": 1.0, "min": 0.4},
            "steps.1.tolerance.max_iterations": 2,
        }
    )


def test_lost_convergence_keeps_the_results(stuck: wythe.Model) -> None:
    with pytest.raises(wythe.ConvergenceError) as raised:
        stuck.run()
    error = raised.value
    assert isinstance(error, wythe.WytheError)
    assert isinstance(error, RuntimeError)
    assert str(error) == error.message == error.results.message
    for said in ("step 1 (softening)", "no equilibrium within 2 iterations", "try steps.1."):
        assert said in error.message
    run = error.results
    assert run.status == "not_converged"
    assert set(run.history.step) == {0}
    assert run.peak_force > 5.0
    assert run.frame().displacement.shape == (75, 3)
    assert "not converged" in repr(run)
    # The folder lives as long as the results, not as the error.
    del error, raised
    assert os.path.isdir(run.path)


def test_lost_convergence_is_lost_again(stuck: wythe.Model, tmp_path: Path) -> None:
    with pytest.raises(wythe.ConvergenceError) as first:
        stuck.run(tmp_path / "out")
    with pytest.raises(wythe.ConvergenceError) as second:
        first.value.results.resume()
    assert second.value.message == first.value.message
    assert second.value.results.history.increments == first.value.results.history.increments


def test_dry_blocks_that_nothing_presses() -> None:
    """A lifted block floats: the model is refused, with what is missing, before anything runs."""
    lifted = wythe.build.blocks(
        [
            wythe.build.block("lower", "stone", [40, 20, 10]),
            wythe.build.block("upper", "stone", [40, 20, 10], [0, 0, 12]),
        ],
        materials={"stone": wythe.build.elastic("5 GPa", 0.2, density="2000 kg/m^3")},
        interfaces={"dry": wythe.build.dry_joint(0.5)},
        contacts=[wythe.build.contact("dry", "upper.bottom", "lower.top")],
        supports=[wythe.build.support("lower.bottom")],
        steps=[wythe.build.gravity()],
    )
    assert not lifted.check()
    with pytest.raises(wythe.ModelError, match="upper"):
        lifted.run()


def unwritable(tmp_path: Path) -> Path:
    """A folder in which nothing can be made: one without permissions, or where they do not count (for the
    administrator) one of the kernel's.
    """
    folder = tmp_path / "sealed"
    folder.mkdir()
    folder.chmod(0o555)
    if not os.access(folder, os.W_OK):
        return folder
    kernel = Path("/sys/kernel")
    if kernel.is_dir() and os.geteuid() == 0:
        return kernel
    pytest.skip("nothing is forbidden here")


def test_a_folder_that_cannot_be_written(model: wythe.Model, tmp_path: Path) -> None:
    folder = unwritable(tmp_path)
    with pytest.raises(wythe.OutputError) as raised:
        model.run(folder / "out")
    error = raised.value
    assert isinstance(error, wythe.WytheError)
    assert isinstance(error, OSError)
    assert error.errno in (1, 13, 30)
    assert str(folder / "out") in str(error)
    assert "check the permissions" in error.fix
    assert str(error).endswith(f"fix: {error.fix}")
    with pytest.raises(wythe.OutputError):
        model.run(folder)


def test_a_file_in_the_way(model: wythe.Model, tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(wythe.OutputError, match="this is a file, but the results need a folder"):
        model.run(tmp_path / "file")
    with pytest.raises(wythe.OutputError, match="cannot be created"):
        model.run(tmp_path / "file" / "below")
    assert (tmp_path / "file").read_text() == "mine"
    (tmp_path / "out" / "history.csv").mkdir(parents=True)
    with pytest.raises(wythe.OutputError, match=r"history\.csv: cannot be written") as raised:
        model.run(tmp_path / "out")
    assert raised.value.errno == 21


def test_two_runs_do_not_write_into_one_folder(model: wythe.Model, tmp_path: Path) -> None:
    refused: list[str] = []

    def meanwhile(row: wythe.Increment) -> None:
        if row.increment == 2:
            for second in (model.run, lambda out: wythe.Results(out).resume()):
                with pytest.raises(wythe.OutputError) as raised:
                    second(tmp_path / "out")
                refused.append(str(raised.value))

    run = model.run(tmp_path / "out", callback=meanwhile)
    assert run.status == "completed"
    assert len(refused) == 2
    assert all("another run is writing its results into this folder" in said for said in refused)
    assert not any("--" in said for said in refused)


def test_a_folder_can_be_run_into_again(model: wythe.Model, tmp_path: Path) -> None:
    before = model.run(tmp_path / "out").history
    (tmp_path / "out" / "notes.txt").write_text("mine")
    second = model.with_(steps__1__displacement="0.01 mm").run(tmp_path / "out")
    assert second.history.displacement_mm[-1] < before.displacement_mm[-1]
    assert (tmp_path / "out" / "notes.txt").read_text() == "mine"


def test_errors_of_models_have_a_kind_that_pickles() -> None:
    text = (EXAMPLES / "01_couplet_tension.toml").read_text()
    for wrong, kind in [
        (text + "\n[", "syntax"),
        (text.replace("[[steps]]", "[[stepz]]", 1), "unknown-key"),
        (text + "\n[[steps]]\n", "missing"),
    ]:
        with pytest.raises(wythe.ModelError) as raised:
            wythe.Model.from_toml(wrong)
        assert raised.value.kind == kind
        assert pickle.loads(pickle.dumps(raised.value)).kind == kind


def test_errors_without_arguments_still_speak() -> None:
    assert str(wythe.OutputError()) == ""
    assert str(wythe.OutputError("why")) == "why"
    assert str(wythe.OutputError(13, "why")) == "why"
    assert str(wythe.ModelError("why")) == "why"
    assert wythe.OutputError("why").fix == ""
    assert issubclass(wythe.RunInterrupted, KeyboardInterrupt)
    assert not issubclass(wythe.RunInterrupted, Exception)
