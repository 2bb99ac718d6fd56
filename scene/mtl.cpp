// SPDX-License-Identifier: Apache-2.0
#include "scene/mtl.hpp"

#include <algorithm>
#include <filesystem>
#include <optional>

#include "config/byte_order_mark.hpp"
#include "config/config.hpp"
#include "scene/lines.hpp"
#include "scene/mesh_text.hpp"

namespace bitspan {
namespace {

std::string lower(std::string_view word) {
  std::string out(word);
  for (char& letter : out) {
    if (letter >= 'A' && letter <= 'Z') letter = static_cast<char>(letter + ('a' - 'A'));
  }
  return out;
}

// An option in front of an image's name: how many words follow at most; those that need not be there are
// numbers.
struct MapOption {
  std::string_view name;
  int words;
  bool is_numbers;          // up to `words` numbers, else exactly `words` words
  std::string_view no_use;  // the words that change nothing; "*": none does
};
constexpr auto map_options = std::to_array<MapOption>({{"-blendu", 1, false, "*"},
                                                       {"-blendv", 1, false, "*"},
                                                       {"-bm", 1, false, "*"},
                                                       {"-boost", 1, false, "*"},
                                                       {"-cc", 1, false, "off"},
                                                       {"-clamp", 1, false, "off"},
                                                       {"-imfchan", 1, false, ""},
                                                       {"-mm", 2, false, "0 1"},
                                                       {"-o", 3, true, "*"},
                                                       {"-s", 3, true, "*"},
                                                       {"-t", 3, true, ""},
                                                       {"-texres", 1, false, ""},
                                                       {"-type", 1, false, ""}});

class MtlReader {
 public:
  MtlReader(const std::string& path, const std::string& mesh_folder, MtlLibrary& library,
            std::vector<std::string>& notes)
      : path_(path), mesh_folder_(mesh_folder), library_(library), notes_(notes) {}

  void read(std::string_view text) {
    StatementLines lines(without_mark(text));
    std::string_view statement;
    while (lines.next(statement)) {
      line_ = lines.number();
      const std::string keyword = lower(take_word(statement));
      read_statement(keyword, trimmed(statement));
    }
  }

 private:
  InputError error(const std::string& what) const {
    return InputError(path_ + ":" + std::to_string(line_) + ": " + what);
  }
  // Here, and not of the whole file, so with its line.
  void note(const std::string& what) { notes_.push_back(file() + ":" + std::to_string(line_) + ": " + what); }
  std::string file() const { return std::filesystem::path(path_).filename().string(); }

  void read_statement(const std::string& keyword, std::string_view rest) {
    if (keyword == "newmtl") return begin_material(rest);
    const bool is_read = keyword == "kd" || keyword == "d" || keyword == "tr" || keyword == "map_kd";
    const bool is_left_out = keyword == "map_d" || keyword == "map_tr" || keyword == "decal";
    if ((is_read || is_left_out) && material_ < 0) {
      return note(keyword + " stands before the first newmtl, and is left out");
    }
    if (is_left_out) return note(keyword + " is left out");
    if (keyword == "kd") return read_color(rest);
    if (keyword == "map_kd") return read_map(rest);
    if (keyword == "d" || keyword == "tr") return read_opacity(keyword, rest);
    // What is left only lights a surface, or is another program's.
  }

  MeshMaterial& material() { return library_.materials[static_cast<std::size_t>(material_)]; }

  void begin_material(std::string_view name) {
    const auto [entry, is_new] =
        library_.by_name.try_emplace(std::string(name), static_cast<int>(library_.materials.size()));
    if (!is_new) note("material " + in_quotes(name) + " is defined twice; the last one counts");
    entry->second = material_ = static_cast<int>(library_.materials.size());
    library_.materials.push_back({.name = std::string(name)});
    library_.placements.emplace_back();
    has_opacity_ = false;
  }

  double number(std::string_view word) const {
    const std::optional<double> value = to_number(word);
    if (!value) throw error(in_quotes(word) + " is no number that a double holds; expected one");
    return *value;
  }

  void read_color(std::string_view rest) {
    std::string_view words = rest;
    const std::string_view first = take_word(words);
    if (first == "spectral" || first == "xyz") {
      return note("Kd " + std::string(first) + " is left out: the material is white");
    }
    const double red = number(first);
    double green = red, blue = red;
    if (const std::string_view second = take_word(words); !second.empty() && !second.starts_with('#')) {
      green = number(second);
      blue = number(take_word(words));
    }
    for (const double value : {red, green, blue}) {
      if (!(value >= 0 && value <= 1)) note("Kd is beyond 0..1, and clamped");
    }
    const std::array<double, 3> color{red, green, blue};
    std::copy(color.begin(), color.end(), material().color.begin());
  }

  void read_opacity(const std::string& keyword, std::string_view rest) {
    std::string_view word = take_word(rest);
    if (word == "-halo") {
      note("d -halo is read as d");
      word = take_word(rest);
    }
    const double value = number(word);
    // Some programs write d and a Tr that says the opposite.
    if (keyword == "tr" && has_opacity_) return;
    has_opacity_ = has_opacity_ || keyword == "d";
    material().color[3] = keyword == "d" ? value : 1 - value;
  }

  void read_map(std::string_view rest) {
    MtlLibrary::Placement place;
    while (rest.starts_with('-')) {
      std::string_view behind = rest;
      const std::string option = lower(take_word(behind));
      const auto known = std::ranges::find(map_options, option, &MapOption::name);
      if (known == map_options.end()) break;  // a name that begins so
      read_option(*known, behind, place);
      rest = trimmed(behind);
    }
    if (rest.empty()) return note("map_Kd has no image, and is left out");
    std::string name(rest);
    std::replace(name.begin(), name.end(), '\\', '/');
    material().image = image(name);
    library_.placements[static_cast<std::size_t>(material_)] = place;
  }

  // Takes the option's words off `rest`.
  void read_option(const MapOption& option, std::string_view& rest, MtlLibrary::Placement& place) {
    std::string words;
    std::array<double, 3> numbers{};
    int count = 0;
    for (; count < option.words; ++count) {
      std::string_view behind = rest;
      const std::string_view word = take_word(behind);
      if (option.is_numbers) {
        const std::optional<double> value = to_number(word);
        // The last word is the image's name, even if it is a number.
        if (count > 0 && (!value || trimmed(behind).empty())) break;
        numbers[static_cast<std::size_t>(count)] = number(word);
      }
      if (!words.empty()) words += ' ';
      words += word;
      rest = behind;
    }
    const auto given = std::min<std::ptrdiff_t>(count, 2);
    if (option.name == "-o") std::copy_n(numbers.begin(), given, place.offset.begin());
    if (option.name == "-s") std::copy_n(numbers.begin(), given, place.scale.begin());
    if (option.no_use != "*" && words != option.no_use) {
      note("map_Kd " + std::string(option.name) + " is left out");
    }
  }

  int image(const std::string& name) {
    const std::filesystem::path folder = std::filesystem::path(path_).parent_path();
    std::string path = (folder / name).string();
    std::error_code code;
    if (!std::filesystem::exists(path, code)) {
      path = (std::filesystem::path(mesh_folder_) / name).string();
    }
    const auto known = std::ranges::find(library_.images, path, &MeshImage::path);
    if (known == library_.images.end()) {
      library_.images.push_back({path, path, {}});
      return static_cast<int>(library_.images.size()) - 1;
    }
    return static_cast<int>(known - library_.images.begin());
  }

  const std::string& path_;
  const std::string& mesh_folder_;
  MtlLibrary& library_;
  std::vector<std::string>& notes_;
  std::size_t line_ = 0;
  int material_ = -1;
  bool has_opacity_ = false;  // by d
};

}  // namespace

void parse_mtl(std::string_view text, const std::string& path, const std::string& mesh_folder,
               MtlLibrary& library, std::vector<std::string>& notes) {
  MtlReader(path, mesh_folder, library, notes).read(text);
}

}  // namespace bitspan
