// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "new_tags.hpp"

using roughmesh::InputError;
using roughmesh::Tag;
using roughmesh::detail::NewTags;

TEST(NewTags, FollowTheLargestOne) {
  NewTags tags("node");
  EXPECT_EQ(tags.next(), 1);
  tags.keep_off(std::vector<Tag>{7, 3, -4});
  EXPECT_EQ(tags.next(), 8);
  EXPECT_EQ(tags.next(), 9);
}

TEST(NewTags, EndWithTheLargestNumber) {
  NewTags tags("element");
  tags.keep_off(std::numeric_limits<Tag>::max() - 1);
  EXPECT_EQ(tags.next(), std::numeric_limits<Tag>::max());
  try {
    tags.next();
    FAIL();
  } catch (const InputError& error) {
    EXPECT_NE(std::string(error.what()).find("element 9223372036854775807"), std::string::npos);
  }
}
