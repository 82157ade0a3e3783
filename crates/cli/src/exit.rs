//! How a command ends: its exit code and what it says on stderr.

use miette::{Diagnostic, GraphicalReportHandler, GraphicalTheme};
use std::io::IsTerminal;
use std::process::ExitCode;

/// A command that did what was asked.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Done {
    /// Exit code 0.
    Clean,
    /// Exit code 3: done, with a warning that the user must look at.
    LookAt,
}

/// A command that did not.
#[derive(Debug)]
pub enum Stop {
    /// Exit code 2: bad arguments or input.
    Input(miette::Report),
    /// Exit code 1: it failed.
    Failed(miette::Report),
    /// Exit code 130: interrupted; what was computed is on disk.
    Interrupted(String),
}

/// A diagnostic of words alone, for errors that have no place in a file.
#[derive(Debug, thiserror::Error)]
#[error("{message}")]
struct Words {
    message: String,
    help: Option<String>,
}

impl Diagnostic for Words {
    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        self.help.as_ref().map(|h| Box::new(h) as Box<dyn std::fmt::Display>)
    }
}

fn words(message: impl Into<String>, help: impl Into<String>) -> miette::Report {
    let help = help.into();
    miette::Report::new(Words {
        message: message.into(),
        help: (!help.is_empty()).then_some(help),
    })
}

impl Stop {
    /// Bad input: what is wrong and what to do next.
    pub fn input(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Input(words(message, help))
    }

    /// A failure: what went wrong and what to do next.
    pub fn failed(message: impl Into<String>, help: impl Into<String>) -> Self {
        Self::Failed(words(message, help))
    }

    fn code(&self) -> u8 {
        match self {
            Self::Failed(_) => 1,
            Self::Input(_) => 2,
            Self::Interrupted(_) => 130,
        }
    }
}

impl From<dip_case::CaseError> for Stop {
    fn from(error: dip_case::CaseError) -> Self {
        Self::Input(miette::Report::new(error))
    }
}

/// Prints what there is to say and turns the outcome into an exit code.
pub fn finish(outcome: Result<Done, Stop>) -> ExitCode {
    match outcome {
        Ok(Done::Clean) => ExitCode::SUCCESS,
        Ok(Done::LookAt) => ExitCode::from(3),
        Err(stop) => {
            match &stop {
                Stop::Input(report) | Stop::Failed(report) => eprintln!("{}", render(report)),
                Stop::Interrupted(words) => eprintln!("interrupted: {words}"),
            }
            ExitCode::from(stop.code())
        }
    }
}

/// The report as text: the first line says it all for scripts, the picture of the place follows.
fn render(report: &miette::Report) -> String {
    let theme = if std::io::stderr().is_terminal() {
        GraphicalTheme::unicode()
    } else {
        GraphicalTheme::unicode_nocolor()
    };
    let handler = GraphicalReportHandler::new_themed(theme)
        .with_width(120)
        .with_links(false);
    let mut text = format!("error: {report}\n");
    let mut picture = String::new();
    if report.labels().is_some() && handler.render_report(&mut picture, report.as_ref()).is_ok() {
        // The picture repeats the message; keep only what stands below it.
        if let Some(at) = picture.find('╭') {
            let start = picture[..at].rfind('\n').map_or(0, |i| i + 1);
            text.push_str(&picture[start..]);
            return text.trim_end().to_owned();
        }
    }
    if let Some(help) = report.help() {
        text.push_str(&format!("  help: {help}"));
    }
    text.trim_end().to_owned()
}
