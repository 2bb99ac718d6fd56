// SPDX-License-Identifier: Apache-2.0
// bitspan's C library in Verilog and SystemVerilog, as system functions through VPI: for Icarus 11, which has
// no DPI-C. The functions are those of dv/dpi/bitspan_pkg.sv. bitspan_checker.sv and docs/dv.md show their
// use.
//
//   $bs_open(name, configuration, settings, engine)   model, a number; 0 after a failure
//   $bs_find(name)                                    the open model of that name, or 0
//   $bs_close(model)                                  status: 0, or $bs_last_error() says what was wrong
//   $bs_draw(model, scene, width, height)             status
//   $bs_begin(model, scene, width, height)            status
//   $bs_row(model, stage, record)                     status
//   $bs_columns(model, stage)                         -1 after a failure
//   $bs_records(model, stage)                         64 bits; -1 after a failure
//   $bs_column(model, stage, field)                   -1: no such field
//   $bs_column_of(model, stage, fields, i)            -1: no such field; -2: behind the last name
//   $bs_fetch(model, stage, i, record)                status; fills the record
//   $bs_expect(model, stage, record, present)         status; 1 where a value differs
//   $bs_matched, $bs_nontrivial, $bs_unchecked, $bs_different (model, stage)   64 bits
//   $bs_divergence(model), $bs_last_error()           a text of up to 512 bytes, for %0s
//
// A stage is a number or a name, such as "span". A record is an array of longint, one element per column or
// more.
#include <sv_vpi_user.h>
#include <vpi_user.h>

#include "../bitspan_bench.hpp"

namespace {

namespace dv = bitspan_dv;

constexpr int text_bytes = 512;

// The arguments of the call that runs. What is read behind the first wrong one is empty.
class Arguments {
 public:
  Arguments(const char* function, const char* names) : text_(std::string(function) + "(" + names + ")") {
    vpiHandle call = vpi_handle(vpiSysTfCall, nullptr);
    vpiHandle walk = vpi_iterate(vpiArgument, call);
    if (walk == nullptr) return;
    while (vpiHandle argument = vpi_scan(walk)) all_.push_back(argument);
  }

  std::int64_t integer() {
    vpiHandle argument = next();
    if (argument == nullptr) return 0;
    if (!is_vector(argument, vpi_get(vpiType, argument))) {
      fail("is no integer");
      return 0;
    }
    return value(argument);
  }

  std::string string() {
    vpiHandle argument = next();
    if (argument == nullptr) return {};
    const int type = vpi_get(vpiType, argument);
    if (type != vpiStringVar && !is_vector(argument, type)) {
      fail("is no text");
      return {};
    }
    s_vpi_value value{};
    value.format = vpiStringVal;
    vpi_get_value(argument, &value);
    return value.value.str == nullptr ? "" : value.value.str;
  }

  dv::Bench* model() {
    const std::int64_t number = integer();
    const auto& all = dv::benches();
    if (number < 1 || static_cast<std::uint64_t>(number) > all.size()) return nullptr;
    return all[static_cast<std::size_t>(number - 1)].get();
  }

  int stage() {
    if (at_ < all_.size() && is_text(all_[at_])) {
      const std::string name = string();
      const int stage = good() ? dv::stage_of(name) : -1;
      if (stage < 0) fail("is no stage: " + name);
      return stage;
    }
    const std::int64_t number = integer();
    return number < 0 || number >= dv::stage_count ? -1 : static_cast<int>(number);
  }

  // An array, its number of elements, and its elements' values.
  vpiHandle array(std::size_t& size) {
    vpiHandle argument = next();
    if (argument == nullptr) return nullptr;
    const int type = vpi_get(vpiType, argument);
    if (type != vpiMemory && type != vpiRegArray && type != vpiNetArray) {
      fail("is no array of longint");
      return nullptr;
    }
    size = static_cast<std::size_t>(vpi_get(vpiSize, argument));
    return argument;
  }

  std::vector<std::int64_t> record() {
    std::vector<std::int64_t> out;
    std::size_t size = 0;
    vpiHandle words = array(size);
    for (std::size_t i = 0; good() && i < size; ++i) {
      vpiHandle word = element(words, i);
      if (!is_vector(word, vpi_get(vpiType, word)))
        fail("is no array of longint");
      else
        out.push_back(value(word));
    }
    return out;
  }

  // Element i from the lower end of the array.
  static vpiHandle element(vpiHandle words, std::size_t i) {
    return vpi_handle_by_index(words, low(words) + static_cast<PLI_INT32>(i));
  }

  // Whether every argument was what it must be; and for whole(), that there are no more.
  bool good() const { return error_.empty(); }
  bool whole() {
    if (good() && at_ < all_.size()) {
      ++at_;
      fail("is one too many");
    }
    if (!good()) dv::failed(BS_BAD_INPUT, error_);
    return good();
  }

 private:
  static PLI_INT32 low(vpiHandle words) {
    PLI_INT32 ends[2];
    const PLI_INT32 properties[] = {vpiLeftRange, vpiRightRange};
    for (int i = 0; i < 2; ++i) {
      s_vpi_value value{};
      value.format = vpiIntVal;
      vpi_get_value(vpi_handle(properties[i], words), &value);
      ends[i] = value.value.integer;
    }
    return std::min(ends[0], ends[1]);
  }

  static bool is_text(vpiHandle argument) {
    const int type = vpi_get(vpiType, argument);
    return type == vpiStringVar || ((type == vpiConstant || type == vpiParameter) &&
                                    vpi_get(vpiConstType, argument) == vpiStringConst);
  }

  static bool is_vector(vpiHandle argument, int type) {
    switch (type) {
      case vpiConstant:
      case vpiParameter:
        return vpi_get(vpiConstType, argument) != vpiRealConst;
      case vpiRealVar:
      case vpiStringVar:
      case vpiMemory:
      case vpiRegArray:
      case vpiNetArray:
      case vpiModule:
      case vpiNamedEvent:
        return false;
      default:
        return vpi_get(vpiSize, argument) > 0;
    }
  }

  vpiHandle next() {
    if (!error_.empty()) return nullptr;
    if (at_ == all_.size()) {
      ++at_;
      fail("is missing");
      return nullptr;
    }
    return all_[at_++];
  }

  std::int64_t value(vpiHandle argument) {
    const int bits = vpi_get(vpiSize, argument);
    s_vpi_value value{};
    value.format = vpiVectorVal;
    vpi_get_value(argument, &value);
    std::uint64_t out = 0;
    for (int i = 0; i < bits; i += 32) {
      const s_vpi_vecval& word = value.value.vector[i / 32];
      const int used = std::min(bits - i, 32);
      const std::uint32_t mask = used == 32 ? ~0U : (1U << used) - 1;
      if ((static_cast<std::uint32_t>(word.bval) & mask) != 0) {
        fail("has x or z");
        return 0;
      }
      if (i < 64) out |= static_cast<std::uint64_t>(static_cast<std::uint32_t>(word.aval) & mask) << i;
    }
    if (bits < 64 && vpi_get(vpiSigned, argument) != 0 && (out >> (bits - 1) & 1U) != 0)
      out |= ~std::uint64_t{0} << bits;
    return static_cast<std::int64_t>(out);
  }

  void fail(const std::string& what) {
    if (error_.empty()) error_ = text_ + ": argument " + std::to_string(at_) + " " + what;
  }

  std::string text_, error_;
  std::vector<vpiHandle> all_;
  std::size_t at_ = 0;
};

void give(std::int64_t result) {
  s_vpi_vecval words[2] = {};
  words[0].aval = static_cast<PLI_INT32>(result & 0xffffffff);
  words[1].aval = static_cast<PLI_INT32>(result >> 32);
  s_vpi_value value{};
  value.format = vpiVectorVal;
  value.value.vector = words;
  vpi_put_value(vpi_handle(vpiSysTfCall, nullptr), &value, nullptr, vpiNoDelay);
}

void give(const std::string& text) {
  std::string copy = text.substr(0, text_bytes);
  s_vpi_value value{};
  value.format = vpiStringVal;
  value.value.str = copy.data();
  vpi_put_value(vpi_handle(vpiSysTfCall, nullptr), &value, nullptr, vpiNoDelay);
}

// The functions. One reads its arguments, and where these are good gives what the call returned.
struct Function {
  const char* name;
  const char* arguments;
  int bits;
  void (*call)(Arguments&);
};

std::int64_t number_of(const dv::Bench* bench) {
  const auto& all = dv::benches();
  for (std::size_t i = 0; i < all.size(); ++i)
    if (all[i].get() == bench) return static_cast<std::int64_t>(i + 1);
  return 0;
}

void open(Arguments& a) {
  const std::string name = a.string();
  const std::string config = a.string();
  const std::string settings = a.string();
  const std::string engine = a.string();
  give(a.whole() ? number_of(dv::open(name, config, settings, engine)) : 0);
}

void find(Arguments& a) {
  const std::string name = a.string();
  give(a.whole() ? number_of(dv::find(name)) : 0);
}

void close(Arguments& a) {
  dv::Bench* bench = a.model();
  give(a.whole() ? dv::close(bench) : BS_BAD_INPUT);
}

template <bool Draws>
void begin(Arguments& a) {
  dv::Bench* bench = a.model();
  const std::string scene = a.string();
  const auto width = static_cast<int>(a.integer());
  const auto height = static_cast<int>(a.integer());
  give(a.whole() ? dv::begin(bench, scene, width, height, Draws) : BS_BAD_INPUT);
}

void row(Arguments& a) {
  dv::Bench* bench = a.model();
  const int stage = a.stage();
  const std::vector<std::int64_t> record = a.record();
  give(a.whole() ? dv::row(bench, stage, record) : BS_BAD_INPUT);
}

template <auto Ask>
void about_stage(Arguments& a) {
  dv::Bench* bench = a.model();
  const int stage = a.stage();
  give(a.whole() ? static_cast<std::int64_t>(Ask(bench, stage)) : -1);
}

void column(Arguments& a) {
  dv::Bench* bench = a.model();
  const int stage = a.stage();
  const std::string field = a.string();
  give(a.whole() ? dv::column(bench, stage, field) : -1);
}

void column_of(Arguments& a) {
  dv::Bench* bench = a.model();
  const int stage = a.stage();
  const std::string fields = a.string();
  const auto i = static_cast<int>(a.integer());
  give(a.whole() ? dv::column_of(bench, stage, fields, i) : -1);
}

void fetch(Arguments& a) {
  dv::Bench* bench = a.model();
  const int stage = a.stage();
  const std::int64_t i = a.integer();
  std::size_t room = 0;
  vpiHandle words = a.array(room);
  if (!a.whole()) return give(BS_BAD_INPUT);
  std::vector<std::int64_t> values;
  const bs_status status = dv::fetch(bench, stage, i, room, values);
  for (std::size_t f = 0; f < values.size(); ++f) {
    s_vpi_vecval halves[2] = {};
    halves[0].aval = static_cast<PLI_INT32>(values[f] & 0xffffffff);
    halves[1].aval = static_cast<PLI_INT32>(values[f] >> 32);
    s_vpi_value value{};
    value.format = vpiVectorVal;
    value.value.vector = halves;
    vpi_put_value(Arguments::element(words, f), &value, nullptr, vpiNoDelay);
  }
  give(status);
}

void expect(Arguments& a) {
  dv::Bench* bench = a.model();
  const int stage = a.stage();
  const std::vector<std::int64_t> record = a.record();
  const auto present = static_cast<std::uint64_t>(a.integer());
  give(a.whole() ? dv::check(bench, stage, record, present) : BS_BAD_INPUT);
}

template <auto Member>
void count(Arguments& a) {
  const dv::Bench* bench = a.model();
  const int stage = a.stage();
  give(a.whole() ? static_cast<std::int64_t>(dv::counts(bench, stage).*Member) : 0);
}

void divergence(Arguments& a) {
  const dv::Bench* bench = a.model();
  give(a.whole() && bench != nullptr ? bench->first : "");
}

void last_error(Arguments&) { give(dv::error()); }

constexpr Function functions[] = {
    {"$bs_open", "name, configuration, settings, engine", 32, open},
    {"$bs_find", "name", 32, find},
    {"$bs_close", "model", 32, close},
    {"$bs_draw", "model, scene, width, height", 32, begin<true>},
    {"$bs_begin", "model, scene, width, height", 32, begin<false>},
    {"$bs_row", "model, stage, record", 32, row},
    {"$bs_columns", "model, stage", 32, about_stage<dv::columns>},
    {"$bs_records", "model, stage", 64, about_stage<dv::record_count>},
    {"$bs_column", "model, stage, field", 32, column},
    {"$bs_column_of", "model, stage, fields, i", 32, column_of},
    {"$bs_fetch", "model, stage, i, record", 32, fetch},
    {"$bs_expect", "model, stage, record, present", 32, expect},
    {"$bs_matched", "model, stage", 64, count<&dv::Counts::matched>},
    {"$bs_nontrivial", "model, stage", 64, count<&dv::Counts::nontrivial>},
    {"$bs_unchecked", "model, stage", 64, count<&dv::Counts::unchecked>},
    {"$bs_different", "model, stage", 64, count<&dv::Counts::different>},
    {"$bs_divergence", "model", 8 * text_bytes, divergence},
    {"$bs_last_error", "", 8 * text_bytes, last_error},
};

PLI_INT32 run(PLI_BYTE8* data) {
  const auto& function = *reinterpret_cast<const Function*>(data);
  Arguments arguments(function.name, function.arguments);
  function.call(arguments);
  return 0;
}

PLI_INT32 bits_of(PLI_BYTE8* data) { return reinterpret_cast<const Function*>(data)->bits; }

void registration() {
  for (const Function& function : functions) {
    s_vpi_systf_data data{};
    data.type = vpiSysFunc;
    data.sysfunctype = function.bits == 32 ? vpiIntFunc : vpiSizedSignedFunc;
    data.tfname = function.name;
    data.calltf = run;
    data.sizetf = bits_of;
    data.user_data = reinterpret_cast<PLI_BYTE8*>(const_cast<Function*>(&function));
    vpi_register_systf(&data);
  }
}

}  // namespace

extern "C" {
void (*vlog_startup_routines[])() = {registration, nullptr};
}
