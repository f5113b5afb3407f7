#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <ostream>

#include "tools/cli/terminal/gzip_file.hpp"
#include "tools/progress/progress_line.hpp"

namespace fieldcast::cli {
namespace {

using namespace std::chrono_literals;
namespace fs = std::filesystem;

std::string wide(const ProgressText& text) { return progress_line_text(text, 200); }

TEST(ProgressText, SaysHowMuchIsDoneAndHowLongTheRestTakes) {
  EXPECT_EQ(wide(progress_text("simulating line", 0, 1s)), "simulating line: 0 %");
  EXPECT_EQ(wide(progress_text("simulating line", 0.25, 10s)), "simulating line: 25 %, 30s left");
  EXPECT_EQ(wide(progress_text("simulating line", 0.5, 50ms)), "simulating line: 50 %");
  EXPECT_EQ(wide(progress_text("simulating line", 7, 1s)), "simulating line: 100 %, 0s left");
  EXPECT_EQ(wide(progress_text("simulating line", 1e-12, 10s)), "simulating line: 0 %")
      << "a guess of years is none";
}

TEST(ProgressText, OnANarrowTerminalHowFarItIsStays) {
  const ProgressText text = progress_text("simulating boiler-house", 0.25, 10s);
  EXPECT_EQ(progress_line_text(text, 40), "simulating boiler-house: 25 %, 30s left");
  EXPECT_EQ(progress_line_text(text, 24), "simulat~: 25 %, 30s left");
  EXPECT_EQ(progress_line_text(text, 19), "25 %, 30s left");
  EXPECT_EQ(progress_line_text(text, 6), "25 %, ");
  EXPECT_EQ(progress_line_text({"\x1b[2Jbus", "1 %"}, 40), "\\x1B[2Jbus: 1 %") << "of others";
}

class GzipFileTest : public testing::Test {
 protected:
  GzipFileTest() { fs::create_directories(folder_); }
  ~GzipFileTest() override { fs::remove_all(folder_); }
  [[nodiscard]] bool is_empty() const { return fs::is_empty(folder_); }

  const fs::path folder_ =
      fs::temp_directory_path() / ("fieldcast-gzip-" + std::to_string(::getpid()));
};

TEST_F(GzipFileTest, HasNoNameUntilItIsWhole) {
  {
    GzipFile file(folder_ / "half.gz");
    std::ostream(&file) << std::string(1 << 20, 'x') << std::flush;
    EXPECT_TRUE(is_empty());
  }
  EXPECT_TRUE(is_empty()) << "nothing half written is left";
  GzipFile file(folder_ / "whole.gz");
  std::ostream(&file) << "text" << std::flush;
  EXPECT_EQ(file.close(), std::nullopt);
  EXPECT_TRUE(fs::exists(folder_ / "whole.gz"));
}

TEST_F(GzipFileTest, LeavesAFileThatIsThereAlone) {
  for (int i = 0; i < 2; ++i) {
    GzipFile file(folder_ / "one.gz");
    std::ostream(&file) << "text" << std::flush;
    EXPECT_EQ(file.close().has_value(), i == 1);
  }
}

}  // namespace
}  // namespace fieldcast::cli
