"""A run in Blender: the mesh of `selvage export RUN -o run.pc2`, moved by its point cache.

    blender --python import_run.py -- run.pc2                    opens it
    blender -b --python import_run.py -- run.pc2 run.blend       saves it, without a display
"""

import pathlib
import struct
import sys

import bpy

given = [pathlib.Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :]]
cache_file, mesh_file = given[0], given[0].with_suffix(".obj")
with cache_file.open("rb") as file:
    first, _, frames = struct.unpack("<ffi", file.read(32)[20:])

bpy.ops.wm.read_factory_settings(use_empty=True)
bpy.ops.wm.obj_import(filepath=str(mesh_file), forward_axis="Y", up_axis="Z")
bodies = bpy.context.selected_objects[0]
cache = bodies.modifiers.new("frames", "MESH_CACHE")
cache.cache_format = "PC2"
cache.filepath = str(cache_file)
cache.frame_start = 0

scene = bpy.context.scene
scene.render.fps = 60  # those of the scene, where it says others
scene.frame_start, scene.frame_end = int(first), int(first) + frames - 1
scene.frame_set(scene.frame_start)
print(f"{cache_file.name}: {frames} frames of {len(bodies.data.vertices)} vertices")
if len(given) > 1:
    bpy.ops.wm.save_as_mainfile(filepath=str(given[1]))
