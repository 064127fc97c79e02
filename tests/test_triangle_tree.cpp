// SPDX-License-Identifier: BSD-3-Clause
// The hierarchy of boxes: no pair and no ray is missed, and no pair comes twice.
#include <map>
#include <random>
#include <set>
#include <utility>

#include <gtest/gtest.h>

#include "triangle_tree.hpp"

using namespace roughmesh;
using detail::Facet;
using detail::TriangleTree;

namespace {

struct Soup {
  std::vector<Facet> facets;
  std::vector<Vec3> positions;
  std::vector<std::uint8_t> marks;
};

Soup random_soup(std::size_t n, double size, unsigned seed, const Vec3& origin = Vec3::Zero(),
                 double scale = 1) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> place(0, 1), near(-size, size);
  Soup soup;
  for (std::size_t f = 0; f < n; ++f) {
    const Vec3 middle(place(random), place(random), place(random));
    Facet facet;
    for (Index& point : facet) {
      point = static_cast<Index>(soup.positions.size());
      const Vec3 x = middle + Vec3(near(random), near(random), near(random));
      soup.positions.emplace_back(origin + scale * x);
      soup.marks.push_back(random() % 4 == 0);
    }
    soup.facets.push_back(facet);
  }
  return soup;
}

Eigen::AlignedBox3d box_of(const Soup& soup, std::size_t f) {
  Eigen::AlignedBox3d box;
  for (const Index point : soup.facets[f]) box.extend(soup.positions[point]);
  return box;
}

bool is_marked(const Soup& soup, std::size_t f) {
  const auto& [a, b, c] = soup.facets[f];
  return soup.marks[a] || soup.marks[b] || soup.marks[c];
}

std::map<std::pair<std::size_t, std::size_t>, int> visited(const Soup& soup) {
  const TriangleTree tree(soup.facets, soup.positions, soup.marks);
  std::map<std::pair<std::size_t, std::size_t>, int> pairs;
  for (const TriangleTree::Task& task : tree.tasks())
    tree.for_each_pair(task, [&](std::size_t i, std::size_t j) {
      ++pairs[{i, j}];
      return true;
    });
  return pairs;
}

}  // namespace

// Boxes of float are larger than they are: by less than 1e-6 of the extent on each side.
TEST(TriangleTree, VisitsEachPairOfOverlappingBoxesOnce) {
  for (const std::size_t n : {0U, 1U, 2U, 3U, 4U, 5U, 8U, 9U, 100U, 1500U})
    for (const Vec3& origin : {Vec3(0, 0, 0), Vec3(1e6, -1e6, 3)})
      for (const double scale : {1.0, 1e-150, 1e150}) {
        const Soup soup = random_soup(n, 0.05, 1, scale == 1 ? origin : Vec3::Zero(), scale);
        const auto pairs = visited(soup);
        std::size_t n_expected = 0;
        const double slack = 4e-6 * scale;
        for (std::size_t i = 0; i < n; ++i)
          for (std::size_t j = i + 1; j < n; ++j) {
            if (!is_marked(soup, i) && !is_marked(soup, j)) {
              EXPECT_EQ(pairs.count({i, j}), 0U);
              continue;
            }
            const auto a = box_of(soup, i), b = box_of(soup, j);
            const auto found = pairs.find({i, j});
            if (a.intersects(b)) {
              ++n_expected;
              ASSERT_TRUE(found != pairs.end());
            }
            if (found == pairs.end()) continue;
            EXPECT_EQ(found->second, 1);
            EXPECT_TRUE((a.min().array() - slack <= b.max().array()).all() &&
                        (b.min().array() - slack <= a.max().array()).all());
          }
        EXPECT_LE(n_expected, pairs.size());
      }
}

TEST(TriangleTree, StopsWhereItIsTold) {
  const Soup soup = random_soup(400, 0.5, 2);
  const TriangleTree tree(soup.facets, soup.positions, soup.marks);
  for (const TriangleTree::Task& task : tree.tasks()) {
    int n = 0;
    tree.for_each_pair(task, [&](std::size_t, std::size_t) { return ++n < 3; });
    EXPECT_LE(n, 3);
  }
}

// Touching boxes overlap, also where their sides lie between two numbers of a float.
TEST(TriangleTree, FindsBoxesThatTouch) {
  Soup soup;
  const double x = 1.0 / 3;
  soup.positions = {{0, 0, 0}, {x, 0, 0}, {0, x, 0}, {x, 0, 0}, {1, 0, 0}, {1, x, 0}};
  soup.facets = {{0, 1, 2}, {3, 4, 5}};
  soup.marks.assign(6, 1);
  EXPECT_EQ(visited(soup).size(), 1U);
}

TEST(TriangleTree, RaysMeetEveryBoxOnTheirWay) {
  const Soup soup = random_soup(900, 0.1, 4);
  const TriangleTree tree(soup.facets, soup.positions, soup.marks);
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  for (int i = 0; i < 300; ++i) {
    const Vec3 from = soup.positions[random() % soup.positions.size()];
    Vec3 direction = Vec3(normal(random), normal(random), normal(random)).normalized();
    if (i % 3 == 0) direction = Vec3::Unit(i % 9 / 3);
    const double reach = 0.1 * static_cast<double>(i % 7);
    std::set<std::size_t> met;
    tree.for_each_along(from, direction, reach, [&](std::size_t f, double within) {
      EXPECT_TRUE(met.insert(f).second);
      return within;
    });
    // A facet is met for sure if a place of the ray is inside its box.
    for (std::size_t f = 0; f < soup.facets.size(); ++f)
      for (int k = 0; k <= 50; ++k)
        if (box_of(soup, f).contains(from + reach * k / 50 * direction)) {
          ASSERT_TRUE(met.count(f)) << i;
          break;
        }
  }
}

TEST(TriangleTree, ARayMayBeShortened) {
  const Soup soup = random_soup(900, 0.1, 4);
  const TriangleTree tree(soup.facets, soup.positions, soup.marks);
  int n_all = 0, n_short = 0;
  const auto count = [&](int& n, double rest) {
    tree.for_each_along(Vec3(0, 0.5, 0.5), Vec3(1, 0, 0), 1, [&](std::size_t, double within) {
      ++n;
      return rest * within;
    });
  };
  count(n_all, 1);
  count(n_short, 0.1);
  EXPECT_GT(n_all, 10);
  EXPECT_LT(n_short, n_all / 2);
}
