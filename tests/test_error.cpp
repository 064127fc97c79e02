// SPDX-License-Identifier: BSD-3-Clause
// What users get to read is one line, whatever the values hold that it names.
#include <gtest/gtest.h>

#include "roughmesh/error.hpp"

using namespace roughmesh;

TEST(Errors, HaveMessagesOfOneLine) {
  const std::string text = "a\nb\r\t\x1b[1m\x7f\xc3\xa9", line = "a?b???[1m?\xc3\xa9";
  EXPECT_EQ(InputError(text).what(), line);
  EXPECT_EQ(FormatError(text).what(), line);
  EXPECT_EQ(CheckError(text).what(), line);
  EXPECT_EQ(NumericalError(text).what(), line);
}
