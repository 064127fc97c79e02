# SPDX-License-Identifier: BSD-3-Clause
"""What the benchmarks page measures: each case in a process of its own, with a time limit."""
import json
import math
import os
import pathlib
import subprocess
import tempfile
import threading

import covariance_error

SPACINGS = 2.5  # correlation length over the mean spacing of the points: the least a mesh carries
FAMILIES = ("gaussian", "exponential", "matern", "self-affine", "stretched", "rational-quadratic")
COMPARED = ("gaussian", "exponential")
HERE = pathlib.Path(__file__).resolve().parent


def sizes(first, last):
    return [10 ** k for k in range(first, last + 1)]


FULL = {
    "families": FAMILIES,
    "lattice": sizes(3, 7), "cholesky": [1000, 3000, 10_000],
    "case_limit": 60,           # seconds that a case of the sweep may be expected to take
    "tolerances": (1e-2, 1e-3, 1e-4, 1e-5, 1e-6), "tolerance_points": 100_000,
    "compared": {"lattice": sizes(3, 6), "cholesky": sizes(3, 4), "hmat": sizes(3, 5),
                 "openturns_cholesky": sizes(3, 4), "gstools": sizes(3, 6)},
    "realizations": (200, 50),  # of the measured errors, up to 10^4 points and above
    "divisions": (408, 1291),   # of the spheres that the whole command roughens: 6 d^2 + 2 nodes
    "programs": ("bench_gather", "bench_noise", "bench_cholesky", "bench_paper_example",
                 "bench_read_msh", "bench_read_surface", "bench_move_volume", "bench_self_intersection"),
}
QUICK = {
    "families": COMPARED,
    "lattice": sizes(3, 5), "cholesky": [1000],
    "case_limit": 5,
    "tolerances": (1e-2, 1e-4), "tolerance_points": 10_000,
    "compared": {"lattice": [1000], "cholesky": [1000], "hmat": [1000],
                 "openturns_cholesky": [1000], "gstools": [1000]},
    "realizations": (50, 50),
    "divisions": (129,),
    "programs": (),
}


class Tools:
    """Where the programs are. An interpreter that is missing leaves its cases out."""

    def __init__(self, build, openturns_python, gstools_python):
        self.bin = pathlib.Path(build).resolve() / "bin"
        self.openturns = self.importing(openturns_python, "openturns")
        self.gstools = self.importing(gstools_python, "gstools")

    @staticmethod
    def importing(python, module):
        try:
            subprocess.run([python, "-c", f"import {module}"], check=True, capture_output=True)
        except (OSError, subprocess.CalledProcessError):
            print(f"{module}: not installed for {python}; its cases are left out", flush=True)
            return None
        return python


def last_line(text):
    lines = [line for line in text.splitlines() if line.strip()]
    return lines[-1] if lines else ""


def json_of(command, limit, known):
    """What the command prints as its last line, with what is known of the case; or why it failed."""
    print(" ".join(f"{key} {value}" for key, value in known.items()), flush=True)
    try:
        done = subprocess.run([str(word) for word in command], capture_output=True, text=True,
                              timeout=limit)
    except subprocess.TimeoutExpired:
        return {**known, "failed": f"more than {limit:.0f} s"}
    if done.returncode != 0:
        return {**known, "failed": last_line(done.stderr) or f"exit code {done.returncode}"}
    return {**known, **json.loads(last_line(done.stdout))}


def field_case(tools, method, family, n, limit, extra=()):
    command = [tools.bin / "bench_field", "--method", method, "--family", family, "--points", n,
               "--length", SPACINGS, *extra]
    return json_of(command, limit, {"tool": "roughmesh", "method": method, "family": family, "n": n})


def expected_seconds(case, n, power):
    return case["first_s"] * (n / case["n"]) ** power


def sweep_family(tools, method, family, ns, limit):
    """Ascending in N, until a case fails or the next would take too long."""
    cases, power = [], 1 if method == "lattice" else 3
    for n in ns:
        if cases and expected_seconds(cases[-1], n, power) > limit:
            break
        case = field_case(tools, method, family, n, 5 * limit)
        cases.append(case)
        if "failed" in case:
            break
    return cases


def sweep(tools, plan):
    return [case for method in ("lattice", "cholesky") for family in plan["families"]
            for case in sweep_family(tools, method, family, plan[method], plan["case_limit"])]


def tolerances(tools, plan):
    return [{**field_case(tools, "lattice", family, plan["tolerance_points"], 120,
                          ["--tolerance", tolerance]), "tolerance": tolerance}
            for family in plan["families"] for tolerance in plan["tolerances"]]


class Comparison:
    """All samplers on the points and pairs of one (family, N)."""

    def __init__(self, tools, plan, family, n, folder):
        self.tools, self.plan, self.family, self.n = tools, plan, family, n
        self.points, self.pairs = folder / "points", folder / "pairs.json"
        self.values = folder / "values"
        self.shared = ["--points-file", self.points, "--pairs-file", self.pairs]

    def realizations(self):
        return self.plan["realizations"][self.n > 10_000]

    def is_planned(self, name):
        return self.n in self.plan["compared"][name]

    def ours(self, method):
        case = field_case(self.tools, method, self.family, self.n, 300,
                          [*self.shared, "--values-file", self.values, "--realizations",
                           self.realizations()])
        if "failed" not in case:
            case["measured"] = covariance_error.measured_error_of_files(self.pairs, self.values)
        return case

    def theirs(self, python, script, tool, method, extra):
        length = SPACINGS * math.sqrt(4 * math.pi / self.n)
        command = [python, HERE / script, *self.shared, "--family", self.family,
                   "--length", repr(length), "--realizations", self.realizations(), *extra]
        return json_of(command, 300, {"tool": tool, "method": method, "family": self.family,
                                      "n": self.n})

    def openturns(self, method):
        rows = ["--rows", 20 if self.n <= 10_000 else 0]
        return self.theirs(self.tools.openturns, "compare_openturns.py", "OpenTURNS", method,
                           ["--method", method, *rows])

    def gstools(self):
        return self.theirs(self.tools.gstools, "compare_gstools.py", "GSTools", "RandMeth", [])

    def cases(self):
        """`lattice` always runs: it writes the points and the pairs."""
        result = [self.ours("lattice")]
        if self.is_planned("cholesky"):
            result.append(self.ours("cholesky"))
        if self.tools.openturns and self.is_planned("hmat"):
            result.append(self.openturns("hmat"))
        if self.tools.openturns and self.is_planned("openturns_cholesky"):
            result.append(self.openturns("cholesky"))
        if self.tools.gstools and self.is_planned("gstools"):
            result.append(self.gstools())
        return result


def compared(tools, plan):
    cases = []
    for family in COMPARED:
        for n in plan["compared"]["lattice"]:
            with tempfile.TemporaryDirectory() as folder:
                cases += Comparison(tools, plan, family, n, pathlib.Path(folder)).cases()
    return cases


def run_measured(command, limit):
    """Exit code, peak memory in bytes and stderr of a command; killed after `limit` seconds."""
    with tempfile.TemporaryFile("w+") as errors:
        process = subprocess.Popen([str(word) for word in command], stdout=subprocess.DEVNULL,
                                   stderr=errors)
        timer = threading.Timer(limit, process.kill)
        timer.start()
        _, status, usage = os.wait4(process.pid, 0)
        timer.cancel()
        process.returncode = os.waitstatus_to_exitcode(status)
        errors.seek(0)
        return process.returncode, usage.ru_maxrss * 1024, errors.read()


def roughen_sphere(tools, divisions, family, folder):
    """The whole command, file to file, on a sphere as binary PLY."""
    sphere, rough, report = folder / "sphere.ply", folder / "rough.ply", folder / "report.json"
    if not sphere.exists():
        subprocess.run([tools.bin / "make_sphere", str(divisions), sphere], check=True)
    n = 6 * divisions ** 2 + 2
    spacing = math.sqrt(4 * math.pi / n)
    print(f"roughmesh roughen, {family}, {n} nodes", flush=True)
    code, memory, errors = run_measured(
        [tools.bin / "roughmesh", "roughen", sphere, "-o", rough, "--report", report, "--acf", family,
         "--rms", 0.05 * spacing, "--length", SPACINGS * spacing, "--quiet"], 300)
    case = {"family": family, "n": n, "memory_bytes": memory}
    if code != 0:
        return {**case, "failed": last_line(errors) or f"exit code {code}"}
    with open(report) as file:
        made = json.load(file)
    return {**case, "timings": made["timings"], "input_bytes": sphere.stat().st_size}


def pipeline(tools, plan):
    cases = []
    for divisions in plan["divisions"]:
        with tempfile.TemporaryDirectory(dir=tools.bin.parent) as folder:
            cases += [roughen_sphere(tools, divisions, family, pathlib.Path(folder))
                      for family in COMPARED]
    return cases


def programs(tools, plan):
    """The text that each program prints."""
    outputs = {}
    for name in plan["programs"]:
        print(name, flush=True)
        try:
            done = subprocess.run([tools.bin / name], capture_output=True, text=True, timeout=400)
            outputs[name] = done.stdout or f"failed: {last_line(done.stderr)}\n"
        except (OSError, subprocess.TimeoutExpired) as error:
            outputs[name] = f"failed: {type(error).__name__}\n"
    return outputs
