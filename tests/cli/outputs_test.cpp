// SPDX-License-Identifier: Apache-2.0
// Outputs that fail, and programs that end while they write: the exit code says it, and nothing is left.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <csignal>

#include "tests/cli/program.hpp"
#include "tests/support/environment.hpp"

namespace bitspan {
namespace {

class Outputs : public Program {
 protected:
  // The exit code, or 128 + the signal that ended it. The shell's redirections come last.
  int code(const std::string& arguments, const std::string& redirections) const {
    const std::string line = "cd '" + folder.path() + "' && exec '" + build_path("cli/bitspan") + "' " +
                             arguments + " </dev/null " + redirections;
    const int status = std::system(line.c_str());
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  std::vector<std::string> names() const {
    std::vector<std::string> out;
    for (const auto& entry : std::filesystem::directory_iterator(folder.path())) {
      out.push_back(entry.path().filename().string());
    }
    std::ranges::sort(out);
    return out;
  }
};

// A pipe without reader, under a number that every shell can name.
class BrokenPipe {
 public:
  BrokenPipe() {
    int ends[2];
    if (::pipe(ends) != 0 || ::dup2(ends[1], number) != number) throw std::runtime_error("no pipe");
    ::close(ends[0]);
    ::close(ends[1]);
  }
  ~BrokenPipe() { ::close(number); }
  BrokenPipe(const BrokenPipe&) = delete;
  BrokenPipe& operator=(const BrokenPipe&) = delete;

  static constexpr int number = 9;
};

TEST_F(Outputs, ARefusalThatNobodyHearsKeepsItsCode) {
  const BrokenPipe pipe;
  for (const char* command : {"demo", "verify", "render", "explain", "sim", "fuzz", "replay", "vectors",
                              "check", "study", "make", "dut", "config", "completion", "no-such-command"}) {
    for (const char* lost : {"2>/dev/full", "2>&-", "2>&9", ">/dev/full 2>/dev/full", ">&- 2>&-"}) {
      EXPECT_EQ(code(std::string(command) + " --no-such-flag", lost), 2) << command << " " << lost;
    }
  }
}

TEST_F(Outputs, EachCodeIsKept) {
  const BrokenPipe pipe;
  stream("a.tri");
  stream("none.tri", "");
  folder.write("note.obj", "v -1 -1 0\nv 1 -1 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\np 1\n");
  const Environment cache("BITSPAN_CACHE", folder.path("cache"));
  const Environment no_tools("PATH", "/nonexistent");
  for (const char* lost : {"2>/dev/full", "2>&-", "2>&9"}) {
    EXPECT_EQ(code("render a.tri -o a.png", std::string(">out ") + lost), 0) << lost;
    EXPECT_EQ(code("render note.obj -o a.png", std::string(">out ") + lost), 0) << lost;
    EXPECT_EQ(code("verify none.tri --engines golden,model", std::string(">out ") + lost), 1) << lost;
    EXPECT_EQ(code("render missing.tri -o a.png", std::string(">out ") + lost), 2) << lost;
    EXPECT_EQ(code("render a.tri --engine rtl -o a.png", std::string(">out ") + lost), 3) << lost;
  }
}

TEST_F(Outputs, AReportThatDoesNotArriveIsNoSuccess) {
  stream("a.tri");
  for (const char* arguments :
       {"--help", "--version", "config show depth16", "render a.tri -o a.png",
        "verify a.tri --engines golden,model", "sim a.tri", "explain a.tri 5 5", "completion"}) {
    for (const char* lost : {">/dev/full", ">&-"}) {
      EXPECT_EQ(code(arguments, std::string(lost) + " 2>err"), 2) << arguments << lost;
      const std::string said = folder.read("err");
      EXPECT_TRUE(said.starts_with("bitspan: standard output: cannot write: ")) << arguments << ": " << said;
      EXPECT_EQ(std::ranges::count(said, '\n'), 1) << said;
      EXPECT_EQ(code(arguments, std::string(lost) + " 2>&-"), 2) << arguments << lost;
    }
  }
}

// A file that is opened does not take the place of a closed stream.
TEST_F(Outputs, NothingIsPrintedIntoAPicture) {
  stream("a.tri");
  ASSERT_EQ(code("render a.tri -o good.png", ">out 2>&1"), 0);
  for (const char* closed : {">&-", ">&- 2>&-", "<&- >&- 2>&-"}) {
    EXPECT_EQ(code("render a.tri -o a.png", closed), 2);
    EXPECT_EQ(folder.read("a.png"), folder.read("good.png")) << closed;
  }
}

TEST_F(Outputs, ALimitOfSizeIsARefusalThatLeavesNothing) {
  const BrokenPipe pipe;  // a file's message would meet the limit itself
  ASSERT_EQ(::fcntl(BrokenPipe::number, F_GETFD), 0);
  for (const char* arguments :
       {"render demo -o a.png", "render demo --dump d", "render demo --emit-tri d.tri -o a.png",
        "vectors demo --stage span --format hex -o v", "vectors demo --stage span --format json -o v",
        "vectors demo --stage span --format npy -o v"}) {
    const std::string line = "cd '" + folder.path() + "' && ulimit -f 8 && { '" + build_path("cli/bitspan") +
                             "' " + arguments + " 2>&1 >/dev/null; echo $?; } | cat";
    FILE* out = ::popen(line.c_str(), "r");
    ASSERT_NE(out, nullptr);
    std::string said;
    char part[512];
    while (const std::size_t n = std::fread(part, 1, sizeof part, out)) said.append(part, n);
    ::pclose(out);
    EXPECT_NE(said.find("File too large"), std::string::npos) << arguments << ": " << said;
    EXPECT_TRUE(said.ends_with("\n2\n")) << arguments << ": " << said;
    EXPECT_EQ(folder.files(), 0) << arguments;
  }
}

// A log that is written while the scene runs. The file that tries whether the place can be written comes
// first, and is empty.
TEST_F(Outputs, ASignalLeavesNothing) {
  for (const int number : {SIGHUP, SIGINT, SIGTERM, SIGQUIT}) {
    const Result r = signalled("sim demo --access-log log", number, [this] {
      return std::ranges::any_of(std::filesystem::directory_iterator(folder.path()), [](const auto& entry) {
        std::error_code gone;
        return entry.path().filename().string().starts_with(".bitspan-") && entry.file_size(gone) > 0 &&
               !gone;
      });
    });
    EXPECT_EQ(r.signal, number) << r.code;
    EXPECT_EQ(names(), std::vector<std::string>{}) << number;
  }
}

// While Verilator's runtime is compiled, for no build is in the cache. The compiler runs on for a while; the
// folder that it writes into is gone.
TEST_F(Outputs, ASignalDuringABuildLeavesNothing) {
  const TemporaryFolder cache;
  const Environment variable("BITSPAN_CACHE", cache.path());
  const Result r = signalled("render demo --engine rtl -o a.png", SIGTERM, [&] {
    return std::ranges::any_of(std::filesystem::recursive_directory_iterator(cache.path()),
                               [](const auto& entry) { return entry.path().extension() == ".log"; });
  });
  EXPECT_EQ(r.signal, SIGTERM) << r.code;
  EXPECT_EQ(cache.files(), 0);
  EXPECT_EQ(names(), std::vector<std::string>{});
}

TEST_F(Outputs, ANameOf255BytesCanBeWritten) {
  stream("a.tri");
  for (const std::size_t size : {244U, 250U, 251U, 255U}) {
    const std::string picture = std::string(size - 4, 'p') + ".png",
                      tri = std::string(size - 4, 't') + ".tri";
    const std::string dump(size, 'd');
    const Result r = run("render a.tri -o " + picture + " --emit-tri " + tri + " --dump " + dump);
    EXPECT_EQ(r.code, 0) << r.err;
    for (const std::string& made : {picture, tri, dump})
      EXPECT_TRUE(std::filesystem::remove_all(folder.path(made)) > 0) << made;
  }
  EXPECT_EQ(names(), std::vector<std::string>{"a.tri"});
  const std::string longer(256, 'x');
  refused("render a.tri -o " + longer, "cannot write: File name too long");
  refused("render a.tri --dump " + longer, "cannot write: File name too long");
}

// The pictures of a stream and the files beside a database have longer names than these.
TEST_F(Outputs, ALongNameLeavesRoomForThoseThatFollowIt) {
  for (const std::string& stem : {std::string(251, 's'), std::string(250, 's') + "t",
                                  std::string(125, 's') + "\xC3\xA4\xC3\xA4" + std::string(122, 's')}) {
    ASSERT_EQ(stem.size(), 251U);
    ASSERT_EQ(run("render demo --size 64x48 -o a.png --emit-tri " + stem + ".tri").code, 0) << stem;
    ASSERT_EQ(run("render " + stem + ".tri -o b.png").code, 0) << stem;
    EXPECT_EQ(folder.read("a.png"), folder.read("b.png"));
  }
  int pictures = 0;
  for (const std::string& name : names()) pictures += name.ends_with(".0.png") ? 1 : 0;
  EXPECT_EQ(pictures, 3) << "each stream has its own";
  refused("study --point depth16 extreme/slivers --db " + std::string(248, 'd'),
          "expected at most 247 bytes for a database");
  EXPECT_FALSE(std::filesystem::exists(folder.path(std::string(248, 'd'))));
  EXPECT_EQ(run("study --point depth16 extreme/slivers --db " + std::string(247, 'd')).code, 0);
}

TEST_F(Outputs, TwoDumpsAtOnceBothEndWell) {
  stream("a.tri");
  const std::string program = "'" + build_path("cli/bitspan") + "' ";
  const std::string both = "cd '" + folder.path() + "' && (" + program +
                           "render a.tri --dump d >one 2>&1; echo $? >>one) & cd '" + folder.path() +
                           "' && " + program + "render a.tri --dump d >two 2>&1; echo $? >>two; wait";
  for (int i = 0; i < 10; ++i) {
    std::filesystem::remove_all(folder.path("d"));
    ASSERT_EQ(std::system(both.c_str()), 0);
    EXPECT_TRUE(folder.read("one").ends_with("\n0\n")) << folder.read("one");
    EXPECT_TRUE(folder.read("two").ends_with("\n0\n")) << folder.read("two");
    EXPECT_TRUE(std::filesystem::exists(folder.path("d/run.json")));
  }
  EXPECT_EQ(names(), (std::vector<std::string>{"a.tri", "d", "one", "two"}));
}

TEST_F(Outputs, AFolderOfReplayFilesIsMade) {
  EXPECT_EQ(run("fuzz --count 1 --engines golden,model -o new/fuzz").code, 0);
  EXPECT_TRUE(std::filesystem::is_directory(folder.path("new/fuzz")));
  EXPECT_EQ(run("verify --suite 'fill.top_left/delta_f/*' --engines golden,model -o new/suites").code, 0);
  EXPECT_TRUE(std::filesystem::is_directory(folder.path("new/suites")));
  folder.write("file", "");
  refused("fuzz --count 1 --engines golden,model -o file", "file: cannot write");
  refused("verify --suite 'fill.top_left/delta_f/*' --engines golden,model -o file", "file: cannot write");
}

// What is nested too deep is refused with its line, whatever reads it.
TEST_F(Outputs, DeepTextIsRefused) {
  constexpr std::size_t deep = 200'000;
  std::string dotted = "a";
  for (std::size_t i = 1; i < deep; ++i) dotted += ".a";
  folder.write("dotted.toml", "\n" + dotted + " = 1\n");
  folder.write("header.toml", "[" + dotted + "]\n");
  folder.write("array.toml", "a = " + std::string(deep, '[') + std::string(deep, ']') + "\n");
  std::string tables;
  for (std::size_t i = 0; i < deep; ++i) tables += "{a=";
  folder.write("tables.toml", "a = " + tables + "\n");
  for (const char* name : {"dotted", "header"}) {
    const std::string at = std::string(name) + ".toml:" + (name == std::string("dotted") ? "2" : "1");
    refused(std::string("study ") + name + ".toml", at + ": a key has too many parts; expected at most 17");
    refused(std::string("config show ") + name + ".toml", at + ": a key has too many parts");
    refused(std::string("dut add ") + name + ".toml", at + ": a key has too many parts");
  }
  for (const char* name : {"array", "tables"}) {
    const std::string what = std::string(name) + ".toml:1: values are nested too deep; expected at most 64";
    refused(std::string("study ") + name + ".toml", what);
    refused(std::string("config check ") + name + ".toml", what);
  }
  folder.write("deep.json", "{\"bitspan_replay\": 1,\n\"scene\": " + std::string(deep, '['));
  refused("replay deep.json",
          "deep.json: line 2: arrays and objects are nested too deep; expected at most 64");
  std::filesystem::create_directory(folder.path("v"));
  folder.write("v/vectors.json", std::string(deep, '['));
  refused("check v", "v/vectors.json: line 1: arrays and objects are nested too deep");
}

}  // namespace
}  // namespace bitspan
