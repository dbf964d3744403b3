//! The SIMD vectors of the processor.

#[cfg(not(all(target_arch = "wasm32", target_feature = "relaxed-simd")))]
pub(crate) use pulp::Arch;
#[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
pub(crate) use relaxed::Arch;

/// A build for relaxed SIMD, which no browser without it loads, leaves out the code for browsers
/// without it: a tenth of the page.
#[cfg(all(target_arch = "wasm32", target_feature = "relaxed-simd"))]
mod relaxed {
    use pulp::wasm::RelaxedSimd;
    use pulp::{Simd, WithSimd};

    /// Vectors of relaxed SIMD.
    #[derive(Clone, Copy)]
    pub(crate) struct Arch(RelaxedSimd);

    impl Arch {
        /// Finds the vectors.
        pub fn new() -> Self {
            let found = RelaxedSimd::try_new();
            Self(found.unwrap_or_else(|| unreachable!("the module was loaded")))
        }

        /// Does the work of `op` with them.
        pub fn dispatch<Op: WithSimd>(self, op: Op) -> Op::Output {
            Simd::vectorize(self.0, op)
        }
    }
}
