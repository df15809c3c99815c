//! `yorp report` as a user meets it: the page of whole and half-finished runs, of a run that goes on, and refusals.

mod synthetic;

use std::path::Path;
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

use synthetic::{Synthetic, Until};

fn yorp() -> Command {
    Command::new(env!("CARGO_BIN_EXE_yorp"))
}

fn report(run: &Path, more: &[&str]) -> Output {
    yorp().arg("report").arg(run).args(more).output().unwrap()
}

/// The page of a made-up run.
fn page_of(synthetic: &Synthetic) -> String {
    let folder = tempfile::tempdir().unwrap();
    synthetic.write(folder.path());
    let output = report(folder.path(), &[]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let page = folder.path().join("report/index.html");
    assert_eq!(String::from_utf8_lossy(&output.stdout).lines().next(), page.to_str());
    std::fs::read_to_string(page).unwrap()
}

/// The shapes that the page carries.
fn run_data(page: &str) -> serde_json::Value {
    let start = page.split_once("<script type=\"application/json\" id=\"run-data\">").expect("data").1;
    serde_json::from_str(start.split_once("</script>").expect("an end").0).unwrap()
}

#[test]
fn the_page_of_a_run_is_whole_and_needs_no_network() {
    let page = page_of(&Synthetic::default());
    assert!(page.starts_with("<!DOCTYPE html>") && page.trim_end().ends_with("</html>"));
    assert!(page.contains("<canvas id=\"view3d\"") && page.contains("type=\"range\""));
    for outside in ["http://", "https://", "src=", "@import", "url(", "<link", "<iframe"] {
        assert!(!page.contains(outside), "{outside}");
    }
    for section in ["type", "scene", "body", "intervals", "shed", "settling", "costs"] {
        assert!(page.contains(&format!("<section id=\"{section}\">")), "{section}");
    }
    let data = run_data(&page);
    let frames = data["frames"].as_array().unwrap();
    assert_eq!(frames.len(), 12);
    assert_eq!(frames[11]["configuration"], 11);
    assert!((frames[11]["t_myr"].as_f64().unwrap() - 0.55).abs() < 1e-12);
    // Leg 4 shed a sphere: configuration 5 lacks it.
    assert_eq!(frames[5]["gone"], serde_json::json!([119]));
    assert_eq!(frames[5]["lost"][0]["fate"], "escape");
    assert!(frames.iter().enumerate().all(|(i, f)| i == 5 || f["lost"] == serde_json::json!([])));
}

#[test]
fn the_page_is_the_same_on_any_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    Synthetic::default().write(folder.path());
    let page = |threads: &str| {
        assert!(report(folder.path(), &["--threads", threads]).status.success());
        std::fs::read(folder.path().join("report/index.html")).unwrap()
    };
    assert!(page("1") == page("3"));
}

#[test]
fn a_scene_named_like_a_script_stays_text() {
    let name = "<script>alert(1)</script>\" onload='x' </title>&amp;";
    let page = page_of(&Synthetic { name: name.into(), ..Synthetic::default() });
    let shown = "&lt;script&gt;alert(1)&lt;/script&gt;&quot; onload=&#39;x&#39; &lt;/title&gt;&amp;amp;";
    assert!(page.contains(&format!("<title>{shown}")) && page.contains(&format!("<h1>{shown}</h1>")));
    assert!(!page.contains("<script>alert"));
    // The scripts and the data, nothing else.
    assert_eq!((page.matches("<script").count(), page.matches("</script").count()), (2, 2));
}

#[test]
fn a_half_finished_run_gives_a_page_of_what_is_there() {
    let sections = |until| {
        let page = page_of(&Synthetic { until, ..Synthetic::default() });
        let ids = ["body", "settling", "intervals", "shed"];
        (page.clone(), ids.map(|id| page.contains(&format!("<section id=\"{id}\">"))))
    };
    let (begun, has) = sections(Until::Begun);
    assert_eq!(has, [false, false, false, false]);
    assert!(begun.contains("not built yet"));
    let (built, has) = sections(Until::Built);
    assert_eq!(has, [true, false, false, false]);
    assert_eq!(run_data(&built)["frames"][0]["configuration"], -1);
    assert_eq!(sections(Until::Settling).1, [true, true, false, false]);
    let (object_0, has) = sections(Until::Object0);
    assert_eq!(has, [true, true, false, false]);
    assert_eq!(run_data(&object_0)["frames"].as_array().unwrap().len(), 1);
    let (legs, has) = sections(Until::Legs);
    assert_eq!(has, [true, true, true, true]);
    assert!(legs.contains("--resume"));
}

#[test]
fn json_names_the_page_and_another_place_is_taken() {
    let folder = tempfile::tempdir().unwrap();
    let (run, out) = (folder.path().join("run"), folder.path().join("a/b"));
    Synthetic { until: Until::Object0, ..Synthetic::default() }.write(&run);
    let output = report(&run, &["--json", "--out", out.to_str().unwrap()]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["page"].as_str(), out.join("index.html").to_str());
    assert!(out.join("index.html").exists() && !run.join("report").exists());
}

#[test]
fn what_is_no_run_is_refused_with_2_and_nothing_is_written() {
    let folder = tempfile::tempdir().unwrap();
    let refused = |path: &Path, word: &str| {
        let output = report(path, &["--json"]);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(output.stdout.is_empty() && message.contains(word), "{message}");
        assert!(!path.join("report").exists());
    };
    refused(&folder.path().join("absent"), "absent");
    refused(folder.path(), "run");
    let foreign = folder.path().join("foreign");
    std::fs::create_dir(&foreign).unwrap();
    let database = rusqlite::Connection::open(foreign.join("run.sqlite")).unwrap();
    database.execute_batch("PRAGMA application_id = 5; CREATE TABLE t (x);").unwrap();
    refused(&foreign, "not a yorp run database");
}

#[test]
fn a_place_that_cannot_be_written_is_a_write_failure() {
    let folder = tempfile::tempdir().unwrap();
    let run = folder.path().join("run");
    Synthetic { until: Until::Object0, ..Synthetic::default() }.write(&run);
    std::fs::write(folder.path().join("file"), "").unwrap();
    // A file stands where the directory should be.
    let below = folder.path().join("file/report");
    let output = report(&run, &["--out", below.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(4), "{}", String::from_utf8_lossy(&output.stderr));
    // A directory stands where the page should be.
    std::fs::create_dir_all(run.join("report/index.html/x")).unwrap();
    let output = report(&run, &[]);
    assert_eq!(output.status.code(), Some(2), "{}", String::from_utf8_lossy(&output.stderr));
    assert!(run.join("report/index.html/x").exists());
}

fn wait_for(what: &str, holds: impl Fn() -> bool) {
    let start = Instant::now();
    while !holds() {
        assert!(start.elapsed() < Duration::from_secs(60), "{what}");
        std::thread::sleep(Duration::from_millis(50));
    }
}

#[cfg(unix)]
#[test]
fn a_watched_run_is_written_again_and_ctrl_c_leaves_a_page_that_rests() {
    let folder = tempfile::tempdir().unwrap();
    Synthetic { until: Until::Legs, ..Synthetic::default() }.write(folder.path());
    let page = folder.path().join("report/index.html");
    let read = || std::fs::read_to_string(&page).unwrap_or_default();
    let mut child = yorp()
        .args(["report", "--watch"])
        .arg(folder.path())
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .spawn()
        .unwrap();
    wait_for("the first page", || read().contains("data-fresh-every"));
    // A session begins: a transaction.
    let scene = yorp::report::RunData::read(folder.path()).unwrap().scene;
    drop(yorp::store::RunStore::open(folder.path(), &scene, true).unwrap());
    let sessions = |page: &str| page.split("Starts of the program").nth(1).map_or(0, |t| t.matches("<tr>").count());
    wait_for("the second page", || sessions(&read()) == 3);
    assert!(read().contains("http-equiv=\"refresh\""));
    let kill = Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert!(kill.success());
    assert_eq!(child.wait().unwrap().code(), Some(130));
    assert!(!read().contains("data-fresh-every") && !read().contains("http-equiv=\"refresh\""));
}

#[test]
fn watching_a_run_at_its_end_writes_once() {
    let folder = tempfile::tempdir().unwrap();
    Synthetic::default().write(folder.path());
    assert!(report(folder.path(), &["--watch"]).status.success());
    let page = std::fs::read_to_string(folder.path().join("report/index.html")).unwrap();
    assert!(!page.contains("data-fresh-every"));
}

#[test]
fn every_figure_is_a_file_and_stands_in_the_page_or_says_why_not() {
    let folder = tempfile::tempdir().unwrap();
    Synthetic::default().write(folder.path());
    let output = report(folder.path(), &["--json"]);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let page = std::fs::read_to_string(folder.path().join("report/index.html")).unwrap();
    let figures = value["figures"].as_array().unwrap();
    let names: Vec<&str> = figures.iter().map(|f| f["name"].as_str().unwrap()).collect();
    assert_eq!(names, ["spin", "torque", "shape", "movements", "losses", "walk", "error", "cost"]);
    for figure in figures {
        let svg = std::fs::read_to_string(figure["svg"].as_str().unwrap()).unwrap();
        assert!(svg.starts_with("<svg ") && svg.trim_end().ends_with("</svg>"));
        assert!(page.contains(&format!("<h3>{}</h3>", figure["title"].as_str().unwrap())));
        let png = std::fs::read(figure["png"].as_str().unwrap()).unwrap();
        assert_eq!(png[1..4], *b"PNG");
    }
    let spin = std::fs::read_to_string(figures[0]["svg"].as_str().unwrap()).unwrap();
    for words in ["Time (Myr)", "Spin rate (rev/day)", "Obliquity (deg)", "rigid body", "mass loss", "configuration"] {
        assert!(spin.contains(words), "{words}");
    }
    // Half a run: what there is nothing for is named, in the page too.
    let begun = tempfile::tempdir().unwrap();
    Synthetic { until: Until::Object0, ..Synthetic::default() }.write(begun.path());
    let output = report(begun.path(), &["--json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    assert_eq!(value["figures"][0]["name"], "torque");
    let left_out = value["left_out"].as_array().unwrap();
    let spin = left_out.iter().find(|m| m["name"] == "spin").unwrap();
    let page = std::fs::read_to_string(begun.path().join("report/index.html")).unwrap();
    assert!(page.contains(spin["reason"].as_str().unwrap()));
}

#[test]
fn several_runs_share_figures_with_their_names() {
    let folder = tempfile::tempdir().unwrap();
    let runs = ["first", "second<&>"].map(|name| {
        let run = folder.path().join(name.replace(['<', '&', '>'], ""));
        Synthetic { name: name.into(), ..Synthetic::default() }.write(&run);
        run
    });
    let out = folder.path().join("together");
    assert_eq!(report(&runs[0], &[runs[1].to_str().unwrap()]).status.code(), Some(2));
    let output = report(&runs[0], &[runs[1].to_str().unwrap(), "--out", out.to_str().unwrap(), "--json"]);
    let value: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
    let page = std::fs::read_to_string(value["page"].as_str().unwrap()).unwrap();
    assert!(page.contains("second&lt;&amp;&gt;") && page.contains("figures/together.csv") && !page.contains("<canvas"));
    let figures = value["figures"].as_array().unwrap();
    assert_eq!(figures.len(), 5);
    assert_eq!(figures[0]["name"], "together");
    for figure in figures {
        let svg = std::fs::read_to_string(figure["svg"].as_str().unwrap()).unwrap();
        assert!(svg.contains("first") && svg.contains("second&lt;&amp;&gt;"), "{}", figure["name"]);
    }
}
