// SPDX-License-Identifier: Apache-2.0
#include "tb/rtl_build.hpp"

#include <dlfcn.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <limits>
#include <mutex>
#include <numeric>
#include <sstream>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "config/fnv.hpp"
#include "config/rtl_timing.hpp"
#include "engine/emit_sv.hpp"
#include "io/data_folder.hpp"
#include "io/message.hpp"
#include "tb/programs.hpp"
#include "tb/rtl_coverage.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

const std::vector<std::string> verilator_flags = {"--cc",   "--assert",        "-Wall",   "-Wno-fatal",
                                                  "-O3",    "--x-assign",      "fast",    "--x-initial",
                                                  "unique", "--max-num-width", "1048576", "--top-module"};
const std::vector<std::string> plain_compiler_flags = {"-std=c++17",
                                                       "-O1",
                                                       "-fPIC",
                                                       "-fvisibility=hidden",
                                                       "-fno-gnu-unique",
                                                       "-w",
                                                       "-DVL_USER_STOP",
                                                       "-DVL_USER_FATAL",
                                                       "-DVL_USER_FINISH",
                                                       "-DVL_TIME_CONTEXT",
                                                       "-DVL_PRINTF=bitspan_rtl_printf"};

constexpr std::string_view cache_hint = "BITSPAN_CACHE names the cache folder";

std::vector<std::string> compiler_flags() {
  std::vector<std::string> flags = plain_compiler_flags;
  // What counts is as much text as ten designs, and runs once.
  if (coverage_wanted()) flags.insert(flags.end(), {"-O0", "-DVM_COVERAGE=1"});
  return flags;
}

std::string compiler() {
  std::string cxx = environment("CXX");
  return cxx.empty() ? "c++" : cxx;
}

// The first line of a log that tells what went wrong.
std::string first_complaint(const fs::path& log) {
  std::ifstream in(log);
  std::string first;
  for (std::string line; std::getline(in, line);) {
    if (line.find("rror") != std::string::npos || line.starts_with("%Warning")) return line;
    if (first.empty()) first = line;
  }
  return first;
}

// Inside the cache, gone when the build is over, unless it is kept for its log.
ScratchFolder build_folder(const fs::path& cache) { return {cache, "build", cache_hint}; }

void run_or_throw(ScratchFolder& scratch, const std::vector<std::string>& command, const std::string& what,
                  bool users_sources = false) {
  const fs::path log = scratch.path() / (what + ".log");
  if (run_program(command, log, "the rtl engine") == 0) return;
  scratch.keep();
  const std::string text = fmt::format("{} refused the RTL of this configuration: {} (all of it in {})",
                                       command.front(), first_complaint(log), log.string());
  // Sources that the user named may be at fault; those that belong to this program are not the user's.
  if (users_sources || (what == "verilator" && !environment("BITSPAN_ROOT").empty())) throw InputError(text);
  throw ToolError(text);
}

// Moves a finished file to its place; another process may have put the same one there.
void publish(const fs::path& made, const fs::path& place) {
  std::error_code error;
  fs::rename(made, place, error);
  if (error) throw InputError(fmt::format("{}: cannot be written ({})", place.string(), error.message()));
}

std::string verilator_include() {
  std::string root = environment("VERILATOR_ROOT");
  return (root.empty() ? std::string("/usr/share/verilator") : root) + "/include";
}

std::vector<std::string> compile_command(const fs::path& root) {
  std::vector<std::string> command = {compiler()};
  const std::vector<std::string> flags = compiler_flags();
  command.insert(command.end(), flags.begin(), flags.end());
  command.insert(command.end(),
                 {"-include", (root / "tb/rtl_printf.hpp").string(), "-I" + verilator_include(),
                  "-I" + verilator_include() + "/vltstd", "-I" + (root / "tb").string()});
  return command;
}

// Verilator's own runtime, compiled once for every configuration.
std::vector<fs::path> build_runtime(const fs::path& cache, const fs::path& root,
                                    const std::string& flags_text) {
  static std::mutex mutex;  // the second of two builds finds what the first one compiled
  const std::lock_guard lock(mutex);
  std::vector<fs::path> objects;
  std::vector<std::string> parts = {"verilated", "verilated_threads"};
  if (coverage_wanted()) parts.emplace_back("verilated_cov");
  for (const std::string& part : parts) {
    const fs::path source = fs::path(verilator_include()) / (part + ".cpp");
    if (!fs::exists(source)) {
      throw ToolError(
          fmt::format("{}: not found; the rtl engine needs Verilator (VERILATOR_ROOT names its folder)",
                      source.string()));
    }
    Fnv128 key;
    key.text(flags_text);
    key.text(read_text(source, data_folder_hint));
    const fs::path object = cache / fmt::format("{}-{}.o", part, key.hex());
    if (!fs::exists(object)) {
      ScratchFolder scratch = build_folder(cache);
      const fs::path made = scratch.path() / "runtime.o";
      std::vector<std::string> command = compile_command(root);
      command.insert(command.end(), {"-c", source.string(), "-o", made.string()});
      run_or_throw(scratch, command, "compile");
      publish(made, object);
    }
    objects.push_back(object);
  }
  return objects;
}

// Keeps the cache small: libraries unused for an hour go when there are too many, the longest unused first,
// and so do folders of builds that were killed.
void prune(const fs::path& cache) {
  constexpr std::size_t kept_libraries = 256;
  const auto now = fs::file_time_type::clock::now();
  std::error_code ignored;
  std::vector<std::pair<fs::file_time_type, fs::path>> libraries;
  for (const fs::directory_entry& entry : fs::directory_iterator(cache, ignored)) {
    const auto used = entry.last_write_time(ignored);
    if (ignored) continue;  // gone meanwhile
    const std::string name = entry.path().filename().string();
    if (name.starts_with("build-") && now - used > std::chrono::hours(24))
      fs::remove_all(entry.path(), ignored);
    if (name.starts_with("rtl-")) libraries.emplace_back(used, entry.path());
  }
  if (libraries.size() <= kept_libraries) return;
  std::sort(libraries.begin(), libraries.end());
  libraries.resize(libraries.size() - kept_libraries);
  for (const auto& [used, path] : libraries) {
    if (now - used > std::chrono::hours(1)) fs::remove(path, ignored);
  }
}

// A line on a terminal while builds run; those of one configuration run side by side.
class Progress {
 public:
  explicit Progress(const std::string& name) {
    if (::isatty(STDERR_FILENO) == 0) return;
    const std::lock_guard lock(mutex_);
    if (builds_++ > 0) return;
    say("building the RTL of " + (name.empty() ? "this configuration" : name) + " ...");
  }
  ~Progress() {
    const std::lock_guard lock(mutex_);
    if (builds_ > 0 && --builds_ == 0) say("\r\033[K");
  }
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

 private:
  static inline std::mutex mutex_;
  static inline int builds_ = 0;  // those that the line stands for
};

}  // namespace

const std::vector<std::string>& verilator_safe_flags() {
  // Verilator 5.006 miscompiles some trees of XOR without it.
  static const std::vector<std::string> flags = {"-fno-const-bit-op-tree"};
  return flags;
}

fs::path rtl_cache_folder() {
  if (const std::string cache = environment("BITSPAN_CACHE"); !cache.empty()) return fs::absolute(cache);
  if (const std::string cache = environment("XDG_CACHE_HOME"); !cache.empty())
    return fs::path(cache) / "bitspan";
  if (const std::string home = environment("HOME"); !home.empty()) return fs::path(home) / ".cache/bitspan";
  return fs::temp_directory_path() / fmt::format("bitspan-{}", ::getuid());
}

fs::path build_library(const RtlDesign& design) {
  const fs::path root = data_folder();
  const fs::path cache = rtl_cache_folder();

  Fnv128 key;
  std::string flags_text = compiler() + ' ' + verilator_include();
  for (const std::string& flag : compiler_flags()) flags_text += ' ' + flag;
  key.text(flags_text);
  std::vector<std::string> verilator = {"verilator"};
  verilator.insert(verilator.end(), verilator_safe_flags().begin(), verilator_safe_flags().end());
  verilator.insert(verilator.end(), verilator_flags.begin(), verilator_flags.end());
  verilator.push_back(design.top);
  std::string covers;
  if (coverage_wanted()) {
    verilator.insert(verilator.end(), coverage_flags().begin(), coverage_flags().end());
    std::vector<std::string> texts;
    for (const fs::path& source : design.sources) texts.push_back(read_text(source, data_folder_hint));
    covers = handshake_covers(texts);
    key.text(covers);
  }
  for (const std::string& flag : verilator) key.text(flag);
  key.text(without_comments(design.package));
  for (const fs::path& source : design.sources) key.text(read_text(source, data_folder_hint));
  for (const std::string& word : design.words) key.text(word);
  for (const fs::path& file : design.files) key.text(read_text(file));
  key.text(design.ports);
  for (const std::string& part : {design.harness, std::string("tb/rtl_abi.hpp"),
                                  std::string("tb/rtl_harness.hpp"), std::string("tb/rtl_printf.hpp")})
    key.text(read_text(root / part, data_folder_hint));
  fs::path library = cache / fmt::format("rtl-{}.so", key.hex());
  std::error_code missing;
  fs::last_write_time(library, fs::file_time_type::clock::now(), missing);  // used now
  if (!missing || fs::exists(library)) return library;

  const Progress progress(design.name);
  const std::vector<fs::path> runtime = build_runtime(cache, root, flags_text);
  ScratchFolder scratch = build_folder(cache);
  const fs::path package_path = scratch.path() / "package.sv";
  const fs::path verilated = scratch.path() / "verilated";
  write_text(package_path, design.package, cache_hint);
  std::vector<std::string> command = verilator;
  command.insert(command.end(), {"--Mdir", verilated.string(), package_path.string()});
  for (const fs::path& source : design.sources) command.push_back(source.string());
  command.insert(command.end(), design.words.begin(), design.words.end());
  if (!covers.empty()) {
    const fs::path covers_path = scratch.path() / "handshakes.sv";
    write_text(covers_path, covers, cache_hint);
    command.push_back(covers_path.string());
  }
  run_or_throw(scratch, command, "verilator", !design.words.empty());

  // One translation unit: most of a small one's time goes into the headers. Counters make it so large that
  // the compiler takes all memory: then several.
  const std::uintmax_t unit_bytes =
      coverage_wanted() ? 1'500'000 : std::numeric_limits<std::uintmax_t>::max();
  std::string all = design.ports + fmt::format("#include \"{}\"\n", (root / design.harness).string());
  std::vector<std::string> parts;
  for (const fs::directory_entry& entry : fs::directory_iterator(verilated)) {
    if (entry.path().extension() == ".cpp") parts.push_back(entry.path().filename().string());
  }
  std::sort(parts.begin(), parts.end());
  command = compile_command(root);
  std::uintmax_t bytes = 0;
  int units = 0;
  const auto write_unit = [&] {
    const fs::path unit = verilated / fmt::format("all{}.cpp", units++);
    write_text(unit, std::exchange(all, ""), cache_hint);
    command.push_back(unit.string());
    bytes = 0;
  };
  for (const std::string& part : parts) {
    all += fmt::format("#include \"{}\"\n", part);
    bytes += fs::file_size(verilated / part);
    if (bytes > unit_bytes) write_unit();
  }
  if (!all.empty()) write_unit();
  const fs::path made = scratch.path() / "rtl.so";
  command.insert(command.end(), {"-I" + verilated.string(), "-shared"});
  for (const fs::path& object : runtime) command.push_back(object.string());
  command.insert(command.end(), {"-o", made.string(), "-lpthread"});
  run_or_throw(scratch, command, "compile");
  publish(made, library);
  prune(cache);
  return library;
}

fs::path build_rtl(const Config& config) {
  return build_library({.name = config.name,
                        .top = "span_interpolator",
                        .package = emit_sv(config),
                        .sources = rtl_sources(),
                        .ports = "",
                        .harness = "tb/rtl_harness.cpp"});
}

RtlLibrary::RtlLibrary(const fs::path& path) : handle_(::dlopen(path.c_str(), RTLD_NOW | RTLD_LOCAL)) {
  if (handle_ == nullptr) throw ToolError(fmt::format("{}: {}", path.string(), ::dlerror()));
}
RtlLibrary::~RtlLibrary() { ::dlclose(handle_); }
void* RtlLibrary::symbol(const char* name) const {
  void* found = ::dlsym(handle_, name);
  if (found == nullptr)
    throw ToolError(fmt::format("the RTL library has no {}; empty the cache folder", name));
  return found;
}

struct Rtl::Library {
  explicit Library(const fs::path& path) : file(path) {
    file.load(create, "bitspan_rtl_create");
    file.load(destroy, "bitspan_rtl_destroy");
    file.load(reset, "bitspan_rtl_reset");
    file.load(clock, "bitspan_rtl_clock");
  }

  RtlLibrary file;
  RtlCreate create = nullptr;
  RtlDestroy destroy = nullptr;
  RtlReset reset = nullptr;
  RtlClock clock = nullptr;
};

void throw_on_assertion(const char* failed) {
  if (failed != nullptr) throw std::logic_error(fmt::format("assertion in the RTL: {}", failed));
}

Rtl::Rtl(const Config& config, int initial_seed)
    : library_(std::make_shared<Library>(build_rtl(config))),
      handle_(library_->create(initial_seed), library_->destroy) {
  const RtlTiming timing = rtl_timing(config);
  // What is left in span_setup, the FIFO, span and the buffer at its output. Whole intervals of rows and of
  // pixels: both stages are then where they would be without these clocks.
  const int interval = std::lcm(timing.row.interval, timing.pixel_interval);
  const int left = timing.row.latency + timing.row.interval + 1 + timing.pixel_interval + timing.span + 2;
  clocks_until_empty_ = (left + interval - 1) / interval * interval;
  reset();
}
Rtl::~Rtl() = default;
Rtl::Rtl(Rtl&&) noexcept = default;
Rtl& Rtl::operator=(Rtl&& other) noexcept {
  handle_ = std::move(other.handle_);  // first: what it held is destroyed by the library it came from
  library_ = std::move(other.library_);
  clocks_until_empty_ = other.clocks_until_empty_;
  return *this;
}

void Rtl::reset() { throw_on_assertion(library_->reset(handle_.get())); }

void Rtl::clock(const RtlDrive& drive, RtlSample& sample) {
  throw_on_assertion(library_->clock(handle_.get(), &drive, &sample));
}

std::uint64_t Rtl::to_port(std::int64_t raw, int width) {
  const auto bits = static_cast<std::uint64_t>(raw);
  return width >= 64 ? bits : bits & ((std::uint64_t{1} << width) - 1);
}

std::int64_t Rtl::from_port(std::uint64_t bits, const Format& format) {
  if (!format.is_signed || format.word >= 64) return static_cast<std::int64_t>(bits);
  const std::uint64_t sign = std::uint64_t{1} << (format.word - 1);
  return static_cast<std::int64_t>((bits ^ sign) - sign);
}

void Rtl::put(RtlShades& port, std::size_t at, std::int64_t raw, int width) {
  const std::uint64_t bits = to_port(raw, width);
  const std::size_t shift = at % 64;
  port.words[at / 64] |= bits << shift;
  if (shift + static_cast<std::size_t>(width) > 64) port.words[at / 64 + 1] |= bits >> (64 - shift);
}

std::int64_t Rtl::get(const RtlShades& port, std::size_t at, const Format& format) {
  const std::size_t shift = at % 64;
  std::uint64_t bits = port.words[at / 64] >> shift;
  if (shift + static_cast<std::size_t>(format.word) > 64) bits |= port.words[at / 64 + 1] << (64 - shift);
  return from_port(to_port(static_cast<std::int64_t>(bits), format.word), format);
}

RtlShades Rtl::to_port(const Shades& raw, int width) {
  RtlShades port{};
  for (std::size_t i = 0; i < raw.size(); ++i) put(port, i * static_cast<std::size_t>(width), raw[i], width);
  return port;
}

Rtl::Shades Rtl::from_port(const RtlShades& port, const Format& format) {
  Shades raw{};
  for (std::size_t i = 0; i < raw.size(); ++i) {
    raw[i] = get(port, i * static_cast<std::size_t>(format.word), format);
  }
  return raw;
}

}  // namespace bitspan
