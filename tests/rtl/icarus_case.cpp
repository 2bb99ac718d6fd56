// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/icarus_case.hpp"

#include <fmt/format.h>

#include <iterator>

#include "config/lines.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_sv.hpp"
#include "io/data_folder.hpp"
#include "tb/rtl_build.hpp"
#include "tb/rtl_stream.hpp"

namespace bitspan {
namespace {

std::string line(const std::initializer_list<std::uint64_t>& values) {
  std::string text;
  for (const std::uint64_t v : values) text += fmt::format("{:x} ", v);
  return text + '\n';
}

// Ports of four shades, each as one number, behind a line's other values.
void append(std::string& text, const std::initializer_list<RtlShades>& ports) {
  text.pop_back();
  for (const RtlShades& p : ports) {
    for (std::size_t i = std::size(p.words); i-- > 0;) text += fmt::format("{:016x}", p.words[i]);
    text += ' ';
  }
  text += '\n';
}

std::string input_lines(const std::vector<RtlInputs>& inputs) {
  std::string text;
#define BITSPAN_VALUE(name) in.name,
  for (const RtlInputs& in : inputs) {
    text += line({BITSPAN_RTL_INPUTS(BITSPAN_VALUE)});
    append(text, {BITSPAN_RTL_INPUT_SHADES(BITSPAN_VALUE)});
  }
#undef BITSPAN_VALUE
  return text;
}

std::uint64_t bits(std::int64_t raw, const Format& f) { return Rtl::to_port(raw, f.word); }
std::uint64_t bits(std::int64_t raw, const Config& c, FormatId id) { return bits(raw, c.format(id)); }
std::uint64_t exponent_bits(std::int64_t e) { return Rtl::to_port(e, 8); }

std::string span_lines(const Config& c, const InterpolatorCase& given) {
  const FormatId acc = texture_acc(c);
  const FormatId step = texture_step(c);
  const int shade_acc = c.format(FormatId::span_shade_acc).word;
  const int shade_step = c.format(FormatId::span_shade_step).word;
  std::string text;
  const std::size_t channels = ChannelList(c).size();
  for (std::size_t i = 0; i < given.spans.size(); ++i) {
    const SpanRecord& s = given.spans[i];
    text += line({static_cast<std::uint64_t>(s.x), static_cast<std::uint64_t>(s.count),
                  bits(s.recip_m, c.row_reciprocal.output), exponent_bits(s.recip_e),
                  static_cast<std::uint64_t>(s.phase), bits(s.fu_diff, c, FormatId::span_f_diff),
                  bits(s.fv_diff, c, FormatId::span_f_diff), bits(s.h, c, FormatId::span_h),
                  bits(s.h_step, c, FormatId::span_h_step), bits(s.u1, c, FormatId::edge_uv),
                  bits(s.v1, c, FormatId::edge_uv), bits(s.fu, c, acc), bits(s.fv, c, acc),
                  bits(s.fu_step0, c, step), bits(s.fu_step1, c, step), bits(s.fv_step0, c, step),
                  bits(s.fv_step1, c, step)});
    RtlSpan ports{};
    ports.shade = Rtl::to_port({s.r, s.g, s.b, s.a}, shade_acc);
    ports.shade_step0 = Rtl::to_port({s.r_step0, s.g_step0, s.b_step0, s.a_step0}, shade_step);
    ports.shade_step1 = Rtl::to_port({s.r_step1, s.g_step1, s.b_step1, s.a_step1}, shade_step);
    for (std::size_t k = 0; k < channels; ++k) put_channel(c, given.span_channels[i * channels + k], ports);
    append(text, {ports.shade, ports.shade_step0, ports.shade_step1});
  }
  return text;
}

std::string pixel_lines(const Config& c, const InterpolatorCase& given) {
  const FormatId acc = texture_acc(c);
  const int shade = c.format(FormatId::span_shade).word;
  std::string text;
  const std::size_t channels = ChannelList(c).size();
  for (std::size_t i = 0; i < given.pixels.size(); ++i) {
    const reference::Pixel& p = given.pixels[i];
    const FragmentRecord& f = p.fragment;
    text += line({static_cast<std::uint64_t>(f.x), p.step ? 1U : 0U, static_cast<std::uint64_t>(f.last),
                  bits(f.h, c, FormatId::span_h), bits(f.fu, c, acc), bits(f.fv, c, acc),
                  bits(f.recip_m, c.pixel_reciprocal.output), exponent_bits(f.recip_e),
                  bits(f.u, c, FormatId::span_uv), bits(f.v, c, FormatId::span_uv)});
    RtlPixel ports{};
    ports.shade = Rtl::to_port({f.r, f.g, f.b, f.a}, shade);
    for (std::size_t k = 0; k < channels; ++k) put_channel(c, given.pixel_channels[i * channels + k], ports);
    append(text, {ports.shade});
  }
  return text;
}

}  // namespace

IcarusRun prepare_icarus(const TemporaryFolder& folder, const Config& c, const InterpolatorCase& given) {
  IcarusRun run;
  run.sources = {folder.write("bitspan_cfg_pkg.sv", emit_sv(c))};
  for (const auto& source : rtl_sources()) run.sources.push_back(source);
  run.sources.push_back(data_folder() / "tb/icarus_tb.sv");
  run.arguments = {"+inputs=" + folder.write("inputs", input_lines(given.inputs)),
                   "+spans=" + folder.write("spans", span_lines(c, given)),
                   "+pixels=" + folder.write("pixels", pixel_lines(c, given)), "+seed=7"};
  run.expected = fmt::format("icarus_tb: {} spans, {} pixels, {} values equal", given.spans.size(),
                             given.pixels.size(), 29 * given.spans.size() + 14 * given.pixels.size());
  return run;
}

}  // namespace bitspan
