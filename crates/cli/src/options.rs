//! Options that all commands share.

use crate::exit::Stop;
use dip_case::Document;
use std::path::{Path, PathBuf};

/// Options that every command which computes something takes.
#[derive(Debug, Clone, clap::Args)]
pub struct Common {
    /// Folder for the results (default: runs/<case folder>-<case file>)
    #[arg(long, value_name = "DIR")]
    pub out: Option<PathBuf>,
    /// Write over an older finished run
    #[arg(long)]
    pub force: bool,
    /// Override a key of the case file, as in --set lattice.chordwise=20 (repeatable)
    #[arg(long = "set", value_name = "KEY=VALUE")]
    pub set: Vec<String>,
    /// Print the summary as JSON on stdout
    #[arg(long)]
    pub json: bool,
    /// Threads to use (default: all cores); results do not depend on it
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Say nothing on stderr but warnings (the reasons of exit code 3) and errors
    #[arg(short, long)]
    pub quiet: bool,
    /// Say more on stderr (repeat for more)
    #[arg(short, long, action = clap::ArgAction::Count)]
    pub verbose: u8,
}

impl Common {
    /// Sets up threads and messages. Call once, first.
    ///
    /// # Errors
    /// `--threads 0`.
    pub fn start(&self) -> Result<(), Stop> {
        let level = match (self.quiet, self.verbose) {
            // Exit code 3 asks the user to look at a warning: that must be there to look at.
            (true, _) => tracing::Level::WARN,
            (false, 0) => tracing::Level::INFO,
            (false, 1) => tracing::Level::DEBUG,
            (false, _) => tracing::Level::TRACE,
        };
        let messages = tracing_subscriber::fmt()
            .with_max_level(level)
            .with_writer(std::io::stderr)
            .with_ansi(std::io::IsTerminal::is_terminal(&std::io::stderr()))
            .without_time()
            .with_target(false)
            .finish();
        // A second call (two commands in one process, in tests) keeps the first set-up.
        let _ = tracing::subscriber::set_global_default(messages);
        if let Some(n) = self.threads {
            if n == 0 {
                return Err(Stop::input(
                    "--threads 0: needed 1 or more",
                    "leave it out to use all cores",
                ));
            }
            let _ = rayon::ThreadPoolBuilder::new().num_threads(n).build_global();
        }
        Ok(())
    }

    /// Reads a case file with the overrides of `--set`.
    ///
    /// # Errors
    /// As [`Document::read`].
    pub fn document(&self, case: &Path) -> Result<Document, Stop> {
        Ok(Document::read(case, &self.set)?)
    }

    /// Where the results of a case go.
    pub fn folder(&self, case: &Path) -> PathBuf {
        match &self.out {
            Some(dir) => dir.clone(),
            None => Path::new("runs").join(case_name(case)),
        }
    }
}

/// Sets up messages for commands that take no [`Common`] options.
///
/// # Errors
/// None; the type is that of [`Common::start`].
pub fn messages(quiet: bool) -> Result<(), Stop> {
    Common {
        out: None,
        force: false,
        set: Vec::new(),
        json: false,
        threads: None,
        quiet,
        verbose: 0,
    }
    .start()
}

/// Name of a case: its folder and its file, so that `agard445/flutter.toml` and `f5/flutter.toml` stay apart.
pub fn case_name(case: &Path) -> String {
    let stem = case
        .file_stem()
        .map_or_else(|| "case".into(), |s| s.to_string_lossy().into_owned());
    let absolute = std::path::absolute(case).unwrap_or_else(|_| case.to_path_buf());
    match absolute.parent().and_then(Path::file_name) {
        Some(folder) => format!("{}-{stem}", folder.to_string_lossy()),
        None => stem,
    }
}

/// Prints the completions of a shell on stdout.
pub fn completions(command: &mut clap::Command, shell: clap_complete::Shell) {
    let mut script = Vec::new();
    let name = command.get_name().to_owned();
    clap_complete::generate(shell, command, name, &mut script);
    crate::output::print(&String::from_utf8_lossy(&script));
}
