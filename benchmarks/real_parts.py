#!/usr/bin/env python3
# SPDX-License-Identifier: BSD-3-Clause
"""Roughens real parts and a sphere, and writes what became of them: docs/validity.md.

usage: real_parts.py BIN_FOLDER DATA_FOLDER OUTPUT.md
"""
import collections
import json
import pathlib
import statistics
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
BODIES = ["cube", "cylinder", "L-shaped block", "wedge of 30 degrees"]
SPHERES = [(0.14, 0.34), (0.085, 0.22), (0.0445, 0.125)]  # mesh size on the sphere, at the corners of the box


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


def sphere_rows(bench):
    """Of bench_untangle: a header for each mesh, then its columns."""
    geometry = pathlib.Path(__file__).parent / "sphere_in_box.geo"
    with tempfile.TemporaryDirectory() as scratch:
        meshes = [pathlib.Path(scratch) / f"{k}.msh" for k in range(len(SPHERES))]
        for (sphere, corners), mesh in zip(SPHERES, meshes):
            subprocess.run(["gmsh", geometry, "-setnumber", "s", str(sphere), "-setnumber", "c", str(corners), "-3", "-v", "0",
                            "-o", mesh], check=True, stdout=subprocess.DEVNULL)
        for line in subprocess.run([bench, *meshes], check=True, capture_output=True, text=True).stdout.splitlines():
            print(line, flush=True)
            if "tetrahedra" in line:
                mesh = line.split()
            elif not line.startswith("Rq/h"):
                ratio, first, stages, methods = (cell.split() for cell in line.split("|"))
                yield [f"{int(mesh[0]):,}", mesh[-1], *ratio, *first[:2], *stages[:3], first[2], stages[3], " + ".join(methods)]


def body_rows(roughmesh):
    """Of ten seeds: how many are valid by which method, and the median of the smallest scaled Jacobian."""
    geometry = pathlib.Path(__file__).parent / "body_in_box.geo"
    for number, body in enumerate(BODIES, start=1):
        with tempfile.TemporaryDirectory() as scratch:
            folder = pathlib.Path(scratch)
            mesh, report = folder / "body.msh", folder / "run.json"
            subprocess.run(["gmsh", geometry, "-setnumber", "body", str(number), "-3", "-v", "0", "-o", mesh], check=True,
                           stdout=subprocess.DEVNULL)
            h = median_edge(roughmesh, mesh, ["--group", "surface"], folder)
            for ratio in (0.3, 0.5, 0.7):
                methods, qualities, refusals = collections.Counter(), [], set()
                for seed in range(10):
                    code, line = run(roughmesh, ["roughen", mesh, "-o", folder / "rough.msh", "--group", "surface", "--rms", ratio * h,
                                                 "--length", 1.77 * h, "--seed", seed, "--report", report, "--quiet"])
                    if code != 0:
                        refusals.add(line.removeprefix("roughmesh: "))
                        continue
                    result = json.load(open(report))["realizations"][0]
                    methods[result["volume_method"]] += 1
                    qualities.append(result["min_quality"])
                row = [body, str(ratio), f"{len(qualities)} of 10", ", ".join(f"{n} {m}" for m, n in sorted(methods.items())),
                       f"{statistics.median(qualities):.3f}" if qualities else "", "; ".join(sorted(refusals))]
                print(*row, sep=" | ", flush=True)
                yield row


def body_section(table):
    lines = ["", "## Bodies with edges in a box", "",
             "Some 16 to 19 thousand tetrahedra inside and around a body whose surface is roughened, edges and corners included, l = 1.77 h,",
             "h being the median edge of the surface; ten seeds each. Median of the smallest scaled Jacobian over the valid ones.", "",
             "| body | Rq/h | valid | by | smallest scaled Jacobian | refused |", "|---|---|---|---|---|---|"]
    return lines + [f"| {' | '.join(row)} |" for row in table]


def sphere_section(table):
    lines = ["", "## Sphere in a box", "",
             "Tetrahedra inside and around a sphere whose surface is roughened, l = 1.77 h, h being the mean edge of the surface; ten seeds each, medians",
             "over the seeds. Smallest scaled Jacobian and number of invalid meshes: after the harmonic extension alone, and after all stages that move",
             "nodes. How many seeds needed the harmonic extension only, the foldover-free map, a split of edges. Seconds on all cores.", "",
             "| tetrahedra | input | Rq/h | harmonic | invalid | all stages | the least | invalid | harmonic, s | all stages, s | harmonic + map + split |",
             "|---|---|---|---|---|---|---|---|---|---|---|"]
    return lines + [f"| {' | '.join(row)} |" for row in table]


def page(table, bodies, spheres):
    lines = ["# Real parts", "",
             "Real meshes and CAD, roughened with Rq = h/4 and a correlation length of 3 h (Gaussian), h being the median edge: about the",
             "roughest that a mesh can carry. Seed 0. Made by `./dev validity DATA_FOLDER`; the files are public test meshes of gmsh,",
             "geometry-central and MFEM.", "",
             "| part | file | h | mesh | outcome |", "|---|---|---|---|---|"]
    lines += [f"| {name} | `{file}` | {h:.4g} | {what} | {result} |" for name, file, h, what, result in table]
    return "\n".join(lines + body_section(bodies) + sphere_section(spheres)) + "\n"


if __name__ == "__main__":
    programs, data, output = map(pathlib.Path, sys.argv[1:])
    table = []
    for row in rows(programs / "roughmesh", data):
        print(*row, sep=" | ", flush=True)
        table.append(row)
    output.write_text(page(table, list(body_rows(programs / "roughmesh")), list(sphere_rows(programs / "bench_untangle"))))
