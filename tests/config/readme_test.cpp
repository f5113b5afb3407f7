#include <gtest/gtest.h>

#include "config/document/map_reader.hpp"
#include "config/keys/documents.hpp"
#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

std::string readme() { return slurp(source_dir() / "config/README.md"); }

TEST(Readme, ItsExampleLoads) {
  static constexpr std::string_view kFence = "```yaml\n";
  const auto text = readme();
  unsigned examples = 0;
  for (auto at = text.find(kFence); at != std::string::npos;
       at = text.find(kFence, at + 1), ++examples) {
    const auto start = at + kFence.size();
    const auto example = text.substr(start, text.find("```", start) - start);
    EXPECT_EQ(faults_of(load_text(example, "README.md", disk_reader(), default_options())), "");
  }
  EXPECT_GE(examples, 1u);
}

TEST(Readme, ItsTablesAreThoseOfTheKeys) {
  EXPECT_EQ(readme(), with_key_tables(readme()))
      << "cmake --build build --target documents generates them again";
}

TEST(Readme, ExplainsEveryKeyInATable) {
  const auto text = readme();
  for (const RowTable* table : key_tables()) {
    for (const auto key : table->keys) {
      bool explained = false;
      const std::string word(key);
      for (auto at = text.find("\n| "); at != std::string::npos && !explained;
           at = text.find("\n| ", at + 1)) {
        const auto row = text.substr(at, text.find('\n', at + 1) - at);
        explained = row.find('`' + word + '`') != std::string::npos ||
                    row.find("{ " + word) != std::string::npos ||
                    row.find(", " + word) != std::string::npos;
      }
      EXPECT_TRUE(explained) << table->name << ": " << key;
    }
  }
}

TEST(Readme, NamesEveryColumnOfAChannelList) {
  const auto text = readme();
  for (const auto& column : columns())
    EXPECT_NE(text.find('`' + std::string(column.name) + '`'), std::string::npos) << column.name;
}

}  // namespace
}  // namespace fieldcast::config
