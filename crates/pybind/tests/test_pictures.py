"""Pictures, plots, meshes for other packages, and what is said where those are missing."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import wythe


def test_every_picture(wall: wythe.Results, measured: Path) -> None:
    plain = wall.picture()
    assert plain.svg == wall.picture("curves").svg
    assert "measured" in wall.picture("curves", experiment=measured).svg
    both = wall.picture("curves", against={"another run": wall})
    assert "another run" in both.svg
    first, last = wall.picture("cracks", frame=0).svg, wall.picture("cracks", frame="last").svg
    assert first != last
    assert wall.picture("cracks").svg == last
    assert "<svg" in wall.picture("deflection_height", frame="peak").svg
    bent = wythe.templates.out_of_plane(drive="0.05 mm", courses=4).run()
    assert "<svg" in bent.picture("deflection_length", frame=-1).svg


def test_faces_sections_and_columns(wall: wythe.Results) -> None:
    front, back = wall.picture("cracks", scale=50), wall.picture("cracks", face="back", scale=50)
    assert "displacements × 50" in front.svg and "seen from +y" in back.svg
    middle = float(wall.nodes[:, 1].mean())
    section = wall.picture("cracks", section=f"y={middle}")
    assert "section y" in section.svg
    assert wall.picture("cracks", view="iso").svg != wall.picture("cracks", view=(10, 5)).svg
    columns = wall.picture("columns", x="time", y=["force_kN", "elastic_energy_J"])
    assert "elastic energy [J]" in columns.svg and "time [s]" in columns.svg
    axes = wall.plot(x="time", y="elastic_energy_J")
    assert axes.get_ylabel() == "elastic energy [J]"
    np.testing.assert_array_equal(axes.get_lines()[0].get_xdata(), wall.history["time"])


def test_an_animation_is_a_gif(wall: wythe.Results, tmp_path: Path) -> None:
    name = wall.animate(tmp_path / "wall.gif", view="iso", width=160, most=3)
    assert Path(name).read_bytes().startswith(b"GIF89a")
    with pytest.raises(ValueError, match="width from 50"):
        wall.animate(tmp_path / "wall.gif", width=1)
    with pytest.raises(ValueError, match=r"path: expected a name that ends in \.gif, .* got '.*wall\.mp4'"):
        wall.animate(tmp_path / "wall.mp4")
    assert not (tmp_path / "wall.mp4").exists()


def test_the_frame_of_the_peak_is_the_peak(wall: wythe.Results) -> None:
    force = wall.history["force_kN"]
    assert wall.frame("peak").increment == wall.history["increment"][np.argmax(force)]


def test_views_and_columns_that_are_none(wall: wythe.Results) -> None:
    with pytest.raises(ValueError, match="no column `force`"):
        wall.picture("columns", y="force")
    with pytest.raises(ValueError, match="no column `elastic_energy`"):
        wall.plot(y="elastic_energy")
    with pytest.raises(ValueError, match="no part of the model lies at y = -1 mm"):
        wall.picture("cracks", section="y=-1")
    with pytest.raises(ValueError, match="is no view"):
        wall.picture("cracks", view="behind")
    with pytest.raises(ValueError, match="expected one of them"):
        wall.picture("cracks", face="back", view="iso")


def test_pictures_that_are_none(wall: wythe.Results) -> None:
    with pytest.raises(ValueError, match="kind: expected one of curves, columns, cracks, .*got 'crack'"):
        wall.picture("crack")  # type: ignore[arg-type]
    with pytest.raises(IndexError, match="there is no frame 99"):
        wall.picture("cracks", frame=99)
    with pytest.raises(TypeError, match="frame"):
        wall.picture("cracks", frame=1.5)  # type: ignore[arg-type]
    with pytest.raises(wythe.OutputError, match="cannot be read"):
        wall.picture(experiment="/nowhere.csv")
    with pytest.raises(TypeError, match="experiment: expected a path"):
        wall.picture(experiment=3)  # type: ignore[arg-type]


def test_pictures_are_shown_and_saved(couplet: wythe.Results, tmp_path: Path) -> None:
    picture = couplet.picture()
    assert picture._repr_svg_() == picture.svg
    assert re.fullmatch(r"<Picture: \d+ kB of SVG; .*>", repr(picture))
    svg = picture.save(tmp_path / "curve.svg")
    assert Path(svg).read_text() == picture.svg
    png = picture.save(tmp_path / "curve.PNG", zoom=1.0)
    assert Path(png).read_bytes() == picture.png(1.0)
    small, large = picture.png(1.0), picture.png()

    def width(image: bytes) -> int:
        assert image.startswith(b"\x89PNG")
        return int.from_bytes(image[16:20], "big")

    assert width(large) == 2 * width(small)
    with pytest.raises(ValueError, match=r"path: expected a name that ends in \.svg or \.png"):
        picture.save(tmp_path / "curve.jpg")
    with pytest.raises(wythe.OutputError, match="cannot be written: No such file") as raised:
        picture.save(tmp_path / "no" / "curve.svg")
    assert raised.value.errno == 2
    for zoom in (0, -1, 1e9):
        with pytest.raises(ValueError, match="picture has no size|pixels are too many"):
            picture.png(zoom)
    with pytest.raises(ValueError, match="SVG"):
        wythe.Picture("no picture").png()


def test_a_curve_by_matplotlib(couplet: wythe.Results, measured: Path) -> None:
    from matplotlib import pyplot

    ax = couplet.plot(experiment=measured)
    run, peak, test = ax.get_lines()
    assert np.array_equal(run.get_xdata(), couplet.history.displacement_mm)
    assert np.array_equal(run.get_ydata(), couplet.history.force_kN)
    assert list(np.atleast_1d(peak.get_ydata())) == [couplet.peak_force]
    assert list(np.atleast_1d(test.get_ydata())) == [0.0, 5.0, 4.5, 3.0]
    assert [run.get_label(), test.get_label()] == ["couplet", "measured"]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("displacement [mm]", "force [kN]")
    again = couplet.plot(ax=ax, label="again")
    assert again is ax
    assert len(ax.get_lines()) == 5
    assert ax.get_lines()[3].get_label() == "again"
    pyplot.close("all")


def test_only_driven_increments_are_plotted(wall: wythe.Results) -> None:
    from matplotlib import pyplot

    line = wall.plot().get_lines()[0]
    assert len(np.atleast_1d(line.get_xdata())) == wall.history.driven.sum()
    pyplot.close("all")


def test_a_mesh_for_pyvista(wall: wythe.Results) -> None:
    frame = wall.frame("peak")
    grid = wall.mesh("peak")
    assert grid.n_cells == len(wall.elements)
    assert (np.asarray(grid.points) == wall.nodes + frame.displacement).all()
    assert (np.asarray(wall.mesh("peak", scale=0.0).points) == wall.nodes).all()
    assert (np.asarray(grid.point_data["displacement"]) == frame.displacement).all()
    names = {"stress", "principal_stress", "plastic_strain", "tensile_damage", "compressive_damage"}
    names |= {"crack_width", "yielded", "material", "unit", "course"}
    assert set(grid.cell_data.keys()) == names
    for name in ("stress", "tensile_damage", "yielded"):
        assert (np.asarray(grid.cell_data[name]) == getattr(frame, name)).all()
    assert (np.asarray(grid.cell_data["unit"]) == wall.unit).all()
    # A hexahedron the right way round has a positive volume.
    volumes = np.asarray(wall.mesh(0, scale=0.0).compute_cell_sizes().cell_data["Volume"])
    assert volumes.min() > 0.0
    assert volumes.sum() == pytest.approx(np.prod(np.ptp(wall.nodes, axis=0)))


def test_a_mesh_for_meshio(couplet: wythe.Results, tmp_path: Path) -> None:
    import meshio

    mesh = couplet.to_meshio("peak")
    frame = couplet.frame("peak")
    assert (mesh.points == couplet.nodes).all()
    assert np.array_equal(mesh.cells_dict["hexahedron"], couplet.elements)
    assert np.array_equal(mesh.point_data["displacement"], frame.displacement)
    assert np.array_equal(mesh.cell_data["stress"][0], frame.stress)
    path = tmp_path / "couplet.vtu"
    mesh.write(path)
    assert np.array_equal(meshio.read(path).cell_data["stress"][0], frame.stress)


def test_velocities_go_along() -> None:
    run = wythe.templates.column("5 ms").run()
    assert "velocity" in run.mesh().point_data.keys()
    assert np.array_equal(run.to_meshio().point_data["velocity"], run.frame().velocity)


@pytest.mark.parametrize(
    ("package", "extra"),
    [("matplotlib", "plot"), ("pyvista", "plot"), ("meshio", "plot"), ("pandas", "study")],
)
def test_missing_packages_are_named(
    couplet: wythe.Results, monkeypatch: pytest.MonkeyPatch, package: str, extra: str
) -> None:
    asks: dict[str, Callable[[], object]] = {
        "matplotlib": couplet.plot,
        "pyvista": couplet.mesh,
        "meshio": couplet.to_meshio,
        "pandas": couplet.history.to_pandas,
    }
    # None makes the import fail, as if it were not installed.
    monkeypatch.setitem(sys.modules, package, None)
    with pytest.raises(ImportError) as raised:
        asks[package]()
    assert str(raised.value) == f"this needs {package}: pip install 'wythe[{extra}]'"
    # What needs none goes on.
    assert couplet.picture().png(0.5).startswith(b"\x89PNG")
