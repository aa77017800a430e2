//! A Chromium that a test drives by its DevTools protocol over pipes: keys, dropped files and requests are the
//! browser's own. The variable `CHROMIUM` names its program if that is not `chromium`.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

/// Longest time that a page may take for what is waited for: machines of tests draw in software, beside other tests.
const PATIENCE: Duration = Duration::from_secs(180);

/// What makes a browser draw in software, said outright: one that has to fall back to it warns on the console.
pub const IN_SOFTWARE: [&str; 2] = ["--use-angle=swiftshader", "--enable-unsafe-swiftshader"];

/// A browser with one page.
pub struct Browser {
    child: Child,
    to: ChildStdin,
    from: BufReader<ChildStdout>,
    session: Option<String>,
    calls: u64,
    events: Vec<Value>,
    folder: tempfile::TempDir,
}

impl Browser {
    /// A browser that draws in software, with further arguments.
    pub fn start(more: &[&str]) -> Self {
        let folder = tempfile::tempdir().unwrap();
        let program = std::env::var("CHROMIUM").unwrap_or_else(|_| "chromium".into());
        // The protocol is spoken on descriptors 3 and 4.
        let mut child = Command::new("sh")
            .args(["-c", "exec \"$@\" 3<&0 4>&1 1>/dev/null 2>/dev/null", "sh"])
            .args([
                &program,
                "--headless=new",
                "--no-sandbox",
                "--remote-debugging-pipe",
            ])
            .args(IN_SOFTWARE)
            .arg(format!(
                "--user-data-dir={}",
                folder.path().join("profile").display()
            ))
            .args(more)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap_or_else(|e| panic!("{program} cannot be started (set CHROMIUM): {e}"));
        let (to, from) = (child.stdin.take().unwrap(), child.stdout.take().unwrap());
        let mut browser = Self {
            child,
            to,
            from: BufReader::new(from),
            session: None,
            calls: 0,
            events: Vec::new(),
            folder,
        };
        let target = browser.call("Target.createTarget", json!({"url": "about:blank"}));
        let asked = json!({"targetId": target["targetId"], "flatten": true});
        let attached = browser.call("Target.attachToTarget", asked);
        browser.session = attached["sessionId"].as_str().map(str::to_owned);
        for domain in ["Page", "Runtime", "Network", "Log"] {
            browser.call(&format!("{domain}.enable"), json!({}));
        }
        browser.size(1280, 1000);
        browser
    }

    /// One message of the browser.
    fn message(&mut self) -> Value {
        let mut bytes = Vec::new();
        self.from.read_until(0, &mut bytes).unwrap();
        assert_eq!(bytes.pop(), Some(0), "the browser has ended");
        serde_json::from_slice(&bytes).unwrap()
    }

    /// A call of the protocol, and what it returns.
    pub fn call(&mut self, method: &str, params: Value) -> Value {
        self.calls += 1;
        let id = self.calls;
        let mut message = json!({"id": id, "method": method, "params": params});
        if let Some(session) = &self.session {
            message["sessionId"] = json!(session);
        }
        self.to.write_all(message.to_string().as_bytes()).unwrap();
        self.to.write_all(&[0]).unwrap();
        self.to.flush().unwrap();
        loop {
            let answer = self.message();
            if answer["id"] == json!(id) {
                assert!(
                    answer.get("error").is_none(),
                    "{method}: {}",
                    answer["error"]
                );
                return answer["result"].clone();
            }
            self.events.push(answer);
        }
    }

    /// Sets the size of the window, in CSS pixels.
    pub fn size(&mut self, width: u32, height: u32) {
        let size =
            json!({"width": width, "height": height, "deviceScaleFactor": 1, "mobile": false});
        self.call("Emulation.setDeviceMetricsOverride", size);
    }

    /// Opens a file with this after its name, as `?plain` or `#run=...`.
    pub fn open(&mut self, file: &Path, after: &str) {
        self.call("Page.navigate", json!({"url": "about:blank"}));
        self.wait("location.href === 'about:blank'");
        self.events.clear();
        let url = format!("file://{}{after}", file.display());
        self.call("Page.navigate", json!({"url": url}));
        self.wait("location.protocol === 'file:' && document.readyState === 'complete'");
    }

    /// The value of an expression in the page; promises are waited for.
    pub fn value(&mut self, script: &str) -> Value {
        let asked = json!({"expression": script, "awaitPromise": true, "returnByValue": true});
        let answer = self.call("Runtime.evaluate", asked);
        assert!(
            answer.get("exceptionDetails").is_none(),
            "{script}: {answer}"
        );
        answer["result"]["value"].clone()
    }

    /// The text of the element with this id.
    pub fn text(&mut self, id: &str) -> String {
        let text = self.value(&format!(
            "document.getElementById({}).textContent",
            json!(id)
        ));
        text.as_str().unwrap().to_string()
    }

    /// Waits until an expression in the page holds.
    pub fn wait(&mut self, condition: &str) {
        let began = Instant::now();
        while self.value(condition) != json!(true) {
            let shown = "document.body?.innerText.slice(0, 3000)";
            if began.elapsed() > PATIENCE {
                panic!(
                    "{condition} does not come; the page shows {}",
                    self.value(shown)
                );
            }
            std::thread::sleep(Duration::from_millis(50));
        }
    }

    /// Presses and lets go a key, by its name in `KeyboardEvent.key`.
    pub fn press(&mut self, key: &str) {
        let code = match key {
            "Tab" => 9,
            "Enter" => 13,
            "Home" => 36,
            "ArrowLeft" => 37,
            "ArrowUp" => 38,
            "ArrowRight" => 39,
            "ArrowDown" => 40,
            other => u32::from(other.as_bytes()[0].to_ascii_uppercase()),
        };
        let text = match key {
            "Enter" => "\r",
            one if one.len() == 1 => one,
            _ => "",
        };
        let mut event = json!({"key": key, "windowsVirtualKeyCode": code});
        event["type"] = json!(if text.is_empty() {
            "rawKeyDown"
        } else {
            "keyDown"
        });
        if !text.is_empty() {
            event["text"] = json!(text);
        }
        self.call("Input.dispatchKeyEvent", event.clone());
        event["type"] = json!("keyUp");
        self.call("Input.dispatchKeyEvent", event);
    }

    /// Moves the pointer (`mouseMoved`), or presses or lets go its first button there, in CSS pixels; `held` is 1 while
    /// that is down.
    pub fn mouse(&mut self, kind: &str, [x, y]: [f64; 2], held: u32) {
        let button = if held == 1 { "left" } else { "none" };
        let buttons = if kind == "mouseReleased" { 0 } else { held };
        let event = json!({"type": kind, "x": x, "y": y, "button": button, "buttons": buttons,
            "clickCount": u32::from(kind != "mouseMoved")});
        self.call("Input.dispatchMouseEvent", event);
    }

    /// Drops a file on the middle of the window.
    pub fn drop(&mut self, file: &Path) {
        // The browser reads no path that goes up.
        let file = file.canonicalize().unwrap();
        let data = json!({"items": [], "files": [file], "dragOperationsMask": 1});
        for kind in ["dragEnter", "dragOver", "drop"] {
            let event = json!({"type": kind, "x": 300, "y": 300, "data": data});
            self.call("Input.dispatchDragEvent", event);
        }
    }

    /// Does what makes the page save a file, and returns its bytes.
    pub fn saved(&mut self, act: &str, name: &str) -> Vec<u8> {
        let folder = self.folder.path().join("saved");
        std::fs::create_dir_all(&folder).unwrap();
        let path = folder.join(name);
        let _ = std::fs::remove_file(&path);
        let session = self.session.take();
        let asked = json!({"behavior": "allow", "downloadPath": folder});
        self.call("Browser.setDownloadBehavior", asked);
        self.session = session;
        self.value(act);
        let began = Instant::now();
        while !path.exists() {
            assert!(began.elapsed() < PATIENCE, "{name} is not saved");
            std::thread::sleep(Duration::from_millis(50));
        }
        std::fs::read(path).unwrap()
    }

    /// Exceptions, and errors on the console, since the page was opened.
    pub fn errors(&mut self) -> Vec<String> {
        self.value("0");
        let is_error = |event: &&Value| match event["method"].as_str() {
            Some("Runtime.exceptionThrown") => true,
            Some("Runtime.consoleAPICalled") => event["params"]["type"] == "error",
            Some("Log.entryAdded") => event["params"]["entry"]["level"] == "error",
            _ => false,
        };
        self.events
            .iter()
            .filter(is_error)
            .map(Value::to_string)
            .collect()
    }

    /// Addresses that were asked for since the page was opened, but for the file itself and what the page made.
    pub fn requests(&mut self) -> Vec<String> {
        self.value("0");
        let asked = self.events.iter();
        let asked = asked.filter(|event| event["method"] == "Network.requestWillBeSent");
        let urls = asked.map(|event| event["params"]["request"]["url"].as_str().unwrap_or(""));
        let foreign = urls.filter(|url| !["file:", "blob:"].iter().any(|own| url.starts_with(own)));
        foreign.map(str::to_owned).collect()
    }
}

impl Drop for Browser {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
