"""The same small scenes by each solver with its defaults: what a frame costs, what crosses on the way and at the end, how
fast things still move when they should be at rest. See README.md."""

from __future__ import annotations

import argparse
import os
import platform
import resource
import tempfile
from typing import Any

import selvage

SOLVERS = ("xpbd", "newton", "vbd")
LONG = ("a heap of 200 to 1,500 kg/m3 in a box", "two octopi in a box", "a large pile of 200 to 1,500 kg/m3 in a box")
FLOOR = {"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}


def solid(modulus: float, density: float) -> dict[str, Any]:
    """A material."""
    return {"youngs_modulus": modulus, "poisson_ratio": 0.4, "density": density}


def falling(
    mesh: dict[str, Any],
    material: dict[str, Any],
    height: float,
    seed: int,
    counts: tuple[int, int, int] = (2, 1, 1),
    spacing: float = 0.8,
) -> dict[str, Any]:
    """Some of a body side by side, the lowest at a height."""
    return {
        "mesh": mesh,
        "translate": [-spacing * (counts[0] - 1) / 2, -spacing * (counts[1] - 1) / 2, height],
        "instances": {
            "grid": {"counts": list(counts), "spacing": [spacing, spacing, 0.55]},
            "jitter": {"translate": 0.05, "degrees": 40, "seed": seed},
        },
        "material": material,
    }


def scenes() -> dict[str, dict[str, Any]]:
    """All end at rest on a floor."""
    ball = {"shape": "ball", "radius": 0.2, "cell": 0.08}
    cube = {"shape": "box", "size": [0.4, 0.4, 0.4], "cell": 0.1}
    sheet = {"shape": "cloth", "size": [1, 1, 0], "cell": 0.05}
    grid = {"counts": [2, 2, 2], "spacing": [0.41, 0.41, 0.45]}
    octopus = {"shape": "octopus", "radius": 0.5, "slenderness": 2, "elements": 10800, "seed": 3}
    torus = {"shape": "torus", "radius": 0.25, "inner_radius": 0.1, "cell": 0.06}
    return {
        "eight soft balls fall into a box": {
            "bodies": [
                {
                    "mesh": ball,
                    "translate": [-0.2, -0.2, 0.25],
                    "instances": {"grid": grid, "jitter": {"translate": 0.005, "degrees": 30, "seed": 1}},
                    "material": solid(5e4, 1000),
                }
            ],
            "colliders": [{"box": {"min": [-0.45, -0.45, 0], "max": [0.45, 0.45, 3]}}],
        },
        "a cube of 1,500 kg/m3 on two of 200": {
            "bodies": [
                {"mesh": cube, "translate": [0, 0, 0.01], "material": solid(2e5, 200)},
                {"mesh": cube, "translate": [0.02, 0.01, 0.42], "material": solid(2e5, 200)},
                {"mesh": cube, "translate": [0, 0.02, 0.83], "material": solid(2e5, 1500)},
            ],
            "colliders": [FLOOR],
        },
        "a heap of 200 to 1,500 kg/m3 in a box": {
            "bodies": [
                {"mesh": octopus, "translate": [0, 0, 0.6], "material": solid(1e5, 200)},
                falling(cube, solid(5e5, 1000), 1.3, 2),
                falling(torus, solid(1e6, 200), 2.3, 3),
                falling(ball, solid(2e5, 1500), 2.9, 4),
            ],
            "colliders": [{"box": {"min": [-0.9, -0.9, 0], "max": [0.9, 0.9, 6]}}],
        },
        "a large pile of 200 to 1,500 kg/m3 in a box": {
            "bodies": [
                falling(octopus, solid(1e5, 200), 0.6, 1, (2, 2, 2), 1.3),
                falling({**cube, "cell": 0.05}, solid(5e5, 1000), 2.0, 2, (3, 3, 1), 0.9),
                falling({**torus, "cell": 0.05}, solid(1e6, 200), 2.8, 3, (3, 3, 1), 0.9),
                falling({**ball, "cell": 0.05}, solid(2e5, 1500), 3.3, 4, (3, 3, 1), 0.9),
            ],
            "colliders": [{"box": {"min": [-1.5, -1.5, 0], "max": [1.5, 1.5, 8]}}],
        },
        "two octopi in a box": {
            "bodies": [
                {
                    "mesh": octopus,
                    "translate": [0, 0, 0.5],
                    "instances": {
                        "grid": {"counts": [1, 1, 2], "spacing": [1, 1, 0.5]},
                        "jitter": {"translate": 0.02, "degrees": 20, "seed": 8},
                    },
                    "material": solid(1e5, 1000),
                }
            ],
            "colliders": [{"box": {"min": [-0.6, -0.6, 0], "max": [0.6, 0.6, 6]}}],
        },
        "three sheets on a ball": {
            "bodies": [
                {
                    "mesh": sheet,
                    "translate": [-0.5, -0.5, 0.52],
                    "instances": {"grid": {"counts": [1, 1, 3], "spacing": [0, 0, 0.03]}},
                    "material": {"kind": "cloth", "bending": 1e-5, "thickness": 0.004},
                }
            ],
            "colliders": [FLOOR, {"sphere": {"centre": [0, 0, 0.25], "radius": 0.25}}],
        },
    }


def cpu_seconds() -> float:
    """User time of this process, all threads."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_utime


def row(scene: dict[str, Any], solver: str, frames: int, substeps: int | None) -> str:
    """Runs a scene on one thread. Nothing may sleep: that would hide what trembles."""
    with tempfile.TemporaryDirectory() as folder, selvage.threads(1):
        made = {"selvage_scene": 1, "solver": solver, "sleep_speed": 0, **scene}
        if substeps:
            made["substeps"] = substeps
        begin = cpu_seconds()
        run = selvage.simulate(made, folder, frames=frames)
        cost = (cpu_seconds() - begin) / frames
        s = run.statistics
        last = max(1, frames // 6)
        residual = f"{s['residual'][-last:].max():.2g}" if solver != "xpbd" else ""
        potential = (s["elastic_energy"] + s["gravity_energy"])[-last:].mean()
        return (
            f"| {solver} | {cost:.3f} | {s['triangle_pairs'].max():.0f} | {s['triangle_pairs'][-1]:.0f} "
            f"| {s['fastest'][-last:].max():.4f} | {s['kinetic_energy'][-last:].mean():.2g} "
            f"| {potential:.5g} | {residual} |"
        )


def main() -> None:
    """Prints a table a scene."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--frames", type=int, default=180, help="of 1/60 s; the last sixth counts as at rest")
    parser.add_argument("--scene", default="", help="those whose name has this in it; without, the three that take a minute")
    parser.add_argument("--solver", choices=SOLVERS, action="append", help="only this one; may be given several times")
    parser.add_argument("--substeps", type=int, help="steps a frame in place of the default, as to compare at equal time")
    arguments = parser.parse_args()
    frames = arguments.frames
    print(f"Python {platform.python_version()}, {platform.processor() or platform.machine()}, {os.cpu_count()} cores")
    print(f"selvage {selvage.__version__}, {frames} frames, one thread")
    for name, scene in scenes().items():
        if arguments.scene not in name or (not arguments.scene and name in LONG):
            continue
        print(f"\n{name}:\n")
        print(
            "| solver | user CPU [s/frame] | most pairs | pairs at the end | fastest at rest [m/s] "
            "| kinetic energy of it [J] | elastic and potential [J] | residual [m] |"
        )
        print("| --- | --- | --- | --- | --- | --- | --- | --- |")
        for solver in arguments.solver or SOLVERS:
            print(row(scene, solver, frames, arguments.substeps), flush=True)


if __name__ == "__main__":
    main()
