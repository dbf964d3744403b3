"""Newton's cloth on this processor: python newton_cloth.py (vbd | style3d) STEPS ITERATIONS."""

import sys

import newton
import warp as wp
from folding import MASS, RATE, SIDE, SPACING, THICKNESS, mesh, run
from newton.solvers import style3d

name, steps, iterations = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
wp.set_device("cpu")
points, triangles = mesh()
builder = newton.ModelBuilder(up_axis=newton.Axis.Y, gravity=(0, -9.81, 0))
common = {
    "pos": wp.vec3(0, 0, 0),
    "rot": wp.quat_identity(),
    "vel": wp.vec3(0, 0, 0),
    "vertices": [wp.vec3(*p) for p in points],
    "indices": triangles.ravel().tolist(),
    "density": 0.2,
    "scale": 1.0,
    "particle_radius": THICKNESS / 2,
}
if name == "vbd":
    # The springs' lattice is isotropic for small strains: both of Lame's constants are 20 N/m.
    builder.add_cloth_mesh(
        **common, tri_ke=20, tri_ka=20, tri_kd=4e-3, edge_ke=5e-4, edge_kd=1e-6
    )
    builder.color(include_bending=True)
else:
    newton.solvers.SolverStyle3D.register_custom_attributes(builder)
    style3d.add_cloth_mesh(
        builder,
        **common,
        tri_aniso_ke=wp.vec3(53, 53, 20),
        edge_aniso_ke=wp.vec3(3e-6, 3e-6, 3e-6),
    )
builder.add_ground_plane(cfg=newton.ModelBuilder.ShapeConfig(mu=0.4))
model = builder.finalize()
model.particle_mass.fill_(MASS)
model.particle_inv_mass.fill_(1 / MASS)
model.soft_contact_ke, model.soft_contact_kd = (1e3, 1e-1) if name == "vbd" else (1e2, 1e-2)
model.soft_contact_mu = 0.3
pipeline = newton.CollisionPipeline(model)
if name == "vbd":
    solver = newton.solvers.SolverVBD(
        model,
        iterations=iterations,
        particle_enable_self_contact=True,
        particle_self_contact_margin=THICKNESS,
        particle_self_contact_gap=0.75 * THICKNESS,
        particle_topological_contact_filter_threshold=1,
        particle_vertex_contact_buffer_size=64,
        particle_edge_contact_buffer_size=128,
    )
else:
    config = newton.solvers.SolverStyle3D.Config(iterations=iterations)
    solver = newton.solvers.SolverStyle3D(model, config=config)
    solver.collision.radius = THICKNESS / 2
states = [model.state(), model.state()]
control, contacts = model.control(), pipeline.contacts()


def simulate():
    """The steps of a frame, as the examples of Newton take them."""
    pipeline.collide(states[0], contacts)
    if name == "vbd":
        solver.rebuild_bvh(states[0])
    for _ in range(steps):
        states[0].clear_forces()
        solver.step(states[0], states[1], control, contacts, 1 / (RATE * steps))
        states.reverse()


def positions():
    """Positions of the particles (m)."""
    return states[0].particle_q.numpy()


start = [array.numpy().copy() for array in (states[0].particle_q, states[0].particle_qd)]
simulate()  # compiles the kernels
for state in states:
    state.particle_q.assign(start[0])
    state.particle_qd.assign(start[1])
graph = None
if name == "vbd":  # Style3D's steps cannot be captured on a processor.
    with wp.ScopedCapture() as capture:
        simulate()
    graph = capture.graph
run(f"{name}.pc2", (lambda: wp.capture_launch(graph)) if graph else simulate, positions)
