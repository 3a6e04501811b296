"""Files of `wythe export` as VTK and other programs read them."""

import csv
import subprocess
from pathlib import Path

import numpy as np
import pytest
from conftest import TARGET
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOHDF import vtkHDFReader
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader


def export(folder: Path, out: Path, *arguments: str) -> Path:
    done = subprocess.run(
        [TARGET / "release" / "wythe", "export", folder, "--out", out, *arguments],
        capture_output=True,
        text=True,
        timeout=300,
    )
    assert done.returncode == 0, done.stderr
    return out


def read(path: Path):
    reader = vtkXMLUnstructuredGridReader()
    assert reader.CanReadFile(str(path))
    reader.SetFileName(str(path))
    reader.Update()
    return reader.GetOutput()


def arrays(data) -> dict[str, np.ndarray]:
    return {data.GetArrayName(i): vtk_to_numpy(data.GetArray(i)) for i in range(data.GetNumberOfArrays())}


def test_vtu_has_the_bits_of_vtkhdf(couplet: Path, tmp_path: Path) -> None:
    out = export(couplet, tmp_path, "--to", "vtu", "--frame", "all")
    reader = vtkHDFReader()
    reader.SetFileName(str(couplet / "results.vtkhdf"))
    reader.UpdateInformation()
    steps = reader.GetNumberOfSteps()
    files = sorted(f for f in out.glob("frame_*.vtu") if "interfaces" not in f.name)
    assert len(files) == steps
    for step, file in enumerate(files):
        reader.SetStep(step)
        reader.Update()
        wanted, found = reader.GetOutputDataObject(0), read(file)
        assert found.GetNumberOfCells() == wanted.GetNumberOfCells()
        np.testing.assert_array_equal(
            vtk_to_numpy(found.GetPoints().GetData()), vtk_to_numpy(wanted.GetPoints().GetData())
        )
        for of in ("GetPointData", "GetCellData"):
            expected = arrays(getattr(wanted, of)())
            given = arrays(getattr(found, of)())
            assert given, of
            for name, values in given.items():
                np.testing.assert_array_equal(values, expected[name], err_msg=f"{name} {step}")
    assert (out / "series.pvd").read_text().count("<DataSet") == steps


def test_vtu_of_the_interfaces_holds_quads(couplet: Path, tmp_path: Path) -> None:
    out = export(couplet, tmp_path, "--to", "vtu")
    (file,) = out.glob("*_interfaces.vtu")
    grid = read(file)
    assert {grid.GetCellType(c) for c in range(grid.GetNumberOfCells())} == {9}
    fields = arrays(grid.GetCellData())
    assert set(fields) == {"opening", "slip", "traction", "damage", "state"}
    assert fields["traction"].shape == (grid.GetNumberOfCells(), 3)
    assert fields["damage"].max() > 0


def test_csv_has_a_row_a_node_an_element_and_a_point(couplet: Path, tmp_path: Path) -> None:
    out = export(couplet, tmp_path, "--to", "csv", "--frame", "peak")
    rows = {}
    for kind in ("nodes", "elements", "interfaces"):
        (file,) = out.glob(f"*_{kind}.csv")
        with file.open() as text:
            rows[kind] = list(csv.DictReader(text))
    assert [int(r["node"]) for r in rows["nodes"]] == list(range(len(rows["nodes"])))
    top = [r for r in rows["nodes"] if float(r["z_mm"]) == max(float(n["z_mm"]) for n in rows["nodes"])]
    assert len({r["u_z_mm"] for r in top}) == 1
    assert {r["material"] for r in rows["elements"]} == {"brick", "mortar"}
    assert {r["state"] for r in rows["interfaces"]} <= {"intact", "softening", "failed_open", "failed_sliding"}


def test_inp_has_elements_of_positive_volume_and_its_sets(couplet: Path, tmp_path: Path) -> None:
    text = (export(couplet, tmp_path, "--to", "inp") / "model.inp").read_text()
    blocks: dict[str, list[list[float]]] = {}
    for line in text.splitlines():
        if line.startswith("**") or line == "Couplet in tension":
            continue
        if line.startswith("*"):
            blocks[keyword := line] = []
        else:
            blocks[keyword].append(line.split(", "))
    nodes = {int(n): np.array([float(v) for v in x]) for n, *x in blocks["*NODE, NSET=ALL_NODES"]}
    elements = blocks["*ELEMENT, TYPE=C3D8, ELSET=ALL_ELEMENTS"]
    for _, *corners in elements:
        x = [nodes[int(n)] for n in corners]
        assert np.dot(np.cross(x[1] - x[0], x[3] - x[0]), x[4] - x[0]) > 0
    members = [int(e) for k, rows in blocks.items() if "ELSET=UNIT_" in k for r in rows for e in r]
    assert sorted(members) == list(range(1, len(elements) + 1))
    held = [int(n) for r in blocks["*NSET, NSET=SUPPORT_BOTTOM"] for n in r]
    assert all(nodes[n][2] == pytest.approx(0) for n in held)
