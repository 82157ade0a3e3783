//! Solves a deck and prints modes, summaries and crossings: `cargo run --release --example solve_deck -- DECK.bdf [--qhh]`

use std::process::ExitCode;

fn main() -> ExitCode {
    let mut arguments = std::env::args().skip(1);
    let Some(path) = arguments.next() else {
        eprintln!("usage: solve_deck DECK.bdf [--qhh]");
        return ExitCode::from(2);
    };
    let solution = match dip_deck::run(&path) {
        Ok(solution) => solution,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::from(2);
        }
    };
    for note in &solution.notes {
        eprintln!("{note}");
    }
    print!("{}", solution.text());
    if arguments.any(|a| a == "--qhh") {
        let mut text = String::new();
        for subcase in &solution.subcases {
            let _ = dip_deck::print::generalized_forces(&mut text, &subcase.forces);
        }
        print!("{text}");
    }
    ExitCode::SUCCESS
}
