"""Shortest paths: those of C++, bit for bit."""

from __future__ import annotations

import numpy as np
import pytest
import selvage
from selvage import Feature, PathStatus


def test_paths_are_those_of_the_program(rod, program, tmp_path):
    path = tmp_path / "rod.vtu"
    selvage.write_mesh(path, rod)
    rows = program("paths", path)["paths"]
    inside = selvage.shortest_paths(rod)
    assert len(inside) == len(rows) > 0
    names = {Feature.FACE: "face", Feature.EDGE: "edge", Feature.VERTEX: "vertex"}
    for i, row in enumerate(rows):
        assert inside.vertices[i] == row["query"] and inside.queries.elements[i] == row["element"]
        assert inside.paths.face[i] == row["face_id"] and inside.paths.distance[i] == row["distance"]
        assert inside.paths.point[i].tolist() == [row["sx"], row["sy"], row["sz"]]
        assert inside.paths.normal[i].tolist() == [row["nx"], row["ny"], row["nz"]]
        assert inside.paths.barycentric[i].tolist() == [row["b0"], row["b1"], row["b2"]]
        assert names[Feature(inside.paths.feature[i])] == row["feature"]


def test_updates_and_warm_starts_change_no_answer(rod):
    finder = selvage.BoundaryPathFinder(rod, rod.V)
    queries = finder.find_penetrating_vertices()
    face = None
    for step in range(5):
        V = rod.V * (1 + 0.01 * step)
        finder.update(V)
        queries = finder.find_penetrating_vertices()
        warm = face if face is not None and len(face) == len(queries) else None
        got = finder.find_paths(queries.points, queries.elements, sources=queries.sources, warm_start=warm)
        fresh = selvage.BoundaryPathFinder(rod, V)
        want = fresh.find_paths(queries.points, queries.elements, sources=queries.sources)
        for a, b in zip(got, want):
            assert np.array_equal(a, b, equal_nan=a.dtype.kind == "f")
        face = got.face


def test_many_queries_in_pieces_are_those_one_by_one(rod):
    finder = selvage.BoundaryPathFinder(rod)
    rng = np.random.default_rng(1)
    elements = rng.integers(0, len(rod.T), 40_000)
    weights = rng.dirichlet(np.ones(4), len(elements))
    points = np.einsum("ki,kid->kd", weights, rod.V[rod.T[elements]])
    shares: list[float] = []
    paths = finder.find_paths(points, elements, progress=shares.append)
    assert shares and shares[-1] == 1 and shares == sorted(shares)
    some = rng.choice(len(elements), 50, replace=False)
    for i in some:
        one = finder.find_paths(points[i : i + 1], elements[i : i + 1])
        assert one.face[0] == paths.face[i] and np.array_equal(one.distance, paths.distance[i : i + 1], equal_nan=True)


def test_points_at_edges_and_vertices(rod):
    finder = selvage.BoundaryPathFinder(rod)
    queries = finder.find_penetrating_vertices()
    v = queries.vertices[0]
    assert np.array_equal(queries.points[0], rod.V[v])
    with_source = finder.find_paths(queries.points[:1], queries.elements[:1], sources=[[v, -1]])
    assert v not in rod.boundary_faces[with_source.face[0]]
    edge = finder.find_paths(queries.points[:1], queries.elements[:1], sources=[[v, v + 1]])
    assert len(edge) == 1


def test_answers_that_are_none(rod):
    finder = selvage.BoundaryPathFinder(rod)
    paths = finder.find_paths([[1e3, 0, 0]], [0])
    assert paths.status[0] == PathStatus.NOT_IN_ELEMENT and not paths.found[0]
    assert paths.face[0] == -1 and np.isnan(paths.distance[0]) and np.isnan(paths.point).all()
    assert len(finder.find_paths(np.empty((0, 3)), np.empty(0, int))) == 0
    assert "0 found of 1" in repr(paths)


@pytest.mark.parametrize(
    ("arguments", "options", "said"),
    [
        (([[0, 0, 0]], [10**6]), {}, "element"),
        (([[0, 0, 0]], [0, 1]), {}, "elements: 2 for 1 points"),
        (([[0, 0, np.nan]], [0]), {}, "finite|NaN|nan"),
        (([[0, 0, 0]], [0]), {"sources": [[0, -1], [1, -1]]}, "sources: 2 for 1"),
        (([[0, 0, 0]], [0]), {"warm_start": [0, 1]}, "warm_start: 2 for 1"),
        (([[0, 0, 0]], [0.5]), {}, "elements: an array"),
        (([[0, 0]], [0]), {}, r"points: an array \(1, 2\)"),
    ],
)
def test_impossible_queries(rod, arguments, options, said):
    with pytest.raises(selvage.Error, match=said):
        selvage.BoundaryPathFinder(rod).find_paths(*arguments, **options)


def test_located_points(rod):
    finder = selvage.BoundaryPathFinder(rod)
    centre = rod.V[rod.T].mean(axis=1)
    located = finder.locate(centre)
    own = np.zeros(len(centre), bool)
    own[located.point[located.point == located.element]] = True
    assert own.all()
    assert np.array_equal(located.point, np.sort(located.point))


def test_options_are_keywords(rod):
    finder = selvage.BoundaryPathFinder(rod)
    with pytest.raises(TypeError):
        finder.find_paths([[0, 0, 0]], [0], [[0, -1]])
