//! The drag as a moving picture: the grains round the intruder, coloured by speed, at one frame after the
//! other.

use super::caption::depth_text;
use super::flow::{GROUPS, coloured, group};
use super::near_field::key;
use super::player::{ROOM, State, figure};
use super::plot::drawable;
use super::scale::{Cut, Scale};
use super::scale::{open, ticks};
use super::text::escape;
use bitgrain_lab::frames::{Frame, Slice, reach};
use bitgrain_lab::summary::{DragSummary, Summary};
use bitgrain_sim::format::short;
use bitgrain_sim::motion::Moves;
use bitgrain_sim::simulation::Role;

/// Frames of a drag; all lengths over the mean grain diameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Name of the run.
    pub run: String,
    /// Radius of the intruder.
    pub radius: f64,
    /// Depth of the floor below its centre.
    pub floor: f64,
    /// Which of bed and intruder moves along +x.
    pub moves: Moves,
    /// In the order of time.
    pub frames: Vec<Frame>,
}

/// The section of the page; empty if there is nothing to play.
pub(super) fn section(summary: &Summary, films: &[Film]) -> String {
    let share = ROOM / films.len().max(1);
    let mut figures = String::new();
    for (k, film) in films.iter().enumerate() {
        let run = summary.runs.iter().find(|run| run.name == film.run);
        if let Some(html) = run.and_then(|run| played(summary, run, film, (share, k))) {
            figures.push_str(&html);
        }
    }
    if figures.is_empty() {
        return String::new();
    }
    let lid = films.iter().any(|f| {
        f.frames
            .iter()
            .any(|f| f.cuts.iter().any(|c| c.role == Role::Lid))
    });
    format!(
        "<section>\n<h2>The drag, frame by frame</h2>\n<p>Slices through the intruder&rsquo;s centre, which stays in \
         the middle; play them or step through them. Colours are speeds over V, relative to the base.</p>\n{}\
         <div class=\"grid\">\n{figures}</div>\n</section>\n",
        key(lid)
    )
}

/// Every k-th frame, so that they have at most as many circles.
fn thinned(frames: &[Frame], most: usize) -> Vec<&Frame> {
    let circles: usize = frames.iter().map(|frame| frame.cuts.len()).sum();
    let apart = circles.div_ceil(most.max(1)).max(1);
    frames.iter().step_by(apart).collect()
}

/// One film; `None` if there is nothing to step through.
fn played(
    summary: &Summary,
    run: &DragSummary,
    film: &Film,
    (share, index): (usize, usize),
) -> Option<String> {
    let frames = thinned(&film.frames, share);
    let all = || frames.iter().flat_map(|frame| &frame.cuts);
    let good = |c: &Slice| [c.x, c.z, c.radius, c.speed].iter().all(|x| drawable(*x));
    let sound = [film.radius, film.floor].iter().all(|x| drawable(*x));
    if frames.len() < 2 || !sound || !all().all(good) {
        return None;
    }
    let reach = reach(film.radius);
    let far = |of: fn(&Slice) -> f64| all().map(of).fold(film.radius, f64::max);
    let half = far(|c| c.x.abs()).min(reach);
    let top = far(|c| c.z + c.radius).min(reach);
    let low = film.floor.max(film.radius).min(reach);
    let scale = Scale::new([-half, -low], [half, top])?;
    let home = frames.len() / 2;
    let states: Vec<State> = frames.iter().map(|frame| state(frame)).collect();
    let mut svg = String::new();
    let id = format!("film-{index}");
    let title = format!("Frames of {}", film.run);
    open(&mut svg, "flow", &title, &id, &scale);
    let cuts = |place: usize| -> Vec<Cut> {
        let own = states[home].cuts.iter().filter(|(_, k)| *k == place);
        own.map(|(cut, _)| *cut).collect()
    };
    coloured(&mut svg, &scale, &id, cuts, film.radius);
    svg.push_str("</g>");
    super::flow::frame(&mut svg, &scale, -film.floor);
    ticks(&mut svg, &scale, ["along the drag (d)", "up (d)"]);
    svg.push_str("</svg>");
    let way = match film.moves {
        Moves::Intruder => "The intruder moves to the right.",
        Moves::Bed => "The bed moves to the right.",
    };
    let name = match run.flow {
        Some(_) => format!("<b>{}</b>{}", escape(&run.name), depth_text(summary, run)),
        None => format!(
            "<b>{}</b>, Fr&nbsp;=&nbsp;{}",
            escape(&run.name),
            short(run.froude)
        ),
    };
    let ends = [0, frames.len() - 1].map(|k| short(frames[k].travel));
    let caption = format!("{name}, travel {} to {}&nbsp;d. {way}", ends[0], ends[1]);
    let words = (&title[..], &caption[..]);
    Some(figure("played", &svg, words, &scale, GROUPS, &states, home))
}

fn state(frame: &Frame) -> State {
    let cut = |c: &Slice| Cut {
        x: c.x,
        z: c.z,
        radius: c.radius,
    };
    State {
        label: format!("travel {:.2} d", frame.travel),
        cuts: frame
            .cuts
            .iter()
            .map(|c| (cut(c), group(c.role, c.speed)))
            .collect(),
    }
}
