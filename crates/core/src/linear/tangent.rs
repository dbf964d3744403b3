//! The matrix of an implicit step, A = M + a (C + D) + a2 K. Couplings that the system does not
//! multiply itself are listed at each assembly, and all couplings if a factorisation or multigrid
//! needs them. Pinned particles are filtered: their rows are those of the identity, and solutions
//! are zero there.

use crate::columns::columns_mut;
use crate::coupling::{
    AxialCoupling, Coupling, Diagonal, GeneralCoupling, Matrix, RankOneCoupling, full,
};
use crate::system::Linearized;

/// The matrix A, and K.
pub(crate) struct Tangent {
    /// Axial couplings. Those that the system multiplies come first.
    axial: Vec<AxialCoupling>,
    blocks: Vec<GeneralCoupling>,
    rank_one: Vec<RankOneCoupling>,
    /// Number of couplings that the system multiplies, and whether they are listed too.
    fast: usize,
    listed: bool,
    /// Mass of each particle in A (kg); 0 for pinned ones.
    masses: Vec<f64>,
    /// 0 for each pinned particle, 1 for others.
    free: Vec<f64>,
    /// Whether couplings are clamped.
    clamped: bool,
    /// Whether A is without K, and without the drag that drifts solve.
    only_damping: bool,
    /// Number of changes of the pattern, the pairs of coupled particles.
    pattern: u64,
    /// Number of assemblies.
    version: u64,
    /// Time (s), positions (m) and step (s) of the last assembly.
    t: f64,
    x: Vec<f64>,
    a: f64,
    /// Columns of the blocks on the diagonal of A (kg), and of the sums of the largest eigenvalues
    /// of each particle's couplings (kg).
    diagonal: Vec<f64>,
    /// Product with a matrix, and a mass of zero for each particle.
    scratch: Vec<f64>,
    zeros: Vec<f64>,
}

impl Tangent {
    /// Creates a matrix with room for all couplings of the system, if their pattern is fixed.
    pub fn new(system: &dyn Linearized) -> Self {
        let mut tangent = Self::empty(system);
        if system.hints().pattern_is_fixed() {
            tangent.list(system);
        }
        tangent
    }

    /// Does what [`new`](Self::new) does, for the matrix A = M + a C, with a D if drifts do not
    /// solve drag.
    pub fn of_damping(system: &dyn Linearized) -> Self {
        let mut tangent = Self { only_damping: true, ..Self::empty(system) };
        // The pattern of a fluid changes.
        if system.hints().pattern_is_fixed() && system.lists_all_couplings() {
            tangent.list(system);
        }
        tangent
    }

    fn empty(system: &dyn Linearized) -> Self {
        let n = system.inverse_masses().len();
        Self {
            axial: vec![],
            blocks: vec![],
            rank_one: vec![],
            fast: 0,
            listed: false,
            masses: vec![0.0; n],
            free: vec![0.0; n],
            clamped: false,
            only_damping: false,
            pattern: 0,
            version: 0,
            t: 0.0,
            x: vec![0.0; 3 * n],
            a: 0.0,
            diagonal: vec![0.0; 7 * n],
            scratch: vec![0.0; 3 * n],
            zeros: vec![0.0; n],
        }
    }

    /// Lists all couplings in the state of the last assembly, unless they are listed.
    pub fn list(&mut self, system: &dyn Linearized) {
        if !self.listed {
            self.listed = true;
            self.collect((0, false), |t, x, clamped, visit| {
                system.couplings(t, x, clamped, visit);
            });
        }
    }

    /// Puts couplings in the lists, axial ones after the first `left`, which stay. With `skips`,
    /// those of two pinned particles are left out.
    fn collect(
        &mut self,
        (left, skips): (usize, bool),
        visit: impl FnOnce(f64, &[f64], bool, &mut dyn FnMut(Coupling)),
    ) {
        let Self { axial, blocks, rank_one, free, .. } = self;
        // Walls of a fluid have many couplings of two pinned particles, which act on nothing.
        let idle = |c: &AxialCoupling| skips && free[c.i] + free[c.j] == 0.0;
        let counts = [axial.len(), blocks.len(), rank_one.len()];
        let (mut axial_count, mut block_count, mut rank_one_count, mut same) = (left, 0, 0, true);
        visit(self.t, &self.x, self.clamped, &mut |coupling| {
            let block = match coupling {
                Coupling::Axial(new) if idle(&new) => return,
                Coupling::Axial(new) => {
                    same &= put(axial, axial_count, new, |c| [c.i, c.j]);
                    axial_count += 1;
                    return;
                }
                Coupling::Block(coupling) => coupling.into(),
                Coupling::General(coupling) => coupling,
                Coupling::RankOne(new) => {
                    same &= put(rank_one, rank_one_count, new, |c| c.ends);
                    rank_one_count += 1;
                    return;
                }
            };
            same &= put(blocks, block_count, block, |c| [c.i, c.j]);
            block_count += 1;
        });
        axial.truncate(axial_count);
        blocks.truncate(block_count);
        rank_one.truncate(rank_one_count);
        self.pattern += u64::from(!same || counts != [axial_count, block_count, rank_one_count]);
    }

    /// Returns the number of the pattern, which changes whenever other particles are coupled.
    pub fn pattern(&self) -> u64 {
        self.pattern
    }

    /// Returns the number of the assembly, which changes whenever couplings are assembled again.
    pub fn version(&self) -> u64 {
        self.version
    }

    /// Returns the number of particles.
    pub fn particles(&self) -> usize {
        self.masses.len()
    }

    /// Returns the number of couplings.
    pub fn couplings(&self) -> usize {
        self.axial.len() + self.blocks.len() + self.rank_one.len()
    }

    /// Lists the ends of the couplings.
    pub fn pairs(&self) -> impl Iterator<Item = [u32; 2]> {
        let axial = self.axial.iter().map(|c| [c.i as u32, c.j as u32]);
        let blocks = self.blocks.iter().map(|c| [c.i as u32, c.j as u32]);
        let of_four = |c: &RankOneCoupling| TWO_OF_FOUR.map(|two| two.map(|k| c.ends[k] as u32));
        axial.chain(blocks).chain(self.rank_one.iter().flat_map(of_four))
    }

    /// Assembles the couplings at time t (s) at x for steps of length a (s). With `clamped`, A is
    /// positive definite.
    pub fn assemble(
        &mut self,
        system: &dyn Linearized,
        (t, a): (f64, f64),
        x: &[f64],
        clamped: bool,
    ) {
        (self.t, self.a, self.clamped) = (t, a, clamped);
        self.x.copy_from_slice(x);
        self.version += 1;
        let drifts = self.only_damping && system.splitting().is_some();
        let drag = if drifts { 0.0 } else { a * system.drag_coefficient() };
        let particles = self.masses.iter_mut().zip(&mut self.free);
        for ((m, free), w) in particles.zip(system.inverse_masses()) {
            (*m, *free) = if *w == 0.0 { (0.0, 0.0) } else { (1.0 / w + drag, 1.0) };
        }
        self.add_up_diagonal(system);
    }

    /// Sums the blocks on the diagonal, and lists the couplings that the system does not multiply.
    fn add_up_diagonal(&mut self, system: &dyn Linearized) {
        let n = self.particles();
        let mut sums = std::mem::take(&mut self.diagonal);
        sums.fill(0.0);
        for column in sums.chunks_exact_mut(n).take(3) {
            column.copy_from_slice(&self.masses);
        }
        let mut diagonal = Diagonal { columns: columns_mut(&mut sums) };
        let products = system.products();
        let fast =
            products.map_or(0, |products| products.add_diagonal(&self.matrix(), &mut diagonal));
        self.listed = false;
        if fast == self.fast && fast <= self.axial.len() {
            let skips = self.only_damping;
            self.collect((fast, skips), |t, x, clamped, visit| match products {
                Some(products) => products.other_couplings(t, x, clamped, visit),
                None => system.couplings(t, x, clamped, visit),
            });
            self.listed = fast == 0;
        } else {
            self.fast = fast;
            self.list(system);
        }
        for c in &self.axial[fast..] {
            let [iso, along] = self.factors(c);
            let k = (iso + along).max(iso);
            add_own(&mut diagonal, [c.i, c.j], self.axial_block(c), k);
        }
        for c in &self.blocks {
            let block = self.block(c);
            let [xx, xy, xz, yx, yy, yz, zx, zy, zz] = block.map(f64::abs);
            // The largest sum of a row bounds the largest eigenvalue.
            let rows = (xx + xy + xz).max(yx + yy + yz).max(zx + zy + zz);
            let k = rows.max(xx + yx + zx).max(xy + yy + zy).max(xz + yz + zz);
            // The sum of the blocks of a particle is symmetric.
            add_own(&mut diagonal, [c.i, c.j], symmetric(block), k);
        }
        for c in &self.rank_one {
            let (factor, block) = (self.factor(c), square(c.direction));
            let [columns @ .., sums] = &mut diagonal.columns;
            for (i, weight) in c.ends.into_iter().zip(c.weights) {
                for (column, part) in columns.iter_mut().zip(block) {
                    column[i] += factor * weight * weight * part;
                }
                // Half of the sum of a row, as the weights of a side sum to 1.
                sums[i] += factor * weight.abs();
            }
        }
        self.diagonal = sums;
    }

    /// Returns the matrix as the system sees it.
    fn matrix(&self) -> Matrix<'_> {
        Matrix {
            x: &self.x,
            stiffness: self.stiffness_factor(),
            damping: self.a,
            clamped: self.clamped,
            masses: &self.masses,
            free: &self.free,
        }
    }

    /// Returns the factor of K in A: a2 (s2), or 0.
    fn stiffness_factor(&self) -> f64 {
        if self.only_damping { 0.0 } else { self.a * self.a }
    }

    /// Returns whether A is without K.
    pub fn is_only_damping(&self) -> bool {
        self.only_damping
    }

    /// Returns the columns xx, yy, zz, xy, xz and yz of the blocks on the diagonal of A (kg).
    pub fn diagonal(&self) -> [&[f64]; 6] {
        let n = self.particles();
        std::array::from_fn(|k| &self.diagonal[k * n..(k + 1) * n])
    }

    /// Returns the mass of each particle in A (kg); 0 where it is pinned.
    pub fn masses(&self) -> &[f64] {
        &self.masses
    }

    /// Returns 0 for each particle that is pinned, 1 for others.
    pub fn free(&self) -> &[f64] {
        &self.free
    }

    /// Returns the factors of an axial coupling in A: for all directions, and in addition along it.
    #[inline]
    fn factors(&self, c: &AxialCoupling) -> [f64; 2] {
        let (a, square) = (self.a, self.stiffness_factor());
        let (across, along) = (square * c.across, square * (c.along - c.across));
        [across, along + a * c.damping]
    }

    /// Returns the block of an axial coupling in A.
    #[inline]
    fn axial_block(&self, c: &AxialCoupling) -> Block {
        let ([iso, along], [x, y, z]) = (self.factors(c), c.direction);
        [
            iso + along * x * x,
            iso + along * y * y,
            iso + along * z * z,
            along * x * y,
            along * x * z,
            along * y * z,
        ]
    }

    /// Returns the block of a coupling in A.
    fn block(&self, coupling: &GeneralCoupling) -> [f64; 9] {
        let (a, square) = (self.a, self.stiffness_factor());
        let [k, c] = [coupling.stiffness, coupling.damping];
        std::array::from_fn(|part| square * k[part] + a * c[part])
    }

    /// Returns the factor of a coupling of four particles in A.
    fn factor(&self, c: &RankOneCoupling) -> f64 {
        self.stiffness_factor() * c.stiffness + self.a * c.damping
    }

    /// Visits the ends i and j of each coupling and its 3 x 3 block B in A, row by row: -B is in
    /// the rows of i and the columns of j. One of four particles couples each two of them.
    pub fn blocks(&self, mut visit: impl FnMut(usize, usize, [f64; 9])) {
        for c in &self.axial {
            visit(c.i, c.j, full(self.axial_block(c)));
        }
        for c in &self.blocks {
            visit(c.i, c.j, self.block(c));
        }
        for c in &self.rank_one {
            for [k, l] in TWO_OF_FOUR {
                let share = -self.factor(c) * c.weights[k] * c.weights[l];
                let block = square(c.direction).map(|part| share * part);
                visit(c.ends[k], c.ends[l], full(block));
            }
        }
    }

    /// Visits the ends of each coupling and the symmetric part of its block in A.
    pub fn symmetric_blocks(&self, mut visit: impl FnMut(usize, usize, Block)) {
        self.blocks(|i, j, block| visit(i, j, symmetric(block)));
    }

    /// Returns an upper bound on a2 w2, the square of the step's length over the time scale of the
    /// fastest motion.
    pub fn stiffness(&self) -> f64 {
        let sums = &self.diagonal[6 * self.particles()..];
        let ratios = sums.iter().zip(&self.masses);
        ratios.filter(|(_, m)| **m > 0.0).fold(0.0, |most: f64, (sum, m)| most.max(2.0 * sum / m))
    }

    /// Writes A p to `out`, for a p that is zero on pinned particles; so is `out`.
    pub fn product(&self, system: &dyn Linearized, p: &[f64], out: &mut [f64]) {
        let matrix = self.matrix();
        let products = system.products();
        let done = products.map_or(0, |products| products.multiply(&matrix, p, out));
        if done == 0 {
            let n = self.particles();
            for (out, p) in out.chunks_exact_mut(n).zip(p.chunks_exact(n)) {
                for ((out, p), m) in out.iter_mut().zip(p).zip(&self.masses) {
                    *out = m * p;
                }
            }
        } else if done == self.couplings() {
            return;
        }
        for c in &self.axial[done..] {
            let [iso, along] = self.factors(c);
            add_axial(c, iso, along, p, out);
        }
        for c in &self.blocks {
            add_block(c, self.block(c), p, out);
        }
        for c in &self.rank_one {
            add_rank_one(c, self.factor(c), p, out);
        }
        self.filter(out);
    }

    /// Subtracts a K d from out, which is a times the change of the forces by a displacement d, in
    /// which pinned particles may move.
    pub fn subtract_stiffness(
        &mut self,
        system: &dyn Linearized,
        a: f64,
        d: &[f64],
        out: &mut [f64],
    ) {
        let mut product = std::mem::take(&mut self.scratch);
        let matrix = Matrix { stiffness: 1.0, damping: 0.0, masses: &self.zeros, ..self.matrix() };
        let products = system.products();
        let done = products.map_or(0, |products| products.multiply(&matrix, d, &mut product));
        if done > 0 {
            for (out, product) in out.iter_mut().zip(&product) {
                *out -= a * product;
            }
        }
        self.scratch = product;
        for c in &self.axial[done..] {
            add_axial(c, -a * c.across, -a * (c.along - c.across), d, out);
        }
        for c in &self.blocks {
            add_block(c, c.stiffness.map(|k| -a * k), d, out);
        }
        for c in &self.rank_one {
            add_rank_one(c, -a * c.stiffness, d, out);
        }
    }

    /// Sets a to zero where particles are pinned.
    pub fn filter(&self, a: &mut [f64]) {
        let n = self.particles();
        for column in a.chunks_exact_mut(n) {
            for (a, m) in column.iter_mut().zip(&self.masses) {
                if *m == 0.0 {
                    *a = 0.0;
                }
            }
        }
    }
}

/// Adds a coupling's block to those of its ends on the diagonal, and its largest eigenvalue.
pub fn add_own(diagonal: &mut Diagonal, [i, j]: [usize; 2], block: Block, largest: f64) {
    let [columns @ .., sums] = &mut diagonal.columns;
    for (column, part) in columns.iter_mut().zip(block) {
        column[i] += part;
        if j != i {
            column[j] += part;
        }
    }
    sums[i] += largest;
    sums[j] += largest;
}

/// Adds (iso + along u uT) d at one end of a coupling, and subtracts it at the other.
#[inline]
pub fn add_axial(c: &AxialCoupling, iso: f64, along: f64, p: &[f64], out: &mut [f64]) {
    let (d, u) = (difference(p, c.i, c.j), c.direction);
    let share = along * (d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
    add(c.i, c.j, |axis| iso * d[axis] + share * u[axis], out);
}

/// Adds a block times d at one end of a coupling, and subtracts it at the other, unless the other
/// is a place.
pub fn add_block(c: &GeneralCoupling, block: [f64; 9], p: &[f64], out: &mut [f64]) {
    let n = p.len() / 3;
    let anchored = c.i == c.j;
    let d = if anchored {
        [0, n, 2 * n].map(|column| p[column + c.i])
    } else {
        difference(p, c.i, c.j)
    };
    for (axis, row) in block.as_chunks::<3>().0.iter().enumerate() {
        out[axis * n + c.i] += row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
        if !anchored {
            let row = [block[axis], block[3 + axis], block[6 + axis]];
            out[axis * n + c.j] -= row[0] * d[0] + row[1] * d[1] + row[2] * d[2];
        }
    }
}

/// Adds to each end its weight times factor u uT d.
#[inline]
fn add_rank_one(c: &RankOneCoupling, factor: f64, p: &[f64], out: &mut [f64]) {
    let n = p.len() / 3;
    let weighted = |column: usize| {
        let ([a, b, c, d], [u, v, w, x]) = (c.ends.map(|i| p[column * n + i]), c.weights);
        a * u + b * v + c * w + d * x
    };
    let [x, y, z] = c.direction;
    let along = factor * (weighted(0) * x + weighted(1) * y + weighted(2) * z);
    for (i, weight) in c.ends.into_iter().zip(c.weights) {
        let along = weight * along;
        for (axis, u) in c.direction.into_iter().enumerate() {
            out[axis * n + i] += along * u;
        }
    }
}

#[inline]
fn difference(p: &[f64], i: usize, j: usize) -> [f64; 3] {
    let n = p.len() / 3;
    [0, n, 2 * n].map(|column| p[column + i] - p[column + j])
}

#[inline]
fn add(i: usize, j: usize, force: impl Fn(usize) -> f64, out: &mut [f64]) {
    let n = out.len() / 3;
    for axis in 0..3 {
        out[axis * n + i] += force(axis);
        out[axis * n + j] -= force(axis);
    }
}

/// Puts a coupling in its place in a list. Returns whether there was one of the same ends.
#[inline]
pub fn put<C, E: PartialEq>(
    list: &mut Vec<C>,
    place: usize,
    new: C,
    ends: impl Fn(&C) -> E,
) -> bool {
    if let Some(old) = list.get_mut(place) {
        let same = ends(old) == ends(&new);
        *old = new;
        same
    } else {
        list.push(new);
        false
    }
}

/// Places of each two of four ends.
const TWO_OF_FOUR: [[usize; 2]; 6] = [[0, 1], [0, 2], [0, 3], [1, 2], [1, 3], [2, 3]];

/// A block: xx, yy, zz, xy, xz, yz.
pub(super) type Block = [f64; 6];

/// Returns the block u uT.
fn square([x, y, z]: [f64; 3]) -> Block {
    [x * x, y * y, z * z, x * y, x * z, y * z]
}

/// Returns the inverse of a symmetric block; if the block is not positive definite, the inverse of
/// the absolute values on its diagonal.
pub(super) fn inverse([xx, yy, zz, xy, xz, yz]: Block) -> Block {
    let minor = xx * yy - xy * xy;
    let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let determinant = xx * a + xy * b + xz * c;
    if xx > 0.0 && minor > 0.0 && determinant > 0.0 {
        let d = 1.0 / determinant;
        [a * d, (xx * zz - xz * xz) * d, minor * d, b * d, c * d, (xy * xz - xx * yz) * d]
    } else {
        let size = |k: f64| 1.0 / k.abs().max(f64::MIN_POSITIVE);
        [size(xx), size(yy), size(zz), 0.0, 0.0, 0.0]
    }
}

/// Returns the symmetric part of a block.
pub(super) fn symmetric([xx, xy, xz, yx, yy, yz, zx, zy, zz]: [f64; 9]) -> Block {
    let mean = |a: f64, b: f64| 0.5 * (a + b);
    [xx, yy, zz, mean(xy, yx), mean(xz, zx), mean(yz, zy)]
}
