#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Roughens real parts and writes what became of them: docs/validity.md.

usage: real_parts.py ROUGHMESH DATA_FOLDER OUTPUT.md
"""
import json
import pathlib
import subprocess
import sys
import tempfile

PARTS = [
    # name, file, options for input, is a closed surface or a volume
    ("machined block (STEP)", "cad/block.stp", ["--mesh-size", "{h}"], "volume"),
    ("brick", "meshes/lego.ply", [], "closed"),
    ("aorta, open vessel", "meshes/aorta.stl", [], "open"),
    ("cow", "meshes/spot.ply", [], "closed"),
    ("torus-like body", "meshes/bob_small.ply", [], "closed"),
    ("nested cubes, two materials", "meshes/nested_cubes.msh", ["--group", "all"], "volume"),
]
BLOCK_SIZE = 3.0  # mm: some 40 edges along the longest side


def run(roughmesh, arguments):
    done = subprocess.run([roughmesh, *map(str, arguments)], capture_output=True, text=True)
    return done.returncode, (done.stderr.strip().splitlines() or [""])[-1]


def median_edge(roughmesh, path, options, folder):
    report = folder / "size.json"
    code, line = run(roughmesh, ["roughen", path, "-o", folder / f"size{output_suffix(path)}", "--rms", 1e-9, "--length", 1,
                                 "--volume", "none", "--allow-invalid", "--quiet", "--report", report, *options])
    if code != 0:
        raise SystemExit(f"{path}: {line}")
    return json.load(open(report))["surface"]["mesh_size"]["median"]


def output_suffix(path):
    return ".msh" if path.suffix == ".stp" else path.suffix


def outcome(roughmesh, path, options, h, rms, folder, suffix):
    report = folder / "run.json"
    report.unlink(missing_ok=True)
    code, line = run(roughmesh, ["roughen", path, "-o", folder / f"rough{suffix}", "--rms", f"{rms:.6g}", "--length", f"{3 * h:.6g}",
                                 "--quiet", "--report", report, *options])
    if code != 0:
        return f"exit code {code}: {line.removeprefix('roughmesh: ')}"
    result = json.load(open(report))["realizations"][0]
    return (f"valid; {result['volume_method']}; {result['self_intersections']} self-intersections, "
            f"{result['inverted_elements']} inverted, smallest scaled Jacobian {result['min_quality']:.3f}")


def rows(roughmesh, data):
    for name, file, options, kind in PARTS:
        with tempfile.TemporaryDirectory() as scratch:
            folder, path = pathlib.Path(scratch), data / file
            options = [option.format(h=BLOCK_SIZE) for option in options]
            h = median_edge(roughmesh, path, options, folder)
            yield name, file, h, "as it is", outcome(roughmesh, path, options, h, h / 4, folder, output_suffix(path))
            if kind == "closed":
                for what, more in (("filled", []), ("filled, in a box", ["--box", "2"])):
                    yield name, file, h, what, outcome(roughmesh, path, [*options, "--volume", "remesh", *more], h, h / 4, folder, ".msh")
            if kind == "volume":
                yield name, file, h, "meshed anew", outcome(roughmesh, path, [*options, "--volume", "remesh"], h, h / 4, folder, ".msh")


def page(table):
    lines = ["# Real parts", "",
             "Real meshes and CAD, roughened with Rq = h/4 and a correlation length of 3 h (Gaussian), h being the median edge: about the",
             "roughest that a mesh can carry. Seed 0. Made by `./dev validity DATA_FOLDER`; the files are public test meshes of gmsh,",
             "geometry-central and MFEM.", "",
             "| part | file | h | mesh | outcome |", "|---|---|---|---|---|"]
    lines += [f"| {name} | `{file}` | {h:.4g} | {what} | {result} |" for name, file, h, what, result in table]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    roughmesh, data, output = sys.argv[1:]
    table = []
    for row in rows(roughmesh, pathlib.Path(data)):
        print(*row, sep=" | ", flush=True)
        table.append(row)
    pathlib.Path(output).write_text(page(table))
