//! Packages as they are read: nested systems, start values, and every fault at its place.

mod packed;

use packed::with_units;
use std::path::PathBuf;
use tempfile::TempDir;
use toolroom_ssp::{Package, SspError};

/// A cell with a nested system; connections lead through the connectors of both.
const NESTED: &str = r#"<ssd:SystemStructureDescription name="cell" version="2.0">
  <ssd:System name="cell">
    <ssd:ParameterBindings><ssd:ParameterBinding source="resources/cell.ssv"/></ssd:ParameterBindings>
    <ssd:Connectors><ssd:Connector name="wear" kind="output"><ssc:Real unit="m"/></ssd:Connector></ssd:Connectors>
    <ssd:Elements>
      <ssd:Component name="controller" source="resources/controller.fmu">
        <ssd:Connectors>
          <ssd:Connector name="force" kind="input"><ssc:Real/></ssd:Connector>
          <ssd:Connector name="speed" kind="output"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
      </ssd:Component>
      <ssd:System name="machine">
        <ssd:Connectors>
          <ssd:Connector name="command" kind="input"><ssc:Real/></ssd:Connector>
          <ssd:Connector name="VB" kind="output"><ssc:Real/></ssd:Connector>
          <ssd:Connector name="F" kind="output"><ssc:Real/></ssd:Connector>
        </ssd:Connectors>
        <ssd:Elements>
          <ssd:Component name="lathe" source="resources/lathe.fmu">
            <ssd:Connectors>
              <ssd:Connector name="vc" kind="input"><ssc:Real unit="m/min"/></ssd:Connector>
              <ssd:Connector name="VB" kind="output"><ssc:Real unit="mm"/></ssd:Connector>
              <ssd:Connector name="Ff" kind="output"><ssc:Real/></ssd:Connector>
            </ssd:Connectors>
            <ssd:ParameterBindings><ssd:ParameterBinding><ssd:ParameterValues>
              <ssv:ParameterSet version="2.0" name="inner"><ssv:Parameters>
                <ssv:Parameter name="hardness"><ssv:Real value="200"/></ssv:Parameter>
                <ssv:Parameter name="tool"><ssv:String value="c45_t15k6"/></ssv:Parameter>
              </ssv:Parameters></ssv:ParameterSet>
            </ssd:ParameterValues></ssd:ParameterBinding></ssd:ParameterBindings>
          </ssd:Component>
        </ssd:Elements>
        <ssd:Connections>
          <ssd:Connection startConnector="command" endElement="lathe" endConnector="vc"/>
          <ssd:Connection startElement="lathe" startConnector="VB" endConnector="VB"/>
          <ssd:Connection startElement="lathe" startConnector="Ff" endConnector="F">
            <ssc:LinearTransformation factor="2" offset="3"/>
          </ssd:Connection>
        </ssd:Connections>
      </ssd:System>
    </ssd:Elements>
    <ssd:Connections>
      <ssd:Connection startElement="controller" startConnector="speed" endElement="machine" endConnector="command" suppressUnitConversion="true"/>
      <ssd:Connection startElement="machine" startConnector="F" endElement="controller" endConnector="force">
        <ssc:LinearTransformation factor="10" offset="1"/>
      </ssd:Connection>
      <ssd:Connection startElement="machine" startConnector="VB" endConnector="wear"/>
    </ssd:Connections>
  </ssd:System>
  <ssd:Units><ssc:Unit name="m"><ssc:BaseUnit m="1"/></ssc:Unit><ssc:Unit name="m/min"><ssc:BaseUnit m="1" s="-1" factor="0.016666666666666666"/></ssc:Unit><ssc:Unit name="mm"><ssc:BaseUnit m="1" factor="0.001"/></ssc:Unit></ssd:Units>
  <ssd:DefaultExperiment startTime="0" stopTime="600"/>
</ssd:SystemStructureDescription>"#;

const VALUES: &str = r#"<ssv:ParameterSet version="2.0" name="cell"><ssv:Parameters>
  <ssv:Parameter name="machine.lathe.hardness"><ssv:Real value="240" unit="HB"/></ssv:Parameter>
  <ssv:Parameter name="controller.mode"><ssv:Integer value="1"/></ssv:Parameter>
</ssv:Parameters></ssv:ParameterSet>"#;

/// A package with this structure, texts by name, and empty entries in the place of units.
fn packed(structure: &str, texts: &[(&str, &str)], units: &[&str]) -> (TempDir, PathBuf) {
    let units = units.iter().map(|name| (*name, Vec::new()));
    let texts = texts.iter().map(|(name, text)| (*name, text.as_bytes().to_vec()));
    with_units(structure, &texts.chain(units).collect::<Vec<_>>())
}

const UNITS: [&str; 2] = ["resources/controller.fmu", "resources/lathe.fmu"];

#[test]
fn nested_systems_are_resolved_with_their_transformations() {
    let (_folder, path) = packed(NESTED, &[("resources/cell.ssv", VALUES)], &UNITS);
    let package = Package::open(&path).expect("a sound package");
    let structure = package.structure();
    let names: Vec<&str> = structure.components.iter().map(|component| component.name.as_str()).collect();
    assert_eq!(names, ["controller", "machine.lathe"]);
    let signals: Vec<String> =
        package.listing().lines().filter(|line| line.contains("->")).map(str::to_owned).collect();
    assert_eq!(
        signals,
        [
            "  controller.speed -> machine.lathe.vc",
            // 10 (2 F + 3) + 1
            "  machine.lathe.Ff -> controller.force  × 20 + 31"
        ]
    );
    assert_eq!(structure.connections.iter().map(|each| each.converts).collect::<Vec<_>>(), [false, true]);
    let [wear] = &structure.boundary[..] else { panic!("one output of the system") };
    assert_eq!((wear.name.as_str(), wear.ends.len(), wear.ends[0].component), ("wear", 1, 1));
    assert_eq!(structure.stop, Some(600.0));
    assert!((structure.units["m/min"].factor * 60.0 - 1.0).abs() < 1e-15);
    // What an outer system binds takes precedence: it comes later.
    let lathe: Vec<(&str, &str)> =
        structure.components[1].parameters.iter().map(|each| (each.name.as_str(), each.value.as_str())).collect();
    assert_eq!(lathe, [("hardness", "200"), ("tool", "c45_t15k6"), ("hardness", "240")]);
}

/// Faults of the structure with `from` replaced by `to`.
fn faults(from: &str, to: &str) -> Vec<String> {
    assert!(NESTED.contains(from), "{from}");
    let (_folder, path) = packed(&NESTED.replacen(from, to, 1), &[("resources/cell.ssv", VALUES)], &UNITS);
    match Package::open(&path) {
        Err(SspError::Faults { faults, .. }) => faults.iter().map(ToString::to_string).collect(),
        other => panic!("{to}: {other:?}"),
    }
}

#[test]
fn every_fault_has_its_entry_and_line() {
    for (from, to, said) in [
        ("endConnector=\"vc\"", "endConnector=\"v\"", "SystemStructure.ssd:34: machine.lathe has no input \"v\""),
        ("startConnector=\"speed\"", "startConnector=\"force\"", "controller has no output \"force\""),
        (
            "resources/lathe.fmu",
            "resources/mill.fmu",
            "SystemStructure.ssd:19: source = \"resources/mill.fmu\": there is",
        ),
        ("source=\"resources/cell.ssv\"", "source=\"other.ssv\"", "SystemStructure.ssd:3: source = \"other.ssv\": "),
        ("stopTime=\"600\"", "stopTime=\"ten\"", "stopTime = \"ten\" is no number"),
        ("name=\"controller\" source", "name=\"machine.lathe\" source", "there are two elements of the name"),
        (
            "<ssc:LinearTransformation factor=\"10\" offset=\"1\"/>",
            "<ssc:BooleanMappingTransformation/>",
            "is not read",
        ),
        ("startElement=\"controller\"", "startElement=\"zz\"", "names an element \"zz\", which is not there"),
        ("version=\"2.0\"", "version=\"3.0\"", "version = \"3.0\" of the standard is not read"),
        (
            "<ssc:Unit name=\"m\">",
            "<ssc:Unit name=\"ell\">",
            "wear of the system is in \"m\", which <Units> does not define",
        ),
        (
            "<ssd:Connection startElement=\"machine\" startConnector=\"VB\" endConnector=\"wear\"/>",
            "<ssd:Connection startElement=\"machine\" startConnector=\"VB\" endConnector=\"wear\"/><ssd:Connection startElement=\"machine\" startConnector=\"F\" endConnector=\"wear\"/>",
            "wear of the system is connected twice",
        ),
        ("<ssc:Unit name=\"m/min\">", "<ssc:Unit name=\"furlong\">", "is in \"m/min\", which <Units> does not define"),
        (" name=\"hardness\"", "", "<Parameter> lacks the attribute name"),
        ("</ssd:System>\n  <ssd:Units>", "<ssd:Units>", "not well-formed XML"),
    ] {
        let found = faults(from, to);
        assert!(found.iter().any(|fault| fault.contains(said)), "{to}: {found:?}");
    }
}

#[test]
fn a_parameter_of_no_component_is_a_fault_of_its_file() {
    let values = VALUES.replace("machine.lathe.", "mill.");
    let (_folder, path) = packed(NESTED, &[("resources/cell.ssv", &values)], &UNITS);
    let error = Package::open(&path).expect_err("a fault").to_string();
    assert!(error.contains("\"mill.hardness\" begins with the name of no component"), "{error}");
}

#[test]
fn what_is_no_package_is_an_error() {
    let folder = TempDir::new().expect("a folder");
    let path = folder.path().join("cell.ssp");
    std::fs::write(&path, b"no zip").expect("writable");
    assert!(matches!(Package::open(&path), Err(SspError::Archive(_))));
    let (_folder, path) = packed("<other/>", &[], &[]);
    let error = Package::open(&path).expect_err("another file").to_string();
    assert!(error.contains("SystemStructure.ssd:1: <other> instead of"), "{error}");
}
