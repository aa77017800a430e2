//! What hosts say of rigid bodies, made into what the kernel takes.

use bitgrain_kernel::{Orientation, Shape};

use crate::grain::sphere_mass;

/// Mass of a body of this shape and density (mass / length^3); none of a shape without a volume. That of a ball is that
/// of a grain.
pub fn body_mass(shape: &Shape<f64>, density: f64) -> Option<f64> {
    match *shape {
        Shape::Sphere { radius } => Some(sphere_mass(2.0 * radius, density)),
        _ => shape.volume().map(|volume| density * volume),
    }
}

/// The orientation that four numbers (w, x, y, z) name, of length 1.
///
/// # Errors
/// What is wrong with numbers that name none.
pub fn orientation(numbers: [f64; 4]) -> Result<Orientation<f64>, String> {
    let length = numbers.iter().map(|x| x * x).sum::<f64>().sqrt();
    // Numbers that were written with seven digits still name a direction.
    match (length - 1.0).abs() < 1e-6 {
        true => Ok(numbers.map(|x| x / length)),
        false => Err(format!(
            "has length {length}; expected a unit quaternion [w, x, y, z]"
        )),
    }
}
