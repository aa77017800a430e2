//! An obstacle of a case: what its file says, and the body that it makes.

use bitgrain_kernel::{FreeMotion, Motion, Obstacle, Orientation};
use bitgrain_sim::body::{body_mass, orientation};
use bitgrain_sim::mesh::{Triangle, add_mesh, check_triangles};
use bitgrain_sim::owned_world::OwnedWorld;
use serde::{Deserialize, Serialize};

use super::numbers::{direction as is_direction, finite, positive};

/// What an obstacle is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum BodyShape {
    /// A wall through `point`; grains live where `normal` points.
    Plane,
    /// A ball: `center`, `diameter`.
    Sphere,
    /// A bar: `center`, `axis`, `diameter`, and `length`; endless without it.
    Cylinder,
    /// A bar with half balls as ends: `center`, `axis`, `diameter`, `half_length` between centre and half ball.
    Capsule,
    /// A box: `center`, and `half` of its edges.
    Box,
    /// The inside of a cylinder with ends, in which grains live: `center`, `axis`, `diameter`, `length`.
    Drum,
    /// Triangles that grains touch on both sides: `triangles` or `file`, and `center`.
    Mesh,
}

/// What moves an obstacle.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case", deny_unknown_fields)]
pub enum BodyMotion {
    /// Its velocity and angular velocity stay as they are.
    #[default]
    Prescribed,
    /// The forces on it and gravity.
    Free,
    /// Forces and gravity along some axes; along the others its velocity stays.
    Partly {
        /// Along which axes it answers forces.
        along: [bool; 3],
        /// Whether it answers torques.
        #[serde(default)]
        turns: bool,
    },
}

/// An obstacle as the file of a case spells it. Which keys a shape has is said there.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ObstacleSpec {
    /// What it is.
    pub shape: BodyShape,
    /// A point of a plane.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub point: Option<[f64; 3]>,
    /// Direction out of a plane, of any length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub normal: Option<[f64; 3]>,
    /// Centre; of one that moves freely its centre of mass.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub center: Option<[f64; 3]>,
    /// Direction of the axis in the body's own axes, of any length.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub axis: Option<[f64; 3]>,
    /// Diameter; of a drum the inner one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub diameter: Option<f64>,
    /// Length of a bar or, inside, of a drum.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub length: Option<f64>,
    /// Half of the distance between the half balls of a capsule.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half_length: Option<f64>,
    /// Half of the edges of a box.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub half: Option<[f64; 3]>,
    /// The corners of a mesh from its centre, nine numbers for each triangle.
    #[serde(
        default,
        with = "rows_of_nine",
        skip_serializing_if = "Option::is_none"
    )]
    pub triangles: Option<Vec<Triangle>>,
    /// Or an STL file of them, from the folder of the case; [`read`](super::read) puts its triangles here.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub file: Option<String>,
    /// Mass density: its own mass enters its contacts, and it may move freely. Without one, and without a mass, it is
    /// infinitely heavy; null does not leave it out.
    #[serde(
        default,
        deserialize_with = "number",
        skip_serializing_if = "Option::is_none"
    )]
    pub density: Option<f64>,
    /// Mass, instead of a density.
    #[serde(
        default,
        deserialize_with = "number",
        skip_serializing_if = "Option::is_none"
    )]
    pub mass: Option<f64>,
    /// Principal moments of inertia, about the own axes; with a mass only, and those of the shape if it is left out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub inertia: Option<[f64; 3]>,
    /// Unit quaternion (w, x, y, z) that turns it from its own axes to those of the world.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub orientation: Option<[f64; 4]>,
    /// Velocity.
    #[serde(default)]
    pub velocity: [f64; 3],
    /// Angular velocity in the axes of the world.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angular_velocity: Option<[f64; 3]>,
    /// What moves it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub motion: Option<BodyMotion>,
    /// A constant force on the centre of one that moves freely, besides its weight.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub applied_force: Option<[f64; 3]>,
    /// A constant torque on it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub applied_torque: Option<[f64; 3]>,
    /// Whether the curvature of a surface that is no ball's counts in the effective radius.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub curved: bool,
    /// Name of its material, if the law has several.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
}

fn number<'de, D: serde::Deserializer<'de>>(from: D) -> Result<Option<f64>, D::Error> {
    f64::deserialize(from).map(Some)
}

impl ObstacleSpec {
    /// An obstacle at rest of which only the shape is said.
    fn new(shape: BodyShape) -> Self {
        Self {
            shape,
            point: None,
            normal: None,
            center: None,
            axis: None,
            diameter: None,
            length: None,
            half_length: None,
            half: None,
            triangles: None,
            file: None,
            density: None,
            mass: None,
            inertia: None,
            orientation: None,
            velocity: [0.0; 3],
            angular_velocity: None,
            motion: None,
            applied_force: None,
            applied_torque: None,
            curved: false,
            material: None,
        }
    }

    /// An infinitely heavy mesh at rest, of these triangles about the origin.
    #[must_use]
    pub fn mesh(triangles: Vec<Triangle>) -> Self {
        Self {
            triangles: Some(triangles),
            ..Self::new(BodyShape::Mesh)
        }
    }

    /// A wall at rest.
    #[must_use]
    pub fn plane(point: [f64; 3], normal: [f64; 3]) -> Self {
        Self {
            point: Some(point),
            normal: Some(normal),
            ..Self::new(BodyShape::Plane)
        }
    }

    /// An infinitely heavy ball at rest.
    #[must_use]
    pub fn sphere(center: [f64; 3], diameter: f64) -> Self {
        Self {
            center: Some(center),
            diameter: Some(diameter),
            ..Self::new(BodyShape::Sphere)
        }
    }

    /// An infinitely heavy endless bar at rest.
    #[must_use]
    pub fn cylinder(center: [f64; 3], axis: [f64; 3], diameter: f64) -> Self {
        Self {
            center: Some(center),
            axis: Some(axis),
            diameter: Some(diameter),
            ..Self::new(BodyShape::Cylinder)
        }
    }

    /// The body, in a world with this gravity; or the key that is wrong and what is wrong with it.
    /// A mesh adds its triangles to the world.
    pub(super) fn build(
        &self,
        gravity: [f64; 3],
        world: &mut OwnedWorld<f64>,
    ) -> Result<Obstacle<f64>, (String, String)> {
        let body = self.shaped(world)?;
        let body = Obstacle {
            velocity: self.velocity,
            angular_velocity: self.angular_velocity.unwrap_or([0.0; 3]),
            orientation: self.turned()?,
            curved: self.curved,
            ..body
        };
        let Some(mass) = self.weighed(&body)? else {
            return self.prescribed(body);
        };
        let body = Obstacle {
            inverse_mass: 1.0 / mass,
            ..body
        };
        let (integrates, spins) = match self.motion.unwrap_or_default() {
            BodyMotion::Prescribed => return self.prescribed(body),
            BodyMotion::Free => ([true; 3], true),
            BodyMotion::Partly { along, turns } => (along, turns),
        };
        for moment in self.inertia.into_iter().flatten() {
            size("inertia", Some(moment))?;
        }
        // Of a body that does not turn it says nothing.
        let any = (!spins).then_some([1.0; 3]);
        let Some(inertia) = self.inertia.or(body.own_inertia()).or(any) else {
            let problem = "is left out, and the shape lies askew to its own axes or has none; give the principal \
                           moments, or an axis along x, y or z and an orientation";
            return Err(("inertia".into(), problem.into()));
        };
        Ok(Obstacle {
            motion: Motion::Free(FreeMotion {
                force: self.applied_force.unwrap_or([0.0; 3]),
                torque: self.applied_torque.unwrap_or([0.0; 3]),
                integrates,
                spins,
                ..FreeMotion::new(inertia, gravity)
            }),
            ..body
        })
    }

    /// A body that only its host moves.
    fn prescribed(&self, body: Obstacle<f64>) -> Result<Obstacle<f64>, (String, String)> {
        if self.motion.unwrap_or_default() != BodyMotion::Prescribed {
            let problem = "says that forces move it, so it needs a `density`, or a `mass`";
            return Err(("motion".into(), problem.into()));
        }
        for (key, is_there) in [
            ("applied_force", self.applied_force.is_some()),
            ("applied_torque", self.applied_torque.is_some()),
            ("inertia", self.inertia.is_some()),
        ] {
            if is_there {
                let problem =
                    "does nothing to a body that no force moves; add \"motion\": \"free\"";
                return Err((key.into(), problem.into()));
            }
        }
        Ok(body)
    }

    /// The body's shape and place, at rest and infinitely heavy.
    fn shaped(&self, world: &mut OwnedWorld<f64>) -> Result<Obstacle<f64>, (String, String)> {
        let allowed: &[&str] = match self.shape {
            BodyShape::Plane => &["point", "normal"],
            BodyShape::Sphere => &["center", "diameter"],
            BodyShape::Cylinder => &["center", "axis", "diameter", "length"],
            BodyShape::Capsule => &["center", "axis", "diameter", "half_length"],
            BodyShape::Box => &["center", "half"],
            BodyShape::Drum => &["center", "axis", "diameter", "length"],
            BodyShape::Mesh => &["center", "triangles", "file"],
        };
        let given = [
            ("point", self.point.is_some()),
            ("normal", self.normal.is_some()),
            ("center", self.center.is_some()),
            ("axis", self.axis.is_some()),
            ("diameter", self.diameter.is_some()),
            ("length", self.length.is_some()),
            ("half_length", self.half_length.is_some()),
            ("half", self.half.is_some()),
            ("triangles", self.triangles.is_some()),
            ("file", self.file.is_some()),
        ];
        for (key, is_given) in given {
            if is_given && !allowed.contains(&key) {
                let has = allowed.join("`, `");
                let problem = format!("is no key of this shape, which has `{has}`");
                return Err((key.into(), problem));
            }
        }
        let (center, axis) = (self.center, self.axis);
        Ok(match self.shape {
            BodyShape::Plane => {
                let (point, normal) = (need("point", self.point)?, need("normal", self.normal)?);
                Obstacle::plane(vector("point", point)?, direction("normal", normal)?)
            }
            BodyShape::Sphere => {
                let center = vector("center", need("center", center)?)?;
                Obstacle::sphere(center, 0.5 * size("diameter", self.diameter)?)
            }
            BodyShape::Cylinder | BodyShape::Capsule | BodyShape::Drum => {
                let center = vector("center", need("center", center)?)?;
                let axis = direction("axis", need("axis", axis)?)?;
                let radius = 0.5 * size("diameter", self.diameter)?;
                match self.shape {
                    BodyShape::Capsule => {
                        let half = size("half_length", self.half_length)?;
                        Obstacle::capsule(center, axis, radius, half)
                    }
                    BodyShape::Drum => {
                        let half = 0.5 * size("length", self.length)?;
                        Obstacle::drum(center, axis, radius, half)
                    }
                    _ if self.length.is_some() => {
                        let half = 0.5 * size("length", self.length)?;
                        Obstacle::finite_cylinder(center, axis, radius, half)
                    }
                    _ => Obstacle::cylinder(center, axis, radius),
                }
            }
            BodyShape::Box => {
                let center = vector("center", need("center", center)?)?;
                let half = need("half", self.half)?;
                for edge in half {
                    size("half", Some(edge))?;
                }
                Obstacle::cuboid(center, half)
            }
            BodyShape::Mesh => {
                let center = vector("center", center.unwrap_or([0.0; 3]))?;
                let triangles = need("triangles", self.triangles.as_deref())?;
                check_triangles(triangles).map_err(|problem| ("triangles".into(), problem))?;
                add_mesh(world, center, triangles)
            }
        })
    }

    /// The orientation.
    fn turned(&self) -> Result<Orientation<f64>, (String, String)> {
        let upright = [1.0, 0.0, 0.0, 0.0];
        let turned = self.orientation.map_or(Ok(upright), orientation);
        turned.map_err(|problem| ("orientation".into(), problem))
    }

    /// Mass of this body, if it has one.
    fn weighed(&self, body: &Obstacle<f64>) -> Result<Option<f64>, (String, String)> {
        let wrong = |key: &str, problem: &str| Err((key.to_string(), problem.to_string()));
        match (self.density, self.mass) {
            (None, None) => Ok(None),
            (Some(_), Some(_)) => {
                wrong("mass", "is given beside `density`; one of the two says all")
            }
            (None, mass) => size("mass", mass).map(Some),
            (density, None) => match body_mass(&body.shape, size("density", density)?) {
                None => wrong(
                    "density",
                    "is given for a shape without a volume; leave it out or give a `mass`",
                ),
                mass => Ok(mass),
            },
        }
    }
}

/// Triangles as rows of nine numbers.
mod rows_of_nine {
    use super::Triangle;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    pub fn serialize<S: Serializer>(all: &Option<Vec<Triangle>>, to: S) -> Result<S::Ok, S::Error> {
        let rows = all.iter().flatten().map(|triangle| triangle.as_flattened());
        rows.collect::<Vec<_>>().serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(
        from: D,
    ) -> Result<Option<Vec<Triangle>>, D::Error> {
        let rows = Vec::<[f64; 9]>::deserialize(from)?;
        let corners = rows.as_flattened().as_chunks::<3>().0;
        Ok(Some(corners.as_chunks::<3>().0.to_vec()))
    }
}

fn need<T>(key: &str, value: Option<T>) -> Result<T, (String, String)> {
    value.ok_or_else(|| (key.into(), "is missing".into()))
}

fn size(key: &str, value: Option<f64>) -> Result<f64, (String, String)> {
    let value = need(key, value)?;
    positive(key, value)?;
    Ok(value)
}

fn vector(key: &str, value: [f64; 3]) -> Result<[f64; 3], (String, String)> {
    finite(key, &value)?;
    Ok(value)
}

fn direction(key: &str, value: [f64; 3]) -> Result<[f64; 3], (String, String)> {
    is_direction(key, &value)?;
    Ok(value)
}
