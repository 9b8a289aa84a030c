//! A candidate as a Modelica model: masses, and what joins them, with the laws of `crumple-lumped`.
//!
//! The text needs no library and no tables. Parameters stand at its top, so that a mass, a speed or a knot is changed
//! where Modelica is simulated. It follows the Modelica Language Specification 3.6.

use std::fmt::Write;

use crumple_artifact::records::{CandidateV1, RecommendationV1, TestV1};
use crumple_artifact::{Artifact, ReadError};
use crumple_lumped::{Connection, Element, Extrapolation, ForceDeflection, Node, OwnForce, Structure, structure_of};
use crumple_stage::{Refused, Usage, unknown_name};

use super::program::records;

/// The text of a candidate, the recommended one unless its ID is given. Errors: no such candidate, one without a
/// structure of masses and elements, a run without an impact speed.
pub(crate) fn modelica(artifacts: &[Artifact], id: Option<&str>) -> anyhow::Result<String> {
    let candidates = found(records::<CandidateV1>(artifacts, "/parameters/"))?;
    let chosen = found(records::<RecommendationV1>(artifacts, "/recommendation"))?;
    let ids: Vec<&str> = candidates.iter().map(|(id, _)| id.as_str()).collect();
    let id = match id {
        Some(id) => id.to_owned(),
        None => chosen.into_iter().find_map(|(_, choice)| choice.recommended).ok_or_else(|| {
            let hint = ids.first().map_or("run the chain to its report".to_owned(), |id| format!("--candidate {id}"));
            Refused::new("the run recommends no model").hint(hint)
        })?,
    };
    let unknown = || unknown_name(&format!("the run has no candidate {id:?}"), &id, &ids);
    let candidate = &candidates.iter().find(|(own, _)| *own == id).ok_or_else(unknown)?.1;
    let tests = found(records::<TestV1>(artifacts, "/test"))?;
    let speed = tests.iter().find_map(|(_, test)| test.impact_speed_m_per_s);
    let speed = speed.ok_or_else(|| Usage::new("the run has no impact speed").hint("run it with --impact-speed"))?;
    let structure = structure_of(&candidate.model, candidate.law.as_deref(), &candidate.parameters)
        .map_err(|problem| Refused::new(format!("{id}: {problem}")).hint("name one of Crumple with --candidate"))?;
    if structure.connections().iter().any(is_too_long) {
        let problem = format!("{id}: a force of its law is too long for an equation");
        return Err(Refused::new(problem).hint("use fewer of abs, min and max within each other").into());
    }
    Ok(ModelText::of(&structure, speed).written(&id, candidate))
}

/// Whether an element has a law that is not written, with names as long as here.
fn is_too_long(connection: &Connection) -> bool {
    let Element::OwnForce(own) = &connection.element else { return false };
    own.written_force("u10", "w10", &|place| format!("p10_{}", place + 1)).is_none()
}

fn found<T>(records: Result<T, ReadError>) -> Result<T, Refused> {
    records.map_err(Refused::from)
}

/// The parts of a model.
#[derive(Debug, Default)]
struct ModelText {
    parameters: Vec<String>,
    variables: Vec<String>,
    equations: Vec<String>,
}

impl ModelText {
    /// A structure that runs against a wall that stands still.
    fn of(structure: &Structure, speed_m_per_s: f64) -> Self {
        let mut text = Self::default();
        text.parameter("v0", "m/s", speed_m_per_s, "impact speed");
        for (i, kg) in structure.masses_kg().iter().enumerate() {
            let n = i + 1;
            text.parameter(&format!("m{n}"), "kg", *kg, &format!("mass {n}"));
            text.variables.extend([
                format!("Real x{n}(unit = \"m\", start = 0, fixed = true) \"displacement of mass {n}\";"),
                format!("Real v{n}(unit = \"m/s\", start = v0, fixed = true) \"its velocity\";"),
                format!("Real a{n}(unit = \"m/s2\") \"its acceleration, negative where it slows down\";"),
            ]);
            text.equations.extend([format!("der(x{n}) = v{n};"), format!("der(v{n}) = a{n};")]);
        }
        for (i, connection) in structure.connections().iter().enumerate() {
            text.connect(i + 1, connection);
        }
        for i in 0..structure.masses_kg().len() {
            let term = |(j, connection): (usize, &Connection)| {
                let of = |node: Node, sign: &str| (node == Node::Mass(i)).then(|| format!("{sign} f{}", j + 1));
                of(connection.rear, "-").or_else(|| of(connection.front, "+"))
            };
            let forces: Vec<String> = structure.connections().iter().enumerate().filter_map(term).collect();
            let sum = if forces.is_empty() { "0".to_owned() } else { forces.join(" ") };
            text.equations.push(format!("m{n} * a{n} = {sum};", n = i + 1));
        }
        text
    }

    fn parameter(&mut self, name: &str, unit: &str, value: f64, what: &str) {
        self.parameters.push(format!("parameter Real {name}(unit = \"{unit}\") = {value:?} \"{what}\";"));
    }

    /// An element: its compression, the rate of it, and its force by its law.
    fn connect(&mut self, n: usize, connection: &Connection) {
        let [front, rear] = [connection.front, connection.rear].map(|node| match node {
            Node::Wall => None,
            Node::Mass(i) => Some(i + 1),
        });
        let named = |node: Option<usize>| node.map_or("the wall".to_owned(), |i| format!("mass {i}"));
        let between = format!("between {} and {}", named(front), named(rear));
        let less = |symbol: &str| {
            let of = |node: Option<usize>| node.map_or("0".to_owned(), |i| format!("{symbol}{i}"));
            format!("{} - {}", of(rear), of(front))
        };
        self.variables.extend([
            format!("Real u{n}(unit = \"m\") \"compression {between}\";"),
            format!("Real w{n}(unit = \"m/s\") \"its rate\";"),
            format!("Real f{n}(unit = \"N\") \"force {between}\";"),
        ]);
        self.equations.extend([format!("u{n} = {};", less("x")), format!("w{n} = {};", less("v"))]);
        match &connection.element {
            Element::Spring(spring) => {
                let knots: Vec<(f64, f64)> = spring.0.points().collect();
                let k = self.coefficient(&format!("k{n}"), ["m", "N/m"], &knots, &format!("abs(u{n})"));
                self.equations.push(format!("f{n} = {k} * u{n};"));
            }
            Element::Damper(damper) => {
                let knots: Vec<(f64, f64)> = damper.0.points().collect();
                let c = self.coefficient(&format!("c{n}"), ["m/s", "N.s/m"], &knots, &format!("abs(w{n})"));
                self.equations.push(format!("f{n} = {c} * w{n};"));
            }
            Element::SeriesSpringDamper(series) => {
                self.parameter(&format!("k{n}"), "N/m", series.stiffness_n_per_m, "stiffness");
                self.parameter(&format!("c{n}"), "N.s/m", series.damping_n_s_per_m, "damping in series with it");
                let spring = "compression of the spring alone";
                self.variables.push(format!("Real z{n}(unit = \"m\", start = 0, fixed = true) \"{spring}\";"));
                self.equations
                    .extend([format!("der(z{n}) = w{n} - k{n} / c{n} * z{n};"), format!("f{n} = k{n} * z{n};")]);
            }
            Element::PlasticSpring(spring) => {
                self.parameter(&format!("k{n}"), "N/m", spring.loading_stiffness_n_per_m, "stiffness of loading");
                self.parameter(&format!("ku{n}"), "N/m", spring.unloading_stiffness_n_per_m, "stiffness of unloading");
                let stands = |at: &str| format!("k{n} * {at}");
                let moving = stands(&format!("u{n}"));
                self.crushed(n, &format!("u{n}"), stands, (moving, None), spring.release);
            }
            Element::ForceDeflection(element) => self.force_deflection(n, element),
            Element::OwnForce(own) => self.own_force(n, own),
        }
    }

    /// A force of a law of one's own, its parameters numbered as in the law.
    fn own_force(&mut self, n: usize, own: &OwnForce) {
        let named = |place: usize| format!("p{n}_{}", place + 1);
        for (place, (value, _)) in own.values().enumerate().filter(|(_, (_, is_used))| *is_used) {
            self.parameter(&named(place), "1", value, "parameter of the law, in SI");
        }
        let written = |x: &str, v: &str| own.written_force(x, v, &named).unwrap_or_default();
        let x = format!("u{n}");
        let Some(stiffness) = own.written_unloading(&format!("({})", written(&x, "0")), &x, &named) else {
            self.equations.push(format!("f{n} = {};", written(&x, &format!("w{n}"))));
            return;
        };
        self.variables.push(format!("discrete Real ku{n}(unit = \"N/m\", start = 1, fixed = true) \"unloading\";"));
        let moving = written(&x, &format!("w{n}"));
        let turn = format!("  ku{n} = max(1, {stiffness});");
        self.crushed(n, &x, |at| format!("({})", written(at, "0")), (moving, Some(turn)), true);
    }

    /// A coefficient that is linear between knots `(place, value)` over `at`, and constant outside.
    fn coefficient(&mut self, name: &str, [of, unit]: [&str; 2], knots: &[(f64, f64)], at: &str) -> String {
        if let [(_, only)] = knots {
            self.parameter(name, unit, *only, "coefficient");
            return name.to_owned();
        }
        for (j, (place, value)) in knots.iter().enumerate() {
            self.parameter(&format!("{name}_at{j}"), of, *place, "knot");
            self.parameter(&format!("{name}_{j}"), unit, *value, "coefficient at this knot");
        }
        let last = knots.len() - 1;
        format!("({})", linear(name, "_at", last, at, &format!("{name}_{last}")))
    }

    /// A structure that is crushed: its static curve, then [`crushed`](Self::crushed).
    fn force_deflection(&mut self, n: usize, element: &ForceDeflection) {
        let (knots, name) = (element.knots(), format!("F{n}"));
        for (j, (deflection, force)) in knots.iter().enumerate() {
            self.parameter(&format!("{name}_at{j}"), "m", *deflection, "deflection at a knot");
            self.parameter(&format!("{name}_{j}"), "N", *force, "force at this knot");
        }
        self.parameter(&format!("ku{n}"), "N/m", element.unloading_n_per_m(), "stiffness of unloading");
        self.parameter(&format!("gap{n}"), "m", element.gap_m(), "gap that closes first");
        self.parameter(&format!("rate{n}"), "s/m", element.rate_s_per_m(), "rate factor of loading");
        self.variables.push(format!("Real d{n}(unit = \"m\") \"deflection behind the gap\";"));
        self.equations.push(format!("d{n} = u{n} - gap{n};"));
        let last = knots.len() - 1;
        let slope = match element.extrapolation() {
            Extrapolation::Constant => "0".to_owned(),
            Extrapolation::Slope => {
                let (from, to) = (last - 1, last);
                format!("max(0, ({name}_{to} - {name}_{from}) / ({name}_at{to} - {name}_at{from}))")
            }
            Extrapolation::Stiffness(stiffness) => {
                self.parameter(&format!("kb{n}"), "N/m", stiffness, "stiffness beyond the last knot");
                format!("kb{n}")
            }
        };
        let limit = element.limit_n().map(|limit| {
            self.parameter(&format!("limit{n}"), "N", limit, "force limit");
            format!("limit{n}")
        });
        let stands = |at: &str| {
            let beyond = format!("{name}_{last} + {slope} * ({at} - {name}_at{last})");
            let curve = linear(&name, "_at", last, at, &beyond);
            let curve = format!("(if {at} < 0 then 0 else {curve})");
            limit.as_ref().map_or(curve.clone(), |limit| format!("min({limit}, {curve})"))
        };
        let d = format!("d{n}");
        let dynamic = format!("{} * (1 + rate{n} * w{n})", stands(&d));
        let moving = limit.as_ref().map_or(dynamic.clone(), |limit| format!("min({limit}, {dynamic})"));
        self.crushed(n, &d, stands, (moving, None), true);
    }

    /// The branches of what is crushed: along the curve while it goes in; from the turn on along the unloading
    /// stiffness about a set, out and in again until the curve is met.
    fn crushed(
        &mut self,
        n: usize,
        d: &str,
        stands: impl Fn(&str) -> String,
        (moving, at_turn): (String, Option<String>),
        release: bool,
    ) {
        self.variables.extend([
            format!("Real curve{n}(unit = \"N\") \"force of the curve\";"),
            format!("Real elastic{n}(unit = \"N\") \"force of the elastic line\";"),
            format!("discrete Real crush{n}(unit = \"m\", start = 0, fixed = true) \"deflection at the last turn\";"),
            format!("discrete Real set{n}(unit = \"m\", start = 0, fixed = true) \"permanent set\";"),
            format!("Boolean loading{n}(start = true, fixed = true) \"on the curve\";"),
        ]);
        let at_rest = stands(d);
        let again = format!("{d} >= pre(crush{n}) and (pre(crush{n}) <= 0 or elastic{n} >= curve{n})");
        let free = if release { format!("if {d} < set{n} then 0 else ") } else { String::new() };
        self.equations.extend([
            format!("curve{n} = {moving};"),
            format!("elastic{n} = ku{n} * ({d} - set{n});"),
            format!("loading{n} = w{n} >= 0 and (pre(loading{n}) or {again});"),
            format!("when not loading{n} then"),
        ]);
        self.equations.extend(at_turn);
        self.equations.extend([
            format!("  crush{n} = max(0, {d});"),
            format!("  set{n} = max(0, {d} - {at_rest} / ku{n});"),
            "end when;".to_owned(),
            format!("f{n} = if loading{n} then curve{n} else {free}elastic{n};"),
        ]);
    }

    fn written(&self, id: &str, candidate: &CandidateV1) -> String {
        let mut out = format!("model Candidate \"{id}\"\n");
        let _ = writeln!(out, "  // Written by crumple {}. SI units; time zero is contact.", env!("CARGO_PKG_VERSION"));
        let bounds = candidate.uncertainty.as_ref();
        for (name, value) in &candidate.parameters {
            let low = bounds.and_then(|known| *known.interval_low.get(name)?);
            let high = bounds.and_then(|known| *known.interval_high.get(name)?);
            let interval = low.zip(high).map(|(low, high)| format!(", 95 % interval {low:?} to {high:?}"));
            let _ = writeln!(out, "  // {name} = {value:?}{}", interval.unwrap_or_default());
        }
        for line in self.parameters.iter().chain(&self.variables) {
            let _ = writeln!(out, "  {line}");
        }
        out.push_str("equation\n");
        for line in &self.equations {
            let _ = writeln!(out, "  {line}");
        }
        out.push_str("end Candidate;\n");
        out
    }
}

/// `name` over `at`: straight between the knots 0 to `last`, then `beyond`. A step of a table would be a jump of the
/// derivative that a solver does not see; an `if` is one that it finds.
fn linear(name: &str, knot: &str, last: usize, at: &str, beyond: &str) -> String {
    let piece = |j: usize| {
        let (from, to) = (format!("{name}{knot}{j}"), format!("{name}{knot}{}", j + 1));
        let rise = format!("({name}_{} - {name}_{j}) / ({to} - {from})", j + 1);
        format!("if {at} < {to} then {name}_{j} + {rise} * ({at} - {from}) else ")
    };
    (0..last).map(piece).collect::<String>() + beyond
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use crumple_lumped::{Damper, OwnLaw, OwnModel, PiecewiseLinear, PlasticSpring, SeriesSpringDamper, Spring};

    use super::*;

    /// Two masses and every kind of element, with every part that it may have.
    fn every_element() -> ModelText {
        let knots = PiecewiseLinear::new(&[(0.0, 2e5), (0.3, 4e5), (0.6, 1e5)]).unwrap();
        let crushed = ForceDeflection::new(&[(0.0, 0.0), (0.1, 8e4), (0.5, 2e5)], 5e6).unwrap();
        let crushed = crushed.with_rate(0.01).and_then(|one| one.with_gap(0.05)).and_then(|one| one.with_limit(3e5));
        let crushed = crushed.and_then(|one| one.with_extrapolation(Extrapolation::Stiffness(1e5))).unwrap();
        let plastic = PlasticSpring { loading_stiffness_n_per_m: 3e5, unloading_stiffness_n_per_m: 3e6, release: true };
        let series = SeriesSpringDamper { stiffness_n_per_m: 1e5, damping_n_s_per_m: 1e4 };
        let fronts: [Vec<Element>; 2] = [
            vec![Spring(knots.clone()).into(), Damper(knots).into(), crushed.into()],
            vec![plastic.into(), series.into(), Spring(PiecewiseLinear::constant(1e5)).into()],
        ];
        ModelText::of(&Structure::row(&[300.0, 1100.0], fronts).unwrap(), 15.0)
    }

    /// A law of one's own that goes back along itself, along a line, and rigidly.
    fn own_forces() -> ModelText {
        let law = "[[element]]\nforce = \"k*x + c*v*abs(x)\"\n[[element]]\nforce = \"k*x^3\"\nunloading = \"9*c\"\n\
                   [[element]]\nforce = \"c*tanh(x)\"\nunloading = \"rigid\"\n\
                   [parameters]\nk = { unit = \"N/m\", value = 3e5 }\nc = { unit = \"N\", value = 1e4 }\n";
        let model = OwnModel::at_start(Arc::new(OwnLaw::read(law).unwrap()), 1200.0).unwrap();
        ModelText::of(&model.structure().unwrap(), 15.0)
    }

    #[test]
    fn a_law_of_ones_own_is_an_equation() {
        let text = own_forces();
        let of_first = "f1 = (p1_2 * u1 + p1_1 * w1 * (if u1 >= 0 then u1 else (0.0 - u1)));";
        assert!(text.equations.iter().any(|line| line == of_first), "{:#?}", text.equations);
    }

    /// As many equations as unknowns (section 4.7 of the specification), and no parameter that nothing reads.
    #[test]
    fn the_model_is_balanced_and_reads_each_parameter() {
        balanced_and_read(&every_element());
        balanced_and_read(&own_forces());
    }

    fn balanced_and_read(text: &ModelText) {
        let equations = text.equations.iter().filter(|line| line.contains(" = ")).count();
        assert_eq!(text.variables.len(), equations);
        let body = text.equations.join("\n");
        let of_start = text.variables.join("\n");
        for line in &text.parameters {
            let name = line.trim_start_matches("parameter Real ").split('(').next().unwrap();
            let is_word = |c: char| !(c.is_alphanumeric() || c == '_');
            assert!(body.split(is_word).chain(of_start.split(is_word)).any(|word| word == name), "{line}");
        }
    }

    /// The force that compresses an element pushes its rear mass back and its front mass on.
    #[test]
    fn forces_act_on_both_ends() {
        let text = every_element();
        let balance: Vec<&str> =
            text.equations.iter().filter(|line| line.starts_with('m')).map(String::as_str).collect();
        assert_eq!(balance, ["m1 * a1 = - f1 - f2 - f3 + f4 + f5 + f6;", "m2 * a2 = - f4 - f5 - f6;"]);
    }
}
