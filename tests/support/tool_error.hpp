// SPDX-License-Identifier: Apache-2.0
// What the tests ask about tools that are missing or broke.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tb/programs.hpp"
#include "tests/support/input_error.hpp"

namespace bitspan {

// The text of the ToolError that `call` must throw; a test failure where it is more than one line.
template <class Call>
std::string tool_error(const Call& call) {
  std::string text = line_thrown<ToolError>(call);
  EXPECT_NE(text, "") << "no ToolError";
  return text;
}

}  // namespace bitspan
