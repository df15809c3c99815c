//! Progress on stderr: a bar on a terminal, a plain line now and then elsewhere; Ctrl-C and SIGTERM end the work.

use std::io::IsTerminal as _;
use std::sync::OnceLock;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use super::CliError;
use crate::evolve::driver::MYR_S;
use crate::evolve::{Observer, Progress};

static INTERRUPTED: AtomicBool = AtomicBool::new(false);
static LEAVES: OnceLock<Leaves> = OnceLock::new();

/// Time between two plain lines.
const LINE_EVERY: Duration = Duration::from_secs(10);

/// How long work that has been asked to stop may take to its next safe point. Batch systems kill soon after they have asked.
const GRACE: Duration = Duration::from_millis(1500);

/// What an end by the user leaves behind.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Leaves {
    /// A run whose transactions are all on disk.
    Run,
    /// Nothing: the result is written at the end.
    Nothing,
    /// A page as it was at the last look.
    Page,
}

impl Leaves {
    /// The last words.
    fn message(self) -> &'static str {
        match self {
            Self::Run => "interrupted; what was done until now is saved and --resume goes on",
            Self::Nothing => "interrupted; nothing was written, and the work begins anew next time",
            Self::Page => "interrupted; the page shows the run as it was at the last look",
        }
    }
}

/// Takes over Ctrl-C and SIGTERM: the first asks, see [`is_interrupted`], and ends the process itself if the work does not get
/// to a safe point within [`GRACE`]; the second ends it at once.
///
/// That is no worse than a kill, which everything on disk survives: transactions are whole or not there, and other files are
/// written aside and renamed.
pub(super) fn catch_interrupt(leaves: Leaves) -> Result<(), CliError> {
    let _ = LEAVES.set(leaves);
    ctrlc::set_handler(|| {
        if INTERRUPTED.swap(true, Ordering::SeqCst) {
            std::process::exit(130);
        }
        std::thread::spawn(|| {
            std::thread::sleep(GRACE);
            eprintln!("{}", last_words());
            std::process::exit(130);
        });
    })
    .map_err(CliError::input)
}

/// What an interrupted process has to say.
pub(super) fn last_words() -> &'static str {
    LEAVES.get().copied().unwrap_or(Leaves::Nothing).message()
}

/// Whether the user has asked this process to stop.
pub(super) fn is_interrupted() -> bool {
    INTERRUPTED.load(Ordering::Relaxed)
}

/// Reports a run to the person who started it.
pub(super) struct Reporter {
    bar: Option<ProgressBar>,
    last_line: Option<Instant>,
    // When this process saw its first leg, and at which evolution time.
    first_leg: Option<(Instant, f64)>,
}

impl Reporter {
    /// Starts reporting and takes over Ctrl-C, see [`catch_interrupt`].
    pub(super) fn start(leaves: Leaves) -> Result<Self, CliError> {
        catch_interrupt(leaves)?;
        let bar = std::io::stderr().is_terminal().then(|| {
            let style = ProgressStyle::with_template("{bar:24} {percent:>3} % {msg}").expect("a valid template");
            ProgressBar::new(1000).with_style(style)
        });
        Ok(Self { bar, last_line: None, first_leg: None })
    }

    fn show(&mut self, fraction: f64, message: &str) {
        if let Some(bar) = &self.bar {
            bar.set_position((1000.0 * fraction) as u64);
            bar.set_message(message.to_owned());
        } else if self.last_line.is_none_or(|last| last.elapsed() >= LINE_EVERY) {
            eprintln!("{message}");
            self.last_line = Some(Instant::now());
        }
    }
}

impl Observer for Reporter {
    fn progress(&mut self, progress: Progress) {
        match progress {
            Progress::Building { stretches } => {
                self.show(0.0, &format!("compacting the aggregate, stretch {}", stretches + 1))
            }
            Progress::Settling { rotations } => self.show(0.0, &format!("settling, rotation {rotations}")),
            Progress::Evolving { t_s, end_s, omega, obliquity, legs, movements } => {
                let period_h = std::f64::consts::TAU / omega / 3600.0;
                let (start, start_s) = *self.first_leg.get_or_insert((Instant::now(), t_s));
                let left = if t_s > start_s {
                    let seconds = start.elapsed().as_secs_f64() * (end_s - t_s) / (t_s - start_s);
                    format!(", about {} left", duration(seconds))
                } else {
                    String::new()
                };
                let message = format!(
                    "{:.4} of {:.4} Myr, period {period_h:.4} h, obliquity {:.2} deg, {legs} legs, {movements} movements{left}",
                    t_s / MYR_S,
                    end_s / MYR_S,
                    obliquity.to_degrees(),
                );
                self.show((t_s / end_s).min(1.0), &message);
            }
        }
    }

    fn interrupted(&self) -> bool {
        is_interrupted()
    }

    fn warn(&mut self, message: &str) {
        match &self.bar {
            Some(bar) => bar.println(format!("warning: {message}")),
            None => eprintln!("warning: {message}"),
        }
    }
}

impl Drop for Reporter {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// `3 h 12 min`, `41 s`.
fn duration(seconds: f64) -> String {
    let s = seconds.round() as u64;
    match s {
        0..60 => format!("{s} s"),
        60..3600 => format!("{} min", s / 60),
        _ => format!("{} h {} min", s / 3600, s / 60 % 60),
    }
}
