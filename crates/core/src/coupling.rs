//! Couplings of particles (their stiffness and damping blocks), and the matrix of an implicit step
//! that is assembled from them.

/// Coupling of two particles, to first order. With d = xi - xj it adds dFi = -(K dd + C dd'), and
/// the opposite to dFj.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Coupling {
    /// A coupling along the line between the particles.
    Axial(AxialCoupling),
    /// A coupling by symmetric matrices.
    Block(BlockCoupling),
    /// A coupling by matrices that need not be symmetric; it adds KT dd + CT dd' to dFj.
    General(GeneralCoupling),
    /// A coupling of four particles along one direction, as of two surfaces that touch.
    RankOne(RankOneCoupling),
}

/// Coupling of two particles along the line between them. With u = d / |d|, K = along u uT + across
/// (1 - u uT), and C = damping u uT.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxialCoupling {
    /// Particle at one end.
    pub i: usize,
    /// Particle at the other end.
    pub j: usize,
    /// Direction u, or 0 for particles at the same place.
    pub direction: [f64; 3],
    /// Stiffness along u (N/m).
    pub along: f64,
    /// Stiffness across u (N/m): negative where the particles push each other apart.
    pub across: f64,
    /// Damping along u (N s/m).
    pub damping: f64,
}

/// Coupling of two particles by symmetric 3 x 3 matrices, each given by its xx, yy, zz, xy, xz and
/// yz.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BlockCoupling {
    /// Particle at one end.
    pub i: usize,
    /// Particle at the other end; i again where the other end is a place that does not depend on
    /// the state, as on an obstacle.
    pub j: usize,
    /// K (N/m).
    pub stiffness: [f64; 6],
    /// C (N s/m).
    pub damping: [f64; 6],
}

/// Coupling of two particles by 3 x 3 matrices, each given row by row. The assembled matrix is
/// symmetric, because the other end has the transposes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GeneralCoupling {
    /// Particle at one end.
    pub i: usize,
    /// Particle at the other end; i again, with symmetric matrices, where the other end is a place
    /// that does not depend on the state.
    pub j: usize,
    /// K (N/m).
    pub stiffness: [f64; 9],
    /// C (N s/m).
    pub damping: [f64; 9],
}

/// Coupling of four particles along one direction u; a particle may stand at several of the four
/// places. With the sum d of all wi xi it adds dFi = -wi u uT (k dd + c dd'), so that K is a matrix
/// of rank one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RankOneCoupling {
    /// Particles.
    pub ends: [usize; 4],
    /// Weight w of each; 0 instead of a place that does not depend on the state, as on an obstacle.
    /// Where the forces reach any distance, systems are solved by the couplings of each two alone:
    /// there, weights sum to 0 and ends are distinct.
    pub weights: [f64; 4],
    /// Direction u.
    pub direction: [f64; 3],
    /// Stiffness k (N/m).
    pub stiffness: f64,
    /// Damping c (N s/m).
    pub damping: f64,
}

impl From<BlockCoupling> for GeneralCoupling {
    fn from(coupling: BlockCoupling) -> Self {
        let BlockCoupling { i, j, stiffness, damping } = coupling;
        Self { i, j, stiffness: full(stiffness), damping: full(damping) }
    }
}

/// Returns the nine numbers, row by row, of a symmetric matrix with these xx, yy, zz, xy, xz and
/// yz.
pub(crate) fn full([xx, yy, zz, xy, xz, yz]: [f64; 6]) -> [f64; 9] {
    [xx, xy, xz, xy, yy, yz, xz, yz, zz]
}

/// The matrix A = M + a (C + D) + a2 K of an implicit step of length a, from the
/// [couplings](crate::Linearized::couplings) at x and from the drag D.
#[derive(Clone, Copy, Debug)]
pub struct Matrix<'a> {
    /// Positions (m).
    pub x: &'a [f64],
    /// Factor of K: a2 (s2).
    pub stiffness: f64,
    /// Factor of C: a (s).
    pub damping: f64,
    /// Whether couplings are clamped.
    pub clamped: bool,
    /// Diagonal of M + a D for each particle (kg).
    pub masses: &'a [f64],
    /// Factor of each particle's rows of the product: 0 for pinned particles, 1 for others.
    pub free: &'a [f64],
}

/// The blocks on the diagonal of a matrix, one for each particle.
#[derive(Debug)]
pub struct Diagonal<'a> {
    /// The columns xx, yy, zz, xy, xz and yz of the blocks (kg), and the sums of the largest
    /// eigenvalues of each particle's couplings (kg).
    pub columns: [&'a mut [f64]; 7],
}
