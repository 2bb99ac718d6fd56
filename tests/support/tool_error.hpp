// SPDX-License-Identifier: Apache-2.0
// What the tests ask about tools that are missing or broke.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "tb/programs.hpp"

namespace bitspan {

// The text of the ToolError that `call` must throw; a test failure where it is more than one line.
template <class Call>
std::string tool_error(const Call& call) {
  try {
    call();
  } catch (const ToolError& error) {
    std::string text = error.what();
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  ADD_FAILURE() << "no ToolError";
  return "";
}

}  // namespace bitspan
