"""What a call from Python costs over the same call in C++: tiny questions, whose work is next to nothing, and a large
check, which build/benchmark/benchmarks/selvage_microbench repeats in C++. See README.md."""

from __future__ import annotations

import json
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
import selvage

MICROBENCH = Path(__file__).parents[2] / "build/benchmark/benchmarks/selvage_microbench"


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
    times, pairs = [], 0
    for _ in range(9):
        start = time.perf_counter()
        large = selvage.SelfCollisionFinder(selvage.TriangleMesh(V, pipe.F), asked_once=True)
        pairs = len(large.find_pairs())
        times.append(time.perf_counter() - start)
    print(f"check of {len(pipe.F)} triangles with the topology, {pairs} pairs: {1e3 * min(times):.1f} ms, the least of 9")
    if MICROBENCH.exists():
        command = [MICROBENCH, "--benchmark_filter=self_collision/check_once", "--benchmark_format=json"]
        answer = json.loads(subprocess.run(command, check=True, capture_output=True).stdout)
        least = next(row for row in answer["benchmarks"] if row["aggregate_name"] == "min")
        print(f"the same in C++:                   {least['real_time']:.1f} ms")
    else:
        print("the same in C++: `make bench` builds it")


if __name__ == "__main__":
    main()
