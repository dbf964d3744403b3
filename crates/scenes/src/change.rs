//! Changes of a description that leave parts out.

/// Change of a description that leaves a part out, or replaces it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// Gravity.
    Gravity,
    /// Drag on particles.
    Drag,
    /// Damping of springs and solids.
    Damping,
    /// Springs of a kind: 0 for structural ones, 1 for shear, 2 for bend.
    Springs(usize),
    /// Buckling of bend springs.
    Buckling,
    /// Limit of strain.
    StrainLimit,
    /// Springs that only pull, replaced by springs that also push.
    TensionOnly,
    /// Ropes.
    Ropes,
    /// Gas in closed meshes.
    Gas,
    /// Tearing.
    Tear,
    /// Viscosity of fluids.
    Viscosity,
    /// Wind.
    Wind,
    /// Gusts of the wind.
    Gusts,
    /// Wind that blows on triangles, replaced by forces on particles.
    WindByParticles,
    /// Friction.
    Friction,
    /// Restitution.
    Restitution,
    /// Contact of surfaces with one another and themselves.
    SelfCollision,
    /// Floor.
    Floor,
    /// Obstacle: its kind (0 for a sphere, 1 a box, 2 a capsule, 3 a mesh), and its index among
    /// those of its kind.
    Obstacle(usize, usize),
    /// Springs of chains, replaced by rods.
    Rods,
    /// Boxes of elastic solids, replaced by jellies.
    Jelly,
}
