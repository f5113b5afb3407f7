// Explanations of frames: explained/PROTOCOL.txt has each frame and, indented, what is shown of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <string_view>

#include "core/protocol/families/registry.hpp"
#include "tests/support/golden.hpp"

namespace fieldcast::test {
namespace {

// "2+4 first: holding:16" is offset, bytes, name and value of a field; "!!" precedes a fault.
std::string shown(const FrameField& field) {
  return std::string(2 + 2 * field.depth, ' ') + std::to_string(field.offset) + '+' +
         std::to_string(field.length) + ' ' + field.name + (field.value.empty() ? "" : ": ") +
         field.value + (field.fault.empty() ? "" : " !! " + field.fault) + '\n';
}

std::string explained(const ProtocolEntry& entry, const Bytes& frame) {
  std::string text;
  for (const FrameField& field : entry.explain(frame)) text += shown(field);
  if (entry.seen_request == nullptr) return text;
  const SeenRequest seen = entry.seen_request(frame);
  return text + "  request: " +
         (seen ? std::to_string(seen.size) + (seen.certain ? " bytes\n" : " bytes, or a response\n")
               : "no\n");
}

class Explained : public testing::TestWithParam<std::string_view> {};

TEST_P(Explained, FramesAreShownAsWritten) {
  const std::string name = std::string(FIELDCAST_EXPLAINED "/") + std::string(GetParam()) + ".txt";
  const std::string text = golden_text(name);
  ASSERT_FALSE(text.empty()) << name;
  expect_responses(name, text, 0, [](const std::string& line) {
    return explained(*find_protocol(GetParam()), *from_hex(line));
  });
}

INSTANTIATE_TEST_SUITE_P(EveryProtocol, Explained,
                         testing::Values("allen-bradley-df1", "dtc", "mitsubishi-fx",
                                         "mitsubishi-mc", "mitsubishi-mc-serial", "modbus-ascii",
                                         "modbus-rtu", "modbus-tcp", "omron-fins", "omron-hostlink",
                                         "s7-freeport", "s7-ppi", "s7-tcp"),
                         [](const auto& row) {
                           std::string name(row.param);
                           std::ranges::replace(name, '-', '_');
                           return name;
                         });

}  // namespace
}  // namespace fieldcast::test
