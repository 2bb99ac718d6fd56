// SPDX-License-Identifier: Apache-2.0
// A MeshFile as bytes, from the program that runs Assimp to the one that waits for it. Both are of one build.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "scene/mesh_file.hpp"

namespace bitspan {

//   offset  0            8              16          24
//           "bitmesh1"   payload bytes  its FNV-1a  payload ...
inline constexpr std::size_t mesh_header_bytes = 24;
inline constexpr std::uint64_t mesh_payload_limit = std::uint64_t{1} << 33;

// The answer of that program: a mesh, or why there is none.
struct MeshAnswer {
  MeshFile mesh;
  std::string error;  // empty: there is one
};

std::vector<std::uint8_t> encode_mesh(const MeshAnswer& answer);

// Returns how many bytes follow a header. Throws std::runtime_error where it is none.
std::uint64_t mesh_payload_bytes(std::span<const std::uint8_t> header);
// Throws std::runtime_error where the bytes are not what encode_mesh gave.
MeshAnswer decode_mesh(std::span<const std::uint8_t> header, std::span<const std::uint8_t> payload);

}  // namespace bitspan
