//! What a failed command tells the user and the shell: a report on stderr and an exit code.

use miette::{Diagnostic, IntoDiagnostic, LabeledSpan, NamedSource, Report, SourceCode};

use crate::evolve::EvolveError;
use crate::exchange::{AggregateFileError, MeshFileError, RefusedOutput, UnknownFormat, WriteError};
use crate::export::ExportError;
use crate::report::figures::SaveError;
use crate::scene::SceneError;
use crate::shed::ShedError;
use crate::store::StoreError;

/// Why a command ended without its result.
#[derive(Debug)]
pub struct CliError {
    /// Exit code of the process.
    pub code: Failure,
    /// What to tell the user.
    pub report: Report,
}

/// Exit codes other than 0.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(u8)]
pub enum Failure {
    /// Anything wrong with arguments or inputs.
    Input = 2,
    /// Something became non-finite or unstable.
    Numerical = 3,
    /// Writing failed.
    Write = 4,
    /// Interrupted, state saved.
    Interrupted = 130,
}

impl CliError {
    /// Wrong arguments or inputs: exit code 2.
    pub fn input(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::new(Failure::Input, error)
    }

    /// A numerical failure: exit code 3.
    pub fn numerical(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::new(Failure::Numerical, error)
    }

    /// Writing failed: exit code 4.
    pub fn write(error: impl std::error::Error + Send + Sync + 'static) -> Self {
        Self::new(Failure::Write, error)
    }

    /// Any of them, with its chain of causes.
    pub fn new(code: Failure, error: impl std::error::Error + Send + Sync + 'static) -> Self {
        let report = Err::<(), _>(error).into_diagnostic().expect_err("built as an error");
        Self { code, report }
    }

    /// Wrong arguments or inputs in one sentence: exit code 2.
    pub fn refused(message: impl Into<String>) -> Self {
        Self { code: Failure::Input, report: Report::msg(message.into()) }
    }
}

impl CliError {
    /// The user has asked to stop.
    pub(super) fn interrupted() -> Self {
        Self { code: Failure::Interrupted, report: Report::msg(super::progress::last_words()) }
    }
}

impl From<SceneError> for CliError {
    fn from(error: SceneError) -> Self {
        Self { code: Failure::Input, report: Report::new(ShownScene::new(error)) }
    }
}

impl From<AggregateFileError> for CliError {
    fn from(error: AggregateFileError) -> Self {
        Self::input(error)
    }
}

impl From<MeshFileError> for CliError {
    fn from(error: MeshFileError) -> Self {
        Self::input(error)
    }
}

impl From<UnknownFormat> for CliError {
    fn from(error: UnknownFormat) -> Self {
        Self::input(error)
    }
}

impl From<RefusedOutput> for CliError {
    fn from(error: RefusedOutput) -> Self {
        match error {
            // As if writing had been tried.
            RefusedOutput::NoFolder(_) => Self::write(error),
            _ => Self::input(error),
        }
    }
}

impl From<WriteError> for CliError {
    fn from(error: WriteError) -> Self {
        Self::write(error)
    }
}

impl From<StoreError> for CliError {
    fn from(error: StoreError) -> Self {
        let code = if error.is_write_failure() { Failure::Write } else { Failure::Input };
        Self::new(code, error)
    }
}

impl From<SaveError> for CliError {
    fn from(error: SaveError) -> Self {
        match error {
            SaveError::Write(error) => Self::write(error),
            // The drawing library fails at nothing that depends on the run; whatever it is, no picture has been written.
            SaveError::Figure(error) => Self::write(error),
        }
    }
}

impl From<ExportError> for CliError {
    fn from(error: ExportError) -> Self {
        match error {
            ExportError::Write(error) => Self::write(error),
            _ => Self::input(error),
        }
    }
}

impl From<ShedError> for CliError {
    fn from(error: ShedError) -> Self {
        match error {
            ShedError::Rebound { .. }
            | ShedError::BecameNonFinite { .. }
            | ShedError::StepVanished { .. }
            | ShedError::EnergyNotKept { .. } => Self::numerical(error),
            _ => Self::input(error),
        }
    }
}

impl From<EvolveError> for CliError {
    fn from(error: EvolveError) -> Self {
        let code = match &error {
            EvolveError::Interrupted => Failure::Interrupted,
            EvolveError::Store(store) if store.is_write_failure() => Failure::Write,
            EvolveError::Store(_) | EvolveError::AggregateFile(_) | EvolveError::MeshFile(_) => Failure::Input,
            EvolveError::Reshaped { .. }
            | EvolveError::Unit { .. }
            | EvolveError::TooFast { .. }
            | EvolveError::NoRotation
            | EvolveError::Aggregate(_)
            | EvolveError::Contact(_) => Failure::Input,
            EvolveError::Shed(_)
            | EvolveError::Dynamics(_)
            | EvolveError::Tiling(_)
            | EvolveError::Surface { .. }
            | EvolveError::Torque(_)
            | EvolveError::Spin(_) => Failure::Numerical,
            EvolveError::BrokeUpWhileSettling { .. } => Failure::Numerical,
        };
        if code == Failure::Interrupted {
            return Self::interrupted();
        }
        Self::new(code, error)
    }
}

/// A scene error with the line it is about.
#[derive(Debug)]
struct ShownScene {
    error: SceneError,
    source: Option<NamedSource<String>>,
}

/// A scene on one long line is not shown, only its place.
const LONGEST_SHOWN_LINE: usize = 400;

impl ShownScene {
    fn new(error: SceneError) -> Self {
        let source = error.location().and_then(|at| {
            let shown =
                at.text.lines().skip(at.line.saturating_sub(2)).take(3).all(|line| line.len() <= LONGEST_SHOWN_LINE);
            shown.then(|| NamedSource::new(at.file.display().to_string(), at.text.to_string()).with_language("json"))
        });
        Self { error, source }
    }
}

impl std::fmt::Display for ShownScene {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        self.error.fmt(f)
    }
}

impl std::error::Error for ShownScene {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.error.source()
    }
}

impl Diagnostic for ShownScene {
    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.source.as_ref().map(|source| source as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let at = self.error.location()?;
        Some(Box::new(std::iter::once(LabeledSpan::at_offset(at.offset, "here"))))
    }
}
