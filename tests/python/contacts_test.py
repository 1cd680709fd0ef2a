"""Contacts of a step, untangling, geometry that a solver of one's own needs."""

from __future__ import annotations

import numpy as np
import pytest
import selvage
from selvage import ContactKind


@pytest.fixture
def boxes():
    box = selvage.make("box", size=(1, 1, 1), cell=0.5)
    V = np.vstack([box.V, box.V + [0.2, 0.3, 1.05]])
    return selvage.TetMesh(V, np.vstack([box.T, box.T + len(box.V)])), len(box.V)


def test_contacts_are_inequalities(boxes):
    mesh, n = boxes
    V1 = mesh.V.copy()
    V1[n:, 2] -= 0.1
    finder = selvage.ContactFinder(mesh)
    with pytest.raises(selvage.Error, match="begin"):
        finder.find_contacts(V1)
    finder.begin_step(mesh.V)
    assert len(finder.penetrating_vertices) == 0
    contacts = finder.find_contacts(V1)
    assert len(contacts) > 0 and "vertex-face" in repr(contacts)
    assert set(contacts.kind) <= {ContactKind.VERTEX_FACE, ContactKind.EDGE_EDGE}
    used = np.arange(7) < contacts.vertex_count[:, None]
    assert (contacts.vertices[~used] == -1).all() and (contacts.weights[~used] == 0).all()
    assert np.allclose(contacts.weights.sum(axis=1), 0)
    assert np.allclose(np.where(contacts.weights > 0, contacts.weights, 0).sum(axis=1), 1)
    assert np.allclose(np.linalg.norm(contacts.normal, axis=1), 1)
    assert np.isclose(contacts.gaps(V1).min(), -0.05)
    assert (contacts.gaps(mesh.V) > 0).all()
    assert np.allclose(contacts.time, 0.5, atol=1e-5)


def test_penetrations_by_dcd(boxes):
    mesh, n = boxes
    V = mesh.V.copy()
    V[n:, 2] -= 0.2
    finder = selvage.ContactFinder(mesh, V, mode="dcd")
    finder.begin_step(V)
    contacts = finder.find_contacts(V)
    assert ContactKind.VERTEX_PATH in contacts.kind and (contacts.gaps(V) < 0).all()
    hybrid = selvage.ContactFinder(mesh, V)
    hybrid.begin_step(V)
    assert len(hybrid.penetrating_vertices) > 0


def test_points_take_turns_where_many_are_inside():
    box = selvage.make("box", size=(1, 1, 1), cell=0.2)
    V = np.vstack([box.V, box.V + [0.31, 0.22, 0.13]])
    mesh = selvage.TetMesh(V, np.vstack([box.T, box.T + len(box.V)]))

    def count(step, **options):
        finder = selvage.ContactFinder(mesh, **options)
        finder.begin_step(V, step)
        return len(finder.find_contacts(V))

    assert count(0) == count(1)
    some = [count(step, take_turns=True) for step in range(4)]
    assert max(some) < count(0) / 2
    assert some[0] == some[3] and len(set(some)) > 1


def test_edges_in_their_own_piece_rest_in_some_steps():
    mesh = selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1)
    finder = selvage.ContactFinder(mesh, mode="dcd")
    kinds = {}
    for step in (0, 55, 56, 63, 64):
        finder.begin_step(mesh.V, step)
        kinds[step] = set(finder.find_contacts(mesh.V).kind)
    assert {step for step in kinds if ContactKind.EDGE_PATH not in kinds[step]} == {56, 63}
    assert all(ContactKind.VERTEX_PATH in kinds[step] for step in kinds)


@pytest.mark.parametrize(
    ("options", "said"),
    [
        ({"mode": "sometimes"}, "mode: there is no 'sometimes'"),
        ({"rule": "luck"}, "rule: there is no 'luck'"),
        ({"rule": "rest-pose"}, "rest"),
        ({"objects": [0]}, "object"),
    ],
)
def test_impossible_options(boxes, options, said):
    with pytest.raises(selvage.Error, match=said):
        selvage.ContactFinder(boxes[0], **options)


def test_untangling(tmp_path, program):
    mesh = selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1)
    rows = []
    free = selvage.resolve(mesh.V, mesh.T, progress=rows.append)
    assert free.is_free and free.outcome == "resolved"
    assert not selvage.has_self_collisions(free.V, mesh.T)
    assert len(rows) == len(free.report["iterations"]) and rows[0]["triangle_pairs"] > 0
    assert free.report["moved_vertices"] == (np.abs(free.V - mesh.V).max(axis=1) > 0).sum()
    selvage.write_mesh(tmp_path / "tangled.vtu", mesh)
    program("resolve", tmp_path / "tangled.vtu", "-o", tmp_path / "free.vtu")
    assert np.array_equal(selvage.read_mesh(tmp_path / "free.vtu").V, free.V)


def test_untangling_holds_what_is_pinned():
    mesh = selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1)
    held = selvage.resolve(mesh, pinned=np.arange(len(mesh.V)))
    assert held.outcome == "held" and np.array_equal(held.V, mesh.V)
    with pytest.raises(selvage.Error):
        selvage.resolve(mesh, pinned=[10**6])


def test_what_progress_raises_comes_out():
    def refuse(row):
        raise KeyError("enough")

    mesh = selvage.make("rod", cell=0.1, pose="self-crossing", crossings=1)
    with pytest.raises(KeyError, match="enough"):
        selvage.resolve(mesh, progress=refuse)
