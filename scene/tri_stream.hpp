// SPDX-License-Identifier: Apache-2.0
// The triangle stream that test benches feed, `.tri` (JSON Lines) or binary, `.trib`. docs/formats.md
// describes both.
#pragma once

#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scene/picture_size.hpp"
#include "scene/scene.hpp"

namespace bitspan {

struct ShadowOptions;

inline constexpr double coordinate_limit = 32767;  // |x|, |y| of a vertex, pixels

// Whether a stream is meant: by the name "-", .tri or .trib, or since the file is a binary stream.
bool is_stream(const std::string& name);

// Reads a stream line by line, or record by record: the contents say whether it is a binary one. Its memory
// is bounded by the longest line (1 MiB at most) or block, and the textures. Every failure is an InputError
// "file:line: key: what; expected ...", of a binary stream "file: byte N: ...".
class TriReader {
 public:
  // Reads the header and the textures it names, relative to the file's folder. "-" reads standard input.
  // frame: which image dynamic textures [T8] show at first; without it the first one, and a stream with it
  // must have such a texture.
  // A header's "shadow" draws the scene in the light of a lamp: then all triangles are read at once, and what
  // is given are the passes. codes: by whose depth_bits and depth_code shadows are
  // compared; null: by those of a ShadowOptions.
  explicit TriReader(const std::string& path, std::optional<int> frame = std::nullopt,
                     const ShadowOptions* codes = nullptr);
  // Reads from `in`, which must outlive the reader; `origin` stands for the file's name.
  TriReader(std::istream& in, const std::string& origin, std::optional<int> frame = std::nullopt,
            const ShadowOptions* codes = nullptr);
  ~TriReader();
  TriReader(const TriReader&) = delete;
  TriReader& operator=(const TriReader&) = delete;

  // Returns the scene without its triangles. Each image of a dynamic texture is a texture of its own.
  const Scene& scene() const;
  // Gives the next triangle in the order of drawing; returns false at the end of the stream.
  bool next(Triangle& triangle);
  // Gives the commands that stood in front of the triangles read since the last call; at the end of the
  // stream those behind the last one, too.
  std::vector<DrawCommand> take_commands();

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Reads the whole stream at once.
Scene read_tri(const std::string& path, std::optional<int> frame = std::nullopt);
Scene parse_tri(std::string_view text, const std::string& origin, std::optional<int> frame = std::nullopt);

// A command as its line of a stream: JSON, without the newline; colours as fractions.
std::string command_text(const DrawCommand& command);
// The same back; `before` is not in it. Throws InputError "origin:1: key: what; expected ...".
DrawCommand parse_command(std::string_view json, const std::string& origin);

// Throws InputError where a stream of this scene could not be read back: sizes, ranges, indices, zero areas.
void check_scene(const Scene& scene, const std::string& origin);

// Writes the stream. Each number is the shortest that reads back as the same double. Textures go by their
// names.
void write_tri(std::ostream& out, const Scene& scene);
// The same as a binary stream.
void write_trib(std::ostream& out, const Scene& scene);
// Writes `path`, a binary stream where it ends in .trib, and, beside it, each texture as STEM.N.png, or its
// texels as STEM.N.bin; the files appear complete or not at all. Throws InputError where they cannot be
// written.
void write_tri_file(const std::string& path, const Scene& scene);

}  // namespace bitspan
