//! The stack of the WebAssembly module.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    if std::env::var("CARGO_CFG_TARGET_FAMILY").is_ok_and(|family| family == "wasm") {
        // Xacro recurses over its document; the default of 1 MiB is soon used up.
        println!("cargo::rustc-link-arg-cdylib=-zstack-size=16777216");
    }
}
