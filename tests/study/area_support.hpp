// SPDX-License-Identifier: Apache-2.0
// A configuration for tests that run the tools of synthesis.
#pragma once

#include <cstdint>
#include <string>

#include "study/keys.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {

// Constant-depth rows with as few bits as make a small netlist: nothing that anybody would draw with.
inline Config tiny_config() {
  return with_keys(shipped_config("narrow"), {{"perspective.mode", std::string("const_depth_rows")},
                                              {"rtl.shades", false},
                                              {"raster.coordinate_bits", std::int64_t{8}},
                                              {"formats.setup.b.word", std::int64_t{6}},
                                              {"formats.setup.b.int", std::int64_t{6}},
                                              {"formats.span.h.word", std::int64_t{6}},
                                              {"formats.span.h.int", std::int64_t{6}},
                                              {"formats.span.f.word", std::int64_t{8}},
                                              {"formats.span.f.int", std::int64_t{8}},
                                              {"formats.span.f_step.word", std::int64_t{8}},
                                              {"formats.span.f_step.int", std::int64_t{8}},
                                              {"formats.span.uv_step.word", std::int64_t{8}},
                                              {"formats.span.uv_step.int", std::int64_t{7}},
                                              {"formats.span.uv_acc.word", std::int64_t{8}},
                                              {"formats.span.uv_acc.int", std::int64_t{7}},
                                              {"formats.span.uv.word", std::int64_t{7}},
                                              {"formats.span.uv.int", std::int64_t{7}},
                                              {"formats.plane.k.word", std::int64_t{6}},
                                              {"reciprocal.row.output.word", std::int64_t{4}},
                                              {"rtl.product_digits", std::int64_t{1}},
                                              {"rtl.pixel_clocks", std::int64_t{1}}});
}

}  // namespace bitspan
