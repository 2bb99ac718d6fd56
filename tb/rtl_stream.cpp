// SPDX-License-Identifier: Apache-2.0
#include "tb/rtl_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <random>
#include <stdexcept>
#include <tuple>

#include "config/modes.hpp"
#include "config/rtl_timing.hpp"
#include "model/stages/line_walk.hpp"

namespace bitspan {
namespace {

std::uint64_t port(const Config& config, FormatId id, std::int64_t raw) {
  return Rtl::to_port(raw, config.format(id).word);
}

// A non-negative number on a port of the pixel index's width.
std::uint64_t index_port(const Config& config, std::int64_t value, const char* what) {
  if (value < 0 || value >= (std::int64_t{1} << pixel_index_bits(config))) {
    throw std::logic_error(fmt::format("{} = {} does not fit the RTL's pixel index", what, value));
  }
  return static_cast<std::uint64_t>(value);
}

std::int64_t value(const Config& config, FormatId id, std::uint64_t bits) {
  return Rtl::from_port(bits, config.format(id));
}

std::int64_t exponent(std::uint64_t bits) { return static_cast<std::int8_t>(bits); }

// Four shades on a port; none without shades in the RTL.
RtlShades shades_port(const Config& config, FormatId id, const Rtl::Shades& raw) {
  return config.rtl.shades ? Rtl::to_port(raw, config.format(id).word) : RtlShades{};
}

// A port of shades has the channels of the configuration above the four shades, in their order.
struct ChannelPort {
  FormatId shade;
  FormatId (*channel)(const Line&);
};
constexpr ChannelPort end_port{FormatId::edge_shade, [](const Line& line) { return line.edge.kept; }};
constexpr ChannelPort acc_port{FormatId::span_shade_acc, [](const Line& line) { return line.row.acc; }};
constexpr ChannelPort step_port{FormatId::span_shade_step, [](const Line& line) { return line.row.step; }};
constexpr ChannelPort pixel_port{FormatId::span_shade, [](const Line& line) { return line.row.kept; }};
static_assert(4 + channel_limit <= sizeof(RtlShades) / sizeof(std::uint64_t));

// Where a channel stands.
struct ChannelPlace {
  Format format;
  std::size_t at = 0;
};
ChannelPlace place_of(const Config& config, const ChannelPort& port, std::int64_t channel) {
  const auto format = [&](std::int64_t number) -> const Format& {
    return config.format(port.channel(line_of(channel_line(number), config.perspective)));
  };
  ChannelPlace place{format(channel), 4 * static_cast<std::size_t>(config.format(port.shade).word)};
  for (const int other : ChannelList(config)) {
    if (other < channel) place.at += static_cast<std::size_t>(format(other).word);
  }
  return place;
}
void put(const Config& config, const ChannelPort& port, std::int64_t channel, std::int64_t raw,
         RtlShades& shades) {
  const ChannelPlace place = place_of(config, port, channel);
  Rtl::put(shades, place.at, raw, place.format.word);
}
std::int64_t get(const Config& config, const ChannelPort& port, std::int64_t channel,
                 const RtlShades& shades) {
  const ChannelPlace place = place_of(config, port, channel);
  return Rtl::get(shades, place.at, place.format);
}

// What happens on one clock, seen from outside.
struct Driver {
  Rtl& rtl;
  std::span<const RtlInputs> records;
  bool keep;
  RtlRun run{};
  RtlDrive drive{};
  RtlSample sample{};
  std::size_t next = 0;  // record to be offered

  void clock(bool in_valid, bool out_ready) {
    drive.in_valid = in_valid;
    drive.out_ready = out_ready;
    if (in_valid) drive.in = records[next];
    rtl.clock(drive, sample);
    const std::uint64_t now = run.clocks++;
    if (keep) run.handshakes.push_back({in_valid, sample.in_ready, sample.out_valid, out_ready});
    if (in_valid && sample.in_ready) {
      ++next;
      if (keep) run.accepted_at.push_back(now);
    }
    if (sample.span_take) {
      run.spans.push_back(sample.span);
      if (keep) run.taken_at.push_back(now);
    }
    if (sample.out_valid && out_ready) {
      run.pixels.push_back(sample.pixel);
      if (keep) run.delivered_at.push_back(now);
    }
  }
};

// Runs on until the RTL must be empty, and keeps what still comes out; `drive` holds the ports' last values.
void drain(Rtl& rtl, RtlRun& run, RtlDrive drive) {
  RtlSample sample{};
  drive.in_valid = false;
  drive.out_ready = true;
  for (int clock = 0; clock < rtl.clocks_until_empty(); ++clock) {
    rtl.clock(drive, sample);
    if (sample.span_take) run.spans.push_back(sample.span);
    if (sample.out_valid) run.pixels.push_back(sample.pixel);
  }
}

// A double in [0, 1) is compared as 32 bits; 1 stands for always.
std::uint64_t threshold(double probability) {
  return static_cast<std::uint64_t>(std::clamp(probability, 0.0, 1.0) * 4294967296.0);
}

}  // namespace

RtlInputs rtl_inputs(const Config& config, const RowRecord& row, std::int64_t b,
                     std::span<const RowChannelRecord> ends) {
  RtlInputs in{};
  in.b = port(config, FormatId::setup_b, b);
  in.x_first = index_port(config, row.x_first, "x_first");
  in.count = index_port(config, row.x_last - row.x_first + 1, "count");
  in.x_l = port(config, FormatId::edge_x, row.l_x);
  in.x_r = port(config, FormatId::edge_x, row.r_x);
  in.h_l = port(config, FormatId::edge_h, row.l_h);
  in.h_r = port(config, FormatId::edge_h, row.r_h);
  in.u_l = port(config, FormatId::edge_uv, row.l_u);
  in.u_r = port(config, FormatId::edge_uv, row.r_u);
  in.v_l = port(config, FormatId::edge_uv, row.l_v);
  in.v_r = port(config, FormatId::edge_uv, row.r_v);
  in.shade_l = shades_port(config, FormatId::edge_shade, {row.l_r, row.l_g, row.l_b, row.l_a});
  in.shade_r = shades_port(config, FormatId::edge_shade, {row.r_r, row.r_g, row.r_b, row.r_a});
  for (const RowChannelRecord& end : ends) {
    put(config, end_port, end.channel, end.l, in.shade_l);
    put(config, end_port, end.channel, end.r, in.shade_r);
  }
  return in;
}

RtlInputs rtl_inputs(const Config& config, const LineWalkRecord& line, std::int64_t b) {
  RtlInputs in = rtl_inputs(config, model::row_of(line), b);
  in.phase = static_cast<std::uint64_t>(line.phase);
  in.k = port(config, FormatId::plane_k, line.k);
  return in;
}

RtlInputs rtl_inputs(const Config& config, const PlaneRowRecord& row, std::int64_t k, std::int64_t b,
                     std::span<const SpanChannelRecord> starts) {
  RtlInputs in{};
  in.b = port(config, FormatId::setup_b, b);
  in.x_first = index_port(config, row.major_first, "major_first");
  in.count = index_port(config, row.count, "count");
  in.phase = static_cast<std::uint64_t>(row.phase);
  in.k = port(config, FormatId::plane_k, k);
  in.h = port(config, FormatId::span_h, row.h);
  in.gu = port(config, FormatId::span_f, row.gu);
  in.gv = port(config, FormatId::span_f, row.gv);
  in.gu_step0 = port(config, FormatId::span_f_step, row.gu_step0);
  in.gu_step1 = port(config, FormatId::span_f_step, row.gu_step1);
  in.gv_step0 = port(config, FormatId::span_f_step, row.gv_step0);
  in.gv_step1 = port(config, FormatId::span_f_step, row.gv_step1);
  in.shade = shades_port(config, FormatId::span_shade_acc, {row.r, row.g, row.b, row.a});
  in.shade_step0 =
      shades_port(config, FormatId::span_shade_step, {row.r_step0, row.g_step0, row.b_step0, row.a_step0});
  in.shade_step1 =
      shades_port(config, FormatId::span_shade_step, {row.r_step1, row.g_step1, row.b_step1, row.a_step1});
  for (const SpanChannelRecord& start : starts) {
    put(config, acc_port, start.channel, start.w, in.shade);
    put(config, step_port, start.channel, start.w_step0, in.shade_step0);
    put(config, step_port, start.channel, start.w_step1, in.shade_step1);
  }
  return in;
}

SpanRecord span_record(const Config& config, const RtlSpan& s) {
  const FormatId acc = texture_acc(config);
  const FormatId step = texture_step(config);
  SpanRecord r;
  r.x = static_cast<std::int64_t>(s.x);
  r.count = static_cast<std::int64_t>(s.count);
  r.recip_m = Rtl::from_port(s.recip_m, config.row_reciprocal.output);
  r.recip_e = exponent(s.recip_e);
  r.phase = static_cast<std::int64_t>(s.phase);
  r.fu_diff = value(config, FormatId::span_f_diff, s.fu_diff);
  r.fv_diff = value(config, FormatId::span_f_diff, s.fv_diff);
  r.h = value(config, FormatId::span_h, s.h);
  r.h_step = value(config, FormatId::span_h_step, s.h_step);
  r.u1 = value(config, FormatId::edge_uv, s.u1);
  r.v1 = value(config, FormatId::edge_uv, s.v1);
  r.fu = value(config, acc, s.fu);
  r.fv = value(config, acc, s.fv);
  r.fu_step0 = value(config, step, s.fu_step0);
  r.fu_step1 = value(config, step, s.fu_step1);
  r.fv_step0 = value(config, step, s.fv_step0);
  r.fv_step1 = value(config, step, s.fv_step1);
  const Format& shade_step = config.format(FormatId::span_shade_step);
  const Rtl::Shades start = Rtl::from_port(s.shade, config.format(FormatId::span_shade_acc));
  const Rtl::Shades step0 = Rtl::from_port(s.shade_step0, shade_step);
  const Rtl::Shades step1 = Rtl::from_port(s.shade_step1, shade_step);
  std::tie(r.r, r.g, r.b, r.a) = std::tuple_cat(start);
  std::tie(r.r_step0, r.g_step0, r.b_step0, r.a_step0) = std::tuple_cat(step0);
  std::tie(r.r_step1, r.g_step1, r.b_step1, r.a_step1) = std::tuple_cat(step1);
  return r;
}

FragmentRecord fragment_record(const Config& config, const RtlPixel& p) {
  const FormatId acc = texture_acc(config);
  FragmentRecord r;
  r.x = static_cast<std::int64_t>(p.x);
  r.last = static_cast<std::int64_t>(p.last);
  r.h = value(config, FormatId::span_h, p.h);
  r.fu = value(config, acc, p.fu);
  r.fv = value(config, acc, p.fv);
  r.recip_m = Rtl::from_port(p.recip_m, config.pixel_reciprocal.output);
  r.recip_e = exponent(p.recip_e);
  r.u = value(config, FormatId::span_uv, p.u);
  r.v = value(config, FormatId::span_uv, p.v);
  std::tie(r.r, r.g, r.b, r.a) = std::tuple_cat(Rtl::from_port(p.shade, config.format(FormatId::span_shade)));
  return r;
}

void take_channel(const Config& config, const RtlSpan& span, SpanChannelRecord& record) {
  record.w = get(config, acc_port, record.channel, span.shade);
  record.w_step0 = get(config, step_port, record.channel, span.shade_step0);
  record.w_step1 = get(config, step_port, record.channel, span.shade_step1);
}
void take_channel(const Config& config, const RtlPixel& pixel, FragmentChannelRecord& record) {
  record.w = get(config, pixel_port, record.channel, pixel.shade);
}

void put_channel(const Config& config, const SpanChannelRecord& record, RtlSpan& span) {
  put(config, acc_port, record.channel, record.w, span.shade);
  put(config, step_port, record.channel, record.w_step0, span.shade_step0);
  put(config, step_port, record.channel, record.w_step1, span.shade_step1);
}
void put_channel(const Config& config, const FragmentChannelRecord& record, RtlPixel& pixel) {
  put(config, pixel_port, record.channel, record.w, pixel.shade);
}

RtlRun run_rtl(Rtl& rtl, std::span<const RtlInputs> records, const RtlStalls& stalls, bool keep_handshakes) {
  std::size_t pixels = 0;
  for (const RtlInputs& record : records) pixels += record.count;
  std::mt19937_64 random(stalls.seed);
  const std::uint64_t gap = threshold(stalls.in_gap);
  const std::uint64_t stall = threshold(stalls.out_stall);
  // Far longer than any latency; a clock that no draw of the stalls lets through does not count.
  constexpr int patience_clocks = 10000;
  int idle = 0;

  Driver driver{rtl, records, keep_handshakes};
  bool offered = false;  // once offered, a record stays
  while (driver.next < records.size() || driver.run.pixels.size() < pixels) {
    const std::uint64_t draw = random();
    if (!offered) offered = driver.next < records.size() && (draw & 0xffffffff) >= gap;
    const bool ready = (draw >> 32) >= stall;
    const std::size_t before = driver.next + driver.run.pixels.size() + driver.run.spans.size();
    const std::size_t record = driver.next;
    driver.clock(offered, ready);
    if (driver.next != record) offered = false;
    const bool moved = before != driver.next + driver.run.pixels.size() + driver.run.spans.size();
    idle = moved ? 0 : idle + (ready ? 1 : 0);
    if (idle > patience_clocks) {
      throw std::logic_error(
          fmt::format("the RTL stands still at clock {}: {} of {} records accepted, {} of {} pixels",
                      driver.run.clocks, driver.next, records.size(), driver.run.pixels.size(), pixels));
    }
  }
  drain(rtl, driver.run, driver.drive);
  return std::move(driver.run);
}

RtlRun replay_rtl(Rtl& rtl, std::span<const RtlInputs> records, std::span<const RtlHandshake> driven) {
  Driver driver{rtl, records, true};
  for (const RtlHandshake& h : driven) {
    if (h.in_valid && driver.next == records.size()) {
      throw std::logic_error(fmt::format("replay offers more than {} records", records.size()));
    }
    driver.clock(h.in_valid, h.out_ready);
  }
  drain(rtl, driver.run, driver.drive);
  return std::move(driver.run);
}

}  // namespace bitspan
