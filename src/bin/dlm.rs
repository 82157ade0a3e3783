//! The `dlm` command; everything it does lives in `crates/cli`.
fn main() -> std::process::ExitCode {
    dip_cli::dlm::main()
}
