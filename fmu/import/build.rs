//! Compiles the logger of FMI 2.0, whose list of arguments is one of C.

fn main() {
    #[cfg(feature = "fmi")]
    {
        println!("cargo::rerun-if-changed=src/instance/logger.c");
        cc::Build::new().file("src/instance/logger.c").compile("toolroom_fmi2_logger");
    }
}
