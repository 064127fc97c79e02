# SPDX-License-Identifier: BSD-3-Clause
"""What examples/paper.sh needs beside roughmesh and gmsh, with Python's standard library alone.

usage: paper_tables.py line N FILE.msh          a line of N nodes from 0 to 1, MSH 2.2
       paper_tables.py heights STEM line|sphere  STEM_*.vtu -> STEM.csv: x (y z), one height per realization
       paper_tables.py summary FOLDER STEM...    STEM.report.json -> FOLDER/table.csv, table.md; prints and checks
"""
import array
import csv
import glob
import json
import os
import re
import sys


def write_line(n, path):
    nodes = "".join(f"{i + 1} {i / (n - 1)!r} 0 0\n" for i in range(n))
    elements = "".join(f"{i} 1 2 1 1 {i} {i + 1}\n" for i in range(1, n))
    with open(path, "w") as file:
        file.write('$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 1 "line"\n$EndPhysicalNames\n')
        file.write(f"$Nodes\n{n}\n{nodes}$EndNodes\n$Elements\n{n - 1}\n{elements}$EndElements\n")


def read_vtu(path, name):
    """One array of 64-bit numbers of a VTU with raw appended data, as roughmesh writes it."""
    with open(path, "rb") as file:
        content = file.read()
    head, _, data = content.partition(b'<AppendedData encoding="raw">')
    data = data[data.index(b"_") + 1:]
    offset = int(re.search(rf'Name="{name}"[^>]*offset="(\d+)"'.encode(), head).group(1))
    n_bytes = int.from_bytes(data[offset:offset + 8], "little")
    values = array.array("d", data[offset + 8:offset + 8 + n_bytes])
    if sys.byteorder == "big":
        values.byteswap()
    return values


def realization_of(path):
    return int(re.search(r"_(\d+)\.vtu$", path).group(1))


def write_heights(stem, kind):
    """Nominal positions are the rough ones less the displacements."""
    paths = sorted(glob.glob(glob.escape(stem) + "_*.vtu"), key=realization_of)
    rough = read_vtu(paths[0], "Points")
    moved = read_vtu(paths[0], "displacement")
    nominal = [a - b for a, b in zip(rough, moved)]
    axes = "x" if kind == "line" else "xyz"
    columns = [[f"{value:.12g}" for value in nominal[axis::3]] for axis in range(len(axes))]
    columns += [[repr(value) for value in read_vtu(path, "height")] for path in paths]
    header = list(axes) + [f"height_{realization_of(path)}" for path in paths]
    with open(stem + ".csv", "w", newline="") as file:
        csv.writer(file).writerows([header, *zip(*columns)])


HEADER = ["surface", "nodes", "Rq", "l", "h/l", "realization", "Sq", "Sq expected", "its std", "(Sq - expected)/std"]


def summary_rows(folder, stem):
    with open(os.path.join(folder, stem + ".report.json")) as file:
        report = json.load(file)
    request, surface = report["request"], report["surface"]
    length = request["length"][0]
    for realization in report["realizations"]:
        deviation = (realization["sq"] - realization["sq_expected"]) / realization["sq_expected_std"]
        yield [stem, surface["nodes"], request["rms"], length, f"{surface['mesh_size']['median'] / length:.3f}",
               realization["index"], f"{realization['sq']:.5f}", f"{realization['sq_expected']:.5f}",
               f"{realization['sq_expected_std']:.5f}", f"{deviation:+.2f}"]


def check_deviations(rows):
    """Of some ten independent values with a longer tail upwards than the normal law has, none is so far out."""
    for row in rows:
        if not abs(float(row[-1])) < 5:
            sys.exit(f"{row[0]}, realization {row[5]}: Sq is {row[-1]} standard deviations from what is expected")


def write_summary(folder, stems):
    rows = [row for stem in stems for row in summary_rows(folder, stem)]
    with open(os.path.join(folder, "table.csv"), "w", newline="") as file:
        csv.writer(file).writerows([HEADER, *rows])
    lines = [HEADER, ["---"] * len(HEADER), *rows]
    text = "".join("| " + " | ".join(map(str, line)) + " |\n" for line in lines)
    with open(os.path.join(folder, "table.md"), "w") as file:
        file.write(text)
    print(text, end="")
    check_deviations(rows)


if __name__ == "__main__":
    verb, *arguments = sys.argv[1:] or [""]
    if verb == "line":
        write_line(int(arguments[0]), arguments[1])
    elif verb == "heights":
        write_heights(*arguments)
    elif verb == "summary":
        write_summary(arguments[0], arguments[1:])
    else:
        sys.exit(__doc__)
