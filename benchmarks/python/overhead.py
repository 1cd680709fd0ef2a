"""What a call from Python costs over the same call in C++: tiny questions, whose work is next to nothing, and a large
check, whose C++ time the program prints. See README.md."""

from __future__ import annotations

import json
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import selvage
from selvage._program import PROGRAM


def microseconds(work: Callable[[], object], count: int = 20_000) -> float:
    """Of one call: the least of five rounds."""
    best = np.inf
    for _ in range(5):
        start = time.perf_counter()
        for _ in range(count):
            work()
        best = min(best, (time.perf_counter() - start) / count)
    return best * 1e6


def main() -> None:
    """Prints both."""
    V = np.array([[0, 0, 0], [4, 0, 0], [0, 4, 0], [1, 1, 3], [1, 1, 5], [2, 1, 5.0]])
    mesh = selvage.TriangleMesh(V, [[0, 1, 2], [3, 4, 5]])
    finder, distance = selvage.SelfCollisionFinder(mesh), selvage.SurfaceDistance(mesh)
    P = np.array([[0.2, 0.3, 1.0]])
    print(f"has_pairs() of two triangles:      {microseconds(finder.has_pairs):6.2f} us")
    print(f"find_pairs():                      {microseconds(finder.find_pairs):6.2f} us")
    print(f"update(V):                         {microseconds(lambda: finder.update(V)):6.2f} us")
    print(f"find_closest_points(one point):    {microseconds(lambda: distance.find_closest_points(P)):6.2f} us")

    pipe = selvage.SurfaceSequence("pipe", triangles=1_000_000)
    V = pipe.positions(pipe.frame_count - 1)
    seconds = []
    for _ in range(5):
        start = time.perf_counter()
        large = selvage.SelfCollisionFinder(selvage.TriangleMesh(V, pipe.F), asked_once=True)
        pairs = large.find_pairs()
        seconds.append(time.perf_counter() - start)
    print(f"check of {len(pipe.F)} triangles: {min(seconds):.3f} s with the topology, {len(pairs)} pairs")
    with tempfile.TemporaryDirectory() as folder:
        path, answer = Path(folder) / "pipe.ply", Path(folder) / "answer.json"
        selvage.write_mesh(path, V, pipe.F)
        subprocess.run([PROGRAM, "check", path, "-q", "--json", answer], check=False)
        print("the program, C++ alone:", json.loads(answer.read_text())["seconds"])


if __name__ == "__main__":
    main()
