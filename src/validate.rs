//! `toolroom validate`: published numbers beside computed ones.

use crate::failure::Failure;
use crate::speak::Voice;
use toolroom_claims::Claims;

pub fn run(voice: &Voice) -> Result<(), Failure> {
    let claims = Claims::new().map_err(|error| Failure::Work { message: error.to_string() })?;
    if voice.json {
        voice.json(&claims.json())?;
    } else {
        voice.data(claims.text())?;
    }
    let (all, failed) = (claims.count(), claims.failed());
    voice.say(format_args!("{} of {all} claims hold", all - failed));
    if failed == 0 { Ok(()) } else { Err(Failure::Work { message: format!("{failed} claims do not hold") }) }
}
