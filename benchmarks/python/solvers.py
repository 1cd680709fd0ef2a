"""XPBD and VBD of selvage beside those of Newton (on Warp): the same bodies, time step and iterations."""

from __future__ import annotations

import time
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
import selvage
from timing import Row, absent, module

warp = module("warp")
if warp:
    warp.config.quiet = True  # before newton asks for it
newton = module("newton")

TIME_STEP = 1 / 600
ITERATIONS = 10
YOUNG, POISSON, DENSITY = 1e5, 0.3, 1000.0


def solvers(small: bool) -> Iterator[Row]:
    """Two soft boxes, one that falls on the other, on the ground."""
    box = selvage.make("box", size=(0.4, 0.4, 0.4), cell=0.1 if small else 0.04)
    count = 30 if small else 300
    question = f"{2 * len(box.T):,} tetrahedra, {count} steps"
    for solver in ("xpbd", "vbd"):
        yield of_selvage(question, solver, box, count)
    for name in ("SolverXPBD", "SolverVBD"):
        if newton is None:
            yield absent(question, f"newton, {name}")
            continue
        try:
            yield of_newton(question, name, box, count)
        except Exception as error:  # a version without the solver, or that refuses the bodies
            yield Row(question, f"newton, {name}", None, f"{type(error).__name__}: {str(error).splitlines()[0][:80]}")


def told(V: np.ndarray, T: np.ndarray) -> str:
    """What the last positions look like: pairs of triangles that cross, and how many elements are inverted."""
    if not np.isfinite(V).all():
        return "positions are not finite"
    mesh = selvage.TetMesh(V, T)
    inverted = int((selvage.orient3d(*(V[T[:, i]] for i in range(4))) < 0).sum())
    return f"{len(selvage.self_collisions(mesh))} crossing pairs, {inverted} inverted, lowest {V[:, 2].min():.3f} m"


def seconds_a_step(step: Callable[[], object], count: int) -> float:
    """The mean of all steps but the first, which compiles and allocates."""
    step()
    start = time.perf_counter()
    for _ in range(count - 1):
        step()
    return (time.perf_counter() - start) / (count - 1)


def of_selvage(question: str, solver: str, box: selvage.TetMesh, count: int) -> Row:
    """By `Simulation`, with contact by both detections."""
    material = {"youngs_modulus": YOUNG, "poisson_ratio": POISSON, "density": DENSITY}
    simulation = selvage.Simulation(
        {
            "selvage_scene": 1,
            "solver": solver,
            "iterations": ITERATIONS,
            "substeps": round(1 / 60 / TIME_STEP),
            "bodies": [
                {"mesh": box, "translate": [0, 0, 0.01], "material": material},
                {"mesh": box, "translate": [0.1, 0.05, 0.45], "material": material},
            ],
            "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}],
        }
    )
    seconds = seconds_a_step(simulation.step, count)
    return Row(question, f"selvage, {solver}", seconds, told(simulation.positions, simulation.mesh.T))


def of_newton(question: str, name: str, box: selvage.TetMesh, count: int) -> Row:
    """On the processor. Its soft bodies meet one another as particles (XPBD), or by triangles (VBD)."""
    mu = YOUNG / (2 * (1 + POISSON))
    lame = YOUNG * POISSON / ((1 + POISSON) * (1 - 2 * POISSON))
    builder = newton.ModelBuilder()
    for place in ((0, 0, 0.01), (0.1, 0.05, 0.45)):
        builder.add_soft_mesh(
            pos=warp.vec3(*place), rot=warp.quat_identity(), scale=1.0, vel=warp.vec3(0.0, 0.0, 0.0),
            vertices=[warp.vec3(*map(float, v)) for v in box.V], indices=box.T.ravel().tolist(),
            density=DENSITY, k_mu=mu, k_lambda=lame, k_damp=1e-4, particle_radius=0.005,
        )  # fmt: skip
    builder.add_ground_plane()
    if name == "SolverVBD":
        builder.color()
    model = builder.finalize(device="cpu")
    options: dict[str, Any] = {"iterations": ITERATIONS}
    if name == "SolverVBD":
        options |= {
            "particle_enable_self_contact": True,
            "particle_self_contact_margin": 0.005,
            "particle_self_contact_gap": 0.005,
        }
    solver = getattr(newton.solvers, name)(model, **options)
    states = [model.state(), model.state()]
    control = model.control()

    def step() -> None:
        states[0].clear_forces()
        solver.step(states[0], states[1], control, model.collide(states[0]), TIME_STEP)
        states.reverse()

    seconds = seconds_a_step(step, count)
    V = states[0].particle_q.numpy().astype(float)
    T = np.vstack([box.T, box.T + len(box.V)])
    return Row(question, f"newton, {name}", seconds, told(V, T))
