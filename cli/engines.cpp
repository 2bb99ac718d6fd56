#include "cli/engines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "config/rtl_timing.hpp"
#include "golden/engine_golden.hpp"
#include "golden/ideal.hpp"
#include "model/engine_model.hpp"
#include "model/timed/engine_systemc.hpp"
#include "tb/engine_rtl.hpp"

namespace bitspan {
namespace {

using Factory = std::unique_ptr<Engine> (*)(const Config&, std::uint64_t stall_seed, const ModelOptions&);

struct Entry {
  std::string_view name;
  Factory make;
};

constexpr std::array<Entry, 5> entries{{
    {"golden", [](const Config& c, std::uint64_t, const ModelOptions&) { return make_golden(c); }},
    {"model", [](const Config& c, std::uint64_t, const ModelOptions& o) { return make_model(c, o); }},
    {"systemc",
     [](const Config& c, std::uint64_t, const ModelOptions&) -> std::unique_ptr<Engine> {
       return make_systemc(c);
     }},
    {"rtl",
     [](const Config& c, std::uint64_t seed, const ModelOptions&) -> std::unique_ptr<Engine> {
       RtlOptions options;
       options.stall_seed = seed;
       return make_rtl(c, options);
     }},
    {"ideal", [](const Config& c, std::uint64_t, const ModelOptions&) { return make_ideal(c); }},
}};

constexpr auto names = [] {
  std::array<std::string_view, entries.size()> out;
  std::ranges::transform(entries, out.begin(), &Entry::name);
  return out;
}();

const Entry& find(std::string_view name) {
  const auto* const at = std::ranges::find(entries, name, &Entry::name);
  if (at == entries.end()) {
    std::string legal;
    for (const std::string_view known : names) {
      legal += fmt::format("{}{}", legal.empty() ? "" : ", ", known);
    }
    throw InputError(fmt::format("--engines: '{}' is no engine; legal: {}", name, legal));
  }
  return *at;
}

}  // namespace

std::span<const std::string_view> engine_names() { return names; }

std::vector<std::string> parse_engines(const std::string& list) {
  std::vector<std::string> out;
  std::size_t from = 0;
  while (true) {
    const std::size_t comma = list.find(',', from);
    const std::string name = list.substr(from, comma == std::string::npos ? comma : comma - from);
    static_cast<void>(find(name));
    if (std::ranges::find(out, name) != out.end()) {
      throw InputError(fmt::format("--engines: '{}' is named twice", name));
    }
    out.push_back(name);
    if (comma == std::string::npos) {
      return out;
    }
    from = comma + 1;
  }
}

bool engine_runs(std::string_view name, const Config& config) { return name != "rtl" || has_rtl(config); }

std::unique_ptr<Engine> make_engine(std::string_view name, const Config& config, std::uint64_t stall_seed,
                                    const ModelOptions& model) {
  return find(name).make(config, stall_seed, model);
}

}  // namespace bitspan
