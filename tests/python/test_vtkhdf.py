"""results.vtkhdf as VTK and h5py read it."""

import csv
import hashlib
import subprocess
from pathlib import Path

import h5py
import numpy as np
import pytest
from conftest import ROOT, TARGET
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader

TIMES = [0.5, 1.0, 1.5, 2.0]
VTK_HEXAHEDRON = 12


def reader_of(path: Path) -> vtkHDFReader:
    reader = vtkHDFReader()
    assert reader.CanReadFile(str(path))
    reader.SetFileName(str(path))
    reader.UpdateInformation()
    return reader


def at(reader: vtkHDFReader, step: int):
    reader.SetStep(step)
    reader.Update()
    return reader.GetOutputDataObject(0)


def points(grid, name: str) -> np.ndarray:
    return vtk_to_numpy(grid.GetPointData().GetArray(name))


def cells(grid, name: str) -> np.ndarray:
    return vtk_to_numpy(grid.GetCellData().GetArray(name))


def principal(stress: np.ndarray) -> np.ndarray:
    """Eigenvalues, the largest first. [element][xx,yy,zz,xy,yz,zx] -> [element][3]"""
    xx, yy, zz, xy, yz, zx = stress.T
    tensor = np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]).transpose(2, 0, 1)
    return np.linalg.eigvalsh(tensor)[:, ::-1]


def table(path: Path) -> dict[str, list[str]]:
    with path.open() as file:
        rows = list(csv.DictReader(file))
    return {name: [row[name] for row in rows] for name in rows[0]}


def test_vtk_sees_every_step(known: Path) -> None:
    reader = reader_of(known / "results.vtkhdf")
    assert reader.GetNumberOfSteps() == len(TIMES)
    information = reader.GetOutputInformation(0)
    key = type(reader.GetExecutive()).TIME_STEPS()
    assert [information.Get(key, i) for i in range(information.Length(key))] == TIMES


@pytest.mark.parametrize("step", range(len(TIMES)))
def test_vtk_reads_the_known_fields(known: Path, step: int) -> None:
    """The formulas of tests/verification/results/files.rs. Equality is exact up to the last bit
    of products taken in another order."""
    grid = at(reader_of(known / "results.vtkhdf"), step)
    t = TIMES[step]
    assert grid.GetNumberOfCells() == 3
    assert {grid.GetCellType(c) for c in range(3)} == {VTK_HEXAHEDRON}
    x = vtk_to_numpy(grid.GetPoints().GetData())
    assert x.shape == (24, 3)
    n = np.arange(24)
    u = np.column_stack([1e-3 * t * x[:, 0], -2e-3 * t * x[:, 1], t * n])
    np.testing.assert_allclose(points(grid, "displacement"), u, rtol=1e-15)
    e = np.arange(3)
    stress = t * (10 * e[:, None] + np.arange(6)[None, :])
    np.testing.assert_allclose(cells(grid, "stress"), stress, rtol=1e-15)
    np.testing.assert_allclose(cells(grid, "plastic_strain"), 1e-3 * stress, rtol=1e-15)
    np.testing.assert_allclose(cells(grid, "tensile_damage"), t * e / 10, rtol=1e-15)
    np.testing.assert_allclose(cells(grid, "compressive_damage"), t / (8 + e), rtol=1e-15)
    np.testing.assert_allclose(cells(grid, "crack_width"), t * e / 100, rtol=1e-15)
    assert cells(grid, "yielded").tolist() == [0, 1, 1]
    # Of the tensor that the six components make, with eigenvalues of another library.
    np.testing.assert_allclose(cells(grid, "principal_stress"), principal(stress), atol=1e-12 * t)
    assert grid.GetPointData().GetArray("velocity") is None
    assert cells(grid, "material").tolist() == [0, 1, 0]
    assert cells(grid, "unit").tolist() == [10, 11, 12]
    assert cells(grid, "course").tolist() == [0, 2, 4]


def test_vtk_reads_the_probe_of_every_step(known: Path) -> None:
    reader = reader_of(known / "results.vtkhdf")
    for step, t in enumerate(TIMES):
        probe = at(reader, step).GetFieldData().GetArray("gap_mm")
        assert probe.GetNumberOfTuples() == 1 and probe.GetValue(0) == -8 * t


def test_the_cells_are_not_inside_out(known: Path) -> None:
    """Positive volume in VTK's own order of nodes: each cube is 100 mm wide."""
    grid = at(reader_of(known / "results.vtkhdf"), 0)
    for c in range(grid.GetNumberOfCells()):
        x = np.array([grid.GetPoints().GetPoint(grid.GetCell(c).GetPointId(i)) for i in range(8)])
        volume = np.dot(np.cross(x[1] - x[0], x[3] - x[0]), x[4] - x[0])
        assert volume == pytest.approx(1e6, rel=1e-12)


def test_h5py_finds_the_layout_of_vtkhdf_2_0(known: Path) -> None:
    with h5py.File(known / "results.vtkhdf") as file:
        root = file["VTKHDF"]
        assert root.attrs["Version"].tolist() == [2, 0]
        kind = root.attrs.get_id("Type")
        assert kind.dtype.kind == "S" and root.attrs["Type"] == b"UnstructuredGrid"
        steps = root["Steps"]
        assert steps.attrs["NSteps"] == len(TIMES)
        assert steps["Values"][:].tolist() == TIMES
        assert steps["NumberOfParts"][:].tolist() == [1] * len(TIMES)
        # One mesh for all steps; every step its own rows of the fields.
        for name in ["NumberOfPoints", "NumberOfCells", "NumberOfConnectivityIds"]:
            assert root[name].shape == (1,)
        for name in ["PartOffsets", "PointOffsets", "CellOffsets", "ConnectivityIdOffsets"]:
            assert not steps[name][:].any()
        assert steps["PointDataOffsets/displacement"][:].tolist() == [0, 24, 48, 72]
        assert steps["CellDataOffsets/stress"][:].tolist() == [0, 3, 6, 9]
        assert not steps["CellDataOffsets/unit"][:].any()
        assert root["CellData/stress"].shape == (12, 6)
        assert root["CellData/stress"].compression == "gzip" and root["CellData/stress"].shuffle
        about = file["model"].attrs
        assert list(about["materials"]) == ["brick", "mortar"]
        assert about["title"] == "Known fields"


def test_a_real_run_agrees_with_its_history(couplet: Path) -> None:
    history = np.genfromtxt(couplet / "history.csv", delimiter=",", names=True)
    reader = reader_of(couplet / "results.vtkhdf")
    last = at(reader, reader.GetNumberOfSteps() - 1)
    x, u = vtk_to_numpy(last.GetPoints().GetData()), points(last, "displacement")
    # The top is tied to the driven beam, the bottom is held.
    top, bottom = x[:, 2] == x[:, 2].max(), x[:, 2] == x[:, 2].min()
    # The same number, by way of decimal digits that read back to the same bits.
    np.testing.assert_array_equal(u[top, 2], history["displacement_mm"][-1])
    assert not u[bottom].any()
    # Uniform enough: mean normal stress times area is the force. Free sides and clamped platens
    # disturb single elements but not the mean over a layer, whose section is in equilibrium up to
    # the tolerance of 5e-3 of the nodal forces.
    layer = cells(last, "course") == 1
    force = cells(last, "stress")[layer, 2].mean() * 204 * 98 * 1e-3
    assert force == pytest.approx(history["force_kN"][-1], rel=1e-2)


def test_the_history_is_that_of_the_csv(couplet: Path) -> None:
    """Every column, every increment: decimal digits that read back to the same bits."""
    wanted = table(couplet / "history.csv")
    with h5py.File(couplet / "results.vtkhdf") as file:
        history = file["history"]
        series = {name for name, item in history.items() if isinstance(item, h5py.Dataset)}
        assert series == set(wanted) | {"frame_increment"}
        for name, values in wanted.items():
            if name == "procedure":
                assert [word.decode() for word in history[name][:]] == values
            else:
                np.testing.assert_array_equal(history[name][:], [float(v) for v in values], name)
        units = {name: history[name].attrs["unit"] for name in wanted}
        assert units["force_kN"] == "kN" and units["elastic_energy_J"] == "J"
        assert units["displacement_mm"] == "mm" and units["time"] == "s" and units["step"] == "1"
        # Frames are increments of the history.
        increments = history["frame_increment"][:]
        np.testing.assert_array_equal(
            history["time"][:][increments - 1], file["VTKHDF/Steps/Values"][:]
        )


def test_reactions_are_in_equilibrium_with_the_force(couplet: Path) -> None:
    with h5py.File(couplet / "results.vtkhdf") as file:
        history = file["history"]
        assert list(history["beams"]) == ["top"] and list(history["supports"]) == ["bottom"]
        top, bottom = history["beams/top"][:], history["supports/bottom"][:]
        assert history["beams/top"].attrs["unit"] == history["supports/bottom"].attrs["unit"] == "N"
        force = 1e3 * history["force_kN"][:]
    assert top.shape == bottom.shape == (len(force), 3)
    np.testing.assert_allclose(top[:, 2], force, rtol=1e-14)
    assert force.max() > 1000
    # No weight: the force above equals the reaction below, up to the residual of the iterations.
    np.testing.assert_allclose(bottom[:, 2], -force, atol=1e-2 * force.max())


def test_the_deck_is_kept_with_a_hash_that_anyone_can_check(couplet: Path) -> None:
    deck = (couplet / "model.toml").read_bytes()
    with h5py.File(couplet / "results.vtkhdf") as file:
        model = file["model"]
        assert model["deck"][()] == deck
        assert model.attrs["hash"] == "sha256:" + hashlib.sha256(deck).hexdigest()
        assert model.attrs["version"].count(".") == 2
        assert model.attrs["title"] == "Couplet in tension"


def test_vtk_reads_the_interfaces_by_way_of_the_sidecar(couplet: Path) -> None:
    sidecar = couplet / "results.interfaces.vtkhdf"
    assert sidecar.stat().st_size < 4096
    reader = reader_of(sidecar)
    with h5py.File(couplet / "results.vtkhdf") as file:
        of = file["interfaces"]
        count = int(of["NumberOfCells"][0])
        steps = int(of["Steps"].attrs["NSteps"])
        assert reader.GetNumberOfSteps() == steps == file["VTKHDF/Steps"].attrs["NSteps"]
        for step in range(0, steps, 7):
            grid = at(reader, step)
            assert grid.GetNumberOfCells() == count
            rows = slice(step * count, (step + 1) * count)
            for name in ["opening", "slip", "traction", "damage", "state"]:
                np.testing.assert_array_equal(cells(grid, name), of["CellData"][name][rows], name)
            np.testing.assert_array_equal(cells(grid, "facet"), of["CellData/facet"][:])
        worst = at(reader, steps - 1)
        largest = file["history/max_interface_damage"][:][file["history/frame_increment"][-1] - 1]
        assert of["CellData/opening"].attrs["unit"] == "mm"
        assert of["CellData/traction"].attrs["unit"] == "MPa"
    assert cells(worst, "damage").max() == largest > 0
    assert set(cells(worst, "state")) <= {0, 1, 2, 3}
    # Quads between the mortar and the upper brick; the brick above moves away.
    assert {worst.GetCellType(c) for c in range(worst.GetNumberOfCells())} == {9}
    assert (cells(worst, "opening") > 0).all()


def test_fields_are_those_of_the_tables(couplet: Path, tmp_path: Path) -> None:
    """The solver's own numbers, by way of `wythe export --to csv`."""
    command = [TARGET / "release" / "wythe", "export", couplet, "--to", "csv", "--out", tmp_path]
    done = subprocess.run(command, capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    tables = {}
    for kind in ("nodes", "elements", "interfaces"):
        (path,) = tmp_path.glob(f"*_{kind}.csv")
        tables[kind] = table(path)
    reader = reader_of(couplet / "results.vtkhdf")
    grid = at(reader, reader.GetNumberOfSteps() - 1)
    numbers = lambda kind, name: [float(v) for v in tables[kind][name]]  # noqa: E731
    for i, axis in enumerate("xyz"):
        wanted = numbers("nodes", f"u_{axis}_mm")
        np.testing.assert_array_equal(points(grid, "displacement")[:, i], wanted)
    for i, pair in enumerate(["xx", "yy", "zz", "xy", "yz", "zx"]):
        wanted = numbers("elements", f"stress_{pair}_MPa")
        np.testing.assert_array_equal(cells(grid, "stress")[:, i], wanted)
    assert np.abs(cells(grid, "stress")).max() > 0
    np.testing.assert_allclose(
        cells(grid, "principal_stress"), principal(cells(grid, "stress")), atol=1e-12
    )
    # Brick, mortar, brick.
    heights = [grid.GetCell(c).GetBounds()[4:] for c in range(grid.GetNumberOfCells())]
    for (low, _), course in zip(heights, cells(grid, "course")):
        assert course == (0 if low < 65 - 1e-9 else 1)


def test_velocities_are_there_where_inertia_may_act(couplet: Path, tmp_path: Path) -> None:
    with h5py.File(couplet / "results.vtkhdf") as file:
        assert "velocity" not in file["VTKHDF/PointData"]
    heavy = ["materials.brick.density=2000 kg/m^3", "materials.mortar.density=2000 kg/m^3"]
    steps = ["steps.0.procedure=quasi_static", "steps.1.displacement=0.007"]
    command = [TARGET / "release" / "wythe", "run", ROOT / "examples" / "01_couplet_tension.toml"]
    sets = [part for key in heavy + steps for part in ("--set", key)]
    out = tmp_path / "moving.out"
    done = subprocess.run([*command, "--out", out, *sets], capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
    with h5py.File(out / "results.vtkhdf") as file:
        velocity = file["VTKHDF/PointData/velocity"]
        assert velocity.attrs["unit"] == "mm/s"
        assert velocity.shape == file["VTKHDF/PointData/displacement"].shape
    grid = at(reader_of(out / "results.vtkhdf"), 0)
    x, v = vtk_to_numpy(grid.GetPoints().GetData()), points(grid, "velocity")
    top = x[:, 2] == x[:, 2].max()
    # Driven by 0.006 mm in a step of 1 s.
    np.testing.assert_allclose(v[top, 2], 0.006, rtol=1e-6)
    assert not v[x[:, 2] == 0].any()
