#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tools/cli/text/output.hpp"

namespace fieldcast::cli {
namespace {

using testing::ElementsAre;

TEST(Width, CountsCodePoints) {
  EXPECT_EQ(display_width("21.5 °C"), 7u);
  EXPECT_EQ(clip("°C/min", 2), "°C");
  EXPECT_EQ(clip("°C", 9), "°C");
}

TEST(Printable, ControlCharactersAreShownNotObeyed) {
  EXPECT_EQ(printable("\x1b[2Jgone\n"), "\\x1B[2Jgone\\n");
  EXPECT_EQ(printable("\xC2\x9B"
                      "2J"),
            "\\u009B2J");  // U+009B is the one-character form of ESC [
  EXPECT_EQ(printable("a\u202eb\u2066"), "a\\u202Eb\\u2066") << "marks that turn the direction";
  EXPECT_EQ(printable("°C"), "°C");
}

TEST(Table, ColumnsAreAsWideAsTheirLongestCell) {
  TextTable table({{"name"}, {"value", Align::kRight}, {"unit"}});
  table.add_row({{"oil"}, {"7"}, {"°C"}});
  table.add_row({{"pressure"}, {"12.25"}, {"bar"}});
  EXPECT_THAT(table.render({}), ElementsAre("name      value  unit",  //
                                            "oil           7  °C",    //
                                            "pressure  12.25  bar"));
}

TEST(Table, IsCutAtTheScreensWidth) {
  TextTable table({{"name"}, {"value", Align::kRight}, {"unit"}});
  table.add_row({{"pressure"}, {"12.25"}, {"bar"}});
  for (std::size_t columns = 1; columns < 40; ++columns) {
    for (const auto& line : table.render({columns, 0, false}))
      EXPECT_LE(display_width(line), columns);
  }
  EXPECT_THAT(table.render({12, 0, false}), ElementsAre("name      va", "pressure  12"));
}

TEST(Table, ColoursEndInTheirCell) {
  TextTable table({{"quality"}});
  table.add_row({{"GOOD", Tone::kGood}});
  EXPECT_THAT(table.render({0, 0, true}),
              ElementsAre("\x1b[1mquality\x1b[0m", "\x1b[32mGOOD\x1b[0m"));
}

TEST(Table, MissingCellsAreEmpty) {
  TextTable table({{"a"}, {"b"}});
  table.add_row({{"x"}});
  EXPECT_THAT(table.render({}), ElementsAre("a  b", "x"));
}

}  // namespace
}  // namespace fieldcast::cli
