// SPDX-License-Identifier: BSD-3-Clause
#include "factor.hpp"

#include <algorithm>

#include "parallel.hpp"

namespace roughmesh::detail {

Factor::Factor(DenseMatrix columns, std::vector<Index> order, FactorShape shape)
    : columns_(std::move(columns)),
      order_(std::move(order)),
      row_of_point_(order_.size()),
      shape_(shape) {
  for (std::size_t row = 0; row < order_.size(); ++row)
    row_of_point_[order_[row]] = static_cast<Index>(row);
}

/// rows = the product of rows [begin, begin + rows.size()) of L with the noise. These few rows stay
/// in the fastest cache while the columns stream by.
void Factor::add_columns(std::span<const double> noise, std::size_t begin,
                         std::span<double> rows) const {
  for (std::size_t k = 0; k < noise.size(); ++k) {
    const double* const column = columns_.column(k) + begin;
    const std::size_t first = std::max(begin, first_row(k)) - begin;
    for (std::size_t i = first; i < rows.size(); ++i) rows[i] += noise[k] * column[i];
  }
}

std::vector<double> Factor::heights(const NoiseStream& stream) const {
  const std::size_t n = order_.size();
  const std::vector<double> noise_of_point = white_noise_sequence(stream, n);
  std::vector<double> noise(rank());
  for (std::size_t k = 0; k < noise.size(); ++k) noise[k] = noise_of_point[order_[k]];

  std::vector<double> rows(n, 0.0), heights(n);
  parallel_for(n, 512, [&](std::size_t begin, std::size_t end) {
    add_columns(noise, begin, std::span(rows).subspan(begin, end - begin));
    for (std::size_t row = begin; row < end; ++row) heights[order_[row]] = rows[row];
  });
  return heights;
}

std::vector<double> Factor::covariances(std::span<const PointPair> pairs) const {
  std::vector<double> sums(pairs.size(), 0.0);
  // Columns outside, pairs inside: L is read column by column as it lies in memory, once per range,
  // so there are few ranges.
  parallel_for(pairs.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::vector<PointPair> rows;  // the upper one first
    for (const auto& [a, b] : pairs.subspan(begin, end - begin))
      rows.emplace_back(std::minmax(row_of_point_[a], row_of_point_[b]));
    for (std::size_t k = 0; k < rank(); ++k) {
      const double* const column = columns_.column(k);
      const auto first = static_cast<Index>(first_row(k));
      for (std::size_t p = 0; p < rows.size(); ++p)
        if (rows[p].first >= first)
          sums[begin + p] += column[rows[p].first] * column[rows[p].second];
    }
  });
  return sums;
}

}  // namespace roughmesh::detail
