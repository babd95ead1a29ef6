//! Commands that change at set instants of one pass: the infeeds of a grinding phase, the
//! sections of a contour.

/// A stretch of a pass under one command.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Duration, s.
    pub duration: f64,
    /// Input elements of the process and the values that they take, SI.
    pub commands: Vec<(usize, f64)>,
}

/// The blocks of a pass in order; none where one command holds throughout.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// What is left of them.
    pub blocks: Vec<Block>,
}

impl Program {
    /// Writes the command that holds from `time` (s since the start) on into `input` and tells
    /// until when it holds, s; the last one holds for ever.
    pub fn command(&self, time: f64, input: &mut [f64]) -> f64 {
        let mut end = 0.0;
        for (i, block) in self.blocks.iter().enumerate() {
            end += block.duration;
            let last = i + 1 == self.blocks.len();
            if end > time || last {
                for &(element, value) in &block.commands {
                    input[element] = value;
                }
                return if last { f64::INFINITY } else { end };
            }
        }
        f64::INFINITY
    }

    /// Forgets the first `elapsed` seconds.
    pub fn skip(&mut self, elapsed: f64) {
        let mut left = elapsed;
        let mut past = 0;
        for block in &mut self.blocks {
            if block.duration > left {
                block.duration -= left;
                break;
            }
            left -= block.duration;
            past += 1;
        }
        // The last command stays in force.
        self.blocks.drain(..past.min(self.blocks.len().saturating_sub(1)));
    }

    /// Duration of all blocks, s.
    pub fn duration(&self) -> f64 {
        self.blocks.iter().map(|block| block.duration).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn program() -> Program {
        let block = |duration, value| Block { duration, commands: vec![(1, value)] };
        Program { blocks: vec![block(2.0, 10.0), block(3.0, 20.0), block(1.0, 30.0)] }
    }

    #[test]
    fn every_instant_has_the_command_of_its_block() {
        let mut input = [0.0, 0.0];
        let command_at = |time: f64, input: &mut [f64; 2]| (program().command(time, input), input[1]);
        assert_eq!(command_at(0.0, &mut input), (2.0, 10.0));
        assert_eq!(command_at(2.0, &mut input), (5.0, 20.0));
        assert_eq!(command_at(5.5, &mut input), (f64::INFINITY, 30.0));
        assert_eq!(command_at(9.0, &mut input), (f64::INFINITY, 30.0));
        assert_eq!(input[0], 0.0);
    }

    #[test]
    fn what_is_skipped_is_not_commanded_again() {
        let mut program = program();
        program.skip(2.5);
        assert_eq!(program.duration(), 3.5);
        let mut input = [0.0, 0.0];
        assert_eq!((program.command(0.0, &mut input), input[1]), (2.5, 20.0));
        program.skip(100.0);
        assert_eq!((program.command(0.0, &mut input), input[1]), (f64::INFINITY, 30.0));
    }
}
