"""Meshes with colours and fields, for other programs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from selvage import _native
from selvage._errors import Error
from selvage._meshes import Path, as_mesh, as_surface
from selvage._native import TetMesh


def write_coloured_ply(path: Path, *mesh: Any, vertex_colours: ArrayLike, triangle_colours: ArrayLike) -> None:
    """Writes a surface as a binary .ply with colours: Blender and ParaView show those of vertices, MeshLab of faces.

    Parameters
    ----------
    path : path
    mesh : V and F, or a mesh
        As `self_collisions`.
    vertex_colours : (n, 3) array, triangle_colours : (m, 3) array
        Red, green and blue, whole numbers from 0 to 255.

    Raises
    ------
    selvage.Error
        When numbers of colours do not match, or are out of range.
    selvage.SystemError
        When the file cannot be written.

    Examples
    --------
    >>> import tempfile, os
    >>> rod = selvage.make("rod", pose="self-crossing").surface()
    >>> hit = selvage.self_collisions(rod).mark(len(rod.F))
    >>> colours = np.where(hit[:, None], [213, 94, 0], [190, 190, 190])
    >>> of_vertices = np.full((len(rod.V), 3), 190)
    >>> of_vertices[rod.F[hit]] = [213, 94, 0]
    >>> path = os.path.join(tempfile.mkdtemp(), "marked.ply")
    >>> selvage.write_coloured_ply(path, rod, vertex_colours=of_vertices, triangle_colours=colours)
    """
    surface = as_surface(*mesh)
    flat = [
        _colours(colours, name)
        for name, colours in (("vertex_colours", vertex_colours), ("triangle_colours", triangle_colours))
    ]
    _native.write_coloured_arrays(path, surface.V, surface.F, *flat)


def _colours(colours: ArrayLike, name: str) -> Any:
    array = np.asarray(colours)
    if array.ndim != 2 or array.shape[1] != 3 or array.dtype.kind not in "iu":
        raise Error(f"{name}: an array {array.shape} of {array.dtype} was given; expected (k, 3) whole numbers")
    if array.size and not 0 <= array.min() <= array.max() <= 255:
        raise Error(f"{name}: numbers from {array.min()} to {array.max()} were given; expected 0 to 255")
    return np.ascontiguousarray(array, np.uint8).ravel()


def write_vtu(
    path: Path,
    *mesh: Any,
    point_fields: Mapping[str, ArrayLike] | None = None,
    cell_fields: Mapping[str, ArrayLike] | None = None,
) -> None:
    """Writes a mesh with fields as a .vtu file, for ParaView.

    Parameters
    ----------
    path : path
    mesh : mesh object, or V and F, or V and T
        As `as_mesh`.
    point_fields, cell_fields : dicts of arrays, optional
        By their names: (n,) or (n, c) for vertices, (m,) or (m, c) for triangles or tetrahedra.

    Raises
    ------
    selvage.Error
        When a field has another number of rows.
    selvage.SystemError
        When the file cannot be written.

    Examples
    --------
    >>> import tempfile, os
    >>> rod = selvage.make("rod", pose="self-crossing").surface()
    >>> hit = selvage.self_collisions(rod).mark(len(rod.F))
    >>> selvage.write_vtu(os.path.join(tempfile.mkdtemp(), "marked.vtu"), rod, cell_fields={"collides": hit})
    """
    made = as_mesh(*mesh)
    elements = made.T if isinstance(made, TetMesh) else made.F
    F, T = (None, elements) if isinstance(made, TetMesh) else (elements, None)
    points, cells = _fields(point_fields, len(made.V)), _fields(cell_fields, len(elements))
    _native.write_vtu_arrays(path, made.V, F, T, points, cells)


def _fields(fields: Mapping[str, ArrayLike] | None, rows: int) -> dict[str, Any]:
    arrays = {name: np.asarray(values, float) for name, values in (fields or {}).items()}
    for name, values in arrays.items():
        if values.ndim not in (1, 2) or len(values) != rows:
            raise Error(f"{name}: a field {values.shape} was given; expected {rows} rows")
    return {name: np.ascontiguousarray(values).ravel() for name, values in arrays.items()}
