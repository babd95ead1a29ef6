//! Orders of which several jobs are in the shop: pieces, or as many as are transferred at a time; and orders for which
//! machines are set up before they come.
//!
//! The jobs of an order wait for each other before an operation until as many are there as move on
//! together. The machine that takes the first of them is kept for the order until the last is through, so
//! that it is set up once; where the next one is not there yet, it starves. An order that is split has as many machines
//! as take its jobs in the instant in which the first is taken, and each does its share of them.

use std::collections::VecDeque;

/// Several jobs of one order.
#[derive(Clone, Debug)]
pub struct Lot {
    /// Jobs that move on together.
    pub moving: usize,
    /// Most machines that do one of its operations at a time.
    pub split: usize,
    /// Whether an inspection has sent some of them back.
    pub returned: bool,
    /// By operation.
    pub steps: Vec<LotStep>,
}

/// The jobs of an order at an operation.
#[derive(Clone, Debug, Default)]
pub struct LotStep {
    /// Jobs that have not passed the operation yet.
    pub left: u32,
    /// Places of jobs that wait for others of their order.
    pub gathered: Vec<u32>,
    /// Places of jobs that may be worked on, but are in no queue: one of them is in the queue for all.
    pub line: VecDeque<u32>,
    /// The place of the job that is in the queue.
    pub queued: Option<u32>,
    /// The machines that are kept for the order, in the order in which they took it.
    pub machines: Vec<KeptMachine>,
    /// Whether it is settled which machines these are.
    pub divided: bool,
}

/// A machine that is kept for an order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct KeptMachine {
    /// The machine.
    pub machine: u32,
    /// Jobs that it has taken.
    pub taken: u32,
    /// Jobs that it is to take in all; `None`: all that come.
    pub share: Option<u32>,
}

impl KeptMachine {
    pub(super) fn new(machine: u32) -> Self {
        Self { machine, taken: 0, share: None }
    }

    /// Whether it takes no more.
    pub(super) fn is_done(&self) -> bool {
        self.share.is_some_and(|share| self.taken >= share)
    }
}

impl Lot {
    pub(super) fn new(jobs: u32, moving: u32, split: Option<u32>, operations: usize) -> Self {
        let step = LotStep { left: jobs, ..LotStep::default() };
        let split = split.unwrap_or(1).max(1) as usize;
        Self { moving: moving as usize, split, returned: false, steps: vec![step; operations] }
    }
}

impl LotStep {
    pub(super) fn kept(&mut self, machine: usize) -> Option<&mut KeptMachine> {
        self.machines.iter_mut().find(|kept| kept.machine as usize == machine)
    }
}
