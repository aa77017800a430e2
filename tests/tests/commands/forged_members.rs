//! Members of a campaign with files that nobody computed, held against a table.

use crate::FURNISHED;
use crate::forged::{remake_manifest, remake_member};

/// `sweep --against` confirms no member with a summary that its drags do not give, and none with files that its call,
/// which did all of it, did not write.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_campaign_held_against_a_table_is_all_of_it() {
    let room = FURNISHED.copy();
    let (member, own) = ("mu0.3", "camp/members/mu0.3");
    std::fs::copy(room.path("camp/results.csv"), room.path("golden.csv")).unwrap();
    let summary = String::from_utf8(room.read(&format!("{own}/summary.json"))).unwrap();
    let forged = summary.replacen("\"mean\": ", "\"mean\": 9", 1);
    assert_ne!(summary, forged);
    room.write(&format!("{own}/summary.json"), forged);
    remake_member(&room, member, &[]);
    let command = "sweep weecamp.toml --out camp --against golden.csv --beds none";
    let told = room.says(command, 3);
    assert!(told.contains("not what the checkpoints give"), "{told}");

    let room = FURNISHED.copy();
    std::fs::copy(room.path("camp/results.csv"), room.path("golden.csv")).unwrap();
    let steps = bitgrain::disk::list(&room.path(&format!("{own}/runs/run-1/checkpoints"))).unwrap();
    let step = steps[0].0.split('.').next().unwrap();
    let frames = format!("runs/run-1/frames/{step}.csv");
    for kind in ["beds", "runs"] {
        std::fs::remove_dir_all(room.path(&format!("{own}/{kind}"))).unwrap();
    }
    remake_member(&room, member, &[&frames]);
    room.done(command);
    assert!(!room.path(&format!("{own}/{frames}")).exists());
    room.done("verify camp");
}

/// What lies beside a bed is held against its state in every member, whichever poured the bed.
#[test]
#[cfg_attr(debug_assertions, ignore = "pours small beds: seconds in release")]
fn a_twin_of_a_bed_is_looked_at() {
    let room = FURNISHED.copy();
    let two = "name = \"two\"\nbase = \"wee.toml\"\n[[grid]]\nname = \"a\"\nspeed = [0.6]\n[[grid]]\nname = \"b\"\n\
               set = { \"measure.every\" = 10 }\nspeed = [0.6]\n";
    room.write("two.toml", two);
    room.done("sweep two.toml --out camp2");
    let data = "camp2/members/b/beds/bed.data";
    let text = String::from_utf8(room.read(data)).unwrap();
    room.write(data, text.replacen("0.9", "0.8", 1));
    remake_manifest(&room.path("camp2/members/b"));
    room.done("sweep two.toml --out golden");
    let told = room.says("sweep two.toml --out camp2 --against golden/results.csv", 3);
    assert!(told.contains("bed.data is missing or not as"), "{told}");
}
