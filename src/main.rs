//! The `yorp` program: everything is in the library.

fn main() -> std::process::ExitCode {
    yorp::cli::main().into()
}
