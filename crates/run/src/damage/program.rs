//! `crumple damage`: stiffness of a front from barrier tests, and speed from damage.

use std::ffi::OsString;
use std::io::Write;
use std::path::{Path, PathBuf};

use anyhow::Context;
use crumple_artifact::{OutputKind, write_atomically};
use crumple_metrics::{
    BarrierTest, CollidedVehicle, DamageSpeed, DamagedVehicle, collision_speed, crush_by_force, damage_speed,
    effective_mass_share,
};
use crumple_stage::{DisplayFlag, ExitStatus, Refused, Usage, keep_budget, printable, refuse_to_overwrite, to_stdout};

use super::lines::{common_assumptions, force_warning, lines, vehicle_assumptions, vehicle_warnings};
use super::result::{
    CollisionResult, CrushSource, DamageResult, EnergyKind, SCHEMA, StiffnessResult, VehicleDamage, VehicleResult,
};
use super::stiffness::{FrontStiffness, TypedStiffness};
use super::typed::{self, Coefficients, Line, Profile};

/// Speed from damage: crush energy, equivalent barrier speed, and delta-v of two vehicles.
///
/// The stiffness A, B, G of a front comes from runs of barrier tests, from tests that are typed, from b0 and b1, or is
/// typed. Without a profile only the stiffness is printed.
#[derive(Debug, clap::Parser)]
#[command(
    name = "crumple-damage",
    version,
    after_help = "Values typed by a person carry their unit: 1400kg, 150cm, 8km/h.\n\
                  Exit codes: 0 done, 1 unforeseen failure, 2 usage, 3 input refused."
)]
pub struct DamageOptions {
    /// Run folders of barrier tests of this front.
    #[arg(long, value_name = "RUN", num_args = 1..)]
    from: Vec<PathBuf>,
    /// A test: mass, speed, crush, width: 1400kg,56km/h,48cm,150cm.
    ///
    /// The crush is the mean of the residual crush over the width, the barrier rigid. May be repeated.
    #[arg(long, value_name = "TEST", value_parser = typed::test)]
    test: Vec<BarrierTest>,
    /// b0 and b1 of a line: 2.2m/s,25/s.
    ///
    /// Behind them mass and width of their tests, 2.2m/s,25/s,1400kg,150cm; default: those of the vehicle.
    #[arg(long, value_name = "B0,B1", value_parser = typed::line)]
    line: Option<Line>,
    /// A and B: 55kN/m,400kN/m^2 or 300lb/in,60lb/in^2.
    #[arg(long, value_name = "A,B", value_parser = typed::coefficients)]
    stiffness: Option<Coefficients>,
    /// Speed without damage, b0, of all tests.
    ///
    /// Default: of several tests that of their line; of one test that of its run, or 8.0 km/h (5 mph).
    #[arg(long, value_name = "SPEED", value_parser = typed::speed)]
    no_damage_speed: Option<f64>,
    /// Residual crush at 2 to 12 stations: 10,25,38,40,31,12cm.
    ///
    /// At equal distances over the width of the damage, from one end to the other.
    #[arg(long, value_name = "CRUSH", value_parser = typed::profile)]
    profile: Option<Profile>,
    /// Width of the damage.
    #[arg(long, value_name = "LENGTH", value_parser = typed::length)]
    width: Option<f64>,
    /// Mass of the vehicle in the crash.
    #[arg(long, value_name = "MASS", value_parser = typed::mass)]
    mass: Option<f64>,
    /// Principal force from the normal of the side, up to 45deg.
    #[arg(long, value_name = "ANGLE", default_value = "0deg", requires = "profile", value_parser = typed::angle,
          allow_hyphen_values = true)]
    angle: f64,
    /// Lever arm of the force [default: a central impact].
    #[arg(long, value_name = "LENGTH", requires = "yaw_radius", value_parser = typed::lever)]
    lever: Option<f64>,
    /// Radius of gyration in yaw.
    #[arg(long, value_name = "LENGTH", requires = "lever", value_parser = typed::length)]
    yaw_radius: Option<f64>,
    #[command(flatten)]
    other: OtherOptions,
    /// Restitution; 0: both leave with a common velocity.
    #[arg(long, value_name = "E", default_value = "0.1", requires = "other_mass",
          value_parser = typed::restitution)]
    restitution: f64,
    /// What the crush energies hold.
    #[arg(long, value_enum, value_name = "KIND", default_value = "approach", requires = "other_mass")]
    energy: EnergyKind,
    /// Print one object of JSON in SI units instead of lines.
    #[arg(long)]
    json: bool,
    /// Write that object to a file.
    #[arg(short, long, value_name = "FILE.json")]
    output: Option<PathBuf>,
    /// Print no lines.
    #[arg(short, long)]
    quiet: bool,
    #[command(flatten)]
    display: DisplayFlag,
}

/// The second vehicle.
#[derive(Debug, clap::Args)]
struct OtherOptions {
    /// The same of the second vehicle.
    #[arg(long = "other-from", id = "other_from", value_name = "RUN", num_args = 1..)]
    from: Vec<PathBuf>,
    /// The same of the second vehicle.
    #[arg(long = "other-test", id = "other_test", value_name = "TEST", value_parser = typed::test)]
    test: Vec<BarrierTest>,
    /// The same of the second vehicle.
    #[arg(long = "other-line", id = "other_line", value_name = "B0,B1", value_parser = typed::line)]
    line: Option<Line>,
    /// The same of the second vehicle.
    #[arg(long = "other-stiffness", id = "other_stiffness", value_name = "A,B", value_parser = typed::coefficients)]
    stiffness: Option<Coefficients>,
    /// The same of the second vehicle [default: by force balance].
    #[arg(long = "other-profile", id = "other_profile", value_name = "CRUSH", value_parser = typed::profile)]
    profile: Option<Profile>,
    /// The same of the second vehicle.
    #[arg(long = "other-width", id = "other_width", value_name = "LENGTH", value_parser = typed::length)]
    width: Option<f64>,
    /// The same of the second vehicle.
    #[arg(long = "other-mass", id = "other_mass", value_name = "MASS", value_parser = typed::mass)]
    mass: Option<f64>,
    /// The same of the second vehicle.
    #[arg(long = "other-angle", id = "other_angle", value_name = "ANGLE", value_parser = typed::angle,
          allow_hyphen_values = true)]
    angle: Option<f64>,
    /// The same of the second vehicle.
    #[arg(long = "other-lever", id = "other_lever", value_name = "LENGTH", requires = "other_yaw_radius",
          value_parser = typed::lever)]
    lever: Option<f64>,
    /// The same of the second vehicle.
    #[arg(long = "other-yaw-radius", id = "other_yaw_radius", value_name = "LENGTH", requires = "other_lever",
          value_parser = typed::length)]
    yaw_radius: Option<f64>,
}

/// What was typed about one vehicle.
#[derive(Debug, Clone, Copy)]
struct Side<'a> {
    name: &'static str,
    stiffness: TypedStiffness<'a>,
    profile: Option<&'a [f64]>,
    angle_rad: f64,
    lever_and_yaw_radius_m: Option<(f64, f64)>,
}

/// Speed from damage; `words`: those typed behind the name of the program.
pub(crate) fn damage(options: DamageOptions, words: &[OsString]) -> anyhow::Result<ExitStatus> {
    let runs = [&options.from[..], &options.other.from].concat();
    keep_budget(&runs, ExitStatus::Refused);
    let display = options.display.or_of(None)?;
    if let Some(output) = &options.output {
        let is_json = output.extension().is_none_or(|ending| ending.eq_ignore_ascii_case("json"));
        if !is_json {
            let problem = format!("{} is to be JSON by its content, and not by its name", output.display());
            let hint = format!("-o {}; damage writes no page", output.with_extension("json").display());
            return Err(Usage::new(problem).hint(hint).into());
        }
        refuse_to_overwrite(output, OutputKind::Summary, &runs)?;
    }
    let result = options.result(words)?;
    let json = serde_json::to_string_pretty(&result)? + "\n";
    if let Some(output) = &options.output {
        write(output, &json)?;
    }
    let in_lines = || printable(&(display.during(|| lines(&result)).join("\n") + "\n")).into_owned();
    match (options.json, options.quiet) {
        (true, _) => to_stdout(json.as_bytes())?,
        (false, true) => {}
        (false, false) => to_stdout(in_lines().as_bytes())?,
    }
    Ok(ExitStatus::Done)
}

fn write(output: &Path, json: &str) -> anyhow::Result<()> {
    write_atomically(output, OutputKind::Summary, |file| file.write_all(json.as_bytes()))
        .with_context(|| format!("cannot write {}", output.display()))
}

impl DamageOptions {
    fn side<'a>(&'a self, completed: &'a str) -> Side<'a> {
        let is_one = !self.other(completed).is_stated();
        Side {
            name: if is_one { "vehicle" } else { "first vehicle" },
            stiffness: TypedStiffness {
                runs: &self.from,
                tests: &self.test,
                line: self.line,
                coefficients: self.stiffness,
                no_damage_speed_m_per_s: self.no_damage_speed,
                mass_kg: self.mass,
                width_m: self.width,
                flag: "--",
                completed,
            },
            profile: self.profile.as_ref().map(|profile| &profile.0[..]),
            angle_rad: self.angle,
            lever_and_yaw_radius_m: self.lever.zip(self.yaw_radius),
        }
    }

    fn other<'a>(&'a self, completed: &'a str) -> Side<'a> {
        let other = &self.other;
        Side {
            name: "other vehicle",
            stiffness: TypedStiffness {
                runs: &other.from,
                tests: &other.test,
                line: other.line,
                coefficients: other.stiffness,
                no_damage_speed_m_per_s: self.no_damage_speed,
                mass_kg: other.mass,
                width_m: other.width,
                flag: "--other-",
                completed,
            },
            profile: other.profile.as_ref().map(|profile| &profile.0[..]),
            angle_rad: other.angle.unwrap_or(0.0),
            lever_and_yaw_radius_m: other.lever.zip(other.yaw_radius),
        }
    }

    /// The line that was typed with all that its vehicles lack, to be typed in its place.
    fn completed(&self, words: &[OsString]) -> String {
        let (first, other) = (self.side(""), self.other(""));
        let mut missing = first.stiffness.missing();
        if other.is_stated() {
            if first.profile.is_none() {
                missing.push("--profile 10,25,38,40,31,12cm".to_owned());
            }
            missing.extend(other.stiffness.missing());
        }
        typed::line_with(words, &missing)
    }

    /// b0 is of tests; typed coefficients have their own.
    fn refuse_unused_b0(&self) -> Result<(), Usage> {
        let sides = [&self.from, &self.other.from];
        let has_tests =
            sides.iter().any(|runs| !runs.is_empty()) || !(self.test.is_empty() && self.other.test.is_empty());
        if self.no_damage_speed.is_some() && !has_tests {
            let problem = "--no-damage-speed is for barrier tests, and there are none";
            return Err(Usage::new(problem).hint("leave it out: b0 is in --line, or in A and B of --stiffness"));
        }
        Ok(())
    }

    fn result(&self, words: &[OsString]) -> anyhow::Result<DamageResult> {
        let completed = self.completed(words);
        let (first, other) = (self.side(&completed), self.other(&completed));
        let has_other = other.is_stated();
        self.refuse_unused_b0()?;
        let front = first.stiffness.stiffness()?;
        let is_stiffness_only = !has_other && first.profile.is_none();
        let first_damage = if is_stiffness_only { None } else { Some(first.damage(&front, None)?) };
        let vehicle = VehicleResult {
            stiffness: StiffnessResult::from(&front),
            damage: first_damage.as_ref().map(|(damage, _)| damage.clone()),
        };
        let mut result = DamageResult {
            schema: SCHEMA,
            interval_level: 0.95,
            warnings: vehicle_warnings(first.name, &vehicle),
            assumed: vehicle_assumptions(first.name, &vehicle),
            vehicle,
            other: None,
            collision: None,
        };
        if let Some((damage, speed)) = first_damage.filter(|_| has_other) {
            let front = other.stiffness.stiffness()?;
            let (other_damage, other_speed) = other.damage(&front, Some(speed.peak_force_n))?;
            let shares = [first.effective_mass_share(), other.effective_mass_share()];
            let collision = self.collision([(&damage, &speed), (&other_damage, &other_speed)], shares)?;
            let vehicle = VehicleResult { stiffness: StiffnessResult::from(&front), damage: Some(other_damage) };
            result.warnings.extend(vehicle_warnings(other.name, &vehicle));
            result.warnings.extend(force_warning(&collision));
            result.assumed.extend(vehicle_assumptions(other.name, &vehicle));
            (result.other, result.collision) = (Some(vehicle), Some(collision));
        }
        let assumed = common_assumptions(&result);
        result.assumed.extend(assumed);
        Ok(result)
    }

    fn collision(
        &self,
        sides: [(&VehicleDamage, &DamageSpeed); 2],
        shares: [f64; 2],
    ) -> anyhow::Result<CollisionResult> {
        let vehicles = [0, 1].map(|index| CollidedVehicle {
            mass_kg: sides[index].0.mass_kg,
            energy_j: sides[index].0.energy_j,
            // A crush by the force of the other has no interval.
            energy_half_width_j: sides[index].0.energy_interval_j.and(sides[index].1.energy_half_width_j()),
            effective_mass_share: shares[index],
        });
        let speed = collision_speed(vehicles, self.restitution, self.energy.into());
        let impossible = || Refused::new("the crush energies and masses give no speed").hint("check their units");
        let speed = speed.ok_or_else(impossible)?;
        Ok(CollisionResult::new(&speed, (self.restitution, self.energy), shares, sides.map(|(damage, _)| damage)))
    }
}

impl Side<'_> {
    /// Whether anything was typed about it.
    fn is_stated(&self) -> bool {
        let values =
            [self.stiffness.width_m, self.stiffness.mass_kg, self.lever_and_yaw_radius_m.map(|(lever, _)| lever)];
        self.stiffness.is_stated() || self.profile.is_some() || values.iter().any(Option::is_some)
    }

    fn effective_mass_share(&self) -> f64 {
        self.lever_and_yaw_radius_m.map_or(1.0, |(lever, radius)| effective_mass_share(radius, lever))
    }

    /// Its damage and speed; without a profile the even crush at which it bears a force.
    fn damage(&self, front: &FrontStiffness, force_n: Option<f64>) -> anyhow::Result<(VehicleDamage, DamageSpeed)> {
        let (name, flag) = (self.name, self.stiffness.flag);
        let missing =
            |what: &str| Usage::new(format!("the {what} of the {name} is missing")).hint(self.stiffness.completed);
        let mass_kg = self.stiffness.mass_kg.ok_or_else(|| missing("mass"))?;
        let width_m = self.stiffness.width_m.ok_or_else(|| missing("width"))?;
        let even = match (self.profile, force_n) {
            (Some(_), _) => None,
            (None, None) => return Err(missing("profile").into()),
            (None, Some(force)) => {
                let normal = force * self.angle_rad.cos();
                let crush = crush_by_force(&front.coefficients, width_m, normal).ok_or_else(|| {
                    Refused::new(format!("the {name} is not crushed by the force of the first, {:.0} kN", 1e-3 * force))
                        .hint(format!("check its width and stiffness, or state {flag}profile"))
                })?;
                Some([crush; 2])
            }
        };
        let crush_source = if even.is_some() { CrushSource::ForceBalance } else { CrushSource::Profile };
        let crush_m = even.as_ref().map_or(self.profile.unwrap_or_default(), |even| even);
        let vehicle = DamagedVehicle { mass_kg, width_m, crush_m, force_angle_rad: self.angle_rad };
        let speed = damage_speed(&front.line, &vehicle).map_err(|problem| {
            Refused::new(format!("the {name}: {problem}")).hint("check the values and their units")
        })?;
        Ok((VehicleDamage::new(&vehicle, crush_source, &speed), speed))
    }
}
