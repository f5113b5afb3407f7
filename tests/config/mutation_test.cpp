// Tests hostile text: for any bytes, the loader returns a model or faults with a place. Seeded.
#include <gtest/gtest.h>

#include <random>

#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

void check(const std::string& text, const FileReader& reader, const std::string& what) {
  const auto loaded = load_text(text, "mutant.yaml", reader);
  if (loaded) {
    EXPECT_FALSE(loaded->name.empty()) << what;
    return;
  }
  ASSERT_FALSE(loaded.error().empty()) << what;
  for (const auto& fault : loaded.error()) {
    EXPECT_FALSE(fault.file.empty() || fault.what.empty()) << what;
    EXPECT_TRUE(fault.line >= 1 && fault.column >= 1) << what << '\n' << to_text(fault);
    EXPECT_EQ(to_text(fault).find('\n'), std::string::npos) << what << '\n' << to_text(fault);
  }
}

std::vector<std::filesystem::path> seeds() {
  auto files = files_of(source_dir() / "config/examples", ".yaml");
  const auto good = files_of(source_dir() / "tests/config/good", ".yaml");
  files.insert(files.end(), good.begin(), good.end());
  return files;
}

TEST(Mutation, EveryTruncationIsAModelOrAFault) {
  for (const auto& path : seeds()) {
    const auto text = slurp(path);
    const std::size_t step = std::max<std::size_t>(1, text.size() / 400);
    for (std::size_t length = 0; length < text.size(); length += step) {
      check(text.substr(0, length), within(path.parent_path()),
            path.string() + " cut at " + std::to_string(length));
    }
  }
}

TEST(Mutation, FlippedAndMovedBytesAreAModelOrAFault) {
  static constexpr std::string_view kSigns =
      "{}[]:,-&*!|>'\"%@`#?\n\t \\\0\xff~<"
      "0";
  std::mt19937 random(20240607);
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  for (const auto& path : seeds()) {
    const auto original = slurp(path);
    for (int round = 0; round < 400; ++round) {
      std::string text = original;
      for (std::size_t edits = 1 + below(4); edits > 0; --edits) {
        const std::size_t at = below(text.size());
        switch (below(4)) {
          case 0: text[at] = static_cast<char>(text[at] ^ (1 << below(8))); break;
          case 1: text[at] = kSigns[below(kSigns.size())]; break;
          case 2: text.insert(at, text.substr(below(text.size()), below(40))); break;
          default: text.erase(at, 1 + below(20)); break;
        }
        if (text.empty()) text = "x";
      }
      check(text, within(path.parent_path()), path.string() + " round " + std::to_string(round));
    }
  }
}

TEST(Mutation, MutantsOfChannelListsAndTemplatesAreAModelOrAFault) {
  const auto folder = source_dir() / "tests/config/good";
  const auto main = slurp(folder / "everything.yaml");
  const std::map<std::string, std::string> files{
      {"list.csv", slurp(folder / "list.csv")},
      {"devices/kind.yaml", slurp(folder / "devices/kind.yaml")},
      {"profile.xml", "<dds/>"}};
  std::mt19937 random(7);
  const auto below = [&](std::size_t limit) {
    return std::uniform_int_distribution<std::size_t>(0, limit - 1)(random);
  };
  for (int round = 0; round < 1500; ++round) {
    auto mutants = files;
    for (auto& [name, text] : mutants) {
      if (below(3) == 0) text.resize(below(text.size() + 1));
      if (!text.empty()) text[below(text.size())] = static_cast<char>(below(256));
    }
    check(main, texts(mutants), "round " + std::to_string(round));
  }
}

TEST(Mutation, NoiseIsAFault) {
  std::mt19937 random(1);
  for (int round = 0; round < 2000; ++round) {
    std::string text(random() % 200, '\0');
    for (char& c : text)
      c = static_cast<char>(round % 2 == 0 ? random() % 256
                                           : " \n:-[]{}&*abc,'\"|>?!%#"[random() % 22]);
    const auto loaded = load_text(text, "noise.yaml", {});
    EXPECT_FALSE(loaded) << text;
    check(text, {}, "noise round " + std::to_string(round));
  }
}

}  // namespace
}  // namespace fieldcast::config
