// What the tests ask about refusals.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "config/config.hpp"

namespace bitspan {

// The text of the InputError that `call` throws; a test failure where it throws none, or more than one line.
template <class Call>
std::string input_error(const Call& call) {
  try {
    call();
  } catch (const InputError& error) {
    const std::string text = error.what();
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    return text;
  }
  ADD_FAILURE() << "no InputError";
  return "";
}

}  // namespace bitspan
