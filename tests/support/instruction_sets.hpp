// SPDX-License-Identifier: BSD-3-Clause
// Tests on every instruction set that Highway chooses from when a program runs.
#pragma once

#include <cstdint>

#include <gtest/gtest.h>
#include <hwy/targets.h>

namespace roughmesh::test {

/// Calls test() once for every instruction set that was compiled and that this processor has.
template <class Test>
void on_every_instruction_set(const Test& test) {
  for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
    SCOPED_TRACE(hwy::TargetName(target));
    hwy::SetSupportedTargetsForTest(target);
    test();
  }
  hwy::SetSupportedTargetsForTest(0);
}

}  // namespace roughmesh::test
