# SPDX-License-Identifier: BSD-3-Clause
"""How far the covariance of realizations is from rho, and peak memory: one measure for all samplers.

Samplers write the heights of pairs of points, two doubles a pair, class by class, realization by
realization. A class holds pairs at about one distance. Per realization the mean of z_i z_j - rho_ij
over a class is one number; realizations are independent, so that their spread gives the sampling
error of the mean, whatever the correlation between pairs.
"""
import array
import json
import math


def read_pairs(path):
    with open(path) as file:
        return json.load(file)


def pair_points(classes):
    """The point numbers in the order in which their heights are written."""
    return [point for pair_class in classes for pair in pair_class["pairs"] for point in pair]


def mean_deviation(heights, rho):
    """Mean of z_i z_j - rho over the pairs of a class, in one realization."""
    products = (a * b for a, b in zip(heights[0::2], heights[1::2]))
    return sum(p - r for p, r in zip(products, rho)) / len(rho)


def mean_and_error(values):
    mean = sum(values) / len(values)
    variance = sum((value - mean) ** 2 for value in values) / (len(values) - 1)
    return mean, math.sqrt(variance / len(values))


def deviations_by_class(classes, heights):
    """For each class a list with one mean deviation per realization."""
    size = sum(2 * len(pair_class["pairs"]) for pair_class in classes)
    result = [[] for _ in classes]
    for start in range(0, len(heights), size):
        for pair_class, deviations in zip(classes, result):
            end = start + 2 * len(pair_class["pairs"])
            deviations.append(mean_deviation(heights[start:end], pair_class["rho"]))
            start = end
    return result


def measured_error(classes, heights):
    """The class that deviates most: its deviation and the sampling error of that, as a dict."""
    result = []
    for pair_class, deviations in zip(classes, deviations_by_class(classes, heights)):
        mean, error = mean_and_error(deviations)
        result.append({"distance": pair_class["distance"], "error": mean, "sampling_error": error})
    return max(result, key=lambda row: abs(row["error"]))


def peak_memory():
    """Of this process, in bytes."""
    with open("/proc/self/status") as status:
        return 1024 * int(next(line for line in status if line.startswith("VmHWM:")).split()[1])


def read_heights(path):
    heights = array.array("d")
    with open(path, "rb") as file:
        heights.frombytes(file.read())
    return heights


def measured_error_of_files(pairs_path, values_path):
    return measured_error(read_pairs(pairs_path), read_heights(values_path))
