// SPDX-License-Identifier: BSD-3-Clause
// MSH 2.2 lists an element of several physical groups once for each; here the listings become one
// element again.
#include <algorithm>
#include <compare>
#include <iterator>
#include <map>
#include <span>
#include <tuple>
#include <utility>

#include "hash.hpp"
#include "io_msh.hpp"

namespace roughmesh::detail {
namespace {

/// Blocks of one element type and entity, ascending; they differ in their groups.
using Family = std::vector<std::size_t>;

std::vector<Family> families_of_several(const std::vector<ElementBlock>& blocks) {
  std::map<std::tuple<ElementShape, int, int, Tag>, Family> families;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    const ElementType& type = blocks[b].type;
    families[{type.shape, type.order, type.n_nodes, blocks[b].entity}].push_back(b);
  }
  std::vector<Family> result;
  for (auto& [key, family] : families)
    if (family.size() > 1) result.push_back(std::move(family));
  return result;
}

// Elements are compared as sets of nodes, since Gmsh reverses an element in a group whose entity is
// reversed.
std::vector<Index> sorted_nodes(const std::vector<ElementBlock>& blocks, const Family& family) {
  std::vector<Index> nodes;
  for (const std::size_t b : family)
    for (Index i = 0; i < blocks[b].size(); ++i) {
      const std::span<const Index> element = blocks[b].element(i);
      const auto start = nodes.insert(nodes.end(), element.begin(), element.end());
      std::sort(start, nodes.end());
    }
  return nodes;
}

/// One line of the file that states an element.
struct Listing {
  std::uint64_t hash = 0;  ///< of the sorted nodes
  Index position = 0;      ///< among all listings of the family
  std::uint32_t block = 0;
};

/// The listings of a family, equal ones side by side.
class Listings {
 public:
  Listings(const std::vector<ElementBlock>& blocks, const Family& family)
      : nodes_(sorted_nodes(blocks, family)),
        n_nodes_(static_cast<std::size_t>(blocks[family[0]].type.n_nodes)) {
    listings_.reserve(nodes_.size() / n_nodes_);
    for (const std::size_t b : family)
      for (Index i = 0; i < blocks[b].size(); ++i) {
        const auto position = static_cast<Index>(listings_.size());
        listings_.push_back({hash(nodes(position)), position, static_cast<std::uint32_t>(b)});
      }
    std::sort(listings_.begin(), listings_.end(),
              [this](const Listing& a, const Listing& b) { return is_before(a, b); });
  }

  /// For each position the first one that states the same element.
  std::vector<Index> first_positions() const {
    std::vector<Index> first(listings_.size());
    for (auto start = listings_.begin(); start != listings_.end();) {
      const auto end = std::find_if_not(start, listings_.end(),
                                        [&](const Listing& other) { return equal(*start, other); });
      match({start, end}, first);
      start = end;
    }
    return first;
  }

 private:
  std::span<const Index> nodes(Index position) const {
    return std::span(nodes_).subspan(static_cast<std::size_t>(position) * n_nodes_, n_nodes_);
  }

  bool equal(const Listing& a, const Listing& b) const {
    return a.hash == b.hash && std::ranges::equal(nodes(a.position), nodes(b.position));
  }

  bool is_before(const Listing& a, const Listing& b) const {
    if (a.hash != b.hash) return a.hash < b.hash;
    const auto order =
        std::lexicographical_compare_three_way(nodes(a.position).begin(), nodes(a.position).end(),
                                               nodes(b.position).begin(), nodes(b.position).end());
    return std::is_neq(order) ? std::is_lt(order) : a.position < b.position;
  }

  // One group lists an element once, so a second listing in the same block is another element: the
  // k-th listings of all blocks belong together.
  static void match(std::span<const Listing> equal, std::vector<Index>& first) {
    std::vector<Index> elements;
    std::size_t k = 0;
    for (std::size_t i = 0; i < equal.size(); ++i, ++k) {
      if (i > 0 && equal[i].block != equal[i - 1].block) k = 0;
      if (k == elements.size()) elements.push_back(equal[i].position);
      first[equal[i].position] = elements[k];
    }
  }

  std::vector<Index> nodes_;
  std::size_t n_nodes_;
  std::vector<Listing> listings_;
};

/// Numbers for sets of groups; 0 is the empty set.
class GroupSets {
 public:
  const std::vector<Tag>& operator[](std::size_t set) const { return sets_[set]; }

  /// The union of a set and the groups of a block.
  std::size_t extended(std::size_t set, std::size_t b, const ElementBlock& block) {
    const auto [place, is_new] = extensions_.try_emplace({set, b}, 0);
    if (is_new) {
      std::vector<Tag> groups;
      std::ranges::set_union(sets_[set], block.physical_groups, std::back_inserter(groups));
      place->second = number(groups);
    }
    return place->second;
  }

 private:
  std::size_t number(const std::vector<Tag>& groups) {
    const auto [place, is_new] = numbers_.try_emplace(groups, sets_.size());
    if (is_new) sets_.push_back(groups);
    return place->second;
  }

  std::vector<std::vector<Tag>> sets_{{}};
  std::map<std::vector<Tag>, std::size_t> numbers_{{{}, 0}};
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> extensions_;
};

template <typename Action>
void for_each_listing(const std::vector<ElementBlock>& blocks, const Family& family,
                      Action&& action) {
  std::size_t position = 0;
  for (const std::size_t b : family)
    for (Index i = 0; i < blocks[b].size(); ++i) action(position++, b, i);
}

void append(ElementBlock& block, const ElementBlock& from, Index i) {
  const std::span<const Index> nodes = from.element(i);
  block.nodes.insert(block.nodes.end(), nodes.begin(), nodes.end());
  block.tags.push_back(from.tags[i]);
}

/// Blocks that take the place of each block of the file.
using Replacements = std::vector<std::vector<ElementBlock>>;

// A block for each set of groups, in order of first appearance.
void regroup(const std::vector<ElementBlock>& blocks, const Family& family,
             const std::vector<Index>& first, Replacements& replacements) {
  GroupSets sets;
  std::vector<std::size_t> set_of(first.size(), 0);
  for_each_listing(blocks, family, [&](std::size_t position, std::size_t b, Index) {
    std::size_t& set = set_of[first[position]];
    set = sets.extended(set, b, blocks[b]);
  });
  std::map<std::size_t, std::pair<std::size_t, std::size_t>> places;  // of each set
  for_each_listing(blocks, family, [&](std::size_t position, std::size_t b, Index i) {
    if (static_cast<std::size_t>(first[position]) != position) return;
    const std::size_t set = set_of[position];
    const auto [place, is_new] = places.try_emplace(set, b, replacements[b].size());
    if (is_new) replacements[b].push_back({blocks[b].type, blocks[b].entity, sets[set], {}, {}});
    append(replacements[place->second.first][place->second.second], blocks[b], i);
  });
}

bool has_copies(const std::vector<Index>& first) {
  for (std::size_t position = 0; position < first.size(); ++position)
    if (static_cast<std::size_t>(first[position]) != position) return true;
  return false;
}

}  // namespace

void merge_copies_in_groups(std::vector<ElementBlock>& blocks) {
  const std::vector<Family> families = families_of_several(blocks);
  if (families.empty()) return;
  Replacements replacements(blocks.size());
  std::vector<bool> is_replaced(blocks.size(), false);
  for (const Family& family : families) {
    const std::vector<Index> first = Listings(blocks, family).first_positions();
    if (!has_copies(first)) continue;
    regroup(blocks, family, first, replacements);
    for (const std::size_t b : family) is_replaced[b] = true;
  }
  std::vector<ElementBlock> merged;
  for (std::size_t b = 0; b < blocks.size(); ++b) {
    if (!is_replaced[b]) merged.push_back(std::move(blocks[b]));
    std::move(replacements[b].begin(), replacements[b].end(), std::back_inserter(merged));
  }
  blocks = std::move(merged);
}

}  // namespace roughmesh::detail
