#include <gmock/gmock.h>

#include "tools/cli/view/station_view.hpp"

namespace fieldcast::cli {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const ProgramSessionReport kSession{
    "press-shop", "press-1",      ProgramSessionState::kOpen, "anna (10.0.0.7:51000)", 1234,
    56789,        {1'000'000'000}};

TEST(SessionsView, ShowsWhoProgramsWhatAndHowMuchWent) {
  const auto lines =
      sessions_lines({{{"press-shop", "press-1"}, kSession}}, UtcTime{2'500'000'000}, {});
  ASSERT_EQ(lines.size(), 2u);
  EXPECT_THAT(lines[1], AllOf(HasSubstr("press-shop/press-1"), HasSubstr("open"),
                              HasSubstr("anna (10.0.0.7:51000)"), HasSubstr("1234"),
                              HasSubstr("56789"), HasSubstr("1.50 s")));
}

TEST(SessionsView, SaysSoWhenThereIsNone) {
  EXPECT_THAT(sessions_lines({}, {}, {}), testing::ElementsAre("no device has been programmed"));
}

TEST(SessionsView, JsonHasTheFieldsOfTheIdl) {
  static constexpr std::string_view kLine =
      R"j({"bus":"press-shop","device":"press-1","state":"open","who":"anna (10.0.0.7:51000)",)j"
      R"("bytes_to_device":1234,"bytes_from_device":56789,"since":1000000000})";
  EXPECT_EQ(session_json(kSession).text(), kLine);
}

}  // namespace
}  // namespace fieldcast::cli
