"""Times selvage beside what else there is in Python, on the same arrays: one table. See README.md."""

from __future__ import annotations

import argparse
import importlib.metadata
import os
import platform
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import selvage
from solvers import solvers
from timing import Row, absent, fastest, module, timed

ipctk, igl, trimesh, fcl, pyvista = (module(name) for name in ("ipctk", "igl", "trimesh", "fcl", "pyvista"))
cgal = module("igl.copyleft.cgal")

ROOT = Path(__file__).parents[2]
BROAD_PHASES = ("HashGrid", "SpatialHash", "BVH", "LBVH", "SweepAndPrune", "SweepAndTiniestQueue")
NARROW_PHASES = ("TightInclusionCCD", "AdditiveCCD")


class Case(NamedTuple):
    """A surface: a pose to check, and a step from V0 to V1."""

    pose: np.ndarray
    V0: np.ndarray
    V1: np.ndarray
    F: np.ndarray


def broad_phases() -> Iterator[tuple[str, Any]]:
    """Those that this build of ipctk has; of the others None."""
    for name in BROAD_PHASES:
        try:
            yield name, getattr(ipctk, name)()
        except (AttributeError, RuntimeError):
            yield name, None


def check(V: np.ndarray, F: np.ndarray) -> Iterator[Row]:
    """Does a pose meet itself? Some peers answer for one surface and another one, not for one with itself."""
    yield timed("check", "selvage, all pairs", lambda: selvage.self_collisions(V, F), lambda a: f"{len(a)} pairs")
    yield timed("check", "selvage, any", lambda: selvage.has_self_collisions(V, F))
    if ipctk:
        mesh, x = ipctk.CollisionMesh(V, ipctk.edges(F), F), np.asfortranarray(V)
        for name, phase in broad_phases():
            if phase is None:
                yield Row("check", f"ipctk {name}, any", None, "not in this build")
            else:
                yield timed("check", f"ipctk {name}, any", partial(ipctk.has_intersections, mesh, x, phase))
    else:
        yield absent("check", "ipctk")
    if cgal:
        yield timed(
            "check", "libigl with CGAL, all pairs", lambda: intersecting_faces(V, F), lambda a: f"{a} pairs, exact"
        )
    else:
        yield absent("check", "libigl with CGAL")
    if pyvista:
        surface = pyvista.PolyData.from_regular_faces(V, F)
        yield timed(
            "check", "VTK's collision filter with itself", lambda: surface.collision(surface)[1],
            lambda a: f"{a} contacts, neighbours included",
        )  # fmt: skip
    else:
        yield absent("check", "pyvista (VTK)")
    yield Row("check", "trimesh with python-fcl", None, "asks two objects, see below; not one with itself")


def intersecting_faces(V: np.ndarray, F: np.ndarray) -> int:
    """Number of pairs that CGAL finds by way of libigl, which names no parameter for 'detect only' in all versions."""
    answer = cgal.remesh_self_intersections(V, np.asarray(F, np.int64), detect_only=True)
    return len(next(part for part in answer if getattr(part, "ndim", 0) == 2 and part.shape[1] == 2))


def step(V0: np.ndarray, V1: np.ndarray, F: np.ndarray) -> Iterator[Row]:
    """How far may a step go?"""

    def tell(answer: float) -> str:
        return f"{answer:.6f}"

    yield timed("free step", "selvage", lambda: selvage.free_step(V0, V1, F), tell)
    finder = selvage.ContinuousCollisionFinder(selvage.TriangleMesh(V0, F), V0, V1)

    def refit() -> float:
        finder.update(V0, V1)
        return finder.find_free_step()

    yield timed("free step", "selvage, refitted", refit, tell)
    if not ipctk:
        yield absent("free step", "ipctk")
        return
    if selvage.has_self_collisions(V0, F):  # for which ipctk is not meant: it may search for hours
        yield Row("free step", "ipctk", None, "not asked: the surface meets itself at the start")
        return
    mesh, x0, x1 = ipctk.CollisionMesh(V0, ipctk.edges(F), F), np.asfortranarray(V0), np.asfortranarray(V1)
    for name, phase in broad_phases():
        for narrow in NARROW_PHASES:
            if phase is None:
                yield Row("free step", f"ipctk {name}, {narrow}", None, "not in this build")
                continue
            ccd = getattr(ipctk, narrow)()
            yield timed(
                "free step", f"ipctk {name}, {narrow}",
                partial(
                    ipctk.compute_collision_free_stepsize, mesh, x0, x1, broad_phase=phase, narrow_phase_ccd=ccd
                ),
                tell,
            )  # fmt: skip


def distances(V: np.ndarray, F: np.ndarray, count: int) -> Iterator[Row]:
    """Closest points and signs of many points around a surface."""
    P = np.random.default_rng(0).uniform(V.min(0), V.max(0), (count, 3))

    def tell(answer: Any) -> str:
        return f"mean {np.abs(np.asarray(answer)).mean():.6g}"

    closest = f"closest points, {count:,}"
    yield timed(closest, "selvage", lambda: selvage.closest_points(P, V, F).distance, tell)
    if igl:
        yield timed(closest, "libigl", lambda: np.sqrt(igl.point_mesh_squared_distance(P, V, F)[0]), tell)
    else:
        yield absent(closest, "libigl")
    if trimesh:
        surface, few = trimesh.Trimesh(V, F, process=False), P[:1000]
        yield timed("closest points, 1,000", "selvage", lambda: selvage.closest_points(few, V, F).distance, tell)
        yield timed(
            "closest points, 1,000", "trimesh", lambda: trimesh.proximity.closest_point(surface, few)[1], tell
        )
    else:
        yield absent(closest, "trimesh")
    if not selvage.SurfaceDistance(selvage.TriangleMesh(V, F)).is_closed:
        yield Row("signed distances", "all", None, "the surface is not closed")
        return
    yield timed("signed distances", "selvage", lambda: selvage.signed_distance(P, V, F).distance, tell)
    if igl:
        kind = igl.SIGNED_DISTANCE_TYPE_FAST_WINDING_NUMBER
        yield timed("signed distances", "libigl", lambda: igl.signed_distance(P, V, F, kind)[0], tell)


def two_objects(V: np.ndarray, F: np.ndarray) -> Iterator[Row]:
    """A surface and a copy of it, moved: the question that python-fcl and VTK answer."""
    moved = V + 0.3 * np.ptp(V, axis=0)
    mesh, other = selvage.TriangleMesh(V, F), selvage.TriangleMesh(moved, F)
    yield timed(
        "two objects", "selvage, all pairs", lambda: selvage.collisions_between(mesh, other),
        lambda a: f"{len(a)} pairs",
    )  # fmt: skip
    if trimesh and fcl:
        a, b = trimesh.Trimesh(V, F, process=False), trimesh.Trimesh(moved, F, process=False)

        def with_fcl() -> bool:
            manager = trimesh.collision.CollisionManager()
            manager.add_object("a", a)
            return bool(manager.in_collision_single(b))

        yield timed("two objects", "trimesh with python-fcl, any", with_fcl)
    else:
        yield absent("two objects", "trimesh with python-fcl")
    if pyvista:
        one, copy = (pyvista.PolyData.from_regular_faces(x, F) for x in (V, moved))
        yield timed(
            "two objects", "VTK's collision filter, all", lambda: one.collision(copy)[1], lambda n: f"{n} contacts"
        )


def versions() -> str:
    """Of all that takes part."""
    names = ("numpy", "ipctk", "libigl", "trimesh", "python-fcl", "pyvista", "vtk", "newton", "warp-lang")
    told = [f"selvage {selvage.__version__}"]
    for name in names:
        try:
            told.append(f"{name} {importlib.metadata.version(name)}")
        except importlib.metadata.PackageNotFoundError:
            told.append(f"{name} is not installed")
    return ", ".join(told)


def pipe_case(small: bool) -> Case:
    """The last pose, and the step in which the pipe first meets itself."""
    pipe = selvage.SurfaceSequence("pipe", triangles=4000 if small else 0)
    first = next(k for k in range(pipe.frame_count) if selvage.has_self_collisions(pipe.positions(k), pipe.F))
    return Case(pipe.positions(pipe.frame_count - 1), pipe.positions(first - 1), pipe.positions(first), pipe.F)


def cloth_ball(folder: Path, scale: str) -> Case:
    """The last two frames of scenes/cloth_ball.json, which is run where the folder does not hold it yet."""
    run = selvage.simulate(
        ROOT / "scenes" / "cloth_ball.json", folder / f"cloth_ball_{scale}", scale=scale, resume=True
    )
    return Case(run.frame(-1), run.frame(-2), run.frame(-1), run.boundary_faces)


def own_case(path: str) -> Case:
    """A mesh of the reader's own; its step makes it 1% larger."""
    mesh = selvage.as_mesh(path)
    surface = mesh.surface() if isinstance(mesh, selvage.TetMesh) else mesh
    middle = surface.V.mean(0)
    return Case(surface.V, surface.V, middle + 1.01 * (surface.V - middle), surface.F)


def main() -> None:
    """Prints the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("meshes", nargs="*", help="meshes of your own, such as bunny.obj and dragon.ply")
    parser.add_argument("--step", nargs=2, metavar=("MESH0", "MESH1"), help="one mesh before and after a step")
    parser.add_argument("--small", action="store_true", help="small surfaces, to try the script")
    parser.add_argument("--scale", default="", help="of cloth_ball: paper has 92,000 triangles, and runs for hours")
    parser.add_argument("--runs", type=Path, default=ROOT / "build" / "benchmark-python", help="where runs are kept")
    parser.add_argument("--no-solvers", action="store_true", help="leave out simulation")
    given = parser.parse_args()

    cases = {
        "pipe": pipe_case(given.small),
        "cloth_ball": cloth_ball(given.runs, "small" if given.small else given.scale),
    }
    cases |= {os.path.basename(path): own_case(path) for path in given.meshes}
    if given.step:
        before, after = (selvage.as_mesh(path) for path in given.step)
        surface = before.surface() if isinstance(before, selvage.TetMesh) else before
        cases[os.path.basename(given.step[0])] = Case(after.V, surface.V, after.V, surface.F)

    print(f"Python {platform.python_version()}, {platform.processor() or platform.machine()}, {os.cpu_count()} cores")
    print(versions())
    heading = "\n| question | with | seconds | answer |\n| --- | --- | --- | --- |"
    for name, (pose, V0, V1, F) in cases.items():
        print(f"\n{name}: {len(F):,} triangles\n{heading}")
        for questions in (
            check(pose, F), step(V0, V1, F), distances(V0, F, 2000 if given.small else 20_000), two_objects(V0, F),
        ):  # fmt: skip
            for row in questions:
                print(row, flush=True)
    if not given.no_solvers:
        rows = list(solvers(given.small))  # Warp tells of what it compiles, not between the rows
        print(f"\nSimulation, seconds a step\n{heading}")
        print(*rows, sep="\n")


if __name__ == "__main__":
    main()
