// SPDX-License-Identifier: Apache-2.0
// Draws the embedded scene with two engines and compares every record of the stage `span`.
//
//   compare CONFIGURATION.toml
#include <exception>
#include <iostream>
#include <memory>

#include "engine/registry.hpp"
#include "scene/demo.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "compare: expected CONFIGURATION.toml\n";
    return 2;
  }
  try {
    const bitspan::Config config = bitspan::load_config(argv[1]);
    const bitspan::Scene scene = bitspan::demo_scene(160, 120);
    bitspan::Trace traces[2];
    const char* const names[] = {"golden", "model"};
    for (int i = 0; i < 2; ++i) {
      const std::unique_ptr<bitspan::Engine> engine = bitspan::make_engine(names[i], config);
      engine->begin(scene);
      engine->draw(scene.triangles, 0, &traces[i]);
    }
    const bool equal = traces[0].span == traces[1].span && !traces[0].span.empty();
    std::cout << traces[1].span.size() << " records of span: " << (equal ? "equal" : "different") << '\n';
    return equal ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "compare: " << error.what() << '\n';
    return 2;
  }
}
