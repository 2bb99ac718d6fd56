// SPDX-License-Identifier: Apache-2.0
#include "tests/frozen/digest_file.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iostream>
#include <sstream>
#include <stdexcept>

#include "tests/support/files.hpp"

namespace bitspan::frozen {
namespace {

constexpr std::size_t failures_in_full = 10;

}  // namespace

DigestFile::DigestFile(const std::string& name) : path_(digest_folder() + "/" + name + ".txt") {
  std::istringstream text(read_file(path_));
  Section* section = nullptr;
  for (std::string line; std::getline(text, line);) {
    if (line.starts_with('[') && line.ends_with(']')) {
      section = &frozen_[line.substr(1, line.size() - 2)];
    } else if (const auto colon = line.find(": "); section != nullptr && colon != std::string::npos) {
      (*section)[line.substr(0, colon)] = line.substr(colon + 2);
    } else if (!line.empty()) {
      throw std::runtime_error(path_ + ": this line is neither a section nor a quantity: " + line);
    }
  }
}

void DigestFile::check(const std::string& title, const Computed& computed) {
  ++cases_;
  std::string differences;
  for (const std::string& line : computed.disagreements) differences.append("  " + line + "\n");
  Quantities quantities;
  for (const Group& group : computed.groups)
    quantities.insert(quantities.end(), group.quantities.begin(), group.quantities.end());
  quantities_ += quantities.size();
  const std::string from_file = differences_from_file(title, quantities);
  if (!from_file.empty()) differing_[title] = from_file;
  differences += from_file;
  if (!differences.empty()) fail(title, differences);
}

std::string DigestFile::differences_from_file(const std::string& title, const Quantities& quantities) {
  const auto found = frozen_.find(title);
  if (found == frozen_.end()) return "  this case is not in the file\n";
  Section expected = std::move(found->second);
  frozen_.erase(found);
  std::string out;
  for (const auto& [name, value] : quantities) {
    const auto at = expected.find(name);
    if (at == expected.end()) {
      out.append("  " + name + ": " + value + ", frozen: none\n");
      continue;
    }
    if (at->second != value) out.append("  " + name + ": " + value + ", frozen: " + at->second + "\n");
    expected.erase(at);
  }
  for (const auto& [name, value] : expected) out.append("  " + name + ": none, frozen: " + value + "\n");
  return out;
}

void DigestFile::fail(const std::string& title, const std::string& differences) {
  if (++failures_ <= failures_in_full) {
    ADD_FAILURE() << title << " differs:\n" << differences;
  } else {
    further_.append("  " + title + "\n");
  }
}

void DigestFile::finish() {
  const std::string name = std::filesystem::path(path_).filename().string();
  for (const auto& [title, section] : frozen_) fail(title, "  this case of the file was not computed\n");
  if (!further_.empty()) ADD_FAILURE() << "these differ too:\n" << further_;
  EXPECT_GT(quantities_, 0U);
  std::cout << name << ": compared " << cases_ << " cases, " << quantities_ << " quantities; " << failures_
            << " cases differ\n";
}

}  // namespace bitspan::frozen
