// SPDX-License-Identifier: BSD-3-Clause
#include "lattice_level.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <hwy/aligned_allocator.h>

#include "roughmesh/error.hpp"

#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

/// Above any box of such a cell. The smallest cells that a body far larger than the scale can be
/// sorted into are larger.
constexpr double most_box_values = 0x1p21;

/// Axes along which the field of a Gaussian is constant add no error.
int n_varying(const LatticeSpace& space, double scale) {
  int n = 0;
  for (int axis = 0; axis < 3; ++axis)
    if (space.varies(axis) &&
        !(space.period(axis) > 0 && scale >= flat_periods * space.period(axis)))
      ++n;
  return n;
}

std::array<LatticeAxis, 3> make_axes(const LatticeSpace& space, double scale,
                                     const KernelWidth& width) {
  std::array<LatticeAxis, 3> axes;
  for (int a = 0; a < 3; ++a) {
    if (!space.varies(a)) continue;
    axes[static_cast<std::size_t>(a)] = space.period(a) > 0
                                            ? LatticeAxis(scale, width, space.period(a))
                                            : LatticeAxis(scale, width);
  }
  return axes;
}

/// Estimated work for a place, in multiply-adds: its kernel, and its share of the noise, of which
/// places on a surface have a layer as thick as a kernel.
double work(const KernelWidth& width, double scale, double distance, int n_axes) {
  constexpr double noise = 18;  // multiply-adds in the time of a number
  const double kernel = std::pow(width.n_points, n_axes);
  const double neighbours = distance / (width.spacing * scale);
  const double share = 1.5 * width.n_points * std::pow(neighbours, n_axes - 1);
  return kernel + noise * std::min(kernel, share);
}

/// Room for the values of a box.
class BoxValues {
 public:
  /// At least n numbers, finite, aligned as a box needs them.
  double* make_room(std::size_t n) {
    if (n > size_) {
      values_ = hwy::AllocateAligned<double>(n);
      std::fill_n(values_.get(), n, 0.0);
      size_ = n;
    }
    return values_.get();
  }

 private:
  hwy::AlignedFreeUniquePtr<double[]> values_;
  std::size_t size_ = 0;
};

/// What one cell needs, kept from one cell to the next.
struct Workspace {
  std::vector<std::uint32_t> members;
  std::vector<std::int64_t> first_points;         ///< three for each member
  std::vector<std::int32_t> lowest, highest;      ///< along the third axis, for each column
  std::vector<std::int32_t> low_line, high_line;  ///< the same, of members along one line
  std::vector<NoiseRun> runs;
  BoxValues values;
  std::vector<double> sums;  ///< of each member
};

using Indices = std::array<std::int64_t, 3>;

/// The work on one cell: which lattice points its members reach, their noise, the sums.
class CellSum {
 public:
  CellSum(const LatticeLevel& level, Workspace& work) : level_(level), work_(work) {}

  void find_members(SortedPlaces::Range range, std::span<const std::uint8_t> n_skipped,
                    int number) {
    work_.members.clear();
    for (std::size_t i = range.first; i < range.second; ++i)
      if (n_skipped.empty() || n_skipped[i] <= number)
        work_.members.push_back(static_cast<std::uint32_t>(i));
  }

  bool has_members() const { return !work_.members.empty(); }

  /// Finds the box of the members; false if it is too large for several of them.
  bool bound(const std::vector<Vec3>& places) {
    Indices end;
    box_.first.fill(std::numeric_limits<std::int64_t>::max());
    end.fill(std::numeric_limits<std::int64_t>::min());
    work_.first_points.resize(3 * work_.members.size());
    std::int64_t* point = work_.first_points.data();
    for (const std::uint32_t i : work_.members)
      for (std::size_t a = 0; a < 3; ++a, ++point) {
        const LatticeAxis& axis = level_.axes[a];
        *point = axis.varies() ? axis.first_point(places[i][static_cast<int>(a)]) : 0;
        box_.first[a] = std::min(box_.first[a], *point);
        end[a] = std::max(end[a], *point + axis.n_points());
      }
    box_.first[2] = first_of_column(box_.first[2]);
    for (std::size_t a = 0; a < 3; ++a) box_.size[a] = end[a] - box_.first[a];
    const double n_values = static_cast<double>(box_.size[0]) * static_cast<double>(box_.size[1]) *
                            static_cast<double>(box_.column_length());
    return n_values <= most_box_values || work_.members.size() == 1;
  }

  void add(const LatticeNoise& noise, const SortedPlaces& places, std::span<double> heights) {
    box_.values = work_.values.make_room(static_cast<std::size_t>(box_.n_values()));
    mark_columns();
    make_runs();
    noise.fill(work_.runs);
    work_.sums.resize(work_.members.size());
    gather(level_.axes, box_, work_.members, places.places().data(), work_.sums.data());
    const double factor = std::sqrt(level_.weight);
    for (std::size_t m = 0; m < work_.members.size(); ++m)
      heights[places.order()[work_.members[m]]] += factor * work_.sums[m];
  }

 private:
  int n_points(int axis) const { return level_.axes[static_cast<std::size_t>(axis)].n_points(); }

  /// The noise of a column is needed from the lowest to the highest member that reaches it: of the
  /// members whose first point is in the column, then of those along the second axis, then of those
  /// along the first.
  void mark_columns() {
    constexpr std::int32_t none = std::numeric_limits<std::int32_t>::max();
    const auto n_columns = static_cast<std::size_t>(box_.size[0] * box_.size[1]);
    work_.lowest.assign(n_columns, none);
    work_.highest.assign(n_columns, 0);
    work_.low_line.assign(n_columns, none);
    work_.high_line.assign(n_columns, 0);
    mark_lines();
    const auto nx = static_cast<std::size_t>(box_.size[0]),
               ny = static_cast<std::size_t>(box_.size[1]);
    for (std::size_t x = 0; x < nx; ++x) {
      const std::size_t first = x + 1 - std::min(x + 1, static_cast<std::size_t>(n_points(0)));
      for (std::size_t from = first; from <= x; ++from)
        for (std::size_t y = 0; y < ny; ++y) {
          std::int32_t &low = work_.lowest[x * ny + y], &high = work_.highest[x * ny + y];
          low = std::min(low, work_.low_line[from * ny + y]);
          high = std::max(high, work_.high_line[from * ny + y]);
        }
    }
  }

  void mark_lines() {
    const std::int64_t* before = nullptr;
    for (std::size_t m = 0; m < work_.members.size(); ++m) {
      const std::int64_t* const point = work_.first_points.data() + 3 * m;
      if (before != nullptr && std::equal(point, point + 3, before)) continue;
      before = point;
      const auto low = static_cast<std::int32_t>(point[2] - box_.first[2]);
      const std::int32_t high = low + n_points(2);
      const std::int64_t column =
          (point[0] - box_.first[0]) * box_.size[1] + (point[1] - box_.first[1]);
      std::int32_t* const lowest = work_.low_line.data() + column;
      std::int32_t* const highest = work_.high_line.data() + column;
      for (int j = 0; j < n_points(1); ++j) {
        lowest[j] = std::min(lowest[j], low);
        highest[j] = std::max(highest[j], high);
      }
    }
  }

  void make_runs() {
    work_.runs.clear();
    for (std::int64_t x = 0; x < box_.size[0]; ++x)
      for (std::int64_t y = 0; y < box_.size[1]; ++y) {
        const auto column = static_cast<std::size_t>(x * box_.size[1] + y);
        if (work_.highest[column] == 0) continue;
        const std::int64_t low = work_.lowest[column], n = work_.highest[column] - low;
        append_runs(level_.axes, {box_.first[0] + x, box_.first[1] + y, box_.first[2] + low}, n,
                    box_.column(x, y) + low, work_.runs);
      }
  }

  const LatticeLevel& level_;
  Workspace& work_;
  LatticeBox box_;
};

AxisRow row(const LatticeAxis& axis, double x) {
  const AxisWeights weights = kernel_weights(axis, x);
  AxisRow row{weights.first, axis.n_points(), {}};
  std::copy_n(weights.weight.begin(), row.size, row.value.begin());
  return row;
}

}  // namespace

void append_runs(const std::array<LatticeAxis, 3>& axes, const std::array<std::int64_t, 3>& first,
                 std::int64_t n, double* values, std::vector<NoiseRun>& runs) {
  const LatticeAxis& along = axes[2];
  NoiseRun run;
  run.x = axes[0].wrapped(first[0]);
  run.y = axes[1].wrapped(first[1]);
  for (std::int64_t done = 0; done < n; done += run.n) {
    run.z = along.wrapped(first[2] + done);
    const std::int64_t left = n - done;
    run.n = static_cast<std::int32_t>(
        along.n_period() > 0 ? std::min(left, along.n_period() - run.z) : left);
    run.values = values + done;
    runs.push_back(run);
  }
}

std::vector<LatticeLevel> make_levels(std::span<const MixtureTerm> terms, const LatticeSpace& space,
                                      double error, double distance) {
  const std::span<const KernelWidth> widths = kernel_widths();
  std::vector<std::size_t> width(terms.size(), 0);
  const auto error_of = [&](std::size_t k, std::size_t w) {
    return terms[k].weight * n_varying(space, terms[k].scale) * widths[w].error;
  };
  // Errors of different axes and levels oscillate with incommensurable periods: what they add up to
  // stays within three standard deviations of a sum of random phases, or the sum of all.
  const auto total = [&] {
    double sum = 0, squares = 0;
    for (std::size_t k = 0; k < terms.size(); ++k) {
      const double e = error_of(k, width[k]);
      sum += e;
      if (e > 0) squares += e * e / n_varying(space, terms[k].scale);
    }
    return std::min(sum, 3 * std::sqrt(squares / 2));
  };
  // Widens the kernel that gains most for the work it adds.
  const auto gain = [&](std::size_t k) {
    const std::size_t w = width[k];
    if (w + 1 == widths.size()) return 0.0;
    const int n = space.n_varying();
    return (error_of(k, w) - error_of(k, w + 1)) /
           (work(widths[w + 1], terms[k].scale, distance, n) -
            work(widths[w], terms[k].scale, distance, n));
  };
  while (total() > error) {
    std::size_t best = 0;
    for (std::size_t k = 1; k < terms.size(); ++k)
      if (gain(k) > gain(best)) best = k;
    if (width[best] + 1 == widths.size())
      throw InputError(fmt::format(
          "--tolerance: too small for the method lattice, whose kernels reach {:g}; use a larger "
          "one or --method cholesky",
          widths.back().error));
    ++width[best];
  }
  std::vector<LatticeLevel> levels;
  for (std::size_t k = 0; k < terms.size(); ++k)
    levels.push_back({terms[k].level, terms[k].scale, terms[k].weight, error_of(k, width[k]),
                      make_axes(space, terms[k].scale, widths[width[k]])});
  return levels;
}

void add_level(const LatticeLevel& level, const NoiseStream& stream, const SortedPlaces& places,
               std::span<const std::uint8_t> n_skipped, int number, std::span<double> heights) {
  const LatticeNoise noise(stream, level.key);
  int n_axes = 0;
  double spacing = 0;
  for (const LatticeAxis& axis : level.axes) {
    if (!axis.varies()) continue;
    ++n_axes;
    spacing = std::max(spacing, 1 / axis.inverse_spacing());
  }
  const std::vector<SortedPlaces::Range> cells = places.cells(
      n_axes == 0 ? std::numeric_limits<double>::max() : spacing * cell_points(n_axes));
  PerThread<Workspace> workspaces;
  const std::function<void(SortedPlaces::Range)> add_range = [&](SortedPlaces::Range range) {
    CellSum sum(level, workspaces.local());
    sum.find_members(range, n_skipped, number);
    if (!sum.has_members()) return;
    if (sum.bound(places.places())) return sum.add(noise, places, heights);
    const std::size_t middle = (range.first + range.second) / 2;
    add_range({range.first, middle});
    add_range({middle, range.second});
  };
  parallel_for(cells.size(), 1, [&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) add_range(cells[c]);
  });
}

double level_covariance(const LatticeLevel& level, const Vec3& x, const Vec3& y) {
  double product = level.weight;
  for (std::size_t a = 0; a < 3 && product != 0; ++a) {
    const LatticeAxis& axis = level.axes[a];
    const auto k = static_cast<int>(a);
    product *= row_product(axis, row(axis, x[k]), row(axis, y[k]));
  }
  return product;
}

}  // namespace roughmesh::detail
