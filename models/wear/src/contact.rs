//! The flank contact under one cut, at any state of wear.

use crate::emf::Junction;
use crate::temperature::Heating;
use crate::wear::Wear;
use crate::{Cut, Load, Measurement, Pair};
use toolroom_process::{Number, record};

record! {
    /// What can be known of the edge at one instant.
    pub struct Point {
        /// Contact temperature at the flank, theta.
        temperature: Real["K" => "K"] = 293.15, 0.0..=1e5;
        /// Mechanical wear per path, A.
        mechanical_wear_per_path: Real["1" => "um/m"] = 0.0, 0.0..=1e3;
        /// Thermal wear rate, B.
        thermal_wear_rate: Real["m/s" => "um/min"] = 0.0, 0.0..=1e6;
        /// Wear per path, J = A + B/v; A alone at rest.
        wear_intensity: Real["1" => "um/m"] = 0.0, 0.0..=1e9;
        /// Balance of the weighted functionals, (w_M·A - w_T·B/v)/(w_M·A + w_T·B/v): positive
        /// where more speed means less wear per path, 0 at the minimum.
        wear_balance: Real = 0.0, -1.0..=1.0;
        /// Cutting force P_z.
        cutting_force: Real["N" => "N"] = 0.0, 0.0..=1e9;
        /// Feed force P_x.
        feed_force: Real["N" => "N"] = 0.0, 0.0..=1e9;
        /// Cutting power P_z·v.
        spindle_power: Real["W" => "kW"] = 0.0, 0.0..=1e9;
        /// Thermo-EMF of the tool–work pair.
        thermo_emf: Real["V" => "mV"] = 0.0, -10.0..=10.0;
    }
}

/// The flank contact of a [`Pair`] under one [`Cut`]: everything that does not depend on the
/// state of the edge, computed once.
#[derive(Clone, Copy, Debug)]
pub struct Contact<'a, N: Copy = f64> {
    pub(crate) pair: &'a Pair<N>,
    pub(crate) coefficients: Coefficients<N>,
}

/// The numbers of a [`Contact`] without its pair, for whoever keeps them: they hold as long as
/// neither the cut nor a parameter of the pair changes.
#[derive(Clone, Copy, Debug)]
pub struct Coefficients<N: Copy = f64> {
    pub(crate) cut: Cut<N>,
    heating: Heating<N>,
    level: Wear<N>,
    damage_gain: N,
}

impl<N: Number> Coefficients<N> {
    /// Brings them to another cutting speed (m/s), as [`Contact::at_speed`] does; `pair` is that of their contact.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let pair = Pair::default();
    /// let contact = pair.contact(&pair.reference_cut());
    /// let mut kept = contact.coefficients();
    /// kept.change_speed(&pair, 0.4);
    /// assert_eq!(pair.contact_of(kept).rise(0.2e-3), contact.at_speed(0.4).rise(0.2e-3));
    /// ```
    #[inline]
    pub fn change_speed(&mut self, pair: &Pair<N>, cutting_speed: N) {
        self.cut.cutting_speed = cutting_speed;
        self.heating = pair.temperature.at_speed(&self.heating, cutting_speed);
        self.level = pair.law.level_at_speed(self.level, &self.cut);
    }
}

impl<N: Number> Pair<N> {
    /// The contact under `cut`.
    pub fn contact(&self, cut: &Cut<N>) -> Contact<'_, N> {
        Contact {
            pair: self,
            coefficients: Coefficients {
                cut: *cut,
                heating: self.temperature.heating(cut),
                level: self.law.level(cut),
                damage_gain: self.damage_terms(cut).1,
            },
        }
    }

    /// The contact that had these [`Contact::coefficients`].
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let pair = Pair::default();
    /// let kept = pair.contact(&pair.reference_cut()).coefficients();
    /// assert_eq!(pair.contact_of(kept).rise(0.2e-3), pair.contact(&pair.reference_cut()).rise(0.2e-3));
    /// ```
    #[inline]
    pub fn contact_of(&self, coefficients: Coefficients<N>) -> Contact<'_, N> {
        Contact { pair: self, coefficients }
    }

    /// Quasi-steady point: the tool body is as warm as this cut makes it, no thermal damage.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Cut, Pair};
    /// let point = Pair::named("ni_vk6om").unwrap().point(&Cut::default(), 0.2e-3);
    /// assert!((point.temperature - 1028.916).abs() < 1e-3);
    /// assert!((point.wear_intensity - 0.5000084e-6).abs() < 1e-12);
    /// ```
    pub fn point(&self, cut: &Cut<N>, flank_wear: N) -> Point<N> {
        let contact = self.contact(cut);
        contact.point(&self.force.load(cut), flank_wear, contact.rise(flank_wear), N::from(0.0))
    }
}

impl<'a, N: Number> Contact<'a, N> {
    /// The same cut at another speed; cheaper than a new contact.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let (pair, v) = (Pair::default(), 30.0 / 60.0);
    /// let cut = pair.reference_cut();
    /// let fast = pair.contact(&cut).at_speed(v).steady_temperature(0.2e-3);
    /// assert_eq!(fast, pair.contact(&cut.at_speed(v)).steady_temperature(0.2e-3));
    /// ```
    #[inline]
    pub fn at_speed(&self, cutting_speed: N) -> Self {
        let mut contact = *self;
        contact.coefficients.change_speed(self.pair, cutting_speed);
        contact
    }

    /// [`Contact::at_speed`] within 1e-9, at less cost where the speed is within 3 % of the present one.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let pair = Pair::default();
    /// let contact = pair.contact(&pair.reference_cut().at_speed(0.5));
    /// let (near, exact) = (contact.near_speed(0.51), contact.at_speed(0.51));
    /// assert!((near.rise(0.2e-3) / exact.rise(0.2e-3) - 1.0).abs() < 1e-9);
    /// ```
    #[inline]
    pub fn near_speed(&self, cutting_speed: N) -> Self {
        let change = cutting_speed / self.coefficients.cut.cutting_speed - 1.0;
        if change.re().abs() > 0.03 || change.re().is_nan() {
            return self.at_speed(cutting_speed);
        }
        let cut = Cut { cutting_speed, ..self.coefficients.cut };
        let coefficients = Coefficients {
            heating: self.pair.temperature.near_speed(&self.coefficients.heating, change),
            level: self.pair.law.level_at_speed(self.coefficients.level, &cut),
            cut,
            ..self.coefficients
        };
        Contact { coefficients, ..*self }
    }

    /// The contact under `cut`, which differs from that of this contact in nothing but factors of
    /// wear and temperature, and what is added to damage and chipping; cheaper than a new contact.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::{Cut, Pair};
    /// let pair = Pair::default();
    /// let cut = pair.reference_cut();
    /// let hot = Cut { temperature_factor: 1.1, ..cut };
    /// let (again, anew) = (pair.contact(&cut).with_factors(&hot), pair.contact(&hot));
    /// assert!((again.rise(0.2e-3) / anew.rise(0.2e-3) - 1.0).abs() < 1e-12);
    /// ```
    #[inline]
    pub fn with_factors(&self, cut: &Cut<N>) -> Self {
        let before = &self.coefficients.cut;
        let wear = cut.wear_factor / before.wear_factor;
        let coefficients = Coefficients {
            cut: *cut,
            heating: self.coefficients.heating.times(cut.temperature_factor / before.temperature_factor),
            level: Wear {
                mechanical_per_path: self.coefficients.level.mechanical_per_path
                    * wear
                    * (cut.mechanical_factor / before.mechanical_factor),
                thermal_rate: self.coefficients.level.thermal_rate
                    * wear
                    * (cut.thermal_factor / before.thermal_factor),
            },
            damage_gain: self.pair.damage_terms(cut).1,
        };
        Contact { coefficients, ..*self }
    }

    /// The contact of an edge that wears by `factor` faster.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let pair = Pair::default();
    /// let contact = pair.contact(&pair.reference_cut());
    /// let (own, faster) = (contact.steady_wear(0.2e-3), contact.wearing(1.5).steady_wear(0.2e-3));
    /// assert!((faster.thermal_rate / own.thermal_rate - 1.5).abs() < 1e-12);
    /// ```
    #[inline]
    pub fn wearing(&self, factor: N) -> Self {
        let mut contact = *self;
        contact.coefficients.cut.wear_factor *= factor;
        contact.coefficients.level.mechanical_per_path *= factor;
        contact.coefficients.level.thermal_rate *= factor;
        contact
    }

    /// The cut of this contact.
    #[inline]
    pub fn cut(&self) -> &Cut<N> {
        &self.coefficients.cut
    }

    /// Ambient temperature, K.
    #[inline]
    pub fn ambient(&self) -> N {
        self.pair.temperature.ambient_temperature
    }

    /// What is to be kept of it for [`Pair::contact_of`].
    #[inline]
    pub fn coefficients(&self) -> Coefficients<N> {
        self.coefficients
    }

    /// Temperature rise by chip and flank in cut, K.
    #[inline]
    pub fn rise(&self, flank_wear: N) -> N {
        self.coefficients.heating.chip + self.coefficients.heating.flank(flank_wear)
    }

    /// Quasi-steady contact temperature, K.
    #[inline]
    pub fn steady_temperature(&self, flank_wear: N) -> N {
        let rise = self.rise(flank_wear);
        self.temperature(rise, rise)
    }

    /// Contact temperature at a temperature rise of chip and flank and one of the body, K.
    #[inline]
    pub fn temperature(&self, rise: N, body: N) -> N {
        let share = self.pair.temperature.body_share;
        self.pair.temperature.ambient_temperature
            + (-share + 1.0) * (rise * self.coefficients.cut.engaged)
            + share * body
    }

    /// Wear at a contact temperature.
    #[inline]
    pub fn wear(&self, flank_wear: N, temperature: N, damage: N) -> Wear<N> {
        self.pair.law.wear(self.coefficients.level, flank_wear, temperature, damage, self.coefficients.damage_gain)
    }

    /// Quasi-steady wear without damage.
    #[inline]
    pub fn steady_wear(&self, flank_wear: N) -> Wear<N> {
        self.wear(flank_wear, self.steady_temperature(flank_wear), N::from(0.0))
    }

    /// `∂ ln theta / ∂ ln v` at a quasi-steady contact temperature, χ.
    pub fn speed_sensitivity(&self, flank_wear: N, temperature: N) -> N {
        let flank = self.coefficients.heating.flank(flank_wear);
        (self.pair.temperature.speed_exponent * self.coefficients.heating.chip + flank * 0.5) / temperature
    }

    /// `w_M·A` and `w_T·B/v`, whose difference is `-∂J/∂ln v`, quasi-steady.
    pub(crate) fn balance(&self, flank_wear: N, temperature: N, wear: Wear<N>) -> (N, N) {
        let chi = self.speed_sensitivity(flank_wear, temperature);
        let (mechanical, thermal) = self.pair.law.weights(temperature, chi);
        (mechanical * wear.mechanical_per_path, thermal * wear.thermal_rate / self.coefficients.cut.cutting_speed)
    }

    /// Everything at a state of the edge under the forces of the same cut; `body` is the tool
    /// body's temperature rise.
    pub fn point(&self, load: &Load<N>, flank_wear: N, body: N, damage: N) -> Point<N> {
        self.point_of_chip(load, flank_wear, body, damage, self.pair.force.chip_thickness(&self.coefficients.cut))
    }

    /// The same with the chip thickness (m) of this cut, [`Force::chip_thickness`](crate::Force::chip_thickness), for whoever
    /// knows it already.
    ///
    /// # Examples
    /// ```
    /// use toolroom_wear::Pair;
    /// let pair = Pair::default();
    /// let cut = pair.reference_cut();
    /// let (contact, load, chip) = (pair.contact(&cut), pair.force.load(&cut), pair.force.chip_thickness(&cut));
    /// assert_eq!(
    ///     contact.point_of_chip(&load, 0.2e-3, 700.0, 0.0, chip).thermo_emf,
    ///     contact.point(&load, 0.2e-3, 700.0, 0.0).thermo_emf
    /// );
    /// ```
    pub fn point_of_chip(&self, load: &Load<N>, flank_wear: N, body: N, damage: N, chip_thickness: N) -> Point<N> {
        let cut = &self.coefficients.cut;
        let temperature = self.temperature(self.rise(flank_wear), body);
        let wear = self.wear(flank_wear, temperature, damage);
        let cutting_force = load.cutting(flank_wear) * cut.engaged;
        Point {
            temperature,
            mechanical_wear_per_path: wear.mechanical_per_path,
            thermal_wear_rate: wear.thermal_rate,
            wear_intensity: self.wear_intensity(wear),
            wear_balance: self.wear_balance(flank_wear, temperature, wear),
            cutting_force,
            feed_force: load.feed(flank_wear) * cut.engaged,
            spindle_power: cutting_force * cut.cutting_speed,
            thermo_emf: self.thermo_emf_of_chip(flank_wear, temperature, chip_thickness),
        }
    }

    /// What sensors without error show at a state of the edge under the forces of the same cut;
    /// `body` is the tool body's temperature rise.
    pub fn measurement(&self, load: &Load<N>, flank_wear: N, body: N) -> Measurement<N> {
        let cut = self.cut();
        let temperature = self.temperature(self.rise(flank_wear), body);
        Measurement {
            spindle_power: load.cutting(flank_wear) * cut.engaged * cut.cutting_speed,
            feed_force: load.feed(flank_wear) * cut.engaged,
            thermo_emf: self.thermo_emf(flank_wear, temperature),
        }
    }

    /// Thermo-EMF at a contact temperature, V.
    pub(crate) fn thermo_emf(&self, flank_wear: N, temperature: N) -> N {
        self.thermo_emf_of_chip(flank_wear, temperature, self.pair.force.chip_thickness(&self.coefficients.cut))
    }

    /// Wear per path at rates of wear; the mechanical part alone at rest.
    #[inline]
    pub fn wear_intensity(&self, wear: Wear<N>) -> N {
        let speed = self.coefficients.cut.cutting_speed;
        if speed.re() > 0.0 { wear.intensity(speed) } else { wear.mechanical_per_path }
    }

    /// Balance of the weighted functionals at a land (m), a contact temperature (K) and the rates of wear there, see
    /// [`Point::wear_balance`]; 0 at rest.
    #[inline]
    pub fn wear_balance(&self, flank_wear: N, temperature: N, wear: Wear<N>) -> N {
        if self.coefficients.cut.cutting_speed.re() <= 0.0 {
            return N::from(0.0);
        }
        let (mechanical, thermal) = self.balance(flank_wear, temperature, wear);
        let sum = mechanical.abs() + thermal.abs();
        if sum.re() > 0.0 { (mechanical - thermal) / sum } else { N::from(0.0) }
    }

    /// Thermo-EMF (V) at a land (m), a contact temperature (K) and the chip thickness (m) of the cut.
    #[inline]
    pub fn thermo_emf_of_chip(&self, flank_wear: N, temperature: N, chip_thickness: N) -> N {
        let pair = self.pair;
        let junction = Junction {
            ambient: pair.temperature.ambient_temperature,
            chip: self.coefficients.heating.chip,
            temperature,
            chip_thickness,
            land: flank_wear + pair.temperature.land_offset,
        };
        pair.emf.value(junction) * self.coefficients.cut.engaged
    }
}

impl<'a> Contact<'a> {
    /// The same contact of a pair lifted to another number type, for derivatives by the state.
    pub(crate) fn lift<N: Number>(&self, pair: &'a Pair<N>) -> Contact<'a, N> {
        let coefficients = Coefficients {
            cut: self.coefficients.cut.map(N::from),
            heating: self.coefficients.heating.map(N::from),
            level: Wear {
                mechanical_per_path: N::from(self.coefficients.level.mechanical_per_path),
                thermal_rate: N::from(self.coefficients.level.thermal_rate),
            },
            damage_gain: N::from(self.coefficients.damage_gain),
        };
        pair.contact_of(coefficients)
    }
}
