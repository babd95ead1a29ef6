//! Chatter from the sound of cuts of which everything is known.

use rand::SeedableRng as _;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution as _, StandardNormal};
use std::f64::consts::TAU;
use toolroom_dynamics::{Channel, Chatter, Cutting, Direction, Heard, Origin, Record, Signal, listen};

/// A cut in sound: amplitude of the first line of the teeth 0.3, noise of 0.01.
#[derive(Clone, Copy)]
struct Cut {
    teeth: u32,
    /// True speed (rpm).
    speed: f64,
    /// Amplitude of every line of the spindle.
    runout: f64,
    /// Frequency of the chatter (Hz), its amplitude, and when it begins (s).
    chatter: Option<(f64, f64, f64)>,
    seed: u64,
}

impl Cut {
    fn record(self) -> Record {
        let (rate, count) = (16_000.0, 32_000);
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let spindle = self.speed / 60.0;
        let mut lines: Vec<(f64, f64, f64)> = Vec::new();
        for k in 1..=6 * self.teeth {
            let amplitude = if k % self.teeth == 0 { 0.3 * f64::from(self.teeth) / f64::from(k) } else { self.runout };
            lines.push((f64::from(k) * spindle, amplitude, 0.0));
        }
        if let Some((frequency, amplitude, begin)) = self.chatter {
            let tooth = spindle * f64::from(self.teeth);
            lines.extend([(frequency, amplitude, begin), (frequency + tooth, 0.4 * amplitude, begin)]);
        }
        let phases: Vec<f64> = lines.iter().map(|line| TAU * line.0 / 7.0).collect();
        let value = |i: i32| {
            let time = f64::from(i) / rate;
            let sum: f64 = lines
                .iter()
                .zip(&phases)
                .filter(|((.., begin), _)| time >= *begin)
                .map(|((frequency, amplitude, _), phase)| amplitude * (TAU * frequency * time + phase).sin())
                .sum();
            let noise: f64 = StandardNormal.sample(&mut random);
            sum + 0.01 * noise
        };
        let values = (0..count).map(value).collect();
        let channel = Channel { signal: Signal::Sound, direction: Direction::X, values };
        Record { source: "cut.wav".to_owned(), rate, channels: vec![channel] }
    }

    fn heard(self, commanded: f64) -> Heard {
        let spindle_speed = commanded * TAU / 60.0;
        listen(&self.record(), &Cutting { teeth: self.teeth, spindle_speed, air: None, natural_frequencies: &[] })
            .unwrap()
    }
}

const CUT: Cut = Cut { teeth: 3, speed: 6120.0, runout: 0.05, chatter: None, seed: 1 };

fn rpm(heard: &Heard) -> f64 {
    heard.spindle_speed * 60.0 / TAU
}

#[test]
fn chatter_is_heard_with_its_frequency_onset_and_quiet_speeds() {
    let heard = Cut { chatter: Some((841.7, 0.1, 0.8)), ..CUT }.heard(6000.0);
    assert!((rpm(&heard) - 6120.0).abs() < 0.5, "{}", rpm(&heard));
    assert_eq!(heard.chatter, Chatter::Yes);
    let frequency = heard.chatter_frequency.unwrap();
    assert!((frequency - 841.7).abs() < 0.1, "{frequency}");
    // A frame lasts 0.27 s and moves by an eighth of that.
    assert!((heard.onset.unwrap() - 0.8).abs() < 0.05, "{:?}", heard.onset);
    let orders: Vec<i32> = heard
        .lines
        .iter()
        .filter_map(|line| if let Origin::Chatter(m) = line.origin { Some(m) } else { None })
        .collect();
    assert_eq!(orders, [0, 1]);
    let speeds = heard.suggested_speeds(3, 500.0, 1500.0);
    let expected = [60.0 * 841.7 / 6.0, 60.0 * 841.7 / 9.0];
    assert_eq!(speeds.len(), 2);
    for (speed, rpm) in speeds.iter().zip(expected) {
        assert!((speed * 60.0 / TAU / rpm - 1.0).abs() < 2e-4, "{speed} {rpm}");
    }
}

#[test]
fn cuts_that_chatter_are_told_from_cuts_with_runout() {
    // A hundred cuts of each kind; chatter lies at least two frame bins, 7.5 Hz, from every line of the spindle.
    let mut wrong = Vec::new();
    for i in 0..100u32 {
        let teeth = 2 + i % 4;
        let speed = 4011.0 + 97.3 * f64::from(i);
        let spindle = speed / 60.0;
        let cut = Cut { teeth, speed, runout: 0.06 * f64::from(i % 3), chatter: None, seed: u64::from(i) };
        let commanded = speed * (1.0 + 0.025 * f64::from(i).sin());
        if cut.heard(commanded).chatter != Chatter::No {
            wrong.push(format!("cut {i} without chatter"));
        }
        let frequency = spindle * (5.0 + f64::from(i % 7) + 0.27 + 0.0045 * f64::from(i % 100));
        let heard = Cut { chatter: Some((frequency, 0.05, 0.0)), ..cut }.heard(commanded);
        let found = heard.chatter_frequency.filter(|found| (found - frequency).abs() < 0.5);
        if heard.chatter != Chatter::Yes || found.is_none() {
            wrong.push(format!(
                "cut {i} with chatter at {frequency}: {:?} {:?}",
                heard.chatter, heard.chatter_frequency
            ));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn chatter_beside_a_harmonic_of_the_spindle_is_heard_and_a_wandering_speed_is_none() {
    let mut wrong = Vec::new();
    for i in 0..40u32 {
        let (teeth, speed) = (2 + i % 4, 4611.0 + 153.7 * f64::from(i));
        let cut = Cut { teeth, speed, chatter: None, seed: u64::from(i), ..CUT };
        // Frames tell lines apart that lie ten hertz from each other, the record lines three hertz apart.
        // Beside a harmonic of the teeth stand, beside others of theirs, further lines of the chatter, as of a wandering speed.
        let order = (5 + i % 9..).find(|order| order % teeth != 0).unwrap();
        let harmonic = speed / 60.0 * f64::from(order);
        let frequency = harmonic + (3.5 + 0.1 * f64::from(i)) * if i % 2 == 0 { 1.0 } else { -1.0 };
        let heard = Cut { chatter: Some((frequency, 0.1, 0.0)), ..cut }.heard(speed);
        let found = heard.chatter_frequency.filter(|found| (found - frequency).abs() < 0.5);
        if heard.chatter != Chatter::Yes || found.is_none() {
            wrong
                .push(format!("{i}: {frequency} beside {harmonic}: {:?} {:?}", heard.chatter, heard.chatter_frequency));
        }
        // The same cut at a speed that rises by some tenths of a percent, and at one that swings to and fro.
        for (drift, swing) in [(1e-3, 0.0), (3e-3, 0.0), (0.0, 2e-3)] {
            let mut record = cut.record();
            let rate = record.rate;
            let still = record.channels[0].values.clone();
            for (n, value) in record.channels[0].values.iter_mut().enumerate() {
                let time = n as f64 / rate;
                let moved = time + drift * 0.5 * time * time + swing / (TAU * 1.5) * (TAU * 1.5 * time).sin();
                let place = (moved * rate).min((still.len() - 2) as f64);
                let share = place.fract();
                *value = still[place as usize] * (1.0 - share) + still[place as usize + 1] * share;
            }
            let spindle_speed = speed * TAU / 60.0;
            let cutting = Cutting { teeth, spindle_speed, air: None, natural_frequencies: &[] };
            if listen(&record, &cutting).unwrap().chatter == Chatter::Yes {
                wrong.push(format!("{i}: chatter of a speed that drifts by {drift} and swings by {swing}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn period_doubling_of_even_teeth_is_left_open_and_that_of_odd_teeth_is_heard() {
    let doubled = |teeth: u32| {
        let tooth = 6120.0 / 60.0 * f64::from(teeth);
        Cut { teeth, chatter: Some((1.5 * tooth, 0.25, 0.0)), ..CUT }.heard(6120.0)
    };
    for teeth in [2, 4] {
        let heard = doubled(teeth);
        assert_eq!(heard.chatter, Chatter::Ambiguous);
        assert!((heard.chatter_frequency.unwrap() - 153.0 * f64::from(teeth)).abs() < 0.2);
        assert!(heard.suggested_speeds(teeth, 100.0, 1e4).is_empty());
    }
    assert_eq!(doubled(3).chatter, Chatter::Yes);
}

#[test]
fn lines_of_the_machine_and_of_mains_are_no_chatter() {
    let whistling = Cut { chatter: Some((1770.0, 0.08, 0.0)), ..CUT };
    assert_eq!(whistling.heard(6120.0).chatter, Chatter::Yes);
    let idle = Cut { chatter: Some((1770.0, 0.07, 0.0)), teeth: 3, speed: 6120.0, runout: 0.01, seed: 9 }.record();
    let cutting = Cutting { teeth: 3, spindle_speed: 6120.0 * TAU / 60.0, air: Some(&idle), natural_frequencies: &[] };
    assert_eq!(listen(&whistling.record(), &cutting).unwrap().chatter, Chatter::No);
    let mut humming = CUT.record();
    for (i, value) in humming.channels[0].values.iter_mut().enumerate() {
        *value += 0.08 * (TAU * 250.0 * i as f64 / 16_000.0).sin();
    }
    assert_eq!(listen(&humming, &Cutting { air: None, ..cutting }).unwrap().chatter, Chatter::No);
}

#[test]
fn chatter_on_a_harmonic_of_mains_is_no_mains() {
    // Period doubling of three teeth near 250 Hz, whose companion of the teeth is 750 Hz.
    let doubled = Cut { speed: 10_010.0, chatter: Some((250.25, 0.2, 0.0)), ..CUT };
    let heard = doubled.heard(10_000.0);
    assert_eq!(heard.chatter, Chatter::Yes);
    assert!((heard.chatter_frequency.unwrap() - 250.25).abs() < 0.2, "{:?}", heard.chatter_frequency);
    // Without a companion, a line that sets in while the teeth cut is chatter, and one that was there before is not.
    let humming = |begin: usize| {
        let mut record = CUT.record();
        for (i, value) in record.channels[0].values.iter_mut().enumerate().skip(begin) {
            *value += 0.1 * (TAU * 250.0 * i as f64 / 16_000.0).sin();
        }
        let spindle_speed = 6120.0 * TAU / 60.0;
        listen(&record, &Cutting { teeth: 3, spindle_speed, air: None, natural_frequencies: &[] }).unwrap().chatter
    };
    assert_eq!([humming(0), humming(16_000)], [Chatter::No, Chatter::Yes]);
}

#[test]
fn chatter_close_to_a_harmonic_of_the_teeth_is_heard() {
    // Beside harmonics of the teeth, where the companions of the chatter stand beside others of them at the same distance.
    let mut wrong = Vec::new();
    for i in 0..30u32 {
        let (teeth, speed) = (2 + i % 4, 4611.0 + 203.7 * f64::from(i));
        let offset = 3.5 + 0.5 * f64::from(i);
        let harmonic = speed / 60.0 * f64::from(teeth * (1 + i % 3));
        let frequency = harmonic + offset * if i % 2 == 0 { 1.0 } else { -1.0 };
        let heard = Cut { teeth, speed, chatter: Some((frequency, 0.1, 0.0)), seed: u64::from(i), ..CUT }.heard(speed);
        let found = heard.chatter_frequency.filter(|found| (found - frequency).abs() < 0.5);
        if heard.chatter != Chatter::Yes || found.is_none() {
            wrong
                .push(format!("{i}: {offset} Hz beside {harmonic}: {:?} {:?}", heard.chatter, heard.chatter_frequency));
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
}

#[test]
fn of_two_strong_lines_the_one_at_the_mode_is_the_chatter() {
    let cut = Cut { chatter: Some((841.7, 0.1, 0.0)), ..CUT };
    let mut record = cut.record();
    for (i, value) in record.channels[0].values.iter_mut().enumerate() {
        *value += 0.08 * (TAU * 1253.3 * i as f64 / 16_000.0).sin();
    }
    let spindle_speed = 6120.0 * TAU / 60.0;
    let at = |modes: &[f64]| {
        let cutting = Cutting { teeth: 3, spindle_speed, air: None, natural_frequencies: modes };
        listen(&record, &cutting).unwrap().chatter_frequency.unwrap()
    };
    assert!((at(&[]) - 841.7).abs() < 0.2 && (at(&[1250.0]) - 1253.3).abs() < 0.2);
}

#[test]
fn a_record_without_teeth_is_refused() {
    let mut record = CUT.record();
    let hear = |record: &Record, rpm: f64| {
        let spindle_speed = rpm * TAU / 60.0;
        listen(record, &Cutting { teeth: 3, spindle_speed, air: None, natural_frequencies: &[] })
    };
    let text = hear(&record, 7300.0).unwrap_err().to_string();
    assert!(text.contains("within 3 % of 7300 rpm"), "{text}");
    record.channels[0].values.truncate(1000);
    assert!(hear(&record, 6120.0).unwrap_err().to_string().contains("sixteen revolutions"));
}

#[test]
fn a_cut_at_another_speed_is_not_taken_for_chatter() {
    let mut wrong = Vec::new();
    for (teeth, told) in [(2, 2.0), (4, 2.0), (3, 2.0), (4, 4.0 / 3.0), (4, 0.75), (6, 1.5), (4, 4.0)] {
        let cut = Cut { teeth, seed: u64::from(teeth), ..CUT };
        let spindle_speed = told * cut.speed * TAU / 60.0;
        let cutting = Cutting { teeth, spindle_speed, air: None, natural_frequencies: &[] };
        match listen(&cut.record(), &cutting) {
            Err(refused) if refused.to_string().contains("harmonics of 6120.0 rpm") => {}
            // Without lines of runout where the teeth would be heard there is nothing to begin with.
            Err(refused) if refused.to_string().contains("no harmonics of spindle and teeth") => {}
            Ok(heard) if heard.chatter == Chatter::No => {}
            other => wrong.push(format!("{teeth} teeth, {told} times the speed: {other:?}")),
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    // At half a harmonic of the spindle chatter is still chatter.
    for order in [5.5, 7.5] {
        let frequency = order * CUT.speed / 60.0;
        let heard = Cut { teeth: 4, chatter: Some((frequency, 0.1, 0.0)), ..CUT }.heard(CUT.speed);
        assert_eq!(heard.chatter, Chatter::Yes);
    }
}

#[test]
fn silent_channels_are_passed_over_and_clipping_is_told() {
    let mut record = Cut { chatter: Some((847.3, 0.1, 0.0)), ..CUT }.record();
    let cutting = Cutting { teeth: 3, spindle_speed: CUT.speed * TAU / 60.0, air: None, natural_frequencies: &[] };
    let plain = listen(&record, &cutting).unwrap();
    assert!(plain.notes.is_empty(), "{:?}", plain.notes);
    let sound = record.channels[0].clone();
    record.channels.insert(0, Channel { values: vec![0.25; sound.values.len()], ..sound.clone() });
    let second = listen(&record, &cutting).unwrap();
    assert_eq!((second.chatter_frequency, second.lines), (plain.chatter_frequency, plain.lines));
    assert_eq!(second.notes, ["channel 2 of 2 is heard, those before it are constant"]);
    record.channels.pop();
    let refused = listen(&record, &cutting).unwrap_err().to_string();
    assert!(refused.contains("no sample of its 1 channels differs"), "{refused}");
    record.channels[0].values = sound.values.iter().map(|value| value.clamp(-0.3, 0.3)).collect();
    let clipped = listen(&record, &cutting).unwrap();
    assert_eq!(clipped.chatter, Chatter::Yes);
    assert!((clipped.chatter_frequency.unwrap() - 847.3).abs() < 0.5);
    assert!(clipped.notes[0].contains("clipped"), "{:?}", clipped.notes);
}

/// The record of [`CUT`] with four teeth and `harmonics` of them, sampled `rate` times a second without a filter.
fn unfiltered(rate: f64, harmonics: u32, chatter: Option<f64>) -> Record {
    let mut random = ChaCha8Rng::seed_from_u64(7);
    let spindle = 6133.7 / 60.0;
    let mut lines: Vec<(f64, f64)> = (1..=4 * harmonics)
        .map(|k| (f64::from(k) * spindle, if k % 4 == 0 { 1.2 / f64::from(k) } else { 0.08 / f64::from(k) }))
        .collect();
    lines.extend(chatter.map(|frequency| (frequency, 0.1)));
    let value = |i: i32| {
        let time = f64::from(i) / rate;
        let noise: f64 = StandardNormal.sample(&mut random);
        lines.iter().map(|(frequency, amplitude)| amplitude * (TAU * frequency * time + frequency).sin()).sum::<f64>()
            + 0.003 * noise
    };
    let values = (0..(2.0 * rate) as i32).map(value).collect();
    let channel = Channel { signal: Signal::Sound, direction: Direction::X, values };
    Record { source: "cut.wav".to_owned(), rate, channels: vec![channel] }
}

#[test]
fn a_record_says_how_far_it_tells_and_one_that_holds_too_few_harmonics_is_refused() {
    let cutting = Cutting { teeth: 4, spindle_speed: 6120.0 * TAU / 60.0, air: None, natural_frequencies: &[] };
    let heard = listen(&unfiltered(4000.0, 4, Some(1100.0)), &cutting).unwrap();
    assert!(heard.notes.iter().any(|note| note.contains("up to 1800 Hz")), "{:?}", heard.notes);
    let of_modes = Cutting { natural_frequencies: &[700.0, 3100.0], ..cutting.clone() };
    let heard = listen(&unfiltered(4000.0, 4, Some(1100.0)), &of_modes).unwrap();
    assert!(heard.notes[0].contains("a mode of the lobes file is at 3100 Hz"), "{:?}", heard.notes);
    let text = listen(&unfiltered(2000.0, 40, None), &cutting).unwrap_err().to_string();
    assert!(text.contains("hold fewer than 3 harmonics of the teeth") && text.contains("2802"), "{text}");
    let heard = listen(&unfiltered(16_000.0, 6, Some(3100.0)), &cutting).unwrap();
    assert!(heard.chatter == Chatter::Yes && heard.notes.is_empty(), "{:?}", heard.notes);
}

/// Without a filter harmonics of the teeth from beyond half of the sampling rate stand folded between the others.
#[test]
fn folded_harmonics_of_the_teeth_are_no_chatter() {
    let cutting = Cutting { teeth: 4, spindle_speed: 6120.0 * TAU / 60.0, air: None, natural_frequencies: &[] };
    let mut folded = 0;
    for rate in [4000.0, 5000.0, 6000.0, 7350.0] {
        let heard = listen(&unfiltered(rate, 24, None), &cutting).unwrap();
        assert_eq!(heard.chatter, Chatter::No, "{rate}: {:?}", heard.lines);
        assert!(heard.notes.iter().any(|note| note.contains("no filter against aliasing")), "{:?}", heard.notes);
        // Beside a harmonic of the spindle a folded line counts as one of it.
        folded += usize::from(heard.lines.iter().any(|line| matches!(line.origin, Origin::Folded(_))));
    }
    assert!(folded >= 2, "{folded}");
}

/// Chatter at 3100 Hz stands at 900 Hz among 4000 samples a second, and nothing in such a record tells the two apart.
#[test]
fn chatter_beyond_half_of_the_sampling_rate_is_not_told_at_the_wrong_place() {
    let cutting = Cutting { teeth: 4, spindle_speed: 6120.0 * TAU / 60.0, air: None, natural_frequencies: &[] };
    let record = |harmonics| unfiltered(4000.0, harmonics, Some(3100.0));
    // The teeth stand folded as well: the recorder has no filter.
    let heard = listen(&record(24), &cutting).unwrap();
    assert!(heard.chatter == Chatter::Yes && heard.chatter_frequency.is_none(), "{heard:?}");
    let possible = &heard.possible_frequencies;
    let due = [900.0, 3100.0, 4900.0];
    assert!(possible.len() == 3 && possible.iter().zip(due).all(|(a, b)| (a - b).abs() < 0.5), "{possible:?}");
    assert!(heard.suggested_speeds(4, 100.0, 2000.0).is_empty());
    // A mode decides.
    let heard = listen(&record(24), &Cutting { natural_frequencies: &[650.0, 3040.0], ..cutting.clone() }).unwrap();
    assert!((heard.chatter_frequency.unwrap() - 3100.0).abs() < 0.5, "{heard:?}");
    assert!(heard.suggested_speeds(4, 100.0, 2000.0).len() > 2);
    // Beyond the sampling rate, too, where the line of the chatter is told for it.
    let heard = listen(&record(24), &Cutting { natural_frequencies: &[4850.0], ..cutting.clone() }).unwrap();
    assert!((heard.chatter_frequency.unwrap() - 4900.0).abs() < 0.5, "{heard:?}");
    let own = heard.lines.iter().find(|line| line.origin == Origin::Chatter(0)).expect("the line of the chatter");
    assert!((own.frequency - 900.0).abs() < 1.0, "{own:?}");
    // Nothing of the teeth is folded: the place where the line stands, and the one where it may come from.
    let heard = listen(&record(4), &cutting).unwrap();
    assert!((heard.chatter_frequency.unwrap() - 900.0).abs() < 0.5);
    assert!(heard.notes.iter().any(|note| note.contains("may be at 3100.0 Hz")), "{:?}", heard.notes);
    let heard = listen(&record(4), &Cutting { natural_frequencies: &[3040.0], ..cutting }).unwrap();
    assert_eq!((heard.chatter_frequency, heard.possible_frequencies.len()), (None, 2));
}
