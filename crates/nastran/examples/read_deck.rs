//! Reads a deck and prints what it holds and what was noted: `cargo run --example read_deck -- DECK.bdf`

use std::process::ExitCode;

use dip_nastran::Deck;

fn main() -> ExitCode {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("usage: read_deck DECK.bdf");
        return ExitCode::from(2);
    };
    match Deck::read(&path) {
        Ok(deck) => {
            for note in &deck.notes {
                eprintln!("{note}");
            }
            println!(
                "{} grids, {} bars, {} shells, {} panels, {} Mach-k pairs, {} flutter requests, {} subcases",
                deck.bulk.grids.len(),
                deck.bulk.bars.len(),
                deck.bulk.shells.len(),
                deck.bulk.panels.len(),
                deck.bulk.mach_k.len(),
                deck.bulk.flutters.len(),
                deck.control.subcases.len(),
            );
            ExitCode::SUCCESS
        }
        Err(errors) => {
            eprintln!("{errors}");
            ExitCode::from(2)
        }
    }
}
