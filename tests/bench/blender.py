# What Blender makes of a model, for `bench_lod --beside`: the model with fewer triangles, unwrapped, with the full
# model's normals baked by rays.
#
#   blender --background --python tests/bench/blender.py -- FULL.obj RATIO SIZE LOW.obj NORMALS.png
#
# Prints the seconds of each step. The normals are in object space, as bench_lod has its own.
import sys
import time

import bpy

full_path, ratio, size, low_path, map_path = sys.argv[sys.argv.index('--') + 1:]
ratio, size = float(ratio), int(size)
clock = time.perf_counter()


def step(name):
    global clock
    now = time.perf_counter()
    print(f'{name} {now - clock:.2f} s', flush=True)
    clock = now


bpy.ops.wm.read_factory_settings(use_empty=True)
axes = {'forward_axis': 'Y', 'up_axis': 'Z'}  # as they are
bpy.ops.wm.obj_import(filepath=full_path, **axes)
full = bpy.context.selected_objects[0]
for polygon in full.data.polygons:
    polygon.use_smooth = True
low = full.copy()
low.data = full.data.copy()
bpy.context.collection.objects.link(low)
step('read')

bpy.ops.object.select_all(action='DESELECT')
low.select_set(True)
bpy.context.view_layer.objects.active = low
decimate = low.modifiers.new('decimate', 'DECIMATE')
decimate.ratio = ratio
bpy.ops.object.modifier_apply(modifier=decimate.name)
step('simplify')

bpy.ops.object.mode_set(mode='EDIT')
bpy.ops.mesh.select_all(action='SELECT')
bpy.ops.uv.smart_project(island_margin=16 / size)
bpy.ops.object.mode_set(mode='OBJECT')
step('unwrap')

image = bpy.data.images.new('normals', size, size, alpha=False)
image.colorspace_settings.name = 'Non-Color'
material = bpy.data.materials.new('low')
material.use_nodes = True
texture = material.node_tree.nodes.new('ShaderNodeTexImage')
texture.image = image
material.node_tree.nodes.active = texture
low.data.materials.clear()
low.data.materials.append(material)
scene = bpy.context.scene
scene.render.engine = 'CYCLES'
scene.cycles.device = 'CPU'
scene.cycles.samples = 4
scene.cycles.use_denoising = False  # with it the bake comes out grey, and says nothing
full.select_set(True)
diagonal = sum(side * side for side in full.dimensions) ** 0.5
bpy.ops.object.bake(type='NORMAL', normal_space='OBJECT', use_selected_to_active=True, margin=16,
                    cage_extrusion=0.01 * diagonal, max_ray_distance=0.02 * diagonal)
step('bake')

image.filepath_raw = map_path
image.file_format = 'PNG'
image.save()
full.select_set(False)
bpy.ops.wm.obj_export(filepath=low_path, export_selected_objects=True, export_materials=False, export_normals=False,
                      export_triangulated_mesh=True, **axes)
step('write')
