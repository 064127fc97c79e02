// SPDX-License-Identifier: BSD-3-Clause
#include "field_lattice.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include <fmt/format.h>

#include "free_memory.hpp"
#include "lattice_coarse.hpp"
#include "lattice_level.hpp"
#include "lattice_terms.hpp"
#include "normal_transform.hpp"
#include "parallel.hpp"

namespace roughmesh::detail {
namespace {

constexpr double smallest_tolerance = 1e-8;
constexpr double bytes_per_point = 100;

/// Noise that only places within 1e-9 of the correlation length share, keyed by the place.
class Nugget {
 public:
  explicit Nugget(double length) : per_length_(0x1p30 / length) {}

  using Key = std::array<std::uint64_t, 3>;

  Key key(const Vec3& place) const {
    Key key{};
    for (int a = 0; a < 3; ++a) {
      const double number = std::floor(place[a] * per_length_ + 0.618);
      // So far from the origin that the number has no integer, its bits stand for it.
      key[static_cast<std::size_t>(a)] =
          std::abs(number) < 0x1p62 ? static_cast<std::uint64_t>(static_cast<std::int64_t>(number))
                                    : std::bit_cast<std::uint64_t>(number);
    }
    return key;
  }

  /// The fourth word of the counter is 4 nowhere else.
  static double noise(const NoiseStream& stream, const Key& key) {
    const auto words = random_words(stream, {key[0], key[1], key[2], 4});
    return box_muller(words[0], words[1])[0];
  }

 private:
  double per_length_;
};

class LatticeField final : public FieldMethod {
 public:
  LatticeField(const Correlation& correlation, const FieldOptions& options)
      : FieldMethod(correlation),
        space_(correlation.distance(), options.dimension),
        mixture_space_(correlation.distance()),
        nugget_(correlation.autocorrelation().length()),
        is_cut_(options.cutoff.has_value()),
        places_(stretched(options.tolerance), correlation.autocorrelation().length()) {
    prepare(options);
  }

  std::vector<double> heights(const NoiseStream& stream) const override {
    std::vector<double> heights(places_.size(), 0.0);
    for (std::size_t k = 0; k < levels_.size(); ++k)
      add_level(levels_[k], stream, places_, n_skipped_, static_cast<int>(k), heights);
    coarse_.add(stream, places_, heights);
    add_nugget(stream, heights);
    return heights;
  }

  std::vector<double> covariances(std::span<const PointPair> pairs) const override {
    std::vector<double> result(pairs.size());
    parallel_for(pairs.size(), 64, [&](std::size_t begin, std::size_t end) {
      for (std::size_t p = begin; p < end; ++p)
        result[p] = covariance(position(pairs[p].first), position(pairs[p].second));
    });
    return result;
  }

  double target(Index i, Index j) const override {
    if (!is_cut_) return FieldMethod::target(i, j);
    const std::span<const Vec3> points = correlation().places();
    return mixture_value(mixture_, mixture_space_, points[i] - points[j]);
  }

  FieldSummary summary() const {
    FieldSummary summary;
    summary.method = Method::lattice;
    LatticeSummary& lattice = summary.lattice.emplace();
    for (const MixtureTerm& term : mixture_.terms)
      lattice.terms.push_back({term.weight, term.scale});
    lattice.nugget = mean_nugget();
    lattice.lost_variance = lost_variance_;
    lattice.same_on_other_meshes =
        (is_cut_ && has_cells_of_all_meshes_) || is_one_gaussian(correlation().autocorrelation());
    return summary;
  }

 private:
  std::vector<Vec3> stretched(double tolerance) {
    const std::span<const Vec3> points = correlation().places();
    std::vector<Vec3> result(points.size());
    parallel_for(points.size(), 8192, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) result[i] = space_(points[i]);
    });
    for (const Vec3& x : result)
      largest_coordinate_ = std::max(largest_coordinate_, x.cwiseAbs().maxCoeff());
    // No scale is worth more than the length here; the rest is checked when they are known.
    require_small_error(1e-3 * std::numeric_limits<double>::epsilon() * largest_coordinate_ /
                            correlation().autocorrelation().length(),
                        tolerance);
    return result;
  }

  void prepare(const FieldOptions& options) {
    LatticeTerms terms = choose_terms(correlation(), options, space_, places_);
    n_skipped_ = std::move(terms.n_skipped);
    lost_variance_ = terms.lost_variance;
    set_levels(terms);
    mixture_ = std::move(terms.mixture);
    require_digits(options.tolerance);
  }

  void set_levels(const LatticeTerms& chosen) {
    const CoarseTerms& coarse = chosen.coarse;
    has_cells_of_all_meshes_ = !coarse.is_enlarged;
    levels_ = make_levels(chosen.mixture.terms, space_, chosen.lattice_error, chosen.distance);
    const auto first_coarse = levels_.begin() + static_cast<std::ptrdiff_t>(coarse.first);
    coarse_ = CoarseLevels({first_coarse, levels_.end()}, space_, coarse.cell, coarse.n_stages,
                           coarse.error);
    levels_.erase(first_coarse, levels_.end());
  }

  /// Places are told apart in units of the last digit of their coordinates, which shifts kernels
  /// by parts of their width.
  void require_digits(double tolerance) const {
    double error = 0;
    for (const MixtureTerm& term : mixture_.terms)
      error += term.weight * largest_coordinate_ / term.scale;
    require_small_error(error * std::numeric_limits<double>::epsilon(), tolerance);
  }

  void require_small_error(double error, double tolerance) const {
    if (error < 0.1 * tolerance) return;
    throw InputError(fmt::format(
        "places are up to {:.3g} from the origin, where their digits are too coarse for a "
        "correlation length of {:g}; move the mesh nearer to the origin, check --length or raise "
        "--tolerance",
        largest_coordinate_, correlation().autocorrelation().length()));
  }

  /// Among the sorted places.
  std::size_t position(Index point) const {
    return places_.position(static_cast<std::uint32_t>(point),
                            space_(correlation().places()[static_cast<std::size_t>(point)]));
  }

  std::size_t n_skipped(std::size_t i) const { return n_skipped_.empty() ? 0 : n_skipped_[i]; }

  double nugget_share_of(std::size_t i) const {
    double share = mixture_.nugget;
    for (std::size_t k = 0; k < n_skipped(i); ++k) share += levels_[k].weight;
    return share;
  }

  double mean_nugget() const {
    double sum = 0;
    for (std::size_t i = 0; i < places_.size(); ++i) sum += nugget_share_of(i);
    return sum / static_cast<double>(places_.size());
  }

  void add_nugget(const NoiseStream& stream, std::span<double> heights) const {
    if (mixture_.nugget == 0 && n_skipped_.empty()) return;
    parallel_for(heights.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        const double share = nugget_share_of(i);
        if (share > 0)
          heights[places_.order()[i]] +=
              std::sqrt(share) * Nugget::noise(stream, nugget_.key(places_.places()[i]));
      }
    });
  }

  double covariance(std::size_t i, std::size_t j) const {
    const Vec3 &x = places_.places()[i], &y = places_.places()[j];
    double sum = 0;
    for (std::size_t k = std::max(n_skipped(i), n_skipped(j)); k < levels_.size(); ++k)
      sum += level_covariance(levels_[k], x, y);
    sum += coarse_.covariance(x, y);
    if (nugget_.key(x) == nugget_.key(y))
      sum += std::sqrt(nugget_share_of(i)) * std::sqrt(nugget_share_of(j));
    return sum;
  }

  LatticeSpace space_;
  MixtureSpace mixture_space_;
  double largest_coordinate_ = 0;
  Nugget nugget_;
  bool is_cut_;
  SortedPlaces places_;
  std::vector<LatticeLevel> levels_;     ///< ascending in scale; places sum each by itself
  CoarseLevels coarse_;                  ///< the rest
  std::vector<std::uint8_t> n_skipped_;  ///< levels that a sorted place does without; empty: none
  ScaleMixture mixture_;
  double lost_variance_ = 0;
  bool has_cells_of_all_meshes_ = true;
};

void require_reachable(double tolerance) {
  if (tolerance >= smallest_tolerance) return;
  throw InputError(
      fmt::format("--tolerance {:g}: below {:g}, which the method lattice can reach; use a larger "
                  "one or --method cholesky",
                  tolerance, smallest_tolerance));
}

}  // namespace

std::string lattice_obstacle(const Correlation& correlation) {
  const DistanceKind kind = correlation.distance().kind();
  const Autocorrelation& autocorrelation = correlation.autocorrelation();
  if (kind != DistanceKind::euclidean && kind != DistanceKind::periodic)
    return fmt::format(
        "--method lattice: distance {} is none of space; use --method cholesky or "
        "--distance euclidean",
        name(kind));
  if (autocorrelation.family() == Family::table && autocorrelation.gaussian_terms().empty())
    return fmt::format(
        "--method lattice: the table is met by no mixture of Gaussians (the best leaves {:.3g}); "
        "use --method cholesky",
        autocorrelation.fit_residual().value_or(1));
  return {};
}

PreparedField prepare_lattice(const Correlation& correlation, const FieldOptions& options) {
  const std::string obstacle = lattice_obstacle(correlation);
  if (!obstacle.empty()) throw InputError(obstacle);
  require_reachable(options.tolerance);
  require_memory(bytes_per_point * static_cast<double>(correlation.n_points()),
                 fmt::format("field of {} points", correlation.n_points()), "use a coarser mesh");
  auto field = std::make_unique<LatticeField>(correlation, options);
  PreparedField prepared;
  prepared.summary = field->summary();
  prepared.citations = {
      "Salmon, Moraes, Dror, Shaw (2011), Parallel random numbers: as easy as 1, 2, 3, "
      "doi:10.1145/2063384.2063405",
      "Schoenberg (1938), Metric spaces and completely monotone functions, doi:10.2307/1968466",
      "Higdon (2002), Space and space-time modeling using process convolutions, "
      "doi:10.1007/978-1-4471-0657-9_2"};
  prepared.method = std::move(field);
  return prepared;
}

}  // namespace roughmesh::detail
