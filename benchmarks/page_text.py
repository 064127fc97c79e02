# SPDX-License-Identifier: BSD-3-Clause
"""The benchmarks page from what was measured: Markdown and the series of the plot."""
import bench_cases

NAMES = {("roughmesh", "lattice"): "roughmesh lattice",
         ("roughmesh", "cholesky"): "roughmesh cholesky",
         ("OpenTURNS", "hmat"): "OpenTURNS HMAT",
         ("OpenTURNS", "cholesky"): "OpenTURNS Cholesky",
         ("GSTools", "RandMeth"): "GSTools RandMeth"}
FORMULAS = {"gaussian": "exp(-r²/(2 l²))", "exponential": "exp(-r/l)", "matern": "nu = 1.5",
            "self-affine": "H = 0.8", "stretched": "p = 1.4", "rational-quadratic": "a = 1"}
SUPERSCRIPTS = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def name_of(case):
    method = "RandMeth" if case["tool"] == "GSTools" else case["method"]
    return NAMES[case["tool"], method]


def count(n):
    """10⁴ for powers of ten, else with thousands apart."""
    exponent = len(str(n)) - 1
    return "10" + str(exponent).translate(SUPERSCRIPTS) if n == 10 ** exponent else f"{n:,}"


def seconds(value):
    unit, factor = ("s", 1) if value >= 1 else ("ms", 1e3) if value >= 1e-3 else ("µs", 1e6)
    scaled = value * factor
    return f"{scaled:.0f} {unit}" if scaled >= 10 else f"{scaled:.1f} {unit}"


def memory(value):
    return f"{value * 1e-9:.2f} GB" if value >= 1e9 else f"{value * 1e-6:.0f} MB"


def small(value):
    return f"{value:.1e}" if value < 1e-2 else f"{value:.3f}"


def table(header, rows):
    lines = ["| " + " | ".join(header) + " |", "|" + "---|" * len(header)]
    return "\n".join(lines + ["| " + " | ".join(row) + " |" for row in rows])


def find(cases, **wanted):
    """The case with these values, if it succeeded."""
    for case in cases:
        if "failed" not in case and all(case.get(key) == value for key, value in wanted.items()):
            return case
    return None


def ratio(numerator, denominator, key_of_numerator, key_of_denominator):
    if numerator is None or denominator is None:
        return None
    return numerator[key_of_numerator] / denominator[key_of_denominator]


def against_hmat(results, family):
    ours = find(results["compared"], tool="roughmesh", method="lattice", family=family, n=10 ** 4)
    theirs = find(results["compared"], tool="OpenTURNS", method="hmat", family=family, n=10 ** 4)
    return ratio(theirs, ours, "first_s", "first_s")


def against_gstools(results, family, theirs_key, ours_key):
    ours = find(results["compared"], tool="roughmesh", method="lattice", family=family, n=10 ** 6)
    theirs = find(results["compared"], tool="GSTools", family=family, n=10 ** 6)
    return ratio(theirs, ours, theirs_key, ours_key)


def lattice(results, family, n):
    return find(results["sweep"], method="lattice", family=family, n=n)


def growth(results, family):
    return ratio(lattice(results, family, 10 ** 7), lattice(results, family, 10 ** 6),
                 "first_s", "first_s")


def bytes_a_node(results, family):
    case = lattice(results, family, 10 ** 7) or lattice(results, family, 10 ** 6)
    return case and case["sampler_bytes"] / case["n"]


def whole_command(results, family, n):
    """The run on the sphere with about n nodes."""
    for case in results["pipeline"]:
        if "failed" not in case and case["family"] == family and 0.9 < case["n"] / n < 1.1:
            return case
    return None


def field_share(results, family):
    case = whole_command(results, family, 10 ** 6)
    return case and 100 * case["timings"]["field"] / case["timings"]["total"]


def growth_of_command(results, family, stage):
    cases = [whole_command(results, family, n) for n in (10 ** 6, 10 ** 7)]
    if None in cases:
        return None
    return cases[1]["timings"][stage] / cases[0]["timings"][stage]


def figure(value, form):
    return "not measured" if value is None else form.format(value)


def key_figures(results):
    rows = []
    for family in bench_cases.COMPARED:
        rows += [
            (f"10⁴ points, {family}: OpenTURNS HMAT over `lattice`, first realization",
             "at least 300", figure(against_hmat(results, family), "{:.0f}")),
            (f"10⁶ points, {family}: GSTools with 1,000 modes over `lattice`, a further realization",
             "at least 50", figure(against_gstools(results, family, "next_s", "next_s"), "{:.0f}")),
            ("... covariance error: rms of GSTools over the largest of `lattice`", "at least 50",
             figure(against_gstools(results, family, "pairs_rms", "pairs_error"), "{:.0f}")),
            (f"`lattice`, {family}: time of 10⁷ points over that of 10⁶", "at most 11",
             figure(growth(results, family), "{:.1f}")),
            (f"`lattice`, {family}: memory of the sampler, bytes a point", "at most 100",
             figure(bytes_a_node(results, family), "{:.0f}"))]
    rows += [
        ("`lattice`, 10⁶ points: exponential over Gaussian, first realization", "at most 10",
         figure(ratio(lattice(results, "exponential", 10 ** 6), lattice(results, "gaussian", 10 ** 6),
                      "first_s", "first_s"), "{:.1f}")),
        ("`lattice`, 10⁶ points: exponential over Gaussian, a further realization", "at most 10",
         figure(ratio(lattice(results, "exponential", 10 ** 6), lattice(results, "gaussian", 10 ** 6),
                      "next_s", "next_s"), "{:.1f}")),
        ("`field` in the whole command at 10⁶ nodes, Gaussian", "at most 25 %",
         figure(field_share(results, "gaussian"), "{:.0f} %")),
        ("`field` of the whole command, Gaussian: time of 10⁷ nodes over that of 10⁶", "at most 11",
         figure(growth_of_command(results, "gaussian", "field"), "{:.1f}")),
        ("the whole command, Gaussian: time of 10⁷ nodes over that of 10⁶", "",
         figure(growth_of_command(results, "gaussian", "total"), "{:.1f}"))]
    return table(["what", "bar", "measured"], rows)


def errors_of(case):
    exact = "" if "pairs_error" not in case else small(case["pairs_error"])
    if "pairs_rms" in case:
        exact = f"{small(case['pairs_rms'])} rms, {exact} largest"
    if "measured" not in case:
        return [exact, ""]
    measured = case["measured"]
    return [exact, f"{abs(measured['error']):.3f} ± {measured['sampling_error']:.3f}"]


def compared_row(case):
    head = [count(case["n"]), name_of(case)]
    if "failed" in case:
        return head + [case["failed"], "", "", "", ""]
    return head + [seconds(case["first_s"]), seconds(case["next_s"]), memory(case["memory_bytes"]),
                   *errors_of(case)]


def compared_tables(results):
    header = ["N", "sampler", "first realization", "a further one", "peak memory",
              "covariance error, exact", "measured over realizations"]
    parts = []
    for family in bench_cases.COMPARED:
        rows = [compared_row(c) for c in results["compared"] if c["family"] == family]
        parts.append(f"### {family}, rho = {FORMULAS[family]}\n\n{table(header, rows)}")
    return "\n\n".join(parts)


def sweep_row(case):
    if "failed" in case:
        return [count(case["n"]), case["failed"], "", "", "", "", ""]
    return [count(case["n"]), seconds(case["prepare_s"]), seconds(case["first_s"]),
            seconds(case["next_s"]), memory(case["memory_bytes"]),
            f"{case['sampler_bytes'] / case['n']:.0f}", small(case["audit"]["error"])]


def sweep_tables(results):
    header = ["N", "preparation", "first realization", "a further one", "peak memory",
              "sampler, bytes a point", "audited error"]
    parts = []
    for method in ("lattice", "cholesky"):
        for family in bench_cases.FAMILIES:
            rows = [sweep_row(c) for c in results["sweep"]
                    if c["method"] == method and c["family"] == family]
            if rows:
                parts.append(f"### {method}, {family} ({FORMULAS[family]})\n\n{table(header, rows)}")
    return "\n\n".join(parts)


def tolerance_table(results):
    cases = results["tolerances"]
    tolerances = sorted({case["tolerance"] for case in cases}, reverse=True)
    rows = []
    for family in bench_cases.FAMILIES:
        row = [find(cases, family=family, tolerance=tolerance) for tolerance in tolerances]
        if any(row):
            rows.append([family] + ["-" if case is None else
                                    f"{small(case['audit']['error'])}, {seconds(case['next_s'])}"
                                    for case in row])
    return table(["tolerance"] + [f"{tolerance:g}" for tolerance in tolerances], rows)


def pipeline_row(case):
    head = [case["family"], f"{case['n']:,}"]
    if "failed" in case:
        return head + [case["failed"]] + [""] * 9
    times = case["timings"]
    stages = ["read", "surface", "field", "audit", "displace", "check", "write", "total"]
    return head + [f"{times[stage]:.2f}" for stage in stages] + [
        f"{100 * times['field'] / times['total']:.0f} %", memory(case["memory_bytes"])]


def pipeline_table(results):
    header = ["family", "nodes", "read", "surface", "field", "audit", "displace", "check", "write",
              "total, s", "field", "peak memory"]
    return table(header, [pipeline_row(case) for case in results["pipeline"]])


def program_texts(results):
    return "\n\n".join(f"`{name}`:\n\n```\n{text.rstrip()}\n```"
                       for name, text in results["programs"].items())


def series(results, family):
    """For each sampler the pairs (N, seconds of the first realization), by ascending N."""
    curves = {name: {} for name in NAMES.values()}
    for case in results["compared"] + results["sweep"]:
        if "failed" not in case and case["family"] == family:
            curves[name_of(case)].setdefault(case["n"], case["first_s"])
    return [(name, sorted(curve.items())) for name, curve in curves.items()]


def plot_panels(results):
    return [(f"{family}: {FORMULAS[family]}", series(results, family))
            for family in bench_cases.COMPARED]


def machine_table(machine):
    return table(["", ""], [[key, value] for key, value in machine.items()])


PAGE = """# Benchmarks

Made by `./dev bench`, in one run on one machine; nothing here is typed by hand. `./dev bench quick` is a short version for
checking, which leaves this page alone.

{machine}

**Points.** N points of a unit sphere (Fibonacci's spiral), the same file for every sampler. **Correlation length** l = 2.5 h with
h = sqrt(4 pi / N), the mean spacing: the shortest that the rule h <= l / 2.5 lets a mesh carry, and the dearest for `lattice`,
whose nodes then share least. **First realization**: with all preparation, from points in memory to heights in memory; **a further one**:
median of up to 25. Tolerance of `lattice`: 1e-4. Each case runs in a process of its own, on all cores.

![Seconds to the first realization against the number of points](benchmarks.svg)

## Key figures

{key_figures}

## Side by side

The covariance is compared with rho on the same {n_pairs} pairs, 500 at each of the distances 0, 0.4 l, l, 2 l and 4 l, in two ways:

- *exact*, the largest |covariance - rho| over the pairs, without sampling error. roughmesh: by the tables that the heights are made
  with. OpenTURNS: products of rows of the very factor that its realizations are products with (the first 20 pairs of each distance).
  GSTools: a field is a sum of 1,000 waves whose wave vectors are drawn for each seed; given them, its covariance is a mean of
  cosines. Averaged over seeds that mean is rho, in one field it is off by what stands here.
- *measured*: over 200 realizations (50 above 10⁴ points), each with a seed of its own; the mean deviation of the pairs at one distance,
  for the distance that deviates most, ± its sampling error. It shows that nothing is wrong by more than that, for all samplers
  in the same manner; it cannot resolve 1e-4.

OpenTURNS runs as it comes, on its default H-matrix tolerances of 1e-4 (its error is the multiple of the identity that it adds), but
for the compression of blocks: AcaPlus, as the default AcaRandom ends the program for the Gaussian. GSTools runs with its
compiled core where that installs, on all cores. {differences}

{compared}

## File to file

`roughmesh roughen SPHERE.ply -o ROUGH.ply` with one realization, Rq = 0.05 h, l = 2.5 h, binary PLY with double coordinates; seconds of each stage.

{pipeline}

## Tolerance

`lattice` at {tolerance_points} points: audited covariance error, and time of a further realization, by the tolerance asked for.

{tolerances}

## Time and memory against N

*Audited error*: the largest |covariance - rho| over some 10⁴ pairs, computed, not sampled. Sizes that would take long are left out.

{sweep}

## The other programs

{programs}
"""


def model_differences(results):
    values = [case["model_difference"] for case in results["compared"] if "model_difference" in case]
    if not values:
        return "Neither was at hand in this run."
    return f"Their rho differs from ours by at most {max(values):.0e} on the pairs."


def page(results):
    return PAGE.format(
        machine=machine_table(results["machine"]), key_figures=key_figures(results),
        n_pairs="2,500", differences=model_differences(results), compared=compared_tables(results),
        pipeline=pipeline_table(results), tolerances=tolerance_table(results),
        tolerance_points=count(results["tolerance_points"]), sweep=sweep_tables(results),
        programs=program_texts(results) or "Not run.")
