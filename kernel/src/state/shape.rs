//! Shapes of bodies: how large they are, and where a grain meets their surfaces. What they weigh is in `solid.rs`.

use crate::math::real::{Real, larger, magnitude, smaller};
use crate::math::vec3::{Vec3, dot, scale, sub};

/// The kind of a mesh in files.
pub(crate) const MESH: u32 = 7;

/// What an obstacle is, in its own axes and about its own point.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "serde", derive(serde::Serialize, serde::Deserialize))]
#[repr(u8)]
pub enum Shape<R> {
    /// A ball about the obstacle's point.
    Sphere {
        /// Radius (length), positive.
        radius: R,
    },
    /// An endless round bar through the obstacle's point. To a grain it counts as flat, with the
    /// grain's own radius as effective radius (Guillard 2014, appendix A).
    Cylinder {
        /// Unit vector along the bar.
        axis: Vec3<R>,
        /// Radius (length), positive.
        radius: R,
    },
    /// A flat wall through the obstacle's point; grains live on the side its normal points to.
    Plane {
        /// Unit vector out of the wall.
        normal: Vec3<R>,
    },
    /// A round bar with two flat ends, about the obstacle's point.
    FiniteCylinder {
        /// Unit vector along the bar.
        axis: Vec3<R>,
        /// Radius (length), positive.
        radius: R,
        /// Half of its length (length), positive.
        half_length: R,
    },
    /// A round bar with two half balls as ends, about the obstacle's point.
    Capsule {
        /// Unit vector along the bar.
        axis: Vec3<R>,
        /// Radius (length), positive.
        radius: R,
        /// Half of the distance between the centres of the half balls (length), positive.
        half_length: R,
    },
    /// A box about the obstacle's point, with its edges along the own axes.
    Box {
        /// Half of its edges (length), positive.
        half: Vec3<R>,
    },
    /// The inside of a round tank with two flat ends, about the obstacle's point: grains live in it. It has three
    /// surfaces, and a grain in a corner touches two of them.
    Drum {
        /// Unit vector along the tank.
        axis: Vec3<R>,
        /// Inner radius (length), positive.
        radius: R,
        /// Half of its inner length (length), positive.
        half_length: R,
    },
    /// A surface of triangles about the obstacle's point: some of those that the world has. It has as many surfaces as
    /// triangles, and a grain may touch several of them. [`Obstacle::mesh`](crate::Obstacle::mesh) makes one.
    Mesh {
        /// Number of its first triangle among those of the world.
        first: u32,
        /// How many it has, at most [`FACETS_MAX`](crate::FACETS_MAX).
        count: u32,
        /// Distance of its farthest corner from the point (length).
        reach: R,
        /// What tells its triangles from others: the first half of their hash.
        name: u64,
    },
}

/// The nearest place of a surface, in the axes in which the offset of a grain was given.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Nearest<R> {
    /// Unit vector from the surface to the grain's centre.
    pub normal: Vec3<R>,
    /// Depth of the overlap.
    pub overlap: R,
    /// Radius of curvature of the surface, twice that of a bar, negative if it is hollow; 0 where it is flat.
    pub curvature: R,
}

impl<R: Real> Shape<R> {
    /// Its kind as files have it, its direction and its sizes, zeros for what it has not; of a mesh see
    /// [`Shape::table`].
    pub(crate) fn written(&self) -> (u32, Vec3<R>, Vec3<R>) {
        let zero = R::ZERO;
        match *self {
            Self::Sphere { radius } => (0, [zero; 3], [radius, zero, zero]),
            Self::Cylinder { axis, radius } => (1, axis, [radius, zero, zero]),
            Self::Plane { normal } => (2, normal, [zero; 3]),
            Self::FiniteCylinder {
                axis,
                radius,
                half_length,
            } => (3, axis, [radius, half_length, zero]),
            Self::Capsule {
                axis,
                radius,
                half_length,
            } => (4, axis, [radius, half_length, zero]),
            Self::Box { half } => (5, [zero; 3], half),
            Self::Drum {
                axis,
                radius,
                half_length,
            } => (6, axis, [radius, half_length, zero]),
            Self::Mesh { reach, .. } => (MESH, [zero; 3], [reach, zero, zero]),
        }
    }

    /// Of a mesh: first triangle, number of triangles, and both halves of the name; zeros else.
    pub(crate) fn table(&self) -> [u32; 4] {
        match *self {
            Self::Mesh {
                first, count, name, ..
            } => [first, count, name as u32, (name >> 32) as u32],
            _ => [0; 4],
        }
    }

    /// The shape that was written so; a kind that there is none of is a plane.
    pub(crate) fn read(kind: u32, axis: Vec3<R>, sizes: Vec3<R>, table: [u32; 4]) -> Self {
        let [radius, half_length, _] = sizes;
        match kind {
            0 => Self::Sphere { radius },
            1 => Self::Cylinder { axis, radius },
            3 => Self::FiniteCylinder {
                axis,
                radius,
                half_length,
            },
            4 => Self::Capsule {
                axis,
                radius,
                half_length,
            },
            5 => Self::Box { half: sizes },
            6 => Self::Drum {
                axis,
                radius,
                half_length,
            },
            MESH => {
                let [first, count, low, high] = table;
                Self::Mesh {
                    first,
                    count,
                    reach: radius,
                    name: u64::from(low) | u64::from(high) << 32,
                }
            }
            _ => Self::Plane { normal: axis },
        }
    }

    /// How many surfaces it has, of which a grain may touch several.
    #[must_use]
    pub fn surfaces(&self) -> u32 {
        match self {
            Self::Drum { .. } => 3,
            Self::Mesh { count, .. } => *count,
            _ => 1,
        }
    }

    /// The direction that it is given by; zero if it has none.
    pub(crate) fn direction(&self) -> Vec3<R> {
        match *self {
            Self::Sphere { .. } | Self::Box { .. } | Self::Mesh { .. } => [R::ZERO; 3],
            Self::Cylinder { axis, .. }
            | Self::FiniteCylinder { axis, .. }
            | Self::Capsule { axis, .. }
            | Self::Drum { axis, .. } => axis,
            Self::Plane { normal } => normal,
        }
    }

    /// Whether it has no end, so that it can turn about its own direction only.
    pub(crate) fn is_endless(&self) -> bool {
        matches!(self, Self::Cylinder { .. } | Self::Plane { .. })
    }

    /// How far from its point (or the axis of an endless bar) the surface reaches (length).
    #[must_use]
    pub fn reach(&self) -> R {
        match *self {
            Self::Sphere { radius } | Self::Cylinder { radius, .. } => radius,
            Self::Plane { .. } => R::ZERO,
            Self::Mesh { reach, .. } => reach,
            Self::FiniteCylinder {
                radius,
                half_length,
                ..
            }
            | Self::Drum {
                radius,
                half_length,
                ..
            } => radius + half_length,
            Self::Capsule {
                radius,
                half_length,
                ..
            } => radius + half_length,
            Self::Box { half } => (half[0] + half[1]) + half[2],
        }
    }

    /// Half of its thinnest place (length); 0 if it has no thickness.
    pub(crate) fn thinnest(&self) -> R {
        match *self {
            Self::Sphere { radius }
            | Self::Cylinder { radius, .. }
            | Self::Capsule { radius, .. } => radius,
            Self::Plane { .. } | Self::Drum { .. } | Self::Mesh { .. } => R::ZERO,
            Self::FiniteCylinder {
                radius,
                half_length,
                ..
            } => smaller(radius, half_length),
            Self::Box { half } => smaller(smaller(half[0], half[1]), half[2]),
        }
    }

    /// Whether its sizes are positive and finite, and its direction is of length 1.
    pub(crate) fn is_sound(&self) -> bool {
        let sized = |x: R| x > R::ZERO && x.is_finite();
        let sized = match *self {
            Self::Sphere { radius } | Self::Cylinder { radius, .. } => sized(radius),
            Self::Plane { .. } => true,
            Self::Mesh { reach, .. } => sized(reach),
            Self::FiniteCylinder {
                radius,
                half_length,
                ..
            }
            | Self::Capsule {
                radius,
                half_length,
                ..
            }
            | Self::Drum {
                radius,
                half_length,
                ..
            } => sized(radius) && sized(half_length),
            Self::Box { half } => half.iter().all(|x| sized(*x)),
        };
        let direction = self.direction();
        let off = dot(direction, direction) - R::ONE;
        let has_none = matches!(
            self,
            Self::Sphere { .. } | Self::Box { .. } | Self::Mesh { .. }
        );
        sized && direction.iter().all(|x| x.is_finite()) && (has_none || off * off < R::EPSILON)
    }

    /// Where a grain of this radius meets one of its surfaces, by the offset of its centre from the shape's point in
    /// the shape's own axes.
    ///
    /// The normal is the vector from the nearest point divided by its length, component by component.
    #[inline(always)]
    pub(crate) fn meet(&self, surface: u32, offset: Vec3<R>, radius: R) -> Nearest<R> {
        match *self {
            Self::Sphere { radius: own } => {
                let distance = dot(offset, offset).sqrt();
                Nearest {
                    normal: divide(offset, distance),
                    overlap: (radius + own) - distance,
                    curvature: own,
                }
            }
            Self::Cylinder { axis, radius: own } => {
                let across = sub(offset, scale(axis, dot(offset, axis)));
                let distance = dot(across, across).sqrt();
                Nearest {
                    normal: divide(across, distance),
                    overlap: (radius + own) - distance,
                    curvature: own + own,
                }
            }
            Self::Plane { normal } => Nearest {
                normal,
                overlap: radius - dot(offset, normal),
                curvature: R::ZERO,
            },
            _ => self.meet_bounded(surface, offset, radius),
        }
    }

    /// The same of a shape that has ends: one copy of it, for small machines.
    #[inline(never)]
    fn meet_bounded(&self, surface: u32, offset: Vec3<R>, radius: R) -> Nearest<R> {
        match *self {
            Self::FiniteCylinder {
                axis,
                radius: own,
                half_length,
            } => meet_bar(axis, own, half_length, offset, radius),
            Self::Capsule {
                axis,
                radius: own,
                half_length,
            } => {
                let along = dot(offset, axis);
                let nearest = held(along, half_length);
                let apart = sub(offset, scale(axis, nearest));
                let distance = dot(apart, apart).sqrt();
                let on_side = nearest == along;
                Nearest {
                    normal: divide(apart, distance),
                    overlap: (radius + own) - distance,
                    curvature: if on_side { own + own } else { own },
                }
            }
            Self::Box { half } => meet_box(half, offset, radius),
            Self::Drum {
                axis,
                radius: own,
                half_length,
            } => {
                let along = dot(offset, axis);
                if surface == 0 {
                    let across = sub(offset, scale(axis, along));
                    let distance = dot(across, across).sqrt();
                    return Nearest {
                        normal: divide(scale(across, -R::ONE), distance),
                        overlap: (distance + radius) - own,
                        curvature: -(own + own),
                    };
                }
                let side = if surface == 1 { R::ONE } else { -R::ONE };
                Nearest {
                    normal: scale(axis, side),
                    overlap: radius - (half_length + along * side),
                    curvature: R::ZERO,
                }
            }
            // The first three are met above, a mesh in `mesh.rs`.
            Self::Sphere { .. }
            | Self::Cylinder { .. }
            | Self::Plane { .. }
            | Self::Mesh { .. } => Nearest {
                normal: [R::ZERO; 3],
                overlap: -R::MAX,
                curvature: R::ZERO,
            },
        }
    }
}

/// The number brought between `-most` and `most`.
#[inline(always)]
fn held<R: Real>(x: R, most: R) -> R {
    larger(smaller(x, most), -most)
}

/// The meeting at the side, an end or a rim of a finite bar; of a centre within it, at the nearest of side and end.
#[inline]
fn meet_bar<R: Real>(
    axis: Vec3<R>,
    own: R,
    half_length: R,
    offset: Vec3<R>,
    radius: R,
) -> Nearest<R> {
    let along = dot(offset, axis);
    let across = sub(offset, scale(axis, along));
    let distance = dot(across, across).sqrt();
    let (beside, beyond) = (distance - own, magnitude(along) - half_length);
    if beside > R::ZERO && beyond > R::ZERO {
        let from_axis = scale(across, beside / distance);
        let apart = sub(
            sub(offset, scale(axis, held(along, half_length))),
            sub(across, from_axis),
        );
        let gap = dot(apart, apart).sqrt();
        return Nearest {
            normal: divide(apart, gap),
            overlap: radius - gap,
            curvature: own + own,
        };
    }
    if beyond > beside {
        let out = if along < R::ZERO { -R::ONE } else { R::ONE };
        return Nearest {
            normal: scale(axis, out),
            overlap: radius - beyond,
            curvature: R::ZERO,
        };
    }
    Nearest {
        normal: divide(across, distance),
        overlap: (radius + own) - distance,
        curvature: own + own,
    }
}

/// The meeting at a face, an edge or a corner of a box; of a centre within it, at the nearest face.
#[inline]
fn meet_box<R: Real>(half: Vec3<R>, offset: Vec3<R>, radius: R) -> Nearest<R> {
    let mut apart = [R::ZERO; 3];
    for a in 0..3 {
        apart[a] = offset[a] - held(offset[a], half[a]);
    }
    let gap = dot(apart, apart).sqrt();
    if gap > R::ZERO {
        return Nearest {
            normal: divide(apart, gap),
            overlap: radius - gap,
            curvature: R::ZERO,
        };
    }
    // The first of the least depths, without an index that could be any number.
    let [x, y, z] = offset;
    let depths = [
        half[0] - magnitude(x),
        half[1] - magnitude(y),
        half[2] - magnitude(z),
    ];
    let out = |x: R| if x < R::ZERO { -R::ONE } else { R::ONE };
    let (mut least, mut normal) = (depths[0], [out(x), R::ZERO, R::ZERO]);
    if depths[1] < least {
        (least, normal) = (depths[1], [R::ZERO, out(y), R::ZERO]);
    }
    if depths[2] < least {
        (least, normal) = (depths[2], [R::ZERO, R::ZERO, out(z)]);
    }
    Nearest {
        normal,
        overlap: radius + least,
        curvature: R::ZERO,
    }
}

#[inline(always)]
pub(crate) fn divide<R: Real>(v: Vec3<R>, s: R) -> Vec3<R> {
    [v[0] / s, v[1] / s, v[2] / s]
}
