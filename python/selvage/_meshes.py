"""Meshes from files, from shapes, and from the mesh objects of other packages, and back."""

from __future__ import annotations

import os
from collections.abc import Mapping
from typing import Any, Literal, TypeAlias, overload

import numpy as np
from numpy.typing import ArrayLike

from selvage import _native
from selvage._errors import Error
from selvage._native import TetMesh, TriangleMesh
from selvage._results import Floats, Ints

Path: TypeAlias = "str | os.PathLike[str]"
Mesh: TypeAlias = "TetMesh | TriangleMesh"

_VTK_TETRA = 10
_SHAPE_KEYS = {
    "cell", "elements", "size", "length", "radius", "inner_radius", "tentacles", "teeth", "seed", "slenderness",
}  # fmt: skip
_POSE_KEYS = {"axis", "turns", "angle", "crossings", "core", "offset"}


def _mesh_of(where: object, V: Floats, F: Ints, T: Ints) -> Mesh:
    if len(T):
        return TetMesh(V, T)
    if len(F):
        return TriangleMesh(V, F)
    raise Error(f"{where}: there is neither a tetrahedron nor a triangle; give a mesh with either")


def read_mesh(path: Path, *, weld: bool = False) -> Mesh:
    """Reads a mesh file.

    Parameters
    ----------
    path : path
        .obj .ply .stl .off .t .node .ele .mesh .msh .vtk .vtu, ASCII or binary.
    weld : bool
        Of a surface: join vertices that are in one place, as those of an STL file. `TriangleMesh.weld` also says which
        triangles are left.

    Returns
    -------
    TetMesh or TriangleMesh
        Of the tetrahedra where the file has any, else of the triangles. Vertices keep their order, and are merged by
        `weld` alone.

    Raises
    ------
    selvage.Error
        One line with the file and the line or byte offset.

    Examples
    --------
    >>> import tempfile, os
    >>> path = os.path.join(tempfile.mkdtemp(), "ball.msh")
    >>> selvage.write_mesh(path, selvage.make("ball", cell=0.4))
    >>> selvage.read_mesh(path)
    selvage.TetMesh(175 vertices, 648 elements, 216 boundary faces)
    """
    made = _mesh_of(path, *_native.read_arrays(path))
    if weld and isinstance(made, TetMesh):
        raise Error(f"{os.fspath(path)}: is of tetrahedra, which are not welded; leave out weld")
    return made.weld()[0] if weld and isinstance(made, TriangleMesh) else made


def read_groups(path: Path) -> tuple[Ints, list[str]]:
    """Groups of the triangles of an OBJ file: its objects (`o`) and groups (`g`).

    Parameters
    ----------
    path : path
        A mesh file.

    Returns
    -------
    (m,) int32
        The group of each triangle, -1: in none; as `PairFilters(groups=...)` takes them. Empty where the file has none.
    list of str
        Names of the groups.

    Raises
    ------
    selvage.Error
        As `read_mesh`.

    Examples
    --------
    >>> import tempfile, pathlib
    >>> path = pathlib.Path(tempfile.mkdtemp(), "two.obj")
    >>> _ = path.write_text("o one\\nv 0 0 0\\nv 1 0 0\\nv 0 1 0\\nf 1 2 3\\no other\\nf 3 2 1\\n")
    >>> selvage.read_groups(path)
    (array([0, 1], dtype=int32), ['one', 'other'])
    """
    _, groups, names = _native.read_labels(path)
    return groups, names


def join(*meshes: Any) -> tuple[TriangleMesh, Ints]:
    """Surfaces as one: to ask for pairs between several objects, in a pose, near one another or during a step.

    Parameters
    ----------
    meshes : meshes
        What `as_mesh` takes as one argument; of tetrahedra the boundary.

    Returns
    -------
    TriangleMesh
        Vertices and triangles of the first, then of the next.
    (m,) int32
        The object of each triangle; as `PairFilters(groups=...)` it leaves out pairs within an object.

    Raises
    ------
    selvage.Error
        When there is no mesh, or an argument is none.

    Examples
    --------
    >>> mesh, objects = selvage.join(selvage.make("ball", cell=0.4), selvage.make("rod", cell=0.2))
    >>> near = selvage.near_pairs(mesh, distance=0.05, filters=selvage.PairFilters(groups=objects))
    >>> len(near.vertex_face) > 0, len(objects) == len(mesh.F)
    (True, True)
    """
    surfaces = [as_surface(mesh) for mesh in meshes]
    if not surfaces:
        raise Error("meshes: none was given; give one or more")
    starts = np.cumsum([0, *(len(surface.V) for surface in surfaces)])
    V = np.vstack([surface.V for surface in surfaces])
    F = np.vstack([surface.F + start for surface, start in zip(surfaces, starts)])
    objects = np.repeat(np.arange(len(surfaces), dtype=np.int32), [len(surface.F) for surface in surfaces])
    return TriangleMesh(V, F), objects


def write_mesh(path: Path, *mesh: Any, encoding: str = "usual") -> None:
    """Writes a mesh file, whole or not at all: `write_mesh(path, mesh)`, or `write_mesh(path, V, F)` of arrays.

    Parameters
    ----------
    path : path
        Its extension names the format, see `read_mesh`.
    mesh : mesh object, or V and F, or V and T
        Positions (n, 3) [m]; triangles (m, 3) or tetrahedra (m, 4).
    encoding : str
        'usual' (binary where the format has it), 'ascii' or 'binary'.

    Raises
    ------
    selvage.Error
        When the format cannot hold the mesh.
    selvage.SystemError
        When the file cannot be written.

    Examples
    --------
    >>> import tempfile, os
    >>> selvage.write_mesh(os.path.join(tempfile.mkdtemp(), "one.obj"), [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]])
    """
    made = as_mesh(*mesh)
    if isinstance(made, TetMesh):
        _native.write_arrays(path, made.V, T=made.T, encoding=encoding)
    else:
        _native.write_arrays(path, made.V, F=made.F, encoding=encoding)


@overload
def make(shape: Literal["cloth", "sleeve"], *, pose: str | None = None, **options: Any) -> TriangleMesh: ...


@overload
def make(shape: str, *, pose: str | None = None, **options: Any) -> TetMesh: ...


def make(shape: str, *, pose: str | None = None, **options: Any) -> Mesh:
    """Makes a mesh by formula, to try things on.

    Parameters
    ----------
    shape : str
        One of `shape_names()`: box, beam, rod, trefoil, nested-knot, noodle, overhand, nested-overhand, ball, torus,
        tube, squishy-ball, octopus, gear; cloth and sleeve are surfaces.
    pose : str, optional
        One of `pose_names()`: twist, bend, fold, swirl, self-crossing, overlap. Deforms the mesh so that it runs into
        itself, with no element inverted.
    **options
        Of the shape, lengths in metres: `cell` or `elements`, `size`, `length`, `radius`, `inner_radius`, `tentacles`,
        `teeth`, `seed`, `slenderness`; of the pose, those of `pose`. What is left out has a default.

    Returns
    -------
    TetMesh or TriangleMesh

    Raises
    ------
    selvage.Error
        For an unknown name, an option that the shape or the pose does not have, or impossible values.

    Examples
    --------
    >>> selvage.make("box", size=(1, 1, 1), cell=0.5)
    selvage.TetMesh(27 vertices, 48 elements, 48 boundary faces)
    """
    given = {key: value for key, value in options.items() if value is not None}
    _expect_among(given, _SHAPE_KEYS | _POSE_KEYS)
    posing = {key: value for key, value in given.items() if key in _POSE_KEYS}
    if posing and pose is None:
        raise Error(f"{sorted(posing)[0]}: is an option of poses, and none was named; give pose=...")
    shaping = {key: value for key, value in given.items() if key in _SHAPE_KEYS}
    return _mesh_of(shape, *_native.shape_arrays(shape, shaping, pose, posing))


def _expect_among(given: Mapping[str, Any], keys: set[str]) -> None:
    if unknown := sorted(set(given) - keys):
        raise Error(f"{unknown[0]}: there is no such option; choose among {', '.join(sorted(keys))}")


def pose(mesh: Any, name: str, **options: Any) -> Mesh:
    """A mesh of your own bent, twisted or tangled, with no element inverted; as `selvage make MESH --pose`.

    Parameters
    ----------
    mesh : mesh
        What `as_mesh` takes as one argument.
    name : str
        One of `pose_names()`: twist, bend, fold, swirl, self-crossing, overlap.
    **options
        Of the pose: `axis` ("x", "y", "z" or 0, 1, 2), `turns`, `angle` [rad], `crossings`, `core`, `offset` [m]. What is
        left out has a default that tangles.

    Returns
    -------
    TetMesh or TriangleMesh

    Raises
    ------
    selvage.Error
        For an unknown name, an option that the pose does not have, and when a tetrahedron would turn over.

    Examples
    --------
    >>> bar = selvage.make("beam", size=(4, 0.4, 0.4), cell=0.2)
    >>> selvage.has_self_collisions(selvage.pose(bar, "fold"))
    True
    """
    made = as_mesh(mesh)
    given = {key: value for key, value in options.items() if value is not None}
    _expect_among(given, _POSE_KEYS)
    F, T = (None, made.T) if isinstance(made, TetMesh) else (made.F, None)
    return _mesh_of(name, *_native.posed_arrays(made.V, F, T, name, given))


def as_mesh(*mesh: Any) -> Mesh:
    """A mesh of this package from whatever holds one.

    Parameters
    ----------
    mesh : mesh object, or V and F, or V and T
        A mesh of this package (returned as it is), of trimesh, meshio or PyVista, the path of a file, or two arrays:
        positions (n, 3) [m] and (m, 3) triangles or (m, 4) tetrahedra. Of a mesh with both kinds of elements the
        tetrahedra are taken.

    Returns
    -------
    TetMesh or TriangleMesh

    Raises
    ------
    selvage.Error
        When it is none of these, or as TetMesh and TriangleMesh.

    Examples
    --------
    >>> selvage.as_mesh([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], [[0, 1, 2, 3]])
    selvage.TetMesh(4 vertices, 1 elements, 4 boundary faces)
    """
    if len(mesh) == 2:
        V, elements = mesh
        shape = np.shape(elements)
        if len(shape) != 2 or shape[1] not in (3, 4):
            raise Error(f"elements: an array {shape} was given; expected (m, 3) triangles or (m, 4) tetrahedra")
        return TetMesh(V, elements) if shape[1] == 4 else TriangleMesh(V, elements)
    if len(mesh) != 1:
        raise Error(f"mesh: {len(mesh)} arguments were given; give one mesh, or two arrays V, F or V, T")
    return _from_object(mesh[0])


def _from_object(mesh: Any) -> Mesh:
    if isinstance(mesh, (TetMesh, TriangleMesh)):
        return mesh
    if isinstance(mesh, (str, os.PathLike)):
        return read_mesh(mesh)
    if hasattr(mesh, "points") and hasattr(mesh, "cells_dict"):
        if "connectivity" not in dir(mesh) and hasattr(mesh, "cell_data"):  # meshio
            cells = mesh.cells_dict
            F, T = cells.get("triangle", np.empty((0, 3), int)), cells.get("tetra", np.empty((0, 4), int))
            return _mesh_of("mesh", mesh.points, F, T)
        tets = mesh.cells_dict.get(_VTK_TETRA)  # pyvista.UnstructuredGrid
        if tets is not None:
            return TetMesh(mesh.points, tets)
        return _from_object(mesh.extract_surface())
    if hasattr(mesh, "regular_faces") and hasattr(mesh, "triangulate"):  # pyvista.PolyData
        return TriangleMesh(mesh.points, mesh.triangulate().regular_faces)
    if hasattr(mesh, "vertices") and hasattr(mesh, "faces"):  # trimesh
        return TriangleMesh(mesh.vertices, mesh.faces)
    raise Error(
        f"mesh: a {type(mesh).__name__} was given; give a mesh of selvage, trimesh, meshio or PyVista, a path or arrays"
    )


def to_trimesh(*mesh: Any) -> Any:
    """A `trimesh.Trimesh` of a surface, or of the boundary of a solid; nothing is merged. Needs trimesh."""
    import trimesh

    made = as_mesh(*mesh)
    surface = made.surface() if isinstance(made, TetMesh) else made
    return trimesh.Trimesh(surface.V, surface.F, process=False)


def to_meshio(*mesh: Any) -> Any:
    """A `meshio.Mesh`. Needs meshio."""
    import meshio

    made = as_mesh(*mesh)
    cells = ("tetra", made.T) if isinstance(made, TetMesh) else ("triangle", made.F)
    return meshio.Mesh(made.V, [cells])


def to_pyvista(*mesh: Any) -> Any:
    """A `pyvista.UnstructuredGrid` of tetrahedra, or a `pyvista.PolyData` of triangles. Needs pyvista."""
    import pyvista

    made = as_mesh(*mesh)
    if isinstance(made, TetMesh):
        return pyvista.UnstructuredGrid({_VTK_TETRA: made.T}, made.V)
    return pyvista.PolyData.from_regular_faces(made.V, made.F)


def as_surface(*mesh: Any) -> TriangleMesh:
    """The surface of whatever holds a mesh: see `as_mesh`; of tetrahedra their boundary."""
    made = as_mesh(*mesh)
    return made.surface() if isinstance(made, TetMesh) else made


def as_solid(*mesh: Any) -> TetMesh:
    """The tetrahedra of whatever holds a mesh: see `as_mesh`."""
    made = as_mesh(*mesh)
    if isinstance(made, TetMesh):
        return made
    raise Error("mesh: a surface was given; give tetrahedra, which TetGen, Gmsh or fTetWild make of a closed surface")


def boundary_faces(T: ArrayLike) -> Ints:
    """Boundary faces of tetrahedra, outward; as `igl.boundary_facets`.

    Parameters
    ----------
    T : (m, 4) array of whole numbers
        Positive tetrahedra.

    Returns
    -------
    (b, 3) int32

    Raises
    ------
    selvage.Error
        As TetMesh.

    Examples
    --------
    >>> selvage.boundary_faces([[0, 1, 2, 3]])
    array([[1, 2, 3],
           [0, 3, 2],
           [0, 1, 3],
           [0, 2, 1]], dtype=int32)
    """
    elements = np.asarray(T)
    count = int(elements.max()) + 1 if elements.size and elements.dtype.kind in "iu" else 0
    return TetMesh(np.zeros((count, 3)), T).boundary_faces
