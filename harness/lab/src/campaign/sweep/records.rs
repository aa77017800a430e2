//! What is kept of the runs of a campaign: the table, and summaries and reports of its members.

use super::{Outcome, Under};
use crate::campaign::columns::{Row, Status};
use crate::campaign::{parquet, table};
use crate::folder::Folder;
use crate::run;
use crate::summary::{BedSummary, DragSummary};
use bitgrain_sim::disk;
use bitgrain_sim::error::{Error, Result};

impl Under<'_> {
    /// Keeps how a run ended, and writes the table with it.
    pub(super) fn record(
        &self,
        job: usize,
        ended: std::result::Result<DragSummary, String>,
        bed: &BedSummary,
    ) -> Result<()> {
        let folder = Folder(&self.places[self.jobs[job].member]);
        let scenario = self.scenario(self.jobs[job].member);
        let status = match ended {
            Ok(run) => Status::Done(Box::new(run::record(&folder, scenario, bed, &run))),
            Err(reason) => Status::Failed(reason),
        };
        self.slots()[job] = Some(status);
        self.write_table()
    }

    /// Writes the rows that there are, in the order of the plan.
    pub(super) fn write_table(&self) -> Result<()> {
        // Held until it is written: an older table must not replace a newer one.
        let slots = self.slots();
        let mut rows = Vec::new();
        for (job, slot) in self.jobs.iter().zip(slots.iter()) {
            rows.extend(slot.as_ref().map(|status| Row {
                member: &self.what.plan.members[job.member].name[..],
                scenario: self.scenario(job.member),
                plan: job.plan.clone(),
                status,
            }));
        }
        let units = self.scenario(0).units();
        let text = table::text(&units, &rows);
        self.ledger.write(&self.folder.table(), text.as_bytes())?;
        self.ledger
            .write(&self.folder.parquet(), &parquet::bytes(&rows))?;
        self.ledger.save()
    }

    /// What there is of a campaign that is only to be put together; `None` if no run is missing.
    pub(super) fn unfinished(&self) -> Result<Option<Outcome>> {
        let missing = {
            let slots = self.slots();
            let open = self.jobs.iter().zip(slots.iter());
            open.filter(|(job, slot)| job.open(slot)).count()
        };
        if missing == 0 {
            // A bed alone may be damaged: its member is not whole.
            return match self.open().into_iter().flatten().next() {
                None => Ok(None),
                Some(member) => Err(Error::Unverified {
                    problem: format!(
                        "a bed in {} is missing or was changed since it was written",
                        self.places[member].display()
                    ),
                    hint: "the same command without --merge makes it again",
                }),
            };
        }
        let slots = self.slots();
        let count = |wanted: fn(&Status) -> bool| {
            let ends = slots.iter().flatten();
            ends.filter(|status| wanted(status)).count()
        };
        Ok(Some(Outcome {
            done: count(|status| matches!(status, Status::Done(_))),
            failed: count(|status| matches!(status, Status::Failed(_))),
            missing,
            table: self.folder.table(),
            taken: Vec::new(),
        }))
    }

    /// Writes the summaries and reports of the members whose runs are all done.
    pub(super) fn conclude(&self) -> Result<Outcome> {
        let slots = self.slots();
        let (mut done, mut failed) = (0, 0);
        for (member, place) in self.places.iter().enumerate() {
            let own = self
                .jobs
                .iter()
                .zip(slots.iter())
                .filter(|(job, _)| job.member == member);
            let mut records = Vec::new();
            let mut whole = true;
            for (job, slot) in own {
                if let Some(Status::Done(record)) = slot {
                    records.push(record);
                    continue;
                }
                whole = false;
                failed += usize::from(job.wanted);
            }
            done += records.len();
            let folder = Folder(place);
            if !whole {
                continue;
            }
            let (name, ledger) = (&self.what.plan.members[member].name, self.ledger_of(member));
            if ledger.is_whole() && disk::is_there(&folder.report()) {
                self.ledger.finish_stage(name, &ledger.closing())?;
                continue;
            }
            let mut beds: Vec<BedSummary> = Vec::new();
            for record in &records {
                if !beds.iter().any(|bed| bed.name == record.bed.name) {
                    beds.push(record.bed.clone());
                }
            }
            let runs = records.iter().map(|record| record.run.clone()).collect();
            let closing = run::conclude(&folder, ledger, self.scenario(member), beds, runs)?;
            (self.what.write_report)(&folder)?;
            self.ledger.finish_stage(name, &closing)?;
        }
        self.ledger.finish()?;
        Ok(Outcome {
            done,
            failed,
            missing: 0,
            table: self.folder.table(),
            taken: self.taken.lock().expect("no job panics with it").clone(),
        })
    }
}
