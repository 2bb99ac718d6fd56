// SPDX-License-Identifier: Apache-2.0
// The built program from outside, in a folder of the test's own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <string>

#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {

class Program : public ::testing::Test {
 protected:
  struct Result {
    int code = -1;
    std::string out, err;
  };

  // For the shell; the outputs go into files, so that no terminal is near.
  std::string command(const std::string& arguments) const {
    return "cd '" + folder.path() + "' && exec '" + build_path("cli/bitspan") + "' " + arguments +
           " >.out 2>.err </dev/null";
  }
  Result run(const std::string& arguments) const {
    const int status = std::system(command(arguments).c_str());
    Result result{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), folder.read(".out"),
                  folder.read(".err")};
    std::filesystem::remove(folder.path(".out"));
    std::filesystem::remove(folder.path(".err"));
    return result;
  }
  // Bad input: exit 2, and one line on stderr that holds `part`.
  Result refused(const std::string& arguments, const std::string& part) const {
    Result r = run(arguments);
    EXPECT_EQ(r.code, 2) << arguments << "\n" << r.err;
    EXPECT_TRUE(r.err.starts_with("bitspan: ")) << r.err;
    EXPECT_EQ(std::ranges::count(r.err, '\n'), 1) << r.err;
    EXPECT_NE(r.err.find(part), std::string::npos) << arguments << "\n" << r.err;
    return r;
  }

  // A stream of this picture, and of a triangle in it.
  static constexpr const char* header =
      "{\"bitspan\": 1, \"width\": 32, \"height\": 24, \"s_min\": 1.0, \"s_max\": 100.0, \"focal\": 30.0, "
      "\"background\": [1, 2, 3]}\n";
  static constexpr const char* good_triangle =
      "{\"v\": [[2, 2, 2, 0, 0], [30, 4, 50, 20, 0], [5, 22, 9, 0, 20]], "
      "\"c\": [[1, 0.5, 0.2, 1], [0.3, 1, 0.6, 1], [0.1, 0.2, 1, 1]]}\n";
  void stream(const std::string& name, const std::string& triangles = good_triangle) const {
    folder.write(name, header + triangles);
  }

  TemporaryFolder folder;
};

}  // namespace bitspan
