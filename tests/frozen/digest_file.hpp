// SPDX-License-Identifier: Apache-2.0
// The file digests/NAME.txt: one section for each case, with one line for each quantity.
//
//   [narrow on demo]
//   record setup: 637 of 0123456789abcdef
#pragma once

#include <cstddef>
#include <map>
#include <string>

#include "tests/frozen/digest_lines.hpp"

namespace bitspan::frozen {

class DigestFile {
 public:
  explicit DigestFile(const std::string& name);
  // Compares a case with the file. It is a test failure that names the case and the quantities where they
  // differ, or where engines disagree.
  void check(const std::string& title, const Computed& computed);
  // To be called last. Fails where the file has cases that were not checked.
  void finish();
  // The cases that differ from the file, and how.
  const std::map<std::string, std::string>& differing() const { return differing_; }

 private:
  using Section = std::map<std::string, std::string>;  // from quantity to value

  std::string differences_from_file(const std::string& title, const Quantities& quantities);
  void fail(const std::string& title, const std::string& differences);

  std::string path_;
  std::map<std::string, Section> frozen_;
  std::map<std::string, std::string> differing_;
  std::size_t cases_ = 0, quantities_ = 0;
  std::size_t failures_ = 0;
  std::string further_;  // titles of the failures that are not told in full
};

}  // namespace bitspan::frozen
