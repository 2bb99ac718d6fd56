// SPDX-License-Identifier: Apache-2.0
// Mesa's software renderers through OSMesa: the same triangles, texture, depth test, blend and fog in OpenGL.
//
// GALLIUM_DRIVER (llvmpipe, softpipe) and LP_NUM_THREADS choose the renderer. Mesa reads them once per
// process, so bench/mesa_process.hpp starts one process per renderer.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan::bench {

class Mesa {
 public:
  // Uploads the scene's triangles and textures, which it does not need afterwards. depth_bits: 16, 24 or 32.
  // mip: linear has bitspan's own levels and mixes two; nearest takes the nearest one. Throws InputError
  // where OSMesa gives no such context.
  Mesa(const Scene& scene, TextureFilter filter, int depth_bits, MipMode mip = MipMode::none);
  ~Mesa();
  Mesa(const Mesa&) = delete;
  Mesa& operator=(const Mesa&) = delete;

  // Clears, draws every triangle and waits until the picture is there.
  void draw();
  // Returns the picture of the last draw(): RGBA, rows from the top.
  const std::vector<std::uint8_t>& picture() const;
  // Returns Mesa's own name of the renderer, such as "llvmpipe (LLVM 15.0.6, 512 bits)".
  std::string renderer() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace bitspan::bench
