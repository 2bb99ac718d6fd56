// SPDX-License-Identifier: Apache-2.0
#include "tests/frozen/digest_lines.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string_view>

#include "config/fnv.hpp"
#include "tests/support/files.hpp"
#include "tests/support/paths.hpp"

namespace bitspan::frozen {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t failures_in_full = 10;
constexpr std::size_t all_digits = 16, check_digits = 3;

bool is_left_out(const std::string& value) { return value == "0"; }

std::string check_of(const std::string& name, const std::string& value) {
  Fnv128 digest;
  digest.text(name);
  digest.text(value);
  digest.number(0);  // takes the last letters to the first digits
  return digest.hex().substr(0, check_digits);
}

std::string digest_of(const Quantities& quantities) {
  Fnv128 all;
  std::string checks;
  for (const auto& [name, value] : quantities) {
    if (is_left_out(value)) continue;
    all.text(name);
    all.text(value);
    checks += check_of(name, value);
  }
  return all.hex().substr(0, all_digits) + " " + checks;
}

// One line for each quantity whose check digits are not among the frozen ones.
std::string differing(const Quantities& quantities, const std::string& frozen) {
  std::multiset<std::string> checks;
  for (std::size_t i = all_digits + 1; i < frozen.size(); i += check_digits)
    checks.insert(frozen.substr(i, check_digits));
  std::string out;
  std::string zeros;
  std::size_t differ = 0;
  for (const auto& [name, value] : quantities) {
    if (is_left_out(value)) {
      zeros.append(" " + name);
    } else if (const auto at = checks.find(check_of(name, value)); at != checks.end()) {
      checks.erase(at);
    } else {
      ++differ;
      out.append("    " + name + ": " + value + "\n");
    }
  }
  if (checks.size() > differ) {
    out.append("    of the frozen ones, " + std::to_string(checks.size() - differ) +
               " are gone, or 0 as these are:" + zeros + "\n");
  }
  return out.empty() ? "    what differs has equal check digits: see the list of all\n" : out;
}

void write(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  std::ofstream file(path, std::ios::binary);
  file << text;
  ASSERT_TRUE(file.flush()) << "cannot write " << path;
}

}  // namespace

std::map<std::string, std::map<std::string, std::string>> read_lines(const std::string& path) {
  std::map<std::string, std::map<std::string, std::string>> out;
  std::istringstream text(read_file(path));
  for (std::string line; std::getline(text, line);) {
    auto groups = Json::parse(line).get<std::map<std::string, std::string>>();
    const std::string title = groups.at("case");
    groups.erase("case");
    out.emplace(title, std::move(groups));
  }
  return out;
}

std::string digest_folder() { return source_path("tests/frozen/digests"); }

bool freezing() { return std::getenv("BITSPAN_FREEZE") != nullptr; }

bool drawing_configs() { return freezing() && std::string_view(std::getenv("BITSPAN_FREEZE")) == "configs"; }

DigestLines::DigestLines(const std::string& name) : name_(name) {
  if (!freezing()) frozen_ = read_lines(digest_folder() + "/" + name + ".jsonl");
}

void DigestLines::check(const std::string& title, const Computed& computed) {
  ++cases_;
  std::string differences;
  for (const std::string& line : computed.disagreements) differences.append("  " + line + "\n");
  Quantities digests;
  for (const Group& group : computed.groups) {
    digests.emplace_back(group.name, digest_of(group.quantities));
    for (const auto& [name, value] : group.quantities) {
      quantities_.append(title + ": " + name + ": " + value + "\n");
      if (!is_left_out(value)) seen_.insert(name);
    }
  }
  take(title, digests, computed.groups, differences);
}

void DigestLines::take(const std::string& title, const Quantities& digests, const std::vector<Group>& groups,
                       std::string differences) {
  if (freezing()) {
    Json line{{"case", title}};
    for (const auto& [group, digest] : digests) line[group] = digest;
    lines_.append(line.dump() + "\n");
  } else if (const auto found = frozen_.find(title); found == frozen_.end()) {
    differences.append("  this case is not in the file\n");
  } else {
    for (std::size_t i = 0; i < digests.size(); ++i) {
      const auto& [name, digest] = digests[i];
      const std::string frozen = found->second[name];
      found->second.erase(name);
      if (digest == frozen) continue;
      if (i < groups.size()) {
        differences.append("  " + name + ":\n" + differing(groups[i].quantities, frozen));
      } else {
        differences.append("  " + name + ": " + digest + ", frozen: " + frozen + "\n");
      }
    }
    for (const auto& [name, digest] : found->second)
      differences.append("  " + name + ": none, frozen: " + digest + "\n");
    frozen_.erase(found);
  }
  if (differences.empty()) return;
  if (++failures_ <= failures_in_full) {
    ADD_FAILURE() << title << " differs:\n" << differences;
  } else {
    further_.append("  " + title + "\n");
  }
}

void DigestLines::finish() {
  std::string seen;
  for (const std::string& name : seen_) seen.append((seen.empty() ? "" : ", ") + name);
  take(seen_title, {{"quantities", seen}}, {}, "");
  failures_ += frozen_.size();
  for (const auto& [title, line] : frozen_) further_.append("  " + title + ", which was not computed\n");
  if (!further_.empty()) ADD_FAILURE() << "these differ too:\n" << further_;
  EXPECT_FALSE(seen_.empty());

  const std::filesystem::path folder =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "quantities";
  const std::string list = folder / (name_ + (testing::Test::HasFailure() ? ".differs.txt" : ".txt"));
  write(list, quantities_);
  if (freezing()) {
    ASSERT_FALSE(testing::Test::HasFailure()) << name_ << " is not written";
    write(digest_folder() + "/" + name_ + ".jsonl", lines_);
    GTEST_SKIP() << "wrote " << name_ << ": " << cases_ << " cases";
  }
  std::cout << name_ << ": compared " << cases_ << " cases; " << failures_
            << " differ; all quantities: " << list << "\n";
}

}  // namespace bitspan::frozen
