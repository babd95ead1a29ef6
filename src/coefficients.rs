//! `toolroom coefficients`: cutting-force coefficients from mean forces, or of a group of work materials.

use crate::args::CoefficientsArgs;
use crate::failure::Failure;
use crate::modes::bytes;
use crate::speak::Voice;
use std::path::Path;
use toolroom_dynamics::read_forces;
use toolroom_output::{Files, provenance};
use toolroom_planning::coefficients::{
    CoefficientRequestError, CoefficientStudy, ForceTestRequest, group_list, group_list_json,
};

/// Where the files and the words of a fault are described.
const GUIDE: &str = "see docs/dynamics.md";

pub fn run(args: &CoefficientsArgs, voice: &Voice) -> Result<(), Failure> {
    if args.list {
        return if voice.json { voice.json(&group_list_json()) } else { voice.data(group_list()) };
    }
    let named = args.out.as_deref().or(args.file.as_deref()).and_then(Path::file_stem);
    let name = named.map_or_else(|| "coefficients".to_owned(), |stem| stem.to_string_lossy().into_owned());
    let files = Files::new(args.file.as_deref(), voice.force);
    if let Some(out) = &args.out {
        files.check(out)?;
    }
    let study = match (&args.file, args.group) {
        (Some(path), None) => tested(args, path, name)?,
        (None, Some(group)) => CoefficientStudy::of_group(name, group, &args.chip_thickness, args.radial_ratio)?,
        (Some(_), Some(_)) | (None, None) => {
            return Err(Failure::argument(
                "a file of mean forces or --group is due",
                "see toolroom coefficients --help",
            ));
        }
    };
    if voice.json {
        voice.json(&study.json())?;
    } else {
        voice.data(study.text())?;
    }
    let Some(out) = &args.out else { return Ok(()) };
    files.put(out, study.file().as_bytes())?;
    voice.say(format_args!("wrote {}; a lobes file takes it by coefficients = \"…\"", out.display()));
    Ok(())
}

/// The coefficients of a force test.
fn tested(args: &CoefficientsArgs, path: &Path, name: String) -> Result<CoefficientStudy, Failure> {
    let (Some(teeth), Some(depth)) = (args.teeth, &args.depth) else {
        return Err(Failure::argument(
            "the cut of a force test needs --teeth and --depth",
            "for example --teeth 2 --depth \"2 mm\"",
        ));
    };
    let request = ForceTestRequest { teeth, depth, immersion: args.immersion, up: args.up, axes: args.axes.as_deref() };
    let (cut, axes) = (request.cut()?, request.axes()?);
    let bytes = bytes(path)?;
    let file = path.display().to_string();
    let text = String::from_utf8_lossy(&bytes);
    let test = read_forces(&file, &text).map_err(|error| Failure::located(error, GUIDE))?;
    let mut changes = vec!["--teeth".to_owned(), teeth.to_string(), "--depth".to_owned(), depth.clone()];
    changes.extend(["--immersion".to_owned(), args.immersion.to_string()]);
    changes.extend(args.axes.iter().map(|axes| format!("--axes={axes}")));
    changes.extend(args.up.then(|| "--up".to_owned()));
    let made = provenance("coefficients", &[(file, bytes.as_slice())], changes, None);
    let digests = made.inputs.iter().map(|(name, digest)| format!("{name} ({digest})"));
    let source = format!("{} of {}", made.command, digests.collect::<Vec<_>>().join(", "));
    CoefficientStudy::of_test(name, source, test, &cut, axes).map_err(|error| Failure::argument(error, GUIDE))
}

impl From<CoefficientRequestError> for Failure {
    fn from(error: CoefficientRequestError) -> Self {
        Self::argument(&error, error.fix)
    }
}
