// SPDX-License-Identifier: Apache-2.0
// Material libraries of OBJ (MTL).
#pragma once

#include <array>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "scene/mesh_file.hpp"

namespace bitspan {

// What an OBJ file's material libraries define.
struct MtlLibrary {
  struct Placement {
    std::array<double, 2> scale{1, 1}, offset{0, 0};
  };
  std::vector<MeshImage> images;
  std::vector<MeshMaterial> materials;
  std::vector<Placement> placements;  // of each material's image: u' = u scale + offset
  std::unordered_map<std::string, int> by_name;
};

// Appends the materials of a library's contents. `path` is the library's; images are beside it, or else in
// `mesh_folder`. Throws InputError where a number is bad.
void parse_mtl(std::string_view text, const std::string& path, const std::string& mesh_folder,
               MtlLibrary& library, std::vector<std::string>& notes);

}  // namespace bitspan
