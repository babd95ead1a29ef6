//! G codes: what each is in each language.

use super::modes::Move;
use super::once::Once;
use super::polar::Polar;
use super::run::Iso;
use super::words::Words;
use crate::Dialect;
use crate::control::Units;
use crate::error::{Fault, unknown};
use crate::kernel::{FeedMode, Kernel};
use crate::motion::{Offset, PLANES};
use crate::offset::{Corner, Offsetting};

/// Speed at the axis of a lathe where no greatest one is known, rpm (assumption); a feed there is refused before.
const FASTEST: f64 = 1e5;

/// What a code is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum CodeKind {
    Modal,
    Motion(Move),
    Once(Once),
    ExactStop,
}

impl Iso {
    pub(super) fn plane(&mut self, plane: [usize; 3], kernel: &mut Kernel) -> Result<(), Fault> {
        if plane == kernel.plane {
            return Ok(());
        }
        if self.modes.rotation.is_some() || kernel.offset.is_some() {
            return Err(Fault::new(
                "the plane changes while a rotation or the compensation of the radius is in force; end it before",
            ));
        }
        kernel.plane = plane;
        Ok(())
    }

    pub(super) fn compensate(&mut self, code: u32, words: &mut Words, kernel: &mut Kernel) -> Result<(), Fault> {
        kernel.finish_offset()?;
        if code == 400 {
            return Ok(());
        }
        let left = matches!(code, 410 | 411);
        kernel.side = Some(left);
        if self.is_lathe() {
            kernel.note("the radius of the nose is not known here; the contour is timed as programmed");
            return Ok(());
        }
        if matches!(code, 411 | 421) {
            // LinuxCNC takes the diameter itself.
            let diameter = words.take(b'D').ok_or_else(|| Fault::new("G41.1 and G42.1 need D, the diameter"))?;
            let radius = 0.5 * self.mm(kernel, words, b'D', diameter)?;
            if radius > 0.0 {
                kernel.compensate(Offsetting::new(left, radius, kernel.plane, Corner::Round).left_at_once());
            }
            return Ok(());
        }
        let register = words.whole(b'D', 0.0, 9999.0)?;
        // D holds until another one; LinuxCNC takes the tool in the spindle where there is none.
        let register = match register {
            None if self.dialect != Dialect::LinuxCnc => self.modes.register,
            register => register,
        };
        self.modes.register = register;
        if register == Some(0) {
            return Ok(());
        }
        let number = register.or(kernel.tool);
        let diameter = number.and_then(|number| kernel.control.diameters.get(&number)).copied();
        let Some(diameter) = diameter else {
            let which = number.map_or("the tool".to_owned(), |number| format!("D{number}"));
            kernel.note(format!(
                "the diameter of {which} is not known, so the contour is timed as programmed: give --tool D{}=\"10 mm\"",
                number.unwrap_or(1)
            ));
            return Ok(());
        };
        let corner = if self.dialect == Dialect::Fanuc { Corner::Extended } else { Corner::Round };
        let offset = Offsetting::new(left, 0.5 * diameter, kernel.plane, corner);
        kernel.compensate(if self.dialect == Dialect::LinuxCnc { offset.left_at_once() } else { offset });
        Ok(())
    }

    pub(super) fn modal(&mut self, code: u32, words: &mut Words, kernel: &mut Kernel) -> Result<CodeKind, Fault> {
        use CodeKind::{ExactStop, Modal};
        let (linuxcnc, haas, lathe) =
            (self.dialect == Dialect::LinuxCnc, self.dialect == Dialect::Haas, self.is_lathe());
        let macros = self.macros();
        let calls = words.m.iter().any(|(code, _)| matches!(code, 97 | 98));
        let additional = |number: f64| (1.0..=300.0).contains(&number) && number.fract() == 0.0;
        let refuse = |reason: &str| Err(Fault::new(format!("G{}: {reason}", written(code))).refusing());
        Ok(match code {
            0 => CodeKind::Motion(Move::Rapid),
            10 => CodeKind::Motion(Move::Line),
            20 | 30 => CodeKind::Motion(Move::Arc { left: code == 30 }),
            40 => CodeKind::Once(Once::Dwell),
            50 if linuxcnc => CodeKind::Once(Once::Spline(true)),
            51 if linuxcnc => CodeKind::Once(Once::Spline(false)),
            51 | 80 if macros => {
                words.spend(b"PQR");
                Modal
            }
            // G5 P10000 and P0 switch the look-ahead for programs of many short blocks.
            50 if macros => match words.whole(b'P', 0.0, 99_999.0)? {
                Some(0 | 1 | 2 | 3 | 10_000) => Modal,
                _ => return refuse("only P10000 and P0, the look-ahead for short blocks, are followed"),
            },
            70 if linuxcnc => return refuse("diameters of a lathe are not followed for LinuxCNC; write G8 and radii"),
            80 if linuxcnc => Modal,
            90 if macros => ExactStop,
            100 => CodeKind::Once(Once::Data),
            150 if !lathe && macros => {
                self.modes.polar = None;
                Modal
            }
            160 if !lathe && macros => {
                self.modes.polar = Some(Polar::default());
                Modal
            }
            170 | 180 | 190 => {
                self.plane(PLANES[code as usize / 10 - 17], kernel)?;
                Modal
            }
            200 | 210 => {
                kernel.scale = Some(if code == 200 { Units::Inch } else { Units::Millimetre }.scale());
                Modal
            }
            // The place of the tool becomes the one that G28 or G30 goes to; nothing moves.
            281 | 301 if linuxcnc => Modal,
            280 | 300 => CodeKind::Once(Once::Home),
            320 | 330 if lathe => CodeKind::Motion(Move::Thread),
            331 if linuxcnc => CodeKind::Once(Once::RigidTap),
            330 if linuxcnc => CodeKind::Motion(Move::Thread),
            382..=385 => return refuse("a probe moves until it touches, which depends on the workpiece"),
            310 => return refuse("a skip ends where a signal comes, which depends on the workpiece"),
            400 | 410 | 420 | 411 | 421 if linuxcnc || !matches!(code, 411 | 421) => {
                self.compensate(code, words, kernel)?;
                Modal
            }
            432 if linuxcnc => {
                words.whole(b'H', 0.0, 9999.0)?;
                words.spend(b"XYZ");
                Modal
            }
            430 | 440 | 431 | 490 if !lathe => {
                if code == 431 {
                    words.spend(b"XYZ");
                }
                let register = words.whole(b'H', 0.0, 9999.0)?.filter(|register| *register > 0);
                kernel.offset_by(Offset::Length(if code == 490 { None } else { register.or(kernel.tool) }));
                Modal
            }
            434 | 435 => {
                return refuse("control of the tool's tip moves rotary axes with linear ones, which is not followed");
            }
            500 if lathe => CodeKind::Once(Once::Set),
            500 if macros => {
                self.modes.scaling = None;
                kernel.frame = self.modes.frame(kernel.plane);
                Modal
            }
            510 if macros && !lathe => CodeKind::Once(Once::Scale),
            501 if macros && !lathe => {
                if !words.any(b"XYZ") {
                    self.modes.mirror = [None; 3];
                    kernel.frame = self.modes.frame(kernel.plane);
                    return Ok(Modal);
                }
                CodeKind::Once(Once::Mirror(false))
            }
            511 if macros && !lathe => CodeKind::Once(Once::Mirror(true)),
            520 if macros || linuxcnc => CodeKind::Once(Once::Local),
            530 => CodeKind::Once(Once::Machine),
            // G54 P5 is G54.1 P5; P may belong to a call or a hole of the block instead.
            540 if macros && !calls && !words.has(b'R') && words.see(b'P').is_some_and(additional) => {
                let number = words.whole(b'P', 1.0, 300.0)?.unwrap_or(1);
                self.system(100 + number, kernel);
                Modal
            }
            540 | 550 | 560 | 570 | 580 | 590 => {
                self.system(code / 10 - 53, kernel);
                Modal
            }
            591..=593 if linuxcnc => {
                self.system(code - 591 + 7, kernel);
                Modal
            }
            541 | 1540 if macros => {
                let number =
                    words.whole(b'P', 1.0, 300.0)?.ok_or_else(|| Fault::new("the offset needs P, its number"))?;
                self.system(100 + number, kernel);
                Modal
            }
            1100..=1290 if haas && code.is_multiple_of(10) => {
                self.system(101 + (code - 1100) / 10, kernel);
                Modal
            }
            610 | 611 => {
                kernel.exact = true;
                Modal
            }
            640 => {
                words.spend(b"PQ");
                kernel.exact = false;
                Modal
            }
            650 | 660 if macros => CodeKind::Once(Once::Macro),
            670 if macros => {
                self.modal_macro = None;
                Modal
            }
            680 if macros && !lathe => CodeKind::Once(Once::Rotate),
            690 if macros && !lathe => {
                self.modes.rotation = None;
                kernel.frame = self.modes.frame(kernel.plane);
                Modal
            }
            700 | 710 | 720 if haas => CodeKind::Once(Once::Pattern(code / 10)),
            700 | 710 | 720 | 730 | 740 | 750 | 760 if lathe => CodeKind::Once(Once::TwoBlocks(code / 10)),
            730 | 740 | 760 | 810..=890 if !lathe && code.is_multiple_of(10) => {
                self.begin_cycle(code / 10, kernel)?;
                CodeKind::Motion(Move::Cycle)
            }
            830..=850 | 870..=890 if lathe && code.is_multiple_of(10) => {
                self.begin_drilling(code / 10, kernel);
                CodeKind::Motion(Move::Drilling)
            }
            810..=890 if lathe && code.is_multiple_of(10) => {
                return refuse(
                    "the holes of a Fanuc lathe are G83 to G85 along Z and G87 to G89 along X; other formats are not followed",
                );
            }
            800 => {
                (self.cycle, self.drilling) = (None, None);
                if matches!(self.modes.motion, Move::Cycle | Move::Drilling) {
                    // LinuxCNC asks for a motion behind G80; others go on with what was before the cycle, mostly G0.
                    self.modes.motion = if linuxcnc { Move::Open } else { Move::Rapid };
                }
                Modal
            }
            900 | 920 | 940 if lathe => CodeKind::Motion(Move::Lathe(code / 10)),
            900 => {
                kernel.absolute = true;
                Modal
            }
            910 if !lathe => {
                kernel.absolute = false;
                Modal
            }
            901 | 911 if linuxcnc => {
                self.modes.arc_absolute = code == 901;
                Modal
            }
            920 => CodeKind::Once(Once::Set),
            921 | 922 if linuxcnc => {
                self.modes.set = [0.0; 9];
                kernel.frame = self.modes.frame(kernel.plane);
                Modal
            }
            930 if !lathe => {
                kernel.feed_mode = FeedMode::Inverse;
                Modal
            }
            940 | 950 if !lathe => {
                let mode = if code == 940 { FeedMode::Minute } else { FeedMode::Revolution };
                self.feed_mode(mode, words, kernel);
                Modal
            }
            960 => {
                if linuxcnc && let Some(clamp) = words.take(b'D') {
                    kernel.clamp = clamp;
                }
                if !lathe && !linuxcnc {
                    return refuse("constant surface speed on a mill has no time of its own here; write G97");
                }
                kernel.surface = kernel.surface.or(self.modes.surface).or(Some(0.0));
                if kernel.sense.stands() {
                    kernel.speed = 0.0;
                }
                Modal
            }
            970 => {
                // Without a speed of its own the spindle goes on as fast as it turned.
                self.modes.surface = kernel.surface.or(self.modes.surface);
                if let Some(surface) = kernel.surface.take().filter(|surface| *surface > 0.0)
                    && !words.has(b'S')
                {
                    let around = std::f64::consts::TAU * kernel.at[0].abs();
                    kernel.set_speed((surface / around).min(kernel.clamp).min(FASTEST))?;
                }
                Modal
            }
            980 | 990 if lathe => {
                let mode = if code == 980 { FeedMode::Minute } else { FeedMode::Revolution };
                self.feed_mode(mode, words, kernel);
                Modal
            }
            980 | 990 => {
                self.modes.initial_return = code == 980;
                Modal
            }
            1030 if haas => {
                words.spend(b"P");
                Modal
            }
            1870 if haas => {
                words.spend(b"PE");
                Modal
            }
            1500 => {
                return refuse(
                    "the pocket is a contour cycle of the control, which is not followed; post it as motions",
                );
            }
            120 | 130 if haas => CodeKind::Once(Once::Pocket(code == 130)),
            1000 | 1010 if haas => CodeKind::Once(Once::Mirror(code == 1010)),
            121 | 131 | 71 | 1070 => {
                return refuse("the cylinder or polar interpolation is not followed; post the motions of the axes");
            }
            _ => {
                if let Some(time) = kernel.control.g.get(&code) {
                    return Ok(CodeKind::Once(Once::TimeOnly(*time)));
                }
                return Err(Fault::new(unknown(&format!("G{}", written(code)), "g", &written(code))).refusing());
            }
        })
    }

    /// A feed a minute is none a revolution.
    pub(super) fn feed_mode(&mut self, mode: FeedMode, words: &Words, kernel: &mut Kernel) {
        if mode != kernel.feed_mode {
            kernel.feed_mode = mode;
            if !words.has(b'F') {
                kernel.feed = None;
            }
        }
    }
}

/// A code as it is written.
pub(super) fn written(code: u32) -> String {
    if code.is_multiple_of(10) { format!("{}", code / 10) } else { format!("{}.{}", code / 10, code % 10) }
}
