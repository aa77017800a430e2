//! A real Slurm: a controller and two nodes on this machine, on which a campaign and a run are submitted, lose a node
//! and their time, and end with the bytes of one process.
//!
//! `cargo test -p bitgrain-tests --release --test tools slurm:: -- --ignored --nocapture` needs Debian's `slurm-wlm`
//! and `munge`, and says how long each part took. `.ci/run slurm` builds the program that is run as ranks.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::net::TcpListener;
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Output, Stdio};
use std::time::{Duration, Instant};

use bitgrain_tests::processes::{MPI_AS_ROOT, processes, signal};
use bitgrain_tests::{CAMPAIGN, SMALL, differing, results, root, two_drags};

const PROGRAM: &str = env!("CARGO_BIN_EXE_bitgrain-under-test");

/// How long a part may take before it is taken to hang.
const DEADLINE: Duration = Duration::from_secs(300);

/// Daemons that end with the test.
struct Cluster {
    folder: tempfile::TempDir,
    daemons: Vec<Child>,
    nodes: Vec<Child>,
}

impl Cluster {
    /// With these nodes of so many processors.
    fn start(names: &[&str], processors: usize) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let key = at("munge.key");
        // A key of this cluster alone; it guards nothing.
        std::fs::write(&key, [7; 1024]).unwrap();
        let mode = std::os::unix::fs::PermissionsExt::from_mode(0o600);
        std::fs::set_permissions(&key, mode).unwrap();
        std::fs::create_dir(at("state")).unwrap();
        let text = configuration(folder.path(), names, processors);
        std::fs::write(at("slurm.conf"), text).unwrap();
        let mut cluster = Self {
            folder,
            daemons: Vec::new(),
            nodes: Vec::new(),
        };
        let mut munged = cluster.command("munged");
        munged.args(["--foreground", "--force"]);
        for (option, file) in [
            ("socket", "munge.socket"),
            ("key-file", "munge.key"),
            ("pid-file", "munged.pid"),
            ("seed-file", "munge.seed"),
        ] {
            let path = cluster.folder.path().join(file);
            munged.arg(format!("--{option}={}", path.display()));
        }
        cluster.daemons.push(munged.spawn().expect("munged"));
        let socket = cluster.folder.path().join("munge.socket");
        until("munge answers", || socket.exists());
        let controller = cluster.command("slurmctld").arg("-D").spawn();
        cluster.daemons.push(controller.expect("slurmctld"));
        for name in names {
            let node = cluster.command("slurmd").args(["-D", "-N", name]).spawn();
            cluster.nodes.push(node.expect("slurmd"));
        }
        let idle = format!("{} idle", names.len());
        until("the nodes are idle", || {
            let told = cluster.asks("sinfo", &["-h", "-o", "%D %T"]);
            told.trim() == idle
        });
        cluster
    }

    /// A program of Slurm, in the folder of the work.
    fn command(&self, program: &str) -> Command {
        // Daemons of Debian lie where not every user looks.
        let path = std::env::var("PATH").unwrap_or_default() + ":/usr/sbin:/sbin";
        let mut command = Command::new(program);
        command
            .current_dir(self.folder.path())
            .env("PATH", path)
            .env("SLURM_CONF", self.folder.path().join("slurm.conf"))
            .stderr(Stdio::null())
            .stdout(Stdio::null());
        command
    }

    fn asks(&self, program: &str, args: &[&str]) -> String {
        let mut command = self.command(program);
        let out = command.args(args).stdout(Stdio::piped()).output();
        let out = out.expect("a program of Slurm");
        String::from_utf8_lossy(&out.stdout).into_owned()
    }

    /// Runs bitgrain in the folder of the work.
    fn bitgrain(&self, line: &str) -> Output {
        let mut command = self.command(PROGRAM);
        command.args(line.split_whitespace());
        command.stdout(Stdio::piped()).stderr(Stdio::piped());
        command.output().unwrap()
    }

    /// The same, which must end with this status; returns all that it printed.
    fn says(&self, line: &str, status: i32) -> String {
        let out = self.bitgrain(line);
        let told = String::from_utf8_lossy(&out.stdout).into_owned();
        let told = told + &String::from_utf8_lossy(&out.stderr);
        assert_eq!(out.status.code(), Some(status), "{line}: {told}");
        told
    }

    /// Jobs that are not done: what `squeue` says.
    fn queue(&self) -> String {
        self.asks("squeue", &["-h", "-r", "-o", "%i %j %T %N"])
    }

    fn drained(&self) {
        until("no job is left", || self.queue().is_empty());
    }

    fn at(&self, name: &str) -> PathBuf {
        self.folder.path().join(name)
    }

    /// Kills a node with all that runs on it, by `kill -9`.
    fn kill_node(&mut self, place: usize) {
        let name = format!("SLURMD_NODENAME=node{}", place + 1);
        let own = format!("SLURM_CONF={}", self.at("slurm.conf").display());
        self.nodes[place].kill().unwrap();
        self.nodes[place].wait().unwrap();
        let mut killed = 0;
        for process in processes() {
            if !(process.environment.contains(&name) && process.environment.contains(&own)) {
                continue;
            }
            killed += 1;
            // The one that watches over a step, and the step.
            for id in [process.parent, process.id] {
                let watcher = std::fs::read_to_string(format!("/proc/{id}/cmdline"));
                let is_slurm = watcher.is_ok_and(|line| line.starts_with("slurmstepd"));
                if id == process.id || is_slurm {
                    signal(id, "9");
                }
            }
        }
        assert!(killed > 0, "nothing was at work on the node");
    }
}

impl Drop for Cluster {
    fn drop(&mut self) {
        for daemon in self.nodes.iter_mut().chain(&mut self.daemons).rev() {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
        // What jobs have left.
        let own = format!("SLURM_CONF={}", self.at("slurm.conf").display());
        for process in processes() {
            if process.environment.contains(&own) {
                signal(process.id, "9");
            }
        }
    }
}

/// The smallest Slurm: one controller, these nodes of so many processors each, no accounting.
fn configuration(folder: &Path, names: &[&str], processors: usize) -> String {
    let user = Command::new("id").arg("-un").output().unwrap().stdout;
    let user = String::from_utf8(user).unwrap().trim().to_string();
    // All are free at one time, so that they differ.
    let free = || TcpListener::bind("127.0.0.1:0").unwrap();
    let free: Vec<_> = (0..=names.len()).map(|_| free()).collect();
    let port = |k: usize| free[k].local_addr().unwrap().port();
    let controller = port(0);
    let folder = folder.display();
    let mut text = format!(
        "ClusterName=test\n\
         SlurmctldHost=localhost\n\
         SlurmctldPort={controller}\n\
         AuthType=auth/munge\n\
         AuthInfo=socket={folder}/munge.socket,cred_expire=5\n\
         SlurmUser={user}\n\
         SlurmdUser={user}\n\
         StateSaveLocation={folder}/state\n\
         SlurmdSpoolDir={folder}/spool.%n\n\
         SlurmctldPidFile={folder}/slurmctld.pid\n\
         SlurmdPidFile={folder}/slurmd.%n.pid\n\
         SlurmctldLogFile={folder}/slurmctld.log\n\
         SlurmdLogFile={folder}/slurmd.%n.log\n\
         ProctrackType=proctrack/linuxproc\n\
         TaskPlugin=task/none\n\
         SelectType=select/cons_tres\n\
         SelectTypeParameters=CR_CPU\n\
         ReturnToService=2\n\
         SlurmdTimeout=10\n\
         KillWait=10\n\
         SchedulerParameters=batch_sched_delay=0,sched_interval=2\n"
    );
    for (k, name) in names.iter().enumerate() {
        let port = port(k + 1);
        let _ = writeln!(
            text,
            "NodeName={name} NodeHostname=localhost NodeAddr=127.0.0.1 Port={port} CPUs={processors} State=UNKNOWN"
        );
    }
    let names = names.join(",");
    text + &format!("PartitionName=main Nodes={names} Default=YES MaxTime=INFINITE State=UP\n")
}

fn until(what: &str, done: impl Fn() -> bool) {
    let began = Instant::now();
    while !done() {
        assert!(
            began.elapsed() < DEADLINE,
            "{what}: not within {DEADLINE:?}"
        );
        std::thread::sleep(Duration::from_millis(200));
    }
}

/// What is promised of a folder: all of it but the scripts and logs of the scheduler.
fn promised(folder: &Path) -> BTreeMap<String, Vec<u8>> {
    let mut files = results(folder);
    files.retain(|name, _| !name.starts_with("slurm/"));
    files
}

/// Names of what differs of that.
fn wrong(a: &Path, b: &Path) -> Vec<String> {
    differing(&promised(a), &promised(b))
}

/// Some seconds a row.
fn campaign() -> String {
    let speeds = "speed = [1.0, 2.0]";
    let longer = format!("{speeds}\ndistance = [40.0, 80.0]");
    let campaign = CAMPAIGN.replace(speeds, &longer);
    campaign.replace("set = { ", "set = { \"drag.own_wake\" = true, ")
}

#[test]
#[ignore = "needs Slurm: `.ci/run slurm`"]
fn a_campaign_loses_a_node_and_a_run_its_time() {
    let began = Instant::now();
    let tell = |what: &str| println!("{:6.1} s: {what}", began.elapsed().as_secs_f64());
    let mut cluster = Cluster::start(&["node1", "node2"], 1);
    std::fs::write(cluster.at("small.toml"), SMALL).unwrap();
    std::fs::write(cluster.at("camp.toml"), campaign()).unwrap();
    tell("a controller and two nodes are there");
    let first = Instant::now();
    cluster.says("sweep camp.toml --out one --beds beds-one --threads 1", 0);
    let whole = first.elapsed();
    tell("the campaign is done by one process");
    lose_a_node(&mut cluster, tell);
    run_out_of_time(&cluster, whole, tell);
}

/// `mpirun` in a job takes from Slurm how many ranks there are, and they end with the bytes of one process. The node is
/// this machine under its own name: two nodes of one machine confuse the daemons of Open MPI.
#[test]
#[ignore = "needs Slurm and Open MPI: `.ci/run slurm`"]
fn ranks_of_a_job_share_a_run() {
    let host = Command::new("hostname").output().unwrap().stdout;
    let host = String::from_utf8(host).unwrap();
    let cluster = Cluster::start(&[host.trim()], 2);
    std::fs::write(cluster.at("small.toml"), two_drags()).unwrap();
    let run = "run small.toml --threads 1";
    cluster.says(&format!("{run} --out alone --beds beds-one"), 0);
    let program = root().join("target/ranks/release/bitgrain-under-test");
    let script = format!(
        "#!/bin/sh\n\
         export {} BITGRAIN_PART_MIN=30\n\
         mpirun --tag-output printenv SLURM_JOB_ID\n\
         mpirun {} {run} --out shared --beds beds-two\n\
         echo status $?\n",
        MPI_AS_ROOT
            .map(|(name, value)| format!("{name}={value}"))
            .join(" "),
        program.display()
    );
    std::fs::write(cluster.at("job.sh"), script).unwrap();
    let options = ["--ntasks=2", "--output=job.log", "job.sh"];
    cluster.asks("sbatch", &options);
    cluster.drained();
    let log = std::fs::read_to_string(cluster.at("job.log")).unwrap_or_default();
    assert!(log.contains("status 0"), "{log}");
    for rank in 0..2 {
        assert!(log.contains(&format!("[1,{rank}]<stdout>:1")), "{log}");
    }
    let wrong = wrong(&cluster.at("alone"), &cluster.at("shared"));
    assert!(wrong.is_empty(), "{wrong:?} {log}");
}

/// A campaign on two nodes, one of which is killed, and what is missing then on the other.
fn lose_a_node(cluster: &mut Cluster, tell: impl Fn(&str)) {
    let sweep = "sweep camp.toml --out many --beds beds-many --save-every 500";
    let told = cluster.says(&format!("{sweep} --submit slurm -- --time=10"), 0);
    assert!(told.contains("missing: beds 2, drags 4"), "{told}");
    assert_eq!(told.matches(": job ").count(), 3, "{told}");
    let saved = |drag: &str| {
        let place = format!("many/tasks/{drag}/runs");
        let runs = results_if_there(&cluster.at(&place));
        runs.iter().any(|name| name.ends_with("latest.safetensors"))
    };
    until(
        "a drag is done, and another is saved in its midst on the second node",
        || {
            let running = cluster.queue();
            let mut jobs = running.lines().filter(|job| job.ends_with("RUNNING node2"));
            let on_second =
                jobs.find_map(|job| job.split([' ', '_']).nth(1)?.parse::<usize>().ok());
            let drags = ["mu0.1/run-1", "mu0.1/run-2", "mu0.5/run-1", "mu0.5/run-2"];
            let done = |drag: &&str| {
                let (_, run) = drag.split_once('/').unwrap();
                cluster
                    .at(&format!("many/tasks/{drag}/runs/{run}/summary.json"))
                    .exists()
            };
            drags.iter().any(done) && on_second.is_some_and(|k| saved(drags[k - 1]))
        },
    );
    cluster.kill_node(1);
    tell("a node is killed");
    // Nobody waits until Slurm has seen it: what is left is cancelled.
    let jobs = cluster.queue();
    for job in jobs.lines().filter_map(|job| job.split(' ').next()) {
        cluster.asks("scancel", &[job]);
    }
    cluster.drained();
    let told = cluster.says(&format!("{sweep} --merge"), 3);
    assert!(told.contains("rows of many are missing"), "{told}");
    let missing = told
        .lines()
        .filter(|line| line.contains("--task mu"))
        .count();
    assert!((1..=3).contains(&missing), "{told}");
    let told = cluster.says(&format!("{sweep} --submit slurm -- --time=10"), 0);
    assert!(
        told.contains(&format!("missing: beds 0, drags {missing}")),
        "{told}"
    );
    tell(&format!("{missing} rows are submitted again"));
    cluster.drained();
    let wrong = wrong(&cluster.at("one"), &cluster.at("many"));
    let logs = logs(&cluster.at("many/slurm"));
    assert!(wrong.is_empty(), "{wrong:?} {logs}");
    tell("the merged campaign has the bytes of the one process");
    let told = cluster.says(&format!("{sweep} --submit slurm"), 0);
    assert!(told.contains("nothing to submit"), "{told}");
}

/// A run whose jobs have less time than it takes; each drag of it is about as long as the whole campaign, as that was
/// measured.
fn run_out_of_time(cluster: &Cluster, whole: Duration, tell: impl Fn(&str)) {
    // As many of them as last longer than the time of a job.
    let count = (48.0 / whole.as_secs_f64()).ceil().clamp(8.0, 64.0) as u32;
    let speeds = (0..count).map(|k| format!("0.05{k:02}"));
    let speeds = speeds.collect::<Vec<_>>().join(",");
    let run = format!(
        "run small.toml --set bed.settled=1e-2 --set intruder.speed=[{speeds}] --set drag.distance=8"
    );
    cluster.says(
        &format!("{run} --out alone --beds beds-run-one --threads 1"),
        0,
    );
    tell("the run is done by one process");
    // Slurm looks at its clock every half minute, and then sends what is due in the next.
    let options = "--time=1 --signal=TERM@29";
    cluster.says(
        &format!("{run} --out again --beds beds-run-many --submit slurm -- {options}"),
        0,
    );
    cluster.drained();
    let wrong = wrong(&cluster.at("alone"), &cluster.at("again"));
    let logs = logs(&cluster.at("again/slurm"));
    assert!(wrong.is_empty(), "{wrong:?} {logs}");
    let stops = logs.matches("interrupted at step").count();
    assert!(stops >= 1, "{logs}");
    tell(&format!(
        "the run ended with the same bytes, resumed {stops} times by itself"
    ));
}

/// Names of files below a folder, if there is one; files may come and go.
fn results_if_there(folder: &Path) -> Vec<String> {
    let found = Command::new("find").arg(folder).output().unwrap();
    let found = String::from_utf8_lossy(&found.stdout).into_owned();
    found.lines().map(String::from).collect()
}

/// All logs of submissions.
fn logs(folder: &Path) -> String {
    let mut text = String::new();
    for (name, bytes) in results(folder) {
        if name.ends_with(".log") {
            let _ = writeln!(text, "{name}: {}", String::from_utf8_lossy(&bytes));
        }
    }
    text
}
