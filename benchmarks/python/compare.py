"""Times selvage beside ipctk, libigl, trimesh (with python-fcl) and VTK, on the same arrays. See README.md."""

from __future__ import annotations

import importlib
import importlib.metadata
import os
import platform
import sys
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import selvage

Row = tuple[str, str, float, str]


def fastest(work: Callable[[], Any], budget: float = 2.0) -> tuple[float, Any]:
    """Seconds of the fastest of at least three runs, at most about `budget` seconds in all; and the answer."""
    best, answer = np.inf, None
    begin = time.perf_counter()
    for run in range(1000):
        start = time.perf_counter()
        answer = work()
        best = min(best, time.perf_counter() - start)
        if run >= 2 and time.perf_counter() - begin > budget:
            break
    return best, answer


def module(name: str) -> Any:
    """The package; None where it is not installed."""
    try:
        return importlib.import_module(name)
    except ImportError:
        return None


ipctk, igl, trimesh, fcl, pyvista = (module(name) for name in ("ipctk", "igl", "trimesh", "fcl", "pyvista"))


def check(V: np.ndarray, F: np.ndarray) -> list[Row]:
    """Does a pose meet itself? Most peers answer for pairs of boxes or of objects, not of triangles of one surface."""
    rows: list[Row] = []

    def add(name: str, work: Callable[[], Any], tell: Callable[[Any], str]) -> None:
        seconds, answer = fastest(work)
        rows.append(("check", name, seconds, tell(answer)))

    add("selvage, pairs", lambda: selvage.self_collisions(V, F), lambda a: f"{len(a)} pairs")
    add("selvage, any", lambda: selvage.has_self_collisions(V, F), str)
    if ipctk:
        mesh = ipctk.CollisionMesh(V, ipctk.edges(F), F)
        for broad in ("HashGrid", "BVH", "LBVH", "SweepAndPrune"):
            if hasattr(ipctk, broad):
                phase = getattr(ipctk, broad)()
                add(f"ipctk {broad}, any", lambda p=phase: ipctk.has_intersections(mesh, V, p), str)
    if igl and hasattr(igl, "fast_find_self_intersections"):
        add("libigl, any", lambda: igl.fast_find_self_intersections(V, F), lambda a: str(bool(np.any(a[0]))))
    if pyvista:
        surface = pyvista.PolyData.from_regular_faces(V, F)
        add("VTK with itself", lambda: surface.collision(surface)[1], lambda a: f"{a} contacts, neighbours included")
    return rows


def step(V0: np.ndarray, V1: np.ndarray, F: np.ndarray) -> list[Row]:
    """How far may a step go?"""
    rows: list[Row] = []

    def add(name: str, work: Callable[[], float]) -> None:
        seconds, answer = fastest(work)
        rows.append(("free step", name, seconds, f"{answer:.6f}"))

    add("selvage", lambda: selvage.free_step(V0, V1, F))
    finder = selvage.ContinuousCollisionFinder(selvage.TriangleMesh(V0, F), V0, V1)

    def refit() -> float:
        finder.update(V0, V1)
        return finder.find_free_step()

    add("selvage, refitted", refit)
    if ipctk:
        mesh = ipctk.CollisionMesh(V0, ipctk.edges(F), F)
        for broad in ("HashGrid", "BVH", "LBVH", "SweepAndPrune"):
            for narrow in ("TightInclusionCCD", "AdditiveCCD"):
                if hasattr(ipctk, broad) and hasattr(ipctk, narrow):
                    phase, ccd = getattr(ipctk, broad)(), getattr(ipctk, narrow)()
                    add(
                        f"ipctk {broad}, {narrow}",
                        lambda p=phase, c=ccd: ipctk.compute_collision_free_stepsize(
                            mesh, V0, V1, broad_phase=p, narrow_phase_ccd=c
                        ),
                    )
    return rows


def distances(V: np.ndarray, F: np.ndarray) -> list[Row]:
    """Closest points and signs of many points around a surface."""
    rng = np.random.default_rng(0)
    P = rng.uniform(V.min(0), V.max(0), (20_000, 3))
    rows: list[Row] = []

    def add(what: str, name: str, work: Callable[[], Any]) -> None:
        seconds, answer = fastest(work)
        rows.append((what, name, seconds, f"mean {np.abs(np.asarray(answer)).mean():.6g}"))

    add("closest", "selvage", lambda: selvage.closest_points(P, V, F).distance)
    if igl:
        add("closest", "libigl", lambda: np.sqrt(igl.point_mesh_squared_distance(P, V, F)[0]))
    if trimesh:
        surface = trimesh.Trimesh(V, F, process=False)
        few = P[:1000]
        add("closest, 1,000", "selvage", lambda: selvage.closest_points(few, V, F).distance)
        add("closest, 1,000", "trimesh", lambda: trimesh.proximity.closest_point(surface, few)[1])
    if selvage.SurfaceDistance(selvage.TriangleMesh(V, F)).is_closed:
        add("signed", "selvage", lambda: selvage.signed_distance(P, V, F).distance)
        if igl:
            kind = igl.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
            add("signed", "libigl", lambda: igl.signed_distance(P, V, F, kind)[0])
    return rows


def two_objects(V: np.ndarray, F: np.ndarray) -> list[Row]:
    """A surface and a copy of it, moved: the question that python-fcl answers."""
    if not (trimesh and fcl):
        return []
    offset = 0.3 * np.ptp(V, axis=0)
    a, b = trimesh.Trimesh(V, F, process=False), trimesh.Trimesh(V + offset, F, process=False)

    def with_fcl() -> bool:
        manager = trimesh.collision.CollisionManager()
        manager.add_object("a", a)
        return bool(manager.in_collision_single(b))

    def with_selvage() -> bool:
        one, other = (selvage.SelfCollisionFinder(selvage.TriangleMesh(x, F), asked_once=True) for x in (V, V + offset))
        return len(one.find_pairs_with(other)) > 0

    return [
        ("two objects", name, *((lambda t: (t[0], str(t[1])))(fastest(work))))
        for name, work in (("selvage, all pairs", with_selvage), ("trimesh with python-fcl, any", with_fcl))
    ]


def versions() -> str:
    """Of all that takes part."""
    names = ("selvage", "numpy", "ipctk", "libigl", "trimesh", "python-fcl", "pyvista", "vtk")
    told = []
    for name in names:
        try:
            told.append(f"{name} {selvage.__version__ if name == 'selvage' else importlib.metadata.version(name)}")
        except importlib.metadata.PackageNotFoundError:
            told.append(f"{name} is not installed")
    return ", ".join(told)


def main() -> None:
    """Prints the table."""
    steps: dict[str, tuple[np.ndarray, np.ndarray, np.ndarray]] = {}
    if len(sys.argv) == 3:
        before, after = (selvage.as_mesh(path) for path in sys.argv[1:])
        surface = before.surface() if isinstance(before, selvage.TetMesh) else before
        steps[os.path.basename(sys.argv[1])] = surface.V, after.V, surface.F
    else:
        for name in ("pipe", "crumple"):
            sequence = selvage.SurfaceSequence(name)
            last = sequence.frame_count - 1
            steps[name] = sequence.positions(last - 1), sequence.positions(last), sequence.F
        ball = selvage.make("ball", radius=1, cell=0.03).surface()
        steps["ball"] = ball.V, ball.V * 1.01, ball.F
    print(f"Python {platform.python_version()}, {platform.processor() or platform.machine()}, {os.cpu_count()} cores")
    print(versions())
    for name, (V0, V1, F) in steps.items():
        print(f"\n{name}: {len(F)} triangles\n\n| question | with | seconds | answer |\n| --- | --- | --- | --- |")
        for row in check(V1, F) + step(V0, V1, F) + distances(V0, F) + two_objects(V0, F):
            print(f"| {row[0]} | {row[1]} | {row[2]:.6f} | {row[3]} |", flush=True)


if __name__ == "__main__":
    main()
