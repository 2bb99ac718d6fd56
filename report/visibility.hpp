// SPDX-License-Identifier: Apache-2.0
// Compares the picture of an oracle with an engine's: the triangle that is seen at each pixel, and its stored
// depth.
//
// An engine compares codes. Of two triangles it shows the one whose code is at least as near, and a code is
// off from the exact h by no more than its proved bound. So the engine may show another triangle than the
// oracle only where both h differ by no more than the sum of the two bounds: a tie, which is predicted. There
// is no other tolerance. docs/verify.md, "Oracles".
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "config/config.hpp"
#include "engine/frame.hpp"
#include "golden/oracle.hpp"
#include "scene/scene.hpp"

namespace bitspan {

enum class PixelVerdict : std::uint8_t {
  background,   // neither shows a triangle
  equal,        // both show the same one, at a depth within its bound
  tie,          // they show two whose order the bounds leave open
  edge,         // of shadows: within reach of one's edge, or as near to what shades it as registers tell; of
                // quadrics: where the triangles that stand for one may show something else
  unexplained,  // anything else
  left_out      // a triangle may be seen there whose fragments may be killed
};

// What a pixel is found to be, and why it is unexplained.
struct PixelFinding {
  PixelVerdict verdict = PixelVerdict::background;
  std::string why{};
};

struct VisibilityReport {
  std::string oracle, engine;
  bool is_truth = true;
  bool is_of_engine = true;  // else it says nothing of one: `engine` is what an oracle is compared with
  std::string_view unit = "pixels";
  int width = 0, height = 0;
  std::uint64_t background = 0, equal = 0, ties = 0, edges = 0, unexplained = 0, left_out = 0;
  std::string_view ties_as = "that the bounds predict";
  std::string_view left_out_as = "whose fragments may be killed";
  std::string_view edges_as = "at a shadow's edge";
  std::string first;  // the first unexplained pixel, in one line; empty without one
  std::vector<OracleCount> counts;
  std::vector<PixelVerdict> pixels;

  std::uint64_t compared() const { return equal + ties + edges + unexplained; }
  // The next pixel's.
  void add(PixelFinding found);
  bool held() const { return !is_truth || unexplained == 0; }
};
// Of an oracle and what it is compared with, of so many pixels, with none of them yet.
VisibilityReport report_on(const Oracle& oracle, int width, int height, std::string_view engine);
std::string pixel_text(const PixelFinding& found);
// "half_planes against golden: 812 pixels equal, 3 ties that the bounds predict, 0 unexplained".
std::string visibility_text(const VisibilityReport& report);
// "3 bodies, 27 edges".
std::string counts_text(std::span<const OracleCount> counts);
// The verdict per pixel as a PNG file: 0 equal, 1 tie, 2 unexplained; grey where nothing is compared.
void write_visibility_map(const std::string& path, const VisibilityReport& report);

// Whether depth is of a line that vertices give, and not of the distance.
bool goes_by_given_depth(const Config& config, const Scene& scene);
// The scene as oracles take it; none where that is the scene itself. Where vertices give their depth, as
// those of a parallel projection do, each has the distance whose h that is: 1/S of it is as linear in the
// picture as the depth. Distances are rounded to doubles, so h is off by up to distance_rounding codes.
std::optional<Scene> by_distance(const Config& config, const Scene& scene);
double distance_rounding(const Config& config, const Scene& scene);

// Why no oracle draws the scene: one line that names the key or the command. Empty where the triangle seen
// at each pixel is a matter of the nearest depth alone, but for fragments that are killed. Throws InputError
// where the scene's commands are not legal.
std::string visibility_refusal(const Config& config, const Scene& scene);

// Of some triangles with the scene's textures: whether fragments of each may be killed.
std::vector<bool> vanishing_triangles(const Config& config, const Scene& scene,
                                      std::span<const Triangle> triangles);

// The picture of what an oracle sees, in RGBA: each triangle in one colour, the mean of its vertices' times
// the texel in its middle.
std::vector<std::uint8_t> flat_picture(const Scene& scene, std::span<const Visible> picture);

// A scene, as oracles and engines are compared over it.
class Visibility {
 public:
  // bounds: for each triangle, by how many codes its stored depth may be off (stored_depth_bounds). The scene
  // must outlive it. Expects a scene that is not refused, and a depth code that is h or its complement.
  Visibility(const Config& config, const Scene& scene, std::vector<double> bounds);
  // counts: what the oracle counts besides, where it is asked for.
  std::vector<Visible> picture(const Oracle& oracle, std::vector<OracleCount>* counts = nullptr) const;
  // Of triangles that no oracle draws, since their fragments may be killed.
  std::size_t vanishing() const { return vanishing_.size(); }
  // frame: of an engine that has drawn the whole scene, with its winners.
  VisibilityReport compare(const Oracle& oracle, std::span<const Visible> picture, const Frame& frame,
                           std::string_view engine) const;
  // Of one pixel.
  PixelFinding at(const Oracle& oracle, std::span<const Visible> picture, const Frame& frame,
                  std::string_view engine, std::int64_t x, std::int64_t y) const;
  // The exact h of what an oracle sees; 0 where it is nothing.
  double depth_of(const Visible& seen) const;
  // h of a distance.
  double depth_at(double s) const;
  // By how many codes its stored depth may be off; 0 for no triangle.
  double bound_of(std::int32_t triangle) const;
  // What the engine shows at a pixel, and where that is exactly. None where the triangle cannot be seen
  // there, or what is stored is beyond its bound; then `why` says so.
  std::optional<Visible> shown(const Frame& frame, std::string_view engine, std::int64_t x, std::int64_t y,
                               std::string& why) const;
  // What `judge` finds of each pixel (x, y), but of those that are left out.
  VisibilityReport report_of(const Oracle& oracle, std::span<const Visible> picture, const Frame& frame,
                             std::string_view engine,
                             const std::function<PixelFinding(std::int64_t, std::int64_t)>& judge) const;
  // Whether a triangle that may be killed may be seen at a pixel.
  bool is_doubtful(std::span<const Visible> picture, std::int64_t x, std::int64_t y) const;
  // The oracle's picture of the triangles that stand for no quadric.
  std::vector<Visible> picture_without_quadrics(const Oracle& oracle) const;
  const Config& config() const { return config_; }
  const Scene& scene() const { return *scene_; }

 private:
  std::vector<bool> doubtful(std::span<const Visible> picture) const;
  PixelFinding judge(const Oracle& oracle, const Visible& seen, const Frame& frame, std::string_view engine,
                     std::int64_t x, std::int64_t y) const;
  double stored_h(std::uint32_t code) const;

  Config config_;
  const Scene* scene_;
  std::vector<double> bounds_;
  std::vector<OracleFace> faces_;      // none of whose fragments can be killed
  std::vector<OracleFace> vanishing_;  // the others
};

}  // namespace bitspan
