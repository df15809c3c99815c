//! The pages of this program in a real browser, where there is one: `CHROMIUM`, or a Chromium or Chrome on the path.
//!
//! Drawing is done by the browser's software renderer, so no graphics card is needed. Without a browser the test says so
//! and passes.

mod synthetic;

use std::path::{Path, PathBuf};
use std::process::Command;

use synthetic::{Synthetic, Until};

fn browser() -> Option<PathBuf> {
    let given = std::env::var_os("CHROMIUM").map(PathBuf::from);
    let names = ["chromium", "chromium-browser", "google-chrome", "chrome"].map(PathBuf::from);
    let found = given.into_iter().chain(names).find(|name| {
        let output = Command::new(name).arg("--version").output();
        output.is_ok_and(|o| o.status.success())
    });
    if found.is_none() {
        println!("skipped: no Chromium (set CHROMIUM to its path)");
    }
    found
}

/// The page as it stands once its scripts have run; a message on the browser's console is a failure.
fn opened(browser: &Path, page: &Path, part: &str) -> String {
    let profile = tempfile::tempdir().unwrap();
    let output = Command::new(browser)
        .args(["--headless", "--no-sandbox", "--disable-gpu-sandbox", "--enable-logging=stderr"])
        .args(["--use-gl=angle", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
        .args(["--window-size=1200,900", "--virtual-time-budget=5000", "--dump-dom"])
        .arg(format!("--user-data-dir={}", profile.path().display()))
        .arg(format!("file://{}{part}", page.display()))
        .output()
        .unwrap();
    let log = String::from_utf8_lossy(&output.stderr);
    let said: Vec<&str> = log.lines().filter(|line| line.contains("CONSOLE")).collect();
    assert!(output.status.success() && said.is_empty(), "{said:?}");
    String::from_utf8(output.stdout).unwrap()
}

/// The value of an attribute of the canvas.
fn canvas<'a>(document: &'a str, attribute: &str) -> &'a str {
    let canvas = document.split("<canvas id=\"view3d\"").nth(1).expect("a canvas").split('>').next().unwrap();
    let value = canvas.split(&format!("{attribute}=\"")).nth(1);
    value.unwrap_or_else(|| panic!("{attribute} in {canvas}")).split('"').next().unwrap()
}

fn page_of(folder: &Path, synthetic: &Synthetic) -> PathBuf {
    synthetic.write(folder);
    let report = Command::new(env!("CARGO_BIN_EXE_yorp")).arg("report").arg(folder).output().unwrap();
    assert!(report.status.success());
    folder.join("report/index.html")
}

#[test]
fn the_view_is_drawn_and_follows_time() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let page = page_of(folder.path(), &Synthetic::default());
    // Without more it shows the latest configuration, with a link the one named.
    for (part, configuration) in [("", "11"), ("#configuration=3", "3")] {
        let document = opened(&browser, &page, part);
        assert!(canvas(&document, "data-lit").parse::<u32>().unwrap() > 500);
        assert_eq!(canvas(&document, "data-configuration"), configuration);
        assert!(document.contains(&format!("configuration {configuration} of 11 · ")), "{part}");
    }
}

#[test]
fn a_body_without_surface_is_drawn_and_a_strange_name_does_nothing() {
    let Some(browser) = browser() else { return };
    let folder = tempfile::tempdir().unwrap();
    let name = "<script>document.title = 'taken'</script>".to_owned();
    let page = page_of(folder.path(), &Synthetic { until: Until::Built, name, ..Synthetic::default() });
    let document = opened(&browser, &page, "");
    assert!(canvas(&document, "data-lit").parse::<u32>().unwrap() > 500);
    assert!(document.contains("<title>&lt;script&gt;") && document.contains("as constructed, not settled yet"));
}
