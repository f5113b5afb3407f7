#include "tests/support/vectors.hpp"

#include <gtest/gtest.h>

#include <array>
#include <nlohmann/json.hpp>
#include <set>

#include "core/codec/value_codec.hpp"
#include "core/protocol/families/registry.hpp"
#include "tests/protocol/dtc/dtc_text.hpp"
#include "tests/support/device.hpp"
#include "tests/support/matrix.hpp"

namespace fieldcast::test {
namespace {

constexpr std::array<std::size_t, 5> kBits{1, 16, 32, 32, 64};

struct Group {
  Range range;
  Bytes data;  // as on the wire; empty for a read
};

std::vector<Group> groups_of(const Bytes& packet) {
  const Bytes message = dtc_unpacked(packet);
  std::vector<Group> groups;
  for (std::size_t at = 2; at + 2 < message.size();) {
    const Range range{message[at + 2], read_u16(message, at), read_u16(message, at + 3)};
    const std::size_t size = message[1] == 1 ? (kBits[range.area] * range.count + 7) / 8 : 0;
    at += 5 + size;
    groups.push_back({range, Bytes(message.begin() + static_cast<std::ptrdiff_t>(at - size),
                                   message.begin() + static_cast<std::ptrdiff_t>(at))});
  }
  return groups;
}

Bytes image(const Range& range, ByteView data) {
  if (range.area != 0) return {data.begin(), data.end()};
  Bytes bits;
  for (std::size_t i = 0; i < range.count; ++i) bits.push_back(data[i / 8] >> i % 8 & 1u);
  return bits;
}

std::uint16_t address_of(const GoldenVector& vector) { return dtc_unpacked(vector.request)[0]; }
std::map<std::string, std::string> threshold(const GoldenVector& vector) {
  return {{"threshold", vector.name.find("lzw") != std::string::npos ? "0" : "65535"}};
}
bool has_fault(const std::vector<FrameField>& fields) {
  return std::any_of(fields.begin(), fields.end(),
                     [](const FrameField& field) { return !field.fault.empty(); });
}

// Compares the values of a vector in JSON with the response, to check the parsing of numbers too.
void expect_values(const nlohmann::json& groups, const Reply& reply) {
  ASSERT_EQ(reply.size(), groups.size());
  for (std::size_t g = 0; g < reply.size(); ++g) {
    const std::string type = groups[g]["type"];
    const auto& values = groups[g]["values"];
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (type == "bit") {
        EXPECT_EQ(reply[g].items.at(i), values[i].get<int>());
        continue;
      }
      Encoding encoding{.type = *value_type_from(type)};
      const std::size_t size = width_bits(encoding) / 8;
      const auto value = decode_value(encoding, static_cast<unsigned>(8 * size),
                                      ByteView(reply[g].items).subspan(i * size, size));
      ASSERT_TRUE(value.has_value());
      EXPECT_EQ(*as_number(*value), values[i].get<double>());
    }
  }
}

TEST(DtcVectors, ReadRequestsAndResponsesAreAsPrinted) {
  int seen = 0;
  for (const GoldenVector& vector : load_vectors("dtc")) {
    if (vector.kind != "ok" || !vector.name.starts_with("read_")) continue;
    SCOPED_TRACE(vector.name);
    ++seen;
    const Device device("dtc", address_of(vector), threshold(vector));
    ReadRequest read;
    for (const Group& group : groups_of(vector.request)) read.ranges.push_back(group.range);
    EXPECT_EQ(to_hex(device.request_bytes(read)), to_hex(vector.request));
    const auto exchange = device.begin(read);
    const Outcome outcome = drive(*exchange, vector.response);
    ASSERT_TRUE(outcome.done()) << to_text(outcome);
    expect_values(nlohmann::json::parse(vector.texts.at("groups")), outcome.reply);
    if (vector.response.size() < 400)
      expect_matrix({.begin = [&] { return device.begin(read); }, .answers = {vector.response}});
    EXPECT_FALSE(has_fault(find_protocol("dtc")->explain(vector.request)));
    EXPECT_FALSE(has_fault(find_protocol("dtc")->explain(vector.response)));
    const auto size = device.protocol().size(read);
    ASSERT_TRUE(size.has_value());
    if (vector.request[0] == 0) { EXPECT_EQ(size->request_characters, vector.request.size()); }
    if (vector.response[0] == 0) { EXPECT_EQ(size->response_characters, vector.response.size()); }
  }
  EXPECT_GE(seen, 24);
}

// A WriteRequest has one range, so a message of several groups is sent as one message per group.
TEST(DtcVectors, WritesAreMadeOfThePrintedGroups) {
  int whole = 0, parts = 0;
  for (const GoldenVector& vector : load_vectors("dtc")) {
    if (vector.kind != "ok" || !vector.name.starts_with("write_")) continue;
    SCOPED_TRACE(vector.name);
    const Device device("dtc", address_of(vector), threshold(vector));
    const auto groups = groups_of(vector.request);
    const Bytes message = dtc_unpacked(vector.request);
    for (const Group& group : groups) {
      ++parts;
      const WriteRequest write{.range = group.range, .items = image(group.range, group.data)};
      const Bytes sent = device.request_bytes(write);
      Bytes head{static_cast<std::uint8_t>(address_of(vector)), 1};
      append_u16(head, static_cast<std::uint16_t>(group.range.first));
      head.push_back(group.range.area);
      append_u16(head, static_cast<std::uint16_t>(group.range.count));
      append(head, group.data);
      EXPECT_EQ(to_hex(sent), to_hex(dtc_plain(dtc_message(to_hex(head)))));
      if (groups.size() == 1) {
        ++whole;
        EXPECT_EQ(to_hex(sent), to_hex(vector.request));
      }
      const auto exchange = device.begin(write);
      EXPECT_TRUE(drive(*exchange, vector.response).done());
    }
    EXPECT_FALSE(has_fault(find_protocol("dtc")->explain(vector.request)));
  }
  EXPECT_GE(whole, 2);
  EXPECT_GE(parts, 30);
}

TEST(DtcVectors, RefusalsCarryTheirCode) {
  std::set<int> codes;
  for (const GoldenVector& vector : load_vectors("dtc")) {
    if (vector.kind != "exception") continue;
    SCOPED_TRACE(vector.name);
    const Device device("dtc", 7);
    const auto exchange = device.begin(device.read("int16:0"));
    const Outcome outcome = drive(*exchange, vector.response);
    EXPECT_EQ(outcome.cause, Cause::kDeviceError);
    EXPECT_EQ(outcome.code, dtc_unpacked(vector.response)[2]);
    codes.insert(outcome.code);
    expect_matrix({.begin = [&] { return device.begin(device.read("int16:0")); },
                   .answers = {vector.response}});
  }
  EXPECT_EQ(codes, (std::set<int>{1, 2, 3, 4, 5}));
}

}  // namespace
}  // namespace fieldcast::test
