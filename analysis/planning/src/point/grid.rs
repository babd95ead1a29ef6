//! A process at many operating points at once: what does not change is read and checked once.

use super::evaluate::{advance, no_value, set_parameters, set_values};
use super::turning::{self, BESIDE, Beside};
use super::{PointError, PointOptions, PointProcess, effects, infeed, milling};
use crate::change::{ChangeError, parts};
use rayon::prelude::*;
use std::borrow::Cow;
use toolroom_cutting::Turning;
use toolroom_process::unit::{self, Unit};
use toolroom_process::{Field, Process, Record, watched};

/// A quantity that differs from point to point.
#[derive(Clone, Copy, Debug)]
pub struct Axis<'a> {
    /// An input, a state, or `group.name` of a parameter.
    pub key: &'a str,
    /// One value a point.
    pub values: &'a [f64],
    /// Unit of the values; empty for a ratio.
    pub unit: &'a str,
}

/// One column of a grid.
#[derive(Clone, Debug, PartialEq)]
pub enum Column {
    /// Numbers in the unit of the header; NaN where nothing is defined.
    Numbers(Vec<f64>),
    /// Words.
    Texts(Vec<Cow<'static, str>>),
}

/// Points worked out: columns by header, one row a point.
///
/// ```
/// use toolroom_planning::point::{Axis, Column, PointGrid, PointOptions, PointProcess};
/// let speed = Axis { key: "cutting_speed", values: &[30.0, 40.0], unit: "m/min" };
/// let grid = PointGrid::new(PointProcess::Turning, &PointOptions::default(), &[speed]).unwrap();
/// let (_, life) = grid.columns.iter().find(|(head, _)| head == "tool_life [min]").unwrap();
/// assert!(matches!(life, Column::Numbers(life) if life[0] > life[1]));
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct PointGrid {
    /// Name of the process.
    pub process: &'static str,
    /// Inputs, state and outputs, those of [`Point`](super::Point) in the same order and units; a quantity that is both a
    /// state and an output stands once.
    pub columns: Vec<(String, Column)>,
}

impl PointGrid {
    /// Evaluates a process at every point of `axes`, which are equally long; without axes at one point. The rows are
    /// those of as many [`Point`](super::Point)s bit for bit, whatever the number of threads.
    ///
    /// # Errors
    /// See [`PointError`]; the first point that is refused is told by its index.
    pub fn new(process: PointProcess, options: &PointOptions, axes: &[Axis<'_>]) -> Result<Self, PointError> {
        let effects = effects(options)?;
        match process {
            PointProcess::Turning => {
                let (turning, start) = turning::start(options, effects)?;
                let gave = turning::gives_body(options) || axes.iter().any(|axis| axis.key == turning::BODY);
                let model = options.life_model;
                let beside = |turning: &Turning, input: &_, state: &mut _| {
                    let Beside { numbers, ends_by } = turning::beside(turning, input, state, model, gave);
                    (numbers.to_vec(), vec![ends_by, model.name().into()])
                };
                grid(turning, start, options, axes, (&BESIDE[..3], &BESIDE[3..]), &beside)
            }
            PointProcess::Milling => {
                let (milling, start) = milling(options, effects)?;
                grid(milling, start, options, axes, (&[], &[]), &|_, _, _| (Vec::new(), Vec::new()))
            }
            PointProcess::Infeed => {
                let (infeed, start) = (infeed(options, effects)?, toolroom_infeed::Input::default());
                grid(infeed, start, options, axes, (&[], &[]), &|_, _, _| (Vec::new(), Vec::new()))
            }
        }
    }
}

/// Numbers and words that are worked out beside the outputs.
type Row = (Vec<f64>, Vec<Cow<'static, str>>);

/// Where the values of an axis go.
#[derive(Clone, Copy)]
enum Slot {
    /// Group of parameters, and element in it.
    Parameter(usize, usize),
    Input(usize),
    State(usize),
}

/// An axis with its place.
struct Bound<'a> {
    slot: Slot,
    field: &'static Field,
    values: &'a [f64],
    scale: Conversion,
}

impl Bound<'_> {
    /// The value of a point, in SI.
    fn value(&self, index: usize) -> Result<f64, PointError> {
        let value = self.scale.of(self.values[index]);
        let refused = |source| PointError::Change(ChangeError::OutOfRange { field: self.field, source });
        self.field.check(value).map_err(refused)?;
        Ok(value)
    }
}

/// [`unit::convert`] between two units that are read once.
#[derive(Clone, Copy)]
struct Conversion(Option<(Unit, Unit)>);

impl Conversion {
    fn new(from: &str, to: &str) -> Self {
        // Units of fields can be read; the same one needs no arithmetic.
        Self(if from == to { None } else { unit::parse(from).ok().zip(unit::parse(to).ok()) })
    }

    fn of(self, value: f64) -> f64 {
        match self.0 {
            None => value,
            Some((from, to)) => (value * from.factor + from.offset - to.offset) / to.factor,
        }
    }
}

fn grid<P: Process + Clone>(
    mut process: P,
    start: P::Input,
    options: &PointOptions,
    axes: &[Axis<'_>],
    (number_heads, text_heads): (&[&str], &[&str]),
    beside: &(impl Fn(&P, &P::Input, &mut P::State) -> Row + Sync),
) -> Result<PointGrid, PointError> {
    let changes = options.changes.iter().map(|text| parts(text)).collect::<Result<Vec<_>, _>>()?;
    set_parameters(&mut process, &changes)?;
    // The changes are tried before the first point.
    set_values::<P>(&mut { start }, &mut process.initial(), &changes)?;
    let points = axes.first().map_or(1, |axis| axis.values.len());
    let mut bounds = Vec::new();
    for (position, axis) in axes.iter().enumerate() {
        let twice = changes.iter().any(|(key, _)| *key == axis.key)
            || axes[..position].iter().any(|other| other.key == axis.key);
        if twice {
            return Err(PointError::Twice { key: axis.key.to_owned() });
        }
        if axis.values.len() != points {
            let (key, found) = (axis.key.to_owned(), axis.values.len());
            return Err(PointError::Lengths { key, found, expected: points });
        }
        bounds.push(bound(&mut process, axis)?);
    }
    let own_parameters = bounds.iter().any(|bound| matches!(bound.slot, Slot::Parameter(..)));
    let row = |index: usize| -> Result<Row, PointError> {
        let changed;
        let process = if own_parameters {
            let mut copy = process.clone();
            for bound in &bounds {
                if let Slot::Parameter(group, at) = bound.slot {
                    let value = bound.value(index)?;
                    copy.parameters_mut()[group].1.set_value(at, value);
                }
            }
            changed = copy;
            &changed
        } else {
            &process
        };
        let (mut input, mut state) = (start, process.initial());
        set_values::<P>(&mut input, &mut state, &changes)?;
        for bound in &bounds {
            match bound.slot {
                Slot::Parameter(..) => None,
                Slot::Input(at) => input.set(at, bound.value(index)?),
                Slot::State(at) => state.set(at, bound.value(index)?),
            };
        }
        advance(process, &mut input, &mut state, options)?;
        let at_state = || {
            let beside = beside(process, &input, &mut state);
            (beside, process.output(&state, &input))
        };
        let ((more, texts), output) = watched(at_state).map_err(PointError::Value)?;
        let mut numbers = vec![0.0; width(P::Input::FIELDS) + width(P::State::FIELDS) + width(P::Output::FIELDS)];
        let (inputs, rest) = numbers.split_at_mut(width(P::Input::FIELDS));
        let (states, outputs) = rest.split_at_mut(width(P::State::FIELDS));
        input.write_to(inputs);
        state.write_to(states);
        output.write_to(outputs);
        numbers.extend(more);
        Ok((numbers, texts))
    };
    let result = |index: usize| {
        let refused = |source| PointError::Row { index, source: Box::new(source) };
        row(index).map_err(|source| if axes.is_empty() { source } else { refused(source) })
    };
    let rows: Vec<Row> =
        (0..points).into_par_iter().map(result).collect::<Vec<_>>().into_iter().collect::<Result<_, _>>()?;
    let fields = [P::Input::FIELDS, P::State::FIELDS, P::Output::FIELDS].into_iter().flatten();
    let field_heads = fields.flat_map(|field| (0..field.len).map(move |element| (header(field, element), Some(field))));
    let heads = field_heads.chain(number_heads.iter().map(|head| ((*head).to_owned(), None)));
    let numbers = heads.enumerate().map(|(at, (head, field))| {
        let scale = Conversion::new(field.map_or("", |field| field.unit), field.map_or("", |field| field.display));
        (head, Column::Numbers(rows.iter().map(|(numbers, _)| scale.of(numbers[at])).collect()))
    });
    let mut columns: Vec<(String, Column)> = Vec::new();
    for (head, column) in numbers {
        // A quantity that is a state and an output is one column.
        if columns.iter().all(|(other, _)| *other != head) {
            columns.push((head, column));
        }
    }
    for (index, head) in text_heads.iter().enumerate() {
        columns.push(((*head).to_owned(), Column::Texts(rows.iter().map(|(_, texts)| texts[index].clone()).collect())));
    }
    Ok(PointGrid { process: P::NAME, columns })
}

fn width(fields: &[Field]) -> usize {
    fields.iter().map(|field| field.len).sum()
}

/// Header of an element of a field; elements of a field that has several are counted from 0.
fn header(field: &Field, element: usize) -> String {
    let header = field.header();
    if field.len == 1 { header } else { header.replacen(field.name, &format!("{}_{element}", field.name), 1) }
}

fn bound<'a, P: Process>(process: &mut P, axis: &Axis<'a>) -> Result<Bound<'a>, PointError> {
    let (slot, field) = match axis.key.split_once('.') {
        Some((group, name)) => {
            let groups = process.parameters_mut();
            let known = groups.iter().map(|(name, _)| *name).collect();
            let Some(place) = groups.iter().position(|(each, _)| *each == group) else {
                return Err(PointError::NoGroup { group: group.to_owned(), known });
            };
            let Some((index, field)) = scalar(groups[place].1.fields(), name) else {
                let known = groups[place].1.fields().iter().map(|field| field.name).collect();
                return Err(PointError::NoParameter { group: group.to_owned(), name: name.to_owned(), known });
            };
            (Slot::Parameter(place, index), field)
        }
        None => {
            let input = scalar(P::Input::FIELDS, axis.key).map(|(at, field)| (Slot::Input(at), field));
            let state = || scalar(P::State::FIELDS, axis.key).map(|(at, field)| (Slot::State(at), field));
            input.or_else(state).ok_or_else(|| no_value::<P>(axis.key))?
        }
    };
    // Reading one quantity tells whether the unit fits, and whether one is due.
    unit::quantity(&format!("1 {}", axis.unit), field.unit)
        .map_err(|source| PointError::Change(ChangeError::Unit { field, source }))?;
    let scale = if axis.unit.is_empty() { Conversion(None) } else { Conversion::new(axis.unit, field.unit) };
    Ok(Bound { slot, field, values: axis.values, scale })
}

/// The scalar `name` among fields, with the index of its element.
fn scalar(fields: &'static [Field], name: &str) -> Option<(usize, &'static Field)> {
    let mut index = 0;
    for field in fields {
        if field.name == name && field.len == 1 {
            return Some((index, field));
        }
        index += field.len;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::super::Point;
    use super::*;
    use serde_json::Value;

    fn options(changes: &[&str]) -> PointOptions {
        PointOptions { changes: changes.iter().map(|change| (*change).to_owned()).collect(), ..PointOptions::default() }
    }

    /// Process, key of the axis, its unit and values, changes.
    type Case = (PointProcess, &'static str, &'static str, [f64; 3], &'static [&'static str]);

    #[test]
    fn rows_are_the_points_bit_for_bit() {
        let cases: [Case; 5] = [
            (PointProcess::Turning, "cutting_speed", "m/min", [20.0, 37.3, 80.0], &["flank_wear=0.2 mm"]),
            (PointProcess::Turning, "flank_wear", "um", [0.0, 100.0, 250.0], &["cutting_speed=40 m/min"]),
            (PointProcess::Turning, "limits.wear_limit", "mm", [0.2, 0.3, 0.4], &[]),
            (PointProcess::Milling, "feed_per_tooth", "mm", [0.02, 0.05, 0.08], &[]),
            (PointProcess::Infeed, "infeed_per_rev", "um", [0.5, 1.0, 2.0], &[]),
        ];
        for (process, key, unit, values, changes) in cases {
            let axis = Axis { key, values: &values, unit };
            let grid =
                PointGrid::new(process, &options(changes), &[axis]).unwrap_or_else(|error| panic!("{key}: {error}"));
            for (row, value) in values.iter().enumerate() {
                let change = format!("{key}={value} {unit}");
                let changes: Vec<&str> = changes.iter().copied().chain([change.as_str()]).collect();
                let point = Point::new(process, &options(&changes)).expect("a point");
                for (head, expected) in [point.inputs, point.state, point.outputs].concat() {
                    let column = grid.columns.iter().find(|(name, _)| *name == head).map(|(_, column)| column);
                    match (column, &expected) {
                        (Some(Column::Numbers(numbers)), Value::Number(number)) => {
                            assert_eq!(Some(numbers[row]), number.as_f64(), "{key} {value}: {head}");
                        }
                        (Some(Column::Numbers(numbers)), Value::Null) => assert!(numbers[row].is_nan(), "{head}"),
                        (Some(Column::Texts(texts)), Value::String(text)) => assert_eq!(&texts[row], text, "{head}"),
                        (None, Value::Array(_)) => {}
                        (column, expected) => panic!("{head}: {column:?} and {expected}"),
                    }
                }
            }
        }
    }

    #[test]
    fn a_grid_says_which_point_is_refused_and_which_axis_does_not_fit() {
        let refused = |axes: &[Axis<'_>], changes: &[&str]| {
            PointGrid::new(PointProcess::Turning, &options(changes), axes).expect_err("refused").to_string()
        };
        let speed = |values| Axis { key: "cutting_speed", values, unit: "m/min" };
        assert!(refused(&[speed(&[30.0, -1.0])], &[]).starts_with("point 1: "));
        assert!(refused(&[speed(&[30.0, f64::NAN])], &[]).starts_with("point 1: "));
        let feed = Axis { key: "feed_per_rev", values: &[0.1], unit: "mm" };
        assert!(refused(&[speed(&[30.0, 40.0]), feed], &[]).contains("1 values"));
        assert!(refused(&[speed(&[30.0]), speed(&[30.0])], &[]).contains("twice"));
        assert!(refused(&[speed(&[30.0])], &["cutting_speed=40 m/min"]).contains("twice"));
        assert!(refused(&[Axis { unit: "mm", ..speed(&[30.0]) }], &[]).contains("cutting_speed"));
        assert!(refused(&[Axis { unit: "", ..speed(&[30.0]) }], &[]).contains("m/min"));
        assert!(refused(&[Axis { key: "cuttingspeed", ..speed(&[30.0]) }], &[]).contains("cuttingspeed"));
        assert!(refused(&[Axis { key: "limits.none", ..speed(&[30.0]) }], &[]).contains("none"));
    }
}
