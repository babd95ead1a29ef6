//! Coordinates of a program against those of the workpiece.

use crate::motion::Axes;

/// `base = matrix · program + shift` of X Y Z; the other axes are shifted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Frame {
    pub matrix: [[f64; 3]; 3],
    pub shift: Axes,
}

impl Frame {
    pub const IDENTITY: Self = Self { matrix: [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]], shift: [0.0; 9] };

    pub fn shifted(shift: Axes) -> Self {
        Self { shift, ..Self::IDENTITY }
    }

    /// Scales about `centre`; -1 mirrors.
    pub fn scaled(factors: [f64; 3], centre: [f64; 3]) -> Self {
        let mut frame = Self::IDENTITY;
        for axis in 0..3 {
            frame.matrix[axis][axis] = factors[axis];
            frame.shift[axis] = centre[axis] * (1.0 - factors[axis]);
        }
        frame
    }

    /// Turns from the first axis of `plane` to the second about `centre`, degrees.
    pub fn turned(degrees: f64, plane: [usize; 3], centre: [f64; 2]) -> Self {
        let [u, v, _] = plane;
        let (sin, cos) = turn(degrees);
        let mut frame = Self::IDENTITY;
        (frame.matrix[u][u], frame.matrix[u][v], frame.matrix[v][u], frame.matrix[v][v]) = (cos, -sin, sin, cos);
        frame.shift[u] = centre[0] - cos * centre[0] + sin * centre[1];
        frame.shift[v] = centre[1] - sin * centre[0] - cos * centre[1];
        frame
    }

    /// First `inner`, then this.
    pub fn after(&self, inner: &Self) -> Self {
        let product = |i: usize, j: usize| (0..3).map(|k| self.matrix[i][k] * inner.matrix[k][j]).sum();
        let matrix = std::array::from_fn(|i| std::array::from_fn(|j| product(i, j)));
        Self { matrix, shift: self.base(inner.shift) }
    }

    pub fn base(&self, axes: Axes) -> Axes {
        let mut base: Axes = std::array::from_fn(|i| axes[i] + self.shift[i]);
        for i in 0..3 {
            base[i] = (0..3).map(|k| self.matrix[i][k] * axes[k]).sum::<f64>() + self.shift[i];
        }
        base
    }

    /// The inverse of [`Frame::base`].
    pub fn program(&self, base: Axes) -> Axes {
        if *self == Self::IDENTITY {
            return base;
        }
        let m = &self.matrix;
        let less: [f64; 3] = std::array::from_fn(|i| base[i] - self.shift[i]);
        let mut axes: Axes = std::array::from_fn(|i| base[i] - self.shift[i]);
        let minor = |i: usize, j: usize| {
            let (a, b) = ((i + 1) % 3, (i + 2) % 3);
            let (c, d) = ((j + 1) % 3, (j + 2) % 3);
            m[a][c] * m[b][d] - m[a][d] * m[b][c]
        };
        let determinant: f64 = (0..3).map(|j| m[0][j] * minor(0, j)).sum();
        for i in 0..3 {
            axes[i] = (0..3).map(|k| minor(k, i) * less[k]).sum::<f64>() / determinant;
        }
        axes
    }

    /// Whether a plane is seen from its other side, whatever the scales of its axes.
    pub fn mirrors(&self, [u, v, _]: [usize; 3]) -> bool {
        let m = &self.matrix;
        m[u][u] * m[v][v] - m[u][v] * m[v][u] < 0.0
    }

    /// Factor of lengths in a plane and whether it is mirrored; `None` where circles do not stay circles of the plane.
    pub fn plane(&self, [u, v, w]: [usize; 3]) -> Option<(f64, bool)> {
        let m = &self.matrix;
        let small = |value: f64| value.abs() < 1e-9;
        let kept = small(m[w][u]) && small(m[w][v]) && small(m[u][w]) && small(m[v][w]);
        let (a, b) = (m[u][u].hypot(m[v][u]), m[u][v].hypot(m[v][v]));
        let square = small(m[u][u] * m[u][v] + m[v][u] * m[v][v]);
        (kept && square && (a - b).abs() < 1e-9 * a).then_some((a, self.mirrors([u, v, w])))
    }
}

/// Sine and cosine of degrees, exact at quarter turns.
pub(crate) fn turn(degrees: f64) -> (f64, f64) {
    let quarter = degrees / 90.0;
    if quarter == quarter.round() {
        return match (quarter as i64).rem_euclid(4) {
            0 => (0.0, 1.0),
            1 => (1.0, 0.0),
            2 => (0.0, -1.0),
            _ => (-1.0, 0.0),
        };
    }
    degrees.to_radians().sin_cos()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_frame_and_its_inverse_are_one() {
        let turned = Frame::turned(30.0, [0, 1, 2], [5.0, -2.0]);
        let frame = Frame::shifted([1.0, 2.0, 3.0, 4.0, 0.0, 0.0, 7.0, 0.0, 0.0])
            .after(&turned)
            .after(&Frame::scaled([-2.0, 2.0, 2.0], [1.0; 3]));
        let at = [3.0, -4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0, 11.0];
        let back = frame.program(frame.base(at));
        assert!(at.iter().zip(back).all(|(a, b)| (a - b).abs() < 1e-12), "{back:?}");
        let (factor, mirrored) = frame.plane([0, 1, 2]).expect("circles stay");
        assert!((factor - 2.0).abs() < 1e-12 && mirrored);
        assert_eq!(turned.base([5.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])[..2], [5.0, -2.0]);
    }
}
