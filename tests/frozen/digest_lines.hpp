// SPDX-License-Identifier: Apache-2.0
// The file digests/NAME.jsonl: one line per case, with at most four digests.
//
//   {"case":"narrow on demo","records":"0123456789abcdef 0a12b4","counters":"fedcba9876543210 f3c"}
//
// A digest is of a group of quantities: 16 hexadecimal digits of them all, and then three check digits per
// quantity. The 16 tell whether a group differs, and the check digits which of its quantities does. A
// quantity of "0" is left out, so that a new counter changes no line of a case that does not count it. The
// last line names the quantities that are not 0 in some case.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace bitspan::frozen {

// Names and values, in the order in which they enter the digest.
using Quantities = std::vector<std::pair<std::string, std::string>>;
struct Group {
  std::string name;
  Quantities quantities;
};

// What was computed of a case.
struct Computed {
  std::vector<Group> groups;
  std::vector<std::string> disagreements;  // between engines that must be equal: one line for each
};

inline constexpr const char* seen_title = "not 0 in some case";  // of the last line

// The lines digests/NAME.jsonl: from a case to its groups' digests.
std::map<std::string, std::map<std::string, std::string>> read_lines(const std::string& path);
// The folder that holds these files.
std::string digest_folder();
// Whether the digests are written anew instead of compared: BITSPAN_FREEZE is in the environment.
bool freezing();
// Whether the random configurations are drawn anew before that: its value is "configs".
bool drawing_configs();

class DigestLines {
 public:
  explicit DigestLines(const std::string& name);
  // Compares a case with the file. It is a test failure that names the case and the quantities where they
  // differ, or where engines disagree.
  void check(const std::string& title, const Computed& computed);
  // To be called last. Writes all quantities, one line for each, to quantities/NAME.txt beside the program,
  // or to NAME.differs.txt where a case differs. Comparing: fails where the file has cases that were not
  // checked. Freezing: writes the file, unless the test has failed already, and skips the test.
  void finish();

 private:
  using Line = std::map<std::string, std::string>;  // from group to digest

  // Compares a line with the file's, or adds it to the file as it would be written.
  void take(const std::string& title, const Quantities& digests, const std::vector<Group>& groups,
            std::string differences);

  std::string name_;
  std::map<std::string, Line> frozen_;
  std::string lines_;           // the file as it would be written
  std::string quantities_;      // of all cases
  std::set<std::string> seen_;  // quantities that were not 0 in some case
  std::size_t cases_ = 0;
  std::size_t failures_ = 0;
  std::string further_;  // titles of the failures that are not told in full
};

}  // namespace bitspan::frozen
