// SPDX-License-Identifier: Apache-2.0
// The binary interface: what the library shows, what it needs, and its types against libbitspan.abi.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <string>

#include "tests/support/paths.hpp"

namespace bitspan {
namespace {

struct Output {
  int status = -1;
  std::string text;
};
Output run(const std::string& command) {
  Output out;
  FILE* const pipe = ::popen((command + " 2>&1").c_str(), "r");
  if (pipe == nullptr) return out;
  for (int c = std::fgetc(pipe); c != EOF; c = std::fgetc(pipe)) out.text += static_cast<char>(c);
  out.status = ::pclose(pipe);
  return out;
}

const std::string library = bitspan::build_path("lib/libbitspan.so.0");
// The same with the types that abidiff reads.
const std::string types = bitspan::build_path("tests/lib/libbitspan.so.0");

std::set<std::string> symbols(const std::string& library) {
  const Output nm = run("nm -D --defined-only --format=posix '" + library + "'");
  EXPECT_EQ(nm.status, 0) << nm.text;
  std::set<std::string> out;
  std::istringstream lines(nm.text);
  for (std::string line; std::getline(lines, line);) out.insert(line.substr(0, line.find(' ')));
  return out;
}

TEST(LibAbi, ShowsOnlyItsOwnSymbolsUnderTheirVersion) {
  std::set<std::string> declared{"BITSPAN_0"};
  std::ifstream header(bitspan::source_path("include/bitspan/bitspan.h"));
  for (std::string line; std::getline(header, line);) {
    if (!line.starts_with("BS_API ")) continue;
    const std::size_t open = line.find('(');
    const std::size_t name = line.find_last_of(" *", open) + 1;
    declared.insert(line.substr(name, open - name) + "@@BITSPAN_0");
  }
  EXPECT_GT(declared.size(), 30U);
  EXPECT_EQ(symbols(library), declared);
  EXPECT_EQ(symbols(types), declared);
}

TEST(LibAbi, NeedsNeitherSystemCNorVerilator) {
  const Output needed = run("objdump -p '" + library + "'");
  ASSERT_EQ(needed.status, 0) << needed.text;
  EXPECT_NE(needed.text.find("SONAME               libbitspan.so.0\n"), std::string::npos) << needed.text;
  EXPECT_NE(needed.text.find("NEEDED               libc.so.6\n"), std::string::npos);
  EXPECT_EQ(needed.text.find("systemc"), std::string::npos);
  const Output undefined = run("nm -D --undefined-only -C '" + library + "'");
  ASSERT_EQ(undefined.status, 0);
  EXPECT_EQ(undefined.text.find("sc_core"), std::string::npos);
  EXPECT_EQ(undefined.text.find("Verilated"), std::string::npos);
}

TEST(LibAbi, TypesAreTheCommittedOnes) {
  const Output diff = run("abidiff --harmless --no-show-locs '" +
                          bitspan::source_path("tests/lib/libbitspan.abi") + "' '" + types + "'");
  EXPECT_EQ(diff.status, 0) << diff.text
                            << "\nAn addition: raise BS_ABI_VERSION and run ./dev abi. Anything else breaks "
                               "programs that are already compiled.";
}

}  // namespace
}  // namespace bitspan
