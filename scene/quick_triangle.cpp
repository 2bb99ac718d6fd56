// SPDX-License-Identifier: Apache-2.0
#include "scene/quick_triangle.hpp"

#include <simdjson.h>

#include <span>

namespace bitspan {
namespace {

using simdjson::SUCCESS;

bool read_row(simdjson::dom::element value, std::span<double> out) {
  simdjson::dom::array row;
  if (value.get(row) != SUCCESS || row.size() != out.size()) return false;
  auto to = out.begin();
  for (const simdjson::dom::element number : row) {
    if (number.get(*to++) != SUCCESS) return false;
  }
  return true;
}

// Three rows of out.size() / 3 numbers.
bool read_rows(simdjson::dom::element value, std::span<double> out) {
  simdjson::dom::array rows;
  if (value.get(rows) != SUCCESS || rows.size() != 3) return false;
  const std::size_t size = out.size() / 3;
  std::size_t at = 0;
  for (const simdjson::dom::element row : rows) {
    if (!read_row(row, out.subspan(size * at++, size))) return false;
  }
  return true;
}

// Returns the bit of the key; 0 where a triangle has no such key, or its value has another form.
unsigned read_part(std::string_view key, simdjson::dom::element value, int version, TriangleLine& out) {
  if (key == "v") {
    std::array<double, 15> n{};
    if (!read_rows(value, n)) return 0;
    auto from = n.begin();
    for (Vertex& v : out.triangle.v) {
      for (double* const to : {&v.x, &v.y, &v.s, &v.u, &v.v}) *to = *from++;
    }
    return 1;
  }
  if (key == "c") return read_rows(value, out.colors.emplace()) ? 2 : 0;
  if (key == "tex") return value.get(out.texture.emplace()) == SUCCESS ? 4 : 0;
  unsigned bit = 8;
  for (const GivenAttribute& given : given_attributes) {
    if (version >= 2 && key == given.key) {
      std::array<double, 3> n{};
      if (!read_row(value, n)) return 0;
      for (std::size_t i = 0; i < 3; ++i) out.triangle.v[i].*given.member = n[i];
      return bit;
    }
    bit *= 2;
  }
  return 0;
}

}  // namespace

struct QuickTriangles::Parser {
  simdjson::dom::parser dom;
};

QuickTriangles::QuickTriangles() : parser_(std::make_unique<Parser>()) {}
QuickTriangles::~QuickTriangles() = default;

bool QuickTriangles::read(std::string& line, int version, TriangleLine& out) {
  // simdjson reads beyond the end of what it parses.
  line.reserve(line.size() + simdjson::SIMDJSON_PADDING);
  simdjson::dom::object object;
  if (parser_->dom.parse(line.data(), line.size(), false).get(object) != SUCCESS) return false;
  out = {};
  unsigned seen = 0;
  for (const auto& [key, value] : object) {
    const unsigned bit = read_part(key, value, version, out);
    if (bit == 0 || (seen & bit) != 0) return false;
    seen |= bit;
  }
  return (seen & 1) != 0;
}

}  // namespace bitspan
