//! The kernels of the tree compiled for each instruction set, and the choice among them.

use super::far::{self, Expansion};
use super::field::Sources;
use super::near::{self, Action};
use super::tree::Cell;
use crate::simd::Level;

type Four = unsafe fn(&[Sources], [[usize; 2]; 4]) -> [[f64; 4]; 4];
type Local = unsafe fn([f64; 3], &[u32], &[Cell], &[f64], &mut Expansion);

/// The kernels for one instruction set and one order of expansion.
#[derive(Debug, Clone, Copy)]
pub(super) struct Kernels {
    near: unsafe fn(&[Sources], usize, &[u32], &mut Action),
    near_depth: unsafe fn(&[Sources], usize, &[u32], &mut Action),
    four: Four,
    moments: unsafe fn(&[Sources], [f64; 3], &mut Expansion),
    shift_moments: unsafe fn(&[f64], [f64; 3], &mut Expansion),
    local: Local,
    shift_local: unsafe fn(&Expansion, [f64; 3], &mut Expansion),
    apply: unsafe fn(&Sources, [f64; 3], &Expansion, &mut Action),
}

macro_rules! kernels {
    ($name:ident, $lanes:ty, $rows:literal $(, $feature:literal)?) => {
        mod $name {
            use super::*;

            $(#[target_feature(enable = $feature)])?
            unsafe fn near<const DEPTH: bool>(blocks: &[Sources], own: usize, list: &[u32], out: &mut Action) {
                unsafe { near::block::<$lanes, $rows, DEPTH>(blocks, own, list, out) }
            }
            $(#[target_feature(enable = $feature)])?
            unsafe fn four(blocks: &[Sources], spheres: [[usize; 2]; 4]) -> [[f64; 4]; 4] {
                unsafe { near::four::<$lanes>(blocks, spheres) }
            }
            $(#[target_feature(enable = $feature)])?
            unsafe fn moments<const P: usize>(blocks: &[Sources], centre: [f64; 3], out: &mut Expansion) {
                unsafe { far::moments::<$lanes, P>(blocks, centre, out) }
            }
            $(#[target_feature(enable = $feature)])?
            unsafe fn shift_moments<const P: usize>(moments: &[f64], shift: [f64; 3], out: &mut Expansion) {
                unsafe { far::shift_moments::<P>(moments, shift, out) }
            }
            $(#[target_feature(enable = $feature)])?
            unsafe fn local<const P: usize>(
                centre: [f64; 3],
                list: &[u32],
                cells: &[Cell],
                expansions: &[f64],
                out: &mut Expansion,
            ) {
                unsafe { far::local::<$lanes, P>(centre, list, cells, expansions, out) }
            }
            $(#[target_feature(enable = $feature)])?
            unsafe fn shift_local<const P: usize>(local: &Expansion, shift: [f64; 3], out: &mut Expansion) {
                unsafe { far::shift_local::<P>(local, shift, out) }
            }
            $(#[target_feature(enable = $feature)])?
            unsafe fn apply<const P: usize>(block: &Sources, centre: [f64; 3], local: &Expansion, out: &mut Action) {
                unsafe { far::apply::<$lanes, P>(block, centre, local, out) }
            }

            /// To be used only on processors that have the instruction set.
            pub(super) fn all<const P: usize>() -> Kernels {
                Kernels {
                    near: near::<false>,
                    near_depth: near::<true>,
                    four,
                    moments: moments::<P>,
                    shift_moments: shift_moments::<P>,
                    local: local::<P>,
                    shift_local: shift_local::<P>,
                    apply: apply::<P>,
                }
            }
        }
    };
}

kernels!(plain, super::super::lanes::Plain, 1);
#[cfg(target_arch = "x86_64")]
kernels!(avx2, super::super::lanes::Avx2, 2, "avx2,fma");
#[cfg(target_arch = "x86_64")]
kernels!(avx512, std::arch::x86_64::__m512d, 4, "avx512f,avx2,fma");

// SAFETY of all calls below: `at` hands out kernels only where the processor has their instructions.
impl Kernels {
    /// The kernels that are in use.
    pub fn fastest<const P: usize>() -> Self {
        Self::at::<P>(Level::in_use())
    }

    /// The kernels of a level.
    ///
    /// # Panics
    /// If the processor cannot run them.
    fn at<const P: usize>(level: Level) -> Self {
        assert!(level <= Level::present(), "kernels that can run here");
        match level {
            Level::Scalar => plain::all::<P>(),
            #[cfg(target_arch = "x86_64")]
            Level::Avx2 => avx2::all::<P>(),
            #[cfg(target_arch = "x86_64")]
            Level::Avx512 => avx512::all::<P>(),
        }
    }

    /// [`near::block`].
    pub fn near(&self, depth: bool, blocks: &[Sources], own: usize, list: &[u32], out: &mut Action) {
        let kernel = if depth { self.near_depth } else { self.near };
        unsafe { kernel(blocks, own, list, out) }
    }

    /// [`near::four`].
    pub fn four(&self, blocks: &[Sources], spheres: [[usize; 2]; 4]) -> [[f64; 4]; 4] {
        unsafe { (self.four)(blocks, spheres) }
    }

    /// [`far::moments`].
    pub fn moments(&self, blocks: &[Sources], centre: [f64; 3], out: &mut Expansion) {
        unsafe { (self.moments)(blocks, centre, out) }
    }

    /// [`far::shift_moments`].
    pub fn shift_moments(&self, moments: &[f64], shift: [f64; 3], out: &mut Expansion) {
        unsafe { (self.shift_moments)(moments, shift, out) }
    }

    /// [`far::local`].
    pub fn local(&self, centre: [f64; 3], list: &[u32], cells: &[Cell], expansions: &[f64], out: &mut Expansion) {
        unsafe { (self.local)(centre, list, cells, expansions, out) }
    }

    /// [`far::shift_local`].
    pub fn shift_local(&self, local: &Expansion, shift: [f64; 3], out: &mut Expansion) {
        unsafe { (self.shift_local)(local, shift, out) }
    }

    /// [`far::apply`].
    pub fn apply(&self, block: &Sources, centre: [f64; 3], local: &Expansion, out: &mut Action) {
        unsafe { (self.apply)(block, centre, local, out) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::harmonic::narrow_len;
    use super::super::tree::{NOBODY, Tree};
    use super::super::walk::Walk;
    use super::*;

    /// A field of 700 sources by `kernels`.
    fn field<const P: usize>(kernels: &Kernels, opening: f64) -> Vec<Action> {
        let coordinates = [1.3, 0.7, 2.9].map(|f| (0..700).map(|i| (f * f64::from(i)).sin()).collect::<Vec<f64>>());
        let mass: Vec<f64> = (0..700).map(|i| 1.5 + f64::from(i).sin()).collect();
        let mut tree = Tree::default();
        tree.build([&coordinates[0], &coordinates[1], &coordinates[2]], &mass, [1.0, 1.0], kernels, narrow_len(P));
        let mut out = vec![Action::default(); tree.blocks.len()];
        Walk { tree: &tree, kernels, opening, depth: true }.run(&mut out);
        // What stands in the empty places of blocks means nothing.
        for (action, order) in out.iter_mut().zip(&tree.order) {
            for i in (0..order.len()).filter(|i| order[*i] == NOBODY) {
                action.pull.0.iter_mut().for_each(|component| component[i] = 0.0);
            }
        }
        out
    }

    #[test]
    fn every_level_gives_the_same_bytes() {
        let bits =
            |field: &[Action]| -> Vec<u64> { field.iter().flat_map(|a| a.pull.0.concat()).map(f64::to_bits).collect() };
        for opening in [0.0, 0.7] {
            let plain = (
                field::<6>(&Kernels::at::<6>(Level::Scalar), opening),
                field::<8>(&Kernels::at::<8>(Level::Scalar), opening),
            );
            for level in Level::available() {
                assert!(bits(&field::<6>(&Kernels::at::<6>(level), opening)) == bits(&plain.0), "{}", level.name());
                assert!(bits(&field::<8>(&Kernels::at::<8>(level), opening)) == bits(&plain.1), "{}", level.name());
            }
        }
    }

    /// What the order leaves out of the field falls as the power order + 1 of the opening.
    #[test]
    fn error_falls_with_the_opening_as_its_order_says() {
        let exact = field::<6>(&Kernels::fastest::<6>(), 0.0);
        let rms = |f: &[Action]| {
            let squares = f.iter().zip(&exact).flat_map(|(a, b)| {
                let (a, b) = (a.pull.0.concat(), b.pull.0.concat());
                (0..a.len()).map(|i| (a[i] - b[i]).powi(2)).collect::<Vec<_>>()
            });
            squares.sum::<f64>().sqrt()
        };
        let slope = |wide: &[Action], narrow: &[Action]| (rms(wide) / rms(narrow)).log2();
        let (low, high) = (Kernels::fastest::<6>(), Kernels::fastest::<8>());
        let of_six = slope(&field::<6>(&low, 0.8), &field::<6>(&low, 0.4));
        let of_eight = slope(&field::<8>(&high, 0.8), &field::<8>(&high, 0.4));
        assert!((6.0..9.5).contains(&of_six) && (8.0..12.5).contains(&of_eight), "{of_six} {of_eight}");
    }
}
