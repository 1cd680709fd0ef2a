"""Self-collision, discrete and continuous, proximity: those of C++, and of plain twins in NumPy."""

from __future__ import annotations

import itertools

import numpy as np
import pytest
import selvage
from selvage import TriangleContact


def last(pipe):
    return pipe.positions(pipe.frame_count - 1)


def test_pairs_are_those_of_the_program(pipe, program, tmp_path):
    path = tmp_path / "pipe.ply"
    selvage.write_mesh(path, last(pipe), pipe.F)
    for extra, adjacent in (((), False), (("--adjacent",), True)):
        answer = program("check", path, *extra, allowed=(0, 1))
        pairs = selvage.self_collisions(path, adjacent=adjacent)
        assert pairs.triangles.tolist() == answer["triangle_pairs"]
    assert len(pairs) > 0


def test_steps_are_those_of_the_program(pipe, program, tmp_path):
    V0, V1 = pipe.positions(0), last(pipe)
    selvage.write_mesh(tmp_path / "a.ply", V0, pipe.F)
    selvage.write_mesh(tmp_path / "b.ply", V1, pipe.F)
    answer = program("check", tmp_path / "a.ply", "--to", tmp_path / "b.ply", allowed=(0, 1))
    mesh = selvage.TriangleMesh(V0, pipe.F)
    pairs = selvage.continuous_collisions(V0, V1, pipe.F)
    assert pairs.vertex_face.tolist() == answer["vertex_face"]
    edges = np.hstack([mesh.edges[pairs.edge_edge[:, 0]], mesh.edges[pairs.edge_edge[:, 1]]])
    assert edges.tolist() == answer["edge_edge"] and len(pairs) > 0


@pytest.mark.parametrize("method", ["bvh", "normal-cone", "enhanced-dual-cone", "auto"])
def test_accurate_methods_agree(pipe, method):
    assert method in selvage.culling_methods()
    V = last(pipe)
    want = selvage.self_collisions(V, pipe.F)
    got = selvage.self_collisions(V, pipe.F, method=method)
    assert np.array_equal(got.triangles, want.triangles) and np.array_equal(got.contact, want.contact)
    V0 = pipe.positions(pipe.frame_count - 3)
    a, b = (selvage.continuous_collisions(V0, V, pipe.F, method=m) for m in (method, "auto"))
    assert np.array_equal(a.vertex_face, b.vertex_face) and np.array_equal(a.edge_edge, b.edge_edge)


def test_unknown_method(two):
    with pytest.raises(selvage.Error, match="no method 'magic'.*bvh"):
        selvage.self_collisions(*two, method="magic")


def test_kinds_of_contact():
    F = [[0, 1, 2], [3, 4, 5]]
    base = [[0, 0, 0], [4, 0, 0], [0, 4, 0]]
    crossing = selvage.self_collisions(base + [[1, 1, -1], [1, 1, 2], [2, 1, 2]], F)
    touching = selvage.self_collisions(base + [[1, 1, 0], [1, 1, 2], [2, 1, 2]], F)
    flat = selvage.self_collisions(base + [[1, 1, 0], [2, 1, 0], [1, 2, 0]], F)
    kinds = [TriangleContact(p.contact[0]) for p in (crossing, touching, flat)]
    assert kinds == [TriangleContact.CROSSING, TriangleContact.TOUCHING, TriangleContact.COPLANAR_OVERLAP]


def test_segments_lie_in_both_triangles(pipe):
    V = last(pipe)
    finder = selvage.SelfCollisionFinder(selvage.TriangleMesh(V, pipe.F))
    pairs = finder.find_pairs()
    segments = finder.find_segments(pairs.triangles)
    assert segments.shape == (len(pairs), 2, 3)
    for side in (0, 1):
        a, b, c = (V[pipe.F[pairs.triangles[:, side], i]] for i in range(3))
        normal = np.cross(b - a, c - a)
        normal /= np.linalg.norm(normal, axis=1)[:, None]
        off = np.einsum("kd,ked->ke", normal, segments - a[:, None])
        assert np.nanmax(np.abs(off)) < 1e-9


def test_pairs_of_some_triangles(pipe):
    finder = selvage.SelfCollisionFinder(selvage.TriangleMesh(last(pipe), pipe.F))
    pairs = finder.find_pairs().triangles
    some = np.unique(pairs[:3])
    want = pairs[np.isin(pairs, some).any(axis=1)]
    assert np.array_equal(finder.find_pairs_of(some).triangles, want)
    with pytest.raises(selvage.Error, match="twice"):
        finder.find_pairs_of([0, 0])
    with pytest.raises(selvage.Error, match="no such triangle"):
        finder.find_pairs_of([len(pipe.F)])


def test_pairs_of_two_surfaces(two):
    V, F = two
    one, other = (selvage.SelfCollisionFinder(selvage.TriangleMesh(V, F[i : i + 1])) for i in (0, 1))
    assert one.find_pairs_with(other).triangles.tolist() == [[0, 0]]


def test_filters(two):
    V, F = two

    def count(**filters):
        return len(selvage.self_collisions(V, F, filters=selvage.PairFilters(**filters)))

    assert count() == 1
    assert count(groups=[0, 0]) == 0 and count(groups=[0, 1]) == 1 and count(groups=[-1, -1]) == 1
    assert count(layers=[1, 2]) == 0 and count(layers=[1, 3]) == 1
    assert count(layers=[1, 2], seen_layers=[2, 1]) == 1
    assert count(static=[True, True]) == 0 and count(static=[True, False]) == 1
    assert count(forbidden_pairs=[[1, 0]]) == 0 and count(allowed_pairs=[[0, 1]]) == 1
    assert count(rest_positions=V, rest_distance=0.5) == 0
    with pytest.raises(selvage.Error, match="groups"):
        count(groups=[0])
    with pytest.raises(selvage.Error, match="selvage.PairFilters"):
        selvage.self_collisions(V, F, filters={"groups": [0, 0]})
    with pytest.raises(TypeError):
        selvage.PairFilters([0, 0])


def test_thickness(two):
    V, F = two
    V[3:, 2] += 1.25  # a quarter above the other
    assert not selvage.has_self_collisions(V, F)
    assert selvage.self_collisions(V, F, thickness=np.full(6, 0.13)).contact[0] == TriangleContact.DISJOINT
    assert len(selvage.self_collisions(V, F, thickness=np.full(6, 0.12))) == 0
    with pytest.raises(selvage.Error, match="thickness"):
        selvage.self_collisions(V, F, thickness=[0.1])


def impact(V0, V1, F):
    """The first of many instants at which two triangles meet: a plain twin of free_step."""
    for t in np.linspace(0, 1, 401):
        if selvage.has_self_collisions((1 - t) * V0 + t * V1, F):
            return t
    return 1.0


def test_free_step_is_the_first_impact():
    rng = np.random.default_rng(5)
    F = np.array([[0, 1, 2], [3, 4, 5]])
    met = 0
    for _ in range(60):
        V0 = rng.normal(size=(6, 3))
        V1 = V0 + rng.normal(size=(6, 3))
        if selvage.has_self_collisions(V0, F):
            continue
        step = selvage.free_step(V0, V1, F)
        first = impact(V0, V1, F)
        met += first < 1
        assert step <= first + 1e-12 and first - step < 1 / 200
        assert not selvage.has_self_collisions(V0 + 0.999 * step * (V1 - V0), F)
    assert met > 5


def test_impact_times(pipe):
    V0, V1 = pipe.positions(pipe.frame_count - 4), last(pipe)
    finder = selvage.ContinuousCollisionFinder(selvage.TriangleMesh(V0, pipe.F), V0, V1)
    pairs = finder.find_pairs()
    faces, edges = finder.find_impact_times(pairs)
    assert len(faces) == len(pairs.vertex_face) and len(edges) == len(pairs.edge_edge)
    times = np.concatenate([faces, edges])
    assert (times >= 0).all() and (times <= 1).all()
    assert finder.find_free_step() == finder.find_free_step(pairs) == times.min()
    assert finder.find_separated_step(pairs) == times.min()
    finder.update(V0, V0)
    assert finder.has_pairs() == (len(finder.find_pairs()) > 0)
    with pytest.raises(selvage.Error, match="face"):
        finder.find_impact_times(selvage.ContinuousPairs(np.array([[0, 10**6]]), np.empty((0, 2), int)))


def test_other_ends_of_some_vertices(pipe):
    V0, V1 = pipe.positions(pipe.frame_count - 4), last(pipe)
    mesh = selvage.TriangleMesh(V0, pipe.F)
    finder = selvage.ContinuousCollisionFinder(mesh, V0, V1)
    before = finder.find_pairs()
    moved = np.unique(before.vertex_face[:, 0])[:5]
    V1 = V1.copy()
    V1[moved] = V0[moved]
    found = finder.move_ends(moved, V1)
    expected = selvage.ContinuousCollisionFinder(mesh, V0, V1).find_pairs()
    has_moved = np.zeros(len(V0), bool)
    has_moved[moved] = True
    near = has_moved[expected.vertex_face[:, 0]] | has_moved[pipe.F[expected.vertex_face[:, 1]]].any(axis=1)
    assert len(expected) < len(before)
    assert np.array_equal(found.vertex_face, expected.vertex_face[near])
    assert np.array_equal(finder.find_pairs().edge_edge, expected.edge_edge)
    with pytest.raises(selvage.Error, match="vertex"):
        finder.move_ends([10**6], V1)


def test_methods_refuse_steps_of_other_sizes(two):
    V, F = two
    with pytest.raises(selvage.Error):
        selvage.continuous_collisions(V, V[:5], F)


def segment_distance(a, b):
    """Distance of two segments on a grid: never below the true one, by little above it."""
    s = np.linspace(0, 1, 60)[:, None]
    p, q = a[0] + s * (a[1] - a[0]), b[0] + s * (b[1] - b[0])
    return np.linalg.norm(p[:, None] - q[None], axis=2).min()


def test_near_pairs_miss_nothing():
    rng = np.random.default_rng(3)
    V = rng.normal(size=(15, 3))
    F = np.arange(15).reshape(5, 3)
    mesh = selvage.TriangleMesh(V, F)
    near = selvage.near_pairs(V, F, distance=0.7)
    found = {tuple(p): d for p, d in zip(near.edge_edge.tolist(), near.edge_edge_distance)}
    E = mesh.edges
    for a, b in itertools.combinations(range(len(E)), 2):
        if set(E[a]) & set(E[b]):
            continue
        distance = segment_distance(V[E[a]], V[E[b]])
        if distance < 0.7:
            assert found[a, b] <= distance + 1e-12
        if (a, b) in found:
            assert found[a, b] > distance - 0.15
    gap = np.linalg.norm(near.vertex_face_nearest[:, 0] - near.vertex_face_nearest[:, 1], axis=1)
    assert np.allclose(gap, near.vertex_face_distance)
    for (v, f), weights, points in zip(near.vertex_face, near.barycentric, near.vertex_face_nearest):
        assert v not in F[f] and np.allclose(weights @ V[F[f]], points[1]) and np.array_equal(points[0], V[v])
    finder = selvage.ProximityFinder(mesh, distance=0.7)
    finder.update(V * 100)
    assert len(finder.find_pairs()) < len(near)


@pytest.mark.parametrize("distance", [0, -1, np.nan, np.inf])
def test_impossible_distances(two, distance):
    with pytest.raises(selvage.Error, match="distance"):
        selvage.near_pairs(*two, distance=distance)


def test_closest_points_and_signs():
    mesh = selvage.make("torus", cell=0.1)
    surface = mesh.surface()
    rng = np.random.default_rng(2)
    P = rng.uniform(mesh.V.min(0) - 0.3, mesh.V.max(0) + 0.3, (300, 3))
    answer = selvage.signed_distance(P, mesh)
    closest = selvage.closest_points(P, surface.V, surface.F)
    assert np.array_equal(np.abs(answer.distance), closest.distance)
    assert np.array_equal(answer.point, closest.point)
    a, b, c = (surface.V[surface.F[closest.triangle, i]] for i in range(3))
    w = closest.barycentric
    assert np.allclose(w[:, :1] * a + w[:, 1:2] * b + w[:, 2:] * c, closest.point)
    to_vertices = np.linalg.norm(P[:, None] - surface.V[surface.F].mean(axis=1)[None], axis=2).min(axis=1)
    assert (closest.distance <= to_vertices).all()
    inside = np.isin(np.arange(len(P)), selvage.BoundaryPathFinder(mesh).locate(P).point)
    assert np.array_equal(answer.winding_number != 0, inside) and np.array_equal(answer.distance < 0, inside)


def test_signs_need_a_closed_surface(two):
    distance = selvage.SurfaceDistance(selvage.TriangleMesh(*two))
    assert not distance.is_closed
    with pytest.raises(selvage.Error, match="closed"):
        distance.find_signed_distances([[0, 0, 0]])
    assert distance.find_closest_points(np.empty((0, 3))).distance.shape == (0,)
