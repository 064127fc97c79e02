// SPDX-License-Identifier: BSD-3-Clause
#include "chains.hpp"

#include <algorithm>
#include <tuple>

namespace roughmesh::detail {
namespace {

// Both directions of all segments, sorted.
class Neighbours {
 public:
  explicit Neighbours(std::span<const std::array<Index, 2>> segments) {
    for (const auto& [a, b] : segments) {
      pairs_.push_back({a, b});
      pairs_.push_back({b, a});
    }
    std::sort(pairs_.begin(), pairs_.end());
  }

  const std::vector<std::array<Index, 2>>& pairs() const { return pairs_; }
  std::span<const std::array<Index, 2>> of(Index point) const {
    const auto begin = std::lower_bound(pairs_.begin(), pairs_.end(), std::array{point, Index{-1}});
    const auto end =
        std::find_if(begin, pairs_.end(), [&](const auto& p) { return p[0] != point; });
    return {begin, end};
  }

 private:
  std::vector<std::array<Index, 2>> pairs_;
};

class Search {
 public:
  Search(std::span<const std::array<Index, 2>> segments, std::span<const Vec3> positions,
         std::span<const std::uint8_t> is_end)
      : neighbours_(segments), positions_(positions), is_end_(is_end) {}

  Chains find() {
    Chains result;
    for (const auto& [end, first] : neighbours_.pairs())
      if (is_end(end) && !is_end(first)) follow(end, first, result);
    return result;
  }

 private:
  bool is_end(Index point) const {
    return is_end_[point] != 0 || neighbours_.of(point).size() != 2;
  }

  // Keeps the chain in one of the two directions in which it is met.
  void follow(Index end, Index first, Chains& result) {
    path_.assign({end, first});
    while (!is_end(path_.back())) {
      const auto both = neighbours_.of(path_.back());
      const Index before = path_[path_.size() - 2];
      path_.push_back(both[0][1] == before ? both[1][1] : both[0][1]);
    }
    const Chain chain{end, first, path_.back(), path_[path_.size() - 2]};
    if (std::tie(chain.last_end, chain.last) < std::tie(chain.first_end, chain.first)) return;
    add(chain, result);
  }

  void add(const Chain& chain, Chains& result) const {
    std::vector<double> before = {0};
    for (std::size_t i = 1; i < path_.size(); ++i)
      before.push_back(before.back() + (positions_[path_[i]] - positions_[path_[i - 1]]).norm());
    const auto number = static_cast<Index>(result.chains.size());
    for (std::size_t i = 1; i + 1 < path_.size(); ++i)
      result.links.push_back({path_[i], number, before[i] / before.back()});
    result.chains.push_back(chain);
  }

  Neighbours neighbours_;
  std::span<const Vec3> positions_;
  std::span<const std::uint8_t> is_end_;
  std::vector<Index> path_;  // that is being followed
};

}  // namespace

Chains find_chains(std::span<const std::array<Index, 2>> segments, std::span<const Vec3> positions,
                   std::span<const std::uint8_t> is_end) {
  return Search(segments, positions, is_end).find();
}

}  // namespace roughmesh::detail
