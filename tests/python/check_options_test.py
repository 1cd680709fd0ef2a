"""What `selvage check` and `selvage resolve` can be asked, asked from Python: the same answers, bit for bit."""

from __future__ import annotations

import numpy as np
import pytest
import selvage


@pytest.fixture(scope="module")
def two_files(tmp_path_factory):
    """A ball and a rod that runs through it, as files of surfaces."""
    folder = tmp_path_factory.mktemp("two")
    ball = selvage.make("ball", radius=0.5, cell=0.15).surface()
    rod = selvage.make("rod", radius=0.1, cell=0.1).surface()
    for name, mesh in (("ball.ply", ball), ("rod.ply", rod)):
        selvage.write_mesh(folder / name, mesh)
    return folder / "ball.ply", folder / "rod.ply"


def test_against_another_mesh(two_files, program):
    ball, rod = two_files
    answer = program("check", ball, "--against", rod, "--segments", allowed=(1,))
    pairs = selvage.collisions_between(ball, rod)
    assert pairs.triangles.tolist() == answer["triangle_pairs"] and len(pairs) > 0
    finders = [selvage.SelfCollisionFinder(selvage.read_mesh(path)) for path in two_files]
    segments = finders[0].find_segments_with(finders[1], pairs.triangles)
    assert segments.tolist() == answer["segments"]
    mesh, objects = selvage.join(ball, rod)
    joined = selvage.self_collisions(mesh, filters=selvage.PairFilters(groups=objects))
    assert (joined.triangles - [0, (objects == 0).sum()]).tolist() == answer["triangle_pairs"]


def test_what_is_near_another_mesh(two_files, program):
    ball, rod = two_files
    answer = program("check", ball, "--against", rod, "--thickness", 0.03, allowed=(1,))
    mesh, objects = selvage.join(ball, rod)
    near = selvage.near_pairs(mesh, distance=0.03, filters=selvage.PairFilters(groups=objects))
    of_first = near.vertex_face[:, 0] < len(selvage.read_mesh(ball).V)
    assert near.vertex_face_distance[of_first].tolist() == answer["vertex_face_distances"]
    assert near.vertex_face_distance[~of_first].tolist() == answer["face_vertex_distances"]
    assert near.edge_edge_distance.tolist() == answer["edge_edge_distances"] and len(near) > 0


def test_thickness_between_two_meshes():
    box = selvage.make("box", size=(1, 1, 1), cell=0.5)
    above = selvage.TetMesh(box.V + [0, 0, 1.05], box.T)
    assert len(selvage.collisions_between(box, above)) == 0
    near = selvage.collisions_between(box, above, thickness=0.06)
    assert len(near) > 0 and (near.contact == selvage.TriangleContact.DISJOINT).all()
    assert len(selvage.collisions_between(box, above, thickness=0.04)) == 0
    with pytest.raises(selvage.Error, match="thickness"):
        selvage.collisions_between(box, above, thickness=-1)


def test_rings_and_thickness(pipe, program, tmp_path):
    path = tmp_path / "pipe.ply"
    V = pipe.positions(pipe.frame_count - 1)
    selvage.write_mesh(path, V, pipe.F)
    distance = float(np.linalg.norm(V[pipe.F[:, 0]] - V[pipe.F[:, 1]], axis=1).mean())
    answer = program("check", path, "--thickness", distance, "--rings", 3, allowed=(1,))
    filters = selvage.PairFilters(neighbour_rings=3)
    near = selvage.near_pairs(path, distance=distance, filters=filters)
    assert near.vertex_face.tolist() == answer["vertex_face"]
    assert near.vertex_face_distance.tolist() == answer["vertex_face_distances"] and len(near) > 0
    assert selvage.self_collisions(path, filters=filters).triangles.tolist() == answer["triangle_pairs"]


def test_groups(two_files, program, tmp_path):
    mesh, objects = selvage.join(*two_files)
    path = tmp_path / "both.obj"
    lines = [f"v {x!r} {y!r} {z!r}" for x, y, z in mesh.V.tolist()]
    for number, name in enumerate(("ball", "rod")):
        lines += [f"o {name}", *(f"f {a + 1} {b + 1} {c + 1}" for a, b, c in mesh.F[objects == number].tolist())]
    path.write_text("\n".join(lines) + "\n")
    groups, names = selvage.read_groups(path)
    assert names == ["ball", "rod"] and np.array_equal(groups, objects)
    assert np.array_equal(selvage.read_mesh(path).pieces, objects)
    for how, given in (("names", groups), ("pieces", mesh.pieces)):
        answer = program("check", path, "--groups", how, allowed=(1,))
        pairs = selvage.self_collisions(path, filters=selvage.PairFilters(groups=given))
        assert pairs.triangles.tolist() == answer["triangle_pairs"] and len(pairs) > 0
    no_groups, none = selvage.read_groups(two_files[0])
    assert len(no_groups) == 0 and none == []


def test_welding(program, tmp_path):
    rod = selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1).surface()
    path = tmp_path / "rod.stl"
    selvage.write_mesh(path, rod)
    raw, welded = selvage.read_mesh(path), selvage.read_mesh(path, weld=True)
    assert len(raw.edges) > len(welded.edges) and len(welded.edges) == len(rod.edges)
    answer = program("check", path, "--weld", allowed=(1,))
    assert selvage.self_collisions(welded).triangles.tolist() == answer["triangle_pairs"]
    flat, numbers = selvage.TriangleMesh(raw.V, np.vstack([[[0, 0 + 1, 2]], raw.F])).weld()
    assert len(flat.F) == len(raw.F) + 1 and np.array_equal(numbers, np.arange(len(raw.F) + 1))
    V = [[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 0], [0, 0, 0], [1, 0, 0]]
    kept, numbers = selvage.TriangleMesh(V, [[3, 4, 5], [0, 1, 2]]).weld()
    assert numbers.tolist() == [1] and kept.F.tolist() == [[0, 1, 2]]
    selvage.write_mesh(tmp_path / "ball.vtu", selvage.make("ball", cell=0.4))
    with pytest.raises(selvage.Error, match="weld"):
        selvage.read_mesh(tmp_path / "ball.vtu", weld=True)


def test_join_refuses_nothing():
    with pytest.raises(selvage.Error, match="none was given"):
        selvage.join()


def test_rebuilt_finders_answer_alike(pipe):
    first, last = pipe.positions(0), pipe.positions(pipe.frame_count - 1)
    mesh = selvage.TriangleMesh(first, pipe.F)
    finder = selvage.SelfCollisionFinder(mesh)
    finder.rebuild(last)
    assert np.array_equal(finder.find_pairs().triangles, selvage.self_collisions(last, pipe.F).triangles)
    step = selvage.ContinuousCollisionFinder(mesh, first, first)
    step.rebuild(first, last)
    assert np.array_equal(step.find_pairs().edge_edge, selvage.continuous_collisions(first, last, pipe.F).edge_edge)
    near = selvage.ProximityFinder(mesh, distance=0.01)
    near.rebuild(last)
    assert np.array_equal(near.find_pairs().vertex_face, selvage.near_pairs(last, pipe.F, distance=0.01).vertex_face)


def test_questions_about_a_few_points(pipe):
    V0, V1 = pipe.positions(pipe.frame_count - 3), pipe.positions(pipe.frame_count - 1)
    pairs = selvage.self_collisions(V1, pipe.F)
    a, b = (V1[pipe.F[pairs.triangles[:, i]]] for i in (0, 1))
    assert np.array_equal(selvage.triangle_contacts(a, b), pairs.contact) and len(pairs) > 0
    finder = selvage.ContinuousCollisionFinder(selvage.TriangleMesh(V0, pipe.F), V0, V1)
    meeting = finder.find_pairs()
    faces, edges = finder.find_impact_times(meeting)
    rows = np.hstack([meeting.vertex_face[:, :1], pipe.F[meeting.vertex_face[:, 1]]])
    assert np.array_equal(selvage.impact_times(V0[rows], V1[rows]), faces) and len(faces) > 0
    ends = selvage.TriangleMesh(V0, pipe.F).edges
    rows = np.hstack([ends[meeting.edge_edge[:, 0]], ends[meeting.edge_edge[:, 1]]])
    assert np.array_equal(selvage.impact_times(V0[rows], V1[rows], kind="edge-edge"), edges) and len(edges) > 0
    assert (selvage.impact_times(V0[rows], V1[rows], kind="edge-edge", distance=1e-4) <= edges).all()
    assert np.isnan(selvage.impact_times(V0[rows], V0[rows] + 1, kind="edge-edge")).all()


@pytest.mark.parametrize("ask", [
    lambda: selvage.impact_times(np.zeros((1, 3, 3)), np.zeros((1, 3, 3))),
    lambda: selvage.impact_times(np.zeros((1, 4, 3)), np.zeros((2, 4, 3))),
    lambda: selvage.impact_times(np.zeros((1, 4, 3)), np.zeros((1, 4, 3)), kind="face"),
    lambda: selvage.impact_times(np.zeros((1, 4, 3)), np.zeros((1, 4, 3)), distance=-1.0),
    lambda: selvage.triangle_contacts(np.zeros((1, 3, 3)), np.zeros((2, 3, 3))),
    lambda: selvage.orient2d([[0, 0]], [[0, 0], [1, 1]], [[0, 0]]),
    lambda: selvage.orient3d([[0, 0, 0]], [[0, 0]], [[0, 0, 0]], [[0, 0, 0]]),
])  # fmt: skip
def test_impossible_points(ask):
    with pytest.raises(selvage.Error):
        ask()


def test_resolve_keeps_the_pose(program, tmp_path):
    options = {"length": 4, "radius": 0.2, "cell": 0.1}
    rest = selvage.make("rod", **options)
    tangled = selvage.make("rod", pose="self-crossing", crossings=1, **options)
    selvage.write_mesh(tmp_path / "rest.vtu", rest)
    selvage.write_mesh(tmp_path / "tangled.vtu", tangled)
    for words, keep in (((), True), (("--to-rest",), False)):
        told = program(
            "resolve", tmp_path / "tangled.vtu", "--rest", tmp_path / "rest.vtu", *words,
            "--iterations", 40, "-o", tmp_path / "free.vtu", allowed=(0, 3),
        )  # fmt: skip
        free = selvage.resolve(tangled, rest=rest.V, keep_pose=keep, max_iterations=40)
        assert len(free.report["iterations"]) == len(told["iterations"])
        assert free.report["max_displacement"] == told["displacement"]["max"]
        if free.is_free:
            assert np.array_equal(free.V, selvage.read_mesh(tmp_path / "free.vtu").V)
    assert free.report["volume_at_rest"] > 0 and free.report["elastic_energy_before"] > 0


def test_poses_of_a_mesh_of_ones_own():
    straight = selvage.make("rod", cell=0.1)
    made = selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1)
    posed = selvage.pose(straight, "self-crossing", crossings=1)
    assert np.array_equal(posed.V, made.V) and np.array_equal(posed.T, made.T)
    with pytest.raises(selvage.Error, match="cell"):
        selvage.pose(straight, "twist", cell=0.1)
    assert len(selvage.make("gear", teeth=9, cell=0.1).T) > 0


def test_colours_and_fields(pipe, tmp_path):
    meshio = pytest.importorskip("meshio")
    V = pipe.positions(pipe.frame_count - 1)
    hit = selvage.self_collisions(V, pipe.F).mark(len(pipe.F))
    field = np.arange(3.0 * len(V)).reshape(-1, 3)
    selvage.write_vtu(tmp_path / "a.vtu", V, pipe.F, cell_fields={"hit": hit}, point_fields={"field": field})
    read = meshio.read(tmp_path / "a.vtu")
    assert np.array_equal(read.points, V) and np.array_equal(read.cells_dict["triangle"], pipe.F)
    assert np.array_equal(read.cell_data["hit"][0].ravel(), hit) and np.array_equal(read.point_data["field"], field)
    of_vertices, of_triangles = np.full((len(V), 3), 200), np.where(hit[:, None], [213, 94, 0], [200, 200, 200])
    path = tmp_path / "a.ply"
    selvage.write_coloured_ply(path, V, pipe.F, vertex_colours=of_vertices, triangle_colours=of_triangles)
    assert np.array_equal(selvage.read_mesh(path).F, pipe.F) and b"red" in path.read_bytes()[:400]
    rows = np.frombuffer(path.read_bytes().split(b"end_header\n", 1)[1], np.uint8)[-16 * len(pipe.F) :].reshape(-1, 16)
    assert np.array_equal(rows[:, -3:], of_triangles)
    with pytest.raises(selvage.Error, match="hit: a field"):
        selvage.write_vtu(tmp_path / "b.vtu", V, pipe.F, cell_fields={"hit": hit[1:]})
    for wrong in (of_triangles[1:], of_triangles + 100, of_triangles / 255):
        with pytest.raises(selvage.Error):
            selvage.write_coloured_ply(path, V, pipe.F, vertex_colours=of_vertices, triangle_colours=wrong)
