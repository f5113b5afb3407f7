#pragma once

#include <gtest/gtest.h>

#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>

namespace fieldcast::test {

// Splits "INPUT -> EXPECTED".
inline std::pair<std::string, std::string> text_case(std::string_view text) {
  static constexpr std::string_view kArrow = " -> ";
  const auto at = text.find(kArrow);
  if (at == std::string_view::npos) {
    ADD_FAILURE() << "no arrow in '" << text << "'";
    return {std::string(text), ""};
  }
  return {std::string(text.substr(0, at)), std::string(text.substr(at + kArrow.size()))};
}

// Expects that `function` returns EXPECTED for the INPUT of each "INPUT -> EXPECTED".
template <typename Function>
void expect_texts(Function function, std::initializer_list<std::string_view> cases) {
  for (const std::string_view text : cases) {
    const auto [input, expected] = text_case(text);
    EXPECT_EQ(function(input), expected) << text;
  }
}

}  // namespace fieldcast::test
