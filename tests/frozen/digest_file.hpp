// SPDX-License-Identifier: Apache-2.0
// The file digests/NAME.txt: one section for each case, with one line for each quantity.
//
//   [narrow on demo]
//   record setup: 637 of 0123456789abcdef
#pragma once

#include <cstddef>
#include <map>
#include <string>
#include <utility>
#include <vector>

namespace bitspan::frozen {

// Names and values, in the order in which they are written.
using Quantities = std::vector<std::pair<std::string, std::string>>;

// What was computed of a case.
struct Computed {
  Quantities quantities;
  std::vector<std::string> disagreements;  // between engines that must be equal: one line for each
};

// The folder that holds these files.
std::string digest_folder();
// Whether the digests are written anew instead of compared: BITSPAN_FREEZE is in the environment.
bool freezing();
// Whether the random configurations are drawn anew before that: its value is "configs".
bool drawing_configs();

class DigestFile {
 public:
  explicit DigestFile(const std::string& name);
  // Compares a case with the file. It is a test failure that names the case and the quantities where they
  // differ, or where engines disagree.
  void check(const std::string& title, const Computed& computed);
  void check(const std::string& title, const Quantities& quantities) {
    check(title, Computed{quantities, {}});
  }
  // To be called last. Comparing: fails where the file has cases that were not checked. Freezing: writes the
  // file, unless the test has failed already, and skips the test.
  void finish();

 private:
  using Section = std::map<std::string, std::string>;  // from quantity to value

  std::string differences_from_file(const std::string& title, const Quantities& quantities);
  void fail(const std::string& title, const std::string& differences);

  std::string path_;
  std::map<std::string, Section> frozen_;
  std::string computed_;  // the file as it would be written
  std::size_t cases_ = 0, quantities_ = 0;
  std::size_t failures_ = 0;
  std::string further_;  // titles of the failures that are not told in full
};

}  // namespace bitspan::frozen
