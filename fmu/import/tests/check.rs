//! Units with one fault each: every rule finds its own and nothing else.

use proptest::prelude::*;
use std::io::Write;
use std::path::PathBuf;
use tempfile::TempDir;
use toolroom_fmu_import::check::{Finding, Rule, Severity, check};
use toolroom_fmu_import::{Archive, ArchiveError, ModelDescription};
use zip::write::SimpleFileOptions;

/// A unit without a fault: one state, one input, one output.
const TWO: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="2.0" modelName="Wear" guid="{w}" generationDateAndTime="2026-11-21T15:00:00Z" numberOfEventIndicators="0">
  <CoSimulation modelIdentifier="Wear" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <ModelExchange modelIdentifier="Wear" canGetAndSetFMUstate="true" canSerializeFMUstate="true"/>
  <UnitDefinitions><Unit name="m/s"><BaseUnit m="1" s="-1"/></Unit><Unit name="m"><BaseUnit m="1"/></Unit></UnitDefinitions>
  <LogCategories><Category name="logAll"/></LogCategories>
  <DefaultExperiment startTime="0" stopTime="10" stepSize="0.1"/>
  <ModelVariables>
    <ScalarVariable name="speed" valueReference="1" causality="input" variability="continuous"><Real unit="m/s" start="0.5" min="0" max="10"/></ScalarVariable>
    <ScalarVariable name="wear" valueReference="2" causality="output" variability="continuous" initial="exact"><Real unit="m" start="0"/></ScalarVariable>
    <ScalarVariable name="der(wear)" valueReference="3" causality="local" variability="continuous"><Real derivative="2" unit="m/s"/></ScalarVariable>
    <ScalarVariable name="worn" valueReference="4" causality="output" variability="discrete" initial="calculated"><Boolean/></ScalarVariable>
  </ModelVariables>
  <ModelStructure>
    <Outputs><Unknown index="2" dependencies="2"/><Unknown index="4" dependencies="2" dependenciesKind="dependent"/></Outputs>
    <Derivatives><Unknown index="3" dependencies="1 2"/></Derivatives>
    <InitialUnknowns><Unknown index="3"/><Unknown index="4"/></InitialUnknowns>
  </ModelStructure>
</fmiModelDescription>"#;

/// The same in FMI 3.0.
const THREE: &str = r#"<?xml version="1.0" encoding="UTF-8"?>
<fmiModelDescription fmiVersion="3.0" modelName="Wear" instantiationToken="{w}">
  <CoSimulation modelIdentifier="Wear" hasEventMode="true"/>
  <UnitDefinitions><Unit name="m"><BaseUnit m="1"/></Unit><Unit name="K"><BaseUnit K="1"/></Unit></UnitDefinitions>
  <TypeDefinitions><Float64Type name="Length" unit="m"/></TypeDefinitions>
  <ModelVariables>
    <Float64 name="time" valueReference="0" causality="independent" variability="continuous"/>
    <Float64 name="speed" valueReference="1" causality="input" start="0.5"/>
    <Float64 name="wear" valueReference="2" causality="output" initial="exact" start="0" declaredType="Length"><Alias name="VB"/></Float64>
    <Float64 name="der(wear)" valueReference="3" derivative="2"/>
    <String name="set" valueReference="5" causality="parameter" variability="fixed"><Start value="a"/></String>
  </ModelVariables>
  <ModelStructure>
    <Output valueReference="2" dependencies="2"/>
    <ContinuousStateDerivative valueReference="3" dependencies="1 2"/>
    <InitialUnknown valueReference="3"/>
  </ModelStructure>
</fmiModelDescription>"#;

/// A unit with this description and these further entries.
fn unit(folder: &TempDir, description: &str, more: &[(&str, &[u8])]) -> PathBuf {
    let path = folder.path().join("unit.fmu");
    let mut zip = zip::ZipWriter::new(std::fs::File::create(&path).expect("a temporary file"));
    let entries = std::iter::once(("modelDescription.xml", description.as_bytes())).chain(more.iter().copied());
    for (name, bytes) in entries.filter(|(_, bytes)| !bytes.is_empty()) {
        zip.start_file(name, SimpleFileOptions::default()).expect("an entry");
        zip.write_all(bytes).expect("an entry");
    }
    zip.finish().expect("a zip file");
    path
}

fn findings(description: &str, more: &[(&str, &[u8])]) -> Vec<Finding> {
    let folder = TempDir::new().expect("a temporary folder");
    check(&mut Archive::open(&unit(&folder, description, more)).expect("a zip file")).findings
}

/// Findings of a description alone, without what the missing binaries give.
fn faults(description: &str) -> Vec<(Rule, String)> {
    let found = findings(description, &[("sources/fmi.c", b"int x;")]);
    let bad = found.into_iter().filter(|finding| finding.severity != Severity::Note);
    bad.map(|finding| (finding.rule, format!("{}: {}", finding.place, finding.message))).collect()
}

#[test]
fn a_sound_description_gives_no_finding() {
    assert_eq!(faults(TWO), []);
    assert_eq!(faults(THREE), []);
}

#[test]
fn every_fault_of_a_description_is_found_by_its_rule() {
    use Rule::{Description, Events, Instances, Logging, State, Structure, Time};
    let cases: &[(&str, &str, &str, Rule, &str)] = &[
        (
            TWO,
            "<Unknown index=\"4\" dependencies=\"2\" dependenciesKind=\"dependent\"/>",
            "",
            Structure,
            "missing in <ModelStructure> as output: worn",
        ),
        (
            TWO,
            "<Unknown index=\"3\"/><Unknown index=\"4\"/>",
            "<Unknown index=\"3\"/>",
            Structure,
            "as initial unknown: worn",
        ),
        (
            TWO,
            "<Unknown index=\"3\"/><Unknown index=\"4\"/>",
            "<Unknown index=\"1\"/><Unknown index=\"3\"/><Unknown index=\"4\"/>",
            Structure,
            "but is none: speed",
        ),
        (TWO, "dependencies=\"1 2\"", "dependencies=\"1 3\"", Structure, "der(wear) is said to depend on der(wear)"),
        (TWO, "dependencies=\"1 2\"", "dependencies=\"1 9\"", Description, ":16: dependency \"9\" names no variable"),
        (
            TWO,
            "dependenciesKind=\"dependent\"",
            "dependenciesKind=\"dependent fixed\"",
            Description,
            "2 dependenciesKind for 1",
        ),
        (TWO, "derivative=\"2\"", "derivative=\"0\"", Description, "derivative = \"0\" names no variable"),
        (TWO, "start=\"0.5\" min=\"0\"", "min=\"0\"", Description, "speed: a start value is due"),
        (TWO, "start=\"0.5\"", "start=\"fast\"", Description, "start = \"fast\" is no real"),
        (TWO, "start=\"0.5\"", "start=\"11\"", Description, "outside its range"),
        (TWO, "min=\"0\" max=\"10\"", "min=\"20\"", Description, "outside its range"),
        (TWO, "unit=\"m/s\" start", "unit=\"m/h\" start", Description, "unit \"m/h\" is not among"),
        (TWO, "name=\"worn\"", "name=\"wear\"", Description, "the name wear is taken by the variable of line 10"),
        (
            TWO,
            "valueReference=\"3\"",
            "valueReference=\"2\"",
            Description,
            "share the value reference 2, but not the unit",
        ),
        (TWO, "variability=\"discrete\"", "variability=\"continuous\"", Description, "only reals are continuous"),
        (
            TWO,
            "causality=\"input\" variability=\"continuous\"",
            "causality=\"input\" variability=\"fixed\"",
            Description,
            "cannot be fixed",
        ),
        (TWO, "causality=\"local\"", "causality=\"internal\"", Description, "causality \"internal\" is not known"),
        (
            TWO,
            "modelIdentifier=\"Wear\" canGetAndSetFMUstate=\"true\"",
            "modelIdentifier=\"Wear\"",
            State,
            "serialises the FMU state, but cannot get and set it",
        ),
        (TWO, "canSerializeFMUstate=\"true\"", "canSerializeFMUstate=\"yes\"", Description, "neither true nor false"),
        (
            TWO,
            "canSerializeFMUstate=\"true\"",
            "canBeInstantiatedOnlyOncePerProcess=\"true\"",
            Instances,
            "only one instance a process",
        ),
        (TWO, "guid=\"{w}\"", "guid=\"\"", Instances, "is empty"),
        (TWO, "stopTime=\"10\"", "stopTime=\"0\"", Time, "is not after startTime"),
        (TWO, "stepSize=\"0.1\"", "stepSize=\"0\"", Time, "stepSize is not positive"),
        (TWO, "stepSize=\"0.1\"", "stepSize=\"NaN\"", Time, "stepSize is not finite"),
        (TWO, "stepSize=\"0.1\"", "stepSize=\"0,1\"", Description, "is no number"),
        (TWO, "name=\"logAll\"", "name=\"\"", Logging, "no name"),
        (TWO, "2026-11-21T15:00:00Z", "2026-11-21T15:00:00.5+00:00", Description, "YYYY-MM-DDThh:mm:ssZ"),
        (TWO, "modelIdentifier=\"Wear\"", "modelIdentifier=\"Wear 2\"", Description, "C identifier"),
        (TWO, "fmiVersion=\"2.0\"", "fmiVersion=\"1.0\"", Description, "2.0 and 3.0 are"),
        (TWO, "fmiVersion=\"2.0\"", "fmiVersion=\"2.5\"", Description, "2.0 and 3.0 are"),
        (TWO, "</ModelStructure>", "", Description, "not well-formed XML"),
        (THREE, "K=\"1\"", "k=\"1\"", Description, "<BaseUnit> has no attribute k"),
        (
            THREE,
            "valueReference=\"3\" derivative",
            "valueReference=\"1\" derivative",
            Description,
            "share the value reference 1",
        ),
        (THREE, "declaredType=\"Length\"", "declaredType=\"Height\"", Description, "type \"Height\" is not among"),
        (THREE, "name=\"VB\"", "name=\"speed\"", Description, "the name speed is taken"),
        (THREE, "causality=\"independent\"", "causality=\"local\"", Description, "asks for an independent variable"),
        (THREE, "<Float64 name=\"speed\"", "<Double name=\"speed\"", Description, "<Double> is no type of variable"),
        (
            THREE,
            "<Float64 name=\"speed\" valueReference=\"1\" causality=\"input\" start=\"0.5\"/>",
            "<Real name=\"speed\" valueReference=\"1\" causality=\"input\" start=\"0.5\"/>",
            Description,
            "<Real> is no type of variable",
        ),
        (
            THREE,
            "<Float64Type name=\"Length\"",
            "<Real name=\"Length\"",
            Description,
            "<Real> is no definition of a type",
        ),
        (
            THREE,
            "causality=\"parameter\" variability=\"fixed\"",
            "variability=\"fixed\" initial=\"exact\"",
            Description,
            "a fixed variable of causality local is calculated or approx at first, not exact",
        ),
        // What the schemas of the standards say.
        (
            TWO,
            "initial=\"exact\"",
            "initial=\"often\"",
            Description,
            "initial = \"often\" is none of exact, approx, calculated",
        ),
        (TWO, "<BaseUnit m=\"1\"/>", "<BaseUnit m=\"1.5\"/>", Description, "m = \"1.5\" is no number"),
        (
            TWO,
            "modelIdentifier=\"Wear\"",
            "canHandleVariableCommunicationStepSize=\"x\" modelIdentifier=\"Wear\"",
            Description,
            "neither true nor false",
        ),
        (TWO, "<Boolean/>", "<Enumeration/>", Description, "<Enumeration> lacks the attribute declaredType"),
        (
            TWO,
            "  <LogCategories>",
            "  <TypeDefinitions><SimpleType name=\"Length\"/></TypeDefinitions>\n  <LogCategories>",
            Description,
            "<SimpleType> lacks <Real> or <Integer> or",
        ),
        (
            TWO,
            "  <LogCategories>",
            "  <TypeDefinitions><SimpleType name=\"Rule\"><Enumeration><Item name=\"a\" value=\"\"/></Enumeration></SimpleType></TypeDefinitions>\n  <LogCategories>",
            Description,
            "value = \"\" is no whole number of 32 bits",
        ),
        (TWO, "<Category name=\"logAll\"/>", "", Description, "<LogCategories> lacks <Category>"),
        (
            TWO,
            "unit=\"m\" start",
            "unit=\"m\" displayUnit=\"mm\" start",
            Description,
            "displayUnit \"mm\" is not among those of unit \"m\"",
        ),
        (TWO, "start=\"0.5\"", "start=\"0.5 0.5\"", Description, "2 start values for 1"),
        (TWO, "2026-11-21T15:00:00Z", "yesterday", Description, "no date"),
        (
            THREE,
            "<Alias name=\"VB\"/>",
            "<Alias name=\"VB\" displayUnit=\"ft\"/>",
            Description,
            "displayUnit \"ft\" is not among",
        ),
        (THREE, "<Alias name=\"VB\"/>", "<Alias/>", Description, "<Alias> lacks the attribute name"),
        (THREE, "<Start value=\"a\"/>", "<Start value=\"a\"/><Note/>", Description, "<Note> is no element of <String>"),
        (
            THREE,
            "<Float64 name=\"speed\" valueReference=\"1\" causality=\"input\" start=\"0.5\"/>",
            "<Int8 name=\"speed\" valueReference=\"1\" causality=\"input\" start=\"300\"/>",
            Description,
            "start = \"300\" is no integer (8 bit)",
        ),
        (
            THREE,
            "causality=\"input\" start=\"0.5\"/>",
            "causality=\"input\" start=\"0.5\"><Dimension valueReference=\"5\"/></Float64>",
            Description,
            "the dimension 5 is no structural parameter",
        ),
        (THREE, "declaredType=\"Length\"", "clocks=\"\" declaredType=\"Length\"", Description, "clocks = \"\" is no"),
        (
            THREE,
            "declaredType=\"Length\"",
            "clocks=\"99 1\" declaredType=\"Length\"",
            Description,
            "clocks: 1 is the value",
        ),
        (
            THREE,
            "hasEventMode=\"true\"",
            "hasEventmode=\"true\"",
            Description,
            "<CoSimulation> has no attribute hasEventmode",
        ),
        (
            TWO,
            "<ModelStructure>",
            "<ModelStructure reinit=\"x\">",
            Description,
            "<ModelStructure> has no attribute reinit",
        ),
        (THREE, "<ModelStructure>", "<ModelStructure min=\"m\">", Description, "<ModelStructure> has no attribute min"),
        (THREE, "<ModelVariables>", "<ModelVariables min=\"m\">", Description, "<ModelVariables> has no attribute min"),
        (
            TWO,
            "</fmiModelDescription>",
            "<ModelStructure/></fmiModelDescription>",
            Description,
            "has more than one <ModelStructure>",
        ),
        (
            THREE,
            "</fmiModelDescription>",
            "<LogCategories/></fmiModelDescription>",
            Description,
            "<LogCategories> stands after <ModelStructure>",
        ),
        (TWO, "<Boolean/>", "<Boolean/><Boolean/>", Description, "<ScalarVariable> has more than one <Boolean>"),
        (TWO, "<Boolean/>", "<Boolean/><Real/>", Description, "<ScalarVariable> has more than one <Boolean>"),
        (THREE, "<Output valueReference=\"2\" dependencies=\"2\"/>", "", Structure, "as output: wear"),
        (
            THREE,
            "<Output valueReference=\"2\" dependencies=\"2\"/>",
            "<InitialUnknown valueReference=\"3\"/><Output valueReference=\"2\" dependencies=\"2\"/>",
            Description,
            "<Output> stands after <InitialUnknown>",
        ),
        (
            THREE,
            "causality=\"independent\" variability",
            "causality=\"independent\" initial=\"calculated\" variability",
            Description,
            "is neither known nor unknown at first, not calculated",
        ),
        (
            THREE,
            "</ModelVariables>",
            "<Binary name=\"key\" valueReference=\"77\" causality=\"parameter\" variability=\"fixed\"><Start value=\"2\"/></Binary></ModelVariables>",
            Description,
            "key: start = \"2\" is no binary",
        ),
    ];
    for (sound, from, to, rule, expected) in cases {
        let text = sound.replacen(from, to, 1);
        assert_ne!(&text, sound, "{from} is in the description");
        let found = faults(&text);
        assert!(found.iter().any(|(by, message)| by == rule && message.contains(expected)), "{to}: {found:?}");
    }
    let odd = THREE.replace("name=\"speed\"", "name=\"speed 1\"");
    assert_eq!(faults(&odd), []);
    let convention = "variableNamingConvention=\"structured\" fmiVersion=\"3.0\"";
    let found = faults(&odd.replace("fmiVersion=\"3.0\"", convention));
    let message = "modelDescription.xml:8: speed 1 is no name of the structured naming convention";
    assert_eq!(found, [(Description, message.to_owned())]);
    let quiet = findings(&THREE.replace(" hasEventMode=\"true\"", " mightReturnEarlyFromDoStep=\"true\""), &[]);
    assert!(quiet.iter().any(|finding| finding.rule == Events && finding.severity == Severity::Note), "{quiet:?}");
}

#[test]
fn a_library_is_judged_without_being_loaded() {
    // Any shared object will do; this test's own program hands out no function of FMI.
    let program = std::fs::read(std::env::current_exe().expect("a program")).expect("readable");
    let host = toolroom_fmu_import::Platform::host().expect("tests run on a known platform");
    let name = |folder: &str, suffix: &str| format!("binaries/{folder}/Wear{suffix}");
    let reports = |found: &[Finding], rule: Rule, text: &str| {
        found.iter().any(|finding| finding.rule == rule && finding.message.contains(text))
    };
    let reported = findings(TWO, &[(&name(host.fmi2, host.suffix), &program)]);
    assert!(reports(&reported, Rule::Symbols, "lacks 44 functions: fmi2GetTypesPlatform"), "{reported:?}");
    let three = findings(THREE, &[(&name(host.fmi3, host.suffix), &program)]);
    assert!(reports(&three, Rule::Symbols, "fmi3DoStep"), "{three:?}");
    let (folder, suffix) = if host.fmi2 == "win64" { ("linux64", ".so") } else { ("win64", ".dll") };
    let wrong = findings(TWO, &[(&name(folder, suffix), &program)]);
    assert!(reports(&wrong, Rule::Platform, "the folder is for another platform"), "{wrong:?}");
    assert!(reports(&wrong, Rule::Platform, "no library for this computer"), "{wrong:?}");
    let text = findings(TWO, &[(&name(host.fmi2, host.suffix), b"no library")]);
    assert!(reports(&text, Rule::Platform, "is no shared library"), "{text:?}");
    let other = findings(TWO, &[(&format!("binaries/{}/Other.so", host.fmi2), &program)]);
    assert!(reports(&other, Rule::Platform, "is missing: the modelIdentifier gives this name"), "{other:?}");
    let none = findings(TWO, &[]);
    assert!(reports(&none, Rule::Platform, "neither binaries nor sources"), "{none:?}");
}

#[test]
fn an_archive_that_leads_out_of_its_folder_is_not_unpacked() {
    let folder = TempDir::new().expect("a temporary folder");
    let target = TempDir::new().expect("a temporary folder");
    for name in ["../evil.txt", "/tmp/evil.txt", "C:\\evil.txt", "resources\\..\\..\\evil.txt"] {
        let path = unit(&folder, TWO, &[(name, b"x")]);
        let mut archive = Archive::open(&path).expect("a zip file");
        let refused = archive.unpack(target.path()).expect_err("refused");
        assert!(matches!(refused, ArchiveError::Traversal { .. }), "{name}: {refused}");
        assert_eq!(std::fs::read_dir(target.path()).expect("a folder").count(), 0, "{name}: nothing was written");
        let findings = check(&mut archive).findings;
        assert!(findings.iter().any(|each| each.rule == Rule::Archive && each.severity == Severity::Error), "{name}");
    }
    let path = unit(&folder, TWO, &[("resources\\tools.csv", b"x")]);
    Archive::open(&path).expect("a zip file").unpack(target.path()).expect("inside");
    assert!(target.path().join("resources/tools.csv").is_file());
}

#[test]
fn a_description_in_a_folder_is_told_from_none() {
    let nested = findings("", &[("Wear/modelDescription.xml", TWO.as_bytes())]);
    assert!(nested[0].message.contains("belongs to the root"), "{nested:?}");
    let none = findings("", &[("readme.txt", b"x")]);
    assert!(none[0].message.contains("has no modelDescription.xml"), "{none:?}");
}

#[test]
fn a_damaged_file_is_an_error_and_no_panic() {
    let folder = TempDir::new().expect("a temporary folder");
    let whole = std::fs::read(unit(&folder, TWO, &[])).expect("readable");
    let path = folder.path().join("cut.fmu");
    for length in (0..whole.len()).step_by(7) {
        std::fs::write(&path, &whole[..length]).expect("writable");
        assert!(matches!(Archive::open(&path), Err(ArchiveError::NoZip { .. })), "cut at {length}");
    }
    for offset in (0..whole.len()).step_by(3) {
        let mut bytes = whole.clone();
        bytes[offset] ^= 0x5a;
        std::fs::write(&path, &bytes).expect("writable");
        if let Ok(mut archive) = Archive::open(&path) {
            let _ = check(&mut archive); // whatever it finds, it comes back
        }
    }
}

#[test]
fn entities_and_depth_do_not_explode() {
    let bomb = TWO.replacen(
        "<fmiModelDescription",
        "<!DOCTYPE x [<!ENTITY a \"aaaaaaaaaa\"><!ENTITY b \"&a;&a;&a;&a;&a;&a;&a;&a;\">]><fmiModelDescription",
        1,
    );
    assert!(ModelDescription::read(&bomb).description.is_none());
    let deep = format!("{}{}", "<a>".repeat(20_000), "</a>".repeat(20_000));
    assert!(ModelDescription::read(&deep).description.is_none());
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(300))]

    #[test]
    fn any_text_is_answered(text in "\\PC{0,200}") {
        let _ = ModelDescription::read(&text);
    }

    #[test]
    fn a_description_with_any_piece_replaced_is_answered(
        three in any::<bool>(), at in 0.0..1.0f64, length in 0usize..40, piece in "[<>/\"=a-zA-Z0-9 .&;{}-]{0,20}"
    ) {
        let sound = if three { THREE } else { TWO };
        let start = (at * sound.len() as f64) as usize;
        let end = (start + length).min(sound.len());
        let text = format!("{}{piece}{}", &sound[..start], &sound[end..]);
        let reading = ModelDescription::read(&text);
        prop_assert!(reading.description.is_some() || !reading.faults.is_empty());
    }
}

#[test]
fn what_is_clocked_is_no_initial_unknown() {
    // As in the Reference FMU `Clocks`: an output that belongs to a clock has no value before it ticks.
    let clocked = THREE.replace(
        "    <String name",
        "    <Clock name=\"tick\" valueReference=\"6\" causality=\"input\" intervalVariability=\"triggered\"/>\n    \
         <Int32 name=\"ticks\" valueReference=\"7\" causality=\"output\" clocks=\"6\"/>\n    <String name",
    );
    let clocked = clocked
        .replace("    <ContinuousState", "    <Output valueReference=\"7\" dependencies=\"6\"/>\n    <ContinuousState");
    let folder = TempDir::new().expect("a folder");
    let findings = |description: &str| -> Vec<String> {
        let mut archive = Archive::open(&unit(&folder, description, &[])).expect("a zip file");
        let structure = check(&mut archive).findings.into_iter().filter(|finding| finding.rule == Rule::Structure);
        structure.map(|finding| finding.message).collect()
    };
    assert_eq!(findings(&clocked), [""; 0]);
    // A clock of time is the importer's to tick in Model Exchange, which is said; a triggered one is not.
    let notes = |description: &str| -> Vec<String> {
        let mut archive = Archive::open(&unit(&folder, description, &[])).expect("a zip file");
        let events = check(&mut archive).findings.into_iter().filter(|finding| finding.rule == Rule::Events);
        events.map(|finding| finding.message).filter(|message| message.contains("clock")).collect()
    };
    assert_eq!(notes(THREE), [""; 0]);
    let ticked = |notes: &[String]| notes.iter().any(|note| note.contains("has to tick the clock tick"));
    let exchange = "  <ModelExchange modelIdentifier=\"Wear\"/>\n  <CoSimulation";
    let triggered = clocked.replace("  <CoSimulation", exchange);
    let periodic = triggered.replace("\"triggered\"", "\"constant\" intervalDecimal=\"0.1\"");
    assert!(!ticked(&notes(&triggered)) && ticked(&notes(&periodic)), "{:?}", notes(&periodic));
    assert!(notes(&clocked).iter().any(|note| note.contains("no clock ticks for an importer without Event Mode")));
    let listed =
        clocked.replace("    <InitialUnknown", "    <InitialUnknown valueReference=\"7\"/>\n    <InitialUnknown");
    assert!(findings(&listed)[0].contains("as initial unknown, but is none: ticks"), "{:?}", findings(&listed));
    let unclocked = clocked.replace(" clocks=\"6\"", "");
    assert!(findings(&unclocked)[0].contains("missing in <ModelStructure> as initial unknown: ticks"));
}
