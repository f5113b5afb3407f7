// Exchanges of the built-in protocols: exchanges/NAME.txt begins with the name of the protocol.
#include <gtest/gtest.h>

#include "core/protocol/families/registry.hpp"
#include "tests/protocol/exchange_text.hpp"
#include "tests/support/golden.hpp"

namespace fieldcast::test {
namespace {

const std::string kFolder = FIELDCAST_FACTS "/../exchanges";

class BuiltInText : public ExchangeText {
 public:
  explicit BuiltInText(const std::string& head)
      : ExchangeText([&entry = entry(head)](
                         const DeviceLink& link) { return std::move(entry.make(link).value()); },
                     entry(head).explain) {}

 private:
  static const ProtocolEntry& entry(const std::string& head) {
    const ProtocolEntry* found = find_protocol(head.substr(0, head.find('\n')));
    if (found == nullptr) throw std::invalid_argument("no protocol " + head);
    return *found;
  }
};

class Exchanges : public testing::TestWithParam<std::string> {};

TEST_P(Exchanges, EndAsWritten) {
  expect_bus_responses<BuiltInText>(kFolder + "/" + GetParam() + ".txt");
}

INSTANTIATE_TEST_SUITE_P(BuiltIn, Exchanges, testing::ValuesIn(golden_names(kFolder)),
                         golden_test_name);

}  // namespace
}  // namespace fieldcast::test
