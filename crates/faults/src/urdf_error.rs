//! URDFs with errors: in all inertial parameters, as in every real one, or with a tool drawn that is not mounted.

use std::ops::Range;

use arm::Inertia;
use nalgebra::{Matrix4, Vector4};
use quick_xml::Reader;
use quick_xml::events::Event;
use rand_chacha::ChaCha8Rng;
use rand_distr::{Distribution, StandardNormal};

use crate::error::FaultError;
use crate::pseudo_inertia::PseudoInertia;

/// The relative errors of URDFs, which cases take in turns; the first is exact.
pub(crate) const SIGMAS: [f64; 4] = [0.0, 0.03, 0.1, 0.3];

/// `urdf` with errors in the inertial of each link that has a mass: the pseudo-inertia P becomes A P Aᵀ with A = D
/// e^(σ G) D⁻¹, where G is a 4 × 4 matrix of standard normal numbers, D = diag(l, l, l, 1), and l is the link's radius
/// of gyration. The result is always physical. `sigma` is the approximate relative error of masses and lengths.
/// Everything else keeps its bytes.
///
/// # Errors
/// [`FaultError::Setting`] if `sigma` is outside its range, or the text cannot be read.
pub(crate) fn with_inertial_errors(urdf: &str, sigma: f64, random: &mut ChaCha8Rng) -> Result<String, FaultError> {
    if !(0.0..=1.0).contains(&sigma) {
        return Err(FaultError::Setting(format!("the URDF's error is {sigma}; give a number from 0 (exact) to 1")));
    }
    if sigma == 0.0 {
        return Ok(urdf.to_owned());
    }
    let mut text = String::with_capacity(urdf.len() + 1000);
    let mut at = 0;
    for (place, body) in inertials(urdf)? {
        if body.mass > 0.0 {
            text.push_str(&urdf[at..place.start]);
            text.push_str(&with_errors(&body, sigma, random).to_urdf());
            at = place.end;
        }
    }
    text.push_str(&urdf[at..]);
    Ok(text)
}

/// A body like `body` with errors of about `sigma` in all parameters.
fn with_errors(body: &Inertia, sigma: f64, random: &mut ChaCha8Rng) -> Inertia {
    let pseudo = PseudoInertia::of(body);
    let normals = Matrix4::from_fn(|_, _| -> f64 { StandardNormal.sample(random) });
    let l = pseudo.radius();
    let (scale, back) = (Vector4::new(l, l, l, 1.0), Vector4::new(1.0 / l, 1.0 / l, 1.0 / l, 1.0));
    let map = Matrix4::from_diagonal(&scale) * (normals * sigma).exp() * Matrix4::from_diagonal(&back);
    pseudo.mapped(&map).body()
}

/// `urdf` with `tool` (in the frame of link `on`) as an additional link that is fixed to `on`.
///
/// # Errors
/// [`FaultError::Setting`] if the text has no closing tag.
pub(crate) fn with_tool(urdf: &str, on: &str, tool: &Inertia) -> Result<String, FaultError> {
    let end = urdf
        .rfind("</robot>")
        .ok_or_else(|| FaultError::Setting("the URDF has no </robot>; give one that ends".into()))?;
    let name = (1..)
        .map(|number| format!("tool_{number}"))
        .find(|name| !urdf.contains(&format!("\"{name}\"")))
        .unwrap_or_default();
    let (before, after) = urdf.split_at(end);
    let inertial = tool.to_urdf();
    let weld =
        format!("<joint name=\"{name}_weld\" type=\"fixed\"><parent link=\"{on}\"/><child link=\"{name}\"/></joint>");
    Ok(format!("{before}  <link name=\"{name}\">{inertial}</link>\n  {weld}\n{after}"))
}

/// The places of the links' inertials in the text, each with its body in the link's frame.
fn inertials(urdf: &str) -> Result<Vec<(Range<usize>, Inertia)>, FaultError> {
    let mut reader = Reader::from_str(urdf);
    let mut found = Vec::new();
    let (mut depth, mut in_link) = (0, false);
    let mut begun: Option<usize> = None;
    loop {
        let from = reader.buffer_position() as usize;
        match reader.read_event().map_err(unreadable)? {
            Event::Start(tag) => {
                depth += 1;
                match depth {
                    2 => in_link = tag.name().as_ref() == b"link",
                    3 if in_link && tag.name().as_ref() == b"inertial" => begun = Some(from),
                    _ => {}
                }
            }
            Event::End(_) => {
                if let Some(begun) = begun.take_if(|_| depth == 3) {
                    let place = begun..reader.buffer_position() as usize;
                    let body = Inertia::from_urdf(&urdf[place.clone()])
                        .map_err(|error| FaultError::Setting(error.to_string()))?;
                    found.push((place, body));
                }
                depth -= 1;
            }
            Event::Eof => return Ok(found),
            _ => {}
        }
    }
}

fn unreadable(reason: impl std::fmt::Display) -> FaultError {
    FaultError::Setting(format!("the URDF's inertials cannot be read: {reason}"))
}

#[cfg(test)]
mod tests {
    use arm::{Arm, Matrix3, Vector3};
    use rand::SeedableRng;

    use super::*;
    use crate::test_robots::{puma, seven_axis};

    fn arm(urdf: String) -> Arm {
        Arm::from_urdf_text(&urdf, "moved.urdf").expect("it is an arm")
    }

    /// Links remain physical for every error: their pseudo-inertia is positive definite; and only inertials are
    /// changed.
    #[test]
    fn a_wrong_urdf_is_always_physical() {
        let mut random = ChaCha8Rng::seed_from_u64(3);
        for robot in [puma(), seven_axis()] {
            for sigma in [0.03, 0.1, 0.3, 1.0] {
                for _ in 0..20 {
                    let text = with_inertial_errors(robot.urdf(), sigma, &mut random).expect("it can be");
                    for (_, body) in inertials(&text).expect("it can be read") {
                        let least = PseudoInertia::of(&body).0.symmetric_eigenvalues().min();
                        let moments = Matrix3::identity() * (0.5 * body.tensor.trace()) - body.tensor;
                        let central = moments.symmetric_eigenvalues().min();
                        assert!(body.mass >= 0.0 && least > -1e-12 && central > -1e-9, "{body:?}");
                    }
                    let moved = arm(text);
                    assert_eq!(moved.dof(), robot.arm().dof());
                    for (is, was) in moved.joints().iter().zip(robot.arm().joints()) {
                        assert_eq!((&is.name, is.limits), (&was.name, was.limits));
                        assert!(was.inertia.mass == 0.0 || is.inertia.mass != was.inertia.mass);
                    }
                }
            }
        }
    }

    /// Errors have the requested size: the mass of a point at the origin of its frame is multiplied by e^(2 σ N).
    #[test]
    fn sigma_is_the_size_of_the_error() {
        let mut random = ChaCha8Rng::seed_from_u64(4);
        let body = Inertia { mass: 3.0, com: Vector3::new(0.0, 0.0, 0.2), tensor: Matrix3::identity() * 0.02 };
        let logs: Vec<f64> = (0..2000).map(|_| (with_errors(&body, 0.03, &mut random).mass / 3.0).ln()).collect();
        let spread = (logs.iter().map(|log| log * log).sum::<f64>() / 2000.0).sqrt();
        assert!((0.05..0.1).contains(&spread), "{spread}");
        let (mut one, mut other) = (ChaCha8Rng::seed_from_u64(1), ChaCha8Rng::seed_from_u64(1));
        let urdf = puma().urdf().to_owned();
        assert_eq!(with_inertial_errors(&urdf, 0.0, &mut one).expect("it can be"), urdf);
        let [first, second] =
            [&mut one, &mut other].map(|random| with_inertial_errors(&urdf, 0.1, random).expect("it can be"));
        assert_eq!(first, second);
        assert!(
            with_inertial_errors(&urdf, -0.1, &mut one).is_err()
                && with_inertial_errors(&urdf, f64::NAN, &mut one).is_err()
        );
    }

    #[test]
    fn a_tool_is_drawn_in_place_of_a_payload() {
        let robot = seven_axis();
        let tool = Inertia { mass: 0.7, com: Vector3::new(0.01, 0.0, 0.08), tensor: Matrix3::identity() * 1e-3 };
        let drawn = arm(with_tool(robot.urdf(), &robot.arm().tool_frame().name, &tool).expect("it can be"));
        let loaded = robot.arm().clone().with_payload(&tool);
        let last = robot.arm().dof() - 1;
        let (drawn, loaded) = (drawn.joints()[last].inertia, loaded.joints()[last].inertia);
        assert!((drawn.mass - loaded.mass).abs() < 1e-12 && (drawn.com - loaded.com).norm() < 1e-12);
        assert!((drawn.tensor - loaded.tensor).norm() < 1e-12);
    }
}
