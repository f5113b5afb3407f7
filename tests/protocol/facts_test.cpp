// Areas, limits, addresses and requests of the built-in protocols, with each of their variants:
// facts/PROTOCOL.txt.
#include "tests/protocol/facts.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <set>
#include <sstream>

#include "core/protocol/families/registry.hpp"

namespace fieldcast::test {
namespace {

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

// What each option allows, and which addresses devices have.
std::vector<std::string> allowed(const ProtocolEntry& entry, const DeviceLink& right) {
  std::vector<std::string> lines;
  const auto add = [&](const std::string& name, const DeviceLink& link) {
    const auto made = entry.make(link);
    lines.push_back("  " + name + ": " +
                    (made ? "any" : made.error().what + "; " + made.error().allowed) + '\n');
  };
  for (const std::string_view option : entry.options) {
    DeviceLink link = right;
    link.options[std::string(option)] = "?";
    add(std::string(option), link);
  }
  DeviceLink link = right;
  link.address = 65535;
  add("device", link);
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
    std::vector<std::string> lines = facts_of(**entry.make(link), variant);
    const std::vector<std::string> rules = allowed(entry, link);
    lines.insert(lines.end(), rules.begin(), rules.end());
    for (const std::string& line : lines) text += known.insert(line).second ? line : "";
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
  const std::string actual = facts(*GetParam());
  if (actual == whole.str()) return;
  const std::string copy = testing::TempDir() + "facts-" + std::string(GetParam()->name) + ".txt";
  std::ofstream(copy) << actual;
  EXPECT_EQ(actual, whole.str()) << "to accept it: cp " << copy << ' ' << name;
}

// The wait for a response, and the search for its end in broken bytes, use the length that start()
// returns. Requests of several rounds begin with a greeting, a poll or an acknowledgement.
TEST_P(Facts, TheFirstSendExpectsAResponseOfTheSizeThatIsPlanned) {
  for (const ProtocolVariant& variant : GetParam()->variants) {
    DeviceLink link{.address = 1};
    for (const auto& [name, value] : variant.options) link.options.emplace(name, value);
    const auto protocol = std::move(*GetParam()->make(link));
    for (const std::string_view at : variant.addresses) {
      const auto parsed = protocol->parse_address(at);
      if (!parsed) continue;
      const Request read = ReadRequest{{{parsed->area, parsed->first, 1}}};
      const auto size = protocol->size(read);
      if (!size || size->rounds != 1) continue;
      Bytes sent;
      const Step step = protocol->begin(read, {1})->start(sent);
      if (sent.size() != size->request_characters) continue;
      EXPECT_EQ(step.characters, size->response_characters) << at;
    }
  }
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
