// SPDX-License-Identifier: BSD-3-Clause
#include "mixture_samples.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "image_sum.hpp"
#include "scale_quadrature.hpp"

namespace roughmesh::detail {
namespace {

constexpr double longest_reach = 1e12;  // in correlation lengths

// From begin to end, both included, evenly spaced in the logarithm.
std::vector<double> octaves(double begin, double end, int per_octave) {
  if (!(begin <= end)) return {};
  const double n = std::ceil(std::log2(end / begin) * per_octave);
  std::vector<double> result;
  for (double k = 0; k < n; ++k) result.push_back(begin * std::pow(end / begin, k / n));
  result.push_back(end);
  return result;
}

double shortest_period(const MixtureSpace& space) {
  double shortest = std::numeric_limits<double>::infinity();
  for (std::size_t axis = 0; axis < space.n_axes(); ++axis)
    if (space.period(axis) > 0) shortest = std::min(shortest, space.period(axis));
  return shortest;
}

// Quadrature over scales: those below a ninth of a distance add nothing there.
std::vector<GaussianTerm> shares_of(const Autocorrelation& autocorrelation,
                                    const MixtureSpace& space, double nearest) {
  const int n = space.n_periodic_axes();
  if (n == 0) return {};
  require_image_sum(autocorrelation, n);
  double largest = longest_reach * autocorrelation.length();
  for (std::size_t axis = 0; axis < space.n_axes(); ++axis)
    largest = std::max(largest, space.period(axis));
  const double smallest = std::min(nearest, shortest_period(space) / 2) / 10;
  return space.shares(scale_quadrature(autocorrelation, {smallest, largest}, n));
}

}  // namespace

MixtureTarget::MixtureTarget(const Autocorrelation& autocorrelation, const MixtureSpace& space,
                             double nearest)
    : autocorrelation_(autocorrelation),
      space_(space),
      nearest_(nearest),
      shares_(shares_of(autocorrelation, space, nearest)) {}

double MixtureTarget::operator()(const MixtureSpace::Coordinates& x) const {
  if (shares_.empty()) return autocorrelation_.rho(x[0]);
  double sum = 0;
  for (const GaussianTerm& term : shares_) sum += term.weight * space_.gaussian(x, term.scale);
  return sum;
}

double MixtureTarget::reach(double level) const {
  if (space_.is_bounded()) return nearest_;
  const double longest = longest_reach * autocorrelation_.length();
  const auto rho = [&](double r) {
    MixtureSpace::Coordinates x{};
    x[space_.n_axes() - 1] = r;
    return (*this)(x);
  };
  double low = nearest_, high = nearest_;
  while (high < longest && rho(high) > level) {
    low = high;
    high *= 2;
  }
  while (high > 1.05 * low) {
    const double middle = std::sqrt(low * high);
    (rho(middle) > level ? low : high) = middle;
  }
  return std::max(nearest_, std::min(high, longest));
}

MixtureSamples::MixtureSamples(const MixtureTarget& target, double reach, const Density& density)
    : space_(target.space()), nearest_(target.nearest()), reach_(reach) {
  for (std::size_t axis = 0; axis < space_.n_axes(); ++axis) {
    coordinates_[axis] = {0};
    add_axis(axis, density.on_axes);
  }
  if (space_.n_axes() > 1) add_grid(density.of_grid);
  if (samples_.empty()) add_corner();
  target_ = values(target);
}

std::size_t MixtureSamples::add(std::size_t axis, double coordinate) {
  coordinates_[axis].push_back(coordinate);
  return coordinates_[axis].size() - 1;
}

double MixtureSamples::end(std::size_t axis) const {
  return space_.period(axis) > 0 ? space_.period(axis) / 2 : reach_;
}

// At the nearest distances the smallest Gaussians fall off steeply.
void MixtureSamples::add_axis(std::size_t axis, int per_octave) {
  const double steep_end = nearest_ * std::exp2(0.25);
  std::vector<double> line = octaves(nearest_, std::min(steep_end, end(axis)), 4 * per_octave);
  for (const double coordinate : octaves(steep_end, end(axis), per_octave))
    line.push_back(coordinate);
  for (const double coordinate : line) {
    Places sample{};
    sample[axis] = add(axis, coordinate);
    samples_.push_back(sample);
  }
}

// 0 and coordinates up to the end. Off the axes the sum over images depends on directions only
// where some coordinate is not small beside its period.
std::vector<std::size_t> MixtureSamples::grid_places(std::size_t axis, int per_octave) {
  std::vector<std::size_t> result = {0};
  if (axis >= space_.n_axes()) return result;
  std::vector<double> line = octaves(shortest_period(space_) / 32, end(axis), per_octave);
  if (line.empty()) line = {end(axis)};
  for (const double coordinate : line) result.push_back(add(axis, coordinate));
  return result;
}

void MixtureSamples::add_grid(int per_octave) {
  const std::vector<std::size_t> first = grid_places(0, per_octave);
  const std::vector<std::size_t> second = grid_places(1, per_octave);
  const std::vector<std::size_t> third = grid_places(2, per_octave);
  for (const std::size_t i : first)
    for (const std::size_t j : second)
      for (const std::size_t k : third)
        if ((i > 0) + (j > 0) + (k > 0) > 1) add_far({i, j, k});
}

// Displacements shorter than the nearest do not count.
void MixtureSamples::add_far(const Places& sample) {
  const MixtureSpace::Coordinates x = at(sample);
  if (std::hypot(x[0], x[1], x[2]) >= nearest_) samples_.push_back(sample);
}

// In a cell smaller than the nearest displacement, its corner.
void MixtureSamples::add_corner() {
  Places corner{};
  for (std::size_t axis = 0; axis < space_.n_axes(); ++axis) corner[axis] = add(axis, end(axis));
  samples_.push_back(corner);
}

MixtureSpace::Coordinates MixtureSamples::at(const Places& sample) const {
  MixtureSpace::Coordinates x{};
  for (std::size_t axis = 0; axis < space_.n_axes(); ++axis)
    x[axis] = coordinates_[axis][sample[axis]];
  return x;
}

Eigen::VectorXd MixtureSamples::gaussian(double scale) const {
  std::array<std::vector<double>, MixtureSpace::most_axes> factors;
  for (std::size_t axis = 0; axis < space_.n_axes(); ++axis) {
    const double peak = space_.images(axis, 0, scale);
    for (const double x : coordinates_[axis])
      factors[axis].push_back(space_.images(axis, x, scale) / peak);
  }
  Eigen::VectorXd result(static_cast<Eigen::Index>(samples_.size()));
  for (std::size_t i = 0; i < samples_.size(); ++i) {
    double product = 1;
    for (std::size_t axis = 0; axis < space_.n_axes(); ++axis)
      product *= factors[axis][samples_[i][axis]];
    result[static_cast<Eigen::Index>(i)] = product;
  }
  return result;
}

Eigen::VectorXd MixtureSamples::values(const MixtureTarget& target) const {
  Eigen::VectorXd result = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(samples_.size()));
  for (const GaussianTerm& term : target.shares()) result += term.weight * gaussian(term.scale);
  if (target.shares().empty())
    for (std::size_t i = 0; i < samples_.size(); ++i)
      result[static_cast<Eigen::Index>(i)] = target(at(samples_[i]));
  return result;
}

}  // namespace roughmesh::detail
