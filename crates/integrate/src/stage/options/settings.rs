//! The settings that the options come to.

use crumple_integrate::{EndCondition, Rule, Start, Uncertainty};
use crumple_metrics::NO_DAMAGE_SPEED_M_PER_S;
use crumple_signal::value::{Speed, Time};
use crumple_stage::Usage;
use serde::Serialize;

use crate::stage::options::flags::{BarrierCells, EndVelocity, MetricGroup, Options, ZeroRule};
use crate::stage::options::uncertainty::uncertainty;

/// Options with the defaults filled in that do not depend on the record.
#[derive(Debug, Serialize)]
pub struct StageSettings {
    pub rule: Rule,
    pub start: Start,
    /// `None`: the pulse of the test.
    pub channel: Option<String>,
    /// Further channels.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub channels: Vec<String>,
    /// `None`: by the rule.
    pub time_zero_s: Option<f64>,
    /// `None`: 0 s, where the file has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub time_zero_rule: Option<ZeroRule>,
    /// `None`: that of the test.
    pub impact_speed_m_per_s: Option<f64>,
    /// `None`: no drift is taken out.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub end_condition: Option<EndCondition>,
    #[serde(skip_serializing_if = "is_default")]
    pub barrier_cells: BarrierCells,
    /// Empty: auto.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub metrics: Vec<MetricGroup>,
    /// Speed of no damage, for CRASH3.
    #[serde(skip_serializing_if = "is_usual_speed")]
    pub no_damage_speed_m_per_s: f64,
    /// For CRASH3; `None`: what the file of the test states.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub damage: Option<Damage>,
    /// `None`: no intervals.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty: Option<Uncertainty>,
}

/// The damage of a barrier test, for the stiffness of CRASH3.
#[derive(Debug, Clone, Copy, Serialize)]
pub struct Damage {
    pub width_m: f64,
    pub residual_crush_m: f64,
}

/// Options that are not used stay out of the provenance, so that results from before they existed stay up to date.
fn is_default(cells: &BarrierCells) -> bool {
    *cells == BarrierCells::default()
}

fn is_usual_speed(speed: &f64) -> bool {
    *speed == NO_DAMAGE_SPEED_M_PER_S
}

impl TryFrom<Options> for StageSettings {
    type Error = Usage;

    fn try_from(options: Options) -> Result<Self, Usage> {
        if options.time_zero.is_some() && options.time_zero_rule.is_some() {
            return Err(Usage::new("both time-zero and time-zero-rule are given").hint("leave out either"));
        }
        if options.end_velocity.is_none() {
            let given = [("end-time", options.end_time.is_some()), ("drift", options.drift.is_some())];
            if let Some((name, _)) = given.into_iter().find(|(_, given)| *given) {
                return Err(Usage::new(format!("{name} needs end-velocity"))
                    .hint("give the velocity that is known with --end-velocity"));
            }
        }
        let uncertainty = uncertainty(&options)?;
        let metrics: Vec<MetricGroup> =
            options.metrics.iter().copied().filter(|group| *group != MetricGroup::Auto).collect();
        if metrics.contains(&MetricGroup::None) && metrics.len() > 1 {
            return Err(Usage::new("metrics none stands beside other groups").hint("leave out either"));
        }
        let damage = match (options.damage_width, options.residual_crush) {
            (Some(width), Some(crush)) => Some(Damage { width_m: width.si(), residual_crush_m: crush.si() }),
            (None, None) => None,
            _ => {
                return Err(Usage::new("damage-width and residual-crush belong together")
                    .hint("give both, e.g. --damage-width 1.6m --residual-crush 520mm"));
            }
        };
        Ok(Self {
            uncertainty,
            rule: options.rule.unwrap_or_default(),
            start: options.start.unwrap_or_default(),
            channel: options.channel,
            channels: options.channels,
            time_zero_s: options.time_zero.map(Time::si),
            time_zero_rule: options.time_zero_rule.filter(|rule| *rule != ZeroRule::File),
            impact_speed_m_per_s: options.impact_speed.map(Speed::si),
            end_condition: options.end_velocity.map(|EndVelocity(speed)| EndCondition {
                velocity_m_per_s: speed.si(),
                time_s: options.end_time.map(Time::si),
                shape: options.drift.unwrap_or_default(),
            }),
            barrier_cells: options.barrier_cells.unwrap_or_default(),
            metrics,
            no_damage_speed_m_per_s: options.no_damage_speed.map_or(NO_DAMAGE_SPEED_M_PER_S, Speed::si),
            damage,
        })
    }
}
