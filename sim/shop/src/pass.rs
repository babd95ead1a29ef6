//! Passes: command, plan, interruption, end.

use super::draws;
use super::error::Refusal;
use super::recorder::Recorder;
use super::task::{IN_WORK, InCut, MOUNTED, Machining, Pass, Step, Task, in_cut};
use super::{Shop, ShopError};
use crate::runlog::{ChangeReason, EventRow, LogEvent, PassRow};
use rand::RngExt;
use toolroom_cuts::cut::refusing;
use toolroom_cuts::cut_fault::CutFault;
use toolroom_cuts::edge::owner;
use toolroom_cuts::ports::{read, write};
use toolroom_cuts::tool_plan::cut_duration;
use toolroom_kernel::Purpose;
use toolroom_process::{ProcessEvent, watched};
use toolroom_scenario::policies::{ForceReading, Observation};
use toolroom_scenario::{Cut, ShopConstant, ShopEffect, Work};

/// Longest pass that is told to sensors, s: the greatest `pass_time` of the processes.
pub(super) const LONG: f64 = 1e6;

/// What identifies the pass in a machine.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    pub slot: u32,
    pub job: u32,
    pub part: usize,
    pub operation: usize,
    pub pass: usize,
    pub tool: usize,
}

/// What a pass begins with.
pub(super) struct PassStart {
    /// Time that it takes, s.
    pub duration: f64,
    /// Feed or infeed of its row, m.
    pub feed: f64,
    /// Depth of cut of its row, m.
    pub depth_of_cut: f64,
    /// Cutting speed at its start, m/s.
    pub speed: f64,
    /// Layers in which it is cut.
    pub layers: u32,
    /// Forces that a grinding machine will measure.
    pub readings: Vec<ForceReading>,
}

impl PassStart {
    /// A pass of one layer, in s, without feed, depth and speed.
    pub fn lasting(duration: f64) -> Self {
        Self { duration, feed: 0.0, depth_of_cut: 0.0, speed: 0.0, layers: 1, readings: Vec::new() }
    }
}

impl<R: Recorder> Shop<'_, R> {
    fn place(&self, machine: usize) -> Place {
        let task = self.world.machines[machine].task.as_ref().expect(IN_WORK);
        let job = self.world.jobs.at(task.slot);
        Place {
            slot: task.slot,
            job: job.number,
            part: job.row.part as usize,
            operation: job.operation as usize,
            pass: task.machining().piece.pass as usize,
            tool: task.machining().tool as usize,
        }
    }

    /// Decides what comes after loading, a pass or an edge change: an edge change, the next
    /// pass, or the end of cutting.
    pub(super) fn next_pass(&mut self, machine: usize) -> Result<(), ShopError> {
        let place = self.place(machine);
        self.refused_at(machine, place, |shop| shop.next_pass_of(machine, place))
    }

    fn next_pass_of(&mut self, machine: usize, place: Place) -> Result<(), ShopError> {
        let plan = self.layout.passes(place.part, place.operation);
        let edge = self.world.machines[machine].edges[place.tool].as_ref();
        if edge.is_some_and(|edge| edge.change_reason.is_some_and(|reason| reason != ChangeReason::Dressing)) {
            return self.begin_change(machine);
        }
        let spoiled = self.world.machines[machine].task.as_ref().is_some_and(|task| task.machining().piece.spoiled);
        if spoiled || place.pass >= plan.passes as usize {
            self.finish_cutting(machine);
            return Ok(());
        }
        if edge.is_none() {
            if !self.finds_edge(machine, place.tool)? {
                return self.begin_change(machine);
            }
            self.mount(machine, place.tool);
        }
        if place.pass == 0 {
            self.clamp_new_part(machine, place, plan.first_pass);
        }
        self.watch(machine, place, plan.first_pass);
        self.world.machines[machine].segment.program.blocks.clear();
        let scenario = self.scenario;
        match &scenario.parts[place.part].operations[place.operation].work {
            Work::Cutting(cuts) => self.begin_cut(machine, place, plan.first_pass, &cuts[place.pass]),
            Work::Grinding { .. } | Work::Cycle(_) => self.begin_phase(machine, place, plan.first_pass),
            Work::Contour(_) => self.begin_contour(machine, place, plan.first_pass),
            Work::Program(work) => self.begin_call(machine, place, plan.first_pass, &work.calls[place.pass]),
            Work::Plain(_) => unreachable!("plain work has no passes"),
        }
    }

    /// A part of which passes are cut already is in the machine when the run begins.
    pub(super) fn clamp_at_start(&mut self, machine: usize) {
        let place = self.place(machine);
        if self.world.machines[machine].edges[place.tool].is_none() {
            self.mount(machine, place.tool);
        }
        self.clamp_new_part(machine, place, self.layout.passes(place.part, place.operation).first_pass);
    }

    /// A part comes before the edge: its lot and hardness show, a wheel finds it untouched.
    fn clamp_new_part(&mut self, machine: usize, place: Place, first_pass: u32) {
        let tool = &self.scenario.tools[place.tool];
        let part = &self.scenario.parts[place.part];
        let blank = draws::blank(&tool.scatter, &self.streams, self.world.jobs.at(place.slot), part);
        let machining = self.world.machines[machine].task.as_mut().expect(IN_WORK).machining_mut();
        machining.piece.blank = blank;
        if tool.variants.hardens_lots(machining.acting) {
            machining.piece.blank.lot_deviation = 1.0;
        }
        self.clamp_ground_part(machine, place, first_pass);
    }

    /// Gives the edge an observer where the policy needs one.
    fn watch(&mut self, machine: usize, place: Place, first_pass: u32) {
        let controller = self.controllers.of_pass(machine, first_pass + place.pass as u32);
        let tool = &self.layout.tools[place.tool];
        let process = self.process(machine, place.tool).machine_process();
        let state = &mut self.world.machines[machine];
        let edge = state.edges[place.tool].as_mut().expect(MOUNTED);
        if edge.observer.is_none() {
            // An edge that has cut before the policy came is measured once.
            let reading = (edge.row.passes > 0 || edge.worn_at_start).then(|| {
                let worn = tool.ports.worn(process, &edge.state, &tool.input, &mut state.segment.output);
                let mut stream = self.streams.at(edge.entity.part(owner::READINGS), Purpose::Measurement, u64::MAX);
                worn + controller.reading_error(&mut stream)
            });
            edge.observer = controller.observer(reading, state.learnt[place.tool].as_ref());
        }
    }

    fn begin_cut(&mut self, machine: usize, place: Place, first_pass: u32, cut: &Cut) -> Result<(), ShopError> {
        let pass = first_pass + place.pass as u32;
        let controller = self.controllers.of_pass(machine, pass);
        let kind = self.controllers.kind_of_pass(machine, pass);
        let ports = &self.layout.tools[place.tool].ports;
        let process = self.process(machine, place.tool);
        let state = &mut self.world.machines[machine];
        let InCut { machining: Machining { moved, piece, .. }, edge, .. } =
            in_cut(&mut state.task, &mut state.edges[place.tool]);
        let tool_plan = &self.layout.tools[place.tool];
        let mut input = std::mem::take(&mut state.segment.start_input);
        tool_plan.write_cut(cut, &mut input);
        let output = &mut state.segment.output;
        let observation = Observation {
            path: cut.path_length * piece.share_left,
            edge_path: edge.row.path,
            edge_time: edge.row.cutting_time,
            edge_parts: edge.row.parts,
            last_speed: edge.last_speed,
            observer: edge.observer.as_ref(),
            reaction: state.reactions.iter().find(|each| each.kind == kind).map(|each| each.speed),
            true_wear: (controller.sees_true_wear())
                .then(|| ports.worn(process.machine_process(), &edge.state, &input, output)),
            true_edge: controller.sees_edge().then_some(&edge.scatter),
        };
        let conditions = controller.choose(&observation);
        let tool = &self.scenario.tools[place.tool];
        write(&mut input, ports.cutting_speed, conditions.start_speed);
        let duration = if ports.feed_rate.is_some() {
            cut_duration(cut, process, tool_plan, &input) * piece.share_left * f64::from(conditions.layers)
        } else {
            let duration = conditions.duration(observation.path);
            let change = conditions.end_speed - conditions.start_speed;
            write(&mut input, ports.cutting_acceleration, if change == 0.0 { 0.0 } else { change / duration });
            duration
        };
        if edge.row.passes > 0 && controller.change_due(&observation, &conditions, duration) {
            edge.change_reason = Some(ChangeReason::Rule);
            state.segment.start_input = input;
            return self.begin_change(machine);
        }
        if let (Some(observer), Some(cut)) = (&mut edge.observer, controller.nominal_cut()) {
            observer.begin_pass(cut);
        }
        let operation = self.world.jobs.at(place.slot).entity.part(place.operation as u64);
        let depth = draws::depth(&tool.scatter, &self.streams, operation, piece.pass, cut.depth_of_cut)
            / f64::from(conditions.layers);
        write(&mut input, ports.depth_of_cut, depth);
        edge.draw_noise(&tool.scatter, &self.streams);
        edge.write_scatter(&tool.scatter, &self.pairs[place.tool], piece.blank, ports, &mut input);
        let rate = read(&input, ports.wear_rate_factor, 1.0) * moved.wear_rate;
        write(&mut input, ports.wear_rate_factor, rate);
        if ports.structure {
            let owner = self.layout.tool_owners[machine][place.tool];
            let factors = draws::structure(&tool.structure_scatter, &self.streams, owner);
            write(&mut input, ports.natural_frequency_factor, factors.0);
            write(&mut input, ports.modal_damping_factor, factors.1);
        }
        if let Some(variation) = conditions.variation {
            write(&mut input, ports.speed_variation, variation.amplitude);
            write(&mut input, ports.variation_revolutions, f64::from(variation.revolutions));
        }
        piece.renew_surface();
        // What lags within the pass is read at its end; after so long nothing lags any more.
        write(&mut input, ports.pass_time, duration.min(LONG));
        state.segment.start_input = input;
        let (feed, speed, layers) = (cut.feed, conditions.start_speed, conditions.layers);
        self.open_pass(
            machine,
            place,
            PassStart { feed, depth_of_cut: depth, speed, layers, ..PassStart::lasting(duration) },
        );
        self.plan_segment(machine)
    }

    /// A pass begins.
    pub(super) fn open_pass(&mut self, machine: usize, place: Place, opened: PassStart) {
        let PassStart { duration, feed, depth_of_cut, speed, layers, readings } = opened;
        let now = self.now().seconds();
        let ports = &self.layout.tools[place.tool].ports;
        let process = self.process(machine, place.tool).machine_process();
        let state = &mut self.world.machines[machine];
        let InCut { step, left, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
        edge.row.passes += 1;
        let segment = &mut state.segment;
        let worn = ports.worn(process, &edge.state, &segment.start_input, &mut segment.output);
        let row = PassRow {
            job: place.job,
            part: place.part as u32,
            operation: place.operation as u32,
            pass: place.pass as u32,
            machine: machine as u32,
            edge: edge.number,
            start: now,
            end: now,
            cutting_time: 0.0,
            speed_start: speed,
            speed_end: speed,
            feed,
            depth_of_cut,
            path: 0.0,
            engaged_time: 0.0,
            cutting_length: 0.0,
            edge_time: edge.row.cutting_time,
            flank_wear_start: worn,
            flank_wear_end: worn,
            flank_wear_estimate: f64::NAN,
            cutting_force: 0.0,
            spindle_power: 0.0,
            temperature: 0.0,
            energy: 0.0,
            size_error: 0.0,
            chatter_time: 0.0,
            stability_margin: if ports.structure { f64::INFINITY } else { f64::NAN },
            chatter_frequency: 0.0,
            vibration_amplitude: 0.0,
            roughness: 0.0,
        };
        *step = Step::Pass(Box::new(Pass { row, known: true, layers, readings }));
        *left = duration;
    }

    /// Plans the rest of the pass in work from now on, on a copy of the edge's state.
    pub(super) fn plan_segment(&mut self, machine: usize) -> Result<(), ShopError> {
        let place = self.place(machine);
        let now = self.now();
        let plan = self.layout.passes(place.part, place.operation);
        let ports = &self.layout.tools[place.tool].ports;
        let process = self.process(machine, place.tool).machine_process();
        let controller = self.controllers.of_pass(machine, plan.first_pass + place.pass as u32);
        let state = &mut self.world.machines[machine];
        let InCut { left, machining, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
        let segment = &mut state.segment;
        ports.write_ages(&mut segment.start_input, now.seconds(), &self.scenario.machines[machine]);
        if self.scenario.tools[place.tool].variants.changes_coolant(machining.acting) {
            write(&mut segment.start_input, ports.coolant_changed, 1.0);
        }
        let idle = now - edge.clock;
        let sampling = edge.observer.as_ref().map(|_| controller.sampling_period());
        edge.clock = now;
        let planned = refusing(|| {
            if idle > 0.0 {
                segment.rest(process, ports, &mut edge.state, idle)?;
            }
            segment.plan(process, ports, &edge.state, *left, sampling)
        });
        match planned {
            Ok(()) => {
                let kind = self.controllers.kind_of_pass(machine, plan.first_pass + place.pass as u32);
                let known = state.reactions.iter().find(|each| each.kind == kind);
                segment.stop = segment.stop(controller.stability(), known);
                *left = segment.stop.unwrap_or(segment.elapsed) * machining.moved.pace;
                Ok(())
            }
            Err(fault) => Err(self.cut_error(machine, place, fault)),
        }
    }

    /// The pass in work stops after `elapsed` seconds of its segment, to be gone on with later.
    pub(super) fn halt_pass(&mut self, machine: usize, elapsed: f64) -> Result<(), ShopError> {
        let place = self.place(machine);
        let tool = &self.layout.tools[place.tool];
        let process = self.process(machine, place.tool).machine_process();
        let closing = self.end.is_some();
        let state = &mut self.world.machines[machine];
        if closing && !process.goes_back() {
            // What was cut until the horizon cannot be known: the pass is left out.
            let InCut { step, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
            step.pass_mut().known = false;
            edge.row.passes -= 1;
            return Ok(());
        }
        let InCut { left, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
        let segment = &mut state.segment;
        let requested = segment.requested;
        let share = segment.share(&tool.ports, elapsed);
        *left = (requested - elapsed).max(0.0);
        let sampling = segment.sampling_period;
        let planned = refusing(|| segment.plan(process, &tool.ports, &edge.state, elapsed, sampling));
        if let Err(fault) = planned {
            return Err(self.cut_error(machine, place, fault));
        }
        self.take_over(machine, place, share);
        let segment = &mut self.world.machines[machine].segment;
        segment.program.skip(elapsed);
        std::mem::swap(&mut segment.start_input, &mut segment.input);
        Ok(())
    }

    /// A pass ends, because it is cut or because the edge is lost.
    pub(super) fn end_pass(&mut self, machine: usize) -> Result<(), ShopError> {
        let place = self.place(machine);
        self.refused_at(machine, place, |shop| shop.end_pass_of(machine, place))
    }

    fn end_pass_of(&mut self, machine: usize, place: Place) -> Result<(), ShopError> {
        let segment = &self.world.machines[machine].segment;
        if let Some(stop) = segment.stop {
            return self.react(machine, place, stop);
        }
        let share = segment.share(&self.layout.tools[place.tool].ports, segment.elapsed);
        let lost = segment.lost;
        self.take_over(machine, place, share);
        self.close_pass(machine);
        match lost {
            Some(event) => self.lose_edge(machine, place, event),
            None => {
                let plan = self.layout.passes(place.part, place.operation);
                let state = &mut self.world.machines[machine];
                let InCut { machining: Machining { piece, .. }, edge, .. } =
                    in_cut(&mut state.task, &mut state.edges[place.tool]);
                let operation = &self.scenario.parts[place.part].operations[place.operation];
                piece.pass += 1;
                piece.share_left = 1.0;
                let done = piece.pass == plan.passes;
                let mut later = piece.pass..plan.passes;
                edge.row.parts +=
                    u32::from(later.all(|pass| operation.tool_of_pass(pass as usize) != Some(place.tool)));
                self.take_tool(machine, place);
                if done {
                    self.judge_wheel(machine, place, plan.first_pass);
                }
                let reading_time = self.read_wear(machine, place);
                if reading_time > 0.0 {
                    let task = self.world.machines[machine].task.as_mut().expect(IN_WORK);
                    task.step = Step::Reading;
                    task.left = reading_time;
                    return Ok(());
                }
            }
        }
        self.next_pass(machine)
    }

    /// The planned segment has happened: edge, pass, observer and log take it over.
    fn take_over(&mut self, machine: usize, place: Place, share: f64) {
        let clock = self.now();
        let now = clock.seconds();
        let plan = self.layout.passes(place.part, place.operation);
        let controller = self.controllers.of_pass(machine, plan.first_pass + place.pass as u32);
        let ports = &self.layout.tools[place.tool].ports;
        let work = &self.scenario.parts[place.part].operations[place.operation].work;
        let programmed = matches!(work, Work::Program(_));
        let path = match work {
            Work::Cutting(cuts) => cuts[place.pass].path_length,
            Work::Contour(work) => work.programmed[place.pass].path_length,
            Work::Program(work) => work.calls[place.pass].path,
            Work::Plain(_) | Work::Grinding { .. } | Work::Cycle(_) => 0.0,
        };
        let form_error = self.form_error(machine, place, plan.first_pass);
        let process = self.process(machine, place.tool).machine_process();
        let streams = self.streams;
        let state = &mut self.world.machines[machine];
        let InCut { step, machining: Machining { moved, piece, .. }, edge, .. } =
            in_cut(&mut state.task, &mut state.edges[place.tool]);
        let segment = &state.segment;
        let Pass { row, layers, .. } = step.pass_mut();
        let cut = share * piece.share_left;
        piece.share_left -= cut;
        edge.state.copy_from_slice(&segment.state);
        self.scenario.tools[place.tool].process.machine_process().settle(&edge.state);
        edge.clock = clock;
        // A part program spends much of its time out of cut.
        edge.row.cutting_time += if programmed { segment.engaged_time } else { segment.elapsed };
        let path = path * f64::from(*layers);
        edge.row.path += cut * path;
        edge.last_speed = ports.cutting_speed.map(|i| segment.input[i]);
        if let Some(observer) = &mut edge.observer {
            for sample in &segment.samples {
                let mut noise = streams.at(edge.entity.part(owner::SENSORS), Purpose::Measurement, edge.samples);
                edge.samples += 1;
                observer.see(sample, controller.sensors(), edge.scatter.emf_gain, &mut noise);
            }
            observer.segment_ends();
            row.flank_wear_estimate = observer.flank_wear();
        }
        let output = &segment.output;
        row.end = now;
        row.cutting_time += segment.elapsed;
        row.path += cut * path;
        row.engaged_time += segment.engaged_time;
        row.cutting_length += segment.cutting_length;
        if row.speed_start > 0.0 {
            row.speed_end = read(&segment.input, ports.cutting_speed, row.speed_end);
        }
        row.flank_wear_end = read(output, ports.flank_wear, 0.0);
        row.cutting_force = read(output, ports.cutting_force, 0.0);
        row.spindle_power = read(output, ports.spindle_power, 0.0);
        row.temperature = read(output, ports.temperature, 0.0);
        row.energy += segment.energy;
        row.size_error = form_error.unwrap_or(read(output, ports.size_error, 0.0) - piece.correction);
        edge.row.flank_wear = row.flank_wear_end;
        if let Some(vibration) = &segment.vibration {
            vibration.note(row, &mut piece.surface);
        }
        // Every tool of a part program leaves surfaces of its own.
        if !programmed || row.size_error.abs() > piece.size_error.abs() {
            piece.size_error = row.size_error;
        }
        // An edge that was mounted past its wear limit never crosses it.
        let worn = edge.change_reason.is_none()
            && !segment.has(ProcessEvent::WearLimit)
            && process.holds(ProcessEvent::WearLimit, &edge.state, &segment.input);
        let mounted_worn = worn.then_some((0.0, ProcessEvent::WearLimit));
        for (after, event) in mounted_worn.into_iter().chain(segment.passed.iter().copied()) {
            match event {
                ProcessEvent::WearLimit => edge.change_reason = edge.change_reason.or(Some(ChangeReason::WearLimit)),
                ProcessEvent::Burn => piece.burnt = true,
                // These end the cut or say that the wheel is due, which is seen to elsewhere.
                ProcessEvent::ThermalCollapse | ProcessEvent::Chipping | ProcessEvent::DressingDue => {}
            }
            self.recorder.event(EventRow {
                time: now - (segment.elapsed - after) * moved.pace,
                event: LogEvent::Cut(event),
                machine: Some(machine as u32),
                job: Some(place.job),
                edge: Some(edge.number),
            });
        }
        let number = edge.number;
        self.log_onset(machine, place, number);
        self.ground(machine, place, plan.first_pass);
    }

    /// Writes the row of the pass in work, if there is one: what was cut until now. Another step
    /// follows, or the run is over.
    pub(super) fn close_pass(&mut self, machine: usize) {
        if let Some(Task { step: Step::Pass(pass), .. }) = &self.world.machines[machine].task
            && pass.known
        {
            self.recorder.pass(pass.row);
        }
    }

    /// The edge is gone; chance decides whether the part is gone with it.
    fn lose_edge(&mut self, machine: usize, place: Place, event: ProcessEvent) {
        let job = self.world.jobs.at(place.slot);
        let owner = job.entity.part(place.operation as u64).part(place.pass as u64);
        let risk = self.scenario.parts[place.part].operations[place.operation].scrap_on_tool_failure;
        let risk = self.moved(ShopConstant::Scrap, machine, risk);
        let state = &mut self.world.machines[machine];
        let InCut { machining, edge, .. } = in_cut(&mut state.task, &mut state.edges[place.tool]);
        edge.change_reason = Some(match event {
            ProcessEvent::ThermalCollapse => ChangeReason::ThermalCollapse,
            ProcessEvent::Chipping => ChangeReason::Chipping,
            ProcessEvent::WearLimit | ProcessEvent::Burn | ProcessEvent::DressingDue => {
                unreachable!("{event:?} does not end a cut")
            }
        });
        let chance: f64 = self.streams.at(owner, Purpose::Quality, u64::from(machining.lost_edges)).random();
        machining.lost_edges += 1;
        machining.piece.spoiled |= chance < risk;
        let number = edge.number;
        self.log_event(LogEvent::Cut(event), Some(machine), Some(place.job), Some(number));
    }

    /// The wear limit rule reads the edge after a pass, and tells the observer what it has read. The time that it takes, s.
    fn read_wear(&mut self, machine: usize, place: Place) -> f64 {
        let plan = self.layout.passes(place.part, place.operation);
        let controller = self.controllers.of_pass(machine, plan.first_pass + place.pass as u32);
        let later = self.deviation(ShopEffect::ToolChangePolicy, machine);
        let edge = self.world.machines[machine].edges[place.tool].as_mut().expect(MOUNTED);
        let Some(limit) = controller.reading_limit().map(|limit| limit + later) else { return 0.0 };
        let sensors = controller.sensors();
        if edge.change_reason.is_some() || !edge.row.passes.is_multiple_of(sensors.read_every) {
            return 0.0;
        }
        let reading = u64::from(edge.row.passes);
        let mut stream = self.streams.at(edge.entity.part(owner::READINGS), Purpose::Measurement, reading);
        let flank_wear = edge.row.flank_wear + controller.reading_error(&mut stream);
        if let Some(observer) = &mut edge.observer {
            observer.read(flank_wear, sensors);
        }
        if flank_wear >= limit {
            edge.change_reason = Some(ChangeReason::Rule);
        }
        sensors.reading_time
    }

    /// Does `work` and refuses it where an effect of a user gave no value beside what a planned segment refuses by itself:
    /// where forces are looked at before infeeds are chosen, or a form error after the cut.
    fn refused_at(
        &mut self,
        machine: usize,
        place: Place,
        work: impl FnOnce(&mut Self) -> Result<(), ShopError>,
    ) -> Result<(), ShopError> {
        let mut done = Ok(());
        let watched = watched(|| done = work(self));
        done?;
        watched.map_err(|refusal| self.cut_error(machine, place, CutFault::Model(refusal)))
    }

    fn cut_error(&self, machine: usize, place: Place, fault: CutFault) -> ShopError {
        let time = self.now().seconds();
        let source = match fault {
            CutFault::Model(source) => source,
            CutFault::Stuck => return ShopError::NoProgress { time, events: super::STUCK_EVENTS },
        };
        let part = &self.scenario.parts[place.part];
        let fields = self.process(machine, place.tool).machine_process().inputs();
        let names = fields.iter().flat_map(|field| std::iter::repeat_n(field.name, field.len));
        let values = self.world.machines[machine].segment.start_input.iter().copied();
        ShopError::Model(Box::new(Refusal {
            time,
            machine: self.scenario.machines[machine].name.clone(),
            part: part.name.clone(),
            operation: part.operations[place.operation].name.clone(),
            pass: place.pass as u32,
            inputs: names.zip(values).collect(),
            source,
        }))
    }
}
