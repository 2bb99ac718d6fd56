// SPDX-License-Identifier: Apache-2.0
// A bench around the TLM-2.0 device: memory and a host that know every way of the protocol, and check its
// rules.
#pragma once

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <bitspan/bitspan_tlm.hpp>
#include <cstdio>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace bitspan_tlm {

using Bytes = std::vector<std::uint8_t>;
using sc_core::sc_time;
using sc_core::sc_time_stamp;

inline sc_time ns(double t) { return {t, sc_core::SC_NS}; }

// ---- scenes ----

struct CloseHandle {
  void operator()(bs_config* c) const { bs_config_free(c); }
  void operator()(bs_scene* s) const { bs_scene_free(s); }
  void operator()(bs_model* m) const { bs_close(m); }
};
template <class T>
using Handle = std::unique_ptr<T, CloseHandle>;

inline void ok(bs_status status) { ASSERT_EQ(status, BS_OK) << bs_last_error(); }

inline Handle<bs_config> configuration(const char* name, const char* mode = nullptr) {
  bs_config* config = nullptr;
  ok(bs_config_load(name, &config));
  if (mode != nullptr) ok(bs_config_set(config, "perspective.mode", mode));
  return Handle<bs_config>(config);
}

// A scene of the library with its arrays.
struct LoadedScene {
  Handle<bs_scene> handle;
  bs_scene_desc desc = BS_SCENE_DESC_INIT;
  const bs_vertex* vertices = nullptr;
  const std::int32_t* textures = nullptr;
  std::size_t count = 0;

  LoadedScene(const char* name, int width, int height) {
    bs_scene* scene = nullptr;
    ok(bs_scene_load(name, width, height, &scene));
    handle.reset(scene);
    ok(bs_scene_get(scene, &desc));
    ok(bs_scene_triangles(scene, &vertices, &textures, &count));
  }
};

// What an engine makes of it.
struct Picture {
  Bytes color, depth;
  std::int64_t cycles = 0;
};
inline Bytes plane(bs_model* model, bs_plane which) {
  bs_view view{};
  view.size = sizeof view;
  ok(bs_frame_view(model, which, &view));
  const auto* const base = static_cast<const std::uint8_t*>(view.base);
  return {base, base + view.rows * view.stride};
}
inline Picture draw(const char* engine, bs_config* config, const LoadedScene& scene) {
  bs_model* model = nullptr;
  ok(bs_open(config, engine, &model));
  const Handle<bs_model> owner(model);
  ok(bs_begin(model, &scene.desc));
  ok(bs_draw(model, scene.vertices, scene.textures, scene.count, 0, 0));
  Picture out{plane(model, BS_PLANE_COLOR), plane(model, BS_PLANE_DEPTH), 0};
  ok(bs_counter(model, "cycles", &out.cycles));
  return out;
}

// ---- memory ----

constexpr std::uint64_t list_at = 0x10000, texels_at = 0x100000, color_at = 0x400000, depth_at = 0x600000;
constexpr std::size_t memory_size = 0x800000;

// How it answers in phases.
enum class Style { completed, updated, request_only, four_phases };

struct Memory : sc_core::sc_module, private tlm::tlm_fw_transport_if<> {
  tlm::tlm_target_socket<32> socket{"socket"};
  Bytes bytes = Bytes(memory_size);
  sc_time latency = sc_core::SC_ZERO_TIME;
  Style style = Style::four_phases;
  std::uint64_t transfers = 0, longest = 0;
  std::optional<std::uint64_t> fail_at;  // this transfer is answered with `failure`
  tlm::tlm_response_status failure = tlm::TLM_GENERIC_ERROR_RESPONSE;
  std::map<std::uint64_t, sc_time> written;  // the start of each write

  SC_HAS_PROCESS(Memory);
  explicit Memory(const sc_core::sc_module_name& name) : sc_module(name) {
    socket.bind(static_cast<tlm::tlm_fw_transport_if<>&>(*this));
    SC_THREAD(answer);
  }

 private:
  void access(tlm::tlm_generic_payload& t) {
    const std::uint64_t at = t.get_address();
    const std::size_t n = t.get_data_length();
    EXPECT_EQ(t.get_streaming_width(), n);
    EXPECT_EQ(t.get_byte_enable_ptr(), nullptr);
    EXPECT_EQ(t.get_response_status(), tlm::TLM_INCOMPLETE_RESPONSE);
    EXPECT_GT(n, 0U);
    longest = std::max<std::uint64_t>(longest, n);
    if (transfers++ == fail_at) return t.set_response_status(failure);
    if (at > bytes.size() || n > bytes.size() - at)
      return t.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
    if (t.is_read()) std::memcpy(t.get_data_ptr(), bytes.data() + at, n);
    if (t.is_write()) {
      std::memcpy(bytes.data() + at, t.get_data_ptr(), n);
      written[at] = sc_time_stamp();
    }
    t.set_response_status(tlm::TLM_OK_RESPONSE);
  }
  void b_transport(tlm::tlm_generic_payload& t, sc_time& delay) override {
    access(t);
    delay += latency;
  }
  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& t, tlm::tlm_phase& phase,
                                     sc_time& delay) override {
    if (phase == tlm::END_RESP) {
      EXPECT_EQ(&t, responding_) << "END_RESP without BEGIN_RESP";
      responding_ = nullptr;
      return tlm::TLM_COMPLETED;
    }
    EXPECT_EQ(phase, tlm::BEGIN_REQ);
    EXPECT_TRUE(t.has_mm());
    EXPECT_EQ(current_, nullptr) << "BEGIN_REQ before the end of the one before it";
    EXPECT_EQ(responding_, nullptr);
    if (style == Style::completed || style == Style::updated) {
      access(t);
      delay += latency;
      if (style == Style::completed) return tlm::TLM_COMPLETED;
      phase = tlm::BEGIN_RESP;
      responding_ = &t;
      return tlm::TLM_UPDATED;
    }
    t.acquire();
    current_ = &t;
    begun_.notify(sc_core::SC_ZERO_TIME);
    if (style == Style::request_only) {
      phase = tlm::END_REQ;
      return tlm::TLM_UPDATED;
    }
    return tlm::TLM_ACCEPTED;
  }
  void answer() {
    for (;;) {
      while (current_ == nullptr) wait(begun_);
      tlm::tlm_generic_payload& t = *current_;
      sc_time none = sc_core::SC_ZERO_TIME;
      tlm::tlm_phase phase = tlm::END_REQ;
      if (style == Style::four_phases) {
        EXPECT_EQ(socket->nb_transport_bw(t, phase, none), tlm::TLM_ACCEPTED);
      }
      access(t);
      current_ = nullptr;
      responding_ = &t;
      phase = tlm::BEGIN_RESP;
      sc_time delay = latency;
      EXPECT_EQ(socket->nb_transport_bw(t, phase, delay), tlm::TLM_ACCEPTED);
      t.release();
    }
  }
  bool get_direct_mem_ptr(tlm::tlm_generic_payload& /*t*/, tlm::tlm_dmi& /*dmi*/) override { return false; }
  unsigned transport_dbg(tlm::tlm_generic_payload& /*t*/) override { return 0; }

  tlm::tlm_generic_payload *current_ = nullptr, *responding_ = nullptr;
  sc_core::sc_event begun_;
};

// ---- the host ----

struct AccessRequest {
  tlm::tlm_command command = tlm::TLM_READ_COMMAND;
  std::uint64_t address = 0;
  unsigned length = 4, streaming = 4;
  bool byte_enables = false;
  bool has_data = true;
};

struct Host : sc_core::sc_module, private tlm::tlm_bw_transport_if<>, private tlm::tlm_mm_interface {
  tlm::tlm_initiator_socket<32> socket{"socket"};
  sc_core::sc_in<bool> interrupt{"interrupt"};
  Timing timing = Timing::loose;
  std::function<void()> body;
  bool has_ended = false;
  bool ends_response_at_once = true;  // END_RESP in the answer to BEGIN_RESP; else later

  SC_HAS_PROCESS(Host);
  explicit Host(const sc_core::sc_module_name& name) : sc_module(name) {
    socket.bind(static_cast<tlm::tlm_bw_transport_if<>&>(*this));
    SC_THREAD(run);
    set_stack_size(std::size_t{8} << 20U);
  }

  tlm::tlm_response_status transport(tlm::tlm_generic_payload& t) {
    t.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    sc_time delay = sc_core::SC_ZERO_TIME;
    if (timing == Timing::loose) {
      socket->b_transport(t, delay);
      wait(delay);
      return t.get_response_status();
    }
    t.set_mm(this);
    t.acquire();
    tlm::tlm_phase phase = tlm::BEGIN_REQ;
    phases_.clear();
    if (socket->nb_transport_fw(t, phase, delay) == tlm::TLM_ACCEPTED) {
      while (phases_.empty() || phases_.back() != tlm::BEGIN_RESP) wait(came_);
      const std::vector<tlm::tlm_phase> expected{tlm::END_REQ, tlm::BEGIN_RESP};
      EXPECT_EQ(phases_, expected);
      if (!ends_response_at_once) {
        wait(ns(3));
        phase = tlm::END_RESP;
        EXPECT_EQ(socket->nb_transport_fw(t, phase, delay), tlm::TLM_COMPLETED);
      }
    }
    const tlm::tlm_response_status status = t.get_response_status();
    t.release();
    return status;
  }
  tlm::tlm_response_status access(const AccessRequest& a, std::uint32_t* word) {
    std::array<unsigned char, 16> data{};
    std::array<unsigned char, 16> enables{};
    enables.fill(TLM_BYTE_ENABLED);
    std::memcpy(data.data(), word, 4);
    tlm::tlm_generic_payload& t = payload_;
    t.reset();
    t.set_command(a.command);
    t.set_address(a.address);
    t.set_data_ptr(a.has_data ? data.data() : nullptr);
    t.set_data_length(a.length);
    t.set_streaming_width(a.streaming);
    t.set_byte_enable_ptr(a.byte_enables ? enables.data() : nullptr);
    t.set_byte_enable_length(a.byte_enables ? 4 : 0);
    t.set_dmi_allowed(true);
    const auto status = transport(t);
    EXPECT_FALSE(t.is_dmi_allowed());
    std::memcpy(word, data.data(), 4);
    return status;
  }
  tlm::tlm_response_status try_set(std::uint32_t offset, std::uint32_t word) {
    return access({tlm::TLM_WRITE_COMMAND, offset}, &word);
  }
  void set(std::uint32_t offset, std::uint32_t word) {
    EXPECT_EQ(try_set(offset, word), tlm::TLM_OK_RESPONSE) << "offset " << offset;
  }
  std::uint32_t get(std::uint32_t offset) {
    std::uint32_t word = 0xdeadbeef;
    EXPECT_EQ(access({tlm::TLM_READ_COMMAND, offset}, &word), tlm::TLM_OK_RESPONSE);
    return word;
  }
  std::uint64_t get_pair(std::uint32_t offset) { return get(offset) | std::uint64_t{get(offset + 4)} << 32U; }
  // Registers a frame needs, and START.
  void start(std::size_t list_size) {
    set(BS_TLM_CMD_BASE, list_at);
    set(BS_TLM_CMD_SIZE, static_cast<std::uint32_t>(list_size));
    set(BS_TLM_FB_BASE, color_at);
    set(BS_TLM_Z_BASE, depth_at);
    set(BS_TLM_IRQ_MASK, BS_TLM_IRQ_DONE | BS_TLM_IRQ_ERROR);
    set(BS_TLM_CTRL, BS_TLM_CTRL_START);
  }
  // Waits for the interrupt, takes it away, and returns STATUS.
  std::uint32_t finish() {
    if (!interrupt.read()) wait(interrupt.posedge_event());
    const std::uint32_t status = get(BS_TLM_STATUS);
    const std::uint32_t pending = get(BS_TLM_IRQ);
    EXPECT_EQ(pending, status == BS_TLM_STATUS_DONE ? BS_TLM_IRQ_DONE : BS_TLM_IRQ_ERROR);
    set(BS_TLM_IRQ, pending);
    wait(ns(1));
    EXPECT_FALSE(interrupt.read());
    return status;
  }

 private:
  void run() {
    if (!body) return;
    body();
    has_ended = true;
    sc_core::sc_stop();
  }
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& /*t*/, tlm::tlm_phase& phase,
                                     sc_time& /*delay*/) override {
    phases_.push_back(phase);
    came_.notify(sc_core::SC_ZERO_TIME);
    if (phase != tlm::BEGIN_RESP || !ends_response_at_once) return tlm::TLM_ACCEPTED;
    phase = tlm::END_RESP;
    return tlm::TLM_UPDATED;
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64 /*start*/, sc_dt::uint64 /*end*/) override {}
  void free(tlm::tlm_generic_payload* /*t*/) override {}

  tlm::tlm_generic_payload payload_;
  std::vector<tlm::tlm_phase> phases_;
  sc_core::sc_event came_;
};

struct Bench : sc_core::sc_module {
  Device device;
  Memory memory{"memory"};
  Host host{"host"};
  sc_core::sc_signal<bool> interrupt{"interrupt"};

  Bench(const sc_core::sc_module_name& name, bs_config* config, const Settings& settings)
      : sc_module(name), device("device", config, settings) {
    host.timing = settings.timing;
    host.socket.bind(device.registers);
    device.memory.bind(memory.socket);
    device.interrupt(interrupt);
    host.interrupt(interrupt);
  }
  explicit Bench(bs_config* config, const Settings& settings = {}) : Bench("bench", config, settings) {}
  // Puts a scene's list and textures into memory, and returns the size of the list.
  std::size_t load(const LoadedScene& scene) {
    std::vector<std::uint64_t> texels;
    std::uint64_t next = texels_at;
    for (std::size_t i = 0; i < scene.desc.texture_count; ++i) {
      const bs_texture& t = scene.desc.textures[i];
      const std::size_t n = 4 * static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height);
      std::copy_n(t.rgba, n, memory.bytes.data() + next);
      texels.push_back(next);
      next += n;
    }
    return put(command_list(scene.desc, scene.vertices, scene.textures, scene.count, texels));
  }
  std::size_t put(const Bytes& list) {
    std::copy(list.begin(), list.end(), memory.bytes.begin() + list_at);
    return list.size();
  }
  Bytes at(std::uint64_t address, std::size_t n) const {
    const auto begin = memory.bytes.begin() + static_cast<std::ptrdiff_t>(address);
    return {begin, begin + static_cast<std::ptrdiff_t>(n)};
  }
  // Memory has the picture, and nothing else around it.
  void expect(const Picture& picture) const {
    EXPECT_TRUE(at(color_at, picture.color.size()) == picture.color) << "colour";
    EXPECT_TRUE(at(depth_at, picture.depth.size()) == picture.depth) << "depth";
    for (const std::uint64_t end : {color_at + picture.color.size(), depth_at + picture.depth.size()}) {
      EXPECT_EQ(at(end, 64), Bytes(64));
    }
  }
  void clear_pictures() { std::fill(memory.bytes.begin() + color_at, memory.bytes.end(), std::uint8_t{0}); }
  // Runs the host's body to its end.
  void run(std::function<void()> body) {
    host.body = std::move(body);
    sc_core::sc_start();
    EXPECT_TRUE(host.has_ended) << "nothing moves any more";
  }
};

// SystemC's kernel runs once per process, so each scenario has a process of its own.
inline void in_own_process(const std::function<void()>& scenario) {
  std::fflush(nullptr);
  const pid_t child = fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    int code = 1;
    try {
      scenario();
      code = testing::Test::HasFailure() ? 1 : 0;
    } catch (const std::exception& e) {
      std::printf("an exception left the scenario: %s\n", e.what());
    }
    std::fflush(nullptr);
    _exit(code);
  }
  int status = 0;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0) << "the scenario failed, or crashed";
}

}  // namespace bitspan_tlm
