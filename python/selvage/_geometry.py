"""Questions about a few points each, for many at once."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from selvage import _native
from selvage._errors import Error
from selvage._results import Codes, Floats


def triangle_contacts(A: ArrayLike, B: ArrayLike) -> Codes:
    """How triangles meet, pair by pair, decided exactly.

    Parameters
    ----------
    A, B : (k, 3, 3) arrays
        Corners of the triangles [m].

    Returns
    -------
    (k,) uint8
        See TriangleContact.

    Raises
    ------
    selvage.Error
        When an array has another shape or type.

    Examples
    --------
    >>> A = [[[0, 0, 0], [4, 0, 0], [0, 4, 0]]]
    >>> B = [[[1, 1, -1], [1, 1, 2], [2, 1, 2]]]
    >>> selvage.TriangleContact(selvage.triangle_contacts(A, B)[0]).name
    'CROSSING'
    """
    return _native.contact_codes(_flat(A, 3, "A"), _flat(B, 3, "B"))


def impact_times(X0: ArrayLike, X1: ArrayLike, *, kind: str = "vertex-face", distance: float = 0.0) -> Floats:
    """First times at which a vertex and a face, or two edges, meet while they move on straight lines.

    Parameters
    ----------
    X0, X1 : (k, 4, 3) arrays
        Points at the start and at the end of the step [m]: a vertex and the three of a face, or the ends of two edges.
    kind : str
        'vertex-face' or 'edge-edge'.
    distance : float
        Positive: the first times at which they are nearer than this [m].

    Returns
    -------
    (k,) float64
        Fractions of the step, no later than the true ones and at most 1e-6 earlier; NaN where they do not meet.

    Raises
    ------
    selvage.Error
        When an array has another shape or type, for an unknown kind, or a distance below 0.

    Examples
    --------
    >>> X0 = np.array([[[1, 1, 1], [0, 0, 0], [4, 0, 0], [0, 4, 0.0]]])
    >>> X1 = X0 - [[[0, 0, 2], [0, 0, 0], [0, 0, 0], [0, 0, 0]]]
    >>> selvage.impact_times(X0, X1).round(3), selvage.impact_times(X0, X1, distance=0.2).round(3)
    (array([0.5]), array([0.4]))
    """
    if kind not in ("vertex-face", "edge-edge"):
        raise Error(f"kind: there is no '{kind}'; choose one of vertex-face, edge-edge")
    return _native.first_times(_flat(X0, 4, "X0"), _flat(X1, 4, "X1"), kind == "edge-edge", distance)


def _flat(points: ArrayLike, count: int, name: str) -> Any:
    array = np.asarray(points)
    if array.ndim != 3 or array.shape[1:] != (count, 3):
        raise Error(f"{name}: an array {array.shape} was given; expected (k, {count}, 3)")
    return array.reshape(-1, 3)
