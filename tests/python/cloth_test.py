"""Cloth in scenes, simulations, runs and contacts."""

from __future__ import annotations

import json

import numpy as np
import pytest
import selvage

CLOTH = {"kind": "cloth", "density": 0.2, "stiffness": 300, "thickness": 0.002}


def draped(mesh=None):
    cloth = {"shape": "cloth", "size": [0.6, 0.6, 0], "cell": 0.1} if mesh is None else mesh
    return {
        "selvage_scene": 1,
        "frames": 6,
        "bodies": [
            {
                "mesh": {"shape": "ball", "radius": 0.2, "cell": 0.1},
                "translate": [0.3, 0.3, -0.21],
                "pinned": [{"plane": {"point": [0, 0, -1], "normal": [0, 0, 1]}}],
            },
            {"mesh": cloth, "material": CLOTH},
        ],
    }


def test_cloth_steps_as_it_runs(tmp_path, program):
    (tmp_path / "scene.json").write_text(json.dumps(draped()))
    program("simulate", tmp_path / "scene.json", "-o", tmp_path / "there", "--no-report")
    there = selvage.Run(tmp_path / "there")
    simulation = selvage.Simulation(draped())
    while simulation.frame < 6:
        simulation.step_frame()
    assert np.array_equal(simulation.positions, there.checkpoint()[0])
    assert np.array_equal(simulation.velocities, there.checkpoint()[1])
    assert np.array_equal(simulation.surface.F, there.boundary_faces)
    assert simulation.surface.V is simulation.positions
    contacts = simulation.contacts()
    assert len(contacts) > 0 and contacts.distance.max() == 0.001


def test_bodies_of_both_kinds():
    scene = selvage.read_scene(draped())
    ball, cloth = scene.bodies
    assert not ball["is_cloth"] and cloth["is_cloth"]
    assert cloth["triangles"] == slice(0, len(scene.triangles)) and ball["triangles"] == slice(0, 0)
    assert cloth["elements"].stop - cloth["elements"].start == 0
    assert scene.triangles.min() == cloth["vertices"].start and scene.triangles.max() < cloth["vertices"].stop
    assert np.array_equal(scene.surface.F[-len(scene.triangles) :], scene.triangles)
    assert np.array_equal(scene.surface.F[: -len(scene.triangles)], scene.mesh.boundary_faces)
    assert np.isclose((1 / scene.inverse_masses[cloth["vertices"]]).sum(), 0.2 * 0.36)
    assert "triangles of cloth" in repr(scene)


def test_a_mesh_object_is_cloth():
    mesh = selvage.make("cloth", size=(0.6, 0.6, 0), cell=0.1)
    given, named = selvage.read_scene(draped(mesh)), selvage.read_scene(draped())
    assert np.array_equal(given.rest_positions, named.rest_positions)
    assert np.array_equal(given.triangles, named.triangles)


def test_cloth_alone(tmp_path):
    scene = draped()
    del scene["bodies"][0]
    run = selvage.simulate(scene, tmp_path / "run", frames=2)
    assert len(run.T) == 0 and np.array_equal(run.surface(2).F, run.boundary_faces)
    simulation = selvage.Simulation(scene)
    simulation.step_frame()
    assert len(simulation.mesh.T) == 0 and len(simulation.surface.F) == len(run.boundary_faces)
    with pytest.raises(selvage.Error):
        run.mesh()
    assert run._repr_png_()[1:4] == b"PNG"
    assert np.array_equal(run.frame(1), simulation.positions.astype(np.float32).astype(float))


def test_contacts_of_cloth():
    box = selvage.make("box", size=(1, 1, 1), cell=0.5)
    sheet = np.array([[0.2, 0.2, 1.1], [0.8, 0.2, 1.1], [0.2, 0.8, 1.1]])
    V0 = np.vstack([box.V, sheet])
    F = [[len(box.V), len(box.V) + 1, len(box.V) + 2]]
    thickness = np.r_[np.zeros(len(box.V)), [0.02, 0.02, 0.02]]
    mesh = selvage.TetMesh(V0, box.T)
    V1 = V0.copy()
    V1[-3:, 2] -= 0.3
    finder = selvage.ContactFinder(mesh, cloth=F)
    finder.begin_step(V0)
    contacts = finder.find_contacts(V1)
    assert len(contacts) >= 3 and (contacts.distance == 0).all()
    assert np.isclose(contacts.gaps(V1).min(), -0.2)
    near = V0.copy()
    near[-3:, 2] -= 0.095
    thick = selvage.ContactFinder(mesh, near, cloth=F, thickness=thickness, rest=V0)
    thick.begin_step(near)
    assert thick.find_contacts(near).distance.max() == 0.01
    with pytest.raises(selvage.Error):
        selvage.ContactFinder(mesh, cloth=[[0, 1, 2]])
