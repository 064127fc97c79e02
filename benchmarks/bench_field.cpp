// SPDX-License-Identifier: BSD-3-Clause
// One case of the benchmarks page: a method and a family on N points of a unit sphere, in a process
// of its own, whose peak memory is then that of the sampler. Prints one line of JSON. Points, pairs
// and the heights of those pairs go to files, so that other samplers take the very same points and
// are measured on the very same pairs (covariance_error.py).
#include <chrono>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "roughmesh/error.hpp"
#include "roughmesh/field.hpp"

#include "parallel.hpp"
#include "sphere_points.hpp"

namespace {

using namespace roughmesh;
using nlohmann::ordered_json;
using Clock = std::chrono::steady_clock;

constexpr Index most_anchors = 500;  // of pairs, a class
constexpr std::size_t most_samples = 25;

struct Case {
  Index n = 10'000;
  std::string family = "gaussian";
  std::string method = "lattice";
  double spacings = 2.5;  // correlation length over the mean spacing of the points
  double tolerance = 1e-4;
  double seconds = 2;  // for the timing of further realizations
  int threads = 0;
  std::uint64_t realizations = 0;
  std::string points_file, pairs_file, values_file;
};

Case parse(CLI::App& app, int argc, char** argv) {
  Case c;
  app.add_option("--points", c.n, "points of the sphere")->check(CLI::Range(16, 100'000'000));
  app.add_option("--family", c.family, "autocorrelation family");
  app.add_option("--method", c.method, "cholesky or lattice");
  app.add_option("--length", c.spacings, "correlation length, in spacings of the points");
  app.add_option("--tolerance", c.tolerance, "covariance error asked for");
  app.add_option("--seconds", c.seconds, "time for further realizations");
  app.add_option("--threads", c.threads, "0: all cores");
  app.add_option("--points-file", c.points_file, "write the points: doubles, x y z each");
  app.add_option("--pairs-file", c.pairs_file, "write pairs of points: JSON");
  app.add_option("--values-file", c.values_file, "write heights at the pairs: doubles");
  app.add_option("--realizations", c.realizations, "of the values file");
  app.parse(argc, argv);
  return c;
}

AutocorrelationOptions autocorrelation_options(const Case& c) {
  const double length = c.spacings * bench::sphere_spacing(c.n);
  if (c.family == "gaussian") return {.family = Family::gaussian, .length = length};
  if (c.family == "exponential") return {.family = Family::exponential, .length = length};
  if (c.family == "matern") return {.family = Family::matern, .length = length, .nu = 1.5};
  if (c.family == "self-affine")
    return {.family = Family::self_affine, .length = length, .hurst = 0.8};
  if (c.family == "stretched") return {.family = Family::stretched, .length = length, .power = 1.4};
  if (c.family == "rational-quadratic")
    return {.family = Family::rational_quadratic, .length = length, .alpha = 1.0};
  throw InputError("--family: " + c.family + "; no such family");
}

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Bytes. Not from getrusage(), which also counts what the process was before its exec.
std::int64_t peak_memory() {
  std::ifstream status("/proc/self/status");
  std::string word;
  std::int64_t kilobytes = 0;
  while (status >> word)
    if (word == "VmHWM:") status >> kilobytes;
  return kilobytes * 1024;
}

/// Pairs about as far apart as the class says, one for each anchor; anchors cover the sphere.
struct PairClass {
  double distance;
  std::vector<std::pair<Index, Index>> pairs;
};

/// For each class the point whose distance to the anchor is nearest to that of the class.
void add_pairs(const std::vector<Vec3>& points, Index anchor, std::vector<PairClass>& classes) {
  std::vector<double> misses(classes.size(), INFINITY);
  for (PairClass& c : classes) c.pairs.emplace_back(anchor, anchor);
  for (Index i = 0; i < static_cast<Index>(points.size()); ++i) {
    const double r = (points[i] - points[anchor]).norm();
    for (std::size_t c = 0; c < classes.size(); ++c)
      if (const double miss = std::abs(r - classes[c].distance); miss < misses[c]) {
        misses[c] = miss;
        classes[c].pairs.back().second = i;
      }
  }
}

std::vector<PairClass> make_pairs(const std::vector<Vec3>& points, double length) {
  const auto n = static_cast<Index>(points.size());
  std::vector<PairClass> classes;
  for (const double lengths : {0.0, 0.4, 1.0, 2.0, 4.0}) classes.push_back({lengths * length, {}});
  const Index n_anchors = std::min(most_anchors, n / 2);
  for (Index k = 0; k < n_anchors; ++k)
    add_pairs(points, static_cast<Index>((k + 0.5) * n / n_anchors), classes);
  return classes;
}

void write_doubles(const std::string& path, const std::vector<double>& values) {
  std::ofstream file(path, std::ios::binary);
  file.write(reinterpret_cast<const char*>(values.data()),
             static_cast<std::streamsize>(values.size() * sizeof(double)));
  if (!file) throw InputError(path + ": cannot be written");
}

void write_points(const std::string& path, const std::vector<Vec3>& points) {
  std::vector<double> values;
  for (const Vec3& x : points) values.insert(values.end(), {x.x(), x.y(), x.z()});
  write_doubles(path, values);
}

void write_pairs(const std::string& path, const std::vector<PairClass>& classes,
                 const Correlation& correlation) {
  ordered_json all = ordered_json::array();
  for (const PairClass& c : classes) {
    ordered_json rho = ordered_json::array();
    for (const auto& [i, j] : c.pairs) rho.push_back(correlation(i, j));
    all.push_back({{"distance", c.distance}, {"pairs", c.pairs}, {"rho", rho}});
  }
  std::ofstream file(path);
  file << all.dump();
  if (!file) throw InputError(path + ": cannot be written");
}

/// Heights at both points of every pair, class by class, realization by realization.
void write_values(const Case& c, const FieldSampler& sampler,
                  const std::vector<PairClass>& classes) {
  std::vector<double> values;
  for (std::uint64_t realization = 0; realization < c.realizations; ++realization) {
    const std::vector<double> heights = sampler.heights(0, realization);
    for (const PairClass& pair_class : classes)
      for (const auto& [i, j] : pair_class.pairs)
        values.insert(values.end(), {heights[i], heights[j]});
  }
  write_doubles(c.values_file, values);
}

/// Largest |covariance - rho| over the pairs, by the tables of the sampler.
double exact_error(const std::vector<PairClass>& classes, const FieldSampler& sampler,
                   const Correlation& correlation) {
  double error = 0;
  for (const PairClass& c : classes)
    for (const auto& [i, j] : c.pairs)
      error = std::max(error, std::abs(sampler.covariance(i, j) - correlation(i, j)));
  return error;
}

ordered_json summary(const FieldSampler& sampler) {
  const FieldSummary& summary = sampler.summary();
  if (summary.cholesky)
    return {{"factorization", name(summary.cholesky->factorization)},
            {"rank", summary.cholesky->rank}};
  if (summary.lattice)
    return {{"terms", summary.lattice->terms.size()}, {"nugget", summary.lattice->nugget}};
  return {};
}

/// Times of realizations 1, 2, ...: at least one, then as many as the time allows.
std::vector<double> next_samples(const Case& c, const FieldSampler& sampler) {
  std::vector<double> times;
  const auto start = Clock::now();
  while (times.empty() || (seconds_since(start) < c.seconds && times.size() < most_samples)) {
    const auto sample_start = Clock::now();
    sampler.heights(0, times.size() + 1);
    times.push_back(seconds_since(sample_start));
  }
  return times;
}

ordered_json audited(const FieldSampler& sampler) {
  const auto start = Clock::now();
  const Audit audit = sampler.audit();
  return {{"error", audit.covariance_error},
          {"n_pairs", audit.n_pairs},
          {"seconds", seconds_since(start)}};
}

ordered_json measure(const Case& c, const Correlation& correlation,
                     const std::vector<PairClass>& pairs) {
  const std::int64_t memory_before = peak_memory();
  const FieldOptions options{.method = method_from_name(c.method), .tolerance = c.tolerance};
  const auto start = Clock::now();
  const FieldSampler sampler(correlation, options);
  const double prepare = seconds_since(start);
  sampler.heights(0, 0);
  const double first = seconds_since(start);
  const std::vector<double> times = next_samples(c, sampler);
  const std::int64_t memory = peak_memory();
  ordered_json result = {
      {"prepare_s", prepare},           {"first_s", first},  // with the preparation
      {"next_s", bench::median(times)}, {"n_next", times.size()},
      {"memory_bytes", memory},         {"sampler_bytes", memory - memory_before},
      {"summary", summary(sampler)},    {"audit", audited(sampler)}};
  if (!pairs.empty()) result["pairs_error"] = exact_error(pairs, sampler, correlation);
  if (!c.values_file.empty()) write_values(c, sampler, pairs);
  return result;
}

ordered_json run(const Case& c) {
  const detail::ThreadLimit limit(c.threads);
  const Autocorrelation autocorrelation(autocorrelation_options(c));
  std::vector<Vec3> points = bench::sphere_points(c.n);
  if (!c.points_file.empty()) write_points(c.points_file, points);
  std::vector<PairClass> pairs;
  if (!c.pairs_file.empty()) pairs = make_pairs(points, autocorrelation.length());
  const Correlation correlation(std::move(points), autocorrelation, Distance::euclidean());
  if (!c.pairs_file.empty()) write_pairs(c.pairs_file, pairs, correlation);
  ordered_json result = {{"tool", "roughmesh"},
                         {"method", c.method},
                         {"family", c.family},
                         {"n", c.n},
                         {"length", autocorrelation.length()},
                         {"tolerance", c.tolerance},
                         {"threads", limit.n_threads()}};
  result.update(measure(c, correlation, pairs));
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("One case of the benchmarks page");
  try {
    std::cout << run(parse(app, argc, argv)).dump() << '\n';
  } catch (const CLI::ParseError& error) {
    return app.exit(error);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
