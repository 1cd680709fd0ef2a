# blender -b --factory-startup --python read_in_blender.py -- RUN EXPORTED: reads an exported run in Blender and compares the
# vertices of each frame with the floats of the frame's file; exits with 0 where they are equal.
import glob
import pathlib
import sys

import bpy
import numpy as np

run, exported = (pathlib.Path(word) for word in sys.argv[sys.argv.index("--") + 1 :])
kind = exported.suffix
tolerance = 1e-6 if kind == ".glb" else 0  # of glTF: the first frame and a difference, rounded


def fail(what):
    print("FAILED:", what)
    sys.exit(1)


vertices, elements = np.fromfile(run / "topology.bin", "<i8", count=2, offset=16)
faces = np.fromfile(run / "topology.bin", "<i4", offset=int(64 + 16 * elements + 4 * vertices))
shown = np.unique(faces)
frames = [np.fromfile(name, "<f4", offset=64).reshape(-1, 3)[shown] for name in sorted(glob.glob(str(run / "frames/*.bin")))]

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.context.scene.render.fps = 60
if kind == ".usda":
    if not hasattr(bpy.ops.wm, "usd_import") or not bpy.app.build_options.usd:
        print("SKIPPED: this Blender reads no USD")
        sys.exit(77)
    bpy.ops.wm.usd_import(filepath=str(exported))
elif kind == ".glb":
    # The importer of Blender 3.4 uses a name that NumPy 1.24, which Debian 12 has beside it, no longer knows.
    np.bool = bool
    bpy.ops.import_scene.gltf(filepath=str(exported), merge_vertices=False)
else:
    bpy.ops.wm.obj_import(filepath=str(exported.with_suffix(".obj")), forward_axis="Y", up_axis="Z")
meshes = [item for item in bpy.context.scene.objects if item.type == "MESH"]
if len(meshes) != 1:
    fail(f"{len(meshes)} meshes")
item = meshes[0]
if kind == ".pc2":
    cache = item.modifiers.new("cache", "MESH_CACHE")
    cache.cache_format = "PC2"
    cache.filepath = str(exported)
    cache.frame_start = 0

for number, expected in enumerate(frames):
    # glTF is read at 60 frames a second from frame 0 on, like the others.
    bpy.context.scene.frame_set(number)
    evaluated = item.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    found = np.empty(3 * len(evaluated.vertices), np.float32)
    evaluated.vertices.foreach_get("co", found)
    found = found.reshape(-1, 3)
    if found.shape != expected.shape:
        fail(f"frame {number}: {found.shape[0]} vertices, expected {expected.shape[0]}")
    if kind == ".glb":  # Blender turns y upwards to z upwards, and the node turns z upwards to y
        found = (np.array(item.matrix_world)[:3, :3] @ found.T).T.astype(np.float32)
    worst = np.abs(found - expected).max()
    if not worst <= tolerance * max(1, np.abs(expected).max()):
        fail(f"frame {number}: a coordinate differs by {worst}")
print(f"EQUAL: {len(frames)} frames of {len(shown)} vertices")
