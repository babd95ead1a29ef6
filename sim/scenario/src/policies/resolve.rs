//! From a policy of the scenario to a controller for every pass.

use super::constant::{self, ChangeCost, Edges, Spoilage};
use super::planned::Planned;
use super::set_increment::SetIncrement;
use super::{
    BelievedModel, ChangeRule, ContourPlan, Controller, GrindingController, PolicyError, Speed, Stability, schedule,
};
use crate::policies::ResolveError;
use crate::{
    Course, Cut, Knowledge, MachineType, Operation, PolicyRule, ProcessModel, Scenario, ToolChangeRule, ToolType, Work,
};
use std::sync::Arc;
use toolroom_wear::{Pair, SpeedLaw};

/// A policy worked out for a scenario: resolve once, share over all replications.
#[derive(Clone, Debug, PartialEq)]
pub struct ResolvedPolicy {
    controllers: Vec<Controller>,
    /// Controller of every pass (of all operations of all parts) on every machine.
    of_pass: Vec<Vec<u32>>,
    /// Plans of contours, by machine and pass.
    contour: Vec<Vec<Option<Arc<ContourPlan>>>>,
    /// Cycles of grinding operations, by pass.
    grinding: Vec<Option<Arc<GrindingController>>>,
}

impl ResolvedPolicy {
    /// Works out policy number `policy` of `scenario`.
    ///
    /// # Errors
    /// [`ResolveError::UnknownPolicy`], [`ResolveError::UnknownIndex`] for an operation without tool
    /// or machine, [`ResolveError::Policy`] where a policy can not be worked out on the nominal model.
    pub fn from_scenario(scenario: &Scenario, policy: usize) -> Result<Self, ResolveError> {
        let count = scenario.policies.len();
        let rule = scenario.policies.get(policy).ok_or(ResolveError::UnknownPolicy { index: policy, count })?;
        let mut resolved = Self {
            controllers: Vec::new(),
            of_pass: vec![Vec::new(); scenario.machines.len()],
            contour: vec![Vec::new(); scenario.machines.len()],
            grinding: Vec::new(),
        };
        let mut known: Vec<(Key, u32)> = Vec::new();
        let operations = scenario.parts.iter().flat_map(|part| part.operations.iter().map(move |own| (part, own)));
        for (part, operation) in operations {
            // Plain work has no pass that a policy could choose anything for.
            let Some(index) = operation.tool else { continue };
            let tool = scenario.tools.get(index).ok_or(ResolveError::UnknownIndex {
                kind: "tool",
                index,
                count: scenario.tools.len(),
            })?;
            let refuse = |source| ResolveError::Policy {
                policy: rule.name.clone(),
                tool: tool.name.clone(),
                source: Box::new(source),
            };
            let grinding = grinding(rule, operation, tool).map_err(refuse)?.map(Arc::new);
            let spoilage = Spoilage {
                risk: operation.scrap_on_tool_failure,
                blank: part.material_cost,
                path: if let Work::Cutting(cuts) = &operation.work {
                    cuts.iter().map(|cut| cut.path_length).sum()
                } else {
                    0.0
                },
            };
            for pass in 0..operation.work.passes() {
                resolved.grinding.push(grinding.clone());
                let cut = match &operation.work {
                    Work::Cutting(cuts) => Some(cuts[pass]),
                    Work::Plain(_) | Work::Grinding { .. } | Work::Cycle(_) | Work::Contour(_) | Work::Program(_) => {
                        None
                    }
                };
                let index = operation.tool_of_pass(pass).unwrap_or(index);
                let tool = scenario.tools.get(index).unwrap_or(tool);
                for (place, machine) in scenario.machines.iter().enumerate() {
                    let able = operation.machines.contains(&place);
                    let contour = match &operation.work {
                        Work::Contour(work) if able => {
                            let regime = rule.contour.unwrap_or(work.rule);
                            let plan = ContourPlan::new(work, pass, regime, tool, machine);
                            Some(Arc::new(plan.map_err(|source| refuse(source.into()))?))
                        }
                        Work::Plain(_)
                        | Work::Cutting(_)
                        | Work::Grinding { .. }
                        | Work::Cycle(_)
                        | Work::Contour(_)
                        | Work::Program(_) => None,
                    };
                    resolved.contour[place].push(contour);
                    if !able {
                        resolved.of_pass[place].push(u32::MAX);
                        continue;
                    }
                    let key = Key { tool: index, cut, spoilage, machine: MachineKey::from_machine_type(machine) };
                    let same = known.iter().find(|(each, _)| *each == key).map(|(_, controller)| *controller);
                    let controller = match same {
                        Some(controller) => controller,
                        None => {
                            let commanded = scenario.commands_speed_of(tool);
                            let made = controller(rule, (tool, commanded), cut.as_ref(), spoilage, machine);
                            let made = made.map_err(refuse)?;
                            resolved.controllers.push(made);
                            let number = (resolved.controllers.len() - 1) as u32;
                            known.push((key, number));
                            number
                        }
                    };
                    resolved.of_pass[place].push(controller);
                }
            }
        }
        Ok(resolved)
    }

    /// Controller of a pass, counted over all operations of all parts, on a machine that may
    /// cut it.
    pub fn of_pass(&self, machine: usize, pass: u32) -> &Controller {
        &self.controllers[self.of_pass[machine][pass as usize] as usize]
    }

    /// Plan of a pass around a contour on a machine that may mill it.
    pub fn contour(&self, machine: usize, pass: u32) -> Option<&ContourPlan> {
        self.contour[machine][pass as usize].as_deref()
    }

    /// Number of that controller: equal for passes that cut alike on machines of one kind.
    pub fn kind_of_pass(&self, machine: usize, pass: u32) -> u32 {
        self.of_pass[machine][pass as usize]
    }

    /// Cycle and dressing of a pass of a grinding operation.
    pub fn grinding(&self, pass: u32) -> Option<&GrindingController> {
        self.grinding[pass as usize].as_deref()
    }
}

fn grinding(
    rule: &PolicyRule,
    operation: &Operation,
    tool: &ToolType,
) -> Result<Option<GrindingController>, PolicyError> {
    let ProcessModel::Infeed(wheel) = &tool.process else { return Ok(None) };
    Ok(match &operation.work {
        Work::Cycle(work) => Some(GrindingController::designed(work, rule.grinding, rule.dressing, &rule.sensors)?),
        Work::Grinding { phases, .. } => {
            Some(GrindingController::programmed(phases, wheel, rule.dressing, &rule.sensors))
        }
        Work::Plain(_) | Work::Cutting(_) | Work::Contour(_) | Work::Program(_) => None,
    })
}

/// Everything that a controller depends on.
#[derive(PartialEq)]
struct Key {
    tool: usize,
    cut: Option<Cut>,
    spoilage: Spoilage,
    machine: MachineKey,
}

#[derive(PartialEq)]
struct MachineKey {
    rate: f64,
    tool_change_time: f64,
    magazine: u32,
    refill_time: f64,
    speed_range: (f64, f64),
}

impl MachineKey {
    fn from_machine_type(machine: &MachineType) -> Self {
        let &MachineType { rate, tool_change_time, magazine, refill_time, speed_range, .. } = machine;
        Self { rate, tool_change_time, magazine, refill_time, speed_range }
    }
}

fn controller(
    rule: &PolicyRule,
    (tool, commanded): (&ToolType, bool),
    cut: Option<&Cut>,
    spoilage: Spoilage,
    machine: &MachineType,
) -> Result<Controller, PolicyError> {
    let pair = match &rule.believed_model {
        // An imported unit tells nobody its parameters; a policy may still name what it believes.
        Some(pair) if tool.process.takes_speed_commands() => Some(pair.clone()),
        _ => tool.process.pair().cloned(),
    };
    let believed = match (pair, cut) {
        (Some(pair), Some(cut)) => Some(believe(tool, pair, cut, machine)),
        _ => None,
    };
    let cost = ChangeCost {
        time: machine.tool_change_time + machine.refill_time / f64::from(machine.magazine.max(1)),
        edge: tool.edge_cost,
        machine: machine.rate,
    };
    let programmed = cut.map_or(0.0, |cut| cut.cutting_speed);
    let own_limit = tool.process.wear_limit();
    let limit = match rule.tool_change {
        ToolChangeRule::WearLimit { limit } | ToolChangeRule::Predicted { limit } => limit.unwrap_or(own_limit),
        ToolChangeRule::PartCount { .. } | ToolChangeRule::CuttingTime { .. } => own_limit,
    };
    let speed = if commanded {
        let edges = Edges { limit, scatter: &tool.scatter, spoilage };
        speed(rule, believed.as_ref(), programmed, &cost, edges)
    } else {
        Speed::Fixed(programmed)
    };
    let change = match rule.tool_change {
        ToolChangeRule::WearLimit { limit } => ChangeRule::WearLimit(limit.unwrap_or(own_limit)),
        ToolChangeRule::PartCount { parts } => ChangeRule::PartCount(parts),
        ToolChangeRule::CuttingTime { time } => ChangeRule::CuttingTime(time),
        // Nothing to predict with: the edge is read instead.
        ToolChangeRule::Predicted { limit } if believed.is_none() => ChangeRule::WearLimit(limit.unwrap_or(own_limit)),
        ToolChangeRule::Predicted { limit } => ChangeRule::Predicted(limit.unwrap_or(own_limit)),
    };
    let knows = rule.knowledge();
    let adaptive = matches!(speed, Speed::Planned(_) | Speed::SetIncrement(_));
    let stability = match cut {
        Some(cut) => Stability::from_stability_rule(rule.stability, &tool.process, cut, machine.speed_range)?,
        None => None,
    };
    Ok(Controller {
        stability,
        observes: (adaptive || matches!(change, ChangeRule::Predicted(_))) && knows == Knowledge::Sensors,
        knows,
        speed,
        change,
        range: machine.speed_range,
        sensors: rule.sensors,
        believed,
    })
}

/// A speed rule on the believed model, m/s; as programmed where there is no model to plan with.
fn speed(
    rule: &PolicyRule,
    believed: Option<&BelievedModel>,
    programmed: f64,
    cost: &ChangeCost,
    edges: Edges<'_>,
) -> Speed {
    let on_model = |plan: &dyn Fn(&BelievedModel) -> Speed| believed.map_or(Speed::Fixed(programmed), plan);
    let factor = rule.speed_factor;
    let planned = |law: &dyn Fn(&BelievedModel) -> SpeedLaw| {
        on_model(&|believed| Speed::Planned(Arc::new(Planned::new(believed, law(believed), factor))))
    };
    match rule.speed.entry().course {
        Course::Programmed => Speed::Fixed(factor * programmed),
        Course::Constant(choice) => {
            Speed::Fixed(factor * constant::speed(choice, believed, cost, edges).unwrap_or(programmed))
        }
        Course::Schedule => on_model(&|believed| Speed::Schedule(Arc::new(schedule::tabulate(believed, factor)))),
        Course::SetIncrement(path_per_edge) => {
            on_model(&|_| Speed::SetIncrement(SetIncrement { path_per_edge, factor }))
        }
        Course::Law(law) => planned(&|_| law),
        Course::Price(price) => planned(&|believed| {
            SpeedLaw::ShadowPrice(price.unwrap_or_else(|| shadow_price(believed, cost.worth(), edges.limit)))
        }),
    }
}

/// The price of the rate optimum, s/m, for edges that are changed at a flank wear of `limit` (m), each change being
/// worth `change_time` (s), at speeds that keep clear of thermal collapse.
fn shadow_price(believed: &BelievedModel, change_time: f64, limit: f64) -> f64 {
    let mut pair = Pair::clone(&believed.pair);
    pair.limits.wear_limit = limit;
    let safe = |flank_wear: f64| believed.safe_speed(|_| flank_wear);
    pair.rate_optimum_below(&believed.cut, change_time, safe).shadow_price
}

/// A controller for one pass with a tool of `pair` on a machine of this speed range.
#[cfg(test)]
pub(super) fn for_turning(rule: &PolicyRule, pair: &Pair, cut: &Cut, speed_range: (f64, f64)) -> Controller {
    use crate::{Distribution, ProcessModel};
    let turning = toolroom_cutting::Turning { pair: pair.clone(), ..toolroom_cutting::Turning::default() };
    let tool = ToolType {
        name: "insert".to_owned(),
        process: ProcessModel::Turning(Arc::new(turning)),
        variants: Default::default(),
        parameter_set: pair.name.clone(),
        edge_cost: 8.0,
        dressing_time: 0.0,
        scatter: toolroom_wear::Scatter::shop(),
        structure_scatter: Default::default(),
        posterior: None,
        spreads: Default::default(),
        life: None,
    };
    let machine = MachineType {
        name: "lathe".to_owned(),
        process: "turning".to_owned(),
        rate: 0.02,
        load_time: Distribution::Constant(0.0),
        unload_time: Distribution::Constant(0.0),
        tool_change_time: 90.0,
        setup_time: 0.0,
        setup_matrix: None,
        setup_at_start: None,
        edges_at_start: Vec::new(),
        input_buffer: None,
        output_buffer: None,
        location: "lathe".to_owned(),
        batch: None,
        magazine: 10,
        refill_time: 300.0,
        speed_range,
        idle_power: 0.0,
        coolant_change: None,
        rules: None,
        calendar: None,
    };
    controller(rule, (&tool, true), Some(cut), Spoilage::default(), &machine).expect("a shipped pair")
}

/// The believed pair at a nominal cut, its speed range narrowed to the machine's.
fn believe(tool: &ToolType, mut pair: Pair, cut: &Cut, machine: &MachineType) -> BelievedModel {
    let (slowest, fastest) = machine.speed_range;
    let limits = &mut pair.limits;
    limits.lowest_speed = limits.lowest_speed.max(slowest).min(fastest);
    limits.highest_speed = limits.highest_speed.max(slowest).min(fastest);
    let nominal = toolroom_wear::Cut::nominal(cut.cutting_speed, cut.feed, cut.depth_of_cut);
    let toolroom_wear::Scatter { allowance, common_wear, .. } = tool.scatter;
    BelievedModel { pair: Arc::new(pair), cut: nominal, path: cut.path_length, allowance, edge_scatter: common_wear }
}
