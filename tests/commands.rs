//! The programs as their users meet them: exit codes, messages, files.

mod commands {
    pub mod bad_input;
    pub mod correct;
    pub mod deck;
    pub mod flutter;
    pub mod grid_files;
    pub mod march;
    pub mod mesh;
    pub mod pitch;
    pub mod recording;
    pub mod setup;
    pub mod steady;
    pub mod steady_faults;
    pub mod study;
}
