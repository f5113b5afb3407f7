// Included before every source of a tree with mutants (mutate.py): switches one of them on, and
// records which of them each test evaluates.
#pragma once

#include <cstdio>
#include <cstdlib>

inline const int fc_current = [] {
  const char* text = std::getenv("FIELDCAST_MUTANT");
  return text == nullptr ? 0 : std::atoi(text);
}();
inline bool fc_reached[65536] = {};

constexpr bool fc_mutant(int number) {
  if (__builtin_is_constant_evaluated()) return false;
  fc_reached[number] = true;
  return fc_current == number;
}

#ifdef GTEST_HAS_PTHREAD  // sources of tests
#include <gtest/gtest.h>

#include <string>

// Appends a line for each test to the file that FIELDCAST_REACHED names: its name (* before the
// first test), milliseconds, mutants.
class FcRecorder : public testing::EmptyTestEventListener {
 public:
  void OnTestProgramStart(const testing::UnitTest&) override { write("*", 0); }
  void OnTestEnd(const testing::TestInfo& test) override {
    write(std::string(test.test_suite_name()) + "." + test.name(), test.result()->elapsed_time());
  }

 private:
  static void write(const std::string& name, long milliseconds) {
    std::FILE* file = std::fopen(std::getenv("FIELDCAST_REACHED"), "a");
    if (file == nullptr) std::abort();
    std::fprintf(file, "%s %ld", name.c_str(), milliseconds);
    for (int number = 0; number < 65536; ++number) {
      if (fc_reached[number]) std::fprintf(file, " %d", number);
      fc_reached[number] = false;
    }
    std::fputs("\n", file);
    std::fclose(file);
  }
};
inline const bool fc_recording = [] {
  if (std::getenv("FIELDCAST_REACHED") != nullptr)
    testing::UnitTest::GetInstance()->listeners().Append(new FcRecorder);
  return true;
}();
#endif
