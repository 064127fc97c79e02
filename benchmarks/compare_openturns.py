# SPDX-License-Identifier: BSD-3-Clause
"""OpenTURNS' Gaussian process on the points of bench_field: one case, one line of JSON.

Runs under the python3 that has the package python3-openturns (Debian's, /usr/bin/python3).
"""
import argparse
import json
import statistics
import time

import numpy as np
import openturns as ot

import covariance_error

METHODS = {"hmat": ot.GaussianProcess.HMAT, "cholesky": ot.GaussianProcess.CHOLESKY}
MOST_SAMPLES = 25


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--points-file", required=True)
    parser.add_argument("--pairs-file", required=True)
    parser.add_argument("--method", choices=METHODS, required=True)
    parser.add_argument("--family", choices=["gaussian", "exponential"], required=True)
    parser.add_argument("--length", type=float, required=True)
    parser.add_argument("--compression", default="AcaPlus",
                        help="of H-matrix blocks; AcaRandom, the default of 1.20, aborts the "
                        "program for smooth models: an assertion of hmat-oss fails")
    parser.add_argument("--realizations", type=int, default=0, help="for the measured error")
    parser.add_argument("--rows", type=int, default=0, help="pairs a class for the exact error")
    parser.add_argument("--seconds", type=float, default=2)
    parser.add_argument("--threads", type=int, default=0)
    return parser.parse_args()


def covariance_model(family, length):
    """exp(-r^2 / (2 l^2)) or exp(-r / l) of the Euclidean distance, variance 1."""
    model = ot.SquaredExponential if family == "gaussian" else ot.ExponentialModel
    return model([length] * 3, [1.0])


def largest_model_difference(model, classes, points):
    """Between the model and the rho that our own program wrote beside the pairs."""
    return max(abs(model(points[i] - points[j])[0, 0] - rho)
               for pair_class in classes
               for (i, j), rho in zip(pair_class["pairs"], pair_class["rho"]))


def heights(process):
    return np.asarray(process.getRealization().getValues()).ravel()


def timed_samples(process, seconds):
    """Seconds of the first realization, which holds the factorization, and of further ones."""
    times = []
    start = time.perf_counter()
    while len(times) < 2 or (time.perf_counter() - start - times[0] < seconds
                             and len(times) <= MOST_SAMPLES):
        sample_start = time.perf_counter()
        process.getRealization()
        times.append(time.perf_counter() - sample_start)
    return times[0], times[1:]


def measured_error(process, classes, realizations):
    points = covariance_error.pair_points(classes)
    values = np.concatenate([heights(process)[points] for _ in range(realizations)])
    return covariance_error.measured_error(classes, values.tolist())


def hmatrix_row(factor, i):
    """Row i of the very factor L that realizations are products with: L^T e_i."""
    unit, row = ot.Point(factor.getNbRows()), ot.Point(factor.getNbRows())
    unit[i] = 1
    factor.gemv("T", 1.0, unit, 0.0, row)
    return np.asarray(row)


def factor_row(model, mesh, method):
    if method == "hmat":
        factor = model.discretizeAndFactorizeHMatrix(mesh, ot.HMatrixParameters())
        return lambda i: hmatrix_row(factor, i)
    factor = np.asarray(model.discretizeAndFactorize(mesh))
    return lambda i: factor[i]


def exact_error(model, mesh, method, classes, n_rows):
    """Largest |(L L^T)_ij - rho_ij| over the first pairs of each class."""
    row = factor_row(model, mesh, method)
    return max(abs(float(row(i) @ row(j)) - rho)
               for pair_class in classes
               for (i, j), rho in list(zip(pair_class["pairs"], pair_class["rho"]))[:n_rows])


def run(options):
    if options.threads:
        ot.TBB.SetThreadsNumber(options.threads)
    ot.ResourceMap.Set("HMatrix-CompressionMethod", options.compression)
    ot.RandomGenerator.SetSeed(1)
    points = np.fromfile(options.points_file).reshape(-1, 3)
    classes = covariance_error.read_pairs(options.pairs_file)
    mesh = ot.Mesh(ot.Sample(points))
    model = covariance_model(options.family, options.length)
    process = ot.GaussianProcess(model, mesh)
    process.setSamplingMethod(METHODS[options.method])
    first, further = timed_samples(process, options.seconds)
    result = {"tool": "OpenTURNS", "version": ot.__version__, "method": options.method,
              "family": options.family, "n": len(points), "length": options.length,
              "first_s": first, "next_s": statistics.median(further), "n_next": len(further),
              "memory_bytes": covariance_error.peak_memory(),
              "model_difference": largest_model_difference(model, classes, points)}
    if options.method == "hmat":
        result["compression"] = options.compression
    if options.realizations:
        result["measured"] = measured_error(process, classes, options.realizations)
    if options.rows:
        result["pairs_error"] = exact_error(model, mesh, options.method, classes, options.rows)
    return result


if __name__ == "__main__":
    print(json.dumps(run(parse())))
