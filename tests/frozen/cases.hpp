// SPDX-License-Identifier: Apache-2.0
// The configurations and scenes whose results are frozen.
#pragma once

#include <string>
#include <vector>

#include "config/config.hpp"
#include "scene/scene.hpp"

namespace bitspan::frozen {

// Variants of depth16, each named after what it changes.
std::vector<Config> coverage_variants();         // perspective, numerator, fill rule, edge walk
std::vector<Config> offset_variants();           // start offsets, subpixels
std::vector<Config> slope_variants();            // slope forms
std::vector<Config> edge_reciprocal_variants();  // kinds and shapes of the units
std::vector<Config> row_reciprocal_variants();
std::vector<Config> pixel_reciprocal_variants();
std::vector<Config> depth_variants();           // codes and widths of the depth buffer
std::vector<Config> depth_rounding_variants();  // its rounding and overflow
std::vector<Config> depth_dz_variants();        // float_dz, with depth20 too
std::vector<Config> shading_variants();         // texture and fog
std::vector<Config> plane_variants();           // rows from the triangle's plane
std::vector<Config> mip_variants();             // levels of textures
std::vector<Config> distance_variants();        // zone_d, finite, fog by distance
std::vector<Config> channel_variants();         // fog per vertex
std::vector<Config> cache_variants();           // caches of depth and colour
std::vector<Config> format_variants();          // rounding and overflow of every format
std::vector<Config> timing_variants();          // latencies, intervals, FIFOs and memory: clocks only

// One line of JSON: the name, and the keys that differ from depth16; those that came later (Presence::later)
// from their defaults, so that a new key changes no line.
std::string line_of(const Config& config);
Config config_of(const std::string& line);
// The lines of random_configs.jsonl, one per configuration.
std::vector<std::string> random_config_lines();
// Draws them anew, from the shipped configurations by the seeds 1, 2, ...
void draw_random_configs();

// Spot, seen from the side in fog.
Scene spot_scene(int width, int height);
// Triangles of all extreme scenes but the widest, in one small picture.
Scene small_extreme_scene();
// A random stream that the configuration takes. Where it refuses the first, narrower ranges follow.
Scene random_stream(const Config& config, int number);

}  // namespace bitspan::frozen
