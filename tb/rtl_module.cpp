// SPDX-License-Identifier: Apache-2.0
#include "tb/rtl_module.hpp"

#include <fmt/format.h>

namespace bitspan {
namespace {

std::string list(const char* macro, const std::vector<std::string>& ports) {
  std::string text = fmt::format("#define {}(X)", macro);
  for (const std::string& port : ports) text += fmt::format(" X({})", port);
  return text + '\n';
}

std::filesystem::path library_of(const RtlModuleDesign& design) {
  return build_library({.name = design.name,
                        .top = design.top,
                        .package = design.package,
                        .sources = design.sources,
                        .ports = fmt::format("#include \"V{0}.h\"\n#define BITSPAN_TOP V{0}\n", design.top) +
                                 list("BITSPAN_INPUTS", design.inputs) +
                                 list("BITSPAN_OUTPUTS", design.outputs),
                        .harness = "tb/rtl_module_harness.cpp",
                        .words = design.words,
                        .files = design.files});
}

}  // namespace

struct RtlModule::Library {
  explicit Library(const std::filesystem::path& path) : file(path) {
    file.load(create, "bitspan_module_create");
    file.load(destroy, "bitspan_module_destroy");
    file.load(reset, "bitspan_module_reset");
    file.load(clock, "bitspan_module_clock");
  }

  RtlLibrary file;
  void* (*create)() = nullptr;
  void (*destroy)(void*) = nullptr;
  const char* (*reset)(void*) = nullptr;
  const char* (*clock)(void*, const std::uint64_t*, std::uint64_t*) = nullptr;
};

void RtlModule::build(const RtlModuleDesign& design) { library_of(design); }

RtlModule::RtlModule(const RtlModuleDesign& design)
    : library_(std::make_unique<Library>(library_of(design))),
      handle_(library_->create(), library_->destroy) {
  reset();
}
RtlModule::~RtlModule() = default;

void RtlModule::reset() { throw_on_assertion(library_->reset(handle_.get())); }

void RtlModule::clock(std::span<const std::uint64_t> inputs, std::span<std::uint64_t> outputs) {
  throw_on_assertion(library_->clock(handle_.get(), inputs.data(), outputs.data()));
}

}  // namespace bitspan
