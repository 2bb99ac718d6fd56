// SPDX-License-Identifier: Apache-2.0
// A virtual platform: a processor, a bus, memory, and bitspan, which draws the demo through the bus.
//
//   platform PICTURE.ppm [--approximate] [--size WxH] [--config NAME]
#include <tlm_utils/simple_initiator_socket.h>
#include <tlm_utils/simple_target_socket.h>

#include <bitspan/bitspan_tlm.hpp>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string>

using sc_core::sc_time;

// The platform's addresses.
constexpr std::uint64_t device_at = 0x40000000;
constexpr std::uint64_t list_at = 0x00100000, texels_at = 0x00800000, color_at = 0x01000000,
                        depth_at = 0x02000000;
constexpr std::size_t memory_size = 0x04000000;

struct Memory : sc_core::sc_module {
  tlm_utils::simple_target_socket<Memory> socket{"socket"};
  std::vector<unsigned char> bytes = std::vector<unsigned char>(memory_size);

  explicit Memory(const sc_core::sc_module_name& name) : sc_module(name) {
    socket.register_b_transport(this, &Memory::transport);
  }
  void transport(tlm::tlm_generic_payload& t, sc_time& delay) {
    const std::uint64_t at = t.get_address();
    const std::size_t n = t.get_data_length();
    if (at > bytes.size() || n > bytes.size() - at) {
      t.set_response_status(tlm::TLM_ADDRESS_ERROR_RESPONSE);
      return;
    }
    if (t.is_read()) std::memcpy(t.get_data_ptr(), bytes.data() + at, n);
    if (t.is_write()) std::memcpy(bytes.data() + at, t.get_data_ptr(), n);
    delay += sc_time(10.0 + static_cast<double>(n) / 8, sc_core::SC_NS);  // 8 bytes per nanosecond
    t.set_response_status(tlm::TLM_OK_RESPONSE);
  }
};

// Two masters, and two slaves by address. A master in phases comes through the socket's own adapter.
struct Bus : sc_core::sc_module {
  tlm_utils::simple_target_socket_tagged<Bus> processor{"processor"}, master{"master"};
  tlm_utils::simple_initiator_socket<Bus> to_memory{"to_memory"}, to_device{"to_device"};

  explicit Bus(const sc_core::sc_module_name& name) : sc_module(name) {
    processor.register_b_transport(this, &Bus::transport, 0);
    master.register_b_transport(this, &Bus::transport, 1);
  }
  void transport(int /*master*/, tlm::tlm_generic_payload& t, sc_time& delay) {
    delay += sc_time(5, sc_core::SC_NS);
    const std::uint64_t at = t.get_address();
    if (at < device_at) {
      to_memory->b_transport(t, delay);
      return;
    }
    t.set_address(at - device_at);
    to_device->b_transport(t, delay);
    t.set_address(at);
  }
};

// What the driver of an operating system would do.
struct Processor : sc_core::sc_module {
  tlm_utils::simple_initiator_socket<Processor> socket{"socket"};
  sc_core::sc_in<bool> interrupt{"interrupt"};
  bs_scene* scene;
  std::uint64_t cycles = 0;
  bool has_drawn = false;

  SC_HAS_PROCESS(Processor);
  Processor(const sc_core::sc_module_name& name, bs_scene* drawn) : sc_module(name), scene(drawn) {
    SC_THREAD(run);
  }

  void access(tlm::tlm_command command, std::uint64_t address, void* data, std::size_t n) {
    tlm::tlm_generic_payload t;
    sc_time delay = sc_core::SC_ZERO_TIME;
    t.set_command(command);
    t.set_address(address);
    t.set_data_ptr(static_cast<unsigned char*>(data));
    t.set_data_length(static_cast<unsigned>(n));
    t.set_streaming_width(static_cast<unsigned>(n));
    socket->b_transport(t, delay);
    wait(delay);
    if (!t.is_response_ok()) SC_REPORT_ERROR("processor", t.get_response_string().c_str());
  }
  void store(std::uint64_t address, const void* data, std::size_t n) {
    access(tlm::TLM_WRITE_COMMAND, address, const_cast<void*>(data), n);
  }
  void set(std::uint32_t offset, std::uint32_t word) { store(device_at + offset, &word, 4); }
  std::uint32_t get(std::uint32_t offset) {
    std::uint32_t word = 0;
    access(tlm::TLM_READ_COMMAND, device_at + offset, &word, 4);
    return word;
  }

  void run() {
    bs_scene_desc desc = BS_SCENE_DESC_INIT;
    const bs_vertex* vertices = nullptr;
    const std::int32_t* textures = nullptr;
    std::size_t count = 0;
    bs_scene_get(scene, &desc);
    bs_scene_triangles(scene, &vertices, &textures, &count);

    std::vector<std::uint64_t> texels;
    std::uint64_t next = texels_at;
    for (std::size_t i = 0; i < desc.texture_count; ++i) {
      const bs_texture& t = desc.textures[i];
      const std::size_t n = 4 * static_cast<std::size_t>(t.width) * static_cast<std::size_t>(t.height);
      store(next, t.rgba, n);
      texels.push_back(next);
      next += n;
    }
    const auto list = bitspan_tlm::command_list(desc, vertices, textures, count, texels);
    store(list_at, list.data(), list.size());

    set(BS_TLM_CMD_BASE, list_at);
    set(BS_TLM_CMD_SIZE, static_cast<std::uint32_t>(list.size()));
    set(BS_TLM_FB_BASE, color_at);
    set(BS_TLM_Z_BASE, depth_at);
    set(BS_TLM_IRQ_MASK, BS_TLM_IRQ_DONE | BS_TLM_IRQ_ERROR);
    set(BS_TLM_CTRL, BS_TLM_CTRL_START);
    wait(interrupt.posedge_event());
    has_drawn = (get(BS_TLM_STATUS) & BS_TLM_STATUS_DONE) != 0;
    cycles = get(BS_TLM_CYCLES) | std::uint64_t{get(BS_TLM_CYCLES_HIGH)} << 32U;
    set(BS_TLM_IRQ, BS_TLM_IRQ_DONE | BS_TLM_IRQ_ERROR);
  }
};

static bs_status fail() {
  std::cerr << bs_last_error() << "\n";
  return 1;
}

int sc_main(int argc, char** argv) {
  std::string picture, config_name = "depth16";
  int width = 640, height = 480;
  bitspan_tlm::Settings settings;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word == "--approximate") {
      settings.timing = bitspan_tlm::Timing::approximate;
    } else if (word == "--config" && i + 1 < argc) {
      config_name = argv[++i];
    } else if (word == "--size" && i + 1 < argc && std::sscanf(argv[++i], "%dx%d", &width, &height) == 2) {
    } else if (picture.empty() && word[0] != '-') {
      picture = word;
    } else {
      picture.clear();
      break;
    }
  }
  if (picture.empty()) {
    std::cerr << "usage: platform PICTURE.ppm [--approximate] [--size WxH] [--config NAME]\n";
    return 2;
  }
  bs_config* config = nullptr;
  bs_scene* scene = nullptr;
  if (bs_config_load(config_name.c_str(), &config) != BS_OK) return fail();
  if (bs_scene_load("demo", width, height, &scene) != BS_OK) return fail();

  bitspan_tlm::Device device("device", config, settings);
  Memory memory("memory");
  Bus bus("bus");
  Processor processor("processor", scene);
  sc_core::sc_signal<bool> interrupt("interrupt");
  processor.socket.bind(bus.processor);
  device.memory.bind(bus.master);
  bus.to_memory.bind(memory.socket);
  bus.to_device.bind(device.registers);
  device.interrupt(interrupt);
  processor.interrupt(interrupt);
  sc_core::sc_start();

  if (!processor.has_drawn) {
    std::cerr << "the device drew nothing: " << device.error_text() << "\n";
    return 1;
  }
  std::ofstream out(picture, std::ios::binary);
  out << "P6\n" << width << " " << height << "\n255\n";
  for (std::size_t i = 0; i < static_cast<std::size_t>(width) * static_cast<std::size_t>(height); ++i) {
    out.write(reinterpret_cast<const char*>(memory.bytes.data() + color_at + 4 * i), 3);
  }
  std::cout << picture << ": " << width << "x" << height << ", " << processor.cycles << " cycles, ended at "
            << sc_core::sc_time_stamp() << "\n";
  bs_scene_free(scene);
  bs_config_free(config);
  return out.good() ? 0 : 1;
}
