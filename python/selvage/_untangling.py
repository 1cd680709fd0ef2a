"""Meshes without self-collision."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import Any

from numpy.typing import ArrayLike

from selvage import _native
from selvage._meshes import as_solid
from selvage._results import Floats


@dataclasses.dataclass(frozen=True)
class Resolved:
    """What `resolve` made of a mesh.

    Attributes
    ----------
    V : (n, 3) float64
        Positions [m]; moved, also where the mesh is not resolved.
    outcome : str
        'resolved', 'stuck', 'gave-up' or 'held' (pinned elements collide: nothing was moved).
    report : dict
        `iterations` (one dict each), `tangled_elements`, `holding_vertices`, `moved_vertices`, displacements [m],
        volumes [m^3] and elastic energies [J].
    """

    V: Floats
    outcome: str
    report: dict[str, Any]

    @property
    def is_free(self) -> bool:
        """Whether nothing meets, nothing penetrates, and no element is inverted."""
        return self.outcome == "resolved"


def resolve(
    *mesh: Any,
    rest: ArrayLike | None = None,
    keep_pose: bool = False,
    pinned: ArrayLike | None = None,
    max_displacement: float | None = None,
    clearance: float = 0.05,
    max_iterations: int = 2000,
    patience: int = 60,
    progress: Callable[[dict[str, Any]], object] | None = None,
) -> Resolved:
    """Moves a tangled mesh, at rest, to a state without self-collision.

    Parameters
    ----------
    mesh : V and T, or a mesh of tetrahedra
        As `shortest_paths`.
    rest : (n, 3) array, optional
        Shape without stress [m]; else the input.
    keep_pose : bool
        Take `rest` near the tangle alone, and keep the pose elsewhere, as `selvage resolve --rest` does; False: draw
        the whole mesh towards `rest`, as its `--to-rest`.
    pinned : (k,) array of whole numbers, optional
        Vertices that must stay where they are.
    max_displacement : float, optional
        Of each vertex [m].
    clearance : float
        How close surfaces that met may come again, as a part of the boundary's mean edge length.
    max_iterations, patience : int
        Iterations in all, and those without progress after which the mesh counts as stuck.
    progress : function, optional
        Called before each iteration with its row of the report.

    Returns
    -------
    Resolved

    Raises
    ------
    selvage.Error
        When sizes differ, a position is not finite, an element is not positive at rest, or an option is impossible.

    Notes
    -----
    Chen, Diaz, Yuksel 2023, section 5.2.

    Examples
    --------
    >>> mesh = selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1)
    >>> selvage.has_self_collisions(mesh)
    True
    >>> free = selvage.resolve(mesh)
    >>> free.outcome, selvage.has_self_collisions(free.V, mesh.T)
    ('resolved', False)
    """
    V, report = _native.resolve_arrays(
        as_solid(*mesh), rest=rest, keep_pose=keep_pose, pinned=pinned, max_displacement=max_displacement, clearance=clearance,
        max_iterations=max_iterations, patience=patience, progress=progress,
    )  # fmt: skip
    return Resolved(V, report.pop("outcome"), report)
