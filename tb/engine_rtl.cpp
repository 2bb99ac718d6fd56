// SPDX-License-Identifier: Apache-2.0
#include "tb/engine_rtl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <future>
#include <memory>
#include <stdexcept>
#include <vector>

#include "config/lines.hpp"
#include "config/modes.hpp"
#include "engine/emit_pixel_sv.hpp"
#include "model/pipeline.hpp"
#include "model/scene_run.hpp"
#include "tb/row_batch.hpp"
#include "tb/rtl_pixels.hpp"
#include "tb/rtl_stream.hpp"

namespace bitspan {
namespace {

// Builds the library of the pixel stages side by side with that of the span interpolator.
Rtl make_span_interpolator(const Config& config) {
  std::future<void> pixels;
  if (has_pixel_rtl(config)) {
    pixels = std::async(std::launch::async,
                        [design = module_of(pixel_pipe_design(config))] { RtlModule::build(design); });
  }
  Rtl rtl(config);
  if (pixels.valid()) pixels.get();
  return rtl;
}

class RtlEngine final : public Engine {
 public:
  RtlEngine(const Config& config, const RtlOptions& options)
      : config_(config), options_(options), rtl_(make_span_interpolator(config)) {
    if (has_pixel_rtl(config)) chain_of(DepthWhen::early).pixels = std::make_unique<RtlPixels>(config);
  }

  std::string_view name() const override { return "rtl"; }

  void begin(const Scene& scene) override {
    run_.pipeline = model::make_pipeline(config_, scene);
    run_.begin(scene, true);
    runs_ = 0;
    rtl_.reset();
    take_scene();
  }

  void draw(std::span<const Triangle> triangles, std::int64_t first_index, Trace* trace) override {
    run_.need_begun("draw");
    run_.deliver_constants(trace);
    draw_in_batches(run_.pipeline, *run_.scene, triangles, first_index, batch_, run_.counters, trace,
                    [&] { run(trace); });
  }

  void execute(const DrawCommand& command, std::int64_t next_index, Trace* trace) override {
    const std::uint64_t before = run_.scene.version();
    run_.execute(config_, command, next_index, trace);
    if (run_.scene.version() != before) {
      take_scene();
      return;
    }
    if (std::holds_alternative<StateChange>(command.what)) take_state();
  }

  const Frame& frame() const override { return run_.frame; }
  const Counters& counters() const override { return run_.counters; }

 private:
  // The pixel stages, built for an order of tests.
  struct Chain {
    std::unique_ptr<RtlPixels> pixels;  // none before a state asks for them
    bool has_begun = false;             // they have the scene
  };
  Chain& chain_of(DepthWhen when) { return chains_[is_late(when) ? 1 : 0]; }

  // What the pixel stages have of the scene is loaded anew.
  void take_scene() {
    holds_scene_ = has_pixel_rtl(config_) && holds_textures(config_, *run_.scene);
    for (Chain& chain : chains_) chain.has_begun = false;
    take_state();
  }

  // The pixel stages for the draw state in force, if they take it.
  void take_state() {
    pixels_ = nullptr;
    const DrawState& state = run_.pipeline.state;
    if (!holds_scene_ || !pixel_rtl_takes(config_, state)) return;
    Chain& chain = chain_of(state.depth_when);
    if (!chain.pixels) chain.pixels = std::make_unique<RtlPixels>(config_, state.depth_when);
    pixels_ = chain.pixels.get();
    if (chain.has_begun) {
      pixels_->set(state);
    } else {
      pixels_->begin(run_.pipeline, *run_.scene, run_.frame);
      chain.has_begun = true;
    }
  }

  // All rows collected through the RTL, and what comes out to the frame.
  void run(Trace* trace) {
    if (batch_.rows.size() == 0) return;
    const std::int64_t b = run_.pipeline.constants.record.b;
    inputs_.clear();
    const bool has_channels = run_.pipeline.channels.any();
    for (std::size_t i = 0; i < batch_.rows.rows.size(); ++i) {
      if (const model::WalkedLine* line = model::line_of(batch_.rows, i); line != nullptr) {
        inputs_.push_back(rtl_inputs(config_, line->record, b));
        continue;
      }
      const model::RowChannels ends = has_channels ? batch_.rows.row_channels[i] : model::RowChannels{};
      inputs_.push_back(rtl_inputs(config_, batch_.rows.rows[i], b, in_use(ends)));
    }
    for (std::size_t i = 0; i < batch_.rows.plane_rows.size(); ++i) {
      const model::SpanChannels starts = has_channels ? starts_of(i) : model::SpanChannels{};
      inputs_.push_back(rtl_inputs(config_, batch_.rows.plane_rows[i], model::geometry_of(batch_.rows, i)->k,
                                   b, in_use(starts.record)));
    }
    const RtlStalls stalls{options_.stall_seed + runs_++, options_.in_gap, options_.out_stall};
    const RtlRun result = run_rtl(rtl_, inputs_, stalls, false);
    run_.counters.cycles += result.clocks;

    std::size_t pixel = 0;
    LastSpan last;
    for (std::size_t i = 0; i < batch_.rows.size(); ++i) {
      const model::PlaneGeometry* geometry = model::geometry_of(batch_.rows, i);
      const SpanRecord modelled = model::row_to_span(run_.pipeline, batch_.rows, i, run_.counters);
      fragments_.clear();
      model::span_to_fragments(run_.pipeline, modelled, geometry, fragments_, run_.counters);
      channels_.clear();
      modelled_.span_channel.clear();
      modelled_.fragment_channel.clear();
      if (has_channels) {
        model::channels_of_row(run_.pipeline, batch_.rows, i, modelled, fragments_, channels_, run_.counters,
                               &modelled_);
      }
      if (i < result.spans.size()) {
        const SpanRecord span = replaced(modelled, result.spans[i], geometry);
        deliver(trace, span);
        for (SpanChannelRecord r : modelled_.span_channel) {
          take_channel(config_, result.spans[i], r);
          r.x = span.x;
          r.y = span.y;
          deliver(trace, r);
        }
      }
      const std::span pixels = std::span(result.pixels).subspan(pixel, fragments_.size());
      replace(fragments_, modelled, pixels, geometry);
      if (has_channels) replace_channels(pixels);
      pixel += fragments_.size();
      deliver_all(trace, fragments_);
      for (const model::FragmentChannels& c : channels_) {
        model::deliver_channels(trace, run_.pipeline.channels, c);
      }
      // A wrong position is a difference of the record, not a write outside the frame.
      keep_inside();
      shade(batch_.surfaces[i], trace);
      last = {modelled, geometry};
    }
    if (pixels_ != nullptr) pixels_->run(covered_, run_.counters, trace);
    covered_.clear();
    deliver_surplus(result, pixel, last, trace);
    batch_.clear();
  }

  // The channels in use.
  template <class Record>
  std::span<const Record> in_use(const model::PerChannel<Record>& records) const {
    return std::span(records).first(run_.pipeline.channels.in_use.size());
  }
  // What a row of const_depth_rows brings of them; the counters are those of the row's own turn.
  model::SpanChannels starts_of(std::size_t row) {
    Counters apart;
    const SpanRecord span = model::row_to_span(run_.pipeline, batch_.rows, row, apart);
    return model::span_channels(run_.pipeline.channels,
                                model::triangle_channels_of(batch_.rows, span.triangle), span, nullptr,
                                nullptr, model::geometry_of(batch_.rows, row));
  }

  void keep_inside() {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < fragments_.size(); ++i) {
      const FragmentRecord& f = fragments_[i];
      if (f.x < 0 || f.x >= run_.frame.width || f.y < 0 || f.y >= run_.frame.height) continue;
      fragments_[kept] = f;
      if (!channels_.empty()) channels_[kept] = channels_[i];
      ++kept;
    }
    fragments_.resize(kept);
  }

  // The fragments of a row from depth to the frame: on the RTL's way, or by the model where it has none.
  void shade(const model::Surface& surface, Trace* trace) {
    const GradientRecord* gradient =
        fragments_.empty() ? nullptr : model::gradient_of(batch_.rows, fragments_.front().triangle);
    if (pixels_ != nullptr) {
      for (std::size_t i = 0; i < fragments_.size(); ++i) {
        const FragmentRecord& f = fragments_[i];
        if (f.covered == 0) continue;
        if (model::is_drawn(run_.pipeline, f)) {
          const std::int64_t factor =
              has_vertex_fog(run_.pipeline.fog.mode) ? model::channel_value(channels_[i], LineId::fog) : 0;
          FragmentRecord own;
          const FragmentRecord& drawn =
              model::as_drawn(run_.pipeline.channels, f, channels_.empty() ? nullptr : &channels_[i], own);
          covered_.push_back({drawn, std::max(surface.texture, -1), surface.back, gradient, factor, drawn.h});
          covered_.back().record.h = f.h;
        } else {
          ++run_.counters.masked;
        }
      }
      return;
    }
    model::fragments_to_frame(run_.pipeline, *run_.scene, fragments_, surface, gradient, run_.frame,
                              run_.counters, trace, model::NoObserve{}, channels_);
  }

  struct LastSpan {
    SpanRecord modelled;
    const model::PlaneGeometry* geometry = nullptr;
  };

  // Spans and pixels that the RTL delivered beyond those of the rows become records that no other engine has,
  // named by the last row's triangle. Throws std::logic_error where no trace can show them.
  void deliver_surplus(const RtlRun& result, std::size_t pixels, const LastSpan& last, Trace* trace) const {
    if (result.spans.size() == batch_.rows.size() && result.pixels.size() == pixels) return;
    if (trace == nullptr) {
      throw std::logic_error(fmt::format("the RTL delivered {} spans and {} pixels, expected {} and {}",
                                         result.spans.size(), result.pixels.size(), batch_.rows.size(),
                                         pixels));
    }
    for (std::size_t i = batch_.rows.size(); i < result.spans.size(); ++i) {
      trace->span.push_back(replaced(last.modelled, result.spans[i], last.geometry));
    }
    for (std::size_t i = pixels; i < result.pixels.size(); ++i) {
      FragmentRecord r = fragment_record(config_, result.pixels[i]);
      r.triangle = last.modelled.triangle;
      r.y = last.modelled.y;
      trace->fragment.push_back(r);
    }
  }

  // The RTL's span record with what it does not have.
  SpanRecord replaced(const SpanRecord& modelled, const RtlSpan& span,
                      const model::PlaneGeometry* geometry) const {
    SpanRecord r = span_record(config_, span);
    r.triangle = modelled.triangle;
    r.y = modelled.y;
    if (geometry != nullptr && geometry->along_y) {
      r.y = r.x;
      r.x = modelled.x;
    }
    if (config_.rtl.shades) return r;
    r.r = modelled.r;
    r.g = modelled.g;
    r.b = modelled.b;
    r.a = modelled.a;
    r.r_step0 = modelled.r_step0;
    r.r_step1 = modelled.r_step1;
    r.g_step0 = modelled.g_step0;
    r.g_step1 = modelled.g_step1;
    r.b_step0 = modelled.b_step0;
    r.b_step1 = modelled.b_step1;
    r.a_step0 = modelled.a_step0;
    r.a_step1 = modelled.a_step1;
    return r;
  }

  void replace(std::vector<FragmentRecord>& fragments, const SpanRecord& first,
               std::span<const RtlPixel> pixels, const model::PlaneGeometry* geometry) const {
    const bool along_y = geometry != nullptr && geometry->along_y;
    const std::int64_t side = geometry != nullptr && geometry->k < 0 ? -1 : 1;
    std::int64_t minor = along_y ? first.x : first.y;
    for (std::size_t i = 0; i < fragments.size(); ++i) {
      FragmentRecord& f = fragments[i];
      FragmentRecord r = fragment_record(config_, pixels[i]);
      r.triangle = f.triangle;
      r.covered = f.covered;
      if (!config_.rtl.shades) {
        r.r = f.r;
        r.g = f.g;
        r.b = f.b;
        r.a = f.a;
      }
      r.y = minor;
      if (along_y) std::swap(r.x, r.y);
      if (pixels[i].step != 0) minor += side;
      f = r;
    }
  }

  // After `replace`.
  void replace_channels(std::span<const RtlPixel> pixels) {
    for (std::size_t i = 0; i < fragments_.size(); ++i) {
      for (std::size_t c = 0; c < run_.pipeline.channels.in_use.size(); ++c) {
        FragmentChannelRecord& r = channels_[i][c];
        take_channel(config_, pixels[i], r);
        r.x = fragments_[i].x;
        r.y = fragments_[i].y;
      }
    }
  }

  Config config_;
  RtlOptions options_;
  Rtl rtl_;
  std::array<Chain, 2> chains_;  // early, late
  bool holds_scene_ = false;  // the configuration has pixel stages in RTL, and they hold the scene's textures
  RtlPixels* pixels_ = nullptr;  // those for the draw state in force; null where the model draws
  model::SceneRun run_;
  std::uint64_t runs_ = 0;  // since begin: each has its own stalls
  // Reused from run to run.
  RowBatch batch_;
  std::vector<RtlInputs> inputs_;
  std::vector<FragmentRecord> fragments_;
  std::vector<model::FragmentChannels> channels_;  // of these, where channels are in use
  Trace modelled_;                                 // the model's records of a row's channels
  std::vector<RtlPixels::Fragment> covered_;       // on their way to the pixel stages
};

}  // namespace

bool rtl_draws_pixels(const Config& config, const Scene& scene) {
  return has_pixel_rtl(config) && holds_textures(config, scene) && pixel_rtl_takes(config, scene.commands);
}

EngineOwn rtl_own(const Config& config, const Scene& scene) {
  EngineOwn own;
  const auto fields_of_type = [&](RecordType type) -> std::uint64_t& {
    return own.fields[static_cast<std::size_t>(type)];
  };
#define BITSPAN_COUNT_PORT(name) +1
  fields_of_type(RecordType::span) = 0 BITSPAN_RTL_SPAN(BITSPAN_COUNT_PORT);
  fields_of_type(RecordType::fragment) = 0 BITSPAN_RTL_PIXEL(BITSPAN_COUNT_PORT);
  // Each of these ports has four fields.
  const auto shades = [&](std::uint64_t ports) { return config.rtl.shades ? 4 * ports : 0; };
  fields_of_type(RecordType::span) += shades(0 BITSPAN_RTL_SPAN_SHADES(BITSPAN_COUNT_PORT));
  fields_of_type(RecordType::fragment) += shades(0 BITSPAN_RTL_PIXEL_SHADES(BITSPAN_COUNT_PORT));
#undef BITSPAN_COUNT_PORT
  // Elsewhere step_o is always 0, and a fragment's y is its row's.
  if (!has_digital_line(config)) --fields_of_type(RecordType::fragment);
  if (ChannelList(config).size() > 0) {
    // x, w and its two steps; of a pixel x and w, and y where it is not its row's.
    fields_of_type(RecordType::span_channel) = 4;
    fields_of_type(RecordType::fragment_channel) = has_plane_rows(config.perspective) ? 3 : 2;
  }
  if (!rtl_draws_pixels(config, scene)) return own;
  for (const RecordType type :
       {RecordType::depth, RecordType::stencil, RecordType::texture, RecordType::fog, RecordType::merge}) {
    fields_of_type(type) = fields_of(type).size() - 1;  // all but the triangle
  }
  if (has_lod(config)) fields_of_type(RecordType::lod) = fields_of(RecordType::lod).size() - 1;
  // i and j, although the RTL finds those of the other textures.
  const std::vector<DrawState> states = all_states_of(config, scene.commands);
  const bool finds_all = std::ranges::all_of(states, [&](const DrawState& state) {
    return std::ranges::all_of(scene.textures, [&](const Texture& texture) {
      return addresses_texels(first_lookup(state), texture);
    });
  });
  if (!finds_all) fields_of_type(RecordType::texture) -= 2;
  const bool has_stencil = std::ranges::any_of(states, &DrawState::stencil_test);
  // depth, u, v and three channels of colour, not the triangle; stencil; alpha where merge writes it
  own.picture = has_stencil ? 7 : 6;
  if (has_blend_equation(config.rtl.blend)) {
    fields_of_type(RecordType::merge_alpha) = fields_of(RecordType::merge_alpha).size() - 1;
    ++own.picture;
  }
  // depth_passed, killed, written, stencil_failed
  own.counters = has_stencil ? 4 : 3;
  return own;
}

std::unique_ptr<Engine> make_rtl(const Config& config, const RtlOptions& options) {
  return std::make_unique<RtlEngine>(config, options);
}

}  // namespace bitspan
