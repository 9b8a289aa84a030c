//! What is remarked of the choice of the pulse and of its sign.

use crumple_signal::{About, Weight, remarks};

use super::IMPOSSIBLE;

remarks! {
    /// Remarks of the pulse.
    pub REMARKS;

    /// The record has no crash pulse and is one of inputs and outputs.
    CR119 InputsAndOutputs { channel: Option<String>, reason: Option<String> }
    bears on (About::Pulse, Weight::None)
    decided "--allow-missing lets a record have no pulse. Nobody names one, and no mass, speed, vehicle, barrier or \
             damage speaks of a crash."
    means "Channels are filtered and linear models are identified from them. There is no crush and no model of a \
           vehicle."
    remedy "nothing; for a crash name the pulse by --channel"
    says {
        let channel =
            channel.as_ref().map(|name| format!("channel {name} stands beside quantities that are no motion"));
        let why = channel.as_ref().or(reason.as_ref()).map_or("", String::as_str);
        format!("a record of inputs and outputs, as no pulse is named (--channel names one): {why}")
    };

    /// No channel can be taken as the crash pulse.
    CR120 NoPulse { reason: String }
    bears on (About::Pulse, Weight::Decisive)
    decided "The record speaks of a crash, and --allow-missing lets it go on without a pulse. The reason names what is \
             missing."
    means "There is no velocity, no crush and no model of the vehicle."
    remedy "name the channel of the pulse by --channel"
    says format!("no channel is named as the crash pulse: {reason}");

    /// This channel is the crash pulse.
    CR121 PulseChosen { channel: String, place: Option<&'static str>, why: &'static str, others: Option<String> }
    bears on (About::Pulse, Weight::None)
    decided "--channel names it, it is the only acceleration of the vehicle, or it sits at the best place: rear-seat \
             crossmember or rear floor, rear sill, sill, B-pillar, centre of gravity, tunnel, sled, in this order."
    means "Velocity, crush and all models of the vehicle are made from this channel."
    remedy "name another channel by --channel to see how much the results depend on it"
    says {
        let why = match place {
            Some(place) => format!("valid accelerometer along x at the best available place: {place}"),
            None => (*why).to_owned(),
        };
        let others = others.as_ref().map_or_else(String::new, |others| format!("; others by --channel: {others}"));
        format!("pulse: channel {channel}, {why}{others}")
    };

    /// The laboratory does not call the pulse valid.
    CR122 PulseDoubted { id: String, status: String }
    bears on (About::Pulse, Weight::Marked)
    decided "The file states the status of every channel. This one was asked for all the same."
    means "Crush and models may be off by more than their intervals say."
    remedy "name a valid channel by --channel; --list shows the status of all"
    says format!("the pulse, channel {id}, is {status} by its laboratory");

    /// The pulse may not show the motion of the passenger compartment.
    CR123 NotOfCompartment {
        channel: String, axis: Option<String>, word: Option<&'static str>, code_says: Option<String>,
        taken: &'static str
    }
    bears on (About::Pulse, Weight::Decisive)
    decided "Its axis is not x, its name says engine, head, wheel or the like, or its code names another place than \
             the compartment."
    means "An engine stops in half the time of the car, and a head moves on its own: crush, force and models are not \
           those of the vehicle."
    remedy "name an accelerometer along x in the compartment by --channel: sill, rear floor, B-pillar"
    says {
        let doubt = match (axis, word, code_says) {
            (Some(axis), ..) => format!("it measures along {axis}, not along x"),
            (_, Some(word), _) => format!("it sits elsewhere ({word})"),
            (_, _, Some(place)) => format!("its code says {place}"),
            _ => "its place is none of rear-seat crossmember, rear floor, sill, B-pillar, centre of gravity".to_owned(),
        };
        format!(
            "channel {channel} may not show the motion of the compartment: {doubt}; {taken}. Its crush, force and \
             models are not those of the vehicle"
        )
    };

    /// The pulse is a redundant sensor.
    CR124 RedundantPulse { id: String }
    bears on (About::Pulse, Weight::Slight)
    decided "Primary sensors go first. No primary one at a place of the compartment is valid and has data."
    means "It sits where a primary sensor does, or beside it. The results hold."
    remedy "nothing; --list shows why the primary sensor is not valid"
    says format!("the pulse, channel {id}, is a redundant sensor: no primary one is valid here");

    /// The sign of the accelerations along x was turned.
    CR125 SignTurned { over_s: Option<f64>, ratio: Option<f64>, channels: usize }
    bears on (About::Pulse, Weight::None)
    decided "--sign flip asks for it; --sign auto turns a pulse that gains 0.6 to 1.6 times the impact speed in the \
             first 150 ms. A frontal impact loses 1.0 to 1.35 times that speed."
    means "Deceleration is negative after it (SAE J211). Channels along other axes stay as they are."
    remedy "nothing; --sign keep leaves the sign as it is in the file"
    says {
        let why = over_s.zip(*ratio).map_or_else(
            || "sign of acceleration turned, as asked".to_owned(),
            |(over_s, ratio)| {
                format!(
                    "sign turned by --sign auto: {}, where a frontal impact loses speed",
                    change_of_speed(over_s, ratio)
                )
            },
        );
        format!("{why}: {channels} channel{}", if *channels == 1 { "" } else { "s" })
    };

    /// --sign auto leaves the sign as it is in the file.
    CR126 SignKept { over_s: Option<f64>, ratio: Option<f64> }
    bears on (About::Pulse, Weight::None)
    decided "--sign auto turns only a pulse that gains 0.6 to 1.6 times the impact speed in the first 150 ms."
    means "The pulse loses speed as it should, or its sign is not certain."
    remedy "nothing; --sign flip turns it"
    says match over_s.zip(*ratio) {
        None => "sign kept: without a pulse and its impact speed its polarity is not certain".to_owned(),
        Some((over_s, ratio)) => {
            let gains = change_of_speed(over_s, ratio);
            let why = if ratio <= 0.0 { "" } else { ", since its polarity is not certain" };
            format!("sign kept{why}: {gains}")
        }
    };

    /// The pulse is positive, as in a motion from rest or a hit from behind.
    CR127 PushedPulse { change_m_per_s: f64, over_s: f64, ratio: Option<f64>, sign: Option<&'static str> }
    bears on (About::Pulse, Weight::Slight)
    decided "In the first 150 ms the pulse gains more than 5 % of the impact speed, and less than 60 % of it. Without \
             an impact speed: more than 0.25 m/s, and no code says that it is of a vehicle."
    means "A sled, a hit from behind or a drop looks like this. If it is a frontal impact, velocity and crush are \
           wrong."
    remedy "nothing for a motion from rest; --sign flip if deceleration is positive in this file"
    says positive(*change_m_per_s, *over_s, *ratio, sign.is_some());

    /// The pulse is positive, and a frontal impact is negative.
    CR128 PositivePulse { change_m_per_s: f64, over_s: f64, ratio: Option<f64>, sign: Option<&'static str> }
    bears on (About::Pulse, Weight::Decisive)
    decided "In the first 150 ms the pulse gains 60 % of the impact speed or more. Without an impact speed: more than \
             0.25 m/s, and --sign has turned it or its code says that it is of a vehicle. SAE J211 has deceleration \
             negative. A gain above 2.2 times the impact speed is no sign: a perfect rebound loses twice that speed."
    means "The vehicle seems to be pushed on at impact: velocity, crush and models are wrong."
    remedy "add --sign flip, or leave --sign out if it is given; of a very large gain check the unit first"
    says positive(*change_m_per_s, *over_s, *ratio, sign.is_some());

    /// Of several velocities none is along x.
    CR129 NoneAlongX { what: &'static str, channels: String }
    bears on (About::Pulse, Weight::Slight)
    decided "The velocity, or its change, along x stands for the pulse; else one whose axis is not stated."
    means "No channel stands for the pulse: there is no delta-v and no motion."
    remedy "name the one that is meant by --channel"
    says format!("no {what} is along x: {channels}; --channel names the one that is meant");

    /// A velocity, or a change of velocity, stands for the pulse.
    CR130 VelocityTaken { what: &'static str, channel: String, others: Option<String> }
    bears on (About::Pulse, Weight::None)
    decided "The record is of a kind without a crash pulse. --channel names the velocity, or it is the first along x, \
             or the first whose axis is not stated."
    means "Delta-v is read off this channel. An acceleration is its derivative, and its peaks are uncertain."
    remedy "nothing; --channel names another one"
    says {
        let others = others.as_ref().map_or_else(String::new, |others| format!("; others: {others}"));
        format!("the {what} {channel} is taken as the pulse{others}")
    };

    /// The impact speed is read off a velocity.
    CR131 SpeedAtContact { speed_m_per_s: f64, channel: String }
    bears on (About::ImpactSpeed, Weight::None)
    decided "Nothing else states an impact speed. The velocity at time zero is at least half of the largest one: \
             motions from rest and records of changes of velocity begin with less."
    means "Crush and energy use this speed. An error of time zero changes it little."
    remedy "nothing; --impact-speed states another one"
    says format!("impact speed {speed_m_per_s:.3} m/s: velocity {channel} at time zero");
}

/// What the pulse does to the speed.
fn change_of_speed(over_s: f64, ratio: f64) -> String {
    format!("over the first {:.0} ms the pulse changes the speed by {ratio:+.2} times the impact speed", 1e3 * over_s)
}

/// A positive pulse, and what helps: turning it only where it was not turned and where what it then loses is that of
/// an impact.
fn positive(change_m_per_s: f64, over_s: f64, ratio: Option<f64>, is_turned: bool) -> String {
    let way_out = match ratio {
        _ if is_turned => "--sign has turned it: leave --sign out".to_owned(),
        Some(ratio) if ratio > IMPOSSIBLE => {
            format!(
                "{ratio:.1} times the impact speed is too large for an impact of either sign: check the unit (--unit) \
                 and the impact speed first"
            )
        }
        None => {
            "if this is a frontal impact with deceleration positive, use --sign flip; a motion from rest (a sled, a \
             hit from behind), a shock or a drop may be positive and needs no flag"
                .to_owned()
        }
        Some(_) => "if deceleration is positive in this file, use --sign flip".to_owned(),
    };
    let within = format!("+{change_m_per_s:.2} m/s in the first {:.0} ms", over_s * 1e3);
    format!("the pulse is positive ({within}); a frontal impact is negative (SAE J211). {way_out}")
}
