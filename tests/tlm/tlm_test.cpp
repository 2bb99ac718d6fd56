// SPDX-License-Identifier: Apache-2.0
// The TLM-2.0 device: pictures and clocks, responses, resets, wrong lists, times.
#include <cstddef>
#include <fstream>
#include <iterator>
#include <random>
#include <sstream>

#include "bench.hpp"

namespace bitspan_tlm {
namespace {

constexpr Timing timings[] = {Timing::loose, Timing::approximate};

// ---- the picture ----

void draw_and_compare(const char* name, const char* mode, const Settings& settings, Style style,
                      const sc_time& latency) {
  in_own_process([&] {
    const auto config = configuration(name, mode);
    const LoadedScene scene("demo", 96, 72);
    const Picture model = draw("model", config.get(), scene);
    const Picture timed = draw("timed", config.get(), scene);
    ASSERT_GT(timed.cycles, 1000);
    Bench bench(config.get(), settings);
    bench.memory.style = style;
    bench.memory.latency = latency;
    const std::size_t size = bench.load(scene);
    bench.run([&] {
      for (std::uint32_t frame = 1; frame <= 2; ++frame) {
        bench.clear_pictures();
        bench.host.start(size);
        EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_DONE) << bench.device.error_text();
        bench.expect(model);
        EXPECT_EQ(bench.host.get_pair(BS_TLM_CYCLES), static_cast<std::uint64_t>(timed.cycles));
        EXPECT_EQ(bench.host.get(BS_TLM_FRAMES), frame);
        EXPECT_EQ(bench.host.get(BS_TLM_ERROR), BS_TLM_NO_ERROR);
      }
      EXPECT_LE(bench.memory.longest, settings.burst);
    });
  });
}

TEST(Picture, IsTheModelsInEveryModeLooselyAndApproximatelyTimed) {
  for (const char* mode : {"delta_f", "const_depth_rows", "hyperbolic", "affine"}) {
    for (const Timing timing : timings) {
      Settings settings;
      settings.timing = timing;
      SCOPED_TRACE(mode);
      draw_and_compare("depth16", mode, settings, Style::four_phases, ns(20));
    }
  }
  draw_and_compare("narrow", nullptr, {}, Style::completed, ns(0));
}

TEST(Picture, IsTheSameInEveryStyleOfMemoryAndBurst) {
  for (const Style style : {Style::completed, Style::updated, Style::request_only, Style::four_phases}) {
    for (const unsigned burst : {256U, 1000U, 1U << 20U}) {
      Settings settings;
      settings.timing = Timing::approximate;
      settings.burst = burst;
      draw_and_compare("depth20", nullptr, settings, style, burst == 1000 ? ns(0) : ns(7));
    }
  }
}

TEST(Picture, HasStridesAndBasesAboveFourGigabytesAreKept) {
  in_own_process([] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 40, 30);
    const Picture model = draw("model", config.get(), scene);
    Bench bench(config.get());
    const std::size_t size = bench.load(scene);
    bench.run([&] {
      bench.host.set(BS_TLM_FB_STRIDE, 200);
      bench.host.set(BS_TLM_Z_STRIDE, 164);
      bench.host.start(size);
      EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_DONE);
      for (std::size_t y = 0; y < 30; ++y) {
        const auto row = [&](const Bytes& plane) {
          return Bytes(plane.begin() + static_cast<std::ptrdiff_t>(y * 160),
                       plane.begin() + static_cast<std::ptrdiff_t>(y * 160 + 160));
        };
        EXPECT_EQ(bench.at(color_at + y * 200, 160), row(model.color));
        EXPECT_EQ(bench.at(color_at + y * 200 + 160, 40), Bytes(40)) << "the gap behind a row";
        EXPECT_EQ(bench.at(depth_at + y * 164, 160), row(model.depth));
        EXPECT_EQ(bench.at(depth_at + y * 164 + 160, 4), Bytes(4));
      }
      bench.host.set(BS_TLM_FB_BASE_HIGH, 5);
      bench.host.set(BS_TLM_CTRL, BS_TLM_CTRL_START);
      EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_ERROR);
      EXPECT_EQ(bench.host.get(BS_TLM_ERROR), BS_TLM_BUS_ERROR);
      EXPECT_EQ(bench.host.get_pair(BS_TLM_ERROR_ADDRESS), 0x500000000 + color_at);
    });
  });
}

TEST(Picture, ComesFromTheRegistersOfItsStart) {
  in_own_process([] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 64, 48);
    const Picture model = draw("model", config.get(), scene);
    Bench bench(config.get());
    bench.memory.latency = ns(1000);  // so that the list is being read when the registers change
    const std::size_t size = bench.load(scene);
    bench.run([&] {
      bench.host.start(size);
      wait(ns(100));
      bench.host.set(BS_TLM_FB_BASE, 0x500000);
      bench.host.set(BS_TLM_CMD_SIZE, 0);
      EXPECT_EQ(bench.host.try_set(BS_TLM_CTRL, BS_TLM_CTRL_START), tlm::TLM_COMMAND_ERROR_RESPONSE);
      EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_DONE);
      bench.expect(model);
      EXPECT_EQ(bench.at(0x500000, 4096), Bytes(4096));
    });
  });
}

TEST(Picture, RecordsAreThereOnRequest) {
  in_own_process([] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 64, 48);
    Settings settings;
    settings.trace = true;
    Bench bench(config.get(), settings);
    const std::size_t size = bench.load(scene);
    bench.run([&] {
      bench.host.start(size);
      EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_DONE);
      bs_view view{};
      view.size = sizeof view;
      ok(bs_records(bench.device.model(), BS_STAGE_MERGE, &view));
      EXPECT_GT(view.rows, 1000U);
    });
  });
}

// ---- time ----

// Nanoseconds from START to the interrupt, of a frame of `cycles` clocks of 10 ns.
double frame_time(Timing timing, Style style, const sc_time& latency, std::int64_t& cycles) {
  // What the scenario's process found comes through a file.
  const std::string file = testing::TempDir() + "bitspan_tlm_time." + std::to_string(getpid());
  in_own_process([&] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 64, 48);
    Settings settings;
    settings.timing = timing;
    Bench bench(config.get(), settings);
    bench.memory.style = style;
    bench.memory.latency = latency;
    const std::size_t size = bench.load(scene);
    bench.run([&] {
      bench.host.start(size);
      const sc_time started = sc_time_stamp() - ns(10);  // the write of CTRL took a clock
      wait(bench.host.interrupt.posedge_event());
      const double time = (sc_time_stamp() - started) / ns(1);
      EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_DONE);
      const auto counted = bench.host.get_pair(BS_TLM_CYCLES);
      std::ofstream(file) << time << " " << counted << "\n";
      // Rows are spread over the clocks.
      if (latency == sc_core::SC_ZERO_TIME) {
        for (std::uint64_t y = 0; y < 48; ++y) {
          const double at = (bench.memory.written.at(color_at + y * 256) - started) / ns(1);
          EXPECT_DOUBLE_EQ(at, 10.0 * static_cast<double>(counted * (y + 1) / 48)) << "row " << y;
        }
      }
    });
  });
  double time = 0;
  std::ifstream(file) >> time >> cycles;
  std::remove(file.c_str());
  return time;
}

TEST(Time, IsTheClocksWhereMemoryTakesNoneAndTheSameInBothTimings) {
  const auto config = configuration("depth16");
  const LoadedScene scene("demo", 64, 48);
  const std::int64_t expected = draw("timed", config.get(), scene).cycles;
  std::int64_t cycles = 0;
  for (const Timing timing : timings) {
    for (const Style style : {Style::completed, Style::four_phases}) {
      EXPECT_DOUBLE_EQ(frame_time(timing, style, ns(0), cycles), 10.0 * static_cast<double>(expected));
      EXPECT_EQ(cycles, expected);
    }
  }
  // The same transfers with the same latency take the same time, whatever the phases.
  const double loose = frame_time(Timing::loose, Style::completed, ns(40), cycles);
  EXPECT_GT(loose, 10.0 * static_cast<double>(expected));
  for (const Style style : {Style::completed, Style::updated, Style::request_only, Style::four_phases}) {
    EXPECT_DOUBLE_EQ(frame_time(Timing::approximate, style, ns(40), cycles), loose);
    EXPECT_EQ(cycles, expected);
  }
  // Memory slower than the drawing makes the frame longer, and no other.
  EXPECT_GT(frame_time(Timing::loose, Style::completed, ns(20000), cycles), 96 * 20000.0);
  EXPECT_EQ(cycles, expected);
}

// ---- registers ----

// Each register by its rights, and what is refused, in both ways of transport.
void check_responses(Timing timing, bool ends_response_at_once) {
  in_own_process([&] {
    const auto config = configuration("depth16");
    Settings settings;
    settings.timing = timing;
    Bench bench(config.get(), settings);
    bench.host.ends_response_at_once = ends_response_at_once;
    bench.run([&] {
      Host& host = bench.host;
      for (const Register& r : register_map) {
        EXPECT_EQ(host.get(r.offset), r.reset) << r.name;
        if (r.access == Access::write) continue;
        const bool may = r.access != Access::read;
        EXPECT_EQ(host.try_set(r.offset, 0x89abcdef),
                  may ? tlm::TLM_OK_RESPONSE : tlm::TLM_COMMAND_ERROR_RESPONSE);
        EXPECT_EQ(host.get(r.offset), r.access == Access::read_write ? 0x89abcdef : r.reset) << r.name;
      }
      constexpr auto read = tlm::TLM_READ_COMMAND;
      constexpr auto write = tlm::TLM_WRITE_COMMAND;
      struct Case {
        AccessRequest access;
        tlm::tlm_response_status response;
      };
      const std::vector<Case> cases{
          {{tlm::TLM_IGNORE_COMMAND, BS_TLM_CMD_BASE}, tlm::TLM_OK_RESPONSE},
          {{tlm::TLM_IGNORE_COMMAND, 0xfffffff0}, tlm::TLM_OK_RESPONSE},
          {{read, BS_TLM_MAP_SIZE}, tlm::TLM_ADDRESS_ERROR_RESPONSE},
          {{write, BS_TLM_MAP_SIZE}, tlm::TLM_ADDRESS_ERROR_RESPONSE},
          {{read, 0xffffffffffffffff}, tlm::TLM_ADDRESS_ERROR_RESPONSE},
          {{read, 0x100000000}, tlm::TLM_ADDRESS_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE + 1}, tlm::TLM_ADDRESS_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE + 2, 2, 2}, tlm::TLM_ADDRESS_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 1, 1}, tlm::TLM_BURST_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 2, 2}, tlm::TLM_BURST_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 8, 8}, tlm::TLM_BURST_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 0, 4}, tlm::TLM_BURST_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 4, 1}, tlm::TLM_BURST_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 4, 0}, tlm::TLM_BURST_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 8, 4}, tlm::TLM_BURST_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 4, 4, true}, tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE},
          {{read, BS_TLM_CMD_BASE, 4, 4, true}, tlm::TLM_BYTE_ENABLE_ERROR_RESPONSE},
          {{write, BS_TLM_CMD_BASE, 4, 4, false, false}, tlm::TLM_GENERIC_ERROR_RESPONSE},
          {{write, BS_TLM_ID}, tlm::TLM_COMMAND_ERROR_RESPONSE},
          {{write, BS_TLM_STATUS}, tlm::TLM_COMMAND_ERROR_RESPONSE},
          {{read, BS_TLM_CMD_BASE, 4, 64}, tlm::TLM_OK_RESPONSE},
      };
      host.set(BS_TLM_CMD_BASE, 77);
      for (std::size_t i = 0; i < cases.size(); ++i) {
        std::uint32_t word = 99;
        EXPECT_EQ(host.access(cases[i].access, &word), cases[i].response) << "case " << i;
        const bool reads = cases[i].response == tlm::TLM_OK_RESPONSE && cases[i].access.command == read;
        EXPECT_EQ(word, reads ? 77U : 99U) << "case " << i;
        EXPECT_EQ(host.get(BS_TLM_CMD_BASE), 77U) << "case " << i;
      }
      EXPECT_EQ(host.get(BS_TLM_STATUS), 0U);
    });
  });
}

TEST(Registers, HaveADefinedResponseToEverything) {
  check_responses(Timing::loose, true);
  check_responses(Timing::approximate, true);
  check_responses(Timing::approximate, false);
}

TEST(Registers, TakeTheTimeOfTheDriver) {
  in_own_process([] {
    const auto config = configuration("depth16");
    Bench bench(config.get());
    bench.run([&] {
      tlm::tlm_generic_payload t;
      std::uint32_t word = 0;
      t.set_read();
      t.set_address(BS_TLM_ID);
      t.set_data_ptr(reinterpret_cast<unsigned char*>(&word));
      t.set_data_length(4);
      t.set_streaming_width(4);
      sc_time ahead = ns(123);
      bench.host.socket->b_transport(t, ahead);
      EXPECT_EQ(sc_time_stamp(), ns(123));
      EXPECT_EQ(ahead, ns(10));
      EXPECT_EQ(word, BS_TLM_ID_VALUE);
    });
  });
}

TEST(Registers, RefuseWhatIsAgainstTheProtocol) {
  in_own_process([] {
    const auto config = configuration("depth16");
    Bench bench(config.get());
    bench.run([&] {
      tlm::tlm_generic_payload unmanaged;
      tlm::tlm_phase phase = tlm::BEGIN_REQ;
      sc_time delay = sc_core::SC_ZERO_TIME;
      EXPECT_EQ(bench.host.socket->nb_transport_fw(unmanaged, phase, delay), tlm::TLM_COMPLETED);
      EXPECT_EQ(unmanaged.get_response_status(), tlm::TLM_GENERIC_ERROR_RESPONSE);

      struct Manager : tlm::tlm_mm_interface {
        void free(tlm::tlm_generic_payload* /*t*/) override {}
      } manager;
      std::array<tlm::tlm_generic_payload, 2> two;
      std::array<std::uint32_t, 2> words{};
      for (std::size_t i = 0; i < 2; ++i) {
        two[i].set_mm(&manager);
        two[i].acquire();
        two[i].set_read();
        two[i].set_address(BS_TLM_ID);
        two[i].set_data_ptr(reinterpret_cast<unsigned char*>(&words[i]));
        two[i].set_data_length(4);
        two[i].set_streaming_width(4);
      }
      phase = tlm::BEGIN_REQ;
      EXPECT_EQ(bench.host.socket->nb_transport_fw(two[0], phase, delay), tlm::TLM_ACCEPTED);
      // The request before it has not ended.
      EXPECT_EQ(bench.host.socket->nb_transport_fw(two[1], phase, delay), tlm::TLM_COMPLETED);
      EXPECT_EQ(two[1].get_response_status(), tlm::TLM_GENERIC_ERROR_RESPONSE);
      wait(ns(1));
      // It has ended, and its response has not begun: a second request may come.
      EXPECT_EQ(bench.host.socket->nb_transport_fw(two[1], phase, delay), tlm::TLM_ACCEPTED);
      wait(ns(50));
      for (std::size_t i = 0; i < 2; ++i) {
        EXPECT_EQ(two[i].get_response_status(), tlm::TLM_OK_RESPONSE);
        EXPECT_EQ(words[i], BS_TLM_ID_VALUE);
        EXPECT_EQ(two[i].get_ref_count(), 1) << "the device has kept it";
      }
      phase = tlm::END_RESP;  // of nothing
      EXPECT_EQ(bench.host.socket->nb_transport_fw(two[0], phase, delay), tlm::TLM_ACCEPTED);
    });
  });
}

TEST(Registers, DebugTransportReadsWithoutEffectAndDirectMemoryIsRefused) {
  in_own_process([] {
    const auto config = configuration("depth16");
    Bench bench(config.get());
    bench.run([&] {
      bench.host.set(BS_TLM_CMD_BASE, 0x11223344);
      const sc_time before = sc_time_stamp();
      std::array<unsigned char, 256> data{};
      tlm::tlm_generic_payload t;
      t.set_read();
      t.set_data_ptr(data.data());
      t.set_data_length(256);
      t.set_address(0);
      EXPECT_EQ(bench.host.socket->transport_dbg(t), BS_TLM_MAP_SIZE);
      EXPECT_EQ(std::string(data.begin(), data.begin() + 4), "BSPN");
      EXPECT_EQ(data[BS_TLM_CMD_BASE], 0x44);
      t.set_address(BS_TLM_CMD_BASE + 1);
      t.set_data_length(2);
      EXPECT_EQ(bench.host.socket->transport_dbg(t), 2U);
      EXPECT_EQ(data[0], 0x33);
      EXPECT_EQ(data[1], 0x22);
      t.set_address(BS_TLM_MAP_SIZE);
      EXPECT_EQ(bench.host.socket->transport_dbg(t), 0U);
      t.set_address(0xffffffffffffffff);
      EXPECT_EQ(bench.host.socket->transport_dbg(t), 0U);
      t.set_address(BS_TLM_CMD_BASE);
      t.set_write();
      EXPECT_EQ(bench.host.socket->transport_dbg(t), 0U);
      t.set_address(BS_TLM_CTRL);
      data.fill(0xff);
      EXPECT_EQ(bench.host.socket->transport_dbg(t), 0U);
      EXPECT_EQ(sc_time_stamp(), before);
      EXPECT_EQ(bench.host.get(BS_TLM_CMD_BASE), 0x11223344U);
      EXPECT_EQ(bench.host.get(BS_TLM_STATUS), 0U);
      tlm::tlm_dmi dmi;
      EXPECT_FALSE(bench.host.socket->get_direct_mem_ptr(t, dmi));
      EXPECT_TRUE(dmi.is_none_allowed());
      EXPECT_EQ(dmi.get_end_address(), 0xffffffffffffffffU);
    });
  });
}

TEST(Registers, TheMaskDecidesWhetherAnInterruptShows) {
  in_own_process([] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 32, 24);
    Bench bench(config.get());
    const std::size_t size = bench.load(scene);
    bench.run([&] {
      Host& host = bench.host;
      host.set(BS_TLM_CMD_BASE, list_at);
      host.set(BS_TLM_CMD_SIZE, static_cast<std::uint32_t>(size));
      host.set(BS_TLM_FB_BASE, color_at);
      host.set(BS_TLM_Z_BASE, depth_at);
      host.set(BS_TLM_IRQ_MASK, BS_TLM_IRQ_ERROR);
      host.set(BS_TLM_CTRL, BS_TLM_CTRL_START);
      EXPECT_EQ(host.get(BS_TLM_STATUS), BS_TLM_STATUS_BUSY);
      while (host.get(BS_TLM_STATUS) == BS_TLM_STATUS_BUSY) wait(ns(1000));
      EXPECT_EQ(host.get(BS_TLM_STATUS), BS_TLM_STATUS_DONE);
      EXPECT_EQ(host.get(BS_TLM_IRQ), BS_TLM_IRQ_DONE);
      EXPECT_FALSE(host.interrupt.read());
      host.set(BS_TLM_IRQ_MASK, BS_TLM_IRQ_DONE);
      wait(ns(1));
      EXPECT_TRUE(host.interrupt.read());
      host.set(BS_TLM_IRQ, BS_TLM_IRQ_ERROR);  // not this one
      wait(ns(1));
      EXPECT_TRUE(host.interrupt.read());
      host.set(BS_TLM_IRQ, BS_TLM_IRQ_DONE);
      wait(ns(1));
      EXPECT_FALSE(host.interrupt.read());
      EXPECT_EQ(host.get(BS_TLM_STATUS), BS_TLM_STATUS_DONE);
    });
  });
}

// ---- resets ----

// Resets a frame after `time`, looks at what is left, and draws the next frame whole.
void check_reset(Timing timing, double after, bool starts_at_once, bool has_rows) {
  in_own_process([&] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 64, 48);
    const Picture model = draw("model", config.get(), scene);
    Settings settings;
    settings.timing = timing;
    settings.burst = 256;
    Bench bench(config.get(), settings);
    bench.memory.latency = ns(100);
    const std::size_t size = bench.load(scene);
    bench.run([&] {
      Host& host = bench.host;
      host.start(size);
      wait(ns(after));
      EXPECT_EQ(host.get(BS_TLM_STATUS), BS_TLM_STATUS_BUSY);
      if (starts_at_once) {
        bench.device.reset();
        host.start(size);
      } else {
        host.set(BS_TLM_CTRL, BS_TLM_CTRL_RESET);
        for (const Register& r : register_map) EXPECT_EQ(host.get(r.offset), r.reset) << r.name;
        const Bytes left = bench.at(color_at, model.color.size());
        wait(ns(10'000'000));
        EXPECT_TRUE(bench.at(color_at, model.color.size()) == left) << "written behind the reset";
        EXPECT_FALSE(host.interrupt.read());
        // Rows are the picture's from the top, and then untouched.
        std::size_t rows = 0;
        while (rows < 48 && std::equal(left.begin() + static_cast<std::ptrdiff_t>(256 * rows),
                                       left.begin() + static_cast<std::ptrdiff_t>(256 * (rows + 1)),
                                       model.color.begin() + static_cast<std::ptrdiff_t>(256 * rows))) {
          ++rows;
        }
        EXPECT_LT(rows, 48U);
        EXPECT_EQ(rows > 0, has_rows);
        for (std::size_t i = 256 * rows; i < left.size(); ++i) ASSERT_EQ(left[i], 0) << "byte " << i;
        host.start(size);
      }
      EXPECT_EQ(host.finish(), BS_TLM_STATUS_DONE);
      bench.expect(model);
      EXPECT_EQ(host.get(BS_TLM_FRAMES), 1U);
    });
  });
}

TEST(Reset, InTheMiddleOfAFrameLeavesADefinedState) {
  for (const Timing timing : timings) {
    // While the list and the textures are read, and between rows and within them.
    for (const double after : {0.0, 5.0, 150.0, 20'000.0, 150'000.0, 200'000.0, 203'333.0}) {
      SCOPED_TRACE(after);
      check_reset(timing, after, false, after > 100'000.0);
      check_reset(timing, after, true, false);
    }
  }
}

TEST(Reset, AndStartInOneWordBeginsAnew) {
  in_own_process([] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 32, 24);
    Bench bench(config.get());
    bench.load(scene);
    bench.run([&] {
      bench.host.set(BS_TLM_CMD_SIZE, 8);
      bench.host.set(BS_TLM_CTRL, BS_TLM_CTRL_RESET | BS_TLM_CTRL_START);
      wait(ns(1));
      EXPECT_EQ(bench.host.get(BS_TLM_ERROR), BS_TLM_NO_END);  // the reset went first: the list has no bytes
      EXPECT_FALSE(bench.host.interrupt.read());
    });
  });
}

// ---- wrong lists ----

struct Wrong {
  std::string name;
  std::function<void(Bytes&)> change;
  std::uint32_t code;
  std::uint64_t at;  // behind CMD_BASE
};

template <class T>
void poke(Bytes& list, std::size_t at, T value) {
  std::memcpy(list.data() + at, &value, sizeof value);
}

TEST(WrongList, SetsACodeAndAnAddressAndInterrupts) {
  for (const Timing timing : timings) {
    in_own_process([timing] {
      const auto config = configuration("depth16");
      const LoadedScene scene("demo", 32, 24);
      const Picture model = draw("model", config.get(), scene);
      Settings settings;
      settings.timing = timing;
      Bench bench(config.get(), settings);
      const std::size_t size = bench.load(scene);
      const Bytes good = bench.at(list_at, size);
      const std::size_t texture = sizeof(bs_tlm_begin);
      const std::size_t triangle = texture + scene.desc.texture_count * sizeof(bs_tlm_texture);
      const std::size_t draw_at = size - 16, end_at = size - 8;
      ASSERT_GT(scene.desc.texture_count, 0U);
      const double nan = std::numeric_limits<double>::quiet_NaN();
      const std::vector<Wrong> wrong{
          {"no opcode", [](Bytes& l) { poke(l, 0, 0U); }, BS_TLM_BAD_OPCODE, 0},
          {"an opcode of no command", [&](Bytes& l) { poke(l, triangle, 6U); }, BS_TLM_BAD_OPCODE, triangle},
          {"a size too large", [&](Bytes& l) { poke(l, triangle + 4, 240U); }, BS_TLM_BAD_SIZE, triangle},
          {"a size of 0", [](Bytes& l) { poke(l, 4, 0U); }, BS_TLM_BAD_SIZE, 0},
          {"no begin", [&](Bytes& l) { l.erase(l.begin(), l.begin() + 64); }, BS_TLM_BAD_ORDER, 0},
          {"two begins", [&](Bytes& l) { l.insert(l.begin() + 64, l.begin(), l.begin() + 64); },
           BS_TLM_BAD_ORDER, 64},
          {"another version", [](Bytes& l) { poke(l, 8, 2U); }, BS_TLM_BAD_VERSION, 0},
          {"width 0", [](Bytes& l) { poke(l, 12, 0); }, BS_TLM_BAD_VALUE, 0},
          {"width -1", [](Bytes& l) { poke(l, 12, -1); }, BS_TLM_BAD_VALUE, 0},
          {"s_min is NaN", [nan](Bytes& l) { poke(l, 32, nan); }, BS_TLM_BAD_VALUE, 0},
          {"has_fog 2", [](Bytes& l) { poke(l, 20, 2U); }, BS_TLM_BAD_VALUE, 0},
          {"a reserved byte", [](Bytes& l) { l[27] = 1; }, BS_TLM_BAD_VALUE, 0},
          {"a texture without width", [&](Bytes& l) { poke(l, texture + 8, 0); }, BS_TLM_BAD_VALUE, texture},
          {"a texture too high", [&](Bytes& l) { poke(l, texture + 12, 16385); }, BS_TLM_BAD_VALUE, texture},
          {"a stride too small", [&](Bytes& l) { poke(l, texture + 24, 4U); }, BS_TLM_BAD_VALUE, texture},
          {"a texture beyond the last address", [&](Bytes& l) { poke(l, texture + 16, ~std::uint64_t{0}); },
           BS_TLM_BAD_VALUE, texture},
          {"a texture behind triangles",
           [&](Bytes& l) {
             const Bytes copy(l.begin() + 64, l.begin() + 96);
             l.insert(l.begin() + static_cast<std::ptrdiff_t>(draw_at), copy.begin(), copy.end());
           },
           BS_TLM_BAD_ORDER, draw_at},
          {"an index of no texture", [&](Bytes& l) { poke(l, triangle + 8, 99); }, BS_TLM_BAD_VALUE, draw_at},
          {"x is NaN", [&](Bytes& l) { poke(l, triangle + 16, nan); }, BS_TLM_BAD_VALUE, draw_at},
          {"a reserved word of a triangle", [&](Bytes& l) { poke(l, triangle + 12, 1U); }, BS_TLM_BAD_VALUE,
           triangle},
          {"no end", [](Bytes& l) { l.resize(l.size() - 8); }, BS_TLM_NO_END, end_at},
          {"half an end", [](Bytes& l) { l.resize(l.size() - 4); }, BS_TLM_NO_END, end_at},
          {"half a triangle", [&](Bytes& l) { l.resize(triangle + 100); }, BS_TLM_NO_END, triangle},
          {"nothing", [](Bytes& l) { l.clear(); }, BS_TLM_NO_END, 0},
          {"triangles that are not drawn",
           [&](Bytes& l) { l.erase(l.begin() + static_cast<std::ptrdiff_t>(draw_at), l.end() - 8); },
           BS_TLM_BAD_ORDER, draw_at},
      };
      bench.run([&] {
        Host& host = bench.host;
        std::uint32_t frames = 0;
        for (const Wrong& w : wrong) {
          Bytes list = good;
          w.change(list);
          bench.put(list);
          bench.clear_pictures();
          host.start(list.size());
          EXPECT_EQ(host.finish(), BS_TLM_STATUS_ERROR) << w.name;
          EXPECT_EQ(host.get(BS_TLM_ERROR), w.code) << w.name << ": " << bench.device.error_text();
          EXPECT_EQ(host.get_pair(BS_TLM_ERROR_ADDRESS), list_at + w.at) << w.name;
          EXPECT_FALSE(bench.device.error_text().empty());
          EXPECT_EQ(bench.at(color_at, model.color.size()), Bytes(model.color.size())) << w.name;
          EXPECT_EQ(host.get(BS_TLM_FRAMES), frames);
          // The next frame is whole, and the error is gone.
          bench.put(good);
          host.start(good.size());
          EXPECT_EQ(host.finish(), BS_TLM_STATUS_DONE) << w.name;
          EXPECT_EQ(host.get(BS_TLM_ERROR), BS_TLM_NO_ERROR);
          EXPECT_EQ(host.get_pair(BS_TLM_ERROR_ADDRESS), 0U);
          EXPECT_EQ(host.get(BS_TLM_FRAMES), ++frames);
          bench.expect(model);
        }
      });
    });
  }
}

TEST(WrongList, BasesAndStridesAreChecked) {
  in_own_process([] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 32, 24);
    Bench bench(config.get());
    const std::size_t size = bench.load(scene);
    struct Case {
      std::vector<std::pair<std::uint32_t, std::uint32_t>> set;
      std::uint64_t at;
    };
    const std::vector<Case> cases{
        {{{BS_TLM_CMD_BASE, list_at + 4}}, list_at + 4},
        {{{BS_TLM_CMD_BASE, 0xfffffff8}, {BS_TLM_CMD_BASE_HIGH, 0xffffffff}}, 0xfffffffffffffff8},
        {{{BS_TLM_FB_BASE, color_at + 2}}, color_at + 2},
        {{{BS_TLM_Z_BASE, depth_at + 1}}, depth_at + 1},
        {{{BS_TLM_FB_STRIDE, 124}}, color_at},
        {{{BS_TLM_Z_STRIDE, 130}}, depth_at},
        {{{BS_TLM_FB_BASE, 0xfffffff0}, {BS_TLM_FB_BASE_HIGH, 0xffffffff}}, 0xfffffffffffffff0},
    };
    bench.run([&] {
      for (const Case& c : cases) {
        bench.host.set(BS_TLM_CTRL, BS_TLM_CTRL_RESET);
        bench.host.set(BS_TLM_CMD_BASE, list_at);
        bench.host.set(BS_TLM_CMD_SIZE, static_cast<std::uint32_t>(size));
        bench.host.set(BS_TLM_FB_BASE, color_at);
        bench.host.set(BS_TLM_Z_BASE, depth_at);
        bench.host.set(BS_TLM_IRQ_MASK, BS_TLM_IRQ_ERROR);
        for (const auto& [offset, word] : c.set) bench.host.set(offset, word);
        bench.host.set(BS_TLM_CTRL, BS_TLM_CTRL_START);
        EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_ERROR);
        EXPECT_EQ(bench.host.get(BS_TLM_ERROR), BS_TLM_BAD_BASE);
        EXPECT_EQ(bench.host.get_pair(BS_TLM_ERROR_ADDRESS), c.at);
      }
    });
  });
}

TEST(WrongList, EveryTransferThatFailsIsABusError) {
  for (const Timing timing : timings) {
    in_own_process([timing] {
      const auto config = configuration("depth16");
      const LoadedScene scene("demo", 16, 12);
      Settings settings;
      settings.timing = timing;
      Bench bench(config.get(), settings);
      const std::size_t size = bench.load(scene);
      bench.run([&] {
        bench.host.start(size);
        EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_DONE);
        const std::uint64_t whole = bench.memory.transfers;
        EXPECT_GT(whole, 30U);
        for (std::uint64_t i = 0; i < whole; ++i) {
          bench.memory.transfers = 0;
          bench.memory.fail_at = i;
          bench.memory.failure = i % 2 == 0 ? tlm::TLM_GENERIC_ERROR_RESPONSE : tlm::TLM_INCOMPLETE_RESPONSE;
          bench.host.start(size);
          EXPECT_EQ(bench.host.finish(), BS_TLM_STATUS_ERROR) << "transfer " << i;
          EXPECT_EQ(bench.host.get(BS_TLM_ERROR), BS_TLM_BUS_ERROR) << "transfer " << i;
          EXPECT_EQ(bench.memory.transfers, i + 1) << "a transfer behind the one that failed";
        }
      });
    });
  }
}

TEST(WrongList, RandomBytesNeverStopTheDevice) {
  in_own_process([] {
    const auto config = configuration("depth16");
    const LoadedScene scene("demo", 16, 12);
    Bench bench(config.get());
    const std::size_t whole = bench.load(scene);
    // The head of a real list, short enough for thousands.
    Bytes good = bench.at(list_at, whole);
    const std::size_t head = sizeof(bs_tlm_begin) + scene.desc.texture_count * sizeof(bs_tlm_texture);
    good.erase(good.begin() + static_cast<std::ptrdiff_t>(head + 3 * sizeof(bs_tlm_triangle)),
               good.end() - 16);
    // Small textures: what goes wrong is the list.
    for (std::size_t i = 0; i < scene.desc.texture_count; ++i) {
      poke(good, sizeof(bs_tlm_begin) + i * sizeof(bs_tlm_texture) + 8, std::uint64_t{0x0000000400000004});
    }
    std::mt19937 random(1);
    std::map<std::uint32_t, int> seen;
    bench.run([&] {
      for (int i = 0; i < 3000; ++i) {
        Bytes list = good;
        const auto changes = 1 + random() % 4;
        for (std::uint32_t c = 0; c < changes; ++c) {
          const std::size_t at = random() % list.size();
          // Not the picture's size, whose upper bytes ask for gigabytes.
          if (at >= 12 && at < 20) continue;
          list[at] = static_cast<std::uint8_t>(random());
        }
        if (random() % 8 == 0) list.resize(random() % list.size());
        bench.put(list);
        bench.host.start(list.size());
        const std::uint32_t status = bench.host.finish();
        EXPECT_TRUE(status == BS_TLM_STATUS_DONE || status == BS_TLM_STATUS_ERROR);
        ++seen[bench.host.get(BS_TLM_ERROR)];
      }
      for (const std::uint32_t code : {BS_TLM_NO_ERROR, BS_TLM_BAD_OPCODE, BS_TLM_BAD_SIZE, BS_TLM_BAD_VALUE,
                                       BS_TLM_NO_END, BS_TLM_BUS_ERROR}) {
        EXPECT_GT(seen[code], 5) << "code " << code;
      }
      EXPECT_EQ(seen[BS_TLM_INTERNAL], 0);
    });
  });
}

TEST(Construction, ReportsWhatIsNotLegal) {
  in_own_process([] {
    const auto config = configuration("depth16");
    Settings settings;
    settings.engine = "nothing";
    EXPECT_THROW(Device("device", config.get(), settings), sc_core::sc_report);
    settings = {};
    settings.burst = 255;
    EXPECT_THROW(Device("device2", config.get(), settings), sc_core::sc_report);
  });
}

// ---- the document ----

std::vector<std::vector<std::string>> table(const std::string& head) {
  std::ifstream in(BITSPAN_SOURCE_DIR "/docs/tlm.md");
  const std::string text{std::istreambuf_iterator<char>(in), {}};
  std::vector<std::vector<std::string>> rows;
  const std::size_t begin = text.find(head);
  EXPECT_NE(begin, std::string::npos) << head;
  std::istringstream lines(text.substr(begin == std::string::npos ? text.size() : begin));
  std::string line;
  std::getline(lines, line);
  std::getline(lines, line);
  while (std::getline(lines, line) && !line.empty() && line[0] == '|') {
    std::vector<std::string> cells;
    std::istringstream row(line.substr(1));
    for (std::string cell; std::getline(row, cell, '|');) {
      const auto keep = cell.find_first_not_of(" `");
      cells.push_back(keep == std::string::npos ? ""
                                                : cell.substr(keep, cell.find_last_not_of(" `") - keep + 1));
    }
    rows.push_back(cells);
  }
  return rows;
}
std::string hex(std::uint32_t value) {
  char text[16];
  std::snprintf(text, sizeof text, "0x%02x", value);
  return text;
}

TEST(Document, HasTheRegisters) {
  const auto rows = table("| offset | register | access | after reset |");
  ASSERT_EQ(rows.size(), register_map.size());
  const char* const access[] = {"read", "write", "read, write", "read, 1 clears"};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Register& r = register_map[i];
    EXPECT_EQ(r.offset, 4 * i) << "register_map is in the order of the offsets";
    EXPECT_EQ(rows[i][0], hex(r.offset));
    EXPECT_EQ(rows[i][1], r.name);
    EXPECT_EQ(rows[i][2], access[static_cast<int>(r.access)]) << r.name;
    EXPECT_EQ(rows[i][3], r.reset == 0 ? "0" : hex(r.reset)) << r.name;
  }
}

TEST(Document, HasTheBitsAndTheErrors) {
  const auto bits = table("| register | bit | name |");
  const std::vector<std::vector<std::string>> expected{
      {"CTRL", std::to_string(BS_TLM_CTRL_START), "START"},
      {"CTRL", std::to_string(BS_TLM_CTRL_RESET), "RESET"},
      {"STATUS", std::to_string(BS_TLM_STATUS_BUSY), "BUSY"},
      {"STATUS", std::to_string(BS_TLM_STATUS_DONE), "DONE"},
      {"STATUS", std::to_string(BS_TLM_STATUS_ERROR), "ERROR"},
      {"IRQ, IRQ_MASK", std::to_string(BS_TLM_IRQ_DONE), "DONE"},
      {"IRQ, IRQ_MASK", std::to_string(BS_TLM_IRQ_ERROR), "ERROR"}};
  ASSERT_EQ(bits.size(), expected.size());
  for (std::size_t i = 0; i < bits.size(); ++i) {
    EXPECT_EQ(std::vector<std::string>(bits[i].begin(), bits[i].begin() + 3), expected[i]);
  }
  const auto errors = table("| code | name |");
  const std::vector<std::pair<int, const char*>> codes{
      {BS_TLM_NO_ERROR, "NO_ERROR"},   {BS_TLM_BAD_OPCODE, "BAD_OPCODE"},   {BS_TLM_BAD_SIZE, "BAD_SIZE"},
      {BS_TLM_BAD_ORDER, "BAD_ORDER"}, {BS_TLM_BAD_VERSION, "BAD_VERSION"}, {BS_TLM_BAD_VALUE, "BAD_VALUE"},
      {BS_TLM_NO_END, "NO_END"},       {BS_TLM_BAD_BASE, "BAD_BASE"},       {BS_TLM_BUS_ERROR, "BUS_ERROR"},
      {BS_TLM_NO_MEMORY, "NO_MEMORY"}, {BS_TLM_INTERNAL, "INTERNAL"}};
  ASSERT_EQ(errors.size(), codes.size());
  for (std::size_t i = 0; i < codes.size(); ++i) {
    EXPECT_EQ(errors[i][0], std::to_string(codes[i].first));
    EXPECT_EQ(errors[i][1], codes[i].second);
  }
}

TEST(Document, HasTheCommands) {
  const auto commands = table("| opcode | command | bytes |");
  const std::vector<std::vector<std::string>> expected{
      {std::to_string(BS_TLM_BEGIN), "begin", std::to_string(sizeof(bs_tlm_begin))},
      {std::to_string(BS_TLM_TEXTURE), "texture", std::to_string(sizeof(bs_tlm_texture))},
      {std::to_string(BS_TLM_TRIANGLE), "triangle", std::to_string(sizeof(bs_tlm_triangle))},
      {std::to_string(BS_TLM_DRAW), "draw", std::to_string(sizeof(bs_tlm_command))},
      {std::to_string(BS_TLM_END), "end", std::to_string(sizeof(bs_tlm_command))}};
  ASSERT_EQ(commands.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(std::vector<std::string>(commands[i].begin(), commands[i].begin() + 3), expected[i]);
  }
  const auto rows = table("| command | offset | field | type |");
  struct Place {
    const char* command;
    std::size_t offset, size;
    const char* field;
  };
#define PLACE(command, member) \
  { #command, offsetof(bs_tlm_##command, member), sizeof(bs_tlm_##command::member), #member }
  const std::vector<Place> places{
      PLACE(begin, version),      PLACE(begin, width),       PLACE(begin, height),
      PLACE(begin, has_fog),      PLACE(begin, background),  PLACE(begin, fog_color),
      PLACE(begin, s_min),        PLACE(begin, s_max),       PLACE(begin, focal),
      PLACE(begin, fog_distance), PLACE(texture, width),     PLACE(texture, height),
      PLACE(texture, address),    PLACE(texture, stride),    PLACE(texture, reserved),
      PLACE(triangle, texture),   PLACE(triangle, reserved), PLACE(triangle, vertices)};
#undef PLACE
  const std::map<std::string, std::size_t> sizes{{"u32", 4}, {"i32", 4},   {"u64", 8},
                                                 {"f64", 8}, {"u8[4]", 4}, {"f64[3][9]", 216}};
  ASSERT_EQ(rows.size(), places.size());
  std::map<std::string, std::size_t> bytes;
  for (std::size_t i = 0; i < places.size(); ++i) {
    EXPECT_EQ(rows[i][0], places[i].command);
    EXPECT_EQ(rows[i][1], std::to_string(places[i].offset)) << places[i].field;
    EXPECT_EQ(rows[i][2], places[i].field);
    ASSERT_EQ(sizes.count(rows[i][3]), 1U) << rows[i][3];
    EXPECT_EQ(sizes.at(rows[i][3]), places[i].size) << places[i].field;
    bytes[places[i].command] += places[i].size;
  }
  // No field is missing.
  EXPECT_EQ(bytes["begin"] + 8, sizeof(bs_tlm_begin));
  EXPECT_EQ(bytes["texture"] + 8, sizeof(bs_tlm_texture));
  EXPECT_EQ(bytes["triangle"] + 8, sizeof(bs_tlm_triangle));
}

}  // namespace
}  // namespace bitspan_tlm

// Its own main: SystemC's library has one too, which asks for sc_main.
int sc_main(int /*argc*/, char** /*argv*/) { return 0; }
int main(int argc, char** argv) {
  setenv("SYSTEMC_DISABLE_COPYRIGHT_MESSAGE", "1", 0);
  sc_core::sc_report_handler::set_actions("/OSCI/SystemC", sc_core::SC_DO_NOTHING);
  testing::InitGoogleTest(&argc, argv);
  return RUN_ALL_TESTS();
}
