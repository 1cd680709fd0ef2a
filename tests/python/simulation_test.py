"""Simulations step by step, scenes as dicts and files, folders of runs."""

from __future__ import annotations

import gc
import weakref

import numpy as np
import pytest
import selvage

BOX = {"shape": "box", "size": [0.2, 0.2, 0.2], "cell": 0.1}


def falling(**more):
    return {
        "selvage_scene": 1,
        "frames": 4,
        "bodies": [{"mesh": BOX, "translate": [0, 0, 0.05]}, {"mesh": BOX, "translate": [0.05, 0.02, 0.27]}],
        "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}],
        **more,
    }


def test_steps_are_those_of_a_run(tmp_path):
    run = selvage.simulate(falling(), tmp_path / "run", frames=8)
    simulation = selvage.Simulation(falling())
    while simulation.frame < 8:
        simulation.step_frame()
    positions, velocities, time = run.checkpoint()
    assert np.array_equal(simulation.positions, positions) and np.array_equal(simulation.velocities, velocities)
    assert simulation.time == time and simulation.steps == 40
    assert np.array_equal(run.frame(-1), positions.astype(np.float32).astype(float))


def test_contact_from_a_later_frame(tmp_path):
    scene = falling(contact={"from_frame": 3})
    run = selvage.simulate(scene, tmp_path / "run", frames=6)
    simulation = selvage.Simulation(scene)
    simulation.step(30)
    assert np.array_equal(simulation.positions, run.checkpoint()[0])


def test_runs_are_those_of_the_program(tmp_path, program):
    import json

    (tmp_path / "scene.json").write_text(json.dumps(falling()))
    program("simulate", tmp_path / "scene.json", "-o", tmp_path / "there")
    here = selvage.simulate(tmp_path / "scene.json", tmp_path / "here")
    there = selvage.Run(tmp_path / "there")
    assert len(here) == len(there) == 5
    assert all(np.array_equal(a, b) for a, b in zip(here, there))
    assert np.array_equal(here.T, there.T) and np.array_equal(here.boundary_faces, there.boundary_faces)
    assert here.report["outcome"] == "finished" and here.summary["frames"] == there.summary["frames"]
    names = set(here.statistics)
    assert {"frame", "time", "kinetic_energy"} <= names
    assert np.array_equal(here.statistics["kinetic_energy"], there.statistics["kinetic_energy"])


def test_runs_are_resumed(tmp_path):
    whole = selvage.simulate(falling(), tmp_path / "whole")
    calls = []

    def stop(row):
        calls.append(row["frame"])
        if row["frame"] == 2:
            raise InterruptedError("enough")

    with pytest.raises(InterruptedError, match="enough"):
        selvage.simulate(falling(), tmp_path / "part", progress=stop)
    assert calls == [0, 1, 2]
    with pytest.raises(selvage.Error, match="resume"):
        selvage.simulate(falling(), tmp_path / "part")
    part = selvage.simulate(falling(), tmp_path / "part", resume=True)
    assert part.report["first_frame"] == 2 and part.report["fingerprint"] == whole.report["fingerprint"]


def test_the_folder_of_a_run(tmp_path):
    run = selvage.simulate(falling(), tmp_path / "run", vtu=True, surface="ply")
    assert len(run) == 5 and run[0].shape == run[-1].shape
    assert (run.folder / "frames.pvd").exists()
    assert np.array_equal(run.mesh(2).T, run.T) and np.array_equal(run.surface(2).F, run.boundary_faces)
    assert set(run.vertex_bodies) == {0, 1}
    with pytest.raises(selvage.Error):
        run.frame(99)
    with pytest.raises(IndexError):
        run[99]
    with pytest.raises(selvage.Error):
        selvage.Run(tmp_path / "nothing")
    with pytest.raises(selvage.Error, match="surface"):
        selvage.simulate(falling(), tmp_path / "other", surface="stl")


def test_state_is_read_and_written():
    simulation = selvage.Simulation(falling())
    positions = simulation.positions
    simulation.step()
    assert simulation.positions is positions
    start = positions.copy()
    simulation.velocities[:] = [0, 0, 3]
    simulation.step(2)
    assert positions[:, 2].mean() > start[:, 2].mean()
    simulation.positions = start
    assert np.array_equal(simulation.positions, start)
    assert simulation.mesh.V is simulation.positions
    with pytest.raises(selvage.Error, match="3 rows for 54"):
        simulation.positions = start[:3]
    with pytest.raises(selvage.Error, match="forces"):
        simulation.step(forces=start[:3])


def test_forces_lift():
    scene = selvage.read_scene(falling(bodies=[{"mesh": BOX}], colliders=[]))
    simulation = selvage.Simulation(scene)
    lift = 2 * 9.81 / scene.inverse_masses[:, None] * [0, 0, 1]
    simulation.step(100, forces=lift)
    assert np.allclose(simulation.velocities[:, 2], 9.81 * simulation.time, rtol=1e-6)
    assert simulation.statistics()["constraints"] > 0


def test_a_failed_step_changes_nothing():
    simulation = selvage.Simulation(falling())
    simulation.step(3)
    simulation.velocities[5] = np.nan
    before = simulation.positions.copy()
    with pytest.raises(selvage.Error, match="stops being finite"):
        simulation.step()
    assert np.array_equal(simulation.positions, before) and simulation.steps == 3
    simulation.velocities[5] = 0
    simulation.step()


def test_contacts_of_bodies():
    simulation = selvage.Simulation(falling())
    seen = 0
    for _ in range(60):
        simulation.step()
        seen += len(simulation.contacts())
    assert seen > 0
    assert not selvage.has_self_collisions(simulation.mesh)


def test_a_constraint_of_the_user():
    calls = []

    def hold(positions, inverse_masses, iteration):
        calls.append(iteration)
        positions[:3] = start[:3]

    simulation = selvage.Simulation(falling(colliders=[]))
    start = simulation.positions.copy()
    simulation.set_constraint(hold)
    simulation.step(50)
    assert np.allclose(simulation.positions[:3], start[:3], atol=1e-9)
    assert calls[:3] == [0, 1, 2] and len(calls) == 150
    simulation.set_constraint(None)
    simulation.step(50)
    assert simulation.positions[0, 2] < start[0, 2] - 0.01 and len(calls) == 150


def test_what_a_constraint_raises_comes_out():
    def refuse(positions, inverse_masses, iteration):
        raise LookupError("no")

    simulation = selvage.Simulation(falling())
    simulation.set_constraint(refuse)
    with pytest.raises(LookupError, match="no"):
        simulation.step()
    assert simulation.steps == 0


def test_simulations_are_collected():
    simulation = selvage.Simulation(falling())

    class Constraint:
        def __init__(self, owner):
            self.owner = owner

        def __call__(self, *_):
            pass

    constraint = Constraint(simulation)
    gone = weakref.ref(constraint)
    simulation.set_constraint(constraint)
    del simulation, constraint
    gc.collect()
    assert gone() is None


def test_scenes_with_meshes_and_arrays(tmp_path):
    mesh = selvage.make("box", size=(0.2, 0.2, 0.2), cell=0.1)
    scene = selvage.read_scene(
        {
            "selvage_scene": 1,
            "gravity": np.array([0, 0, -1.62]),
            "bodies": [{"mesh": mesh, "translate": np.array([0, 0, 1.0]), "material": {"density": np.float64(500)}}],
        }
    )
    assert np.array_equal(scene.rest_positions, mesh.V + [0, 0, 1])
    assert np.array_equal(scene.mesh.T, mesh.T)
    assert np.isclose((1 / scene.inverse_masses).sum(), 500 * 0.008)
    assert scene.bodies[0]["vertices"] == slice(0, 27)
    simulation = selvage.Simulation(scene)
    simulation.step(10)
    assert np.allclose(simulation.velocities[:, 2], -1.62 * simulation.time)


@pytest.mark.parametrize(
    ("scene", "said"),
    [
        ({}, "selvage_scene"),
        ({"selvage_scene": 1}, "bodies"),
        ({"selvage_scene": 1, "bodies": [{"mesh": BOX, "material": {"poisson_ratio": 0.7}}]}, r"bodies\[0\].*poisson"),
        ({"selvage_scene": 1, "bodies": [{"mesh": object()}]}, "object"),
        ({"selvage_scene": 1, "bodies": [{"mesh": {"file": "nowhere.msh"}}]}, "nowhere.msh"),
    ],
)
def test_impossible_scenes(scene, said):
    with pytest.raises(selvage.Error, match=said):
        selvage.read_scene(scene)


@pytest.mark.parametrize("solver", ["newton", "vbd"])
def test_implicit_solvers_step_as_they_run(solver, tmp_path):
    run = selvage.simulate(falling(solver=solver), tmp_path / "run", frames=3)
    simulation = selvage.Simulation(falling(solver=solver))
    assert simulation.scene.solver == solver
    while simulation.frame < 3:
        simulation.step_frame()
    assert np.array_equal(simulation.positions, run.checkpoint()[0])
    assert np.array_equal(simulation.velocities, run.checkpoint()[1])
    assert simulation.statistics()["newton_steps"] > 0
    with pytest.raises(selvage.Error, match="constraint: the scene's solver is not xpbd"):
        simulation.set_constraint(lambda *_: None)
    simulation.set_constraint(None)


def test_values_are_changed_as_by_the_program(tmp_path, program):
    import json

    (tmp_path / "scene.json").write_text(json.dumps(falling()))
    program(
        "simulate", tmp_path / "scene.json", "-o", tmp_path / "there", "--no-report",
        "--set", "/bodies/0/mesh/cell=0.05", "--set", "/gravity=[0, 0, -3]", "--check-every", 2,
    )  # fmt: skip
    changes = {"/bodies/0/mesh/cell": 0.05, "/gravity": np.array([0, 0, -3]).tolist()}
    scene = selvage.read_scene(tmp_path / "scene.json", changes=changes)
    of_dict = selvage.read_scene(falling(), changes={**changes, "/gravity": np.array([0, 0, -3])})
    assert np.array_equal(scene.rest_positions, of_dict.rest_positions)
    checked = []
    here = selvage.simulate(
        scene, tmp_path / "here", check_every=2, on_check=lambda frame, found: checked.append((frame, found["crosses"]))
    )
    there = selvage.Run(tmp_path / "there")
    assert all(np.array_equal(a, b) for a, b in zip(here, there))
    assert np.array_equal(here.rest, there.rest) and here.rest.shape == here.frame(0).shape
    assert [frame for frame, _ in checked] == [0, 2, 4]
    for frame, crosses in checked:
        assert json.loads((there.folder / f"checks/frame_{frame:06}.json").read_text())["crosses"] == crosses
    with pytest.raises(selvage.Error, match="nowhere: is not known"):
        selvage.read_scene(falling(), changes={"/nowhere": 1})


def test_a_report_has_every_column(tmp_path):
    inside = falling(bodies=[{"mesh": BOX}, {"mesh": BOX, "translate": [0.1, 0.05, 0.05]}], contact={"mode": "none"})
    run = selvage.simulate(inside, tmp_path / "run", frames=2)
    assert run.report is not None
    for name, column in run.statistics.items():
        assert np.array_equal(column, [row[name] for row in run.report["frames"]]) or name.startswith("seconds"), name
    told, wrote = run.report["at_end"], run.summary["at_end"]
    assert told["crosses"] and len(told["body_pairs"]) == len(wrote["body_pairs"]) == 1
    for name in ("triangle_pairs", "vertices", "deepest_vertex", "edges", "deepest_edge"):
        assert told["body_pairs"][0][name] == wrote["body_pairs"][0][name]
    assert told["body_pairs"][0]["bodies"] == (0, 1) and run.report["guaranteed_from"] is None


def test_runs_go_to_other_programs(tmp_path):
    run = selvage.simulate(falling(), tmp_path / "run")
    run.export(tmp_path / "a.pc2", every=2)
    shown = np.unique(run.boundary_faces)
    points = np.fromfile(tmp_path / "a.pc2", "<f4", offset=32).reshape(3, len(shown), 3)
    assert np.array_equal(points[1], run.frame(2)[shown].astype(np.float32)) and (tmp_path / "a.obj").exists()
    run.view(tmp_path / "a.html")
    run.render(tmp_path / "a.png", frames="last", size=(160, 120), edges=True, fit_each=False)
    assert (tmp_path / "a.png").read_bytes()[1:4] == b"PNG" and (tmp_path / "a.html").stat().st_size > 1000
    with pytest.raises(selvage.Error, match="a.abc"):
        run.export(tmp_path / "a.abc")


def test_bodies_sleep_and_wake():
    scene = {
        "selvage_scene": 1, "sleep_speed": 0.2,
        "bodies": [{"mesh": BOX}, {"mesh": BOX, "translate": [1, 0, 0]}],
        "colliders": [{"plane": {"point": [0, 0, 0], "normal": [0, 0, 1]}}],
    }  # fmt: skip
    simulation = selvage.Simulation(scene)
    assert simulation.rest_times.tolist() == [0, 0]
    simulation.step(400)
    assert simulation.statistics()["sleeping_bodies"] == 2 and (simulation.rest_times >= 0.5).all()
    simulation.wake()
    assert simulation.rest_times.tolist() == [0, 0]
    simulation.step(1)
    assert simulation.statistics()["sleeping_bodies"] == 0
    simulation.step(400)
    assert simulation.statistics()["sleeping_bodies"] == 2
    simulation.positions[0, 0] += 1e-3
    simulation.step(1)
    assert simulation.statistics()["sleeping_bodies"] == 0


def test_scales_and_files(tmp_path):
    import json

    scene = falling(scales={"small": {"/bodies/0/mesh/cell": 0.2}})
    (tmp_path / "s.json").write_text(json.dumps(scene))
    assert len(selvage.read_scene(tmp_path / "s.json", scale="small").mesh.T) < len(selvage.read_scene(scene).mesh.T)
    with pytest.raises(selvage.Error, match="large"):
        selvage.read_scene(scene, scale="large")
