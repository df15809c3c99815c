//! Compiles the C shim between REBOUND and the shed bodies, and notes the commit of the source.

use std::process::Command;

fn main() {
    let shim = "src/shed/shim.c";
    println!("cargo:rerun-if-changed={shim}");
    // Set by librebound-sys, which builds REBOUND itself.
    let include = std::env::var("DEP_REBOUND_INCLUDE").expect("librebound-sys says where its headers are");
    cc::Build::new()
        .include(include)
        .file(shim)
        .flag_if_supported("-std=c99")
        .flag_if_supported("-ffp-contract=off")
        .compile("yorp_shed");
    note_commit();
}

/// Sets `YORP_COMMIT` for the compiler: that of the environment, else what git says, else "unknown", as in a source archive.
fn note_commit() {
    println!("cargo:rerun-if-env-changed=YORP_COMMIT");
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
        String::from_utf8(output.stdout).ok().map(|text| text.trim().to_owned())
    };
    // The log of HEAD grows with every commit and checkout, whatever branch that is.
    for path in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", path]).filter(|path| std::path::Path::new(path).exists()) {
            println!("cargo:rerun-if-changed={path}");
        }
    }
    let commit = std::env::var("YORP_COMMIT").ok().or_else(|| git(&["rev-parse", "--short=10", "HEAD"]));
    println!("cargo:rustc-env=YORP_COMMIT={}", commit.unwrap_or_else(|| "unknown".to_owned()));
}
