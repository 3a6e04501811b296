"""results.vtkhdf as VTK and h5py read it."""

from pathlib import Path

import h5py
import numpy as np
import pytest
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


def test_vtk_sees_every_step(known: Path) -> None:
    reader = reader_of(known / "results.vtkhdf")
    assert reader.GetNumberOfSteps() == len(TIMES)
    information = reader.GetOutputInformation(0)
    key = type(reader.GetExecutive()).TIME_STEPS()
    assert [information.Get(key, i) for i in range(information.Length(key))] == TIMES


@pytest.mark.parametrize("step", range(len(TIMES)))
def test_vtk_reads_the_known_fields(known: Path, step: int) -> None:
    """The formulas of tests/verification/results_files.rs. Equality is exact up to the last bit
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
        about = file["wythe"].attrs
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
