#include "config/calculate/expression.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "config/document/limits.hpp"

namespace fieldcast::config {
namespace {

// The result for inputs 2, 3, 5, ... in the order of their first use.
double value_of(const std::string& text) {
  const auto parsed = parse_expression(text);
  if (!parsed) {
    ADD_FAILURE() << text << ": " << parsed.error().what;
    return NAN;
  }
  const auto formula = compile(*parsed);
  if (!formula) {
    ADD_FAILURE() << text << ": " << formula.error().what;
    return NAN;
  }
  static constexpr double kValues[]{2, 3, 5, 7};
  return (*formula)(std::span(kValues).first(parsed->names.size()));
}

std::string fault_of(const std::string& text) {
  const auto parsed = parse_expression(text);
  const auto describe = [](const ExpressionFault& fault) {
    return std::to_string(fault.at) + ": " + fault.what;
  };
  if (!parsed) return describe(parsed.error());
  const auto formula = compile(*parsed);
  return formula ? "" : describe(formula.error());
}

TEST(Expression, HasTheUsualOperatorsAndPrecedence) {
  EXPECT_EQ(value_of("a * b"), 6);
  EXPECT_EQ(value_of("a + b * 2"), 8);
  EXPECT_EQ(value_of("(a + b) * 2"), 10);
  EXPECT_EQ(value_of("-a ^ 2 + 1e1"), -4 + 10);
  EXPECT_EQ(value_of("a < b && b >= 3"), 1);
  EXPECT_EQ(value_of("a == b || a != 2"), 0);
  EXPECT_EQ(value_of("a / b"), 2.0 / 3);
}

TEST(Expression, HasFunctionsOfItsList) {
  EXPECT_EQ(value_of("max(a, b, 10) - min(a, b)"), 8);
  EXPECT_EQ(value_of("mean(a, b, c) * 3 - sum(a, b, c)"), 0);
  EXPECT_EQ(value_of("if(a > b, 1, sqrt(b + 1))"), 2);
  EXPECT_EQ(value_of("not(a) + round(2.6) + abs(0 - b)"), 6);
  EXPECT_NEAR(value_of("atan2(a, a) * 4"), M_PI, 1e-12);
}

TEST(Expression, ABlankMayFollowAFunction) {
  EXPECT_EQ(value_of("max (a, b) + min  (a, b)"), 5);
  EXPECT_EQ(value_of("if (a > b, 1, {max} + max (1, 2))"), 7);
}

TEST(Expression, AComparisonIsNotCompared) {
  EXPECT_EQ(fault_of("10 < a < 80"), "7: a comparison of a comparison");
  EXPECT_EQ(fault_of("a < b == c < d"), "6: a comparison of a comparison");
  EXPECT_EQ(fault_of("a <= b + 1 >= c"), "11: a comparison of a comparison");
  EXPECT_EQ(fault_of("(a < b) + max(a < b, b > c != a)"), "27: a comparison of a comparison");
  EXPECT_EQ(value_of("1 < a && a < 80 || a == b"), 1);
  EXPECT_EQ(value_of("(a < b) == (b < c)"), 1);
  EXPECT_EQ(value_of("max(a > b, b > a) != 0"), 1);
}

TEST(Expression, AnArgumentThatIsNoNumberIsTheResult) {
  for (const char* text : {"max(0, (a - a) / (b - b))", "max((a - a) / (b - b), 0)",
                           "min(0, (a - a) / (b - b))", "min((a - a) / (b - b), 0)"})
    EXPECT_TRUE(std::isnan(value_of(text))) << text;
}

TEST(Expression, ABracedNameMayHaveEveryCharacterOfAName) {
  const auto parsed = parse_expression("{oil-temp.1}+x + {line-2/meter/u}*x");
  ASSERT_TRUE(parsed);
  ASSERT_EQ(parsed->names.size(), 3u);
  EXPECT_EQ(parsed->names[0].text, "oil-temp.1");
  EXPECT_EQ(parsed->names[1].text, "x");
  EXPECT_EQ(parsed->names[2].text, "line-2/meter/u");
  EXPECT_EQ(parsed->names[2].at, 17u);
  EXPECT_EQ(parsed->code.size(), std::string("{oil-temp.1}+x + {line-2/meter/u}*x").size());
  EXPECT_EQ(value_of("{oil-temp.1}+x + {line-2/meter/u}*x"), 2 + 3 + 5 * 3);
  EXPECT_EQ(value_of("{min} * min({min}, 1) + {a} - a"), 2);
}

TEST(Expression, AFaultSaysAtWhichByteAndWhat) {
  EXPECT_EQ(fault_of(""), "0: an empty expression");
  EXPECT_EQ(fault_of("1 + 2"), "0: an expression without a channel");
  EXPECT_EQ(fault_of("a = 3"), "2: '=' would be an assignment");
  EXPECT_EQ(fault_of("a ; b"), "2: character ';'");
  EXPECT_EQ(fault_of("a + \"text\""), "4: character '\"'");
  EXPECT_EQ(fault_of("a + ü"), "4: character 'ü'");
  EXPECT_EQ(fault_of("a + 12v"), "4: '12v' is not a number");
  EXPECT_EQ(fault_of("a + system(1)"), "4: unknown function 'system'");
  EXPECT_EQ(fault_of("a + min"), "4: function 'min' without brackets");
  EXPECT_EQ(fault_of("a + {b"), "4: '{' without '}'");
  EXPECT_EQ(fault_of("a + "), "4: the expression ends too early");
  EXPECT_EQ(fault_of("(a + b"), "6: ')' is missing");
  EXPECT_EQ(fault_of("a, b"), "0: ',' outside of a function");
  EXPECT_EQ(fault_of("a ? b : c"), "2: character '?'");
  EXPECT_NE(fault_of("a b"), "");
  EXPECT_NE(fault_of("sqrt(a, b)"), "");
  EXPECT_NE(fault_of("if(a)"), "");
  EXPECT_NE(fault_of("max()+a"), "");
  EXPECT_NE(fault_of("a + )"), "");
}

TEST(Expression, AFaultSaysWhatIsAllowed) {
  const auto allowed = [](const char* text) {
    const auto expression = parse_expression(text);
    return expression ? compile(*expression).error().allowed : expression.error().allowed;
  };
  EXPECT_NE(allowed("if(a)").find("if(condition, then, else)"), std::string::npos);
  EXPECT_NE(allowed("sqrt(a, b)").find("one of every other function"), std::string::npos);
  EXPECT_NE(allowed("a + * b").find("the name of a channel"), std::string::npos);
}

TEST(Expression, LengthOfNamesAndNestingAreBounded) {
  std::string names;
  for (std::size_t i = 0; i <= kMaxInputs; ++i) names += (i == 0 ? "" : "+c") + std::to_string(i);
  names = "c" + names;
  EXPECT_NE(fault_of(names).find("too many channels"), std::string::npos);
  const std::string deep(kMaxBracketDepth + 1, '(');
  EXPECT_NE(fault_of(deep + "a").find("too many nested brackets"), std::string::npos);
  const std::string most =
      std::string(kMaxBracketDepth, '(') + "a" + std::string(kMaxBracketDepth, ')');
  EXPECT_EQ(value_of(most), 2);
}

TEST(Expression, EachUserHasItsOwnVariables) {
  const auto parsed = parse_expression("a + b");
  const Formula one = compile(*parsed).value(), two = compile(*parsed).value();
  const double small[]{1, 1}, large[]{100, 100};
  EXPECT_EQ(one(small), 2);
  EXPECT_EQ(two(large), 200);
  EXPECT_EQ(one(small), 2);
}

// Whatever the text is: a fault with a position within it, or a formula that ends.
TEST(Expression, RandomTextIsRefusedOrCalculates) {
  static constexpr std::string_view kPieces[]{
      "a",  "{b-1}", "1",  "2.5e3", "+",   "-", "*", "/", "^", "(", ")",     ",", "<",  ">=",
      "==", "&&",    "||", "max(",  "if(", " ", "!", "=", "{", "}", "sqrt(", ".", "e5", "\xC3"};
  std::mt19937 random(3);
  int good = 0;
  for (int round = 0; round < 20000; ++round) {
    std::string text;
    for (std::size_t i = 1 + random() % 12; i > 0; --i)
      text += kPieces[random() % std::size(kPieces)];
    const auto parsed = parse_expression(text);
    if (!parsed) {
      EXPECT_LE(parsed.error().at, text.size()) << text;
      continue;
    }
    const auto formula = compile(*parsed);
    if (!formula) {
      EXPECT_LE(formula.error().at, text.size()) << text;
      continue;
    }
    ++good;
    const std::vector<double> values(parsed->names.size(), 1.5);
    (void)(*formula)(values);
  }
  EXPECT_GT(good, 50);
}

TEST(Expression, NamesThatPlusOrMinusCombinesAreKnown) {
  const auto sums = [](const std::string& text) { return parse_expression(text)->sums.size(); };
  EXPECT_EQ(sums("a + b"), 1u);
  EXPECT_EQ(sums("a * c + b"), 0u);
  EXPECT_EQ(sums("a - b * c"), 0u);
  EXPECT_EQ(sums("(a + b) / (c - a)"), 2u);
}

}  // namespace
}  // namespace fieldcast::config
