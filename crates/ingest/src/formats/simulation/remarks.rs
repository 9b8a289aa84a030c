//! What is remarked about simulations.

use crumple_signal::{About, Weight, remarks};

remarks! {
    /// Remarks of simulations.
    pub REMARKS;

    /// The record is the result of a simulation.
    CR170 Simulated { solver: String, contents: String }
    bears on (About::Record, Weight::None)
    decided "The file is an output of a crash solver. The sentence names what it holds."
    means "There is no sensor: no zero level, no noise, no trigger. Accelerations are derivatives of the velocity, \
           which is exact at every state."
    remedy "nothing"
    says format!("result of a simulation ({solver}): {contents}; accelerations are derivatives of the velocity");

    /// These units were used.
    CR171 UnitsOfModel { system: String, from: String, words: String }
    bears on (About::Record, Weight::None)
    decided "--units or the file states the system of units. Mass, speed and time that follow are those of a car."
    means "Every quantity is converted by the system: lengths, speeds, forces, energies."
    remedy "nothing; --units states another system"
    says format!("units {system} by {from}: {words}");

    /// In these units the simulation is not that of a car.
    CR172 UnitsDoubted { system: String, from: String, words: String, fitting: String }
    bears on (About::Record, Weight::Decisive)
    decided "A crash of a car lasts 30 to 500 ms, from 3 to 30 m/s, with 600 to 3500 kg. Where --units is not of a car \
             and another system is, the file is refused instead."
    means "Crush, force and energy are wrong by large factors if the system is wrong."
    remedy "check the units of the model; --units states another system"
    says format!("units {system} by {from} give {words}, which is no crash of a car; {fitting}");

    /// The model moves against its axis and was turned.
    CR173 Turned { axis: String, speed_m_per_s: f64 }
    bears on (About::Pulse, Weight::None)
    decided "The velocity of the node at the start says where it drives to. Motions and forces are along that line."
    means "Speeds are positive and a deceleration is negative, as of a test."
    remedy "nothing"
    says format!(
        "the model drives to -{axis} at {speed_m_per_s:.3} m/s: motions and forces are turned to the line of driving"
    );

    /// The written acceleration does not fit the velocity.
    CR174 Aliased { node: String, largest_m_per_s: f64, integral_m_per_s: f64, velocity_m_per_s: f64 }
    bears on (About::Pulse, Weight::None)
    decided "The integral of the written acceleration leaves the written velocity by more than 0.1 m/s. Accelerations \
             are of one time step: what is above half the output rate folds down."
    means "The written acceleration is aliased and not used. The pulse is the derivative of the velocity."
    remedy "nothing; for a comparison of accelerations write them averaged (IACCOP 1) or more often"
    says format!(
        "the acceleration of node {node} is aliased: its integral is off the velocity by up to {largest_m_per_s:.2} \
         m/s (end {integral_m_per_s:.2}, velocity {velocity_m_per_s:.2} m/s); the velocity is used"
    );

    /// The end of the result is missing.
    CR175 EndMissing { files: String, states: usize, until: f64 }
    bears on (About::Record, Weight::Marked)
    decided "The last table of symbols or the last state is not whole: the run goes on or was stopped, or it is cut."
    means "States after this are missing: the car may not have stopped yet."
    remedy "give the output of the whole run"
    says format!("{files} is cut: {states} states, the last at {until} in the units of the file");

    /// The force of the wall misses a part of its impulse.
    CR176 Undersampled { impulse_n_s: f64, momentum_n_s: f64, peak_n: f64, state: usize }
    bears on (About::WallForce, Weight::Marked)
    decided "The integral of the force is compared with the change of the model's momentum; beyond 2 % it is said."
    means "A rigid wall takes the momentum of a node in one step: the output interval misses such spikes. Forces are \
           too small or too large by this share."
    remedy "write the force more often; for energies and crush use the velocity"
    says {
        // Four digits, of a car as of a grain.
        let [impulse, momentum] = [impulse_n_s, momentum_n_s].map(|x| format!("{x:.3e}").parse().unwrap_or(*x));
        format!(
            "the force of the wall is undersampled: its impulse is {impulse} N s, the change of momentum {momentum} \
             N s; its largest is {peak_n:.3} N at state {state}"
        )
    };

    /// Impulses were differentiated.
    CR177 FromImpulse { walls: String }
    bears on (About::WallForce, Weight::None)
    decided "OpenRadioss writes impulses for walls, interfaces and sections. Of a table the change of momentum tells \
             whether its columns are impulses or forces."
    means "The force is the derivative of the impulse by central differences."
    remedy "nothing"
    says format!("impulse, not force, is written for {walls}: the force is its derivative");

    /// The model touches the wall in the first state.
    CR178 StartMissing { wall: String }
    bears on (About::Time, Weight::Marked)
    decided "The force of the wall is above 0.5 % of its peak in the first state."
    means "The beginning of the crash is not in the record: crush and delta-v are lower bounds."
    remedy "give the output from the start of the run"
    says format!("the start is missing: wall {wall} has a force in the first state");

    /// No force of a wall is in the result.
    CR179 NoWall {}
    bears on (About::WallForce, Weight::None)
    decided "No rigid wall is in the output, or none has a force along the line of driving."
    means "Contact is taken from the deceleration. What gives way is told by deceleration only."
    remedy "write rwforc (LS-DYNA) or the wall (/TH/RWALL), and give the whole folder"
    says "no force of a wall is in it: contact and segments by deceleration only";

    /// States at unequal times were brought to equal ones.
    CR180 UnequalStates { of: String, rate_hz: f64 }
    bears on (About::Time, Weight::None)
    decided "A solver writes a state at the first time step after an interval. Values are interpolated linearly."
    means "The error is an eighth of the step squared times the second derivative."
    remedy "nothing; --resample states another rate"
    says format!("states of {of} are at unequal times: resampled at {rate_hz:.1} Hz");

    /// Rows of a text are cut.
    CR181 RowsCut { file: String, rows: usize }
    bears on (About::Record, Weight::Slight)
    decided "A row of a state must hold all its numbers."
    means "These rows are left out: the run was stopped, or the file is cut."
    remedy "give the output of the whole run"
    says format!("{rows} rows of {file} are not whole and left out");

    /// Forces or impulses, which is not known.
    CR182 ForceOrImpulse { walls: String }
    bears on (About::WallForce, Weight::Slight)
    decided "Neither the last value nor the integral of the columns fits the change of momentum within 20 %."
    means "The columns are left out: an impulse is never taken for a force."
    remedy "give the T01 file itself with its T01_TITLES"
    says format!("force or impulse, which cannot be told, for {walls}: left out");

    /// The run blew up.
    CR183 BlownUp { count: usize, of: String, from: f64 }
    bears on (About::Record, Weight::Marked)
    decided "The last state of a node, wall or part holds no number, but NaN, Infinity or fields of stars. Its record \
             ends in front of the first of them."
    means "The solver lost the solution: a run that blew up is no result, also before that time."
    remedy "look at the messages of the solver"
    says {
        let first = if *count > 1 { ", the first of them" } else { "" };
        format!("no numbers from {from} on (units of the file{first}) in {of}: the run blew up")
    };

    /// Columns hold what is no number.
    CR184 NotNumbers { count: usize, of: String, columns: String }
    bears on (About::Record, Weight::Slight)
    decided "NaN, Infinity and fields of stars are no numbers. Columns that hold one are left out."
    means "The other columns are as the solver wrote them."
    remedy "give binout: in a text a field of stars is too narrow for its number"
    says {
        let members = if *count > 1 { format!(" ({count})") } else { String::new() };
        format!("{columns} of {of}{members} left out: not every value is a number")
    };

    /// Columns without names were taken by their place.
    CR185 NamedByPlace { first: usize, last: usize }
    bears on (About::Record, Weight::Slight)
    decided "th_to_csv had no T01_TITLES. An element with nine columns is taken for a node, one with six for a wall or \
             an interface, in the order of their codes. Displacements are the integrals of the velocities."
    means "A table of other variables would be read wrongly if it had the same numbers of them."
    remedy "give the T01 file itself with its T01_TITLES"
    says format!("columns {first} to {last} have no names: taken by their order, which their values bear out");
}
