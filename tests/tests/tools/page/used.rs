//! The page in Chromium.

use bitgrain_tests::golden;

use super::{command, page};
use crate::chromium::Browser;

/// The step that the page shows.
fn step(browser: &mut Browser) -> u64 {
    let text = browser.text("command");
    let steps = text.split(" --steps ").nth(1).unwrap();
    steps.split(' ').next().unwrap().parse().unwrap()
}

fn click(browser: &mut Browser, id: &str) {
    browser.value(&format!("document.getElementById('{id}').click()"));
}

/// Moves a slider or a choice as a visitor does.
fn set(browser: &mut Browser, id: &str, value: &str) {
    browser.value(&format!(
        "{{ const one = document.getElementById('{id}'); one.value = '{value}'; \
         for (const kind of ['input', 'change']) one.dispatchEvent(new Event(kind)); }}"
    ));
}

/// Opens the page and waits until it has begun.
fn begun(browser: &mut Browser, after: &str) {
    browser.open(&page(), after);
    browser.wait("document.getElementById('digest').textContent.length === 64");
}

fn pause(browser: &mut Browser) {
    browser.wait("document.getElementById('run').getAttribute('aria-pressed') === 'true'");
    click(browser, "run");
    browser.wait("document.getElementById('clock').textContent.includes('stands still')");
}

/// Saves the open case and compares the shown digest with the command's at the shown step.
fn check_against_the_command(browser: &mut Browser) {
    // The next frame shows what the last key did.
    let frame = "new Promise((shown) => requestAnimationFrame(() => requestAnimationFrame(shown)))";
    browser.value(frame);
    let text = browser.saved("document.getElementById('save').click()", "case.json");
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("case.json");
    std::fs::write(&path, text).unwrap();
    let steps = step(browser);
    let (last, digest) = command(&path, steps, u64::MAX).pop().unwrap();
    assert_eq!((last, digest), (steps, browser.text("digest")));
}

/// The part of the address to share that tells the open case, its step and its digest.
fn shared_fragment(browser: &mut Browser) -> String {
    click(browser, "share");
    browser.wait("!document.getElementById('shared').hidden");
    let address = browser.value("document.getElementById('address').value");
    let (_, fragment) = address.as_str().unwrap().split_once('#').unwrap();
    fragment.to_string()
}

#[test]
#[ignore = "needs a Chromium"]
fn after_ten_thousand_steps_the_digest_is_the_commands_with_and_without_wide_instructions() {
    let mut browser = Browser::start(&[]);
    let mut ends = Vec::new();
    for (after, word) in [("", "with 128-bit"), ("?plain", "without 128-bit")] {
        begun(&mut browser, after);
        assert!(browser.text("about").contains(word));
        set(&mut browser, "pace", "7");
        browser.wait("document.getElementById('agrees').textContent.startsWith('step 10,000:')");
        pause(&mut browser);
        assert_eq!(
            browser.text("agrees"),
            "step 10,000: the same as here, as at all 21 steps so far"
        );
        ends.push(browser.text("expected"));
        check_against_the_command(&mut browser);
        assert_eq!(browser.errors(), Vec::<String>::new());
        assert_eq!(browser.requests(), Vec::<String>::new());
    }
    assert_eq!(ends[0], ends[1]);
}

/// Changes of every kind make cases that the command replays, and an address leads back to the same digest.
#[test]
#[ignore = "needs a Chromium"]
fn what_a_visitor_does_is_a_case_and_fits_an_address() {
    let mut browser = Browser::start(&[]);
    begun(&mut browser, "");
    pause(&mut browser);
    set(&mut browser, "body", "cylinder");
    for (id, value) in [("mu", "0.2"), ("young", "4"), ("speed", "0.2")] {
        click(&mut browser, "once");
        set(&mut browser, id, value);
        click(&mut browser, "once");
        browser.wait("!document.getElementById('digest').textContent.startsWith('-')");
    }
    click(&mut browser, "left");
    browser.wait("document.getElementById('clock').textContent.includes('of case 5 ')");
    pause(&mut browser);
    check_against_the_command(&mut browser);
    let (last, digest) = (step(&mut browser), browser.text("digest"));
    let fragment = shared_fragment(&mut browser);
    assert!(
        fragment.len() < 400 && fragment.contains("bed=cylinder"),
        "{fragment}"
    );
    let there = "/and the digest is/.test(document.getElementById('said').textContent) || \
                 /but the digest/.test(document.getElementById('said').textContent)";
    for (given, end) in [
        (fragment.clone(), "and the digest is the same."),
        (
            fragment.replace("0.2,4,-0.2", "0.25,4,-0.2"),
            "but the digest is another: this browser or",
        ),
        (
            fragment
                .replace("bits=1", "bits=99")
                .replace("0.2,4,-0.2", "0.25,4,-0.2"),
            "arithmetic version 99",
        ),
    ] {
        // A slow machine draws nothing it need not.
        browser.open(&page(), &format!("?plain#{given}"));
        browser.wait(there);
        assert!(
            browser.text("said").contains(end),
            "{}",
            browser.text("said")
        );
        if given == fragment {
            browser.wait("document.getElementById('digest').textContent.length === 64");
            assert_eq!(
                (step(&mut browser), browser.text("digest")),
                (last, digest.clone())
            );
        }
    }
    for (broken, word) in [
        ("bed=ball&run=0.5,2,0.1,20", "no digest of 64"),
        (
            &*fragment.replace("bed=cylinder", "bed=cube"),
            "bed round \"cube\"",
        ),
        (
            &*fragment.replace("run=", "run=7,"),
            "is no friction, stiffness, velocity and steps",
        ),
        (
            &*format!("case=AAAA&steps=3&digest={digest}&bits=1"),
            "cannot be unpacked",
        ),
    ] {
        browser.open(&page(), &format!("#{broken}"));
        browser.wait("!document.getElementById('error').hidden");
        assert!(
            browser.text("error").contains(word),
            "{}",
            browser.text("error")
        );
    }
}

#[test]
#[ignore = "needs a Chromium"]
fn files_are_dropped_replayed_and_refused_with_a_reason() {
    let mut browser = Browser::start(&[]);
    begun(&mut browser, "");
    let case = golden("cases/collapse.json");
    browser.drop(&case);
    browser
        .wait("document.getElementById('said').textContent.startsWith('collapse.json: 30 grains')");
    let folder = tempfile::tempdir().unwrap();
    let lines = folder.path().join("lines.jsonl");
    let printed = command(&case, 1000, 250);
    let line =
        |(step, digest): &(u64, String)| format!("{{\"step\":{step},\"digest\":\"{digest}\"}}\n");
    std::fs::write(&lines, printed.iter().map(line).collect::<String>()).unwrap();
    click(&mut browser, "again");
    browser.drop(&lines);
    browser.wait(
        "document.getElementById('agrees').textContent.startsWith('step 1,000: the same as here')",
    );
    pause(&mut browser);
    check_against_the_command(&mut browser);
    assert_eq!(
        browser.value("document.getElementById('physics').disabled"),
        true
    );
    // An address holds a small case whole.
    let fragment = shared_fragment(&mut browser);
    browser.open(&page(), &format!("#{fragment}"));
    browser
        .wait("document.getElementById('said').textContent.includes('and the digest is the same')");
    // One wrong digit in the command's lines is seen.
    let wrong: Vec<(u64, String)> = printed
        .iter()
        .map(|(step, of)| (*step, of.replace('a', "b")))
        .collect();
    std::fs::write(&lines, wrong.iter().map(line).collect::<String>()).unwrap();
    click(&mut browser, "again");
    browser.drop(&lines);
    browser
        .wait("document.getElementById('agrees').textContent.includes('another digest than here')");
    let before = browser.text("digest");
    let text = std::fs::read_to_string(&case).unwrap();
    for (name, text, word) in [
        ("cut.json", &text[..text.len() / 2], "is the file cut off?"),
        (
            "key.json",
            &text.replacen("\"mu\"", "\"my\"", 1),
            "did you mean `mu`?",
        ),
        ("none.json", "a text", "case.json:1"),
    ] {
        let path = folder.path().join(name);
        std::fs::write(&path, text).unwrap();
        browser.drop(&path);
        let said = format!("document.getElementById('error').textContent.includes({word:?})");
        browser.wait(&said);
        browser.wait("!document.getElementById('error').hidden");
    }
    assert_eq!(browser.text("digest").len(), before.len());
    assert_eq!(browser.requests(), Vec::<String>::new());
    assert_eq!(browser.errors(), Vec::<String>::new());
}

#[test]
#[ignore = "needs a Chromium"]
fn keys_alone_are_enough() {
    let mut browser = Browser::start(&[]);
    begun(&mut browser, "");
    let mut seen = Vec::new();
    for _ in 0..22 {
        browser.press("Tab");
        let id = browser.value("document.activeElement.id");
        seen.push(id.as_str().unwrap_or("").to_string());
    }
    for id in [
        "view", "run", "once", "again", "left", "stop", "right", "body", "mu", "young", "speed",
        "pace", "colour", "cut", "command", "save", "share", "file",
    ] {
        assert!(
            seen.iter().any(|one| one == id),
            "{id} is not reached: {seen:?}"
        );
    }
    let pressed = |id: &str, on: bool| {
        format!("document.getElementById('{id}').getAttribute('aria-pressed') === '{on}'")
    };
    browser.value("document.getElementById('view').focus()");
    for (key, id) in [("s", "stop"), ("a", "left"), ("d", "right")] {
        browser.press(key);
        browser.wait(&pressed(id, true));
    }
    for key in ["ArrowLeft", "ArrowUp", "+", "Home"] {
        browser.press(key);
    }
    browser.press(" ");
    browser.wait(&pressed("run", false));
    browser.value("document.getElementById('mu').focus()");
    browser.press("ArrowRight");
    browser.wait("document.getElementById('mu').nextElementSibling.textContent === '0.55'");
    browser.value("document.getElementById('left').focus()");
    browser.press("Enter");
    browser.wait(&pressed("left", true));
    browser.wait("document.getElementById('clock').textContent.includes(' of case ')");
    browser.value("document.getElementById('run').focus()");
    browser.press(" ");
    browser.wait("document.getElementById('clock').textContent.includes('stands still')");
    check_against_the_command(&mut browser);
    assert_eq!(browser.errors(), Vec::<String>::new());
}

/// A pointer on the ball drags it, and stops it where it is let go; elsewhere it turns the view.
#[test]
#[ignore = "needs a Chromium"]
fn the_ball_follows_a_pointer() {
    let mut browser = Browser::start(&["--force-prefers-reduced-motion"]);
    begun(&mut browser, "");
    click(&mut browser, "stop");
    pause(&mut browser);
    let place = "(() => { const {left, top, width, height} = document.getElementById('view')\
                 .getBoundingClientRect(); return [left, top, width, height]; })()";
    let place = browser.value(place);
    let [left, top, width, height] = std::array::from_fn(|k| place[k].as_f64().unwrap());
    let cursor = "document.getElementById('view').style.cursor";
    // The pointer looks for the ball in steps of half its width or less.
    let found = (0..30 * 30).map(|k| [k % 30, k / 30].map(|n| (f64::from(n) + 0.5) / 30.0));
    let mut over = None;
    for [x, y] in found {
        let at = [left + x * width, top + y * height];
        browser.mouse("mouseMoved", at, 0);
        if browser.value(cursor) == "ew-resize" {
            over = Some(at);
            break;
        }
    }
    let [x, y] = over.expect("the ball is in the view");
    let before = browser.text("digest");
    browser.mouse("mousePressed", [x, y], 1);
    browser.mouse("mouseMoved", [x + 80.0, y + 20.0], 1);
    let right = "document.getElementById('right').getAttribute('aria-pressed') === 'true'";
    browser.wait(right);
    browser.wait("/a travel of [1-9]/.test(document.getElementById('force').textContent)");
    browser.mouse("mouseReleased", [x + 80.0, y + 20.0], 1);
    browser.wait("document.getElementById('stop').getAttribute('aria-pressed') === 'true'");
    pause(&mut browser);
    assert_ne!(browser.text("digest"), before);
    check_against_the_command(&mut browser);
    assert_eq!(browser.errors(), Vec::<String>::new());
}

#[test]
#[ignore = "needs a Chromium"]
fn it_can_be_read_on_a_desk_and_on_a_phone_and_by_those_who_want_no_motion() {
    let mut browser = Browser::start(&["--force-prefers-reduced-motion"]);
    for (width, scheme) in [(1280, "light"), (390, "light"), (390, "dark")] {
        browser.size(width, 900);
        let features =
            serde_json::json!({"features": [{"name": "prefers-color-scheme", "value": scheme}]});
        browser.call("Emulation.setEmulatedMedia", features);
        begun(&mut browser, "");
        // It waits for the visitor.
        assert_eq!(step(&mut browser), 0);
        click(&mut browser, "once");
        click(&mut browser, "share");
        browser.wait("!document.getElementById('shared').hidden");
        let script = include_str!("../browser.js");
        let finds = browser.value(&format!(
            "(() => {{ const SMALLEST = 9;\n{script}\nlook(window); return finds.join('\\n'); }})()"
        ));
        let finds = finds.as_str().unwrap();
        assert_eq!(finds.lines().count(), 1, "at {width} px: {finds}");
        assert!(finds.starts_with("looked at 1 drawings"), "{finds}");
    }
}

#[test]
#[ignore = "needs a Chromium"]
fn without_a_picture_all_else_works() {
    let mut browser = Browser::start(&["--disable-3d-apis"]);
    begun(&mut browser, "");
    assert!(
        browser
            .text("stage")
            .contains("There is no picture: this browser shows no WebGL 2")
    );
    browser.wait("document.getElementById('agrees').textContent.startsWith('step 500: the same')");
    pause(&mut browser);
    check_against_the_command(&mut browser);
}

/// Frames a second as the page itself says them: figures, not limits, since all is drawn in software here.
#[test]
#[ignore = "figures, not a test"]
fn bench() {
    let mut browser = Browser::start(&[]);
    for (after, size) in [("", [1280, 1000]), ("", [390, 844]), ("?plain", [390, 844])] {
        browser.size(size[0], size[1]);
        begun(&mut browser, after);
        // The page draws fewer pixels by and by, if it is slow.
        std::thread::sleep(std::time::Duration::from_secs(10));
        let [width, height] = size;
        let told = browser.text("clock");
        println!("2,000 grains, {width} x {height} pixels, drawn in software {after}: {told}");
    }
}
