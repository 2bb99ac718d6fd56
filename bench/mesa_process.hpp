// SPDX-License-Identifier: Apache-2.0
// Mesa in a process of its own, so that one run can hold several of its renderers and take turns with them.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "config/config.hpp"

namespace bitspan::bench {

struct MesaOptions {
  std::string driver = "llvmpipe";  // or softpipe
  int threads = 0;                  // LP_NUM_THREADS: 0 draws in the calling thread alone
  TextureFilter filter = TextureFilter::nearest;
  int depth_bits = 16;
  MipMode mip = MipMode::none;
};

class MesaProcess {
 public:
  // Starts this program again; `scene` and `texture` are frame_scene's arguments. Returns when the scene is
  // uploaded. Throws InputError with the child's reason.
  MesaProcess(const std::string& scene, const std::string& texture, const MesaOptions& options);
  ~MesaProcess();
  MesaProcess(const MesaProcess&) = delete;
  MesaProcess& operator=(const MesaProcess&) = delete;

  // Returns the seconds that one frame took, from the clear to the finished picture, by the child's clock.
  double draw();
  // Returns the picture of the last draw(): RGBA, rows from the top.
  std::vector<std::uint8_t> picture();
  const std::string& renderer() const { return renderer_; }

 private:
  void ask(char command);
  void read(void* data, std::size_t size);
  void end();  // the child ends when its input does

  int to_child_ = -1, from_child_ = -1;
  int pid_ = -1;
  std::string renderer_;
};

// The first argument of a process that MesaProcess started, whose main() must call mesa_child.
inline constexpr const char* mesa_child_flag = "--mesa-child";
int mesa_child(int argc, char** argv);

}  // namespace bitspan::bench
