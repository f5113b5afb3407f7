// Areas, limits, addresses and requests of the built-in protocols, with each of their variants:
// facts/PROTOCOL.txt.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "core/protocol/families/registry.hpp"

namespace fieldcast::test {
namespace {

std::string area_text(const Area& area) {
  std::string text = "  " + std::string(area.name) + ": " + std::to_string(area.items) + " of " +
                     std::to_string(area.item_bits) + " bits, read " +
                     std::to_string(area.max_read) + ", write " +
                     (area.writable ? std::to_string(area.max_write) : "-");
  if (area.type) text += ", " + std::string(to_text(*area.type));
  if (area.alignment != 1) text += ", aligned to " + std::to_string(area.alignment);
  if (area.bank != 0) text += ", banks of " + std::to_string(area.bank);
  for (const auto& [is, name] :
       {std::pair{area.bit_write, "bits"},
        {area.byte_write, "bytes"},
        {area.mask_write, "masks"},
        {area.window, "window"},
        {area.counted, "counted"},
        {area.word_order == WordOrder::kLittleEndian, "low word first"},
        {area.text_order == ByteOrder::kLittleEndian, "low character first"}})
    text += is ? std::string(", ") + name : "";
  return text + '\n';
}

std::string request_text(const Protocol& protocol, const Request& request) {
  const auto size = protocol.size(request);
  if (!size) return "not possible\n";
  Bytes out;
  (void)protocol.begin(request, {1})->start(out);
  return std::to_string(size->request_characters) + " + " +
         std::to_string(size->response_characters) + " in " + std::to_string(size->rounds) + ": " +
         to_hex(out) + '\n';
}

std::string address_text(const Protocol& protocol, std::string_view at) {
  const auto parsed = protocol.parse_address(at);
  if (!parsed)
    return "  '" + std::string(at) + "': " + parsed.error().what + "; " +
           parsed.error().suggestion + '\n';
  std::string text = "  " + std::string(at) + ": " +
                     std::string(protocol.areas()[parsed->area].name) + ' ' +
                     std::to_string(parsed->first);
  if (parsed->bit) text += '.' + std::to_string(*parsed->bit);
  if (parsed->width_bits) text += ", " + std::to_string(*parsed->width_bits) + " bits";
  if (parsed->text_characters != 0)
    text += ", " + std::to_string(parsed->text_characters) + " characters";
  return text + '\n';
}

// Characters of request and response, rounds, and the first frame: "8 + 11 in 1: 01 03 ...".
std::string requests_text(const Protocol& protocol, const ParsedAddress& at) {
  const Area& area = protocol.areas()[at.area];
  const std::uint32_t count =
      std::max<std::uint32_t>(area.alignment, 3 / area.alignment * area.alignment);
  const Range range{at.area, at.first - at.first % area.alignment, count};
  const auto write = [&](std::uint32_t items, std::optional<std::uint8_t> bit) {
    WriteRequest request{{at.area, range.first, items},
                         Bytes(image_bytes(area.item_bits, items), 1)};
    request.bit = bit;
    return request_text(protocol, request);
  };
  return "    read " + request_text(protocol, ReadRequest{{range}}) + "    write two " +
         write(2, {}) + "    write one " + write(1, {}) + "    write a bit " + write(1, 0);
}

// Addresses with one fault each.
std::vector<std::string> broken(std::string_view at) {
  std::string lower(at), all_nines(at);
  for (char& c : lower) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c;
  const auto digit = at.find_last_of("0123456789");
  if (digit != at.npos) all_nines.insert(digit, "99999");
  return {lower, all_nines, std::string(at) + "x", std::string(at) + ".64",
          std::string(at.substr(0, at.find_first_of("0123456789")))};
}

std::vector<std::string> facts_of(const Protocol& protocol, const ProtocolVariant& variant) {
  std::vector<std::string> lines;
  for (const Area& area : protocol.areas()) lines.push_back(area_text(area));
  std::set<std::string> faults;
  std::set<unsigned> asked;  // one area of each size of its items
  for (const std::string_view at : variant.addresses) {
    lines.push_back(address_text(protocol, at));
    const auto parsed = protocol.parse_address(at);
    if (parsed && asked.insert(protocol.areas()[parsed->area].item_bits).second)
      lines.back() += requests_text(protocol, *parsed);
    for (const std::string& each : broken(at)) {
      if (!protocol.parse_address(each)) faults.insert(address_text(protocol, each));
    }
  }
  lines.insert(lines.end(), faults.begin(), faults.end());
  return lines;
}

// Of later variants, only what the first one does not have.
std::string facts(const ProtocolEntry& entry) {
  std::string text;
  std::set<std::string> known;
  for (const ProtocolVariant& variant : entry.variants) {
    DeviceLink link{.address = 1};
    text += "variant";
    for (const auto& [name, value] : variant.options) {
      link.options.emplace(name, value);
      text += ' ' + std::string(name) + '=' + std::string(value);
    }
    text += '\n';
    for (const std::string& line : facts_of(**entry.make(link), variant))
      text += known.insert(line).second ? line : "";
  }
  return text;
}

class Facts : public testing::TestWithParam<const ProtocolEntry*> {};

TEST_P(Facts, AreAsWritten) {
  const std::string name = FIELDCAST_FACTS "/" + std::string(GetParam()->name) + ".txt";
  std::ifstream file(name);
  ASSERT_TRUE(file) << name;
  std::ostringstream whole;
  whole << file.rdbuf();
  EXPECT_EQ(facts(*GetParam()), whole.str());
}

std::vector<const ProtocolEntry*> entries() {
  std::vector<const ProtocolEntry*> all;
  for (const ProtocolEntry& entry : protocols()) all.push_back(&entry);
  return all;
}

INSTANTIATE_TEST_SUITE_P(EveryProtocol, Facts, testing::ValuesIn(entries()), [](const auto& row) {
  std::string name(row.param->name);
  std::ranges::replace(name, '-', '_');
  return name;
});

}  // namespace
}  // namespace fieldcast::test
