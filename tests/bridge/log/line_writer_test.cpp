#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "bridge/base/file_descriptor.hpp"
#include "bridge/log/log_lines.hpp"

namespace fieldcast {
namespace {

using std::chrono::milliseconds;
using std::chrono::minutes;
using std::chrono::seconds;

std::string remark(std::uint64_t lost) { return "[" + std::to_string(lost) + " lost]\n"; }

struct Pipe {
  Pipe() {
    int ends[2];
    EXPECT_EQ(::pipe2(ends, O_CLOEXEC), 0);
    read.reset(ends[0]);
    write.reset(ends[1]);
  }
  std::string receive(const std::string& end) {
    std::string all;
    char piece[65536];
    while (all.find(end) == std::string::npos) {
      const ssize_t size = ::read(read.get(), piece, sizeof piece);
      if (size <= 0) break;
      all.append(piece, static_cast<std::size_t>(size));
    }
    return all;
  }
  FileDescriptor read, write;
};

TEST(LineWriter, WritesLinesInTheirOrder) {
  Pipe pipe;
  LineWriter lines(pipe.write.get(), remark);
  lines.put("one\n");
  lines.put("two\n");
  EXPECT_TRUE(lines.flush(seconds{5}));
  EXPECT_EQ(pipe.receive("two\n"), "one\ntwo\n");
  EXPECT_EQ(lines.lost(), 0u);
}

TEST(LineWriter, WritesToTheDescriptorThatItWasGivenLast) {
  Pipe first, second;
  LineWriter lines(first.write.get(), remark);
  lines.put("one\n");
  EXPECT_TRUE(lines.flush(seconds{5}));
  lines.reopen(second.write.get());
  lines.put("two\n");
  EXPECT_EQ(first.receive("one\n"), "one\n");
  EXPECT_EQ(second.receive("two\n"), "two\n");
}

TEST(LineWriter, APipeThatNobodyReadsHoldsUpNobodyAndItsLossIsSaidWhereItIs) {
  Pipe pipe;
  LineWriter lines(pipe.write.get(), remark);
  const std::string filler(100, 'x');
  constexpr std::uint64_t kLines = 50'000;  // 5 MB; the pipe and the queue hold 1.1 MB
  for (std::uint64_t i = 0; i < kLines; ++i) lines.put(std::to_string(i) + ' ' + filler + '\n');
  EXPECT_FALSE(lines.flush(milliseconds{50}));
  EXPECT_GT(lines.lost(), kLines / 2);

  lines.put("the end\n");
  std::istringstream received(pipe.receive("the end\n"));
  std::uint64_t told = 0, whole = 0;
  for (std::string line; std::getline(received, line);) {
    if (line.starts_with('[')) {
      told += std::stoull(line.substr(1));
    } else if (line != "the end") {
      ++whole;
      EXPECT_EQ(line, std::to_string(told + whole - 1) + ' ' + filler) << "a remark is missing";
    }
  }
  EXPECT_EQ(told, lines.lost());
  EXPECT_EQ(whole, kLines - lines.lost());
  EXPECT_TRUE(lines.flush(seconds{5}));
}

TEST(LineWriter, EndsWhileThePipeIsFull) {
  Pipe pipe;
  const auto begun = std::chrono::steady_clock::now();
  {
    LineWriter lines(pipe.write.get(), remark);
    for (int i = 0; i < 10'000; ++i) lines.put(std::string(100, 'x') + '\n');
  }
  EXPECT_LT(std::chrono::steady_clock::now() - begun, seconds{2});
}

TEST(LineWriter, AClosedPipeLosesLinesAndNothingElse) {
  ::signal(SIGPIPE, SIG_IGN);
  Pipe pipe;
  LineWriter lines(pipe.write.get(), remark);
  pipe.read.reset();
  lines.put("nobody receives this\n");
  EXPECT_TRUE(lines.flush(seconds{5}));
  EXPECT_EQ(lines.lost(), 1u);
}

TEST(LineWriter, WithoutADescriptorLinesAreLost) {
  LineWriter lines(-1, remark);
  lines.put("nowhere\n");
  EXPECT_TRUE(lines.flush(seconds{5}));
  EXPECT_EQ(lines.lost(), 1u);
}

TEST(LineWriter, AFileThatIsFullAndHasRoomAgain) {
  ::signal(SIGXFSZ, SIG_IGN);
  const auto path =
      std::filesystem::path(testing::TempDir()) / ("fieldcast-lines-" + std::to_string(::getpid()));
  const FileDescriptor file(::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600));
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  LineWriter lines(file.get(), remark);
  const rlimit small{10, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  lines.put("123456789\n");
  EXPECT_TRUE(lines.flush(seconds{5}));
  lines.put("too much\n");
  lines.put("too much\n");
  EXPECT_TRUE(lines.flush(seconds{5}));
  EXPECT_EQ(lines.lost(), 2u);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  lines.put("room again\n");
  EXPECT_TRUE(lines.flush(seconds{5}));
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_EQ(text.str(), "123456789\n[2 lost]\nroom again\n");
  std::filesystem::remove(path);
}

const Instant kStart{std::chrono::hours{1}};

unsigned lines_of(LineBudget& budget, unsigned occurrences, const std::string& kind, Instant now) {
  unsigned lines = 0;
  for (unsigned i = 0; i < occurrences; ++i) lines += budget.occurred(kind, now).log ? 1 : 0;
  return lines;
}

TEST(LineBudget, TheFirstLinesOfAKindAreWrittenTheRestIsCounted) {
  LineBudget budget;
  EXPECT_EQ(lines_of(budget, 30'000, "a", kStart), LineBudget::kLines);
  EXPECT_TRUE(budget.summaries(kStart + minutes{9}).empty());
  const auto summaries = budget.summaries(kStart + minutes{10});
  ASSERT_EQ(summaries.size(), 1u);
  EXPECT_EQ(summaries[0].key, "a");
  EXPECT_EQ(summaries[0].suppressed, 30'000 - LineBudget::kLines);
  EXPECT_TRUE(budget.summaries(kStart + minutes{11}).empty());
}

TEST(LineBudget, TheNextLineOfAKindSaysWhatWasCounted) {
  LineBudget budget;
  lines_of(budget, LineBudget::kLines + 5, "a", kStart);
  const auto verdict = budget.occurred("a", kStart + minutes{10});
  EXPECT_TRUE(verdict.log);
  EXPECT_EQ(verdict.suppressed, 5u);
}

TEST(LineBudget, KindsDoNotTakeEachOthersLines) {
  LineBudget budget;
  lines_of(budget, 100, "a", kStart);
  EXPECT_TRUE(budget.occurred("b", kStart).log);
}

TEST(LineBudget, MoreKindsThanItKnowsShareOneBudget) {
  LineBudget budget;
  unsigned lines = 0;
  for (unsigned i = 0; i < 10'000; ++i)
    lines += budget.occurred("kind " + std::to_string(i), kStart + seconds{i % 60}).log ? 1 : 0;
  EXPECT_EQ(lines, LineBudget::kMaxKinds + LineBudget::kLines);
}

TEST(LineBudget, AKindWhosePeriodHasEndedMakesRoomForANewOne) {
  LineBudget budget;
  for (unsigned i = 0; i < LineBudget::kMaxKinds; ++i)
    lines_of(budget, LineBudget::kLines + 1, "module " + std::to_string(i), kStart);
  EXPECT_EQ(lines_of(budget, 100, "full", kStart), LineBudget::kLines);
  // What was counted is not lost.
  EXPECT_EQ(lines_of(budget, 100, "full", kStart + minutes{1}), 0u);
  EXPECT_EQ(budget.summaries(kStart + minutes{10}).size(), LineBudget::kMaxKinds + 1u);
  for (const auto* kind : {"logins refused", "interests refused"})
    EXPECT_EQ(lines_of(budget, 100, kind, kStart + minutes{20}), LineBudget::kLines) << kind;
}

}  // namespace
}  // namespace fieldcast
