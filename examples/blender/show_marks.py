"""What `selvage check MESH --ply marked.ply` found, in Blender: a material that shows the file's colours.

    blender --python show_marks.py -- marked.ply                    opens it; Z, Material Preview, shows the colours
    blender -b --python show_marks.py -- marked.ply marked.png      draws it, without a display
"""

import pathlib
import sys

import bpy
from mathutils import Vector

given = [pathlib.Path(word).resolve() for word in sys.argv[sys.argv.index("--") + 1 :]]
bpy.ops.wm.read_factory_settings(use_empty=True)
if bpy.app.version >= (3, 6, 0):
    bpy.ops.wm.ply_import(filepath=str(given[0]), forward_axis="Y", up_axis="Z")
else:
    bpy.ops.import_mesh.ply(filepath=str(given[0]))
surface = bpy.context.selected_objects[0]

material = bpy.data.materials.new("marks")
material.use_nodes = True
nodes = material.node_tree.nodes
colours = nodes.new("ShaderNodeVertexColor")
colours.layer_name = surface.data.color_attributes[0].name
material.node_tree.links.new(colours.outputs["Color"], nodes["Principled BSDF"].inputs["Base Color"])
surface.data.materials.clear()
surface.data.materials.append(material)
print(f"{given[0].name}: {len(surface.data.polygons)} triangles, colours in '{colours.layer_name}'")

scene = bpy.context.scene
corners = [surface.matrix_world @ Vector(corner) for corner in surface.bound_box]
middle = sum(corners, Vector()) / 8
camera = bpy.data.objects.new("camera", bpy.data.cameras.new("camera"))
camera.location = middle + 1.5 * (corners[6] - corners[0]).length * Vector((0.5, -0.7, 0.5))
camera.rotation_euler = (middle - camera.location).to_track_quat("-Z", "Y").to_euler()
sun = bpy.data.objects.new("sun", bpy.data.lights.new("sun", "SUN"))
sun.rotation_euler = camera.rotation_euler
sun.data.energy = 3
for item in (camera, sun):
    scene.collection.objects.link(item)
scene.camera = camera
if len(given) > 1:
    scene.render.engine = "CYCLES"
    scene.cycles.device, scene.cycles.samples = "CPU", 16
    scene.cycles.use_denoising = False
    scene.view_settings.view_transform = "Standard"
    scene.render.resolution_x, scene.render.resolution_y = 480, 320
    scene.render.filepath = str(given[1])
    bpy.ops.render.render(write_still=True)
