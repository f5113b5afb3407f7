// Each case in tests/config/bad_protocols has one fault; its comments list the expected messages.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/config/support.hpp"

namespace fieldcast::config {
namespace {

class BadProtocol : public testing::TestWithParam<BadCase> {};

TEST_P(BadProtocol, IsRefusedWithExactlyTheFaultsAtItsHead) {
  const auto expected = GetParam().expected();
  ASSERT_NE(expected, "") << "the case has no expected message";
  const auto loaded = load_declaration_text(GetParam().text, GetParam().file());
  EXPECT_EQ(loaded ? "" : to_text(std::span(loaded.error())), expected);
}

INSTANTIATE_TEST_SUITE_P(Config, BadProtocol,
                         testing::ValuesIn(bad_cases(source_dir() / "tests/config/bad_protocols")),
                         [](const auto& bad) { return bad.param.identifier(); });

TEST(DeclaredProtocols, ThoseThatComeWithFieldcastLoad) {
  for (const auto& path : files_of(source_dir() / "config/protocols", ".yaml")) {
    const auto loaded = load_declaration(path.string());
    EXPECT_TRUE(loaded) << to_text(std::span(loaded.error()));
  }
}

TEST(DeclaredProtocols, EveryTruncationIsADeclarationOrFaults) {
  for (const auto& path : files_of(source_dir() / "config/protocols", ".yaml")) {
    const auto text = slurp(path);
    for (std::size_t length = 0; length < text.size(); length += 3) {
      const auto loaded =
          load_declaration_text(std::string_view(text).substr(0, length), "cut.yaml");
      if (!loaded) { EXPECT_FALSE(loaded.error().empty()) << length; }
    }
  }
}

std::string bridge(const std::string& protocol, const std::string& at) {
  return "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n    protocol: " +
         protocol +
         "\n    devices:\n      - name: d\n        address: 3\n        channels:\n          - { "
         "name: c, at: \"" +
         at + "\", type: uint16 }\n";
}

TEST(DeclaredProtocols, AreFoundBesideTheConfigurationFirst) {
  auto instrument = slurp(source_dir() / "config/protocols/instrument.yaml");
  const LoadOptions options{{}, {"/share/protocols"}};
  const auto shared = texts({{"/share/protocols/thing.yaml", instrument}});
  const auto loaded = load_text(bridge("thing", "status"), "/etc/plant.yaml", shared, options);
  ASSERT_TRUE(loaded) << faults_of(loaded);
  const auto& device = loaded->buses[0].devices[0];
  EXPECT_EQ(device.protocol, "thing");
  ASSERT_TRUE(device.declaration);
  EXPECT_EQ(device.declaration.value->name, "thing");
  EXPECT_EQ(device.channels[0].range, (Range{0, 0, 1}));

  const auto both = texts({{"/share/protocols/thing.yaml", instrument},
                           {"/etc/protocols/thing.yaml", "summary: mine\n"}});
  EXPECT_NE(faults_of(load_text(bridge("thing", "status"), "/etc/plant.yaml", both, options))
                .find("/etc/protocols/thing.yaml"),
            std::string::npos);
}

// Its own folder has no declarations.
TEST(DeclaredProtocols, ATemplateMayBeForSeveral) {
  const auto instrument = slurp(source_dir() / "config/protocols/instrument.yaml");
  const auto files = texts({{"/etc/protocols/old.yaml", instrument},
                            {"/etc/protocols/new.yaml", instrument},
                            {"/etc/devices/kind.yaml",
                             "protocols: [old, new]\n"
                             "channels: [{ name: c, at: status, type: uint8 }]\n"}});
  const auto loaded = load_text(
      "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n    protocol: new\n"
      "    devices: [{ name: d, address: 3, template: kind }]\n",
      "/etc/plant.yaml", files);
  ASSERT_TRUE(loaded) << faults_of(loaded);
  EXPECT_EQ(loaded->buses[0].devices[0].channels[0].name, "c");
}

std::string meters(const std::string& address, const std::string& channel) {
  return "bridge: b\nbuses:\n  - name: bus\n    port: { serial: /dev/ttyS0 }\n    protocol: meter\n"
         "    devices:\n      - { name: d, address: " +
         address + ", channels: [" + channel + "] }\n";
}

// A meter's number may have any number of digits, quotes and leading zeros.
TEST(DeclaredProtocols, HaveAddressesOfMoreThan16Bits) {
  const auto file = slurp(source_dir() / "config/protocols/dlt645-2007.yaml");
  const auto files = texts({{"/etc/protocols/meter.yaml", file}});
  const auto load = [&](const std::string& address) {
    return load_text(meters(address, "{ name: c, at: \"energy:10000\", type: uint32 }"),
                     "/etc/plant.yaml", files);
  };
  for (const auto& [address, number] :
       {std::pair<std::string, std::string>{"398192000337", "398192000337"},
        {"\"004712345678\"", "4712345678"}}) {
    const auto loaded = load(address);
    ASSERT_TRUE(loaded) << faults_of(loaded);
    EXPECT_EQ(loaded->buses[0].devices[0].link.long_address, number);
  }
  const auto small = load("\"000000000007\"");
  ASSERT_TRUE(small) << faults_of(small);
  EXPECT_EQ(small->buses[0].devices[0].link, (DeviceLink{.address = 7}));
  EXPECT_THAT(faults_of(load("1000000000000")),
              testing::HasSubstr("address '1000000000000' is outside what meter has; allowed: "
                                 "0..999999999999"));
  EXPECT_THAT(faults_of(load("meter")), testing::HasSubstr("is no whole number"));
}

TEST(DeclaredProtocols, ATriggerIsWriteOnly) {
  const auto file = slurp(source_dir() / "config/protocols/mt-sics.yaml");
  const auto files = texts({{"/etc/protocols/meter.yaml", file}});
  const auto loaded =
      load_text(meters("1", "{ name: t, at: tare, access: write-only }"), "/etc/plant.yaml", files);
  ASSERT_TRUE(loaded) << faults_of(loaded);
  EXPECT_EQ(loaded->buses[0].devices[0].channels[0].encoding.type, ValueType::kBool);
  EXPECT_THAT(faults_of(load_text(meters("1", "{ name: t, at: tare, access: read-write }"),
                                  "/etc/plant.yaml", files)),
              testing::HasSubstr("'tare' cannot be read; allowed: access: write-only"));
}

// Its refresh is the longest accepted silence.
TEST(DeclaredProtocols, AnUnsolicitedChannelIsOnlyWatched) {
  const auto file = slurp(source_dir() / "config/protocols/nmea-0183.yaml");
  const auto files = texts({{"/etc/protocols/meter.yaml", file}});
  const auto load = [&](const std::string& rest) {
    return load_text(meters("1", "{ name: c, at: altitude, type: float64, " + rest + " }"),
                     "/etc/plant.yaml", files);
  };
  const auto loaded = load("refresh: 3s");
  ASSERT_TRUE(loaded) << faults_of(loaded);
  EXPECT_TRUE(loaded->buses[0].devices[0].channels[0].unsolicited);
  EXPECT_THAT(faults_of(load("refresh: 1s")),
              testing::HasSubstr("refresh 1s is not longer than the time between two frames of the "
                                 "device; allowed: above 1s, for example 3s"));
  EXPECT_THAT(faults_of(load("refresh: 3s, mode: on-demand")),
              testing::HasSubstr("'altitude' is sent by the device and never read on demand"));

  // Where a default cannot hold it does not.
  std::string inherited = meters("1", "{ name: c, at: altitude, type: float64, refresh: 3s }");
  inherited.replace(inherited.find("channels"), 0, "mode: on-demand, ");
  const auto scheduled = load_text(inherited, "/etc/plant.yaml", files);
  ASSERT_TRUE(scheduled) << faults_of(scheduled);
  EXPECT_EQ(scheduled->buses[0].devices[0].channels[0].mode, Mode::kScheduled);
}

TEST(DeclaredProtocols, AreComparedByWhatTheySay) {
  const auto instrument = slurp(source_dir() / "config/protocols/instrument.yaml");
  const auto load = [&](const std::string& text) {
    return *load_text(bridge("thing", "status"), "plant.yaml",
                      texts({{"protocols/thing.yaml", text}}));
  };
  EXPECT_EQ(load(instrument), load(instrument));
  EXPECT_EQ(load(instrument), load(instrument + "# a remark\n"));
  auto other = instrument;
  other.replace(other.find("0x55"), 4, "0x56");
  EXPECT_NE(load(instrument), load(other));
}

TEST(DeclaredProtocols, PlacesThatAreMisspeltAreFaultsOfTheChannel) {
  const auto instrument = slurp(source_dir() / "config/protocols/instrument.yaml");
  const auto loaded = load_text(bridge("thing", "statuss"), "plant.yaml",
                                texts({{"protocols/thing.yaml", instrument}}));
  EXPECT_NE(faults_of(loaded).find("'statuss' is no address; allowed: status, analog, unit, input, "
                                   "output; a bit as .BIT behind it; did you mean status?"),
            std::string::npos)
      << faults_of(loaded);
}

}  // namespace
}  // namespace fieldcast::config
