//! A force on the tool that begins and ends.

use super::prelude::*;

pub(super) const FAULT: Fault = Fault {
    name: "external_contact",
    forms: &["half-sine", "decaying"],
    may_repeat: true,
    draw: |bare, at, random| {
        let mut direction: [f64; 3] = [0.0; 3].map(|_: f64| StandardNormal.sample(random));
        let length = direction.iter().map(|x| x * x).sum::<f64>().sqrt();
        let size = at.load() * random.random_range(8.0..27.0);
        direction = direction.map(|x| x / length * size);
        // A recording takes 25 s of every 30 s; the contact is within one recording.
        let (first, last) = at.span;
        let recordings = ((last - first) / 30.0).round().max(1.0) as usize;
        let start = first + 30.0 * random.random_range(0..recordings) as f64;
        let bare = match if at.hard { random.random_range(1..3) } else { 0 } {
            0 => bare,
            1 => bare.formed("half-sine"),
            _ => bare.formed("decaying"),
        };
        bare.with("start", start + random.random_range(5.0..21.0))
            .with("duration", random.random_range(0.4..1.5))
            .with("force", json!(direction))
    },
    size: Size::Changed(|injected, factor| {
        let force = injected.parameters.get("force").and_then(Value::as_array);
        let force = force.into_iter().flatten().filter_map(Value::as_f64);
        vec![("force", json!(force.map(|part| factor * part).collect::<Vec<f64>>()))]
    }),
    read: |reader| {
        let contact = Contact {
            start: reader.number("start")?,
            duration: reader.number_above("duration", 0.0)?,
            force: Vector3::from(reader.numbers("force")?),
            course: [TimeCourse::Step, TimeCourse::HalfSine, TimeCourse::Decaying][reader.form()?],
        };
        Ok(vec![Property::Contact(contact).into()])
    },
    #[cfg(test)]
    example: |bare| bare.with("start", 1.0).with("duration", 1.0).with("force", json!([10.0, -15.0, 20.0])),
    ..Fault::ON_THE_ARM
};
