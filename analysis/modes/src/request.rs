//! What the user of a fit decides, as it is written on a command line.

use toolroom_dynamics::{Estimator, FitOptions, FullScale, HammerOptions, Scatter, TapOptions};
use toolroom_process::unit;

/// An argument that cannot be used.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{message}")]
pub struct RequestError {
    message: String,
    /// What would do.
    pub fix: &'static str,
}

/// Arguments of a fit.
#[derive(Clone, Debug, Default)]
pub struct Request<'a> {
    /// Averages behind each function.
    pub averages: Option<u32>,
    /// `feed`, `normal`, or an angle from the feed with its unit.
    pub direction: Option<&'a str>,
    /// Number of modes.
    pub modes: Option<u32>,
    /// Frequencies of modes with their units.
    pub picks: &'a [String],
    /// How responses are estimated from hits over time: `h1`, `h2` or `hv`.
    pub estimator: Option<&'a str>,
    /// Highest frequency that hits have to excite, with its unit.
    pub highest: Option<&'a str>,
    /// Full scale of every channel of a sound file, such as `force=500 N`.
    pub scales: &'a [String],
}

fn quantity(flag: &str, text: &str, si: &'static str, fix: &'static str) -> Result<f64, RequestError> {
    unit::quantity(text, si).map_err(|error| RequestError { message: format!("{flag}: {error}"), fix })
}

impl Request<'_> {
    /// The options of the fit.
    ///
    /// # Errors
    /// [`RequestError`]: a text that is no quantity of its unit, a frequency that is not positive.
    pub fn options(&self) -> Result<FitOptions, RequestError> {
        const PICK: &str = "write for example --pick \"612 Hz\"";
        let pick = |pick: &String| {
            let frequency = quantity("--pick", pick, "Hz", PICK)?;
            let refused = || RequestError { message: format!("--pick: {pick} is no frequency"), fix: PICK };
            if frequency > 0.0 { Ok(frequency) } else { Err(refused()) }
        };
        let direction = match self.direction {
            None => None,
            Some("feed") => Some([1.0, 0.0]),
            Some("normal") => Some([0.0, 1.0]),
            Some(angle) => {
                let fix = "write feed, normal, or an angle such as \"30 deg\"";
                let (sine, cosine) = quantity("--direction", angle, "rad", fix)?.sin_cos();
                Some([cosine, sine])
            }
        };
        let picks = self.picks.iter().map(pick).collect::<Result<Vec<f64>, _>>()?;
        Ok(FitOptions { averages: self.averages, modes: self.modes.map(|modes| modes as usize), picks, direction })
    }

    /// What is told of the file of a tap test.
    ///
    /// # Errors
    /// [`RequestError`]: an estimator, a frequency or a full scale that is none.
    pub fn taps(&self) -> Result<TapOptions, RequestError> {
        const SCALE: &str = "write for example --scale \"force=500 N\" --scale \"acceleration=50 g\"";
        const HIGHEST: &str = "write for example --highest \"2000 Hz\"";
        let refused = |message: String, fix| RequestError { message, fix };
        let estimator = match self.estimator {
            None => Estimator::default(),
            Some(name) => Estimator::named(name)
                .ok_or_else(|| refused(format!("--estimator: there is no `{name}`"), "write h1, h2 or hv"))?,
        };
        let highest = self.highest.map(|text| quantity("--highest", text, "Hz", HIGHEST)).transpose()?;
        if let Some(text) = self.highest.filter(|_| highest.is_some_and(|highest| highest.is_nan() || highest <= 0.0)) {
            return Err(refused(format!("--highest: {text} is no frequency"), HIGHEST));
        }
        let scale = |text: &String| {
            let found = text.split_once('=').and_then(|(name, value)| FullScale::from_name(name, value));
            found.ok_or_else(|| refused(format!("--scale: {text} is no full scale of a channel"), SCALE))
        };
        let scales = self.scales.iter().map(scale).collect::<Result<Vec<_>, _>>()?;
        Ok(TapOptions { scales, hammer: HammerOptions { estimator, highest } })
    }

    /// What changes the result, as it has to be typed.
    pub fn arguments(&self) -> Vec<String> {
        let averages = self.averages.map(|averages| ["--averages".to_owned(), averages.to_string()]);
        let direction = self.direction.map(|direction| ["--direction".to_owned(), direction.to_owned()]);
        let modes = self.modes.map(|modes| ["--modes".to_owned(), modes.to_string()]);
        let picks = self.picks.iter().map(|pick| ["--pick".to_owned(), pick.clone()]);
        let estimator = self.estimator.map(|estimator| ["--estimator".to_owned(), estimator.to_owned()]);
        let highest = self.highest.map(|highest| ["--highest".to_owned(), highest.to_owned()]);
        let scales = self.scales.iter().map(|scale| ["--scale".to_owned(), scale.clone()]);
        let single = [averages, direction, modes, estimator, highest].into_iter().flatten();
        single.chain(picks).chain(scales).flatten().collect()
    }
}

/// The scatter between mountings with the shares that `changes` give: `f=0.5 %`, `zeta=0.1`, `k=5 %`.
///
/// # Errors
/// [`RequestError`]: another key, or a share outside 0 … 1.
pub fn scatter(changes: &[String]) -> Result<Scatter, RequestError> {
    const FIX: &str = "write for example --scatter \"f=0.5 %\" --scatter zeta=0.1";
    let mut scatter = Scatter::ASSUMED;
    for change in changes {
        let (key, share) = change.split_once('=').unwrap_or((change, ""));
        let (key, share) = (key.trim(), share.trim());
        let refused = |message: String| RequestError { message, fix: FIX };
        let place = match key {
            "f" => &mut scatter.natural_frequency,
            "zeta" => &mut scatter.damping_ratio,
            "k" => &mut scatter.stiffness,
            other => return Err(refused(format!("--scatter: there is no `{other}`; f, zeta and k are"))),
        };
        let read = quantity("--scatter", share, "1", FIX)?;
        if !(0.0..1.0).contains(&read) {
            return Err(refused(format!("--scatter {key}: {share} is not within 0 … 1")));
        }
        *place = read;
    }
    Ok(scatter)
}

/// First and last frequency (Hz) of two quantities.
///
/// # Errors
/// [`RequestError`]: texts that are no frequencies, or a range that cannot be computed.
pub fn range(texts: &[String]) -> Result<[f64; 2], RequestError> {
    const FIX: &str = "write for example --range \"50 Hz\" \"6000 Hz\": 100 Hz and more, between 1 Hz and 100 kHz";
    let ends = texts.iter().map(|text| quantity("--range", text, "Hz", FIX)).collect::<Result<Vec<f64>, _>>()?;
    match ends[..] {
        [first, last] if first >= 1.0 && last >= first + 100.0 && last <= 1e5 => Ok([first, last]),
        _ => Err(RequestError { message: format!("--range: {} is no range", texts.join(" to ")), fix: FIX }),
    }
}
