//! Compiles the C shim between REBOUND and the shed bodies.

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
}
