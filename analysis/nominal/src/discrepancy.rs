//! What a smooth error of the equations is a function of, and on what it acts.

use super::{Measured, Role, Surface};

/// What a discrepancy is a function of, and which channels may have one.
#[derive(Clone, Debug)]
pub struct Discrepancy {
    /// Standardised coordinates of every row.
    pub points: Vec<Vec<f64>>,
    /// Classes of channels that share their equations.
    pub classes: Vec<Discrepant>,
}

/// A class of channels with a discrepancy.
#[derive(Clone, Debug)]
pub struct Discrepant {
    /// Name.
    pub name: &'static str,
    /// Channels.
    pub channels: Vec<usize>,
    /// Scale of the half-normal prior of its amplitude, relative to what it acts on.
    pub scale: f64,
    /// What it acts on.
    pub on: On,
}

/// What a discrepancy acts on.
#[derive(Clone, Debug)]
pub enum On {
    /// The value of the channel.
    Value,
    /// A quantity of the row, in SI units of the channel.
    Quantity(Vec<f64>),
    /// What a row adds to the reading, SI: the deviations of a life add up.
    Growth(Vec<f64>),
}

impl Discrepant {
    /// Surfaces of unit amplitude.
    pub fn surfaces(&self, measured: &Measured, features: &[Vec<f64>]) -> Vec<Surface> {
        let surface = |(index, feature): (usize, &Vec<f64>)| Surface {
            name: format!("{}, discrepancy {}", self.name, index + 1),
            channels: self.channels.clone(),
            feature: self.acting(measured, feature),
            deviation: self.scale,
            role: Role::Allowance,
            absolute: !matches!(self.on, On::Value),
        };
        features.iter().enumerate().map(surface).collect()
    }

    fn acting(&self, measured: &Measured, feature: &[f64]) -> Vec<f64> {
        match &self.on {
            On::Value => feature.to_vec(),
            On::Quantity(quantity) => feature.iter().zip(quantity).map(|(a, b)| a * b).collect(),
            On::Growth(growth) => {
                let groups = &measured.group_of_row;
                let mut sums = vec![0.0; measured.groups.len()];
                let rows = feature.iter().zip(growth).zip(groups);
                rows.map(|((feature, growth), group)| {
                    sums[*group] += feature * growth;
                    sums[*group]
                })
                .collect()
            }
        }
    }
}
