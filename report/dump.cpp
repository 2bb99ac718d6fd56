// SPDX-License-Identifier: Apache-2.0
#include "report/dump.hpp"

#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>
#include <system_error>

#include "io/atomic_file.hpp"
#include "io/npy.hpp"

namespace bitspan {
namespace {

namespace fs = std::filesystem;

// A folder that is removed with all it holds unless keep() was called.
class TemporaryFolder {
 public:
  explicit TemporaryFolder(const fs::path& target) {
    std::string name =
        (target.parent_path() / fmt::format(".{}.XXXXXX", target.filename().string())).string();
    if (mkdtemp(name.data()) == nullptr) {
      throw InputError(fmt::format("{}: cannot write: {}", target.string(), std::strerror(errno)));
    }
    chmod(name.c_str(), 0755);
    path_ = name;
  }
  ~TemporaryFolder() {
    if (!path_.empty()) {
      std::error_code ignored;
      fs::remove_all(path_, ignored);
    }
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return path_; }
  void keep() { path_.clear(); }

 private:
  fs::path path_;
};

constexpr std::array<std::string_view, 6> dump_files{"color.npy", "depth.npy",    "u.npy",
                                                     "v.npy",     "triangle.npy", "run.json"};

}  // namespace

std::string run_json(const Frame& frame, const Counters& counters, const Config& config,
                     const DumpInfo& info) {
  nlohmann::ordered_json json;
  json["bitspan"] = info.version;
  json["dump_format"] = 1;
  json["engine"] = info.engine;
  if (info.model) {
    json["model"] = {{"form", info.model->form}, {"threads", info.model->threads}};
    if (!info.model->target.empty()) {
      json["model"]["target"] = info.model->target;
    }
  }
  json["scene"] = info.scene;
  json["width"] = frame.width;
  json["height"] = frame.height;
  json["configuration"] = {{"name", config.name}, {"hash", config_hash(config)}, {"toml", to_toml(config)}};
  for_each_counter([&](const CounterInfo& info, auto member) {
    json["counters"][std::string(info.name)] = counters.*member;
  });
  json["wall_seconds"] = info.wall_seconds;
  return json.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
}

void write_dump(const std::string& directory, const Frame& frame, const Counters& counters,
                const Config& config, const DumpInfo& info) {
  fs::path target = fs::absolute(directory).lexically_normal();
  if (target.filename().empty()) {
    target = target.parent_path();  // a trailing slash
  }
  std::error_code error;
  const fs::file_status status = fs::status(target, error);
  if (fs::exists(status) && !fs::is_directory(status)) {
    throw InputError(fmt::format("{}: cannot write: it is not a folder", directory));
  }
  TemporaryFolder folder(target);
  const auto h = static_cast<std::size_t>(frame.height);
  const auto w = static_cast<std::size_t>(frame.width);
  const auto path = [&](std::string_view name) { return (folder.path() / name).string(); };
  write_npy(path("color.npy"), {h, w, 4}, frame.color);
  write_npy(path("depth.npy"), {h, w}, frame.depth);
  write_npy(path("u.npy"), {h, w}, frame.u);
  write_npy(path("v.npy"), {h, w}, frame.v);
  write_npy(path("triangle.npy"), {h, w}, frame.triangle);
  write_file(path("run.json"), run_json(frame, counters, config, info));

  if (!fs::exists(status)) {
    fs::rename(folder.path(), target, error);
    if (error) {
      throw InputError(fmt::format("{}: cannot write: {}", directory, error.message()));
    }
    folder.keep();
    return;
  }
  // The old run.json goes first and the new one comes last: a dump with a run.json is one whole dump.
  fs::remove(target / "run.json", error);
  for (const std::string_view name : dump_files) {
    fs::rename(folder.path() / name, target / name, error);
    if (error) {
      throw InputError(fmt::format("{}: cannot write {}: {}", directory, name, error.message()));
    }
  }
}

}  // namespace bitspan
