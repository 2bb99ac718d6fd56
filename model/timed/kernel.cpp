// SPDX-License-Identifier: Apache-2.0
#include "model/timed/kernel.hpp"

#include <sysc/tracing/sc_tracing_ids.h>

#include <exception>
#include <fstream>
#include <mutex>
#include <system_error>
#include <systemc>

#include "config/config.hpp"

// SystemC's library has a main() that wants one; a program's own sc_main takes the place of this.
__attribute__((weak)) int sc_main(int /*argc*/, char** /*argv*/) { return 0; }

namespace bitspan::timed {
namespace {

// SystemC has one current simulation context per process: whoever works with one holds this.
std::mutex& kernel_mutex() {
  static std::mutex one;
  return one;
}

// Makes a simulation context the current one for a scope.
class ContextScope {
 public:
  explicit ContextScope(sc_core::sc_simcontext* context) : previous_(sc_core::sc_curr_simcontext) {
    sc_core::sc_curr_simcontext = context;
  }
  ContextScope(const ContextScope&) = delete;
  ContextScope& operator=(const ContextScope&) = delete;
  ~ContextScope() { sc_core::sc_curr_simcontext = previous_; }

 private:
  sc_core::sc_simcontext* previous_;
};

struct RunState {
  std::uint64_t now = 0;  // rising edges so far; the number of the next one
  const std::function<bool()>* done = nullptr;
  std::exception_ptr failure;

  void fail() {
    if (!failure) failure = std::current_exception();
    sc_core::sc_pause();
  }
};

struct StageModule : sc_core::sc_module {
  sc_core::sc_in<bool> clk{"clk"};

  SC_HAS_PROCESS(StageModule);
  StageModule(const sc_core::sc_module_name& name, Clocked* clocked, RunState* run)
      : sc_module(name), clocked_(clocked), run_(run) {
    SC_METHOD(rising);
    sensitive << clk.pos();
    dont_initialize();
  }

 private:
  void rising() {
    try {
      clocked_->clock(run_->now);
    } catch (...) {
      run_->fail();
    }
  }
  Clocked* clocked_;
  RunState* run_;
};

// Between the edges, when every stage has had its clock.
struct MonitorModule : sc_core::sc_module {
  sc_core::sc_in<bool> clk{"clk"};

  SC_HAS_PROCESS(MonitorModule);
  MonitorModule(const sc_core::sc_module_name& name, RunState* run) : sc_module(name), run_(run) {
    SC_METHOD(falling);
    sensitive << clk.neg();
    dont_initialize();
  }

 private:
  void falling() {
    ++run_->now;
    try {
      if ((*run_->done)()) sc_core::sc_pause();
    } catch (...) {
      run_->fail();
    }
  }
  RunState* run_;
};

}  // namespace

struct Kernel::Impl {
  std::unique_ptr<sc_core::sc_simcontext> context;
  std::unique_ptr<sc_core::sc_clock> clock;
  std::vector<std::unique_ptr<StageModule>> stages;
  std::unique_ptr<MonitorModule> monitor;
  RunState run;
  std::filesystem::path vcd;
  std::filesystem::path vcd_partial;
  sc_core::sc_trace_file* trace = nullptr;

  ~Impl() {
    const std::lock_guard lock(kernel_mutex());
    const ContextScope scope(context.get());
    if (trace != nullptr) sc_core::sc_close_vcd_trace_file(trace);
    stages.clear();
    monitor.reset();
    clock.reset();
    // Forgets the clock's cancelled next edge, which the context would leak.
    sc_core::sc_time_to_pending_activity(context.get());
    context.reset();
  }
};

Kernel::Kernel(const std::vector<KernelPart>& parts, const std::filesystem::path& vcd)
    : impl_(std::make_unique<Impl>()) {
  const std::lock_guard lock(kernel_mutex());
  impl_->context = std::make_unique<sc_core::sc_simcontext>();
  const ContextScope scope(impl_->context.get());
  impl_->clock = std::make_unique<sc_core::sc_clock>("clk", 1, sc_core::SC_NS);
  for (const KernelPart& part : parts) {
    impl_->stages.push_back(std::make_unique<StageModule>(part.name.c_str(), part.clocked, &impl_->run));
    impl_->stages.back()->clk(*impl_->clock);
  }
  impl_->monitor = std::make_unique<MonitorModule>("monitor", &impl_->run);
  impl_->monitor->clk(*impl_->clock);

  if (vcd.empty()) return;
  // SystemC appends ".vcd", and says nothing useful where it cannot write.
  std::filesystem::path stem = vcd;
  stem += ".partial";
  impl_->vcd = vcd;
  impl_->vcd_partial = stem;
  impl_->vcd_partial += ".vcd";
  if (!std::ofstream(impl_->vcd_partial)) throw InputError(vcd.string() + ": cannot write the waveform");
  // A clock's picoseconds are no news, nor is a waveform without a clock.
  sc_core::sc_report_handler::set_actions(sc_core::SC_ID_TRACING_TIMESCALE_DEFAULT_, sc_core::SC_DO_NOTHING);
  sc_core::sc_report_handler::set_actions(sc_core::SC_ID_TRACING_CLOSE_EMPTY_FILE_, sc_core::SC_DO_NOTHING);
  impl_->trace = sc_core::sc_create_vcd_trace_file(stem.c_str());
  sc_core::sc_trace(impl_->trace, *impl_->clock, "clk");
  for (const KernelPart& part : parts) {
    for (const auto& [key, signals] : part.signals) {
      const std::string prefix = part.name + "." + (key.empty() ? "" : key + ".");
      sc_core::sc_trace(impl_->trace, signals->in_valid, prefix + "in_valid");
      sc_core::sc_trace(impl_->trace, signals->in_ready, prefix + "in_ready");
      sc_core::sc_trace(impl_->trace, signals->out_valid, prefix + "out_valid");
      sc_core::sc_trace(impl_->trace, signals->out_ready, prefix + "out_ready");
      sc_core::sc_trace(impl_->trace, signals->occupancy, prefix + "occupancy");
      sc_core::sc_trace(impl_->trace, signals->state, prefix + "state", 2);
    }
  }
}

Kernel::~Kernel() {
  try {
    close_vcd();
  } catch (const InputError&) {
    // Who wants to know calls close_vcd.
  }
}

void Kernel::run(const std::function<bool()>& done) {
  const std::lock_guard lock(kernel_mutex());
  const ContextScope scope(impl_->context.get());
  impl_->run.done = &done;
  sc_core::sc_start();
  impl_->run.done = nullptr;
  if (impl_->run.failure) std::rethrow_exception(impl_->run.failure);
}

std::uint64_t Kernel::cycles() const { return impl_->run.now; }

void Kernel::close_vcd() {
  if (impl_->trace == nullptr) return;
  {
    const std::lock_guard lock(kernel_mutex());
    const ContextScope scope(impl_->context.get());
    sc_core::sc_close_vcd_trace_file(impl_->trace);
    impl_->trace = nullptr;
  }
  std::error_code error;
  if (impl_->run.failure || impl_->run.now == 0) {
    std::filesystem::remove(impl_->vcd_partial, error);
    return;
  }
  std::filesystem::rename(impl_->vcd_partial, impl_->vcd, error);
  if (!error) return;
  const std::string reason = error.message();
  std::filesystem::remove(impl_->vcd_partial, error);
  throw InputError(impl_->vcd.string() + ": cannot write the waveform: " + reason);
}

}  // namespace bitspan::timed
