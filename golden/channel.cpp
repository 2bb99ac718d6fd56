// SPDX-License-Identifier: Apache-2.0
#include "golden/channel.hpp"

#include <algorithm>

#include "golden/fog.hpp"

namespace bitspan::golden {

namespace {

bool asks_for(const Scene& scene, LineId channel) {
  switch (channel) {
    case LineId::fog:
      return scene.fog.has_value();
    case LineId::project_x:
    case LineId::project_y:
    case LineId::project_w:
      return scene.projector.has_value();
    case LineId::nx:
    case LineId::ny:
    case LineId::nz:
    case LineId::light:
    case LineId::lx:
    case LineId::ly:
    case LineId::lz:
      return scene.light.has_value();
    case LineId::shade_r:
    case LineId::shade_g:
    case LineId::shade_b:
    case LineId::shade_a:
    case LineId::z:
    case LineId::u2:
    case LineId::v2:
      return true;
    case LineId::h:
    case LineId::fu:
    case LineId::fv:
    case LineId::r:
    case LineId::g:
    case LineId::b:
    case LineId::a:
    case LineId::count:
      break;
  }
  unreachable();  // no channel
}

}  // namespace

std::vector<LineId> channels_in_use(const Config& config, const Scene& scene) {
  std::vector<LineId> out;
  for (const int channel : ChannelList(config)) {
    if (asks_for(scene, channel_line(channel))) out.push_back(channel_line(channel));
  }
  return out;
}

std::ptrdiff_t place_of(const Constants& constants, LineId channel) {
  return std::ranges::find(constants.channels, channel) - constants.channels.begin();
}

std::int64_t channel_at(LineId channel, const Vertex& vertex, Quad h, const Constants& constants,
                        const Quantizer<Quad>& q) {
  const auto narrowed = [&](double w) { return q.raw(q(Quad(w))); };
  // Any double by any power of two of doubles is exact in Quad.
  const auto projected = [&](double w) {
    return q.raw(q(Quad(w) * scalbnq(1, -constants.projector.value().s_exponent)));
  };
  switch (channel) {
    case LineId::fog:
      if (vertex.fog >= 0) return q.raw(q(Quad(vertex.fog)));
      return faded(q, Quad(vertex.s), Quad(constants.fog_distance));
    case LineId::project_x:
      return projected(vertex.project_x);
    case LineId::project_y:
      return projected(vertex.project_y);
    case LineId::project_w:
      return projected(vertex.project_w);
    case LineId::shade_r:
      return narrowed(vertex.c[0]);
    case LineId::shade_g:
      return narrowed(vertex.c[1]);
    case LineId::shade_b:
      return narrowed(vertex.c[2]);
    case LineId::shade_a:
      return narrowed(vertex.c[3]);
    case LineId::z: {
      if (vertex.z < 0) return q.raw(h);
      const Quad z_max = constants.z_max;
      return q.raw(q(z_max - q(Quad(vertex.z) * z_max)));
    }
    case LineId::u2:
      return narrowed(vertex.u2);
    case LineId::v2:
      return narrowed(vertex.v2);
    case LineId::nx:
      return narrowed(vertex.nx);
    case LineId::ny:
      return narrowed(vertex.ny);
    case LineId::nz:
      return narrowed(vertex.nz);
    case LineId::light:
      return constants.light(vertex, q);
    case LineId::lx:
      return narrowed(vertex.lx);
    case LineId::ly:
      return narrowed(vertex.ly);
    case LineId::lz:
      return narrowed(vertex.lz);
    case LineId::h:
    case LineId::fu:
    case LineId::fv:
    case LineId::r:
    case LineId::g:
    case LineId::b:
    case LineId::a:
    case LineId::count:
      break;
  }
  unreachable();  // no channel
}

}  // namespace bitspan::golden
