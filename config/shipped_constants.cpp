// SPDX-License-Identifier: Apache-2.0
// shipped_constants OUTPUT FILE.toml ...: the shipped configurations as constant expressions, a header that
// the specialised forms are compiled from. Run by the build (config/CMakeLists.txt).
#include <fmt/format.h>

#include <cctype>
#include <cstdio>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "config/keys.hpp"

namespace bitspan {
namespace {

std::string truth(bool x) { return x ? "true" : "false"; }

std::string text(const std::string& /*member*/, const int* v) { return fmt::format("{}", *v); }
std::string text(const std::string& /*member*/, const bool* v) { return truth(*v); }
std::string text(const std::string& member, const Choice& v) {
  return fmt::format("decltype({}){{{}}}", member, *v.number);
}
std::string text(const std::string& /*member*/, const StartOffset* v) {
  return fmt::format("{{{}, {:a}}}", truth(v->half_ulp), v->value);
}
std::string text(const std::string& /*member*/, const Color* v) {
  if (!*v) return "std::nullopt";
  return fmt::format("std::array<std::uint8_t, 3>{{{}, {}, {}}}", (**v)[0], (**v)[1], (**v)[2]);
}
std::string text(const std::string& /*member*/, const Rgba* v) {
  return fmt::format("std::array<std::uint8_t, 4>{{{}, {}, {}, {}}}", (*v)[0], (*v)[1], (*v)[2], (*v)[3]);
}
std::string text(const std::string& /*member*/, const Format* /*v*/) {
  throw std::logic_error("a format is written by its fields");
}

// A function that returns the configuration without its name.
std::string function(const std::string& name, const Config& c) {
  std::string out = fmt::format("constexpr Config {}() {{\n  Config c;\n", name);
  for (const Key& key : keys()) {
    const std::string member = "c." + member_of(key);
    const std::string value = std::visit([&](const auto& v) { return text(member, v); }, place(c, key));
    out += fmt::format("  {} = {};  // {}\n", member, value, key.path);
  }
  return out + "  return c;\n}\n\n";
}

std::string header(const std::vector<std::string>& paths) {
  std::string functions, entries;
  for (const std::string& path : paths) {
    const Config config = load_config(path);
    for (const char ch : config.name) {
      if (std::isalnum(static_cast<unsigned char>(ch)) == 0 && ch != '_') {
        throw InputError(path + ": a shipped configuration's name has letters, digits and underscores only");
      }
    }
    functions += function(config.name, config);
    entries += fmt::format("    Entry{{\"{0}\", \"{1}\", {0}}},\n", config.name, config_hash(config));
  }
  return "// Made by shipped_constants from config/*.toml.\n"
         "#pragma once\n\n"
         "#include <array>\n#include <cstdint>\n#include <string_view>\n\n"
         "#include \"config/config.hpp\"\n\n"
         "namespace bitspan::shipped {\n\n"
         "// The configurations of config/ as constant expressions, their names left empty.\n" +
         functions +
         "struct Entry {\n"
         "  std::string_view name;  // the file's stem\n"
         "  std::string_view hash;  // config_hash\n"
         "  Config (*make)();\n"
         "};\n"
         "inline constexpr std::array all{\n" +
         entries + "};\n\n}  // namespace bitspan::shipped\n";
}

}  // namespace
}  // namespace bitspan

int main(int argc, char** argv) {
  try {
    if (argc < 3) throw bitspan::InputError("usage: shipped_constants OUTPUT FILE.toml ...");
    const std::string text = bitspan::header({argv + 2, argv + argc});
    std::ofstream out(argv[1], std::ios::binary | std::ios::trunc);
    out << text;
    out.close();
    if (!out) throw bitspan::InputError(std::string(argv[1]) + ": cannot be written");
  } catch (const std::exception& error) {
    std::fprintf(stderr, "shipped_constants: %s\n", error.what());
    return 2;
  }
  return 0;
}
