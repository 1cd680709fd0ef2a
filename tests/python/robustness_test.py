"""Threads at once, steady memory, Ctrl-C, progress, and hostile input."""

from __future__ import annotations

import concurrent.futures
import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time
import weakref

import numpy as np
import pytest
import selvage
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp


def resident() -> int:
    """[bytes]"""
    with open("/proc/self/statm") as file:
        return int(file.read().split()[1]) * os.sysconf("SC_PAGE_SIZE")


def test_memory_is_steady(two, rod):
    V, F = two
    finder = selvage.BoundaryPathFinder(rod)
    queries = finder.find_penetrating_vertices()
    points, elements = queries.points[:8], queries.elements[:8]

    def call():
        selvage.self_collisions(V.astype(np.float32), F)
        selvage.closest_points(V, V, F)
        finder.find_paths(points, elements)
        with pytest.raises(selvage.Error):
            selvage.self_collisions(V[:, :2], F)

    for _ in range(500):
        call()
    gc.collect()
    before = resident()
    for _ in range(2500):  # four calls each
        call()
    gc.collect()
    assert resident() - before < 4e6


def test_threads_call_at_once(pipe):
    V = pipe.positions(pipe.frame_count - 1)
    mesh = selvage.TriangleMesh(V, pipe.F)
    finder = selvage.SelfCollisionFinder(mesh)
    want = finder.find_pairs().triangles

    def ask(i):
        if i % 2:
            return finder.find_pairs().triangles
        return selvage.SelfCollisionFinder(mesh, progress=lambda share: None).find_pairs().triangles

    with concurrent.futures.ThreadPoolExecutor(8) as pool:
        assert all(np.array_equal(got, want) for got in pool.map(ask, range(64)))


def test_other_threads_run_meanwhile():
    mesh = selvage.make("torus", cell=0.03)
    ticks = 0
    stop = threading.Event()

    def tick():
        nonlocal ticks
        while not stop.is_set():
            ticks += 1
            time.sleep(0.0005)

    thread = threading.Thread(target=tick)
    thread.start()
    P = np.random.default_rng(0).normal(size=(60_000, 3))
    ticks = 0
    selvage.signed_distance(P, mesh)
    during = ticks
    stop.set()
    thread.join()
    assert during > 5


def test_numbers_of_threads_change_nothing(pipe, rod):
    V = pipe.positions(pipe.frame_count - 1)
    want = selvage.self_collisions(V, pipe.F)
    ways = selvage.shortest_paths(rod).paths
    for count in (1, 2, 3):
        with selvage.threads(count):
            assert np.array_equal(selvage.self_collisions(V, pipe.F).triangles, want.triangles)
            assert np.array_equal(selvage.shortest_paths(rod).paths.distance, ways.distance)
    with pytest.raises(selvage.Error, match="threads: 0"):
        selvage.threads(0)


def interrupted(code: str, *, after: float = 0.2) -> tuple[float, str]:
    """Seconds from Ctrl-C to the end of a program, and what it said."""
    program = "import signal, selvage, numpy as np\nsignal.signal(signal.SIGINT, signal.default_int_handler)\n"
    program += textwrap.dedent(code)
    process = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    assert process.stdout.readline() == "ready\n"
    time.sleep(after)
    assert process.poll() is None, "the work was too short to be stopped"
    start = time.monotonic()
    process.send_signal(signal.SIGINT)
    try:
        errors = process.communicate(timeout=30)[1]
    finally:
        process.kill()
    return time.monotonic() - start, errors


@pytest.mark.parametrize(
    "code",
    [
        """
        n = 300000
        rng = np.random.default_rng(0)
        V = np.repeat(rng.normal(size=(n, 3)), 3, axis=0) + 0.2 * rng.normal(size=(3 * n, 3))
        finder = selvage.SelfCollisionFinder(selvage.TriangleMesh(V, np.arange(3 * n).reshape(n, 3)))
        print("ready", flush=True)
        finder.find_pairs()
        """,
        """
        n = 60000
        rng = np.random.default_rng(0)
        V = np.repeat(rng.normal(size=(n, 3)), 3, axis=0) + 0.1 * rng.normal(size=(3 * n, 3))
        mesh = selvage.TriangleMesh(V, np.arange(3 * n).reshape(n, 3))
        finder = selvage.ContinuousCollisionFinder(mesh, V, V + 0.2 * rng.normal(size=V.shape))
        print("ready", flush=True)
        finder.find_pairs()
        """,
        """
        n = 120000
        rng = np.random.default_rng(0)
        V = np.repeat(rng.normal(size=(n, 3)), 3, axis=0) + 0.05 * rng.normal(size=(3 * n, 3))
        finder = selvage.ProximityFinder(selvage.TriangleMesh(V, np.arange(3 * n).reshape(n, 3)), distance=0.05)
        print("ready", flush=True)
        finder.find_pairs()
        """,
        """
        mesh = selvage.make("torus", cell=0.05)
        P = np.random.default_rng(0).normal(size=(4 * 10**6, 3))
        print("ready", flush=True)
        selvage.signed_distance(P, mesh)
        """,
        """
        scene = {"selvage_scene": 1, "bodies": [{"mesh": {"shape": "torus", "cell": 0.05}}]}
        simulation = selvage.Simulation(scene)
        print("ready", flush=True)
        simulation.step(10**6)
        """,
        """
        import tempfile
        scene = {"selvage_scene": 1, "bodies": [{"mesh": {"shape": "torus", "cell": 0.05}}], "substeps": 1000}
        print("ready", flush=True)
        selvage.simulate(scene, tempfile.mkdtemp())
        """,
        """
        mesh = selvage.make("nested-knot", pose="overlap")
        print("ready", flush=True)
        selvage.resolve(mesh)
        """,
    ],
    ids=["pairs", "step", "near", "distance", "simulation", "run", "resolve"],
)
def test_ctrl_c_stops_long_work(code):
    seconds, errors = interrupted(code)
    assert "KeyboardInterrupt" in errors
    assert seconds < 5  # a second on a quiet machine, with the end of the interpreter


def test_progress_is_reported(pipe):
    shares: list[float] = []
    mesh = selvage.TriangleMesh(pipe.positions(0), pipe.F)
    finder = selvage.SelfCollisionFinder(mesh, progress=shares.append)
    finder.find_pairs()
    assert shares and shares == sorted(shares) and shares[-1] == 1


def test_what_progress_raises_comes_out_and_the_finder_serves_again(pipe):
    V = pipe.positions(pipe.frame_count - 1)

    def refuse(share):
        if refusing:
            raise RuntimeError("enough")

    refusing = True
    finder = selvage.SelfCollisionFinder(selvage.TriangleMesh(V, pipe.F), progress=refuse)
    with pytest.raises(RuntimeError, match="enough"):
        finder.find_pairs()
    refusing = False
    assert np.array_equal(finder.find_pairs().triangles, selvage.self_collisions(V, pipe.F).triangles)


def test_finders_with_progress_are_collected(two):
    class Progress:
        owner: object = None

        def __call__(self, share):
            pass

    for make in (
        lambda mesh, p: selvage.SelfCollisionFinder(mesh, progress=p),
        lambda mesh, p: selvage.ContinuousCollisionFinder(mesh, mesh.V, mesh.V, progress=p),
        lambda mesh, p: selvage.ProximityFinder(mesh, distance=1, progress=p),
    ):
        progress = Progress()
        gone = weakref.ref(progress)
        progress.owner = make(selvage.TriangleMesh(*two), progress)
        del progress
        gc.collect()
        assert gone() is None


quick = settings(max_examples=150, deadline=None, suppress_health_check=list(HealthCheck))
anything = st.one_of(
    st.none(), st.booleans(), st.integers(), st.floats(), st.text(max_size=4), st.binary(max_size=64),
    st.lists(st.one_of(st.floats(), st.lists(st.floats(), max_size=4)), max_size=5),
    hnp.arrays(
        st.one_of(hnp.scalar_dtypes(), hnp.unicode_string_dtypes(max_len=2)),
        hnp.array_shapes(min_dims=0, max_dims=3, min_side=0, max_side=4),
    ),
)  # fmt: skip


@quick
@given(V=anything, F=anything)
def test_anything_is_answered_or_refused(V, F):
    try:
        mesh = selvage.TriangleMesh(V, F)
        selvage.self_collisions(mesh)
        selvage.closest_points(V, mesh)
    except selvage.Error as error:
        assert str(error) and "\n" not in str(error)


@quick
@given(
    V=hnp.arrays(np.float64, st.tuples(st.integers(3, 8), st.just(3))),
    F=hnp.arrays(np.int32, st.tuples(st.integers(1, 6), st.just(3)), elements=st.integers(-1, 8)),
)
def test_any_surface_is_answered_or_refused(V, F):
    try:
        pairs = selvage.self_collisions(V, F, adjacent=True)
        assert (pairs.triangles[:, 0] < pairs.triangles[:, 1]).all()
        assert np.array_equal(pairs.triangles, selvage.self_collisions(V, F, adjacent=True, method="bvh").triangles)
        assert 0 <= selvage.free_step(V, V[::-1].copy(), F) <= 1
    except selvage.Error as error:
        assert str(error) and "\n" not in str(error)


@quick
@given(
    V=hnp.arrays(np.float64, st.tuples(st.integers(4, 8), st.just(3)), elements=st.floats(-1e3, 1e3)),
    T=hnp.arrays(np.int64, st.tuples(st.integers(1, 4), st.just(4)), elements=st.integers(-1, 8)),
    points=hnp.arrays(np.float64, st.tuples(st.integers(0, 3), st.just(3))),
)
def test_any_solid_is_answered_or_refused(V, T, points):
    try:
        finder = selvage.BoundaryPathFinder(selvage.TetMesh(V, T))
        located = finder.locate(points)
        paths = finder.find_paths(points[located.point], located.element)
        assert (paths.distance[paths.found] >= 0).all()
        selvage.shortest_paths(V, T)
    except selvage.Error as error:
        assert str(error) and "\n" not in str(error)
