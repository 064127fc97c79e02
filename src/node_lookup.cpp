// SPDX-License-Identifier: BSD-3-Clause
#include "node_lookup.hpp"

#include <algorithm>

namespace roughmesh::detail {

NodeLookup::NodeLookup(std::span<const Tag> tags) {
  if (tags.empty()) return;
  const auto [least, greatest] = std::minmax_element(tags.begin(), tags.end());
  first_ = *least;
  const auto range = static_cast<std::uint64_t>(*greatest) - static_cast<std::uint64_t>(*least);
  // A table up to four times as long as needed costs less than the sorted list.
  if (range < 4 * tags.size())
    fill_dense(tags, range + 1);
  else
    fill_sorted(tags);
}

void NodeLookup::fill_dense(std::span<const Tag> tags, std::size_t n_slots) {
  dense_.assign(n_slots, Index{-1});
  for (std::size_t i = 0; i < tags.size(); ++i) {
    Index& slot = dense_[static_cast<std::size_t>(tags[i] - first_)];
    if (slot >= 0 && !duplicate_) duplicate_ = static_cast<Index>(i);
    slot = static_cast<Index>(i);
  }
}

void NodeLookup::fill_sorted(std::span<const Tag> tags) {
  sorted_.reserve(tags.size());
  for (std::size_t i = 0; i < tags.size(); ++i)
    sorted_.emplace_back(tags[i], static_cast<Index>(i));
  std::sort(sorted_.begin(), sorted_.end());
  const auto same =
      std::adjacent_find(sorted_.begin(), sorted_.end(),
                         [](const auto& a, const auto& b) { return a.first == b.first; });
  if (same != sorted_.end()) duplicate_ = std::next(same)->second;
}

Index NodeLookup::find_sorted(Tag tag) const {
  const auto place = std::lower_bound(sorted_.begin(), sorted_.end(), std::pair{tag, Index{0}});
  return place != sorted_.end() && place->first == tag ? place->second : Index{-1};
}

}  // namespace roughmesh::detail
