// SPDX-License-Identifier: Apache-2.0
// What the tests ask about refusals.
#pragma once

#include <gtest/gtest.h>

#include <string>
#include <string_view>

#include "config/config.hpp"

namespace bitspan {

// The text of the Error that `call` throws, "" where it throws none; a test failure where it is more than one
// line.
template <class Error, class Call>
std::string line_thrown(const Call& call) {
  try {
    call();
  } catch (const Error& error) {
    std::string text = error.what();
    EXPECT_FALSE(text.empty());
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  return "";
}
template <class Call>
std::string error_of(const Call& call) {
  return line_thrown<InputError>(call);
}
// The same where one must be thrown.
template <class Call>
std::string input_error(const Call& call) {
  std::string text = error_of(call);
  EXPECT_NE(text, "") << "no InputError";
  return text;
}

inline bool names(const std::string& message, std::string_view part) {
  return message.find(part) != std::string::npos;
}
template <class Call>
void expect_refusal(const Call& call, std::string_view part) {
  const std::string message = input_error(call);
  EXPECT_TRUE(names(message, part)) << message;
}

}  // namespace bitspan
