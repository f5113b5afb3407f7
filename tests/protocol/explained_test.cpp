// Explanations of frames: explained/PROTOCOL.txt has each frame and, indented, what is shown of it.
// A line `damaged FRAME` shows the faults if the frame ends earlier, or if a byte differs by 01 or
// by 10; "4..6" are the bytes with the same faults.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
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

std::string faults(const ProtocolEntry& entry, const Bytes& frame) {
  std::string text;
  for (const FrameField& field : entry.explain(frame)) {
    if (!field.fault.empty())
      text += (text.empty() ? "" : "; ") + field.name + " !! " + field.fault;
  }
  return text.empty() ? "none" : text;
}

// Numbers that differ for each byte: the right check, and the bytes that are there.
std::string without(const std::string& numbers, const std::string& text) {
  return std::regex_replace(text, std::regex(numbers), "..");
}

// One line for each run of bytes at which `at` returns the same.
template <class At>
std::string runs(const std::string& title, std::size_t size, At at) {
  std::string text, last;
  std::size_t begin = 0;
  for (std::size_t place = 0; place <= size; ++place) {
    const std::string now = place < size ? at(place) : std::string{};
    if (now == last) continue;
    if (!last.empty()) {
      text += "  " + title + ' ' + std::to_string(begin);
      if (place > begin + 1) text += ".." + std::to_string(place - 1);
      text += ": " + last + '\n';
    }
    begin = place;
    last = now;
  }
  return text;
}

constexpr const char* kChecks =
    "([CL]RC is [0-9A-F]+, should be [0-9A-F]+|\\b[0-9A-F]{2}( [0-9A-F]{2})*( or BCC "
    "[0-9A-F]{2})?)(?=;|$)";

std::string damaged(const ProtocolEntry& entry, const Bytes& frame) {
  std::string text = runs("cut", frame.size(), [&](std::size_t at) {
    const Bytes part(frame.begin(), frame.begin() + static_cast<std::ptrdiff_t>(at));
    return without(std::to_string(at) + "(?= bytes)", without(kChecks, faults(entry, part)));
  });
  for (const auto& [title, bits] : {std::pair{"by 01", 0x01}, std::pair{"by 10", 0x10}})
    text += runs(title, frame.size(), [&, change = bits](std::size_t at) {
      Bytes changed = frame;
      changed[at] = static_cast<std::uint8_t>(changed[at] ^ change);
      return without(kChecks, faults(entry, changed));
    });
  return text;
}

class Explained : public testing::TestWithParam<std::string_view> {};

TEST_P(Explained, FramesAreShownAsWritten) {
  const std::string name = std::string(FIELDCAST_EXPLAINED "/") + std::string(GetParam()) + ".txt";
  const std::string text = golden_text(name);
  ASSERT_FALSE(text.empty()) << name;
  expect_responses(name, text, 0, [](const std::string& line) {
    const ProtocolEntry& entry = *find_protocol(GetParam());
    const std::string word = "damaged ";
    if (line.starts_with(word)) return damaged(entry, *from_hex(line.substr(word.size())));
    return explained(entry, *from_hex(line));
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
