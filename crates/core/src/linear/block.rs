//! Symmetric 3 x 3 blocks of a matrix.

/// A block: xx, yy, zz, xy, xz, yz.
pub(super) type Block = [f64; 6];

/// Returns the inverse of a symmetric block; if the block is not positive definite, the inverse of
/// the absolute values on its diagonal.
pub(super) fn inverse([xx, yy, zz, xy, xz, yz]: Block) -> Block {
    let minor = xx * yy - xy * xy;
    let (a, b, c) = (yy * zz - yz * yz, xz * yz - xy * zz, xy * yz - xz * yy);
    let determinant = xx * a + xy * b + xz * c;
    if xx > 0.0 && minor > 0.0 && determinant > 0.0 {
        let d = 1.0 / determinant;
        [
            a * d,
            (xx * zz - xz * xz) * d,
            minor * d,
            b * d,
            c * d,
            (xy * xz - xx * yz) * d,
        ]
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
