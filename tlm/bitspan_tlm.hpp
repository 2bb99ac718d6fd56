// SPDX-License-Identifier: Apache-2.0
// bitspan as a TLM-2.0 device: a target socket with registers, an initiator socket to memory, an interrupt.
//
// A driver writes a command list into memory, and its address into the registers. The device reads the list
// and the textures, draws, writes colour and depth, and raises the interrupt. docs/tlm.md defines registers,
// list, responses and times. The header needs C++17, SystemC 2.3 and the C library of bitspan; it has no .cpp
// file.
#ifndef BITSPAN_TLM_HPP
#define BITSPAN_TLM_HPP

#include <bitspan/bitspan.h>
#include <bitspan/bitspan_tlm_map.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <stdexcept>
#include <string>
#include <systemc>
#include <tlm>
#include <utility>
#include <vector>

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "bitspan_tlm.hpp needs a little-endian host"
#endif

namespace bitspan_tlm {

enum class Access { read, write, read_write, clear };  // clear: a 1 that is written clears its bit

struct Register {
  const char* name;
  std::uint32_t offset;
  Access access;
  std::uint32_t reset;
};
inline constexpr std::array<Register, BS_TLM_MAP_SIZE / 4> register_map{{
    {"ID", BS_TLM_ID, Access::read, BS_TLM_ID_VALUE},
    {"VERSION", BS_TLM_VERSION, Access::read, BS_TLM_LIST_VERSION},
    {"CTRL", BS_TLM_CTRL, Access::write, 0},
    {"STATUS", BS_TLM_STATUS, Access::read, 0},
    {"IRQ", BS_TLM_IRQ, Access::clear, 0},
    {"IRQ_MASK", BS_TLM_IRQ_MASK, Access::read_write, 0},
    {"ERROR", BS_TLM_ERROR, Access::read, 0},
    {"FRAMES", BS_TLM_FRAMES, Access::read, 0},
    {"CMD_BASE", BS_TLM_CMD_BASE, Access::read_write, 0},
    {"CMD_BASE_HIGH", BS_TLM_CMD_BASE_HIGH, Access::read_write, 0},
    {"CMD_SIZE", BS_TLM_CMD_SIZE, Access::read_write, 0},
    {"FB_STRIDE", BS_TLM_FB_STRIDE, Access::read_write, 0},
    {"FB_BASE", BS_TLM_FB_BASE, Access::read_write, 0},
    {"FB_BASE_HIGH", BS_TLM_FB_BASE_HIGH, Access::read_write, 0},
    {"Z_BASE", BS_TLM_Z_BASE, Access::read_write, 0},
    {"Z_BASE_HIGH", BS_TLM_Z_BASE_HIGH, Access::read_write, 0},
    {"Z_STRIDE", BS_TLM_Z_STRIDE, Access::read_write, 0},
    {"CYCLES", BS_TLM_CYCLES, Access::read, 0},
    {"CYCLES_HIGH", BS_TLM_CYCLES_HIGH, Access::read, 0},
    {"ERROR_ADDRESS", BS_TLM_ERROR_ADDRESS, Access::read, 0},
    {"ERROR_ADDRESS_HIGH", BS_TLM_ERROR_ADDRESS_HIGH, Access::read, 0},
}};

// How the device speaks to memory. Its registers answer in both ways, whatever this is.
enum class Timing {
  loose,       // b_transport
  approximate  // nb_transport, in the four phases of the base protocol
};

struct Settings {
  Timing timing = Timing::loose;
  sc_core::sc_time clock{10, sc_core::SC_NS};
  unsigned register_clocks = 1;  // from a request to its response
  unsigned burst = 4096;         // bytes of the longest transfer to or from memory, at least 256
  const char* engine = "timed";  // of bs_open; the others have no clocks
  bool trace = false;            // keep the records of the last picture, for bs_records and bs_check
};

// A command list that draws `count` triangles as bs_draw does after bs_begin, for a driver to put at
// CMD_BASE. `texels` are the addresses of the scene's textures, whose rows have no gaps.
inline std::vector<std::uint8_t> command_list(const bs_scene_desc& scene, const bs_vertex* vertices,
                                              const std::int32_t* textures, std::size_t count,
                                              const std::vector<std::uint64_t>& texels) {
  std::vector<std::uint8_t> out;
  const auto append = [&out](const auto& command) {
    const auto* const bytes = reinterpret_cast<const std::uint8_t*>(&command);
    out.insert(out.end(), bytes, bytes + sizeof command);
  };
  bs_tlm_begin begin{};
  begin.command = {BS_TLM_BEGIN, sizeof begin};
  begin.version = BS_TLM_LIST_VERSION;
  begin.width = scene.width;
  begin.height = scene.height;
  begin.has_fog = scene.has_fog;
  std::copy_n(scene.background, 3, begin.background);
  std::copy_n(scene.fog_color, 3, begin.fog_color);
  begin.s_min = scene.s_min;
  begin.s_max = scene.s_max;
  begin.focal = scene.focal;
  begin.fog_distance = scene.fog_distance;
  append(begin);
  for (std::size_t i = 0; i < texels.size(); ++i) {
    const bs_texture& t = scene.textures[i];
    append(bs_tlm_texture{{BS_TLM_TEXTURE, sizeof(bs_tlm_texture)}, t.width, t.height, texels[i], 0, 0});
  }
  for (std::size_t i = 0; i < count; ++i) {
    bs_tlm_triangle triangle{{BS_TLM_TRIANGLE, sizeof triangle}, textures[i], 0, {}};
    for (std::size_t k = 0; k < 3; ++k) {
      const bs_vertex& v = vertices[3 * i + k];
      triangle.vertices[k] = {v.x, v.y, v.s, v.u, v.v, v.r, v.g, v.b, v.a};
    }
    append(triangle);
  }
  append(bs_tlm_command{BS_TLM_DRAW, sizeof(bs_tlm_command)});
  append(bs_tlm_command{BS_TLM_END, sizeof(bs_tlm_command)});
  return out;
}

class Device : public sc_core::sc_module,
               private tlm::tlm_fw_transport_if<>,
               private tlm::tlm_bw_transport_if<>,
               private tlm::tlm_mm_interface {
 public:
  tlm::tlm_target_socket<32> registers{"registers"};
  tlm::tlm_initiator_socket<32> memory{"memory"};
  sc_core::sc_out<bool> interrupt{"interrupt"};  // 1 while a bit is set in IRQ and in IRQ_MASK

  SC_HAS_PROCESS(Device);
  // Copies the configuration. Reports SC_ERROR where the configuration or a setting is not legal; nothing
  // behind the constructor reports or throws.
  Device(const sc_core::sc_module_name& name, bs_config* config, const Settings& settings = {})
      : sc_module(name), settings_(settings) {
    if (settings_.burst < 256) SC_REPORT_ERROR("bitspan", "Settings::burst: expected at least 256");
    bs_model* model = nullptr;
    if (bs_open(config, settings_.engine, &model) != BS_OK) SC_REPORT_ERROR("bitspan", bs_last_error());
    model_.reset(model);
    bs_trace(model, settings_.trace ? 1 : 0);
    clear_registers();
    registers.bind(static_cast<tlm::tlm_fw_transport_if<>&>(*this));
    memory.bind(static_cast<tlm::tlm_bw_transport_if<>&>(*this));
    SC_THREAD(run);
    set_stack_size(std::size_t{8} << 20U);  // the library draws on it
    SC_THREAD(serve);
    SC_METHOD(drive_interrupt);
    sensitive << interrupt_changed_;
  }

  // As CTRL.RESET does; for a reset line.
  void reset() {
    ++epoch_;
    clear_registers();
    error_text_.clear();
    reset_.notify(sc_core::SC_ZERO_TIME);
    interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
  }

  // What the error in ERROR was, in one line; "" where there is none.
  const std::string& error_text() const { return error_text_; }
  // The model that draws, for its counters, and with Settings::trace its records. Use it while STATUS.BUSY is
  // 0.
  bs_model* model() const { return model_.get(); }

 private:
  struct Fault {
    std::uint32_t code;
    std::uint64_t address;
    std::string text;
  };
  struct WasReset {};
  struct CloseModel {
    void operator()(bs_model* model) const { bs_close(model); }
  };
  struct Rows {  // a plane's place in memory
    std::uint64_t base, stride;
  };

  // ---- registers ----

  std::uint32_t& value(std::uint32_t offset) { return values_[offset / 4]; }
  // What a register, or a pair of them, had at START.
  std::uint32_t latched(std::uint32_t offset) const { return latched_[offset / 4]; }
  std::uint64_t latched_pair(std::uint32_t offset) const {
    return latched(offset) | std::uint64_t{latched(offset + 4)} << 32U;
  }
  void set_pair(std::uint32_t offset, std::uint64_t to) {
    value(offset) = static_cast<std::uint32_t>(to);
    value(offset + 4) = static_cast<std::uint32_t>(to >> 32U);
  }
  void clear_registers() {
    for (const Register& r : register_map) value(r.offset) = r.reset;
  }

  tlm::tlm_response_status start() {
    if ((value(BS_TLM_STATUS) & BS_TLM_STATUS_BUSY) != 0) return tlm::TLM_COMMAND_ERROR_RESPONSE;
    value(BS_TLM_STATUS) = BS_TLM_STATUS_BUSY;
    value(BS_TLM_ERROR) = BS_TLM_NO_ERROR;
    set_pair(BS_TLM_ERROR_ADDRESS, 0);
    error_text_.clear();
    latched_ = values_;
    started_.notify(sc_core::SC_ZERO_TIME);
    return tlm::TLM_OK_RESPONSE;
  }

  tlm::tlm_response_status write(const Register& r, std::uint32_t to) {
    switch (r.access) {
      case Access::read:
        return tlm::TLM_COMMAND_ERROR_RESPONSE;
      case Access::write:
        if ((to & BS_TLM_CTRL_RESET) != 0) reset();
        return (to & BS_TLM_CTRL_START) != 0 ? start() : tlm::TLM_OK_RESPONSE;
      case Access::read_write:
        value(r.offset) = to;
        break;
      case Access::clear:
        value(r.offset) &= ~to;
        break;
    }
    interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
    return tlm::TLM_OK_RESPONSE;
  }

  // Does what the transaction asks for at once.
  tlm::tlm_response_status access(tlm::tlm_generic_payload& t) {
    if (t.get_command() == tlm::TLM_IGNORE_COMMAND) return tlm::TLM_OK_RESPONSE;
    if (t.get_address() >= BS_TLM_MAP_SIZE || t.get_address() % 4 != 0)
      return tlm::TLM_ADDRESS_ERROR_RESPONSE;
    if (t.get_data_length() != 4 || t.get_streaming_width() < 4) return tlm::TLM_BURST_ERROR_RESPONSE;
    if (t.get_byte_enable_ptr() != nullptr) return tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE;
    if (t.get_data_ptr() == nullptr) return tlm::TLM_GENERIC_ERROR_RESPONSE;
    const Register& r = register_map[static_cast<std::size_t>(t.get_address() / 4)];
    std::uint32_t word = value(r.offset);
    if (t.is_read()) {
      std::memcpy(t.get_data_ptr(), &word, sizeof word);
      return tlm::TLM_OK_RESPONSE;
    }
    std::memcpy(&word, t.get_data_ptr(), sizeof word);
    return write(r, word);
  }
  void respond(tlm::tlm_generic_payload& t) {
    t.set_dmi_allowed(false);
    t.set_response_status(access(t));
  }
  sc_core::sc_time register_time() const { return settings_.clock * settings_.register_clocks; }

  // The driver's time goes first: what it does to registers happens in the order of simulated time.
  void b_transport(tlm::tlm_generic_payload& t, sc_core::sc_time& delay) override {
    if (delay != sc_core::SC_ZERO_TIME) wait(delay);
    respond(t);
    delay = register_time();
  }

  tlm::tlm_sync_enum nb_transport_fw(tlm::tlm_generic_payload& t, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    if (phase == tlm::BEGIN_REQ) {
      // Against the protocol: no memory manager, or a request before the end of the one before it.
      if (!t.has_mm() || request_ != nullptr) {
        t.set_response_status(tlm::TLM_GENERIC_ERROR_RESPONSE);
        return tlm::TLM_COMPLETED;
      }
      t.acquire();
      request_ = &t;
      request_time_ = sc_core::sc_time_stamp() + delay;
      requested_.notify(sc_core::SC_ZERO_TIME);
    } else if (phase == tlm::END_RESP && &t == response_) {
      response_ = nullptr;
      response_ended_.notify(delay);
      return tlm::TLM_COMPLETED;
    }
    return tlm::TLM_ACCEPTED;
  }

  // Takes one request after the other through its phases.
  void serve() {
    for (;;) {
      while (request_ == nullptr) wait(requested_);
      tlm::tlm_generic_payload& t = *request_;
      if (request_time_ > sc_core::sc_time_stamp()) wait(request_time_ - sc_core::sc_time_stamp());
      request_ = nullptr;
      send_back(t, tlm::END_REQ);
      respond(t);
      wait(register_time());
      while (response_ != nullptr) wait(response_ended_);
      response_ = &t;
      if (send_back(t, tlm::BEGIN_RESP)) response_ = nullptr;
      t.release();
    }
  }
  // Returns whether that ended the transaction.
  bool send_back(tlm::tlm_generic_payload& t, tlm::tlm_phase phase) {
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    const tlm::tlm_sync_enum answer = registers->nb_transport_bw(t, phase, delay);
    const bool ended = answer == tlm::TLM_COMPLETED || (answer == tlm::TLM_UPDATED && phase == tlm::END_RESP);
    if (ended && delay != sc_core::SC_ZERO_TIME) wait(delay);
    return ended;
  }

  bool get_direct_mem_ptr(tlm::tlm_generic_payload& /*t*/, tlm::tlm_dmi& dmi) override {
    dmi.allow_none();
    dmi.set_start_address(0);
    dmi.set_end_address(std::numeric_limits<sc_dt::uint64>::max());
    return false;
  }
  // Reads any bytes of the registers, without effect. Writes none.
  unsigned transport_dbg(tlm::tlm_generic_payload& t) override {
    if (!t.is_read() || t.get_data_ptr() == nullptr || t.get_address() >= BS_TLM_MAP_SIZE) return 0;
    const auto at = static_cast<std::size_t>(t.get_address());
    const std::size_t n = std::min<std::size_t>(t.get_data_length(), BS_TLM_MAP_SIZE - at);
    std::memcpy(t.get_data_ptr(), reinterpret_cast<const unsigned char*>(values_.data()) + at, n);
    return static_cast<unsigned>(n);
  }

  void drive_interrupt() { interrupt.write((value(BS_TLM_IRQ) & value(BS_TLM_IRQ_MASK)) != 0); }

  // ---- memory ----

  tlm::tlm_generic_payload* payload() {
    if (free_.empty()) {
      payloads_.push_back(
          std::make_unique<tlm::tlm_generic_payload>(static_cast<tlm::tlm_mm_interface*>(this)));
      return payloads_.back().get();
    }
    tlm::tlm_generic_payload* const t = free_.back();
    free_.pop_back();
    return t;
  }
  void free(tlm::tlm_generic_payload* t) override { free_.push_back(t); }

  void stop_if_reset() const {
    if (epoch_ != run_epoch_) throw WasReset{};
  }
  void wait_until(const sc_core::sc_time& time) {
    while (time > sc_core::sc_time_stamp()) {
      wait(time - sc_core::sc_time_stamp(), reset_);
      stop_if_reset();
    }
  }

  // One transfer. A reset lets it end and goes on then, because the base protocol has no way to take it back.
  void transfer(tlm::tlm_command command, std::uint64_t address, unsigned char* data, std::size_t n) {
    tlm::tlm_generic_payload& t = *payload();
    t.acquire();
    t.set_command(command);
    t.set_address(address);
    t.set_data_ptr(data);
    t.set_data_length(static_cast<unsigned>(n));
    t.set_streaming_width(static_cast<unsigned>(n));
    t.set_byte_enable_ptr(nullptr);
    t.set_dmi_allowed(false);
    t.set_response_status(tlm::TLM_INCOMPLETE_RESPONSE);
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    if (settings_.timing == Timing::loose) {
      memory->b_transport(t, delay);
      if (delay != sc_core::SC_ZERO_TIME) wait(delay);
    } else {
      transfer_in_phases(t);
    }
    const std::string answer = t.is_response_ok() ? "" : t.get_response_string();
    t.release();
    stop_if_reset();
    if (answer.empty()) return;
    const char* const what = command == tlm::TLM_READ_COMMAND ? "a read" : "a write";
    throw Fault{BS_TLM_BUS_ERROR, address, std::string(what) + " of memory was answered with " + answer};
  }
  void transfer_in_phases(tlm::tlm_generic_payload& t) {
    sc_core::sc_time delay = sc_core::SC_ZERO_TIME;
    tlm::tlm_phase phase = tlm::BEGIN_REQ;
    in_flight_ = &t;
    response_begun_ = false;
    const tlm::tlm_sync_enum answer = memory->nb_transport_fw(t, phase, delay);
    if (answer == tlm::TLM_COMPLETED) {
      if (delay != sc_core::SC_ZERO_TIME) wait(delay);
      in_flight_ = nullptr;
      return;
    }
    if (answer == tlm::TLM_UPDATED && phase == tlm::BEGIN_RESP) begin_response(delay);
    while (!response_begun_) wait(response_came_);
    if (response_time_ > sc_core::sc_time_stamp()) wait(response_time_ - sc_core::sc_time_stamp());
    in_flight_ = nullptr;
    phase = tlm::END_RESP;
    delay = sc_core::SC_ZERO_TIME;
    memory->nb_transport_fw(t, phase, delay);
  }
  void begin_response(const sc_core::sc_time& delay) {
    response_begun_ = true;
    response_time_ = sc_core::sc_time_stamp() + delay;
  }
  tlm::tlm_sync_enum nb_transport_bw(tlm::tlm_generic_payload& t, tlm::tlm_phase& phase,
                                     sc_core::sc_time& delay) override {
    if (phase == tlm::BEGIN_RESP && &t == in_flight_) {
      begin_response(delay);
      response_came_.notify(sc_core::SC_ZERO_TIME);
    }
    return tlm::TLM_ACCEPTED;
  }
  void invalidate_direct_mem_ptr(sc_dt::uint64 /*start*/, sc_dt::uint64 /*end*/) override {}

  void transfer_all(tlm::tlm_command command, std::uint64_t address, unsigned char* data, std::size_t n) {
    while (n > 0) {
      const std::size_t part = std::min<std::size_t>(n, settings_.burst);
      transfer(command, address, data, part);
      address += part;
      data += part;
      n -= part;
    }
  }

  // ---- the command list ----

  // A command at a place of the list, as far as the list goes; read from memory a burst at a time.
  template <class Command>
  Command fetch(std::uint64_t at, std::uint64_t size) {
    Command out;
    if (at < window_at_ || at + sizeof out > window_at_ + window_.size()) {
      window_.resize(static_cast<std::size_t>(std::min<std::uint64_t>(settings_.burst, size - at)));
      window_at_ = at;
      transfer(tlm::TLM_READ_COMMAND, latched_pair(BS_TLM_CMD_BASE) + at, window_.data(), window_.size());
    }
    std::memcpy(&out, window_.data() + (at - window_at_), sizeof out);
    return out;
  }

  static std::uint32_t size_of(std::uint32_t opcode) {
    switch (opcode) {
      case BS_TLM_BEGIN:
        return sizeof(bs_tlm_begin);
      case BS_TLM_TEXTURE:
        return sizeof(bs_tlm_texture);
      case BS_TLM_TRIANGLE:
        return sizeof(bs_tlm_triangle);
      case BS_TLM_DRAW:
      case BS_TLM_END:
        return sizeof(bs_tlm_command);
      default:
        return 0;
    }
  }

  void draw_list() {
    const std::uint64_t base = latched_pair(BS_TLM_CMD_BASE);
    const std::uint64_t size = latched(BS_TLM_CMD_SIZE);
    if (base % 8 != 0 || base > std::numeric_limits<std::uint64_t>::max() - size) {
      throw Fault{BS_TLM_BAD_BASE, base,
                  "CMD_BASE is no multiple of 8, or the list goes beyond the last address"};
    }
    window_.clear();
    texels_.clear();
    textures_.clear();
    vertices_.clear();
    texture_of_.clear();
    begin_at_ = none;
    scene_begun_ = false;
    for (std::uint64_t at = 0;;) {
      command_at_ = base + at;
      expect(size - at >= sizeof(bs_tlm_command), BS_TLM_NO_END, "the list is over without end");
      const auto command = fetch<bs_tlm_command>(at, size);
      const std::uint32_t expected = size_of(command.opcode);
      expect(expected != 0, BS_TLM_BAD_OPCODE, "no command has this opcode");
      expect(command.size == expected, BS_TLM_BAD_SIZE, "the size is not that of the command");
      expect(size - at >= expected, BS_TLM_NO_END, "the list is over within a command");
      expect(command.opcode == BS_TLM_BEGIN || begin_at_ != none, BS_TLM_BAD_ORDER, "begin must come first");
      switch (command.opcode) {
        case BS_TLM_BEGIN:
          begin(fetch<bs_tlm_begin>(at, size));
          break;
        case BS_TLM_TEXTURE:
          texture(fetch<bs_tlm_texture>(at, size));
          break;
        case BS_TLM_TRIANGLE:
          triangle(fetch<bs_tlm_triangle>(at, size));
          break;
        case BS_TLM_DRAW:
          draw();
          break;
        default:
          end();
          return;
      }
      at += expected;
    }
  }

  void expect(bool held, std::uint32_t code, const char* text) const {
    if (!held) throw Fault{code, command_at_, text};
  }
  void expect_ok(bs_status status, std::uint64_t command) const {
    if (status == BS_OK) return;
    const std::uint32_t code = status == BS_BAD_INPUT     ? BS_TLM_BAD_VALUE
                               : status == BS_UNSUPPORTED ? BS_TLM_BAD_VALUE
                               : status == BS_NO_MEMORY   ? BS_TLM_NO_MEMORY
                                                          : BS_TLM_INTERNAL;
    throw Fault{code, command, bs_last_error()};
  }

  void begin(const bs_tlm_begin& from) {
    expect(begin_at_ == none, BS_TLM_BAD_ORDER, "a list has one begin");
    expect(from.version == BS_TLM_LIST_VERSION, BS_TLM_BAD_VERSION, "begin has another version");
    expect(from.has_fog <= 1 && from.background[3] == 0 && from.fog_color[3] == 0, BS_TLM_BAD_VALUE,
           "has_fog is not 0 or 1, or a reserved byte is not 0");
    begin_at_ = command_at_;
    desc_ = BS_SCENE_DESC_INIT;
    desc_.width = from.width;
    desc_.height = from.height;
    desc_.s_min = from.s_min;
    desc_.s_max = from.s_max;
    desc_.focal = from.focal;
    desc_.has_fog = static_cast<std::uint8_t>(from.has_fog);
    desc_.fog_distance = from.fog_distance;
    std::copy_n(from.background, 3, desc_.background);
    std::copy_n(from.fog_color, 3, desc_.fog_color);
  }

  void texture(const bs_tlm_texture& from) {
    constexpr std::int32_t limit = 16384;  // texels, as bs_texture has it
    expect(!scene_begun_, BS_TLM_BAD_ORDER, "textures come before triangles");
    const bool is_size = from.width >= 1 && from.width <= limit && from.height >= 1 && from.height <= limit;
    expect(is_size && from.reserved == 0, BS_TLM_BAD_VALUE,
           "width or height is not 1 to 16384, or reserved is not 0");
    const auto row = 4 * static_cast<std::uint64_t>(from.width);
    const std::uint64_t stride = from.stride == 0 ? row : from.stride;
    const std::uint64_t whole = stride * static_cast<std::uint64_t>(from.height);
    expect(stride >= row && from.address <= std::numeric_limits<std::uint64_t>::max() - whole,
           BS_TLM_BAD_VALUE, "stride is below 4 * width, or the texture goes beyond the last address");
    std::vector<std::uint8_t> texels;
    for (std::int32_t y = 0; y < from.height; ++y) {
      texels.resize(texels.size() + row);
      transfer_all(tlm::TLM_READ_COMMAND, from.address + stride * static_cast<std::uint64_t>(y),
                   texels.data() + texels.size() - row, row);
    }
    texels_.push_back(std::move(texels));
    bs_texture texture = BS_TEXTURE_INIT;
    texture.width = from.width;
    texture.height = from.height;
    texture.rgba = texels_.back().data();
    textures_.push_back(texture);
  }

  void triangle(const bs_tlm_triangle& from) {
    expect(from.reserved == 0, BS_TLM_BAD_VALUE, "reserved is not 0");
    begin_scene();
    for (const bs_tlm_vertex& v : from.vertices) {
      bs_vertex& to = vertices_.emplace_back(bs_vertex BS_VERTEX_INIT);
      to.x = v.x;
      to.y = v.y;
      to.s = v.s;
      to.u = v.u;
      to.v = v.v;
      to.r = v.r;
      to.g = v.g;
      to.b = v.b;
      to.a = v.a;
    }
    texture_of_.push_back(from.texture);
  }

  void begin_scene() {
    if (scene_begun_) return;
    desc_.textures = textures_.data();
    desc_.texture_count = textures_.size();
    expect_ok(bs_begin(model_.get(), &desc_), begin_at_);
    color_ = rows_at(BS_TLM_FB_BASE, BS_TLM_FB_STRIDE, "FB_BASE or FB_STRIDE");
    depth_ = rows_at(BS_TLM_Z_BASE, BS_TLM_Z_STRIDE, "Z_BASE or Z_STRIDE");
    scene_begun_ = true;
  }
  Rows rows_at(std::uint32_t base, std::uint32_t stride, const char* name) const {
    const std::uint64_t row = 4 * static_cast<std::uint64_t>(desc_.width);
    const Rows rows{latched_pair(base), latched(stride) == 0 ? row : latched(stride)};
    const std::uint64_t whole = rows.stride * static_cast<std::uint64_t>(desc_.height);
    if (rows.base % 4 != 0 || rows.stride % 4 != 0 || rows.stride < row ||
        rows.base > std::numeric_limits<std::uint64_t>::max() - whole) {
      throw Fault{BS_TLM_BAD_BASE, rows.base,
                  std::string(name) +
                      " is no multiple of 4, or the stride is below 4 * width, or the "
                      "rows go beyond the last address"};
    }
    return rows;
  }

  void draw() {
    begin_scene();
    expect_ok(bs_draw(model_.get(), vertices_.data(), texture_of_.data(), texture_of_.size(),
                      value(BS_TLM_FRAMES), 0),
              command_at_);
    vertices_.clear();
    texture_of_.clear();
  }

  // The clocks of the drawing begin when the list has been read. Row y of `height` is written when (y + 1) /
  // height of them are over, or later where memory is slower.
  void end() {
    expect(vertices_.empty(), BS_TLM_BAD_ORDER, "triangles without a draw behind them");
    begin_scene();
    std::int64_t cycles = 0;
    bs_view color{}, depth{};
    color.size = depth.size = sizeof(bs_view);
    expect_ok(bs_counter(model_.get(), "cycles", &cycles), command_at_);
    expect_ok(bs_frame_view(model_.get(), BS_PLANE_COLOR, &color), command_at_);
    expect_ok(bs_frame_view(model_.get(), BS_PLANE_DEPTH, &depth), command_at_);
    const sc_core::sc_time begun = sc_core::sc_time_stamp();
    for (std::size_t y = 0; y < color.rows; ++y) {
      const auto clocks = static_cast<std::uint64_t>(cycles) * (y + 1) / color.rows;
      wait_until(begun + settings_.clock * static_cast<double>(clocks));
      write_row(color_, color, y);
      write_row(depth_, depth, y);
    }
    set_pair(BS_TLM_CYCLES, static_cast<std::uint64_t>(cycles));
    ++value(BS_TLM_FRAMES);
  }
  void write_row(const Rows& rows, const bs_view& view, std::size_t y) {
    const auto* const row = static_cast<const unsigned char*>(view.base) + y * view.stride;
    transfer_all(tlm::TLM_WRITE_COMMAND, rows.base + rows.stride * y, const_cast<unsigned char*>(row),
                 view.stride);
  }

  // ---- the run ----

  void run() {
    for (;;) {
      while ((value(BS_TLM_STATUS) & BS_TLM_STATUS_BUSY) == 0) wait(started_);
      run_epoch_ = epoch_;
      Fault fault{BS_TLM_NO_ERROR, 0, ""};
      try {
        draw_list();
      } catch (const WasReset&) {
        continue;  // to the START that came behind the reset, or to wait for one
      } catch (Fault& f) {
        fault = std::move(f);
      } catch (const std::bad_alloc&) {
        fault = {BS_TLM_NO_MEMORY, command_at_, "no memory for the scene"};
      } catch (const std::length_error&) {
        fault = {BS_TLM_NO_MEMORY, command_at_, "no memory for the scene"};
      }
      const bool held = fault.code == BS_TLM_NO_ERROR;
      value(BS_TLM_STATUS) = held ? BS_TLM_STATUS_DONE : BS_TLM_STATUS_ERROR;
      value(BS_TLM_IRQ) |= held ? BS_TLM_IRQ_DONE : BS_TLM_IRQ_ERROR;
      value(BS_TLM_ERROR) = fault.code;
      set_pair(BS_TLM_ERROR_ADDRESS, fault.address);
      error_text_ = std::move(fault.text);
      interrupt_changed_.notify(sc_core::SC_ZERO_TIME);
    }
  }

  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();

  Settings settings_;
  std::unique_ptr<bs_model, CloseModel> model_;
  std::array<std::uint32_t, register_map.size()> values_{}, latched_{};
  std::string error_text_;
  sc_core::sc_event started_, reset_, interrupt_changed_;
  std::uint64_t epoch_ = 0, run_epoch_ = 0;  // resets so far, and when the run began

  // The registers in phases: a request whose END_REQ was not sent, a response whose END_RESP has not come.
  tlm::tlm_generic_payload *request_ = nullptr, *response_ = nullptr;
  sc_core::sc_time request_time_;
  sc_core::sc_event requested_, response_ended_;

  // The transfer in phases.
  std::vector<std::unique_ptr<tlm::tlm_generic_payload>> payloads_;
  std::vector<tlm::tlm_generic_payload*> free_;
  tlm::tlm_generic_payload* in_flight_ = nullptr;
  bool response_begun_ = false;
  sc_core::sc_time response_time_;
  sc_core::sc_event response_came_;

  // The list in work.
  std::vector<std::uint8_t> window_;  // bytes of the list from window_at_
  std::uint64_t window_at_ = 0;
  std::uint64_t command_at_ = 0, begin_at_ = none;  // addresses
  bool scene_begun_ = false;                        // bs_begin was called
  bs_scene_desc desc_ = BS_SCENE_DESC_INIT;
  std::vector<std::vector<std::uint8_t>> texels_;
  std::vector<bs_texture> textures_;
  std::vector<bs_vertex> vertices_;
  std::vector<std::int32_t> texture_of_;
  Rows color_{}, depth_{};
};

}  // namespace bitspan_tlm

#endif
