//! The vector instructions of the processor, asked for once.
//!
//! Every level gives the same bytes: sums run over eight lanes in the same order whatever the width of a register, products are
//! fused where they are fused at every level, and square roots and divisions round correctly everywhere. So a run may go on
//! on another machine.

use std::sync::OnceLock;

/// Environment variable that forces a level: `scalar`, `sse2` (what x86-64 always has, the same code), `avx2`, `avx512`.
pub const VARIABLE: &str = "YORP_SIMD";

/// A set of vector instructions that kernels are compiled for, in rising order.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub enum Level {
    /// What every processor of the architecture has. Where that lacks fused products they are made by a library: slow and exact.
    Scalar,
    /// AVX2 with FMA: x86-64-v3.
    #[cfg(target_arch = "x86_64")]
    Avx2,
    /// AVX-512 with the parts F, VL and DQ: x86-64-v4.
    #[cfg(target_arch = "x86_64")]
    Avx512,
}

/// A level that was asked for and cannot be had.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum LevelError {
    /// No level has this name.
    #[error("{VARIABLE} is `{0}`; it takes scalar, sse2, avx2 or avx512")]
    Unknown(String),
    /// The processor lacks its instructions.
    #[error("{VARIABLE} asks for {asked}, and this processor has {present} at most")]
    Missing {
        /// Name of the level.
        asked: String,
        /// Name of the highest level that it has.
        present: &'static str,
    },
}

impl Level {
    /// Its name.
    pub fn name(self) -> &'static str {
        match self {
            Self::Scalar => "scalar",
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => "avx2",
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => "avx512",
        }
    }

    /// The highest level of this processor.
    pub fn present() -> Self {
        #[cfg(target_arch = "x86_64")]
        {
            use std::arch::is_x86_feature_detected as has;
            if has!("avx2") && has!("fma") {
                let more = has!("avx512f") && has!("avx512vl") && has!("avx512dq");
                return if more { Self::Avx512 } else { Self::Avx2 };
            }
        }
        Self::Scalar
    }

    /// All levels of this processor, the highest last.
    pub fn available() -> Vec<Self> {
        #[cfg(target_arch = "x86_64")]
        let all = [Self::Scalar, Self::Avx2, Self::Avx512];
        #[cfg(not(target_arch = "x86_64"))]
        let all = [Self::Scalar];
        all.into_iter().filter(|level| *level <= Self::present()).collect()
    }

    /// The level that kernels run at: the one that [`VARIABLE`] names, else the highest.
    ///
    /// # Errors
    /// The variable names no level, or one that this processor lacks.
    pub fn asked() -> Result<Self, LevelError> {
        let Some(name) = std::env::var_os(VARIABLE) else { return Ok(Self::present()) };
        let name = name.to_string_lossy().into_owned();
        let level = match name.as_str() {
            "" => return Ok(Self::present()),
            "scalar" => Self::Scalar,
            #[cfg(target_arch = "x86_64")]
            "sse2" => Self::Scalar,
            #[cfg(target_arch = "x86_64")]
            "avx2" => Self::Avx2,
            #[cfg(target_arch = "x86_64")]
            "avx512" => Self::Avx512,
            _ => return Err(LevelError::Unknown(name)),
        };
        let present = Self::present();
        if level <= present { Ok(level) } else { Err(LevelError::Missing { asked: name, present: present.name() }) }
    }

    /// The same, asked for once; a wrong name counts as none, programs refuse it by [`Self::asked`] first.
    pub(crate) fn in_use() -> Self {
        static LEVEL: OnceLock<Level> = OnceLock::new();
        *LEVEL.get_or_init(|| Self::asked().unwrap_or_else(|_| Self::present()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_plain_level_is_always_there_and_the_present_one_is_the_highest() {
        let levels = Level::available();
        assert_eq!((levels[0], *levels.last().unwrap()), (Level::Scalar, Level::present()));
        assert!(levels.windows(2).all(|pair| pair[0] < pair[1]));
    }
}
