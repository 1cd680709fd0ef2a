"""Arrays as arguments: what is used in place, converted, refused; and arrays as answers."""

from __future__ import annotations

import gc

import numpy as np
import pytest
import selvage


def test_float64_is_used_in_place(two):
    V, F = two
    mesh = selvage.TriangleMesh(V, F)
    assert mesh.V is V
    V[3:, 2] += 100
    finder = selvage.SelfCollisionFinder(mesh)
    assert not finder.has_pairs()
    V[3:, 2] -= 100
    finder.update()
    assert finder.has_pairs()


@pytest.mark.parametrize(
    "convert",
    [
        lambda V: V.astype(np.float32),
        lambda V: V.astype(np.float16),
        lambda V: V.astype(np.longdouble),
        lambda V: V.astype(np.int64),
        lambda V: V.astype(np.int8),
        lambda V: V.astype(">f8"),
        lambda V: np.asfortranarray(V),
        lambda V: np.repeat(V, 2, axis=0)[::2],
        lambda V: V[::-1].copy()[::-1],
        lambda V: np.hstack([V, V])[:, :3],
        lambda V: V.tolist(),
        lambda V: [tuple(row) for row in V],
        lambda V: memoryview(V),
        lambda V: np.frombuffer(b"x" + V.tobytes(), np.uint8)[1:].view(np.float64).reshape(V.shape),
    ],
)
def test_other_arrays_are_converted(two, convert):
    V, F = two
    given = convert(V)
    mesh = selvage.TriangleMesh(given, F)
    assert mesh.V.dtype == np.float64 and mesh.V.flags.c_contiguous
    assert np.array_equal(mesh.V, V)
    assert selvage.self_collisions(given, F).triangles.tolist() == [[0, 1]]


@pytest.mark.parametrize("dtype", [np.int8, np.uint8, np.int16, np.int32, np.uint32, np.int64, np.uint64, ">i4"])
def test_indices_of_any_whole_type(two, dtype):
    V, F = two
    assert len(selvage.self_collisions(V, F.astype(dtype))) == 1


def test_read_only_arrays_serve(two):
    V, F = two
    V.flags.writeable = F.flags.writeable = False
    mesh = selvage.TriangleMesh(V, F)
    assert mesh.V is V
    assert len(selvage.self_collisions(mesh)) == 1


@pytest.mark.parametrize(
    ("V", "said"),
    [
        (np.zeros((6, 2)), r"V: an array \(6, 2\) of float64 was given; expected numbers of shape \(n, 3\)"),
        (np.zeros(18), r"V: an array \(18,\) of float64"),
        (np.zeros((6, 3, 1)), r"V: an array \(6, 3, 1\)"),
        (np.zeros((6, 3), complex), r"V: an array \(6, 3\) of complex128"),
        (np.full((6, 3), "a"), r"V: an array \(6, 3\) of <U1"),
        (np.full((6, 3), None), r"V: an array \(6, 3\) of object"),
        (np.zeros((6, 3), bool), r"V: an array \(6, 3\) of bool"),
        ([[0, 0, 0], [1, 1]], "V: a list that is no array of numbers"),
        (None, "V: an array"),
        ("abc", "V: an array"),
        ({1: 2}, "V: an array"),
        (3.0, "V: an array"),
    ],
)
def test_refused_positions_say_what_was_expected(V, said):
    with pytest.raises(selvage.Error, match=said) as caught:
        selvage.TriangleMesh(V, [[0, 1, 2]])
    assert "expected numbers of shape (n, 3)" in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("F", "said"),
    [
        ([[0.0, 1.0, 2.0]], r"F: an array \(1, 3\) of float64 was given; expected whole numbers of shape \(n, 3\)"),
        ([[0, 1]], r"F: an array \(1, 2\)"),
        ([[0, 1, 2**40]], "F: 1099511627776 does not fit in int32"),
        ([[0, 1, -(2**40)]], "F: -1099511627776 does not fit"),
        ([[0, 1, 6]], "triangle 0"),
        ([[0, 1, -1]], "triangle 0"),
        ([[0, 1, 1]], "triangle 0"),
        ([], "no triangle"),
        (np.empty((0, 3), int), "no triangle"),
    ],
)
def test_refused_triangles(two, F, said):
    with pytest.raises(selvage.Error, match=said):
        selvage.TriangleMesh(two[0], F)


@pytest.mark.parametrize("bad", [np.nan, np.inf, -np.inf])
def test_positions_must_be_finite(two, bad):
    V, F = two
    V[4, 1] = bad
    with pytest.raises(selvage.Error, match="4"):
        selvage.self_collisions(V, F)
    with pytest.raises(selvage.Error, match="4"):
        selvage.free_step(V, V, F)


def test_huge_and_tiny_coordinates(two):
    V, F = two
    for scale in (1e-300, 1e-12, 1e12, 1e300):
        assert selvage.self_collisions(V * scale, F).triangles.tolist() == [[0, 1]]


def test_errors_are_value_errors():
    assert issubclass(selvage.Error, ValueError)
    assert issubclass(selvage.SystemError, selvage.Error) and issubclass(selvage.SystemError, OSError)
    assert selvage.Error.__module__ == "selvage"


def test_answers_own_their_memory(pipe):
    V = pipe.positions(pipe.frame_count - 1)
    finder = selvage.SelfCollisionFinder(selvage.TriangleMesh(V, pipe.F))
    pairs = finder.find_pairs()
    kept = pairs.triangles.copy()
    triangles = pairs.triangles
    assert triangles.flags.owndata and triangles.flags.writeable and triangles.flags.c_contiguous
    del finder, pairs
    gc.collect()
    junk = [np.full(kept.shape, 7, np.int32) for _ in range(100)]
    assert np.array_equal(triangles, kept) and len(junk) == 100
    triangles[:] = 0  # and may be written to


def test_the_mesh_outlives_its_name(rod):
    finder = selvage.BoundaryPathFinder(selvage.TetMesh(rod.V.copy(), rod.T))
    gc.collect()
    assert len(finder.find_penetrating_vertices()) > 0


def test_positions_outlive_the_mesh():
    V = selvage.TriangleMesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 2]]).V
    gc.collect()
    assert V.sum() == 2


def test_a_new_pose_must_fit(two):
    mesh = selvage.TriangleMesh(*two)
    with pytest.raises(selvage.Error, match="5 positions for 6 vertices"):
        mesh.V = np.zeros((5, 3))
    mesh.V = two[0] * 2
    assert mesh.V[1, 0] == 8
    finder = selvage.SelfCollisionFinder(mesh)
    with pytest.raises(selvage.Error):
        finder.update(np.zeros((7, 3)))
    assert finder.has_pairs()
