// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/icarus_case.hpp"

#include <fmt/format.h>

#include "engine/emit_sv.hpp"
#include "tb/rtl_build.hpp"
#include "tb/rtl_stream.hpp"

namespace bitspan {
namespace {

std::string line(const std::initializer_list<std::uint64_t>& values) {
  std::string text;
  for (const std::uint64_t v : values) text += fmt::format("{:x} ", v);
  return text + '\n';
}

std::string input_lines(const std::vector<RtlInputs>& inputs) {
  std::string text;
#define BITSPAN_VALUE(name) in.name,
  for (const RtlInputs& in : inputs) text += line({BITSPAN_RTL_INPUTS(BITSPAN_VALUE)});
#undef BITSPAN_VALUE
  return text;
}

std::uint64_t bits(std::int64_t raw, const Format& f) { return Rtl::to_port(raw, f.word); }
std::uint64_t bits(std::int64_t raw, const Config& c, FormatId id) { return bits(raw, c.format(id)); }
std::uint64_t exponent_bits(std::int64_t e) { return Rtl::to_port(e, 8); }

std::string span_lines(const Config& c, const std::vector<SpanRecord>& spans) {
  const bool rows = c.perspective == Perspective::const_depth_rows;
  const FormatId acc = rows ? FormatId::span_uv_acc : FormatId::span_f;
  const FormatId step = rows ? FormatId::span_uv_step : FormatId::span_f_step;
  std::string text;
  for (const SpanRecord& s : spans) {
    text += line({static_cast<std::uint64_t>(s.x), static_cast<std::uint64_t>(s.count),
                  bits(s.recip_m, c.row_reciprocal.output), exponent_bits(s.recip_e),
                  static_cast<std::uint64_t>(s.phase), bits(s.fu_diff, c, FormatId::span_f_diff),
                  bits(s.fv_diff, c, FormatId::span_f_diff), bits(s.h, c, FormatId::span_h),
                  bits(s.h_step, c, FormatId::span_h_step), bits(s.u1, c, FormatId::edge_uv),
                  bits(s.v1, c, FormatId::edge_uv), bits(s.fu, c, acc), bits(s.fv, c, acc),
                  bits(s.fu_step0, c, step), bits(s.fu_step1, c, step), bits(s.fv_step0, c, step),
                  bits(s.fv_step1, c, step)});
  }
  return text;
}

std::string pixel_lines(const Config& c, const std::vector<reference::Pixel>& pixels) {
  const FormatId acc =
      c.perspective == Perspective::const_depth_rows ? FormatId::span_uv_acc : FormatId::span_f;
  std::string text;
  for (const reference::Pixel& p : pixels) {
    const FragmentRecord& f = p.fragment;
    text += line({static_cast<std::uint64_t>(f.x), p.step ? 1U : 0U, static_cast<std::uint64_t>(f.last),
                  bits(f.h, c, FormatId::span_h), bits(f.fu, c, acc), bits(f.fv, c, acc),
                  bits(f.recip_m, c.pixel_reciprocal.output), exponent_bits(f.recip_e),
                  bits(f.u, c, FormatId::span_uv), bits(f.v, c, FormatId::span_uv)});
  }
  return text;
}

}  // namespace

IcarusRun prepare_icarus(const TemporaryFolder& folder, const Config& c, const InterpolatorCase& given) {
  IcarusRun run;
  run.sources = {folder.write("bitspan_cfg_pkg.sv", emit_sv(c))};
  for (const auto& source : rtl_sources()) run.sources.push_back(source);
  run.sources.push_back(rtl_root() / "tb/icarus_tb.sv");
  run.arguments = {"+inputs=" + folder.write("inputs", input_lines(given.inputs)),
                   "+spans=" + folder.write("spans", span_lines(c, given.spans)),
                   "+pixels=" + folder.write("pixels", pixel_lines(c, given.pixels)), "+seed=7"};
  run.expected = fmt::format("icarus_tb: {} spans, {} pixels, {} values equal", given.spans.size(),
                             given.pixels.size(), 17 * given.spans.size() + 10 * given.pixels.size());
  return run;
}

}  // namespace bitspan
