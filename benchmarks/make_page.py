# SPDX-License-Identifier: BSD-3-Clause
"""Runs the benchmarks and writes the page: benchmarks.md and benchmarks.svg (./dev bench)."""
import argparse
import datetime
import json
import os
import pathlib
import platform
import re
import subprocess
import time

import bench_cases
import log_plot
import page_text

ROOT = pathlib.Path(__file__).resolve().parent.parent


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--build", type=pathlib.Path, default=ROOT / "build/release")
    parser.add_argument("--openturns-python", default="/usr/bin/python3")
    parser.add_argument("--gstools-python", default=str(ROOT / "build/gstools/bin/python"))
    parser.add_argument("--quick", action="store_true", help="small cases; the page goes to --results")
    parser.add_argument("--results", type=pathlib.Path, default=ROOT / "build/bench",
                        help="folder of the raw figures")
    parser.add_argument("--only-page", action="store_true", help="from the raw figures of the last run")
    return parser.parse_args()


def first_match(path, pattern):
    try:
        found = re.search(pattern, pathlib.Path(path).read_text(), re.MULTILINE)
    except OSError:
        return None
    return found and found.group(1)


def first_line_of(*command):
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.split("\n")[0]
    except (OSError, subprocess.CalledProcessError):
        return "unknown"


def processor():
    return first_match("/proc/cpuinfo", r"^model name\s*:\s*(.*)$") or platform.processor()


def compiler(build):
    path = first_match(build / "CMakeCache.txt", r"^CMAKE_CXX_COMPILER:\w+=(.*)$")
    return first_line_of(path or "c++", "--version")


def machine(build):
    """What matters of the machine, without its name or folders."""
    kilobytes = int(first_match("/proc/meminfo", r"^MemTotal:\s*(\d+)") or 0)
    return {"processor": f"{processor()}, {os.cpu_count()} cores",
            "memory": f"{kilobytes * 1024e-9:.0f} GB",
            "system": first_match("/etc/os-release", r'^PRETTY_NAME="(.*)"$') or platform.system(),
            "compiler": compiler(build),
            "roughmesh": first_line_of(str(build / "bin/roughmesh"), "--version"),
            "date": datetime.date.today().isoformat(),
            "load before the run": f"{os.getloadavg()[0]:.1f}"}


def tool_versions(cases):
    versions = {}
    for case in cases:
        if "version" in case:
            core = f", gstools_core {case['core']}" if case.get("core") else ""
            versions[case["tool"]] = case["version"] + core
    return versions


def measure(options):
    tools = bench_cases.Tools(options.build, options.openturns_python, options.gstools_python)
    plan = bench_cases.QUICK if options.quick else bench_cases.FULL
    start = time.monotonic()
    results = {"machine": machine(options.build), "tolerance_points": plan["tolerance_points"],
               "compared": bench_cases.compared(tools, plan),
               "sweep": bench_cases.sweep(tools, plan),
               "tolerances": bench_cases.tolerances(tools, plan),
               "pipeline": bench_cases.pipeline(tools, plan),
               "programs": bench_cases.programs(tools, plan)}
    results["machine"].update(tool_versions(results["compared"]))
    results["machine"]["the run took"] = f"{(time.monotonic() - start) / 60:.0f} minutes"
    return results


def write_page(results, folder):
    (folder / "benchmarks.md").write_text(page_text.page(results))
    plot = log_plot.plot(page_text.plot_panels(results))
    if plot:
        (folder / "benchmarks.svg").write_text(plot)
    print(f"written: {os.path.relpath(folder / 'benchmarks.md')}")


def main():
    options = parse()
    options.results.mkdir(parents=True, exist_ok=True)
    raw = options.results / ("quick.json" if options.quick else "full.json")
    if not options.only_page:
        raw.write_text(json.dumps(measure(options), indent=1))
    write_page(json.loads(raw.read_text()), options.results if options.quick else ROOT / "docs")


if __name__ == "__main__":
    main()
