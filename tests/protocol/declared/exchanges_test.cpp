// Exchanges of declared protocols: exchanges/NAME.txt begins with `shipped: NAME` or a declaration.
#include <gtest/gtest.h>

#include "tests/protocol/exchange_text.hpp"
#include "tests/support/declared_device.hpp"
#include "tests/support/golden.hpp"

namespace fieldcast::test {
namespace {

const std::string kFolder = FIELDCAST_DECLARED_FACTS "/../exchanges";

class DeclaredText : public ExchangeText {
 public:
  explicit DeclaredText(const std::string& head) : DeclaredText(load(head)) {}

 private:
  using Shared = std::shared_ptr<const declared::Declaration>;

  explicit DeclaredText(const Shared& shared)
      : ExchangeText(
            [shared](const DeviceLink& link) {
              return std::move(declared::make(shared, link).value());
            },
            [shared](ByteView frame) { return declared::explain(*shared, frame); }) {}

  static Shared load(const std::string& head) {
    constexpr std::string_view kShipped = "shipped: ";
    if (head.starts_with(kShipped))
      return declaration(head.substr(kShipped.size(), head.find('\n') - kShipped.size()));
    const auto loaded = config::load_declaration_text(head, "test.yaml");
    if (!loaded) throw std::invalid_argument(config::to_text(std::span(loaded.error())));
    return loaded->value;
  }
};

class DeclaredExchanges : public testing::TestWithParam<std::string> {};

TEST_P(DeclaredExchanges, EndAsWritten) {
  expect_bus_responses<DeclaredText>(kFolder + "/" + GetParam() + ".txt");
}

INSTANTIATE_TEST_SUITE_P(Declared, DeclaredExchanges, testing::ValuesIn(golden_names(kFolder)),
                         golden_test_name);

}  // namespace
}  // namespace fieldcast::test
