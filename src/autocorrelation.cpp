// SPDX-License-Identifier: BSD-3-Clause
#include "roughmesh/autocorrelation.hpp"

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include <fmt/format.h>

#include "autocorrelation_table.hpp"
#include "gamma_function.hpp"
#include "matern.hpp"
#include "spectrum_share.hpp"

namespace roughmesh {
namespace {

constexpr std::array<std::pair<Family, std::string_view>, 7> family_names = {
    {{Family::gaussian, "gaussian"},
     {Family::exponential, "exponential"},
     {Family::matern, "matern"},
     {Family::self_affine, "self-affine"},
     {Family::stretched, "stretched"},
     {Family::rational_quadratic, "rational-quadratic"},
     {Family::table, "table"}}};

constexpr std::array<std::pair<LengthDefinition, std::string_view>, 4> definition_names = {
    {{LengthDefinition::formula, "formula"},
     {LengthDefinition::one_over_e, "one-over-e"},
     {LengthDefinition::integral, "integral"},
     {LengthDefinition::sal, "sal"}}};

template <class Names, class Value>
std::string_view name_in(const Names& names, Value value) {
  for (const auto& [candidate, name] : names)
    if (candidate == value) return name;
  return {};
}

// One optional parameter, the family it belongs to and the values it may take: below `below`, or up
// to and including `at_most`.
struct Parameter {
  std::string_view option;
  std::optional<double> value;
  Family family;
  double at_most = std::numeric_limits<double>::max();
  double below = std::numeric_limits<double>::infinity();
};

void check_range(const Parameter& parameter) {
  const double value = *parameter.value;
  if (value > 0 && value <= parameter.at_most && value < parameter.below) return;
  std::string range = "greater than 0 and finite";
  if (parameter.below <= 1) range = fmt::format("between 0 and {}, exclusive", parameter.below);
  if (parameter.at_most <= 2)
    range = fmt::format("greater than 0 and at most {}", parameter.at_most);
  throw InputError(fmt::format("{} is {}; it must be {}", parameter.option, value, range));
}

std::array<Parameter, 5> family_parameters(const AutocorrelationOptions& options) {
  return {{{.option = "--nu", .value = options.nu, .family = Family::matern},
           {.option = "--hurst", .value = options.hurst, .family = Family::self_affine, .below = 1},
           {.option = "--rolloff", .value = options.rolloff, .family = Family::self_affine},
           {.option = "--power", .value = options.power, .family = Family::stretched, .at_most = 2},
           {.option = "--alpha", .value = options.alpha, .family = Family::rational_quadratic}}};
}

void check_parameters(const AutocorrelationOptions& options) {
  for (const Parameter& parameter : family_parameters(options)) {
    if (!parameter.value) continue;
    if (parameter.family != options.family)
      throw InputError(fmt::format(
          "{} is given, but belongs to the autocorrelation family {}, not to {}; leave it out",
          parameter.option, name(parameter.family), name(options.family)));
    check_range(parameter);
  }
}

// The one parameter besides the length.
double required_shape(const AutocorrelationOptions& options) {
  for (const Parameter& parameter : family_parameters(options)) {
    if (parameter.family != options.family || parameter.option == "--rolloff") continue;
    if (!parameter.value)
      throw InputError(fmt::format("the autocorrelation family {} needs {}", name(options.family),
                                   parameter.option));
    return *parameter.value;
  }
  return 0;
}

// A table is its own scale.
void check_table(const AutocorrelationOptions& options) {
  if (options.family != Family::table) {
    if (options.table.empty()) return;
    throw InputError(
        fmt::format("--table is given, but belongs to the autocorrelation family table, not to {}; "
                    "leave it out",
                    name(options.family)));
  }
  if (options.table.empty())
    throw InputError("the autocorrelation family table needs --table, a file of pairs r, rho");
  if (options.length || options.length_definition != LengthDefinition::formula)
    throw InputError(
        "--length and --length-definition do not go with --acf table: the scale is in the table; "
        "leave them out");
}

// Length and roll-off exclude each other; the roll-off is a wavelength, whatever --length means.
void check_length(const AutocorrelationOptions& options) {
  if (options.length) {
    check_range({.option = "--length", .value = options.length, .family = options.family});
    if (options.rolloff)
      throw InputError("--length and --rolloff are both given; give one of them");
    return;
  }
  if (!options.rolloff)
    throw InputError(options.family == Family::self_affine
                         ? "the autocorrelation family self-affine needs --length or --rolloff"
                         : "--length, the correlation length, is not given");
  if (options.length_definition != LengthDefinition::formula)
    throw InputError(
        fmt::format("--length-definition {} applies to --length, not to --rolloff; "
                    "leave it out or give --length",
                    name(options.length_definition)));
}

// -log rho at the two levels that define lengths.
constexpr double one_over_e_depth = 1;
const double sal_depth = std::log(5.0);  // rho = 0.2

// The x at which the Matern function is exp(-depth), by bisection on its binary logarithm, which
// reaches every double.
double matern_decay_distance(double nu, double depth) {
  double low = -1074, high = 1023;
  for (int halvings = 0; halvings < 64; ++halvings) {
    const double middle = (low + high) / 2;
    (-detail::log_matern(nu, std::exp2(middle)) < depth ? low : high) = middle;
  }
  return std::exp2((low + high) / 2);
}

// Distance over l at which rho = exp(-depth); infinite where a double cannot hold it.
double decay_distance(Family family, double shape, double depth) {
  switch (family) {
    case Family::gaussian:
      return std::sqrt(2 * depth);
    case Family::exponential:
      return depth;
    case Family::matern:
    case Family::self_affine:
      return matern_decay_distance(shape, depth);
    case Family::stretched:
      return std::pow(depth, 1 / shape);
    case Family::table:
      break;
    case Family::rational_quadratic:
      return std::sqrt(-2 * shape * std::expm1(-depth / shape)) * std::exp(depth / shape / 2);
  }
  return 0;
}

// Integral of rho over r / l; infinite where it diverges or a double cannot hold it.
double integral_scale(Family family, double shape) {
  const double half_pi = std::numbers::pi / 2;
  switch (family) {
    case Family::gaussian:
      return std::sqrt(half_pi);
    case Family::exponential:
      return 1;
    case Family::matern:
    case Family::self_affine:
      return std::sqrt(half_pi / shape) * detail::gamma_ratio(shape);
    case Family::stretched:
      return std::tgamma(1 + 1 / shape);
    case Family::table:
      break;
    case Family::rational_quadratic:
      if (shape <= 0.5) return std::numeric_limits<double>::infinity();
      return std::sqrt(half_pi * shape) / detail::gamma_ratio(shape - 0.5);
  }
  return 0;
}

EquivalentLengths lengths_of(Family family, double shape, double length) {
  EquivalentLengths result;
  result.formula = length;
  result.one_over_e = length * decay_distance(family, shape, one_over_e_depth);
  result.sal = length * decay_distance(family, shape, sal_depth);
  const double integral = length * integral_scale(family, shape);
  if (std::isfinite(integral)) result.integral = integral;
  return result;
}

// The definition's length when l = 1.
double definition_factor(const AutocorrelationOptions& options, double shape) {
  const EquivalentLengths unit = lengths_of(options.family, shape, 1);
  switch (options.length_definition) {
    case LengthDefinition::formula:
      return 1;
    case LengthDefinition::one_over_e:
      return unit.one_over_e;
    case LengthDefinition::sal:
      return unit.sal;
    case LengthDefinition::integral:
      break;
  }
  if (options.family == Family::rational_quadratic && shape <= 0.5)
    throw InputError(
        fmt::format("--length-definition integral does not exist for "
                    "rational-quadratic with --alpha {}; it needs --alpha above 0.5",
                    shape));
  return unit.integral.value_or(std::numeric_limits<double>::infinity());
}

EquivalentLengths lengths_of(const detail::AutocorrelationTable& table) {
  return {.formula = {},
          .one_over_e = table.decay_distance(std::exp(-one_over_e_depth)),
          .integral = table.integral(),
          .sal = table.decay_distance(std::exp(-sal_depth))};
}

double formula_length(const AutocorrelationOptions& options, double shape) {
  // Roll-off wavenumber q_r = sqrt(2 H) / l (docs/math.md, eq. 7).
  if (options.rolloff) return std::sqrt(2 * shape) * *options.rolloff / (2 * std::numbers::pi);
  if (options.length_definition == LengthDefinition::formula) return *options.length;
  const double length = *options.length / definition_factor(options, shape);
  if (length > 0 && std::isfinite(length)) return length;
  throw InputError(
      fmt::format("--length {} by --length-definition {} gives a correlation length "
                  "of {} for {}; give --length by another definition",
                  *options.length, name(options.length_definition), length, name(options.family)));
}

}  // namespace

std::string_view name(Family family) { return name_in(family_names, family); }

std::string_view name(LengthDefinition definition) { return name_in(definition_names, definition); }

Autocorrelation::Autocorrelation(const AutocorrelationOptions& options) : family_(options.family) {
  check_parameters(options);
  check_table(options);
  if (family_ == Family::table) {
    table_ = std::make_shared<const detail::AutocorrelationTable>(options.table);
    length_ = table_->decay_distance(std::exp(-one_over_e_depth)) / std::numbers::sqrt2;
    return;
  }
  check_length(options);
  shape_ = required_shape(options);
  length_ = formula_length(options, shape_);
  const bool is_matern = family_ == Family::matern || family_ == Family::self_affine;
  if (is_matern && !detail::is_half_integer_matern(shape_))
    matern_table_ = std::make_shared<const detail::MaternTable>(shape_);
}

double Autocorrelation::rho(double r) const {
  const double x = r / length_;
  switch (family_) {
    case Family::gaussian:
      return std::exp(-x * x / 2);
    case Family::exponential:
      return std::exp(-x);
    case Family::matern:
    case Family::self_affine:
      return matern_table_ ? matern_table_->rho(x) : detail::matern_half_integer(shape_, x);
    case Family::stretched:
      return shape_ == 2 ? std::exp(-x * x) : std::exp(-std::pow(x, shape_));
    case Family::rational_quadratic: {
      const double ratio = x / std::sqrt(2 * shape_);
      return std::exp(-shape_ * std::log1p(ratio * ratio));
    }
    case Family::table:
      return table_->rho(r);
  }
  return 0;
}

EquivalentLengths Autocorrelation::equivalent_lengths() const {
  return table_ ? lengths_of(*table_) : lengths_of(family_, shape_, length_);
}

double Autocorrelation::spectrum_share_above(double q, int dimension) const {
  if (!(q >= 0)) throw InputError(fmt::format("wavenumber is {}; it must be at least 0", q));
  if (dimension != 1 && dimension != 2)
    throw InputError(fmt::format("dimension of a spectrum is {}; it must be 1 or 2", dimension));
  if (table_) return table_->spectrum_share_above(q, dimension);
  return detail::spectrum_share_above(family_, shape_, q * length_, dimension);
}

std::optional<double> Autocorrelation::slope_variance() const {
  const double curvature = 1 / length_ / length_;
  switch (family_) {
    case Family::gaussian:
    case Family::rational_quadratic:
      return curvature;
    case Family::matern:
      if (shape_ > 1) return curvature * shape_ / (shape_ - 1);
      return {};
    case Family::stretched:
      if (shape_ == 2) return 2 * curvature;
      return {};
    case Family::table:
      return table_->slope_variance();
    case Family::exponential:
    case Family::self_affine:
      return {};
  }
  return {};
}

std::span<const GaussianTerm> Autocorrelation::gaussian_terms() const {
  return table_ ? table_->terms() : std::span<const GaussianTerm>();
}

std::optional<double> Autocorrelation::fit_residual() const {
  if (!table_) return {};
  return table_->residual();
}

std::vector<std::string> Autocorrelation::citations() const {
  switch (family_) {
    case Family::gaussian:
    case Family::exponential:
      return {
          "Ogilvy, Foster (1989), Rough surfaces: gaussian or exponential statistics?, "
          "doi:10.1088/0022-3727/22/9/001"};
    case Family::matern:
      return {
          "Guttorp, Gneiting (2006), Studies in the history of probability and statistics XLIX: on "
          "the "
          "Matern correlation family, doi:10.1093/biomet/93.4.989"};
    case Family::self_affine:
      return {
          "Palasantzas (1993), Roughness spectrum and surface width of self-affine fractal "
          "surfaces "
          "via the K-correlation model, doi:10.1103/PhysRevB.48.14472"};
    case Family::stretched:
      return {
          "Sinha, Sirota, Garoff, Stanley (1988), X-ray and neutron scattering from rough "
          "surfaces, "
          "doi:10.1103/PhysRevB.38.2297",
          "Schoenberg (1938), Metric spaces and positive definite functions, "
          "doi:10.1090/S0002-9947-1938-1501980-0"};
    case Family::rational_quadratic:
      return {
          "Rasmussen, Williams (2006), Gaussian processes for machine learning, "
          "doi:10.7551/mitpress/3206.001.0001"};
    case Family::table:
      if (gaussian_terms().empty())
        return {
            "Fritsch, Carlson (1980), Monotone piecewise cubic interpolation, "
            "doi:10.1137/0717021"};
      return {
          "Schoenberg (1938), Metric spaces and completely monotone functions, "
          "doi:10.2307/1968466",
          "Lawson, Hanson (1974), Solving least squares problems, doi:10.1137/1.9781611971217"};
  }
  return {};
}

}  // namespace roughmesh
