// Tests every address notation of every protocol in a configuration: the loader accepts it, the
// simulated plant serves it, and the engine reads its values.
#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "config/loader/loader.hpp"
#include "core/protocol/families/registry.hpp"
#include "tools/sim/bus/virtual_bus.hpp"
#include "tools/sim/check/requests.hpp"

namespace fieldcast::sim {
namespace {

using namespace std::chrono_literals;

// Returns a bus with one device and a channel for each notation, as a user would write it.
std::string configuration(const Subject& subject) {
  const auto protocol = subject.protocol();
  const bool tcp = std::holds_alternative<TcpPortSpec>(subject.port);
  std::string text = "bridge: b\nbuses:\n  - name: bus\n    port: ";
  const std::string network = has_datagrams(subject.port) ? "udp" : "tcp";
  text += tcp ? "{ " + network + ": 127.0.0.1:502 }"
              : "{ serial: /dev/none, baud: 115200, format: 8E1 }";
  text += "\n    protocol: " + subject.device.protocol + "\n    devices:\n      - name: d\n";
  text += "        address: " + std::to_string(subject.device.link.address) + '\n';
  if (!subject.device.link.options.empty()) {
    text += "        options: {";
    for (const auto& [name, value] : subject.device.link.options)
      text += (text.ends_with('{') ? ' ' : ',') + name + ": \"" + value + '"';
    text += " }\n";
  }
  text += "        channels:\n";
  unsigned count = 0;
  for (const std::string& at : notations_of(subject)) {
    const auto address = protocol->parse_address(at);
    const Area& area = protocol->areas()[address ? address->area : 0];
    const auto type = natural_encoding(address.value_or(ParsedAddress{}), area,
                                       subject.device.declaration.value.get());
    text += "          - { name: c" + std::to_string(count++) + ", at: \"" + at +
            "\", type: " + to_text(type) + ", refresh: 5s }\n";
  }
  return text;
}

void expect_one_place_on_all_sides(const Subject& subject) {
  auto loaded = config::load_text(configuration(subject), "bus.yaml", config::disk_reader(),
                                  config::default_options());
  ASSERT_TRUE(loaded) << subject.variant << config::to_text(std::span(loaded.error()));
  const BusSpec& bus = loaded->buses[0];
  std::set<ChannelIndex> good;
  VirtualBus run(bus, {}, 1, [&](const Action& action) {
    const auto* publish = std::get_if<Publish>(&action);
    if (publish == nullptr) return;
    for (const Sample& sample : publish->samples) {
      if (sample.quality == Quality::kGood) good.insert(sample.channel);
    }
  });
  run.run_until(Instant{20s});
  for (std::size_t i = 0; i < bus.devices[0].channels.size(); ++i) {
    EXPECT_TRUE(good.contains(static_cast<ChannelIndex>(i)))
        << subject.variant << ' ' << bus.devices[0].channels[i].at << " has no good value";
  }
}

TEST(Notation, OfEveryProtocolIsUnderstoodByTheLoaderThePlantAndTheEngine) {
  std::size_t notations = 0;
  for (const ProtocolEntry& entry : protocols()) {
    for (const Subject& subject : subjects_of(entry.name)) {
      EXPECT_FALSE(notations_of(subject).empty()) << entry.name << " shows no notation";
      notations += notations_of(subject).size();
      expect_one_place_on_all_sides(subject);
    }
  }
  EXPECT_GT(notations, 150u);
}

TEST(Notation, OfADeclarationIsUnderstoodByTheLoaderThePlantAndTheEngine) {
  for (const char* name : {"instrument", "modbus-rtu-declared", "dlt645-2007", "adam-4000",
                           "panasonic-mewtocol", "delta-dvp-rtu"}) {
    const auto declaration = config::load_declaration(name);
    ASSERT_TRUE(declaration);
    for (const Subject& subject : subjects_of(*declaration)) expect_one_place_on_all_sides(subject);
  }
}

// Each area of each protocol needs a notation: a new area needs a new line.
TEST(Notation, ReachesEveryArea) {
  for (const ProtocolEntry& entry : protocols()) {
    for (const Subject& subject : subjects_of(entry.name)) {
      const auto protocol = subject.protocol();
      std::set<AreaIndex> reached;
      for (const std::string& at : notations_of(subject)) {
        const auto address = protocol->parse_address(at);
        ASSERT_TRUE(address) << entry.name << ' ' << at << ": " << address.error().what;
        reached.insert(address->area);
      }
      EXPECT_EQ(reached.size(), protocol->areas().size()) << entry.name << ' ' << subject.variant;
    }
  }
}

}  // namespace
}  // namespace fieldcast::sim
