//! Files of fields: VTK image data for ParaView, tables for everything else.
//!
//! Numbers are single precision, some 1e-7 of them: means over a window are not known better.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

use super::load::{Load, theta};
use super::plane::{Fields, Flag, inertial_number};
use crate::files::bits;
use crate::table::{Cell, Table, Word, column};
use crate::units::Units;

/// A point of a plane, as a row of a table: unknown fields are empty.
#[derive(Clone, Copy, Debug, Default)]
pub struct PlaneRow {
    /// Along x from the intruder's centre, and height above the floor.
    pub place: [Option<f64>; 2],
    /// What is known there.
    pub flag: Flag,
    /// Packing fraction.
    pub packing_fraction: Option<f64>,
    /// Velocity in the intruder's frame.
    pub velocity: [Option<f64>; 3],
    /// Along x, in the frame of the far grains.
    pub far_velocity_x: Option<f64>,
    /// Stress, compression positive.
    pub stress: [[Option<f64>; 3]; 3],
    /// Pressure.
    pub pressure: Option<f64>,
    /// Shear stress.
    pub shear_stress: Option<f64>,
    /// Shear rate.
    pub shear_rate: Option<f64>,
    /// Inertial number.
    pub inertial_number: Option<f64>,
}

/// Fields on a plane.
pub const PLANE: Table<PlaneRow> = Table(&[
    column("x", |r| Cell::Single(&mut r.place[0])),
    column("z", |r| Cell::Single(&mut r.place[1])),
    column("flag", |r| Cell::Word(&mut r.flag)),
    column("packing_fraction", |r| {
        Cell::Single(&mut r.packing_fraction)
    }),
    column("velocity_x", |r| Cell::Single(&mut r.velocity[0])),
    column("velocity_y", |r| Cell::Single(&mut r.velocity[1])),
    column("velocity_z", |r| Cell::Single(&mut r.velocity[2])),
    column("far_velocity_x", |r| Cell::Single(&mut r.far_velocity_x)),
    column("stress_xx", |r| Cell::Single(&mut r.stress[0][0])),
    column("stress_xy", |r| Cell::Single(&mut r.stress[0][1])),
    column("stress_xz", |r| Cell::Single(&mut r.stress[0][2])),
    column("stress_yx", |r| Cell::Single(&mut r.stress[1][0])),
    column("stress_yy", |r| Cell::Single(&mut r.stress[1][1])),
    column("stress_yz", |r| Cell::Single(&mut r.stress[1][2])),
    column("stress_zx", |r| Cell::Single(&mut r.stress[2][0])),
    column("stress_zy", |r| Cell::Single(&mut r.stress[2][1])),
    column("stress_zz", |r| Cell::Single(&mut r.stress[2][2])),
    column("pressure", |r| Cell::Single(&mut r.pressure)),
    column("shear_stress", |r| Cell::Single(&mut r.shear_stress)),
    column("shear_rate", |r| Cell::Single(&mut r.shear_rate)),
    column("inertial_number", |r| Cell::Single(&mut r.inertial_number)),
]);

impl Word for Flag {
    fn word(&self) -> &'static str {
        ["0", "1", "2"][usize::from(self.number())]
    }

    fn take(&mut self, word: &str) -> Option<()> {
        *self = Flag::of(word.parse().ok()?)?;
        Some(())
    }
}

/// Mean stresses on a cylinder at an angle, with the errors of the means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoadRow {
    /// Angle from the front (radians).
    pub theta: f64,
    /// Normal stress, compression positive.
    pub normal: f64,
    /// Its standard error.
    pub normal_error: f64,
    /// Tangential stress, along growing theta.
    pub tangential: f64,
    /// Its standard error.
    pub tangential_error: f64,
}

/// The load round a cylinder.
pub const LOAD: Table<LoadRow> = Table(&[
    column("theta", |r| Cell::Real(&mut r.theta)),
    column("normal_stress", |r| Cell::Real(&mut r.normal)),
    column("normal_stress_error", |r| Cell::Real(&mut r.normal_error)),
    column("tangential_stress", |r| Cell::Real(&mut r.tangential)),
    column("tangential_stress_error", |r| {
        Cell::Real(&mut r.tangential_error)
    }),
]);

/// What fields are written with.
#[derive(Clone, Copy, Debug)]
pub struct Scales<'a> {
    /// Names of the units.
    pub units: &'a Units,
    /// Mean diameter of the grains.
    pub diameter: f64,
    /// Their mass density.
    pub density: f64,
    /// Velocity along x of the far grains, as asked for, in the intruder's frame.
    pub far: f64,
}

/// ParaView's mark of a point that has no value.
const HIDDEN: u8 = 2;

/// The value stored there: the one that NetCDF takes for none, which no reader takes for data.
const FILL: f64 = 9.969_209_968_386_869e36;

/// VTK image data (XML, little-endian): packing fraction, velocity in the intruder's frame and in that of the
/// far grains, stress, pressure and shear stress at every point, and what is known there; places are measured from the
/// intruder's centre, heights from the floor.
///
/// Points without data are marked as VTK marks them, by `vtkGhostType` 2, and ParaView leaves them blank.
pub fn vti(fields: &Fields, scales: Scales) -> String {
    let [nx, ny, nz] = fields.grid.counts;
    let extent = format!("0 {} 0 {} 0 {}", nx - 1, ny - 1, nz - 1);
    let three = |v: [f64; 3]| format!("{:?} {:?} {:?}", v[0], v[1], v[2]);
    let origin = [0, 1, 2].map(|a| fields.grid.at(a, 0));
    let known = || fields.points.iter().zip(&fields.flags);
    let reals = |of: &dyn Fn(&super::FieldPoint) -> Vec<f64>| -> Vec<u8> {
        let each = known().flat_map(|(point, flag)| {
            let values = of(point);
            match flag {
                Flag::Empty => vec![FILL; values.len()],
                _ => values,
            }
        });
        each.flat_map(|x| (x as f32).to_le_bytes()).collect()
    };
    let far = |v: [f64; 3]| vec![v[0] - scales.far, v[1], v[2]];
    let hidden = |flag: &Flag| u8::from(*flag == Flag::Empty) * HIDDEN;
    let ghosts: Vec<u8> = fields.flags.iter().map(hidden).collect();
    let flags: Vec<u8> = fields.flags.iter().map(|flag| flag.number()).collect();
    let arrays = [
        array("vtkGhostType", "UInt8", 1, &ghosts),
        array("flag", "UInt8", 1, &flags),
        array(
            "packing_fraction",
            "Float32",
            1,
            &reals(&|p| vec![p.packing_fraction]),
        ),
        array("velocity", "Float32", 3, &reals(&|p| p.velocity.to_vec())),
        array(
            "velocity_from_far_grains",
            "Float32",
            3,
            &reals(&|p| far(p.velocity)),
        ),
        array(
            "stress",
            "Float32",
            9,
            &reals(&|p| p.stress.as_flattened().to_vec()),
        ),
        array("pressure", "Float32", 1, &reals(&|p| vec![p.pressure()])),
        array(
            "shear_stress",
            "Float32",
            1,
            &reals(&|p| vec![p.shear_stress()]),
        ),
    ];
    format!(
        "<?xml version=\"1.0\"?>\n<!-- lengths in {}, velocities in {}, stresses in {} over length^2; {} -->\n\
         <!-- from the intruder's centre, z from the floor; velocity in the intruder's frame; compression is \
         positive; what is marked by vtkGhostType 2 (or flag 2) holds no data, and the number {FILL:?} -->\n\
         <VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\">\n\
         <ImageData WholeExtent=\"{extent}\" Origin=\"{}\" Spacing=\"{}\">\n<Piece Extent=\"{extent}\">\n\
         <PointData Scalars=\"pressure\" Vectors=\"velocity\" Tensors=\"stress\">\n{}</PointData>\n</Piece>\n\
         </ImageData>\n</VTKFile>\n",
        scales.units.length,
        scales.units.speed,
        scales.units.force,
        bits(),
        three(origin),
        three(fields.grid.step()),
        arrays.concat()
    )
}

/// An array as VTK has it: its length in bytes and the bytes, in base64.
fn array(name: &str, kind: &str, components: usize, bytes: &[u8]) -> String {
    let mut whole = (bytes.len() as u64).to_le_bytes().to_vec();
    whole.extend(bytes);
    format!(
        "<DataArray type=\"{kind}\" Name=\"{name}\" NumberOfComponents=\"{components}\" format=\"binary\">\n{}\n\
         </DataArray>\n",
        STANDARD.encode(whole)
    )
}

/// The table of a plane: a line of units, the column names, a row for each point; a cell is empty if
/// nothing is known.
pub fn plane_text(fields: &Fields, scales: Scales) -> String {
    let comment = format!(
        "x from the intruder's centre, z from the floor, in {}; velocities in the intruder's frame, \
         far_velocity_x in that of the far grains, in {}; stresses in {} over length^2, compression positive; \
         flag 0 whole, 1 window cut by the intruder or the floor, 2 no data",
        scales.units.length, scales.units.speed, scales.units.force
    );
    let rates = fields.shear_rates();
    let nx = fields.grid.counts[0];
    let row = |(k, (point, &flag)): (usize, (&super::FieldPoint, &Flag))| {
        let place = [fields.grid.at(0, k % nx), fields.grid.at(2, k / nx)].map(Some);
        if flag == Flag::Empty {
            return PlaneRow {
                place,
                flag,
                ..PlaneRow::default()
            };
        }
        let number =
            |rate| inertial_number(rate, scales.diameter, scales.density, point.pressure());
        PlaneRow {
            place,
            flag,
            packing_fraction: Some(point.packing_fraction),
            velocity: point.velocity.map(Some),
            far_velocity_x: Some(point.velocity[0] - scales.far),
            stress: point.stress.map(|row| row.map(Some)),
            pressure: Some(point.pressure()),
            shear_stress: Some(point.shear_stress()),
            shear_rate: rates[k],
            inertial_number: rates[k].and_then(number),
        }
    };
    let points = fields.points.iter().zip(&fields.flags).enumerate();
    PLANE.text(&comment, &points.map(row).collect::<Vec<PlaneRow>>())
}

/// The table of a load: a line of units, the column names, a row for each angle.
pub fn load_text(load: &Load, units: &Units) -> String {
    let comment = format!(
        "theta in radians, 0 at the front, 0 to pi/2 in the bottom front quarter; stresses in {} over length^2, \
         normal ones positive in compression, tangential ones along growing theta",
        units.force
    );
    let row = |m: usize| LoadRow {
        theta: theta(m),
        normal: load.normal[m],
        normal_error: load.normal_error[m],
        tangential: load.tangential[m],
        tangential_error: load.tangential_error[m],
    };
    let rows: Vec<LoadRow> = (0..load.normal.len()).map(row).collect();
    LOAD.text(&comment, &rows)
}

#[cfg(test)]
mod tests {
    use super::super::grid::Grid;
    use super::super::{FieldPoint, read};
    use super::*;

    fn fields() -> Fields {
        let grid = Grid {
            counts: [3, 1, 2],
            size: [3.0, 1.0, 2.0],
        };
        let point = |k: usize| FieldPoint {
            packing_fraction: 0.5,
            velocity: [k as f64, 0.25, -0.5],
            stress: [
                [1.0, 0.0, 0.5],
                [0.0, 2.0, 0.0],
                [0.25, 0.0, 3.0 + k as f64],
            ],
        };
        let mut flags = vec![Flag::Whole; 6];
        (flags[1], flags[4]) = (Flag::Cut, Flag::Empty);
        Fields {
            grid,
            flags,
            points: (0..6).map(point).collect(),
        }
    }

    fn with_scales<T>(of: impl FnOnce(Scales) -> T) -> T {
        let units = crate::units::Units::reduced();
        of(Scales {
            units: &units,
            diameter: 1.0,
            density: 1.0,
            far: 2.0,
        })
    }

    /// What is written is read again, and unknown fields are empty.
    #[test]
    fn tables_are_read_again() {
        let text = with_scales(|scales| plane_text(&fields(), scales));
        let again = read::plane(&text, fields().grid).unwrap();
        assert_eq!(again.flags, fields().flags);
        for (k, (a, b)) in again.points.iter().zip(&fields().points).enumerate() {
            if again.flags[k] != Flag::Empty {
                assert_eq!(a, b);
            }
        }
        let columns = PLANE.head().split(',').count();
        for line in text.lines().skip(1) {
            assert_eq!(line.split(',').count(), columns, "{line}");
        }
        let empty = text.lines().nth(6).unwrap();
        assert_eq!(empty, "0,1.5,2,,,,,,,,,,,,,,,,,,");
        assert!(!text.contains("NaN") && !text.contains("inf"));
    }

    #[test]
    fn tables_that_are_none_are_refused_by_line() {
        let text = with_scales(|scales| plane_text(&fields(), scales));
        let grid = fields().grid;
        let lines: Vec<&str> = text.lines().collect();
        let with = |line: &str| {
            format!(
                "{}\n{}\n{line}\n{}\n",
                lines[0],
                lines[1],
                lines[3..].join("\n")
            )
        };
        for bad in [
            "1,2",
            &lines[2].replacen("0.5", "NaN", 1),
            &lines[2].replacen(",0,", ",3,", 1),
        ] {
            assert_ne!(bad, lines[2]);
            assert_eq!(read::plane(&with(bad), grid), Err(3), "{bad}");
        }
        let cut = lines[..lines.len() - 1].join("\n");
        assert_eq!(read::plane(&cut, grid), Err(8));
        assert_eq!(read::plane(&format!("{text}{}\n", lines[7]), grid), Err(9));
        let turned = Grid {
            counts: [2, 1, 3],
            ..grid
        };
        assert_eq!(read::plane(&text, turned), Err(3));
        // Lines that only some readers take for several.
        let joined = format!("{}\n{}\n{}\n", lines[0], lines[1], lines[2..].join("\r"));
        assert_eq!(read::plane(&joined, turned), Err(3));
    }

    /// The words that VTK needs, and bytes that are those of the numbers.
    #[test]
    fn images_hold_their_arrays() {
        let text = with_scales(|scales| vti(&fields(), scales));
        assert!(text.contains(
            "WholeExtent=\"0 2 0 0 0 1\" Origin=\"-1.0 0.0 0.5\" Spacing=\"1.0 1.0 1.0\""
        ));
        let bytes = |name: &str| {
            let (_, rest) = text.split_once(&format!("Name=\"{name}\"")).unwrap();
            let body = rest.lines().nth(1).unwrap();
            let all = STANDARD.decode(body).unwrap();
            let (length, bytes) = all.split_at(8);
            assert_eq!(
                u64::from_le_bytes(length.try_into().unwrap()),
                bytes.len() as u64
            );
            bytes.to_vec()
        };
        assert_eq!(bytes("vtkGhostType"), [0, 0, 0, 0, 2, 0]);
        assert_eq!(bytes("flag"), [0, 1, 0, 0, 2, 0]);
        let reals = |name: &str| -> Vec<f32> {
            let all = bytes(name);
            all.as_chunks::<4>()
                .0
                .iter()
                .map(|b| f32::from_le_bytes(*b))
                .collect()
        };
        assert_eq!(
            reals("velocity_from_far_grains")[..4],
            [-2.0, 0.25, -0.5, -1.0]
        );
        assert_eq!(reals("stress").len(), 54);
        assert_eq!(reals("pressure")[..3], [2.0, 7.0 / 3.0, 8.0 / 3.0]);
        // sqrt((1 + 0 + 1 + 2 (3/8)^2)/2) of a pressure of 2 and deviations of 1 and 3/8.
        assert!((reals("shear_stress")[0] - 1.0_f32.hypot(0.375)).abs() < 1e-6);
        // Where nothing is known no number stands that could be taken for data.
        for name in ["packing_fraction", "pressure", "shear_stress"] {
            let all = reals(name);
            assert!(
                all.iter().enumerate().all(|(k, x)| (*x > 1e36) == (k == 4)),
                "{all:?}"
            );
        }
        assert!(reals("stress")[36..45].iter().all(|x| *x > 1e36));
    }
}
