// SPDX-License-Identifier: Apache-2.0
// Makes the engine `rtl` and the family `dut:NAME` known.
#include "config/rtl_timing.hpp"
#include "engine/registry.hpp"
#include "tb/engine_dut.hpp"
#include "tb/engine_rtl.hpp"
#include "tb/rtl_build.hpp"

namespace bitspan {
namespace {

const RegisterEngine rtl_engine{
    {.name = "rtl",
     .order = 4,
     .compared = true,
     .runs = [](const Config& c) { return has_rtl(c); },
     .needs = "slope.row = divide or reciprocal; line.walk = none or dda; in delta_f also "
              "reciprocal.pixel.pipelined = true and "
              "perspective.subspan_bits = 0",
     .make = [](const Config& c, const EngineOptions& o) -> std::unique_ptr<Engine> {
       RtlOptions options;
       options.stall_seed = o.stall_seed;
       return make_rtl(c, options);
     },
     .own = rtl_own,
     .design = [](const Config&) { return rtl_sources_hash(); }}};

const RegisterEngineFamily duts{{.prefix = dut_prefix, .names = "dut:NAME", .resolve = dut_entry}};

}  // namespace
}  // namespace bitspan

// The linker is told to look for this name, and so takes the object above.
extern "C" void bitspan_rtl_registration() {}
