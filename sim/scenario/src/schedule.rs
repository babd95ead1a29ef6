//! A schedule that somebody made: which machine does which operations, and in which order.

/// Sequences of all machines. Each begins its next operation as soon as it is free and the order is there, not before a time
/// where one is given, and waits for it whatever else is there.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Schedule {
    /// Operations of every machine in their order.
    pub machines: Vec<Vec<PlannedOperation>>,
}

/// An operation of an order on a machine.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlannedOperation {
    /// Order, by index.
    pub order: usize,
    /// Operation of its part, by index.
    pub operation: usize,
    /// Earliest start, s.
    pub not_before: f64,
    /// Start as planned, s, with which that of the run is compared; `None` where the schedule does not say it.
    pub start: Option<f64>,
}

impl Schedule {
    /// All operations, each with its machine and its place there, from 0.
    pub fn operations(&self) -> impl Iterator<Item = (usize, usize, &PlannedOperation)> {
        let machines = self.machines.iter().enumerate();
        machines.flat_map(|(machine, all)| {
            all.iter().enumerate().map(move |(place, operation)| (machine, place, operation))
        })
    }

    /// Operations that wait for each other in a circle, by the order of machines and of routings; empty where there is none.
    /// Operations of an order follow each other by their numbers.
    pub fn circle(&self) -> Vec<(usize, PlannedOperation)> {
        let all: Vec<(usize, usize, &PlannedOperation)> = self.operations().collect();
        let mut firsts: Vec<usize> = vec![0; self.machines.len()];
        for machine in 1..self.machines.len() {
            firsts[machine] = firsts[machine - 1] + self.machines[machine - 1].len();
        }
        let mut of_order: Vec<usize> = (0..all.len()).collect();
        of_order.sort_by_key(|&index| (all[index].2.order, all[index].2.operation));
        let mut before: Vec<Vec<usize>> = vec![Vec::new(); all.len()];
        for (index, (machine, place, _)) in all.iter().enumerate().filter(|(_, (_, place, _))| *place > 0) {
            before[index].push(firsts[*machine] + place - 1);
        }
        for pair in of_order.windows(2) {
            if all[pair[0]].2.order == all[pair[1]].2.order {
                before[pair[1]].push(pair[0]);
            }
        }
        let mut after: Vec<Vec<usize>> = vec![Vec::new(); all.len()];
        let mut left: Vec<usize> = before.iter().map(Vec::len).collect();
        for (index, all_before) in before.iter().enumerate() {
            all_before.iter().for_each(|&earlier| after[earlier].push(index));
        }
        let mut ready: Vec<usize> = (0..all.len()).filter(|&index| left[index] == 0).collect();
        while let Some(index) = ready.pop() {
            for &later in &after[index] {
                left[later] -= 1;
                if left[later] == 0 {
                    ready.push(later);
                }
            }
        }
        // Whatever is left waits for something that is left: going back from it comes to a circle.
        let Some(start) = left.iter().position(|count| *count > 0) else { return Vec::new() };
        let mut walk = vec![start];
        loop {
            let last = walk[walk.len() - 1];
            let earlier = before[last].iter().copied().find(|&index| left[index] > 0);
            let earlier = earlier.expect("what is left waits for something that is left");
            if let Some(first) = walk.iter().position(|&index| index == earlier) {
                let circle = walk.split_off(first);
                return circle.iter().rev().map(|&index| (all[index].0, *all[index].2)).collect();
            }
            walk.push(earlier);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn planned(order: usize, operation: usize) -> PlannedOperation {
        PlannedOperation { order, operation, not_before: 0.0, start: None }
    }

    #[test]
    fn sequences_that_wait_for_each_other_are_a_circle() {
        // Orders 0 and 1 go over machines 0 and 1; machine 0 takes 1 first, machine 1 takes 0 first.
        let crossed =
            Schedule { machines: vec![vec![planned(1, 0), planned(0, 0)], vec![planned(0, 1), planned(1, 1)]] };
        // On machine 1 order 1 comes after order 0, on machine 0 before it: no circle.
        assert!(crossed.circle().is_empty());
        let back = Schedule { machines: vec![vec![planned(1, 1), planned(0, 0)], vec![planned(0, 1), planned(1, 0)]] };
        let circle: Vec<_> = back.circle().iter().map(|(machine, own)| (*machine, own.order, own.operation)).collect();
        assert_eq!(circle.len(), 4);
        for (one, next) in circle.iter().zip(circle.iter().cycle().skip(1)) {
            let on_machine = one.0 == next.0;
            assert!(on_machine || one.1 == next.1 && one.2 < next.2, "{circle:?}");
        }
    }
}
