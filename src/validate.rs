//! `toolroom validate`: published numbers beside computed ones.

use crate::failure::Failure;
use crate::progress::Bar;
use crate::speak::Voice;
use toolroom_claims::Claims;
use toolroom_study::study::Progress;

pub fn run(voice: &Voice) -> Result<(), Failure> {
    let bar = Bar::of(voice, "models");
    let claims = Claims::new(&|done, total| bar.at(Progress { done, total }));
    bar.finish();
    let claims = claims.map_err(|error| Failure::work_error(&error))?;
    if voice.json {
        voice.json(&claims.json())?;
    } else {
        voice.data(claims.text())?;
    }
    let (all, failed) = (claims.count(), claims.failed());
    voice.say(format_args!("{} of {all} claims hold", all - failed));
    if failed == 0 { Ok(()) } else { Err(Failure::work(format_args!("{failed} claims do not hold"))) }
}
