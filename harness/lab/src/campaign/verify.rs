//! Verification of a campaign: its manifest, those of its members, its members by execution, and its table from
//! what their manifests vouch for.

use super::columns::{Row, Status};
use super::folder::{CampaignFolder, Failure};
use super::found::which_bed;
use super::plan::{Member, Plan};
use super::{parquet, table, written};
use crate::folder::{FAILURE, Folder};
use crate::manifest::{FolderKind, Manifest, NAME, Vouched};
use crate::progress::Progress;
use crate::rerun::RunArchive;
use crate::run;
use crate::scenario::DragPlan;
use crate::summary::parse_record;
use crate::verify::{
    Cause, Job, Scope, beside_twin, check_expected, check_manifest, execute, pieces, sampled,
    summary_problem,
};
use bitgrain_sim::below::Below;
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};
use bitgrain_sim::files::read_text;

/// Verifies a campaign, and reports each finding as a line of `say`; `expect` as in
/// [`crate::verify::verify`].
///
/// # Errors
/// [`Error::Unverified`] if something does not hold or is not finished, after all was reported; [`Error::Input`]
/// if there is nothing to verify.
pub fn verify(
    folder: &CampaignFolder<'_>,
    scope: &Scope,
    expect: &[String],
    threads: usize,
    progress: &Progress,
    mut say: impl FnMut(&str) -> Result<()>,
) -> Result<()> {
    let place = folder.0.display().to_string();
    if !scope.segments.is_empty() {
        let problem = "is a campaign: --segment takes stages of a run, so give the folder of one of its members";
        return Err(Error::input(place, problem));
    }
    let path = folder.campaign();
    Below(folder.0).check_file(&path)?;
    let plan = written::parse(&read_text(&path)?, &path.display().to_string(), folder.0)?;
    let planned = CampaignFolder::planned(&plan);
    let (whole, mut problems) = check_manifest(folder.0, &planned, expect, &mut say)?;
    let text = disk::read(&path)?;
    let as_made = written::as_made(&text).is_some_and(|made| made.as_bytes() == text);
    let problem = (!as_made).then(|| format!("{}: not as a campaign writes it", path.display()));
    problems.tell(problem, &mut say)?;
    let names = &planned.stages;

    let places: Vec<_> = names.iter().map(|name| folder.member(name)).collect();
    let folders: Vec<Folder> = places.iter().map(|place| Folder(place)).collect();
    let labels: Vec<String> = names.iter().map(|name| format!("{name}: ")).collect();
    let mut archives = Vec::new();
    for ((member, own), label) in plan.members.iter().zip(&folders).zip(&labels) {
        let mut tell = |line: &str| say(&format!("{label}{line}"));
        let planned = run::planned(&member.scenario);
        let (manifest, found) = check_manifest(own.0, &planned, &[], &mut tell)?;
        problems.take(label, found);
        let problem = disagreement(member, own, whole.as_ref(), manifest.as_ref());
        problems.tell(problem.map(|problem| format!("{label}{problem}")), &mut say)?;
        match RunArchive::open(own) {
            Ok(archive) => archives.push((archive, manifest, label)),
            Err(e) => {
                say(&format!("{label}cannot be run again: {e}"))?;
                problems.add(Cause::Changed, format!("{label}cannot be run again"));
            }
        }
    }
    let mut jobs: Vec<Job> = Vec::new();
    let mut poured: Vec<String> = Vec::new();
    for (archive, manifest, label) in &archives {
        for mut job in pieces(archive, manifest.as_ref(), scope).unwrap_or_default() {
            job.label = label;
            // Members share beds: one that is byte for byte another's is poured once.
            let bed = job.bed();
            let which = bed.map(|bed| which_bed(&archive.scenario, archive.folder, bed));
            // One that cannot be read is told when it is executed.
            if let Some(Ok(Some(which))) = which {
                if poured.contains(&which) {
                    let problem = beside_twin(&job).map(|problem| format!("{label}{problem}"));
                    problems.tell(problem, &mut say)?;
                    continue;
                }
                poured.push(which);
            }
            jobs.push(job);
        }
    }
    if jobs.is_empty() {
        let problem = "no member has a kept checkpoint: nothing can be executed again";
        problems.add(Cause::Unfinished(FolderKind::Campaign), problem);
    }
    let done = execute(&sampled(jobs, scope), threads, progress, &mut say)?;
    if done.wrong > 0 {
        let problem = format!("{} of {} pieces do not hold", done.wrong, done.pieces);
        problems.add(Cause::Changed, problem);
    } else {
        let ends = scope.is_all().then_some(&archives);
        for (archive, manifest, label) in ends.into_iter().flatten() {
            let problem = summary_problem(archive, manifest.as_ref());
            problems.tell(problem.map(|problem| format!("{label}{problem}")), &mut say)?;
        }
        let (links, count) = (done.links, done.pieces);
        say(&format!("all {links} links of {count} pieces hold"))?;
        problems.take(
            "",
            check_expected(expect, whole.as_ref(), |_| scope.is_all()),
        );
    }
    problems.tell(table_holds(folder, &plan).err(), &mut say)?;
    problems.conclude(folder.0)
}

/// What is wrong between a campaign and one of its members.
fn disagreement(
    member: &Member,
    own: &Folder<'_>,
    whole: Option<&Manifest>,
    manifest: Option<&Manifest>,
) -> Option<String> {
    let text = own.scenario_text(&member.scenario);
    if disk::read(&own.scenario()).ok() != Some(text.into_bytes()) {
        return Some("its scenario is not the one that the campaign plans".into());
    }
    let stage = whole?
        .stages
        .iter()
        .find(|stage| stage.name == member.name)?;
    (stage.finished && stage.link != manifest?.closing)
        .then(|| format!("its closing hash is not the one in the campaign's {NAME}"))
}

/// Whether the tables are those of the runs that the members' manifests vouch for.
fn table_holds(folder: &CampaignFolder<'_>, plan: &Plan) -> std::result::Result<(), String> {
    let mut ended: Vec<(&Member, &DragPlan, Status)> = Vec::new();
    for member in &plan.members {
        let place = folder.member(&member.name);
        let vouched = Vouched::open(&place, FolderKind::Run).map_err(|e| e.to_string())?;
        for run in member.scenario.drags() {
            let status = status(&Folder(&place), &vouched, &run.name)?;
            ended.extend(status.map(|status| (member, run, status)));
        }
    }
    let mut rows: Vec<Row> = Vec::new();
    for (member, run, status) in &ended {
        rows.push(Row {
            member: &member.name,
            scenario: &member.scenario,
            plan: (*run).clone(),
            status,
        });
    }
    let units = plan.members[0].scenario.units();
    for (path, made) in [
        (folder.table(), table::text(&units, &rows).into_bytes()),
        (folder.parquet(), parquet::bytes(&rows)),
    ] {
        if disk::read(&path).ok() != Some(made) {
            return Err(format!(
                "{} does not follow from the results of its members",
                path.display()
            ));
        }
    }
    Ok(())
}

/// How a run ended, by what its member's manifest vouches for.
fn status(
    place: &Folder<'_>,
    vouched: &Vouched,
    run: &str,
) -> std::result::Result<Option<Status>, String> {
    let ended = vouched.manifest.has_finished(run);
    for path in [place.0.join(FAILURE), place.of_run(run, FAILURE)] {
        if !ended && vouched.lists(&path) {
            let bytes = vouched.read(&path).map_err(|e| e.to_string())?;
            let failure: Failure = serde_json::from_slice(&bytes).map_err(|e| e.to_string())?;
            return Ok(Some(Status::Failed(failure.reason)));
        }
    }
    let path = place.of_run(run, "summary.json");
    if !vouched.lists(&path) {
        return Ok(None);
    }
    let text = vouched.text(&path).map_err(|e| e.to_string())?;
    let record = parse_record(&text, &path).map_err(|e| e.to_string())?;
    Ok(Some(Status::Done(Box::new(record))))
}
