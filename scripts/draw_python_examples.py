#!/usr/bin/env python3
"""Draws docs/images/python/: the examples of examples/python are run, and what they made is drawn by the program.

    PYTHONPATH=build/release/python build/venv/bin/python scripts/draw_python_examples.py
"""

import os
import runpy
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

import numpy as np
import selvage
from selvage._program import PROGRAM

ROOT = Path(__file__).resolve().parents[1]
PICTURES = ROOT / "docs" / "images" / "python"
SIZE = ("--size", "480", "320")


def program(*words: object, allowed: tuple[int, ...] = (0,)) -> None:
    done = subprocess.run([PROGRAM, *map(str, words), "--quiet"], capture_output=True, text=True, check=False)
    if done.returncode not in allowed:
        raise SystemExit(done.stderr)


def check_mesh(made: dict[str, Any]) -> None:
    selvage.write_mesh("mesh.ply", made["mesh"])
    program("check", "mesh.ply", "--json", "pairs.json", allowed=(1,))
    program("render", "pairs.json", "-o", PICTURES / "check_mesh.png", *SIZE)


def shortest_paths(made: dict[str, Any]) -> None:
    selvage.picture(made["mesh"], file=PICTURES / "shortest_paths.png", size=(480, 320))


def untangle(made: dict[str, Any]) -> None:
    selvage.write_mesh("both.vtu", made["mesh"])
    program("render", "both.vtu", "-o", PICTURES / "untangle_before.png", *SIZE)
    selvage.write_mesh("both.vtu", made["free"].V, made["mesh"].T)
    program("render", "both.vtu", "-o", PICTURES / "untangle_after.png", *SIZE)


def own_xpbd(made: dict[str, Any]) -> None:
    selvage.write_mesh("boxes.vtu", made["x"], made["mesh"].T)
    program("render", "boxes.vtu", "-o", PICTURES / "own_xpbd.png", "--edges", *SIZE)


def from_ipctk(made: dict[str, Any]) -> None:
    selvage.write_mesh("sheets.ply", made["V"], made["F"])
    program("render", "sheets.ply", "-o", PICTURES / "from_ipctk.png", "--edges", *SIZE)


def sweep_dask(_: dict[str, Any]) -> None:
    subprocess.run([sys.executable, ROOT / "examples" / "python" / "sweep_dask.py"], check=True, capture_output=True)
    for folder in sorted(Path("sweep").iterdir(), key=lambda path: float(path.name)):
        selvage.Run(folder).render(PICTURES / f"sweep_{folder.name}.png", size=(320, 240), camera="front", edges=True)


def main() -> None:
    PICTURES.mkdir(exist_ok=True)
    for draw in (check_mesh, shortest_paths, untangle, own_xpbd, from_ipctk, sweep_dask):
        with tempfile.TemporaryDirectory() as folder:
            os.chdir(folder)
            draw(runpy.run_path(str(ROOT / "examples" / "python" / f"{draw.__name__}.py"), run_name="example"))
            os.chdir(ROOT)
    assert np.all([path.stat().st_size > 500 for path in PICTURES.glob("*.png")])


if __name__ == "__main__":
    main()
