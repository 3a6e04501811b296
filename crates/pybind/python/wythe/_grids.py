"""A frame of the solids as a mesh of other packages."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
import numpy.typing as npt

from wythe._errors import need
from wythe._frames import Frame

if TYPE_CHECKING:
    import meshio
    import pyvista

    from wythe._results import Results

__all__ = ["as_meshio", "as_pyvista"]


def as_pyvista(results: Results, frame: Frame, scale: float) -> pyvista.UnstructuredGrid:
    """The deformed solids with all their fields; ``scale`` magnifies the shape, not the displacement field."""
    need("pyvista", "plot")
    import pyvista

    cells = {np.uint8(12): results.elements.astype(np.int64)}
    grid = pyvista.UnstructuredGrid(cells, results.nodes + scale * frame.displacement)
    for name, values in _of_points(frame).items():
        grid.point_data[name] = values
    for name, values in _of_elements(results, frame).items():
        grid.cell_data[name] = values
    return grid


def as_meshio(results: Results, frame: Frame) -> meshio.Mesh:
    """The solids at rest with all fields of a frame."""
    need("meshio", "plot")
    import meshio

    cell_data: dict[str, list[npt.ArrayLike]] = {
        name: [values] for name, values in _of_elements(results, frame).items()
    }
    return meshio.Mesh(
        results.nodes,
        [("hexahedron", results.elements.astype(np.int64))],
        point_data=dict(_of_points(frame)),
        cell_data=cell_data,
    )


def _of_points(frame: Frame) -> dict[str, npt.NDArray[Any]]:
    fields: dict[str, npt.NDArray[Any]] = {"displacement": frame.displacement}
    if len(frame.velocity):
        fields["velocity"] = frame.velocity
    return fields


def _of_elements(results: Results, frame: Frame) -> dict[str, npt.NDArray[Any]]:
    return {
        "stress": frame.stress,
        "principal_stress": frame.principal_stress,
        "plastic_strain": frame.plastic_strain,
        "tensile_damage": frame.tensile_damage,
        "compressive_damage": frame.compressive_damage,
        "crack_width": frame.crack_width,
        "yielded": frame.yielded.astype(np.uint8),
        "material": results.material.astype(np.int64),
        "unit": results.unit.astype(np.int64),
        "course": results.course.astype(np.int64),
    }
