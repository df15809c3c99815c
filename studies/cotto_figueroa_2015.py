"""The runs of Cotto-Figueroa et al. (2015): starts, resumes and lists them, and sets their tables beside the paper's.

    python3 studies/cotto_figueroa_2015.py run --jobs 2 --wall-minutes 60          # all scenes, as far as time allows
    python3 studies/cotto_figueroa_2015.py run 07=3 12=3 10-gravel=0.3             # these, to so many Myr
    python3 studies/cotto_figueroa_2015.py run --variant literal --set evolution.movement_rule='"literal"' 07 12
    python3 studies/cotto_figueroa_2015.py list
    python3 studies/cotto_figueroa_2015.py digest      # small tables from the databases, then the page
    python3 studies/cotto_figueroa_2015.py page        # the page from the small tables alone
    python3 studies/cotto_figueroa_2015.py compare out/a out/b                     # are two sets the same, byte for byte?

Databases are in out/cotto_figueroa_2015 (--out), one directory a run. Runs advance in small steps, the one that is furthest
behind first, so that the set can be stopped or killed at any moment and goes on with the same command; what has been
written never depends on where it was stopped. A directory that another instance works in is passed over. Needs nothing but Python.
"""

import argparse
import collections
import csv
import hashlib
import itertools
import json
import math
import pathlib
import resource
import signal
import sqlite3
import statistics
import subprocess
import sys
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parents[1]
TABLES = ROOT / "docs" / "results" / "cotto_figueroa_2015"
MYR_S = 3.15576e13

STANDARD = [f"{n:02}" for n in range(1, 17)]
HIGH = ["06h", "08h", "10h", "13h"]
SOFT = ["10-gravel", "10-glass-beads"]
GOALS_MYR = {**dict.fromkeys(STANDARD, 1.0), **dict.fromkeys(HIGH, 1.0), **dict.fromkeys(SOFT, 0.3)}


# ---------------------------------------------------------------- the paper's values

INF = math.inf
# Table 2: initial spin, rigid maximum, minimum, end, t_YC; aggregate maximum, minimum, end with its mark, t_sim, type.
TABLE_2 = {
    "01": (2.4, 9.1, 0.0, 0.0, 3.6, 4.7, 0.8, "0.8", 3.2, "MYC/Stg"),
    "02": (2.4, 8.3, 0.0, 0.0, 4.2, 4.8, 0.3, "0.3 ↘", 1.9, "MYC"),
    "03": (2.3, 7.3, 0.0, 0.0, 1.7, 5.6, 0.2, "0.2 ↘", 3.5, "MYC"),
    "04": (4.3, 13.7, 0.0, 0.0, 6.8, 6.2, 4.1, "4.1 ↔", 15.0, "Sto"),
    "05": (2.3, 8.3, 0.0, 0.0, 3.7, 6.2, 0.1, "0.1 ↘", 1.7, "MYC"),
    "06": (4.2, 26.8, 0.0, 0.0, 7.3, 6.0, 4.2, "4.7 ↔", 20.4, "Sto/SG"),
    "07": (4.2, 6.8, 0.0, 0.0, 1.1, 5.5, 0.6, "0.6", 2.5, "Sto/Stg"),
    "08": (3.9, 22.6, 0.0, 0.0, 16.0, 6.1, 3.9, "3.9 ↔", 2.5, "Sto/F"),
    "09": (3.8, 25.8, 0.0, 0.0, 9.4, 6.1, 0.5, "0.5 ↘", 3.3, "Sto"),
    "10": (4.2, 20.1, 0.0, 0.0, 5.3, 6.4, 4.2, "5.1 ↔", 15.0, "Sto"),
    "11": (4.8, 17.7, 0.0, 0.0, 6.9, 6.4, 4.3, "5.3 ↔", 30.0, "Sto/Stg"),
    "12": (4.6, 12.2, 0.0, 0.0, 3.2, 5.4, 3.8, "4.1 ↔", 15.1, "Sto/SG"),
    "13": (5.3, 11.7, 0.0, 0.0, 2.5, 5.9, 0.3, "0.3 ↘", 7.0, "Sto"),
    "14": (4.9, INF, 4.9, INF, INF, 5.6, 4.8, "5.4 ↔", 30.0, "Sto"),
    "15": (5.5, INF, 5.5, INF, INF, 6.1, 4.4, "4.5 ↔", 31.0, "Sto/SG/Stg"),
    "16": (5.7, 5.7, 0.0, 0.0, 2.9, 5.7, 0.0, "0.0", 1.2, "MYC"),
    "06h": (4.2, INF, 4.2, INF, INF, 6.0, 0.7, "0.7 ↘", 15.8, "Sto"),
    "08h": (3.9, 6.5, 0.0, 0.0, 4.8, 6.1, 3.4, "5.1 ↔", 13.5, "Sto"),
    "10h": (4.2, 25.5, 0.0, 0.0, 12.1, 6.6, 0.8, "0.8 ↔", 13.2, "Sto"),
    "13h": (5.3, INF, 5.2, INF, INF, 5.9, 3.9, "4.6 ↔", 30.0, "Sto"),
}
# Table 3: initial obliquity, rigid end, aggregate end with its mark, type.
TABLE_3 = {
    "01": (5, "90", "90", "MYC"),
    "02": (5, "90", "90", "MYC"),
    "03": (5, "90", "83 ↗", "Sto"),
    "04": (5, "90", "50 ↘", "Sto"),
    "05": (5, "90", "90", "MYC"),
    "06": (5, "90", "0", "Sto"),
    "07": (5, "90", "80", "MYC"),
    "08": (5, "90", "19 ↗", "Sto/F"),
    "09": (5, "90", "90", "Sto"),
    "10": (5, "90", "0", "Sto"),
    "11": (5, "90", "12 ↘", "Sto/Stg"),
    "12": (5, "90", "23 ↘", "Sto/SG"),
    "13": (5, "90", "90", "Sto"),
    "14": (5, "90", "6 ↘", "Sto"),
    "15": (5, "90", "30 ↘", "Sto/SG/Stg"),
    "16": (85, "86", "90", "MYC"),
    "06h": (5, "73", "66 ↘", "Sto"),
    "08h": (5, "86", "2 ↗", "Sto/Stg"),
    "10h": (5, "85", "2 ↗", "Sto/Stg"),
    "13h": (5, "85", "20.6 ↘", "Sto/Stg"),
}
# Table 4: events, mass lost (%), time between (Myr), density (g/cm^3), limit of a sphere, b/a, limit of a prolate body, spin.
TABLE_4 = {
    "04": (10, 7.0, 0.05, 1.42, 8.66, 0.76, 7.55, 5.69),
    "08": (10, 6.1, 0.01, 1.53, 8.99, 0.52, 6.45, 5.35),
    "10": (13, 6.3, 0.15, 1.46, 8.79, 0.91, 8.39, 5.73),
    "11": (18, 7.6, 1.71, 1.48, 8.86, 0.58, 6.72, 5.30),
    "15": (13, 5.1, 0.04, 1.57, 9.13, 0.71, 7.69, 5.88),
}
BEGIN, END = "<!-- tables: begin -->", "<!-- tables: end -->"
MARKS = {"increasing": " ↗", "decreasing": " ↘", "varying": " ↔", "constant": "", None: ""}


# ---------------------------------------------------------------- where the runs stand


class Run:
    """One run directory and the scene it belongs to."""

    def __init__(self, options, name):
        self.name = name
        self.directory = options.out / name
        base, _, self.variant = name.partition("+")
        self.base = base
        self.scene = options.scenes / f"{base}.json" if not self.variant else options.out / "scenes" / f"{name}.json"

    def status(self):
        """Stage, Myr, outcome, legs, movements, spheres lost, CPU seconds; None before there is a run."""
        database = self.directory / "run.sqlite"
        if not database.exists() or database.stat().st_size == 0:
            return None
        # Not mode=ro: the journal of a killed run has to be taken back by whoever comes first.
        connection = sqlite3.connect(f"{database.resolve().as_uri()}?mode=rw", uri=True, timeout=60)
        try:
            one = lambda sql: connection.execute(sql).fetchone()
            state = one("SELECT stage, t_s, outcome, leg FROM state")
            ending = one("SELECT t_s, outcome FROM ending")
            stage, t_s, outcome, legs = state or ("started", 0.0, None, 0)
            t_s = max(t_s, ending[0] if ending else 0.0)
            movements = one("SELECT count(*) FROM leg WHERE result = 'movement'")[0]
            lost = one("SELECT count(*) FROM loss WHERE leg >= 0")[0]
            cpu = one("SELECT total(cpu_seconds) FROM meta_session")[0]
        finally:
            connection.close()
        if ending and ending[1] != "until":
            outcome, stage = ending[1], "finished"
        return {"stage": stage, "myr": t_s / MYR_S, "outcome": outcome, "legs": legs, "movements": movements, "lost": lost, "cpu": cpu}


def chosen(options):
    """The runs and goals that were asked for: NAME or NAME=MYR."""
    goals = {}
    for word in options.names or [n for n in GOALS_MYR if (options.scenes / f"{n}.json").exists()]:
        name, _, myr = word.partition("=")
        if not (options.scenes / f"{name}.json").exists():
            sys.exit(f"{options.scenes / name}.json does not exist")
        try:
            goals[name] = float(myr) if myr else options.until_myr or GOALS_MYR.get(name, 1.0)
        except ValueError:
            sys.exit(f"{word}: NAME or NAME=MYR with a number of Myr is expected")
    if not options.variant:
        return {Run(options, name): goal for name, goal in goals.items()}
    runs = {}
    for name, goal in goals.items():
        run = Run(options, f"{name}+{options.variant}")
        scene = json.loads((options.scenes / f"{name}.json").read_text())
        scene["name"] = f"{scene.get('name', name)} {options.variant}"
        for change in options.set:
            path, _, value = change.partition("=")
            place = scene
            *folders, key = path.split(".")
            for folder in folders:
                place = place.setdefault(folder, {})
            place[key] = json.loads(value)
        text = json.dumps(scene, indent=2)
        if run.scene.exists() and run.scene.read_text() != text:
            sys.exit(f"{run.scene} has other settings; give this variant another name")
        run.scene.parent.mkdir(parents=True, exist_ok=True)
        run.scene.write_text(text)
        runs[run] = goal
    return runs


def existing(options):
    """All runs in the output directory: the paper's order, then variants."""
    names = [p.parent.name for p in options.out.glob("*/run.sqlite")]
    order = STANDARD + HIGH + SOFT
    rank = lambda name: (name.partition("+")[2], order.index(name.partition("+")[0]) if name.partition("+")[0] in order else 99, name)
    return [Run(options, name) for name in sorted(names, key=rank)]


def list_runs(options):
    print(f"{'run':<24}{'stage':<10}{'Myr':>9}{'legs':>7}{'moved':>7}{'lost':>6}{'CPU h':>8}{'h/Myr':>8}  outcome")
    for run in existing(options):
        try:
            s = run.status()
        except sqlite3.Error as error:
            print(f"{run.name:<24}{error}")
            continue
        if s is None:
            continue
        rate = f"{s['cpu'] / 3600 / s['myr']:.2f}" if s["myr"] > 0 else "-"
        print(
            f"{run.name:<24}{s['stage']:<10}{s['myr']:>9.4f}{s['legs']:>7}{s['movements']:>7}{s['lost']:>6}"
            f"{s['cpu'] / 3600:>8.2f}{rate:>8}  {s['outcome'] or ''}"
        )


# ---------------------------------------------------------------- running


class Scheduler:
    """Hands out the run that is furthest behind its goal; workers advance it by one step."""

    def __init__(self, options, goals):
        self.options, self.goals = options, goals
        self.deadline = time.time() + 60 * options.wall_minutes if options.wall_minutes else math.inf
        self.build = hashlib.sha256(options.yorp.read_bytes()).hexdigest()[:12]
        self.commit = git("rev-parse", "--short", "HEAD")
        self.lock = threading.Lock()
        self.working, self.failed, self.children, self.asked = set(), set(), set(), set()
        self.retry_at = {}
        self.stopping = False

    def over(self):
        used = resource.getrusage(resource.RUSAGE_CHILDREN)
        spent = self.options.cpu_hours and used.ru_utime + used.ru_stime > 3600 * self.options.cpu_hours
        return self.stopping or spent or time.time() >= self.deadline

    def next(self):
        """The next run with the time to bring it to; None when nothing is left to do now; False when all is done."""
        with self.lock:
            waiting, ready = False, []
            for run, goal in self.goals.items():
                if run in self.failed:
                    continue
                if run in self.working or self.retry_at.get(run, 0) > time.time():
                    waiting = True
                    continue
                try:
                    status = run.status() or {"myr": 0.0, "stage": "new"}
                except sqlite3.Error as error:
                    print(f"{run.name} cannot be read now: {error}", file=sys.stderr, flush=True)
                    self.retry_at[run] = time.time() + 10
                    continue
                if status["stage"] != "finished" and status["myr"] < goal * (1 - 1e-12):
                    ready.append((status["myr"] / goal, run.name, run, status["myr"], goal))
            if not ready:
                return None if waiting or any(t > time.time() for t in self.retry_at.values()) else False
            _, _, run, myr, goal = min(ready, key=lambda r: r[:2])
            self.working.add(run)
            step = self.options.step_myr
            return run, min(goal, (math.floor(myr / step + 1e-9) + 1) * step)

    def work(self):
        while not self.over():
            task = self.next()
            if task is False:
                return
            if task is None:
                time.sleep(0.5)
                continue
            try:
                self.advance(*task)
            finally:
                with self.lock:
                    self.working.discard(task[0])

    def advance(self, run, until):
        command = [self.options.yorp, "run", run.scene, "--out", run.directory, "--resume", "--until-myr", repr(until)]
        command += ["--threads", str(self.options.threads), "--json"]
        began = time.time()
        with self.lock:
            if self.stopping:
                return
            # A group of its own: Ctrl-C reaches this script, which asks the runs to stop.
            child = subprocess.Popen(
                [str(c) for c in command], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, start_new_session=True
            )
            self.children.add(child)
        out, err = child.communicate()
        with self.lock:
            self.children.discard(child)
        self.note(run, until, child.returncode, time.time() - began)
        if child.returncode == 0:
            result = json.loads(out)
            print(
                f"{time.strftime('%H:%M:%S')} {run.name:<20} {result['t_myr']:.4f} Myr, {result['legs']} legs, "
                f"{result['movements']} movements, {result['cpu_seconds'] / 3600:.2f} CPU h, {result['outcome']}",
                flush=True,
            )
        elif "in use by another" in err:
            self.retry_at[run] = time.time() + 10
        elif child.returncode != 130 and not self.stopping:
            self.failed.add(run)
            print(f"{run.name} failed ({child.returncode}) and is left alone:\n{err[-2000:]}", file=sys.stderr, flush=True)

    def note(self, run, until, code, seconds):
        row = {"run": run.name, "until_myr": until, "exit": code, "seconds": round(seconds, 1), "commit": self.commit, "build": self.build}
        with self.lock, (self.options.out / "sessions.jsonl").open("a") as file:
            file.write(json.dumps(row) + "\n")

    def stop(self, *_):
        self.stopping = True

    def interrupt(self):
        """Asks all children to save and end; once, because a second time ends them at once."""
        self.stopping = True
        with self.lock:
            for child in self.children - self.asked:
                child.send_signal(signal.SIGINT)
                self.asked.add(child)


def run_set(options):
    options.out.mkdir(parents=True, exist_ok=True)
    scheduler = Scheduler(options, chosen(options))
    for name in (signal.SIGINT, signal.SIGTERM):
        signal.signal(name, scheduler.stop)
    warn_of_other_builds(options, scheduler)
    workers = [threading.Thread(target=scheduler.work) for _ in range(options.jobs)]
    for worker in workers:
        worker.start()
    while any(worker.is_alive() for worker in workers):
        time.sleep(0.2)
        if scheduler.over():
            scheduler.interrupt()
    list_runs(options)
    sys.exit(3 if scheduler.failed else 0)


def warn_of_other_builds(options, scheduler):
    builds = collections.defaultdict(set)
    for session in sessions(options):
        builds[session["run"]].add(session["build"])
    mixed = [run.name for run in scheduler.goals if builds[run.name] - {scheduler.build}]
    if mixed:
        print(f"warning: begun with another build: {', '.join(mixed)}", file=sys.stderr)


def sessions(options):
    path = options.out / "sessions.jsonl"
    rows = path.read_text().splitlines() if path.exists() else []
    parsed = []
    for row in rows:
        try:
            parsed.append(json.loads(row))
        except ValueError:
            pass  # the last line of a killed instance
    return parsed


def git(*arguments):
    found = subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True)
    return found.stdout.strip() if found.returncode == 0 else "unknown"


def compare(options):
    """Whether two sets hold the same runs: all tables but meta_*, byte for byte."""

    def contents(database):
        connection = sqlite3.connect(f"{database.resolve().as_uri()}?mode=rw", uri=True, timeout=60)
        names = [n for (n,) in connection.execute("SELECT name FROM sqlite_schema WHERE type = 'table' ORDER BY name")]
        digest = {n: hashlib.sha256(repr(connection.execute(f"SELECT * FROM {n}").fetchall()).encode()).hexdigest() for n in names if not n.startswith(("meta_", "sqlite_"))}
        connection.close()
        return digest

    left, right = (pathlib.Path(p) for p in options.names)
    names = sorted({p.parent.name for side in (left, right) for p in side.glob("*/run.sqlite")})
    differ = []
    for name in names:
        a, b = (side / name / "run.sqlite" for side in (left, right))
        if not (a.exists() and b.exists()):
            differ.append(f"{name}: only in {left if a.exists() else right}")
            continue
        x, y = contents(a), contents(b)
        tables = [t for t in sorted(x.keys() | y.keys()) if x.get(t) != y.get(t)]
        if tables:
            differ.append(f"{name}: {', '.join(tables)}")
    print("\n".join(differ) if differ else f"{len(names)} runs, all the same")
    sys.exit(1 if differ or not names else 0)


# ---------------------------------------------------------------- small tables


def digest(options):
    """Writes what the page needs: runs.json, intervals.csv, losses.csv, movements.csv."""
    tables = options.tables
    tables.mkdir(parents=True, exist_ok=True)
    runs, intervals, losses, depths = [], [], [], []
    commits = collections.defaultdict(set)
    for session in sessions(options):
        commits[session["run"]].add(session["commit"])
    for run in existing(options):
        if options.names and run.name not in options.names:
            continue
        command = [str(options.yorp), "classify", str(run.directory), "--json"]
        answer = subprocess.run(command, stdout=subprocess.PIPE)
        if answer.returncode != 0:
            print(f"{run.name} is left out", file=sys.stderr)
            continue
        found = json.loads(answer.stdout)
        for i in found["walk"].pop("intervals"):
            intervals.append([run.name, i["from_myr"], i["length_myr"], *i["spin_rev_day"], *i["obliquity_deg"], i["alpha_s"], i["zeta_s"]])
        for e in found["losses"].pop("events"):
            losses.append({"run": run.name, **e})
        depths.append([run.name, *found["movements"].pop("by_enclosed_mass")])
        criteria = found.pop("criteria")
        scene = json.loads(run.scene.read_text()) if run.variant and run.scene.exists() else None
        runs.append({"run": run.name, **rounded(found), "commits": sorted(commits[run.name]), "scene": scene})
    everything = {"criteria": criteria if runs else None, "runs": runs}
    (tables / "runs.json").write_text(json.dumps(everything, indent=1) + "\n")
    write_csv(tables / "intervals.csv", ["run", "from_myr", "length_myr", "spin0_rev_day", "spin1_rev_day", "obliquity0_deg", "obliquity1_deg", "alpha_s_rev_day_myr", "zeta_s_deg_myr"], intervals)
    columns = list(losses[0]) if losses else ["run"]
    write_csv(tables / "losses.csv", columns, [[e[c] for c in columns] for e in losses])
    write_csv(tables / "movements.csv", ["run", *(f"to_{5 * (k + 1)}_percent" for k in range(20))], depths)
    page(options)


def rounded(value):
    """Numbers to six digits, so that the tables stay small."""
    if isinstance(value, float):
        return float(f"{value:.6g}")
    if isinstance(value, dict):
        return {k: rounded(v) for k, v in value.items()}
    return [rounded(v) for v in value] if isinstance(value, list) else value


def write_csv(path, columns, rows):
    show = lambda v: f"{v:.6g}" if isinstance(v, float) else "" if v is None else v
    with path.open("w", newline="") as file:
        writer = csv.writer(file, lineterminator="\n")
        writer.writerow(columns)
        writer.writerows([show(v) for v in row] for row in rows)


def read_csv(path):
    number = lambda text: float(text) if text not in ("", "True", "False") else {"True": True, "False": False}.get(text)
    with path.open(newline="") as file:
        return [{k: v if k == "run" else number(v) for k, v in row.items()} for row in csv.DictReader(file)]


# ---------------------------------------------------------------- the page


def page(options):
    tables = options.tables
    everything = json.loads((tables / "runs.json").read_text())
    runs = everything["runs"]
    intervals, losses = read_csv(tables / "intervals.csv"), read_csv(tables / "losses.csv")
    groups = grouped(runs)
    parts = [set_part(runs)]
    for title, names in (("Standard resolution", STANDARD), ("High resolution", HIGH)):
        rows = [r for r in runs if r["run"] in names]
        if rows:
            parts += [table_2(rows, title), table_3(rows, title)]
    parts += [table_4(runs)]
    parts += [items(groups, intervals, losses), rates_part(intervals), variants_part(groups, intervals)]
    kept = [r for r in runs if "+" not in r["run"]]
    parts += [bodies_part(kept), reasons_part(kept)]
    text = "\n".join(parts)
    if not options.markdown:
        print(text)
        return
    # What stands outside the two marks is kept.
    old = options.markdown.read_text() if options.markdown.exists() else f"{BEGIN}\n{END}\n"
    if BEGIN not in old or END not in old:
        sys.exit(f"{options.markdown} has no lines {BEGIN} and {END} to write between")
    options.markdown.write_text(old[: old.index(BEGIN)] + f"{BEGIN}\n\n{text}\n" + old[old.index(END) :])


def grouped(runs):
    """Standard, high resolution, soft spheres, and each variant."""
    groups = {}
    for title, names in (("standard", STANDARD), ("high resolution", HIGH), ("soft spheres", SOFT)):
        groups[title] = [r for r in runs if r["run"] in names]
    for r in runs:
        variant = r["run"].partition("+")[2]
        if variant:
            groups.setdefault(variant, []).append(r)
    return {title: rows for title, rows in groups.items() if rows}


def markdown(header, rows):
    line = lambda cells: "| " + " | ".join(str(c) for c in cells) + " |"
    return "\n".join([line(header), line(["---"] * len(header)), *(line(row) for row in rows)]) + "\n"


def spin(value):
    return "-" if value is None else "Inf." if value == INF else f"{value:.1f}"


def evolved(runs):
    return [r for r in runs if r["aggregate"]]


def set_part(runs):
    rows = []
    for r in runs:
        c = r["cost"]
        each = lambda v: "-" if v is None else f"{v:.2f}"
        rate = f"{c['cpu_seconds'] / 3600 / r['t_myr']:.2f}" if r["t_myr"] > 0 else "-"
        rows.append([
            r["run"], f"{r['t_myr']:.3f}", (r["outcome"] or "goes on").replace("_", " "), c["checks"] + c["movements"], r["movements"]["count"],
            each(c["cpu_seconds_per_check"]), each(c["cpu_seconds_per_movement"]), f"{c['cpu_seconds'] / 3600:.2f}", f"{c['seconds'] / 3600:.2f}", rate, " ".join(r["commits"]) or "-",
        ])
    header = ["run", "Myr", "ended", "hand-offs", "movements", "CPU s a check", "CPU s a movement", "CPU h", "wall h", "CPU h a Myr", "commit"]
    total = sum(r["cost"]["cpu_seconds"] for r in runs) / 3600
    text = f"{len(runs)} runs, {sum(r['t_myr'] for r in runs):.2f} Myr together, {total:.1f} CPU hours. A check is a hand-off in which nothing moved.\n"
    return "## The runs\n\n" + text + "\n" + markdown(header, rows)


def table_2(runs, title):
    rows = []
    for r in evolved(runs):
        a, g = r["aggregate"], r["rigid"]
        inf = g["end"] == "infinite_spin_up"
        cycle = "Inf." if inf else "-" if g["cycle_time_myr"] is None else f"{g['cycle_time_myr']:.1f}"
        rows.append([
            r["run"], spin(a["initial_spin_rev_day"]), spin(INF if inf else g["max_spin_rev_day"]), spin(g["min_spin_rev_day"]),
            spin(INF if inf else g["end_spin_rev_day"]), cycle, spin(a["max_spin_rev_day"]), spin(a["min_spin_rev_day"]),
            spin(a["end_spin_rev_day"]) + MARKS[r["spin"]["trend"]], f"{r['t_myr']:.2f}", r["spin"]["type"] or "-",
        ])
        p = TABLE_2[r["run"]]
        italic = [f"*{v}*" for v in (spin(p[0]), spin(p[1]), spin(p[2]), spin(p[3]), spin(p[4]), spin(p[5]), spin(p[6]), p[7], spin(p[8]), p[9])]
        rows.append(["*paper*", *italic])
    header = ["simulation", "initial", "rigid max", "min", "end", "t_YC", "aggregate max", "min", "end", "t_sim", "type"]
    return f"## Table 2: spin rate, {title.lower()}\n\nRevolutions a day and Myr.\n\n" + markdown(header, rows)


def table_3(runs, title):
    rows = []
    for r in evolved(runs):
        a = r["aggregate"]
        rows.append([
            r["run"], f"{a['initial_obliquity_deg']:.0f}", f"{r['rigid']['end_obliquity_deg']:.0f}",
            f"{a['end_obliquity_deg']:.1f}" + MARKS[r["obliquity"]["trend"]], r["obliquity"]["type"] or "-",
        ])
        p = TABLE_3[r["run"]]
        rows.append(["*paper*", *(f"*{v}*" for v in p)])
    header = ["simulation", "initial", "rigid end", "aggregate end", "type"]
    return f"## Table 3: obliquity, {title.lower()}\n\nDegrees.\n\n" + markdown(header, rows)


def table_4(runs):
    rows = []
    for r in runs:
        losses = r["losses"]
        count = losses["event_mass_percent"]["count"]
        if count:
            density, b_over_a = losses["density_kg_m3"]["mean"] / 1000, losses["b_over_a"]["mean"]
            between = losses["mean_time_between_myr"]
            sphere = 7.2707 * math.sqrt(density)
            rows.append([
                r["run"], count, f"{losses['mass_percent']:.1f}", "-" if between is None else f"{between:.2f}", f"{density:.2f}", f"{sphere:.2f}",
                f"{b_over_a:.2f}", f"{sphere * math.sqrt(b_over_a):.2f}", f"{losses['spin_rev_day']['mean']:.2f}",
            ])
        if r["run"] in TABLE_4:
            p = TABLE_4[r["run"]]
            if not count:
                rows.append([r["run"], 0, *["-"] * 7])
            rows.append(["*paper*", *(f"*{v}*" for v in p)])
    header = ["simulation", "events", "mass, %", "time between, Myr", "density, g/cm^3", "limit of a sphere", "b/a", "limit of a prolate body", "spin at the events"]
    note = "Spins in revolutions a day; density by the hull of the spheres, b/a by their half extents. Bodies that neither of us saw lose mass are left out.\n"
    return "## Table 4: mass loss\n\n" + note + "\n" + markdown(header, rows)


def items(groups, intervals, losses):
    """What the paper states in sections 3.1 to 3.5, for every group of runs but variants."""
    columns = {}
    for title in [t for t in ("standard", "high resolution", "soft spheres") if t in groups]:
        columns[title] = item_values(groups[title], intervals, losses)
        names = {"standard": STANDARD, "high resolution": HIGH}.get(title)
        if names:
            columns[f"*{title}, paper*"] = paper_values(names)
    rows = [[name, *(column[k] for column in columns.values())] for k, name in enumerate(ITEMS)]
    note = "Counts are of the runs that have evolved, over the times above.\n"
    return "## Side by side\n\n" + note + "\n" + markdown(["", *columns], rows)


ITEMS = [
    "runs, mean length in Myr",
    "ever above 6.6 rev/day",
    "largest spin, rev/day",
    "as rigid bodies above 12 rev/day",
    "largest spin over the rigid body's, median",
    "self-limited (spin not MYC)",
    "spin: Sto, MYC, SG, Stg, F",
    "obliquity: Sto, MYC, SG, Stg, F",
    "bodies losing mass",
    "spin at loss, rev/day: range, mean",
    "mass of an event, %",
    "events below the Jacobi sequence",
    "shed spheres that escaped, fell back, stayed in orbit, merged",
    "movements a Myr",
    "spheres in a movement: median, mean",
    "interval between movements, kyr: quartiles",
    "spin changes, rev/day/Myr: first third of a run, last third",
    "intervals that go on in spin (P+)",
    "intervals that go on in obliquity (P+)",
    "movement in the inner half, %: range over bodies, mean",
    "movement in the outer tenth, %: range over bodies, mean",
    "c/a decreases (half extents; equivalent ellipsoid)",
    "bodies losing mass that become flatter and more prolate",
    "MYC bodies that become less prolate",
]
KINDS = ["Sto", "MYC", "SG", "Stg", "F"]


def paper_values(names):
    """The same of the paper: its tables where they say it, else the text of its sections 3.2 to 3.5 (16 bodies)."""
    rows = [TABLE_2[name] for name in names]
    count = lambda types: ", ".join(str(sum(kind in t for t in types)) for kind in KINDS)
    of = lambda condition: f"{sum(map(condition, rows))} of {len(rows)}"
    text = ["5.2 to 6.3, 5.6", "0.1 to 2.0", "all", "-", "-", "-", "a few 10", "-", "slightly over half", "slightly over half", "25 to 40", "15 to 25", "13 of 16", "5 of 5", "5 of 5"]
    return [
        f"{len(rows)}, {statistics.mean(r[8] for r in rows):.2f}",
        of(lambda r: r[5] > 6.6),
        f"{max(r[5] for r in rows):.1f}",
        of(lambda r: r[1] > 12),
        f"{statistics.median(r[5] / r[1] for r in rows):.2f}",
        of(lambda r: "MYC" not in r[9]),
        count([r[9].split("/") for r in rows]),
        count([TABLE_3[name][3].split("/") for name in names]),
        *(["5 of 16", *text] if names is STANDARD else ["-"] * (len(text) + 1)),
    ]


def item_values(runs, intervals, losses):
    all_runs, runs = runs, evolved(runs)
    if not runs:
        return ["-"] * len(ITEMS)
    names = {r["run"] for r in runs}
    n = len(runs)
    of = lambda count, total=n: f"{count} of {total}"
    kinds = lambda what: ", ".join(str(sum(kind in r[what]["type"].split("/") for r in runs)) for kind in KINDS)
    rigid_max = lambda r: INF if r["rigid"]["max_spin_rev_day"] is None else r["rigid"]["max_spin_rev_day"]
    ratios = [r["aggregate"]["max_spin_rev_day"] / rigid_max(r) for r in runs]
    events = [e for e in losses if e["run"] in names and not e["breakup"]]
    losing = [r for r in runs if any(e["run"] == r["run"] for e in events)]
    spread = lambda values, form: "-" if not values else f"{min(values):{form}} to {max(values):{form}}"
    lengths = [1000 * i["length_myr"] for i in intervals if i["run"] in names]
    quartiles = ", ".join(f"{q:.0f}" for q in statistics.quantiles(lengths, method="inclusive")) if len(lengths) > 1 else "-"

    def persistence(column):
        rates = [i[column] for i in intervals if i["run"] in names and i[column] is not None]
        if not rates:
            return "-"
        share = sum(math.copysign(1, rate) > 0 for rate in rates) / len(rates)
        return f"{share:.2f} ± {math.sqrt(share * (1 - share) / len(rates)):.2f}"

    def depth(key):
        shares = [100 * r["movements"][key] for r in runs if r["movements"][key] is not None]
        moved = sum(r["movements"]["spheres_moved"] for r in runs)
        mean = sum((r["movements"][key] or 0) * r["movements"]["spheres_moved"] for r in runs) / moved if moved else 0
        return f"{spread(shares, '.0f')}, {100 * mean:.0f}" if shares else "-"

    def change(r, how, key):
        start, end = r["shape"]["start"][how], r["shape"]["end"][how]
        return None if start[key] is None or end[key] is None else end[key] - start[key]

    flatter = lambda how: sum(change(r, how, "c_over_a") < 0 for r in runs)
    more = lambda r: (change(r, "half_extents", "triaxiality") or 0) > 0
    cycles = [r for r in runs if "MYC" in r["spin"]["type"].split("/")]
    spins = [e["spin_rev_day"] for e in events]
    return [
        f"{len(all_runs)}, {statistics.mean(r['t_myr'] for r in all_runs):.2f}",
        of(sum(r["aggregate"]["max_spin_rev_day"] > 6.6 for r in runs)),
        f"{max(r['aggregate']['max_spin_rev_day'] for r in runs):.1f}",
        of(sum(rigid_max(r) > 12 for r in runs)),
        f"{statistics.median(ratios):.2f}",
        of(sum(bool(r["self_limited"]) for r in runs)),
        kinds("spin"),
        kinds("obliquity"),
        of(len(losing)),
        f"{spread(spins, '.1f')}, {statistics.mean(spins):.1f}" if spins else "-",
        spread([e["mass_percent"] for e in events], ".1f"),
        of(sum(bool(e["below_jacobi"]) for e in events), len(events)) if events else "-",
        ", ".join(str(sum(r["losses"]["fates"][fate] for r in runs)) for fate in ("escape", "reimpact", "bound", "merged")) if events else "-",
        f"{sum(r['movements']['count'] for r in runs) / sum(r['t_myr'] for r in runs):.0f}",
        sizes(runs),
        quartiles,
        thirds(runs, intervals),
        persistence("alpha_s_rev_day_myr"),
        persistence("zeta_s_deg_myr"),
        depth("inner_half"),
        depth("outer_tenth"),
        f"{of(flatter('half_extents'))}; {flatter('equivalent_ellipsoid')}",
        of(sum(change(r, "half_extents", "c_over_a") < 0 and more(r) for r in losing), len(losing)) if losing else "-",
        of(sum(not more(r) for r in cycles), len(cycles)) if cycles else "-",
    ]


def sizes(runs):
    """Medians differ from body to body: their range, and the mean over all movements."""
    medians = [r["movements"]["spheres"]["median"] for r in runs if r["movements"]["count"]]
    if not medians:
        return "-"
    mean = sum(r["movements"]["spheres_moved"] for r in runs) / sum(r["movements"]["count"] for r in runs)
    return f"{min(medians):.0f} to {max(medians):.0f}, {mean:.0f}"


def thirds(runs, intervals):
    """How fast the spin changes, up or down, at first and in the end: a stagnating body slows down. Mean over bodies."""
    rates = []
    for r in runs:
        third = r["t_myr"] / 3
        mine = [i for i in intervals if i["run"] == r["run"]]
        for k in (0, 2):
            part = [i for i in mine if k * third <= i["from_myr"] + i["length_myr"] / 2 < (k + 1) * third]
            length = sum(i["length_myr"] for i in part)
            rates.append(sum(abs(i["spin1_rev_day"] - i["spin0_rev_day"]) for i in part) / length if length else None)
    mean = lambda values: f"{statistics.mean(values):.2f}" if values else "-"
    return ", ".join(mean([v for v in rates[k::2] if v is not None]) for k in (0, 1))


def changes_of_rate(intervals, names):
    """Intervals of these runs that another follows, with the rate of the spin in it and in the next, rev/day/Myr."""
    mine = [i for i in intervals if i["run"] in names and i["length_myr"] > 0]
    rate = lambda i: (i["spin1_rev_day"] - i["spin0_rev_day"]) / i["length_myr"]
    return [(one, rate(one), rate(other)) for one, other in zip(mine, mine[1:]) if one["run"] == other["run"]]


def rates_part(intervals):
    """What a movement does to the rate of the spin, by that rate before it: slow ones last, and only they turn round."""
    pairs = changes_of_rate(intervals, STANDARD)
    rows = []
    for low, high in itertools.pairwise([0, 0.5, 1, 2, 4, 8, INF]):
        within = [(i, before, after) for i, before, after in pairs if low <= abs(before) < high]
        if within:
            rows.append([
                f"{low} to {high}" if high < INF else f"above {low}", len(within),
                f"{1000 * statistics.median(i['length_myr'] for i, _, _ in within):.1f}",
                f"{statistics.median(abs(after - before) for _, before, after in within):.2f}",
                sum(before * after < 0 for _, before, after in within),
            ])
    header = ["rate before the movement, rev/day/Myr", "intervals", "median length, kyr", "change at the movement, median", "turned round"]
    return "## Intervals by the rate at which the spin changes\n\nStandard resolution.\n\n" + markdown(header, rows)


def variants_part(groups, intervals):
    """Changed copies of some scenes, all of them together."""
    rows = []
    for title in [t for t in groups if t not in ("standard", "high resolution", "soft spheres")]:
        runs = groups[title]
        names = {r["run"] for r in runs}
        lengths = [1000 * i["length_myr"] for i in intervals if i["run"] in names]
        pairs = changes_of_rate(intervals, names)
        middle = lambda values, form: f"{statistics.median(values):{form}}" if values else "-"
        movements, moved = sum(r["movements"]["count"] for r in runs), sum(r["movements"]["spheres_moved"] for r in runs)
        share = lambda key: f"{100 * sum((r['movements'][key] or 0) * r['movements']['spheres_moved'] for r in runs) / moved:.0f}" if moved else "-"
        cpu = sum(r["cost"]["cpu_seconds"] for r in runs)
        rows.append([
            title, " ".join(r["run"].partition("+")[0] for r in runs), f"{sum(r['t_myr'] for r in runs):.2f}", movements, moved,
            f"{moved / movements:.0f}" if movements else "-", share("inner_half"), share("outer_tenth"), middle(lengths, ".0f"),
            middle([100 * abs(b / a - 1) for _, a, b in pairs if a], ".0f"), sum(a * b < 0 for _, a, b in pairs),
            f"{max((r['aggregate']['max_spin_rev_day'] for r in evolved(runs)), default=0):.1f}", f"{cpu:.0f}",
        ])
    if not rows:
        return ""
    header = ["variant", "bodies", "Myr", "movements", "spheres moved", "a movement, mean", "inner half, %", "outer tenth, %", "median interval, kyr", "rate changes by, %", "turned round", "largest spin", "CPU s"]
    return "## Suspects varied\n\nThe same bodies over the same time.\n\n" + markdown(header, rows)


def bodies_part(runs):
    number = lambda v, form: "-" if v is None else f"{v:{form}}"
    rows = []
    for r in runs:
        start, end = r["shape"]["start"], r["shape"]["end"]
        if not start:
            continue
        ratios = lambda p: f"{p['b_over_a']:.3f}, {p['c_over_a']:.3f}, {number(p['triaxiality'], '.2f')}"
        m, w = r["movements"], r["walk"]
        kyr = lambda v: number(None if v is None else 1000 * v, ".1f")
        rows.append([
            r["run"], ratios(start["half_extents"]), ratios(end["half_extents"]), number(r["shape"]["lowest_over_jacobi"], ".2f"), m["count"],
            number(m["spheres"]["median"], ".0f"), number(m["spheres"]["largest"], ".0f"), number(m["inner_half"], ".2f"), number(m["outer_tenth"], ".2f"),
            kyr(w["length_myr"]["median"]), number(w["spin_persistence"], ".2f"), number(w["obliquity_persistence"], ".2f"),
        ])
    header = ["run", "b/a, c/a, T at the start", "at the end", "lowest c/a over Jacobi's", "movements", "spheres, median", "largest", "inner half", "outer tenth", "median interval, kyr", "P+ spin", "P+ obliquity"]
    return "## Bodies\n\nAxis ratios by the half extents; T is the triaxiality.\n\n" + markdown(header, rows)


def reasons_part(runs):
    lines = []
    for r in evolved(runs):
        for quantity in ("spin", "obliquity"):
            for s in r[quantity]["stretches"]:
                lines.append([r["run"], quantity, s["kind"], f"{s['from_myr']:.3f} to {s['to_myr']:.3f}", s["why"]])
    return "## Why each type was given\n\n" + markdown(["run", "quantity", "type", "Myr", "why"], lines)


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("what", choices=["run", "list", "digest", "page", "compare"])
    parser.add_argument("names", nargs="*", help="scenes, NAME or NAME=MYR; two directories for compare")
    parser.add_argument("--out", type=pathlib.Path, default=ROOT / "out" / "cotto_figueroa_2015")
    parser.add_argument("--scenes", type=pathlib.Path, default=ROOT / "scenarios" / "cotto_figueroa_2015")
    parser.add_argument("--yorp", type=pathlib.Path, default=ROOT / "target" / "release" / "yorp")
    parser.add_argument("--tables", type=pathlib.Path, default=TABLES, help="folder of the small tables")
    parser.add_argument("--markdown", type=pathlib.Path, help="write the page there, between its two marks, instead of to stdout")
    parser.add_argument("--until-myr", type=float, help="goal of every run that has none of its own")
    parser.add_argument("--step-myr", type=float, default=0.05, help="how far a run is brought before the next has its turn")
    parser.add_argument("--jobs", type=int, default=1, help="runs at a time")
    parser.add_argument("--threads", type=int, default=1, help="threads of each run")
    parser.add_argument("--wall-minutes", type=float, help="stop and save after that time")
    parser.add_argument("--cpu-hours", type=float, help="begin no step after that CPU time of this instance")
    parser.add_argument("--variant", help="name of changed copies of the scenes")
    parser.add_argument("--set", action="append", default=[], metavar="PATH=JSON", help="a change of a variant's scenes")
    options = parser.parse_intermixed_args()
    {"run": run_set, "list": list_runs, "digest": digest, "page": page, "compare": compare}[options.what](options)


main()
