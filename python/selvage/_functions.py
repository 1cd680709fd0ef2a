"""The questions, each as one function of arrays. For many poses of one mesh make a finder, and update it."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from selvage import _native
from selvage._meshes import as_solid, as_surface
from selvage._native import (
    BoundaryPathFinder,
    ContinuousCollisionFinder,
    PairFilters,
    ProximityFinder,
    SelfCollisionFinder,
    SurfaceDistance,
)
from selvage._results import (
    ClosestPoints,
    ContinuousPairs,
    Floats,
    NearPairs,
    PathQueries,
    Paths,
    SignedDistances,
    TrianglePairs,
)

Progress = Callable[[float], object]


def self_collisions(
    *mesh: Any,
    method: str = "auto",
    adjacent: bool = False,
    filters: PairFilters | None = None,
    thickness: ArrayLike | None = None,
    progress: Progress | None = None,
) -> TrianglePairs:
    """All pairs of triangles that meet, each once, decided exactly.

    Parameters
    ----------
    mesh : V and F, or a mesh
        Positions (n, 3) [m] and triangles (m, 3); or what `as_mesh` takes. Of tetrahedra the boundary is checked.
    method, adjacent, filters, thickness, progress
        As SelfCollisionFinder.

    Returns
    -------
    TrianglePairs
        `triangles` (k, 2), sorted, and how each pair meets.

    Raises
    ------
    selvage.Error
        When an array has another shape or type, a position is not finite, or an option does not fit.

    Notes
    -----
    Wang, Tang, Wang, Tong 2018, https://doi.org/10.1016/j.cag.2018.04.001; decided by exact predicates.

    Examples
    --------
    >>> V = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, -1], [1, 1, 2], [2, 1, 2]]
    >>> pairs = selvage.self_collisions(V, [[0, 1, 2], [3, 4, 5]])
    >>> pairs.triangles
    array([[0, 1]], dtype=int32)
    >>> pairs.mark(2)
    array([ True,  True])
    """
    return SelfCollisionFinder(
        as_surface(*mesh), method=method, adjacent=adjacent, asked_once=True, filters=filters, thickness=thickness,
        progress=progress,
    ).find_pairs()  # fmt: skip


def has_self_collisions(
    *mesh: Any,
    method: str = "auto",
    adjacent: bool = False,
    filters: PairFilters | None = None,
    thickness: ArrayLike | None = None,
) -> bool:
    """Whether a surface meets itself: stops at the first pair. As `self_collisions`.

    Examples
    --------
    >>> selvage.has_self_collisions(selvage.make("torus"))
    False
    """
    return SelfCollisionFinder(
        as_surface(*mesh), method=method, adjacent=adjacent, asked_once=True, filters=filters, thickness=thickness
    ).has_pairs()


def collisions_between(
    mesh: Any, other: Any, *, thickness: float = 0.0, progress: Progress | None = None
) -> TrianglePairs:
    """All pairs of a triangle of one mesh and a triangle of another that meet, as of a garment and a body.

    As `selvage check --against`: none within either mesh. For steps and for distances `join` the two.

    Parameters
    ----------
    mesh, other : meshes
        What `as_mesh` takes as one argument; of tetrahedra the boundary.
    thickness : float
        Pairs count that are nearer than this [m].
    progress : function, optional
        Called during the search with the share that is done, on any thread.

    Returns
    -------
    TrianglePairs
        The first number of a pair is of `mesh`, the second of `other`.

    Raises
    ------
    selvage.Error
        When an argument is no mesh, a position is not finite, or the thickness is negative.

    Examples
    --------
    >>> ball, rod = selvage.make("ball", radius=0.5, cell=0.2), selvage.make("rod", radius=0.1, cell=0.1)
    >>> pairs = selvage.collisions_between(ball, rod)
    >>> len(pairs) > 0, bool(pairs.triangles[:, 0].max() < len(ball.boundary_faces))
    (True, True)
    """
    first, second = as_surface(mesh), as_surface(other)
    half = None if thickness == 0 else [np.full(len(m.V), thickness / 2) for m in (first, second)]
    finder, against = (
        SelfCollisionFinder(
            m, method="bvh", asked_once=True, thickness=None if half is None else half[i], progress=progress
        )
        for i, m in enumerate((first, second))
    )
    return finder.find_pairs_with(against)


def continuous_collisions(
    V0: ArrayLike,
    V1: ArrayLike,
    F: ArrayLike,
    *,
    method: str = "auto",
    filters: PairFilters | None = None,
    thickness: ArrayLike | None = None,
    progress: Progress | None = None,
) -> ContinuousPairs:
    """All pairs of a vertex and a face, and of two edges, that meet during a step; decided exactly.

    Parameters
    ----------
    V0, V1 : (n, 3) arrays
        Positions at the start and at the end of the step [m].
    F : (m, 3) array of whole numbers
        Triangles.
    method, filters, thickness, progress
        As ContinuousCollisionFinder.

    Returns
    -------
    ContinuousPairs
        `vertex_face` (k, 2) and `edge_edge` (l, 2), rows of `TriangleMesh(V0, F).edges`.

    Raises
    ------
    selvage.Error
        When an array has another shape or type, a position is not finite, or an option does not fit.

    Examples
    --------
    >>> V0 = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 1], [1, 1, 2], [2, 1, 2.0]])
    >>> selvage.continuous_collisions(V0, V0 - [0, 0, 2] * (np.arange(6) > 2)[:, None], [[0, 1, 2], [3, 4, 5]])
    <selvage.ContinuousPairs: 3 vertex-face, 0 edge-edge>
    """
    return ContinuousCollisionFinder(
        as_surface(V0, F), V0, V1, method=method, asked_once=True, filters=filters, thickness=thickness,
        progress=progress,
    ).find_pairs()  # fmt: skip


def free_step(
    V0: ArrayLike,
    V1: ArrayLike,
    F: ArrayLike,
    *,
    filters: PairFilters | None = None,
    thickness: ArrayLike | None = None,
) -> float:
    """The largest fraction of a step that is free of collisions; as `ipctk.compute_collision_free_stepsize`.

    Parameters
    ----------
    V0, V1 : (n, 3) arrays
        Positions at the start and at the end of the step [m].
    F : (m, 3) array of whole numbers
        Triangles.
    filters : PairFilters, optional
    thickness : (n,) array, optional
        Then pairs also stay apart by the sum of their thickness [m].

    Returns
    -------
    float
        1 where nothing meets; else no later than the earliest true time of impact, and at most 1e-6 earlier. What
        crosses at the start already counts only where it meets anew: check that with `has_self_collisions`.

    Raises
    ------
    selvage.Error
        As `continuous_collisions`.

    Examples
    --------
    >>> V0 = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 1], [1, 1, 2], [2, 1, 2.0]])
    >>> V1 = V0 - [0, 0, 2] * (np.arange(6) > 2)[:, None]
    >>> round(selvage.free_step(V0, V1, [[0, 1, 2], [3, 4, 5]]), 3)
    0.5
    >>> round(selvage.free_step(V0, V1, [[0, 1, 2], [3, 4, 5]], thickness=np.full(6, 0.1)), 3)
    0.4
    """
    finder = ContinuousCollisionFinder(
        as_surface(V0, F), V0, V1, asked_once=True, filters=filters, thickness=thickness
    )
    return finder.find_free_step() if thickness is None else finder.find_separated_step()


def near_pairs(*mesh: Any, distance: float, filters: PairFilters | None = None) -> NearPairs:
    """Pairs of a vertex and a face, and of two edges, nearer to each other than a distance.

    Parameters
    ----------
    mesh : V and F, or a mesh
        As `self_collisions`.
    distance : float
        [m], positive.
    filters : PairFilters, optional

    Returns
    -------
    NearPairs

    Raises
    ------
    selvage.Error
        As ProximityFinder.

    Examples
    --------
    >>> V = [[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 0.25], [-1, 1, 2], [-1, 2, 0.5]]
    >>> selvage.near_pairs(V, [[0, 1, 2], [3, 4, 5]], distance=0.5)
    <selvage.NearPairs: 1 vertex-face, 1 edge-edge>
    """
    return ProximityFinder(as_surface(*mesh), distance=distance, filters=filters).find_pairs()


def closest_points(P: ArrayLike, *mesh: Any) -> ClosestPoints:
    """The point of a surface that is closest to each of some points; as `igl.point_mesh_squared_distance`.

    Parameters
    ----------
    P : (k, 3) array
        Points [m].
    mesh : V and F, or a mesh
        As `self_collisions`.

    Returns
    -------
    ClosestPoints
        `distance, triangle, point, barycentric, feature`.

    Raises
    ------
    selvage.Error
        As SurfaceDistance.

    Examples
    --------
    >>> selvage.closest_points([[0.2, 0.2, 3]], [[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).point
    array([[0.2, 0.2, 0. ]])
    """
    return SurfaceDistance(as_surface(*mesh)).find_closest_points(P)


def signed_distance(P: ArrayLike, *mesh: Any) -> SignedDistances:
    """Signed distances of points from a closed surface, negative inside; as `igl.signed_distance`.

    Signs come from exact winding numbers, and hold where the surface intersects itself, too.

    Parameters
    ----------
    P : (k, 3) array
        Points [m].
    mesh : V and F, or a mesh
        As `self_collisions`; closed.

    Returns
    -------
    SignedDistances
        The arrays of ClosestPoints, and `winding_number`.

    Raises
    ------
    selvage.Error
        When the surface is not closed, and as SurfaceDistance.

    Examples
    --------
    >>> selvage.signed_distance([[0.5, 0.5, 0.5]], selvage.make("box", size=(1, 1, 1), cell=0.5)).distance
    array([-0.5])
    """
    return SurfaceDistance(as_surface(*mesh)).find_signed_distances(P)


@dataclasses.dataclass(frozen=True)
class PenetratingPaths:
    """Penetrating vertices of a mesh, and their ways out.

    Attributes
    ----------
    queries : PathQueries
        `queries.vertices` are the vertices, `queries.elements` the elements that they are in.
    paths : Paths
        One row per query.
    """

    queries: PathQueries
    paths: Paths

    @property
    def vertices(self) -> Any:
        """(k,) int32: the penetrating vertices; one comes once for each element that it is in."""
        return self.queries.vertices

    def __len__(self) -> int:
        """Number of pairs of a vertex and an element."""
        return len(self.queries)


def shortest_paths(*mesh: Any, progress: Progress | None = None) -> PenetratingPaths:
    """Every boundary vertex that is inside an element, and its shortest path to the boundary.

    Parameters
    ----------
    mesh : V and T, or a mesh of tetrahedra
        Positions (n, 3) [m] and tetrahedra (m, 4); or what `as_mesh` takes.
    progress : function, optional
        Called now and then with the share that is done.

    Returns
    -------
    PenetratingPaths
        `vertices`, `queries` and `paths`.

    Raises
    ------
    selvage.Error
        When the mesh is a surface, an array has another shape or type, or a position is not finite.

    Notes
    -----
    Chen, Diaz, Yuksel 2023, https://doi.org/10.1145/3592136

    Examples
    --------
    >>> mesh = selvage.make("rod", cell=0.06, pose="self-crossing", crossings=1)
    >>> inside = selvage.shortest_paths(mesh.V, mesh.T)
    >>> len(inside) > 0, bool(inside.paths.found.all())
    (True, True)
    """
    finder = BoundaryPathFinder(as_solid(*mesh))
    queries = finder.find_penetrating_vertices()
    paths = finder.find_paths(queries.points, queries.elements, sources=queries.sources, progress=progress)
    return PenetratingPaths(queries, paths)
