// SPDX-License-Identifier: Apache-2.0
// A copy of the RTL and its benches that a test may change: the RTL under test while the object lives.
#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>

#include "io/data_folder.hpp"
#include "tb/rtl_build.hpp"
#include "tests/support/environment.hpp"
#include "tests/support/files.hpp"
#include "tests/support/long_run.hpp"

namespace bitspan {

class RtlCopy {
 public:
  RtlCopy() {
    for (const char* part : {"rtl", "tb"}) {
      std::filesystem::copy(data_folder() / part, folder_.path(part),
                            std::filesystem::copy_options::recursive);
    }
    // Apart from the RTL as it is, so that neither drives the other out of its cache.
    cache_.emplace("BITSPAN_CACHE", (rtl_cache_folder() / "planted").string());
    root_.emplace("BITSPAN_ROOT", folder_.path());
  }
  // Replaces the only occurrence of `from`.
  void replace(const std::string& file, std::string_view from, std::string_view to) const {
    std::string text = folder_.read(file);
    const std::size_t at = text.find(from);
    ASSERT_NE(at, std::string::npos) << file << " has no '" << from << "'";
    ASSERT_EQ(text.find(from, at + 1), std::string::npos) << file << " has '" << from << "' twice";
    text.replace(at, from.size(), to);
    folder_.write(file, text);
  }
  // A span that no other one follows at once delivers its last pixel twice.
  void plant_doubled_pixel() const {
    replace("rtl/span.sv", "else if (issues && last_q) active_q <= 1'b0;",
            "else if (issues && last_q && again_q) active_q <= 1'b0;");
    replace(
        "rtl/span.sv", "      left_q <= left_q - IndexW'(1);\n      last_q <= left_q == IndexW'(2);",
        "      if (!last_q) left_q <= left_q - IndexW'(1);\n      last_q <= last_q || left_q == IndexW'(2);");
    replace("rtl/span.sv", "logic en, last_q, take, active_q;",
            "logic en, last_q, take, active_q, again_q;\n"
            "  always_ff @(posedge clk_i) if (take) again_q <= 1'b0; else if (issues && last_q) again_q <= "
            "1'b1;");
  }
  std::string path() const { return folder_.path(); }

 private:
  TemporaryFolder folder_;
  std::optional<Environment> root_, cache_;
};

struct PlantedBug {
  const char *file, *from, *to;
};
// Plants each bug alone in a copy of the RTL; `run` must throw std::logic_error with each. In the gate one of
// them, which changes with the commit.
template <class Run>
void expect_seen(std::span<const PlantedBug> bugs, const Run& run) {
  const RtlCopy copy;
  for (const PlantedBug& bug : in_gate(bugs)) {
    copy.replace(bug.file, bug.from, bug.to);
    EXPECT_THROW(run(), std::logic_error) << bug.file << ": " << bug.to;
    copy.replace(bug.file, bug.to, bug.from);
  }
}

}  // namespace bitspan
