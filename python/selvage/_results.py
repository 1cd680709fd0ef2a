"""The answers: tuples of NumPy arrays with names. Arrays of one answer have one row per pair, point or contact."""

from __future__ import annotations

from enum import IntEnum
from typing import NamedTuple, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats: TypeAlias = NDArray[np.float64]
Ints: TypeAlias = NDArray[np.int32]
Codes: TypeAlias = NDArray[np.uint8]
Booleans: TypeAlias = NDArray[np.bool_]


class PathStatus(IntEnum):
    """Outcome of a path query."""

    FOUND = 0
    NO_PATH = 1  # every candidate is blocked, or none is left
    NOT_IN_ELEMENT = 2  # the point is not in the element it was said to be in, or the element is exactly flat


class Feature(IntEnum):
    """The smallest part of a surface that holds a point."""

    FACE = 0
    EDGE = 1
    VERTEX = 2


class TriangleContact(IntEnum):
    """How two triangles meet."""

    DISJOINT = 0  # they are nearer than their thickness
    TOUCHING = 1
    CROSSING = 2
    COPLANAR_OVERLAP = 3


class ContactKind(IntEnum):
    """The kind of the penetrating or moving point, and how it was detected."""

    VERTEX_PATH = 0
    EDGE_PATH = 1
    CENTROID_PATH = 2
    VERTEX_FACE = 3
    EDGE_EDGE = 4


# A NamedTuple cannot define how many rows it has; these add it.
class _PathsFields(NamedTuple):
    status: Codes
    face: Ints
    point: Floats
    distance: Floats
    barycentric: Floats
    feature: Codes
    normal: Floats


class Paths(_PathsFields):
    """Shortest paths to the boundary, one row per query.

    Attributes
    ----------
    status : (k,) uint8
        See PathStatus; `found` is where it is 0.
    face : (k,) int32
        Boundary face, the smallest number where several share the closest point; -1 where nothing was found.
    point : (k, D) float64
        Closest boundary point [m]; NaN where nothing was found.
    distance : (k,) float64
        Length of the path [m]; NaN where nothing was found.
    barycentric : (k, D) float64
        Of `point` in the face's vertices.
    feature : (k,) uint8
        See Feature: whether `point` is inside the face, on an edge or at a vertex.
    normal : (k, D) float64
        Unit outward normal at `point`.
    """

    @property
    def found(self) -> Booleans:
        """(k,) bool: where there is a path."""
        found: Booleans = self.status == PathStatus.FOUND
        return found

    def __len__(self) -> int:
        """Number of queries."""
        return len(self.status)

    def __repr__(self) -> str:
        deepest = f", deepest {np.nanmax(self.distance):.4g} m" if self.found.any() else ""
        return f"<selvage.Paths: {int(self.found.sum())} found of {len(self)}{deepest}>"


class _PathQueriesFields(NamedTuple):
    points: Floats
    elements: Ints
    sources: Ints


class PathQueries(_PathQueriesFields):
    """Points and the elements that they are in: (k, D) `points` [m], (k,) `elements`, (k, 2) `sources`."""

    @property
    def vertices(self) -> Ints:
        """(k,) int32: the vertex that each point is."""
        return self.sources[:, 0]

    def __len__(self) -> int:
        """Number of queries."""
        return len(self.elements)

    def __repr__(self) -> str:
        return f"<selvage.PathQueries: {len(self)} points>"


class LocatedPoints(NamedTuple):
    """Pairs of a point and an element that holds it: (k,) `point` numbers, (k,) `element` numbers."""

    point: NDArray[np.int64]
    element: Ints


class _TrianglePairsFields(NamedTuple):
    triangles: Ints
    contact: Codes


class TrianglePairs(_TrianglePairsFields):
    """Pairs of triangles that meet: (k, 2) int32 `triangles`, sorted, and (k,) uint8 `contact`, see TriangleContact."""

    def __len__(self) -> int:
        """Number of pairs."""
        return len(self.contact)

    def mark(self, triangle_count: int) -> Booleans:
        """(m,) bool: the triangles that are in a pair."""
        marked = np.zeros(triangle_count, bool)
        marked[self.triangles.ravel()] = True
        return marked

    def __repr__(self) -> str:
        return f"<selvage.TrianglePairs: {len(self)} pairs>"


class _ContinuousPairsFields(NamedTuple):
    vertex_face: Ints
    edge_edge: Ints


class ContinuousPairs(_ContinuousPairsFields):
    """Pairs that meet during a step: (k, 2) `vertex_face` and (l, 2) `edge_edge`, rows of `TriangleMesh.edges`."""

    def __len__(self) -> int:
        """Number of pairs, of both kinds."""
        return len(self.vertex_face) + len(self.edge_edge)

    def __repr__(self) -> str:
        return f"<selvage.ContinuousPairs: {len(self.vertex_face)} vertex-face, {len(self.edge_edge)} edge-edge>"


class _NearPairsFields(NamedTuple):
    vertex_face: Ints
    edge_edge: Ints
    vertex_face_distance: Floats
    edge_edge_distance: Floats
    barycentric: Floats
    place: Floats
    vertex_face_nearest: Floats
    edge_edge_nearest: Floats


class NearPairs(_NearPairsFields):
    """Pairs nearer than a distance.

    Attributes
    ----------
    vertex_face : (k, 2) int32, edge_edge : (l, 2) int32
        The pairs; edges are rows of `TriangleMesh.edges`.
    vertex_face_distance : (k,) float64, edge_edge_distance : (l,) float64
        [m]; exactly 0 where the two meet, and only there.
    barycentric : (k, 3) float64
        Of the nearest point of the face in its vertices.
    place : (l, 2) float64
        Of the nearest points along the two edges: 0 at the smaller vertex, 1 at the other.
    vertex_face_nearest : (k, 2, 3) float64, edge_edge_nearest : (l, 2, 3) float64
        The nearest points [m].
    """

    def __len__(self) -> int:
        """Number of pairs, of both kinds."""
        return len(self.vertex_face) + len(self.edge_edge)

    def __repr__(self) -> str:
        return f"<selvage.NearPairs: {len(self.vertex_face)} vertex-face, {len(self.edge_edge)} edge-edge>"


class ClosestPoints(NamedTuple):
    """Closest points of a surface, one row per point.

    Attributes
    ----------
    distance : (k,) float64
        [m], not negative.
    triangle : (k,) int32
        The smallest number where several triangles share the closest point.
    point : (k, 3) float64
        [m]
    barycentric : (k, 3) float64
        Of `point` in the triangle's vertices.
    feature : (k,) uint8
        See Feature.
    """

    distance: Floats
    triangle: Ints
    point: Floats
    barycentric: Floats
    feature: Codes


class SignedDistances(NamedTuple):
    """Signed distances from a closed surface, one row per point: as ClosestPoints, and how often it is enclosed.

    Attributes
    ----------
    distance : (k,) float64
        [m]; negative inside, exactly 0 on the surface.
    winding_number : (k,) int32
        How many times the surface encloses the point; 0 outside and on it.
    """

    distance: Floats
    triangle: Ints
    point: Floats
    barycentric: Floats
    feature: Codes
    winding_number: Ints


class _ContactsFields(NamedTuple):
    kind: Codes
    vertex_count: Codes
    vertices: Ints
    weights: Floats
    normal: Floats
    point: Floats
    distance: Floats
    time: Floats
    point_feature: Ints
    surface_feature: Ints


class Contacts(_ContactsFields):
    """Contacts of a step. Each is one inequality, normal . sum(weights[i] * V[vertices[i]]) >= 0.

    Attributes
    ----------
    kind : (k,) uint8
        See ContactKind.
    vertex_count : (k,) uint8
        How many vertices; the rest of a row is -1 in `vertices` and 0 in `weights`.
    vertices : (k, 7) int32, weights : (k, 7) float64
        First those of the point, whose weights are positive and sum to 1, then those of the surface (to -1).
    normal : (k, 3) float64
        Unit vectors out of the surface, or to the side that the point came from.
    point : (k, 3) float64
        Of the surface: the closest boundary point, or where they met [m].
    distance : (k,) float64
        That is kept in front of the surface, where it was there before: of thick cloth [m].
    time : (k,) float64
        Of impact, as a fraction of the step.
    point_feature, surface_feature : (k,) int32
        What penetrates (vertex, boundary edge or element), and the boundary face or edge that it meets.
    """

    def __len__(self) -> int:
        """Number of contacts."""
        return len(self.kind)

    def gaps(self, V: ArrayLike) -> Floats:
        """(k,) float64: the left side of each inequality at positions V (n, 3); negative behind the surface [m]."""
        x = np.asarray(V, float)
        offset = np.einsum("ki,kid->kd", self.weights, x[self.vertices])
        gaps: Floats = np.einsum("kd,kd->k", self.normal, offset)
        return gaps

    def __repr__(self) -> str:
        kinds = ", ".join(
            f"{int((self.kind == kind).sum())} {kind.name.lower().replace('_', '-')}"
            for kind in ContactKind
            if (self.kind == kind).any()
        )
        return f"<selvage.Contacts: {kinds or 'none'}>"


for _result in (
    PathStatus, Feature, TriangleContact, ContactKind, Paths, PathQueries, LocatedPoints, TrianglePairs,
    ContinuousPairs, NearPairs, ClosestPoints, SignedDistances, Contacts,
):  # fmt: skip
    _result.__module__ = "selvage"
