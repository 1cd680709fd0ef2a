"""Meshes from arrays, files, shapes and other packages."""

from __future__ import annotations

import numpy as np
import pytest
import selvage


def test_topology_of_a_solid(rod, program, tmp_path):
    path = tmp_path / "rod.msh"
    selvage.write_mesh(path, rod)
    assert len(rod.boundary_faces) == len(rod.boundary_elements)
    owners = rod.T[rod.boundary_elements]
    assert all(set(face) <= set(tet) for face, tet in zip(rod.boundary_faces.tolist(), owners.tolist()))
    surface = rod.surface()
    assert np.array_equal(surface.F, rod.boundary_faces) and surface.V is rod.V and surface.is_oriented
    assert np.array_equal(np.unique(rod.boundary_faces), rod.boundary_vertices)
    assert rod.components.max() == 0
    assert len(rod.edges) == len({tuple(e) for e in rod.edges.tolist()})
    assert (rod.neighbours < 0).sum() == len(rod.boundary_faces)
    assert np.array_equal(selvage.boundary_faces(rod.T), rod.boundary_faces)


def test_outward_faces(rod):
    a, b, c = (rod.V[rod.boundary_faces[:, i]] for i in range(3))
    p = rod.V[rod.T]
    volume = np.linalg.det(p[:, 1:] - p[:, :1]).sum() / 6
    assert np.isclose(np.einsum("ij,ij->", np.cross(a, b), c) / 6, volume)


@pytest.mark.parametrize("name", ["m.msh", "m.mesh", "m.vtu", "m.vtk", "m.t", "m.node"])
@pytest.mark.parametrize("encoding", ["usual", "ascii"])
def test_solids_survive_files(rod, tmp_path, name, encoding):
    selvage.write_mesh(tmp_path / name, rod.V, rod.T, encoding=encoding)
    read = selvage.read_mesh(tmp_path / name)
    assert isinstance(read, selvage.TetMesh)
    assert np.array_equal(read.V, rod.V) and np.array_equal(read.T, rod.T)


@pytest.mark.parametrize("name", ["m.obj", "m.ply", "m.off"])
def test_surfaces_survive_files(pipe, tmp_path, name):
    V = pipe.positions(0)
    selvage.write_mesh(str(tmp_path / name), V, pipe.F)
    read = selvage.read_mesh(str(tmp_path / name))
    assert isinstance(read, selvage.TriangleMesh)
    assert np.array_equal(read.V, V) and np.array_equal(read.F, pipe.F)


def test_files_that_cannot_be(tmp_path, rod):
    with pytest.raises(selvage.Error, match="nothing.msh"):
        selvage.read_mesh(tmp_path / "nothing.msh")
    (tmp_path / "bad.off").write_text("OFF\n1 1 0\n0 0\n")
    with pytest.raises(selvage.Error, match=r"bad.off:"):
        selvage.read_mesh(tmp_path / "bad.off")
    with pytest.raises(selvage.Error, match="xyz"):
        selvage.write_mesh(tmp_path / "a.xyz", rod)
    with pytest.raises(selvage.Error, match="encoding"):
        selvage.write_mesh(tmp_path / "a.msh", rod, encoding="utf-8")
    with pytest.raises(selvage.SystemError):
        selvage.write_mesh(tmp_path / "none" / "a.msh", rod)
    assert sorted(p.name for p in tmp_path.iterdir()) == ["bad.off"]


def test_every_shape_and_pose():
    for shape in selvage.shape_names():
        assert len(selvage.make(shape).V) > 0
    assert set(selvage.pose_names()) >= {"twist", "bend", "swirl"}
    assert isinstance(selvage.make("cloth"), selvage.TriangleMesh)
    assert isinstance(selvage.make("sleeve"), selvage.TriangleMesh)
    assert selvage.make("box", size=[1, 2, 3], cell=1).V.max(axis=0).tolist() == [1, 2, 3]


def test_an_axis_by_letter_or_number(rod):
    for number, letter in enumerate("xyz"):
        turned = selvage.pose(rod, "twist", axis=letter, turns=0.1, crossings=0)
        assert (turned.V == selvage.pose(rod, "twist", axis=number, turns=0.1, crossings=0).V).all()
        assert (turned.V[:, number] == rod.V[:, number]).all()


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"shape": "cube"}, "cube"),
        ({"shape": "ball", "length": 2}, "length"),
        ({"shape": "ball", "colour": 2}, "colour"),
        ({"shape": "ball", "turns": 2}, "turns"),
        ({"shape": "ball", "cell": "fine"}, "cell"),
        ({"shape": "ball", "cell": -1}, "cell|must"),
        ({"shape": "box", "size": [1, 2]}, "size"),
        ({"shape": "beam", "pose": "curl"}, "curl"),
        ({"shape": "beam", "pose": "bend", "axis": "w"}, "use x, y or z"),
        ({"shape": "beam", "pose": "bend", "axis": "xy"}, "use x, y or z"),
    ],
)
def test_impossible_shapes(options, said):
    with pytest.raises(selvage.Error, match=said):
        selvage.make(**options)


def test_planar_meshes():
    mesh = selvage.PlanarMesh([[0, 0], [4, 0], [0, 4], [4, 4]], [[0, 1, 2], [1, 3, 2]])
    finder = selvage.PlanarPathFinder(mesh)
    paths = finder.find_paths([[1, 0.5], [3.5, 2]], [0, 1])
    assert np.allclose(paths.distance, [0.5, 0.5]) and paths.found.all()
    assert finder.locate([[2, 2], [9, 9]]).element.tolist() == [0, 1]
    assert finder.defects["inverted_elements"] == 0


def test_what_holds_a_mesh(rod, tmp_path):
    assert selvage.as_mesh(rod) is rod
    with pytest.raises(selvage.Error, match="dict"):
        selvage.as_mesh({})
    with pytest.raises(selvage.Error, match="3 arguments"):
        selvage.as_mesh(1, 2, 3)
    with pytest.raises(selvage.Error, match=r"\(2, 5\)"):
        selvage.as_mesh(np.zeros((3, 3)), np.zeros((2, 5), int))
    with pytest.raises(selvage.Error, match="surface"):
        selvage.shortest_paths(rod.surface())


def test_pictures(rod, tmp_path):
    png = selvage.picture(rod, file=tmp_path / "rod.png", view=(1, 0, 1), size=(160, 100))
    assert png.startswith(b"\x89PNG") and (tmp_path / "rod.png").read_bytes() == png
    assert rod._repr_png_().startswith(b"\x89PNG")
    with pytest.raises(selvage.Error, match="picture-size|size"):
        selvage.picture(rod, size=(1, 1))
    with pytest.raises(selvage.SystemError, match="none"):
        selvage.picture(rod, file=tmp_path / "none" / "rod.png", size=(160, 100))


def test_trimesh(rod):
    trimesh = pytest.importorskip("trimesh")
    there = selvage.to_trimesh(rod)
    assert isinstance(there, trimesh.Trimesh)
    back = selvage.as_mesh(there)
    assert np.array_equal(back.V, rod.V) and np.array_equal(back.F, rod.boundary_faces)


def test_meshio(rod):
    meshio = pytest.importorskip("meshio")
    there = selvage.to_meshio(rod)
    assert isinstance(there, meshio.Mesh)
    back = selvage.as_mesh(there)
    assert np.array_equal(back.V, rod.V) and np.array_equal(back.T, rod.T)
    surface = selvage.as_mesh(selvage.to_meshio(rod.surface()))
    assert np.array_equal(surface.F, rod.boundary_faces)


def test_pyvista(rod):
    pytest.importorskip("pyvista")
    back = selvage.as_mesh(selvage.to_pyvista(rod))
    assert np.array_equal(back.V, rod.V) and np.array_equal(back.T, rod.T)
    surface = selvage.as_mesh(selvage.to_pyvista(rod.surface()))
    assert np.array_equal(surface.V, rod.V) and np.array_equal(surface.F, rod.boundary_faces)
