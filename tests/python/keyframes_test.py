"""Colliders that change their form by key frames."""

from __future__ import annotations

import json

import numpy as np
import pytest
import selvage

BALL = selvage.make("ball", radius=0.1, cell=0.06)
F = BALL.boundary_faces
POSITIONS = np.array([BALL.V, 1.5 * BALL.V, 1.2 * BALL.V]).astype(np.float32).astype(float)
TIMES = [0.0, 0.05, 0.2]
CLOTH = {
    "mesh": {"shape": "cloth", "size": [0.6, 0.6, 0], "cell": 0.1},
    "translate": [-0.3, -0.3, 0.12],
    "material": {"kind": "cloth", "density": 0.2},
}


def scene(keyframed, **more):
    collider = {"keyframed": keyframed, **more}
    return {"selvage_scene": 1, "frames": 6, "bodies": [CLOTH], "colliders": [collider]}


def growing() -> selvage.KeyframedShape:
    return selvage.KeyframedShape(F, TIMES, POSITIONS)


def test_holds_what_it_was_given():
    shape = growing()
    assert np.array_equal(shape.F, F) and np.array_equal(shape.times, TIMES)
    assert np.array_equal(shape.positions, POSITIONS) and shape.positions.flags.owndata is False
    shape.positions[:] = 0  # a copy
    assert np.array_equal(shape.positions, POSITIONS)
    assert repr(shape) == f"<selvage.KeyframedShape: {len(BALL.V)} vertices in 3 key frames>"
    single = selvage.KeyframedShape(F.tolist(), (1,), POSITIONS[:1].astype(np.float32))
    assert np.array_equal(single.at(-5).V, POSITIONS[0]) and np.array_equal(single.at(5).F, F)


def test_is_linear_between_key_frames_and_rests_outside():
    shape = growing()
    for time, expected in [(-1, POSITIONS[0]), (0, POSITIONS[0]), (0.2, POSITIONS[2]), (9, POSITIONS[2])]:
        assert np.array_equal(shape.at(time).V, expected)
    assert np.allclose(shape.at(0.0125).V, 0.75 * POSITIONS[0] + 0.25 * POSITIONS[1], rtol=0, atol=1e-15)


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ((F, [0, 1], POSITIONS), "times: 2 for 3 key frames"),
        ((F, [0, 1, 1], POSITIONS), "key frame 2 is not later"),
        ((F, [0, np.nan, 1], POSITIONS), "key frame 1 is not later"),
        ((F, [], []), "there is no key frame"),
        ((F, [0], None), "NoneType was given"),
        ((F, [0], POSITIONS[0]), "positions"),
        ((F, [0, 1], [POSITIONS[0], POSITIONS[1][:-1]]), "key frame 1 has"),
        ((F[:, :2], TIMES, POSITIONS), "F"),
        ((F, TIMES, POSITIONS.astype(str)), "positions"),
    ],
)
def test_refuses_in_one_line(arguments, words):
    with pytest.raises(selvage.Error, match=words) as caught:
        selvage.KeyframedShape(*arguments)
    assert "\n" not in str(caught.value)
    with pytest.raises(selvage.Error, match="finite"):
        growing().at(np.inf)


def test_what_is_no_solid_is_refused_with_its_place():
    for shape, words in [
        (selvage.KeyframedShape(F[1:], TIMES, POSITIONS), "closed surface"),
        (selvage.KeyframedShape(F[:, ::-1], TIMES, POSITIONS), "colliders.0..keyframed"),
        (selvage.KeyframedShape(F, TIMES, POSITIONS * [[[1]], [[1]], [[np.nan]]]), "sample 2 is not finite"),
    ]:
        with pytest.raises(selvage.Error, match=words):
            selvage.read_scene(scene(shape))


def test_a_scene_of_arrays_runs_as_one_of_files(tmp_path, program):
    selvage.write_mesh(tmp_path / "ball.ply", selvage.TriangleMesh(POSITIONS[0], F))
    selvage.write_point_cache(tmp_path / "ball.pc2", POSITIONS)
    files = {"mesh": str(tmp_path / "ball.ply"), "pc2": str(tmp_path / "ball.pc2"), "times": TIMES}
    (tmp_path / "scene.json").write_text(json.dumps(scene(files, static_friction=0.5)))
    program("simulate", tmp_path / "scene.json", "-o", tmp_path / "there")
    there = selvage.Run(tmp_path / "there")
    here = selvage.Simulation(scene(growing(), static_friction=np.float64(0.5)))
    while here.frame < 6:
        here.step_frame()
    assert np.array_equal(here.positions, there.checkpoint()[0])
    # The ball has lifted the cloth, which lay 2 cm above it.
    still = selvage.Simulation(scene(selvage.KeyframedShape(F, [0], POSITIONS[:1])))
    still.step(30)
    assert here.positions[:, 2].max() > still.positions[:, 2].max() + 0.01


def test_runs_of_arrays_are_resumed(tmp_path):
    selvage.simulate(scene(growing()), tmp_path / "run", frames=2)
    run = selvage.simulate(scene(growing()), tmp_path / "run", frames=4, resume=True)
    assert len(run) == 5 and run.report["first_frame"] == 2
    other = selvage.KeyframedShape(F, TIMES, 0.9 * POSITIONS)
    with pytest.raises(selvage.Error, match="scene"):
        selvage.simulate(scene(other), tmp_path / "run", frames=6, resume=True)


def test_meshes_in_changes_stand_beside_those_of_the_scene():
    coarse, coarser = (selvage.make("cloth", size=(0.6, 0.6, 0), cell=cell) for cell in (0.2, 0.3))
    bodies = [{**CLOTH, "mesh": coarse}, {**CLOTH, "translate": [-0.3, -0.3, 0.3]}]
    read = selvage.read_scene({**scene(growing()), "bodies": bodies}, changes={"/bodies/1/mesh": coarser})
    counts = [body["triangles"].stop - body["triangles"].start for body in read.bodies]
    assert counts == [len(coarse.F), len(coarser.F)] and counts[0] != counts[1]


def test_point_caches_come_back(tmp_path):
    file = tmp_path / "cache.pc2"
    selvage.write_point_cache(file, POSITIONS, first_frame=3, frames_per_sample=0.5)
    positions, first, step = selvage.read_point_cache(file)
    assert np.array_equal(positions, POSITIONS) and (first, step) == (3, 0.5)
    with pytest.raises(selvage.SystemError, match="cannot be written"):
        selvage.write_point_cache(tmp_path / "none" / "cache.pc2", POSITIONS)
    with pytest.raises(selvage.Error, match="cannot be read"):
        selvage.read_point_cache(tmp_path / "none.pc2")
    file.write_bytes(file.read_bytes()[:-1])
    with pytest.raises(selvage.Error, match="samples of"):
        selvage.read_point_cache(file)


def test_runs_show_it_in_pages_and_pictures(tmp_path):
    run = selvage.simulate(scene(growing()), tmp_path / "run", frames=3)
    run.view(tmp_path / "run.html")
    text = (tmp_path / "run.html").read_text()
    assert all(f'id="block-collider0pose{k}"' in text for k in range(4))
    run.render(tmp_path / "run.png", frames="last", size=(160, 120))
    assert (tmp_path / "run.png").stat().st_size > 1000
