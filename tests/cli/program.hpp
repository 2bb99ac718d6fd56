// SPDX-License-Identifier: Apache-2.0
// The built program from outside, in a folder of the test's own.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <functional>
#include <string>
#include <thread>

#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan {

class Program : public ::testing::Test {
 protected:
  struct Result {
    int code = -1;  // or 128 + the signal
    std::string out, err;
    int signal = 0;  // that ended it
  };

  // For the shell; the outputs go into files, so that no terminal is near.
  std::string command(const std::string& arguments) const {
    return "cd '" + folder.path() + "' && exec '" + build_path("cli/bitspan") + "' " + arguments +
           " >.out 2>.err </dev/null";
  }
  Result run(const std::string& arguments) const {
    return result_of(std::system(command(arguments).c_str()));
  }
  // Sends the signal as soon as `seen()`.
  Result signalled(const std::string& arguments, int number, const std::function<bool()>& seen) const {
    const pid_t child = ::fork();
    if (child == 0) {
      ::signal(number, SIG_DFL);  // whatever started the test
      ::execl("/bin/sh", "sh", "-c", command(arguments).c_str(), nullptr);
      ::_exit(127);
    }
    EXPECT_GT(child, 0);
    if (child < 0) return {};
    const auto limit = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    bool now = seen();
    for (; !now && std::chrono::steady_clock::now() < limit; now = seen()) {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    EXPECT_TRUE(now) << arguments;
    EXPECT_EQ(::kill(child, number), 0);
    int status = 0;
    EXPECT_EQ(::waitpid(child, &status, 0), child);
    return result_of(status);
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

 private:
  Result result_of(int status) const {
    Result result{WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status), folder.read(".out"),
                  folder.read(".err"), WIFSIGNALED(status) ? WTERMSIG(status) : 0};
    std::filesystem::remove(folder.path(".out"));
    std::filesystem::remove(folder.path(".err"));
    return result;
  }
};

}  // namespace bitspan
