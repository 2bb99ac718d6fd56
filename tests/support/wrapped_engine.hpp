// SPDX-License-Identifier: Apache-2.0
// An engine around another one, for tests that change what it delivers.
#pragma once

#include <memory>
#include <utility>

#include "engine/engine.hpp"

namespace bitspan {

class WrappedEngine : public Engine {
 public:
  explicit WrappedEngine(std::unique_ptr<Engine> inner) : inner_(std::move(inner)) {}
  std::string_view name() const override { return inner_->name(); }
  void begin(const Scene& scene) override { inner_->begin(scene); }
  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    inner_->draw(triangles, first_index, trace);
  }
  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    inner_->execute(command, next_index, trace);
  }
  const Frame& frame() const override { return inner_->frame(); }
  const Counters& counters() const override { return inner_->counters(); }

 private:
  std::unique_ptr<Engine> inner_;
};

}  // namespace bitspan
