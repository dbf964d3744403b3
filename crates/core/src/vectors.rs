//! The SIMD vectors of the processor.

#[cfg(not(all(target_arch = "wasm32", target_feature = "relaxed-simd")))]
pub(crate) use pulp::Arch;
#[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
pub(crate) use relaxed::Arch;

/// A build for relaxed SIMD leaves out the code for SIMD without it, which a browser never runs
/// there: a tenth of a page.
#[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
mod relaxed {
    use pulp::wasm::RelaxedSimd;
    use pulp::{Scalar, Simd, WithSimd};

    /// The vectors that were found.
    #[derive(Clone, Copy)]
    pub(crate) struct Arch(Option<RelaxedSimd>);

    impl Arch {
        /// Finds the vectors.
        pub fn new() -> Self {
            Self(RelaxedSimd::try_new())
        }

        /// Does the work of `op` with them.
        pub fn dispatch<Op: WithSimd>(self, op: Op) -> Op::Output {
            match self.0 {
                Some(simd) => Simd::vectorize(simd, op),
                None => Simd::vectorize(Scalar::new(), op),
            }
        }
    }
}
