// SPDX-License-Identifier: Apache-2.0
#include "tests/rtl/random_rtl.hpp"

#include <algorithm>
#include <cmath>

#include "config/lines.hpp"
#include "config/rtl_timing.hpp"
#include "report/random_config.hpp"
#include "tests/support/test_config.hpp"

namespace bitspan {
namespace {

int between(Random& random, int lowest, int highest) {
  return std::uniform_int_distribution<int>(lowest, highest)(random);
}
bool chance(Random& random, double p) { return std::bernoulli_distribution(p)(random); }

}  // namespace

Config random_rtl_config(Random& random) {
  const std::vector<Config> bases{shipped_config("depth16")};
  return random_config(random(), bases, {.rtl_only = true, .for_scenes = false, .check = {}});
}

std::int64_t random_raw(Random& random, const Format& f) {
  const std::uint64_t mask = f.word == 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << f.word) - 1;
  std::uint64_t bits = random() & mask;
  switch (between(random, 0, 9)) {
    case 0:
      bits = f.is_signed ? mask >> 1 : mask;  // highest
      break;
    case 1:
      bits = f.is_signed ? mask ^ (mask >> 1) : 0;  // lowest
      break;
    case 2:
      bits = 0;
      break;
    case 3:
    case 4:
    case 5:  // small, of either sign
      bits >>= between(random, 0, f.word - 1);
      if (f.is_signed && chance(random, 0.5)) bits = (~bits + 1) & mask;
      break;
    default:
      break;
  }
  if (!f.is_signed || f.word == 64) return static_cast<std::int64_t>(bits);
  const std::uint64_t sign = std::uint64_t{1} << (f.word - 1);
  return static_cast<std::int64_t>((bits ^ sign) - sign);
}

std::vector<RowRecord> random_rows(Random& random, const Config& c, int count, int longest) {
  std::vector<RowRecord> rows(static_cast<std::size_t>(count));
  const std::int64_t end = (std::int64_t{1} << pixel_index_bits(c)) - longest - 1;
  for (RowRecord& row : rows) {
    const Format& x = c.format(FormatId::edge_x);
    row.l_x = random_raw(random, x);
    row.r_x = random_raw(random, x);
    if (row.r_x < row.l_x && chance(random, 0.9)) std::swap(row.l_x, row.r_x);
    if (chance(random, 0.05)) row.r_x = row.l_x;
    row.x_first = chance(random, 0.5)
                      ? static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end))
                      : std::clamp<std::int64_t>(row.l_x >> std::clamp(x.fraction(), 0, 62), 0, end);
    row.x_last = row.x_first + between(random, 0, chance(random, 0.3) ? 1 : longest - 1);
    for (std::int64_t* h : {&row.l_h, &row.r_h}) *h = random_raw(random, c.format(FormatId::edge_h));
    for (std::int64_t* uv : {&row.l_u, &row.r_u, &row.l_v, &row.r_v}) {
      *uv = random_raw(random, c.format(FormatId::edge_uv));
    }
    if (chance(random, 0.1)) row.l_u = row.r_u = 0;  // 0 divided by any h + B
    for (std::int64_t* shade :
         {&row.l_r, &row.l_g, &row.l_b, &row.l_a, &row.r_r, &row.r_g, &row.r_b, &row.r_a}) {
      *shade = random_raw(random, c.format(FormatId::edge_shade));
    }
  }
  return rows;
}

std::vector<PlaneRowRecord> random_plane_rows(Random& random, const Config& c, int count, int longest) {
  std::vector<PlaneRowRecord> rows(static_cast<std::size_t>(count));
  const std::int64_t end = (std::int64_t{1} << pixel_index_bits(c)) - longest - 1;
  const int phase_bits = c.format(FormatId::plane_k).fraction();
  for (PlaneRowRecord& row : rows) {
    row.major_first = static_cast<std::int64_t>(random() % static_cast<std::uint64_t>(end));
    row.count = between(random, 1, chance(random, 0.3) ? 2 : longest);
    row.phase = static_cast<std::int64_t>(random() >> (64 - phase_bits));
    row.h = random_raw(random, c.format(FormatId::span_h));
    row.gu = random_raw(random, c.format(FormatId::span_f));
    row.gv = random_raw(random, c.format(FormatId::span_f));
    for (std::int64_t* step : {&row.gu_step0, &row.gu_step1, &row.gv_step0, &row.gv_step1}) {
      *step = random_raw(random, c.format(FormatId::span_f_step));
    }
    for (std::int64_t* shade : {&row.r, &row.g, &row.b, &row.a}) {
      *shade = random_raw(random, c.format(FormatId::span_shade_acc));
    }
    for (std::int64_t* step : {&row.r_step0, &row.g_step0, &row.b_step0, &row.a_step0, &row.r_step1,
                               &row.g_step1, &row.b_step1, &row.a_step1}) {
      *step = random_raw(random, c.format(FormatId::span_shade_step));
    }
  }
  return rows;
}

std::vector<RowChannelRecord> random_ends(Random& random, const Config& c) {
  std::vector<RowChannelRecord> ends;
  for (const int channel : ChannelList(c)) {
    const Format& end = c.format(line_of(channel_line(channel), c.perspective).edge.kept);
    ends.push_back({.channel = channel, .l = random_raw(random, end), .r = random_raw(random, end)});
  }
  return ends;
}

std::vector<SpanChannelRecord> random_starts(Random& random, const Config& c) {
  std::vector<SpanChannelRecord> starts;
  for (const int channel : ChannelList(c)) {
    const LineWalk row = line_of(channel_line(channel), c.perspective).row;
    starts.push_back({.channel = channel,
                      .w = random_raw(random, c.format(row.acc)),
                      .w_step0 = random_raw(random, c.format(row.step)),
                      .w_step1 = random_raw(random, c.format(row.step))});
  }
  return starts;
}

std::int64_t random_k(Random& random, const Config& c) {
  const std::int64_t one = std::int64_t{1} << c.format(FormatId::plane_k).fraction();
  switch (between(random, 0, 5)) {
    case 0:
      return 0;
    case 1:
      return one;
    case 2:
      return -one;
    default:
      return std::uniform_int_distribution<std::int64_t>(-one, one)(random);
  }
}

std::optional<std::int64_t> half_of(const Format& format) {
  const int place = format.fraction() - 1;
  const int places = format.is_signed ? format.word - 1 : format.word;
  if (place < 0 || place >= places) return std::nullopt;
  return std::int64_t{1} << place;
}

}  // namespace bitspan
