// merge, timed: reads the stored colour where it blends, writes colour and depth code.
#pragma once

#include <algorithm>
#include <cmath>

#include "model/timed/run.hpp"

namespace bitspan::timed {

class MergeStage : public PipeStage<FragmentItem> {
 public:
  MergeStage(Run& run, Memory& memory, Fifo<FragmentItem*>& in)
      : PipeStage("merge", run.timing(Stage::merge), in, nullptr, run.fragments, &memory, Memory::Port::merge,
                  run.config.memory.latency),
        run_(run),
        color_read_(run.config.memory, color_bytes),
        color_write_(run.config.memory, color_bytes),
        depth_write_(run.config.memory, run.depth_bytes()) {}

 private:
  bool enters(FragmentItem& item) override {
    const std::size_t at = run_.pixel(item.fragment);
    const bool blends = item.texel.a < opaque();
    if (blends && color_read_.access(at * color_bytes)) ask_read(color_read_.word_bytes());
    if (color_write_.access(at * color_bytes)) ask_write(color_write_.word_bytes());
    if (depth_write_.access(at * run_.depth_bytes())) ask_write(depth_write_.word_bytes());

    Frame& frame = run_.frame;
    std::uint8_t* color = frame.color.data() + 4 * at;
    MergeRecord merged;
    model::merge(run_.pipeline.merge, item.depth, item.texel, item.fog, {color[0], color[1], color[2]},
                 merged);
    color[0] = static_cast<std::uint8_t>(merged.r);
    color[1] = static_cast<std::uint8_t>(merged.g);
    color[2] = static_cast<std::uint8_t>(merged.b);
    frame.depth[at] = static_cast<std::uint32_t>(merged.z);
    const int uv_fraction = run_.pipeline.texture.uv.fraction;
    frame.u[at] = std::ldexp(static_cast<double>(item.fragment.u), -uv_fraction);
    frame.v[at] = std::ldexp(static_cast<double>(item.fragment.v), -uv_fraction);
    frame.triangle[at] = static_cast<std::int32_t>(item.fragment.triangle);
    ++run_.counters.written;
    if (run_.trace != nullptr) run_.trace->merge.push_back(merged);
    return true;
  }
  void leaves(FragmentItem& item, bool /*kept*/, std::uint64_t now) override {
    run_.release(item.fragment, now);
  }
  // The least raw alpha that is 1 or more.
  std::int64_t opaque() const {
    const int fraction = run_.pipeline.merge.alpha.fraction;
    return fraction <= 0 ? 1 : std::int64_t{1} << std::min(fraction, 62);
  }
  Run& run_;
  WordRegister color_read_, color_write_, depth_write_;
};

}  // namespace bitspan::timed
