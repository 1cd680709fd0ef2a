"""A sweep of vertex block descent over a soft grid by newton's SolverVBD and by selvage, one thread: what a sweep costs, and
the energy that one step reaches over the time that it takes. See README.md."""

from __future__ import annotations

import argparse
import os
import platform
import time
from collections.abc import Callable
from typing import Any

import newton
import numpy as np
import selvage
import warp

CELLS, SUBSTEPS, ITERATIONS = 20, 10, 3
YOUNG, POISSON, DENSITY = 1e5, 0.3, 1000.0
MU = YOUNG / (2 * (1 + POISSON))
# What both multiply the square of the volume's change by, and newton calls k_lambda: Lame's first parameter and mu.
VOLUME = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON)) + MU
STEP = 1 / 60  # of the energies [s]


def grid(height: float, gravity: float) -> newton.ModelBuilder:
    """A cube of 1 m, five elements a cell, by newton."""
    builder = newton.ModelBuilder(gravity=(0.0, 0.0, gravity))
    builder.add_soft_grid(
        pos=warp.vec3(0.0, 0.0, height), rot=warp.quat_identity(), vel=warp.vec3(0.0, 0.0, 0.0),
        dim_x=CELLS, dim_y=CELLS, dim_z=CELLS, cell_x=1 / CELLS, cell_y=1 / CELLS, cell_z=1 / CELLS,
        density=DENSITY, k_mu=MU, k_lambda=VOLUME, k_damp=0.0, particle_radius=0.005,
    )  # fmt: skip
    return builder


def finished(builder: newton.ModelBuilder) -> newton.Model:
    """Coloured, on the processor."""
    builder.color()
    return builder.finalize(device="cpu")


def mesh_of(model: newton.Model) -> selvage.TetMesh:
    """The same vertices and elements."""
    return selvage.TetMesh(model.particle_q.numpy().astype(np.float64), model.tet_indices.numpy().reshape(-1, 4))


def scene(solver: str, body: dict[str, Any], **options: Any) -> selvage.Simulation:
    """One body that neither sleeps nor is damped apart from its solver."""
    material = {"youngs_modulus": YOUNG, "poisson_ratio": POISSON, "density": DENSITY, "damping": 0}
    return selvage.Simulation(
        {
            "selvage_scene": 1,
            "solver": solver,
            "sleep_speed": 0,
            "deformation_damping": 0,
            "bodies": [{"material": material, **body}],
            **options,
        }
    )


def falling(contact: bool) -> Callable[[], None]:
    """A frame of newton's grid, 2 cm above the ground."""
    builder = grid(0.02, -9.81)
    builder.add_ground_plane()
    model = finished(builder)
    options: dict[str, Any] = {"iterations": ITERATIONS}
    if contact:
        options |= {
            "particle_enable_self_contact": True,
            "particle_self_contact_margin": 0.005,
            "particle_self_contact_gap": 0.005,
        }
    solver = newton.solvers.SolverVBD(model, **options)
    states, control = [model.state(), model.state()], model.control()
    pipeline = newton.CollisionPipeline(model)
    contacts = pipeline.contacts()

    def frame() -> None:
        for _ in range(SUBSTEPS):
            states[0].clear_forces()
            pipeline.collide(states[0], contacts)
            solver.step(states[0], states[1], control, contacts, 1 / (60 * SUBSTEPS))
            states.reverse()

    return frame


def falling_here(solver: str, mode: str) -> Callable[[], None]:
    """The same by selvage."""
    ground = {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}
    simulation = scene(
        solver,
        {"mesh": mesh_of(finished(grid(0.02, -9.81)))},
        substeps=SUBSTEPS,
        iterations=ITERATIONS,
        contact={"mode": mode},
        colliders=[ground],
    )

    def frame() -> None:
        for _ in range(SUBSTEPS):
            simulation.step()

    return frame


def print_sweeps(frames: int) -> None:
    """Nanoseconds an element and sweep, all of a frame, in turns: medians."""
    runs = {
        "newton SolverVBD": (falling(False), falling(True)),
        "selvage vbd": (falling_here("vbd", "none"), falling_here("vbd", "hybrid")),
        "selvage xpbd": (falling_here("xpbd", "none"), falling_here("xpbd", "hybrid")),
    }
    costs: dict[str, tuple[list[float], list[float]]] = {name: ([], []) for name in runs}
    for turn in range(frames + 1):  # the first compiles and allocates
        for name, pair in runs.items():
            for frame, cost in zip(pair, costs[name]):
                begin = time.process_time()
                frame()
                if turn:
                    cost.append(time.process_time() - begin)
    print(f"\n| {5 * CELLS**3:,} elements, {SUBSTEPS} steps of {ITERATIONS} | ns an element and sweep | with contact |")
    print("| --- | --- | --- |")
    for name, pair in costs.items():
        alone, contact = (1e9 * np.median(cost) / (5 * CELLS**3 * SUBSTEPS * ITERATIONS) for cost in pair)
        print(f"| {name} | {alone:.0f} | {contact:.0f} |")


class Stretched:
    """The grid at rest in no way: stretched, pressed and shaken. One step of it has an energy to be made least."""

    def __init__(self) -> None:
        self.model = finished(grid(0, 0))
        self.rest = mesh_of(self.model)
        V, T = self.rest.V, self.rest.T
        noise = np.random.default_rng(1).normal(0, 0.1 / CELLS, V.shape)
        self.start = (V * [1.4, 0.8, 0.8] + noise).astype(np.float32).astype(np.float64)
        edges = self.edges(V)
        self.inverse, self.volume = np.linalg.inv(edges), np.abs(np.linalg.det(edges)) / 6
        self.mass = np.zeros(len(V))
        np.add.at(self.mass, T.ravel(), np.repeat(self.volume * DENSITY / 4, 4))
        # Newton gives all vertices of a grid the same mass; so that both solve the same step, these are of its elements.
        self.model.particle_mass.assign(self.mass.astype(np.float32))
        self.model.particle_inv_mass.assign((1 / self.mass).astype(np.float32))
        self.model.particle_q.assign(self.start.astype(np.float32))

    def edges(self, X: np.ndarray) -> np.ndarray:
        """Three of each element, as columns."""
        T = self.rest.T
        return np.stack([X[T[:, i]] - X[T[:, 0]] for i in (1, 2, 3)], axis=2)

    def energy(self, X: np.ndarray) -> float:
        """The incremental potential of the step: the stable Neo-Hookean energy that both have, and inertia [J]."""
        F = self.edges(X) @ self.inverse
        rest = 1 + MU / VOLUME
        elastic = MU / 2 * ((F**2).sum((1, 2)) - 3) + VOLUME / 2 * ((np.linalg.det(F) - rest) ** 2 - (1 - rest) ** 2)
        return float((self.volume * elastic).sum() + (self.mass * ((X - self.start) ** 2).sum(1)).sum() / (2 * STEP**2))

    def newton(self, sweeps: int) -> tuple[float, float]:
        """Seconds and energy of one step."""
        solver = newton.solvers.SolverVBD(self.model, iterations=sweeps)
        now, after, control = self.model.state(), self.model.state(), self.model.control()
        begin = time.process_time()
        solver.step(now, after, control, None, STEP)
        seconds = time.process_time() - begin
        return seconds, self.energy(after.particle_q.numpy().astype(np.float64))

    def selvage(self, solver: str, **options: Any) -> tuple[float, float]:
        """The same."""
        body = {"mesh": selvage.TetMesh(self.start, self.rest.T), "rest": self.rest}
        contact = {"mode": "none"}
        simulation = scene(solver, body, gravity=[0, 0, 0], substeps=1, contact=contact, **options)
        begin = time.process_time()
        simulation.step()
        return time.process_time() - begin, self.energy(simulation.positions)


def print_energies() -> None:
    """Of one step, over the time that it takes: the fastest of three runs."""
    grid_ = Stretched()
    least = grid_.selvage("newton", newton={"steps": 100, "tolerance": 1e-9})[1]
    runs: list[tuple[str, Callable[[], tuple[float, float]]]] = []
    for sweeps in (3, 10, 30, 100):
        runs.append((f"newton SolverVBD, {sweeps} sweeps", lambda n=sweeps: grid_.newton(n)))
    for solver in ("vbd", "xpbd"):
        for sweeps in (3, 10, 30, 100):
            runs.append((f"selvage {solver}, {sweeps}", lambda s=solver, n=sweeps: grid_.selvage(s, iterations=n)))
    for steps in (1, 2, 4):
        runs.append((f"selvage newton, {steps} steps", lambda n=steps: grid_.selvage("newton", newton={"steps": n})))
    grid_.newton(1)  # compiles
    print(f"\nStretched, energy {grid_.energy(grid_.start):.1f} J at the start, at least {least:.1f} J\n")
    print("| solver | ms | energy above the least [J] |")
    print("| --- | --- | --- |")
    for name, run in runs:
        seconds, energy = min(run() for _ in range(3))
        print(f"| {name} | {1e3 * seconds:.1f} | {energy - least:.3g} |", flush=True)


def main() -> None:
    """Prints both tables."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=6, help="that are timed of each")
    arguments = parser.parse_args()
    warp.config.quiet = True
    warp.init()
    warp.set_device("cpu")
    print(f"Python {platform.python_version()}, {platform.processor() or platform.machine()}, {os.cpu_count()} cores")
    print(f"selvage {selvage.__version__}, newton {newton.__version__}, warp {warp.__version__}; one thread")
    with selvage.threads(1):
        print_sweeps(arguments.frames)
        print_energies()


if __name__ == "__main__":
    main()
