# SPDX-License-Identifier: BSD-3-Clause
"""GSTools' randomization method on the points of bench_field: one case, one line of JSON.

A realization is a sum of waves whose wave vectors and amplitudes are drawn for each seed. Averaged
over seeds the covariance is exact; that of one field, its wave vectors given, is
mean_k cos(k . (x - y)), and its distance from rho is what `pairs_rms` and `pairs_error` hold.
"""
import argparse
import importlib.metadata
import json
import os
import statistics
import time

import gstools as gs
import numpy as np

import covariance_error

MOST_SAMPLES = 25
MODE_SETS = 5  # seeds whose wave vectors are looked at


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points-file", required=True)
    parser.add_argument("--pairs-file", required=True)
    parser.add_argument("--family", choices=["gaussian", "exponential"], required=True)
    parser.add_argument("--length", type=float, required=True)
    parser.add_argument("--modes", type=int, default=1000)
    parser.add_argument("--realizations", type=int, default=0, help="for the measured error")
    parser.add_argument("--seconds", type=float, default=2)
    parser.add_argument("--threads", type=int, default=0)
    return parser.parse_args()


def covariance_model(family, length):
    """exp(-r^2 / (2 l^2)) or exp(-r / l): theirs is cor(rescale * r / len_scale)."""
    if family == "gaussian":
        return gs.Gaussian(dim=3, var=1, len_scale=length, rescale=np.sqrt(0.5))
    return gs.Exponential(dim=3, var=1, len_scale=length, rescale=1)


def differences(points, pair_class):
    first, second = np.asarray(pair_class["pairs"]).T
    return points[first] - points[second]


def largest_model_difference(model, classes, points):
    """Between the model and the rho that our own program wrote beside the pairs."""
    return max(np.abs(model.correlation(np.linalg.norm(differences(points, pair_class), axis=1))
                      - pair_class["rho"]).max() for pair_class in classes)


def timed_samples(model, points, options):
    """Seconds of making the field object, of its first call and of calls with further seeds."""
    start = time.perf_counter()
    field = gs.SRF(model, generator="RandMeth", mode_no=options.modes, seed=0)
    field.set_pos(points.T)
    prepare = time.perf_counter() - start
    field(store=False)
    first = time.perf_counter() - start
    times = []
    while not times or (sum(times) < options.seconds and len(times) < MOST_SAMPLES):
        sample_start = time.perf_counter()
        field(seed=len(times) + 1, store=False)
        times.append(time.perf_counter() - sample_start)
    return prepare, first, times


def measured_error(model, points, classes, options):
    """At the points of the pairs alone: a field of waves is the same there as among others."""
    places = points[covariance_error.pair_points(classes)]
    field = gs.SRF(model, generator="RandMeth", mode_no=options.modes, seed=0)
    field.set_pos(places.T)
    values = [field(seed=seed, store=False) for seed in range(options.realizations)]
    return covariance_error.measured_error(classes, np.concatenate(values).tolist())


def errors_of_modes(model, points, classes, modes):
    """Deviations of mean_k cos(k . (x - y)) from rho, over pairs and sets of wave vectors."""
    result = []
    for seed in range(MODE_SETS):
        field = gs.SRF(model, generator="RandMeth", mode_no=modes, seed=seed)
        waves = field.generator._cov_sample  # 3 rows; there is no public way to them
        for pair_class in classes:
            phases = differences(points, pair_class) @ waves
            result.append(np.cos(phases).mean(axis=1) - pair_class["rho"])
    return np.concatenate(result)


def core_version():
    try:
        return importlib.metadata.version("gstools_core")
    except importlib.metadata.PackageNotFoundError:
        return None


def run(options):
    gs.config.NUM_THREADS = options.threads or os.cpu_count()
    points = np.fromfile(options.points_file).reshape(-1, 3)
    classes = covariance_error.read_pairs(options.pairs_file)
    model = covariance_model(options.family, options.length)
    prepare, first, further = timed_samples(model, points, options)
    memory = covariance_error.peak_memory()
    errors = errors_of_modes(model, points, classes, options.modes)
    result = {"tool": "GSTools", "version": gs.__version__, "core": core_version(),
              "method": f"RandMeth, {options.modes} modes", "family": options.family,
              "n": len(points), "length": options.length, "prepare_s": prepare, "first_s": first,
              "next_s": statistics.median(further), "n_next": len(further), "memory_bytes": memory,
              "pairs_rms": float(np.sqrt((errors ** 2).mean())),
              "pairs_error": float(np.abs(errors).max()),
              "model_difference": float(largest_model_difference(model, classes, points))}
    if options.realizations:
        result["measured"] = measured_error(model, points, classes, options)
    return result


if __name__ == "__main__":
    print(json.dumps(run(parse())))
