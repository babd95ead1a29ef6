//! A unit of FMI 2.0 made for the tests with the system's C compiler, which linking Rust needs too.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::Command;
use toolroom_fmu_import::Platform;

const DESCRIPTION: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="wear" guid="{wear}" numberOfEventIndicators="0">
  <CoSimulation modelIdentifier="wear" canHandleVariableCommunicationStepSize="true" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <UnitDefinitions>
    <Unit name="m/min"><BaseUnit m="1" s="-1" factor="0.016666666666666666"/></Unit>
    <Unit name="mm"><BaseUnit m="1" factor="0.001"/></Unit>
  </UnitDefinitions>
  <LogCategories><Category name="logAll"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="60" stepSize="1"/>
  <ModelVariables>
    <ScalarVariable name="cut.cutting_speed" valueReference="1" causality="input" variability="continuous"><Real unit="m/min" start="30"/></ScalarVariable>
    <ScalarVariable name="cut.engaged" valueReference="4" causality="input" variability="discrete"><Boolean start="true"/></ScalarVariable>
    <ScalarVariable name="tool.VB" valueReference="2" causality="output" variability="continuous" initial="calculated"><Real unit="mm"/></ScalarVariable>
    <ScalarVariable name="tool.worn" valueReference="5" causality="output" variability="discrete" initial="calculated"><Boolean/></ScalarVariable>
    <ScalarVariable name="rate" valueReference="3" causality="parameter" variability="tunable"><Real start="1e-6"/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="3"/><Unknown index="4"/></Outputs>
    <InitialUnknowns><Unknown index="3"/><Unknown index="4"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>"#;

/// The unit as an FMU in `folder`, compiled with `switches`, its description changed from → to.
pub fn unit(folder: &Path, switches: &[&str], change: (&str, &str)) -> PathBuf {
    let changes = [change];
    changed(folder, switches, if change.0.is_empty() { &[] } else { &changes })
}

/// The unit, with several changes of its description.
pub fn changed(folder: &Path, switches: &[&str], changes: &[(&str, &str)]) -> PathBuf {
    let mut description = DESCRIPTION.to_owned();
    for (from, to) in changes {
        assert!(description.contains(from), "{from} is in the description");
        description = description.replacen(from, to, 1);
    }
    compiled(folder, "wear", include_str!("wear.c"), &description, switches, 2)
}

/// A unit of FMI `major` from a file of C, compiled with `switches`.
pub fn compiled(folder: &Path, name: &str, source: &str, description: &str, switches: &[&str], major: u8) -> PathBuf {
    let (library, file) = (folder.join(format!("{name}.so")), folder.join(format!("{name}.c")));
    std::fs::write(&file, source).expect("writable");
    let compiled = Command::new("cc")
        .args(["-shared", "-fPIC", "-O1", "-w", "-fvisibility=hidden", "-o"])
        .arg(&library)
        .args(switches.iter().map(|switch| format!("-D{switch}")))
        .arg(&file)
        .status()
        .expect("a C compiler");
    assert!(compiled.success());
    let path = folder.join(format!("{name}.fmu"));
    let mut zip = zip::ZipWriter::new(std::fs::File::create(&path).expect("writable"));
    let host = Platform::host().expect("tests run on a known platform");
    let binary = format!("binaries/{}/{name}{}", host.folder(major), std::env::consts::DLL_SUFFIX);
    let bytes = std::fs::read(&library).expect("compiled");
    for (name, bytes) in [("modelDescription.xml", description.as_bytes()), (&binary, &bytes)] {
        zip.start_file(name, zip::write::SimpleFileOptions::default()).expect("an entry");
        zip.write_all(bytes).expect("an entry");
    }
    zip.finish().expect("a zip file");
    path
}
