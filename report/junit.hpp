// SPDX-License-Identifier: Apache-2.0
// JUnit XML as continuous integration reads it: one suite, one testcase per scene, stage and pair of engines.
#pragma once

#include <string>
#include <vector>

namespace bitspan {

struct JunitCase {
  std::string class_name;  // the scene
  std::string name;        // stage and pair
  double seconds = 0;
  std::string failure;  // one line, empty where the case passed
  std::string details;  // text of the failure
  std::string skipped;  // the reason, where it did not run
};

// Well-formed XML 1.0 in UTF-8 whatever bytes the texts hold: markup is escaped, characters that XML cannot
// hold and bytes that are no UTF-8 become U+FFFD.
// Throws std::logic_error without a case: a suite of none would pass.
std::string junit_xml(const std::string& suite, const std::vector<JunitCase>& cases);
std::string xml_escape(const std::string& text);

}  // namespace bitspan
