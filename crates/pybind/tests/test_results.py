"""Results: what is in them, in which shapes, and that it is what other readers of the files see."""

from __future__ import annotations

import math
import pickle
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import wythe
from helpers import borrowed

h5py = pytest.importorskip("h5py")

Fields = dict[str, tuple[tuple[int, ...], type[np.generic]]]
#: Fields of a frame: their trailing shape and type.
OF_NODES: Fields = {"displacement": ((3,), np.float64)}
OF_ELEMENTS: Fields = {
    "stress": ((6,), np.float64),
    "principal_stress": ((3,), np.float64),
    "plastic_strain": ((6,), np.float64),
    "tensile_damage": ((), np.float64),
    "compressive_damage": ((), np.float64),
    "crack_width": ((), np.float64),
    "yielded": ((), np.bool_),
}
OF_POINTS: Fields = {
    "opening": ((), np.float64),
    "slip": ((2,), np.float64),
    "traction": ((3,), np.float64),
    "damage": ((), np.float64),
    "state": ((), np.uint8),
}


def of_file(run: wythe.Results) -> Any:
    return h5py.File(Path(run.path) / "results.vtkhdf")


def test_the_mesh(wall: wythe.Results) -> None:
    nodes, elements = len(wall.nodes), len(wall.elements)
    borrowed(wall.nodes, (nodes, 3), np.float64)
    borrowed(wall.elements, (elements, 8), np.uint32)
    borrowed(wall.material, (elements,), np.uint16)
    borrowed(wall.unit, (elements,), np.uint32)
    borrowed(wall.course, (elements,), np.uint16)
    assert (nodes, elements) == (wall.summary["nodes"], wall.summary["elements"])
    assert wall.nodes.max(axis=0).tolist() == [420.5, 98.0, 4 * 50.0 + 3 * 12.5]
    assert wall.elements.max() == nodes - 1
    assert wall.materials == ("brick", "mortar")
    assert set(wall.course.tolist()) == {0, 1, 2, 3}
    with of_file(wall) as file:
        solids = file["VTKHDF"]
        assert (solids["Points"][:] == wall.nodes).all()
        assert (solids["Connectivity"][:].reshape(-1, 8) == wall.elements).all()
        for name in ("material", "unit", "course"):
            assert (solids["CellData"][name][:elements] == getattr(wall, name)).all()
        assert (wall.title, wall.version) == (
            file["model"].attrs["title"],
            file["model"].attrs["version"],
        )


@pytest.mark.parametrize("number", [0, 7, -1])
def test_fields_are_those_of_the_file(wall: wythe.Results, number: int) -> None:
    frame = wall.frame(number)
    at = frame.number
    with of_file(wall) as file:
        solids = file["VTKHDF"]
        for group, rows, fields in (
            ("PointData", len(wall.nodes), OF_NODES),
            ("CellData", len(wall.elements), OF_ELEMENTS),
        ):
            for name, (trailing, kind) in fields.items():
                array = getattr(frame, name)
                borrowed(array, (rows, *trailing), kind)
                assert (array == solids[group][name][at * rows : (at + 1) * rows]).all(), name
                assert getattr(frame, name) is array
        assert solids["Steps"]["Values"][at] == frame.time
        assert file["history"]["frame_increment"][at] == frame.increment
    assert frame.velocity.shape == (0, 3)
    assert not frame.velocity.flags.writeable
    assert f"<wythe.Frame {at}: t = " in repr(frame)


def test_points_are_those_of_the_file(wall: wythe.Results) -> None:
    points = wall.interfaces(5)
    count, corners = len(points), len(points.corners)
    borrowed(points.corners, (corners, 3), np.float64)
    borrowed(points.quads, (count, 4), np.uint32)
    borrowed(points.displacement, (corners, 3), np.float64)
    assert count == wall.summary["contact_points"]
    with of_file(wall) as file:
        joints = file["interfaces"]
        for name, (trailing, kind) in OF_POINTS.items():
            array = getattr(points, name)
            borrowed(array, (count, *trailing), kind)
            assert (array == joints["CellData"][name][5 * count : 6 * count]).all(), name
        assert (joints["Points"][:] == points.corners).all()
        assert (joints["Connectivity"][:].reshape(-1, 4) == points.quads).all()
    assert (wall.frame(5).interfaces.traction == points.traction).all()
    assert repr(points) == f"<wythe.Interfaces of frame 5: {count} points>"


def test_velocities_where_there_is_inertia() -> None:
    run = wythe.templates.column("20 ms").run()
    borrowed(run.frame().velocity, run.nodes.shape, np.float64)
    assert abs(run.frame().velocity).max() > 100.0


def test_a_model_without_interfaces() -> None:
    alone = wythe.build.blocks(
        [wythe.build.block("only", "stone", [10, 10, 10])],
        materials={"stone": wythe.build.elastic(5000, 0.2)},
        interfaces={},
        contacts=[],
        supports=[wythe.build.support("only.bottom")],
        steps=[wythe.build.drive("1 um", "z", face="only.top")],
    )
    run = alone.run()
    points = run.interfaces()
    assert len(points) == 0
    for name, (trailing, _) in OF_POINTS.items():
        assert getattr(points, name).shape == (0, *trailing), name
    assert points.displacement.shape == points.corners.shape == (0, 3)
    assert points.quads.shape == (0, 4)
    assert run.mesh().n_cells == len(run.elements) == 1


def test_frames_by_number_and_name(wall: wythe.Results) -> None:
    borrowed(wall.times, (wall.frames,), np.float64)
    last = wall.frames - 1
    assert wall.frame().number == wall.frame("last").number == wall.frame(-1).number == last
    assert wall.frame(0).number == wall.frame(-wall.frames).number == 0
    assert wall.frame(np.int32(3)).number == 3
    assert wall.frame(last).increment == wall.history.increments
    peak = int(np.argmax(wall.history.force_kN))
    nearest = int(np.argmin(abs(wall.times - wall.history.time[peak])))
    assert wall.frame("peak").number == nearest
    assert wall.frame("peak").time == wall.times[nearest]
    for number in (wall.frames, -wall.frames - 1):
        with pytest.raises(
            IndexError, match=f"there is no frame {number}: the run has {wall.frames}"
        ):
            wall.frame(number)
    for wrong in (1.0, None, True, [1]):
        with pytest.raises(TypeError, match="frame: expected a number, 'peak' or 'last'"):
            wall.frame(wrong)  # type: ignore[arg-type]
    with pytest.raises(ValueError, match="got 'first'"):
        wall.frame("first")  # type: ignore[arg-type]


def test_the_summary_and_its_figures(wall: wythe.Results) -> None:
    summary = wall.summary
    assert wall.peak_force == summary["peak_force_kN"] == wall.history.force_kN.max()
    assert wall.displacement_at_peak == summary["displacement_at_peak_mm"]
    at = np.argmax(wall.history.force_kN)
    assert wall.history.displacement_mm[at] == wall.displacement_at_peak
    assert wall.initial_stiffness == summary["initial_stiffness_kN_per_mm"] > 0
    assert wall.energy_balance_error == summary["energy_balance_error"] < 0.01
    assert wall.status == "completed"
    assert wall.warnings == summary["warnings"]
    assert wall.log == summary["log"]
    eighty = summary["displacement_at_80_percent_mm"]
    assert math.isnan(wall.displacement_at_80_percent) == (eighty is None)


def test_half_of_a_wall_is_shown_whole(tmp_path: Path) -> None:
    shear = wythe.templates.shear_wall(drive="0.05 mm", length="420.5 mm", courses=4)
    shear = shear.with_(output__every=1, steps__0__tolerance__residual=1e-3)
    full, auto = (
        shear.with_(fidelity=fidelity).run(tmp_path / fidelity) for fidelity in ("full", "auto")
    )
    assert any("one half of it is solved" in told for told in auto.log)
    assert (full.summary["mirror_planes"], auto.summary["mirror_planes"]) == ([], ["y = 49 mm"])
    assert auto.summary["dofs"] < 0.6 * full.summary["dofs"]
    assert auto.summary["elements"] == full.summary["elements"]
    a, b = full.frame("last"), auto.frame("last")
    assert a.displacement.shape == b.displacement.shape
    # What the tolerance leaves of each increment.
    assert auto.peak_force == pytest.approx(full.peak_force, rel=0.01)
    assert abs(a.displacement - b.displacement).max() < 0.01 * abs(a.displacement).max()
    assert abs(a.stress - b.stress).max() < 0.02 * abs(a.stress).max()


def test_what_was_not_driven_has_no_peak() -> None:
    run = wythe.templates.arch().with_({"steps.1": None}).run()
    figures = (run.peak_force, run.displacement_at_peak, run.initial_stiffness)
    assert all(map(math.isnan, figures))
    assert run.frame("peak").number == run.frame("last").number
    assert "peak" not in repr(run)


def test_results_show_themselves(couplet: wythe.Results) -> None:
    shown = repr(couplet)
    assert shown.startswith(
        "<wythe.Results 'couplet': completed, peak 5.573 kN at 0.0032 mm, 164 incr"
    )
    assert couplet.path in shown
    assert "<svg" in couplet._repr_html_()


def test_results_can_be_pickled(couplet: wythe.Results) -> None:
    again = pickle.loads(pickle.dumps(couplet))
    assert again.path == couplet.path
    assert (again.frame(3).stress == couplet.frame(3).stress).all()


def test_results_know_their_run(model: wythe.Model, tmp_path: Path) -> None:
    first = model.run(tmp_path / "out")
    peak = first.peak_force
    second = model.with_({"interfaces.joint.f_t": "1 MPa"}).run(tmp_path / "out")
    assert first.peak_force == peak != second.peak_force
    with pytest.raises(wythe.OutputError, match="another run was written into the folder"):
        _ = first.history
    assert wythe.Results(tmp_path / "out").peak_force == second.peak_force


def test_results_are_read_from_any_working_folder(
    model: wythe.Model, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    run = model.run("out")
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path / "other")
    assert run.path == "out"
    assert len(run.history["force_kN"]) == run.summary["increments"]


@pytest.mark.parametrize("height", [-1.0, 0.0, math.nan])
def test_heights_are_positive(couplet: wythe.Results, height: float) -> None:
    with pytest.raises(ValueError, match="height: expected a number above 0"):
        couplet.compare(Path(couplet.path) / "history.csv", height=height)
    with pytest.raises(TypeError, match="height: expected a number above 0"):
        couplet.compare(Path(couplet.path) / "history.csv", height="1 m")  # type: ignore[arg-type]
