"""Blender's cloth on this processor: python blender_cloth.py QUALITY COLLISION_QUALITY."""

import sys

import bpy
import numpy as np
from folding import FRAMES, MASS, RATE, SIDE, SPACING, THICKNESS, mesh, run

LENGTH = (2 + np.sqrt(2)) / 3 * SPACING  # m, the mean of the edges
quality, collision_quality = int(sys.argv[1]), int(sys.argv[2])
bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
scene.render.fps = RATE
scene.gravity = (0, 0, -9.81)
scene.frame_start, scene.frame_end = 1, FRAMES + 1


def body(name, points, faces):
    """An object of these points (m, z upwards)."""
    shape = bpy.data.meshes.new(name)
    shape.from_pydata(points, [], faces)
    made = bpy.data.objects.new(name, shape)
    scene.collection.objects.link(made)
    return made


corners = [(-2, -2, 0), (2, -2, 0), (2, 2, 0), (-2, 2, 0)]
floor = body("floor", corners, [(0, 1, 2, 3)])
floor.modifiers.new("collision", "COLLISION")
floor.collision.thickness_outer = 0.001
floor.collision.cloth_friction = 40

points, triangles = mesh()
cloth = body("cloth", (points[:, [0, 2, 1]] * (1, -1, 1)).tolist(), triangles.tolist())
made = cloth.modifiers.new("cloth", "CLOTH")
law, contact = made.settings, made.collision_settings
# Gravity counts a thousandth in Blender's own unit of time, which therefore is 1/sqrt(1000) s.
# Masses in grams make its forces N. A stiffness is that of a spring times its length.
law.time_scale = np.sqrt(1000) / RATE
law.mass = 1000 * MASS
law.quality = quality
law.tension_stiffness = law.compression_stiffness = 40 * LENGTH
law.shear_stiffness = 20 * LENGTH
law.bending_stiffness = 0.3
law.tension_damping = law.compression_damping = law.shear_damping = 0.28
law.bending_damping = 0
law.air_damping = 0.08
contact.collision_quality = collision_quality
contact.distance_min = contact.self_distance_min = THICKNESS
contact.friction = contact.self_friction = 30
contact.use_self_collision = True
made.point_cache.frame_start, made.point_cache.frame_end = 1, FRAMES + 1
scene.frame_set(1)


def frame():
    """The next frame."""
    scene.frame_set(scene.frame_current + 1)


def positions():
    """Positions of the particles (m)."""
    shape = cloth.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
    numbers = np.empty(3 * SIDE**2, np.float32)
    shape.vertices.foreach_get("co", numbers)
    return numbers.reshape(-1, 3)[:, [0, 2, 1]] * np.float32((1, 1, -1))


run("blender.pc2", frame, positions)
