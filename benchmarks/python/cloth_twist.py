"""Newton's example cloth_twist beside the same sheet by selvage, guaranteed: seconds a frame, and pairs of triangles that
cross, by selvage's exact check of both. See README.md."""

from __future__ import annotations

import argparse
import math
import os
import platform
import resource
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import newton
import newton.usd
import numpy as np
import selvage
import warp
import warp.examples
from pxr import Usd

FPS, SUBSTEPS, ITERATIONS, ACROSS = 60, 10, 4, 50
RADIANS_PER_SECOND = math.pi / 3
# A sheet of newton's tri_ke = tri_ka = 1e3, which are Lame's constants, as a Young's modulus by a thickness. Its edge_ke
# times the length of an edge is the stiffness of a hinge: on these triangles, on average, that of a sheet of 6e-6 J. Its
# damping of stretches is tri_kd = 2e-4 Ns/m; that of bends is edge_kd = 1e-2, ten seconds times edge_ke.
STIFFNESS, POISSON_RATIO, BENDING, DAMPING, BENDING_DAMPING = 2000 * 4 / 3, 1 / 3, 6e-6, 4e-7, 10
DENSITY, THICKNESS, FRICTION = 0.2, 0.002, 0.2


@dataclass
class Frame:
    """One of a run. Seconds are of the frames since the last one."""

    number: int
    V: np.ndarray
    cpu: float
    wall: float


def cpu_seconds() -> float:
    """User time of this process, all threads."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def edges_of(F: np.ndarray) -> np.ndarray:
    """Of triangles, each once."""
    return np.unique(np.sort(F[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1), axis=0)


def strains(V: np.ndarray, rest: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Change of each edge's length by its length at rest, without sign."""
    now, before = (np.linalg.norm(X[edges[:, 0]] - X[edges[:, 1]], axis=1) for X in (V, rest))
    return np.abs(now / before - 1)


def read_sheet() -> tuple[np.ndarray, np.ndarray]:
    """The mesh of the example, as it places it: along y, ends at y = -0.75 and 0.75 [m]."""
    path = os.path.join(warp.examples.get_asset_directory(), "square_cloth.usd")
    stage = Usd.Stage.Open(path)  # without which its parts are gone
    mesh = newton.usd.get_mesh(stage.GetPrimAtPath("/root/cloth/cloth"))
    V = 0.01 * np.asarray(mesh.vertices, dtype=np.float64)
    return np.column_stack([-V[:, 1], V[:, 0], V[:, 2]]), np.asarray(mesh.indices).reshape(-1, 3)


class Newton:
    """The example, with its settings. Its ends are turned here, by NumPy: that costs it nothing."""

    def __init__(self, V: np.ndarray, F: np.ndarray) -> None:
        builder = newton.ModelBuilder(gravity=(0.0, 0.0, 0.0))
        builder.add_cloth_mesh(
            pos=warp.vec3(0.0, 0.0, 0.0),
            rot=warp.quat_identity(),
            scale=1.0,
            vertices=[warp.vec3(*map(float, v)) for v in V],
            indices=F.flatten(),
            vel=warp.vec3(0.0, 0.0, 0.0),
            density=DENSITY,
            tri_ke=1.0e3,
            tri_ka=1.0e3,
            tri_kd=2.0e-4,
            edge_ke=1.0e-3,
            edge_kd=1.0e-2,
        )
        builder.color()
        self.model = builder.finalize(device="cpu")
        self.model.soft_contact_ke = 1.0e3
        self.model.soft_contact_kd = 1.0e-1
        self.model.soft_contact_mu = FRICTION
        self.first = np.arange(0, len(V), ACROSS)
        self.last = self.first + ACROSS - 1
        flags = self.model.particle_flags.numpy()
        flags[np.concatenate([self.first, self.last])] &= ~int(newton.ParticleFlags.ACTIVE)
        self.model.particle_flags = warp.array(flags, device="cpu")
        self.solver = newton.solvers.SolverVBD(
            self.model,
            iterations=ITERATIONS,
            particle_enable_self_contact=True,
            particle_self_contact_margin=THICKNESS,
            particle_self_contact_gap=0.0015,
            particle_vertex_contact_buffer_size=64,
            particle_edge_contact_buffer_size=128,
        )
        self.now, self.next = self.model.state(), self.model.state()
        self.control = self.model.control()
        self.pipeline = newton.CollisionPipeline(self.model)
        self.contacts = self.pipeline.contacts()
        self.start, self.steps = self.now.particle_q.numpy().astype(np.float64), 0

    def turn_ends(self) -> None:
        """About y, the two against each other."""
        angle = RADIANS_PER_SECOND * self.steps / (FPS * SUBSTEPS)
        places = [state.particle_q.numpy() for state in (self.now, self.next)]  # of a CPU: the very memory
        for rows, turned in ((self.first, angle), (self.last, -angle)):
            x, z = self.start[rows, 0], self.start[rows, 2]
            for q in places:
                q[rows, 0] = math.cos(turned) * x + math.sin(turned) * z
                q[rows, 2] = math.cos(turned) * z - math.sin(turned) * x
        self.steps += 1

    def step_frame(self) -> None:
        """As Example.simulate()."""
        self.pipeline.collide(self.now, self.contacts)
        self.solver.rebuild_bvh(self.now)
        for _ in range(SUBSTEPS):
            self.now.clear_forces()
            self.turn_ends()
            self.solver.step(self.now, self.next, self.control, self.contacts, 1 / (FPS * SUBSTEPS))
            self.now, self.next = self.next, self.now


def run_newton(V: np.ndarray, F: np.ndarray, frames: list[int]) -> Iterator[Frame]:
    """Steps the example. Its kernels are compiled before."""
    Newton(V, F).step_frame()
    peer, done = Newton(V, F), 0
    for frame in frames:
        cpu, wall = cpu_seconds(), time.perf_counter()
        for _ in range(frame - done):
            peer.step_frame()
        cpu, wall = cpu_seconds() - cpu, time.perf_counter() - wall
        yield Frame(frame, peer.now.particle_q.numpy().astype(np.float64), cpu / (frame - done), wall / (frame - done))
        done = frame


def scene_of(path: Path, solver: str, seconds: float) -> dict:
    """The same sheet, ends and contact, with a guarantee."""

    def end(side: int) -> dict:
        low, high = sorted((side * 0.74, side * 0.76))
        # The side at y = -0.75 turns by +60 degrees a second about y.
        degrees = -side * math.degrees(RADIANS_PER_SECOND) * seconds
        return {
            "region": {"box": {"min": [-1, low, -1], "max": [1, high, 1]}},
            "motion": {"axis": [0, 1, 0], "keyframes": [{"time": 0}, {"time": seconds, "degrees": degrees}]},
        }

    scene = {
        "selvage_scene": 1,
        "solver": solver,
        "gravity": [0, 0, 0],
        "substeps": SUBSTEPS,
        "contact": {"guarantee": True, "static_friction": FRICTION, "dynamic_friction": FRICTION},
        "bodies": [
            {
                "mesh": {"file": str(path)},
                "material": {
                    "kind": "cloth",
                    "density": DENSITY,
                    "stiffness": STIFFNESS,
                    "poisson_ratio": POISSON_RATIO,
                    "bending": BENDING,
                    "thickness": THICKNESS,
                    "damping": DAMPING,
                    "bending_damping": BENDING_DAMPING,
                },
                "handles": [end(-1), end(1)],
            }
        ],
    }
    if solver == "vbd":
        scene["iterations"] = ITERATIONS
    return scene


def run_selvage(V: np.ndarray, F: np.ndarray, frames: list[int], solver: str) -> Iterator[Frame]:
    """Runs a scene, also what it writes to its folder."""
    with tempfile.TemporaryDirectory() as folder, selvage.threads(1):
        mesh = Path(folder) / "sheet.obj"
        selvage.write_mesh(mesh, V, F)
        clock: list[tuple[float, float]] = [(cpu_seconds(), time.perf_counter())]

        def tick(_row: dict) -> None:
            clock.append((cpu_seconds(), time.perf_counter()))

        run = selvage.simulate(
            scene_of(mesh, solver, frames[-1] / FPS), Path(folder) / "run", frames=frames[-1], progress=tick
        )
        assert run.report["outcome"] == "finished", run.report
        # The progress of frame 0 is the second entry.
        for done, frame in zip([0, *frames], frames):
            (cpu0, wall0), (cpu1, wall1) = clock[done + 1], clock[frame + 1]
            count = frame - done
            yield Frame(frame, run.frame(frame), (cpu1 - cpu0) / count, (wall1 - wall0) / count)
        held = run.statistics["held_back_vertices"].mean()
        print(f"\n{held:.1f} vertices a frame were held back by the guarantee")


def main() -> None:
    """Prints a table a run."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, nargs="+", default=[60, 120, 180, 240, 300], help="that are judged")
    parser.add_argument("--solvers", nargs="*", default=["xpbd", "vbd"], help="of selvage")
    parser.add_argument("--no-peer", action="store_true", help="without newton")
    arguments = parser.parse_args()
    frames = sorted(arguments.frames)
    warp.config.quiet = True
    warp.init()
    warp.set_device("cpu")
    V, F = read_sheet()
    edges = edges_of(F)
    print(f"Python {platform.python_version()}, {platform.processor() or platform.machine()}, {os.cpu_count()} cores")
    print(f"selvage {selvage.__version__}, newton {newton.__version__}, warp {warp.__version__}")
    print(f"{len(V)} vertices, {len(F)} triangles, {SUBSTEPS} substeps; one thread")
    runs: dict[str, Callable[[], Iterator[Frame]]] = {}
    if not arguments.no_peer:
        runs["newton SolverVBD"] = lambda: run_newton(V, F, frames)
    for solver in arguments.solvers:
        runs[f"selvage {solver}"] = lambda s=solver: run_selvage(V, F, frames, s)
    for name, run in runs.items():
        print(f"\n| {name}, frame | user CPU [s/frame] | wall [s/frame] | pairs that cross | strain: mean, most |")
        print("| --- | --- | --- | --- | --- |")
        for frame in run():
            pairs, strain = len(selvage.self_collisions(frame.V, F)), strains(frame.V, V, edges)
            cost = f"{frame.cpu:.3f} | {frame.wall:.3f}"
            print(f"| {frame.number} | {cost} | {pairs} | {strain.mean():.2%}, {strain.max():.1%} |", flush=True)


if __name__ == "__main__":
    main()
